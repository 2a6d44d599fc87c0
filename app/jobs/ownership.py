"""Ownership of studies, which are kept once, by everyone who has posted them.

An owner holds a study from its posting until it makes room for others of theirs, or of the service.
No other owner sees it, unless it is shared.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Row, select

from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.tables import JOBS, OWNED_STUDIES

USED_EVERY = 3600.0  # s; a study's time of last use is written at most once in this time


@dataclass(frozen=True)
class OwnedStudy:
    """A study that an owner has posted.

    Attributes
    ----------
    owner, key : str
        Whose, and which.
    bytes : int
        Of the study itself.
    result : bool
        Whether its owner has asked for its result, too.
    shared : bool
        True if all keys may read the job and its results.
    used : float
        When its owner, or one that it is shared with, used it last, to an hour [s since the epoch].
    """

    owner: str
    key: str
    bytes: int
    result: bool
    shared: bool
    used: float


class Ownership:
    """Reads and writes who holds what; its methods may be called inside a transaction."""

    def __init__(self, database: Database):
        """Read and write the owners' records in a database."""
        self._database = database

    def hold(self, owner: str, key: str, bytes_: int, *, result: bool) -> bool:
        """Record that an owner has posted a study; True if the owner had not posted it before.

        Parameters
        ----------
        owner, key : str
            Name of the API key, and identifier of the study.
        bytes_ : int
            Bytes of the study itself, without its result.
        result : bool
            True if the owner asks for its result, too.
        """
        with self._database.transaction() as connection:
            existing = self.of(owner, key)
            if existing is None:
                connection.execute(
                    OWNED_STUDIES.insert().values(
                        owner=owner, key=key, bytes=bytes_, result=int(result), shared=0,
                        used=time.time(),
                    )
                )  # fmt: skip
            else:
                changes = {"used": time.time(), "result": int(result or existing.result)}
                connection.execute(
                    OWNED_STUDIES.update().where(_held_by(owner, key)).values(changes)
                )
        return existing is None

    def of(self, owner: str, key: str) -> OwnedStudy | None:
        """Return the record of an owner's study; None if the owner has not posted it.

        `owner` is the name of an API key, `key` the study's identifier.
        """
        rows = self._database.read(select(OWNED_STUDIES).where(_held_by(owner, key)))
        return _owned_study(rows[0]) if rows else None

    def readable(self, owner: str, key: str) -> list[OwnedStudy]:
        """Return the records of a study that an owner may read, its own or shared; note the use.

        `owner` is the name of an API key, `key` the study's identifier. The time of last use is
        written at most once an hour.
        """
        is_seen = (OWNED_STUDIES.c.owner == owner) | (OWNED_STUDIES.c.shared == 1)
        rows = self._database.read(select(OWNED_STUDIES).where(OWNED_STUDIES.c.key == key, is_seen))
        owned = [_owned_study(row) for row in rows]
        now = time.time()
        if any(abs(now - study.used) > USED_EVERY for study in owned):
            with self._database.transaction() as connection:
                connection.execute(
                    OWNED_STUDIES.update()
                    .where(OWNED_STUDIES.c.key == key, is_seen)
                    .values(used=now)
                )
        return owned

    def share(self, owner: str | None, key: str, shared: bool) -> None:
        """Make a study readable for all keys (`shared`), or for its owners only.

        `owner` is the owner whose record is changed, None for all owners; `key` is the study's
        identifier.
        """
        condition = OWNED_STUDIES.c.key == key
        if owner is not None:
            condition &= OWNED_STUDIES.c.owner == owner
        with self._database.transaction() as connection:
            connection.execute(OWNED_STUDIES.update().where(condition).values(shared=int(shared)))

    def is_shared(self, owner: str | None, key: str) -> bool:
        """True if an owner, or any owner if None, shares a study with all API keys.

        `owner` is the name of an API key, `key` the study's identifier.
        """
        condition = (OWNED_STUDIES.c.key == key) & (OWNED_STUDIES.c.shared == 1)
        if owner is not None:
            condition &= OWNED_STUDIES.c.owner == owner
        return bool(self._database.read(select(OWNED_STUDIES.c.key).where(condition).limit(1)))

    def of_others(self, owner: str) -> set[str]:
        """Return the identifiers of the studies that owners other than the given one hold."""
        of_others = select(OWNED_STUDIES.c.key).where(OWNED_STUDIES.c.owner != owner).distinct()
        return {row[0] for row in self._database.read(of_others)}

    def release(self, key: str, owner: str | None = None) -> None:
        """Remove an owner's record of a study, or those of all owners; mark their jobs as gone.

        `key` is the study's identifier. Successful jobs of the study then say that the result has
        made room for others.
        """
        is_owned, is_of_job = OWNED_STUDIES.c.key == key, JOBS.c.key == key
        if owner is not None:
            is_owned &= OWNED_STUDIES.c.owner == owner
            is_of_job &= JOBS.c.owner == owner
        with self._database.transaction() as connection:
            connection.execute(OWNED_STUDIES.delete().where(is_owned))
            connection.execute(
                JOBS.update().where(is_of_job, JOBS.c.state == "successful").values(gone=1)
            )

    def studies(self) -> set[str]:
        """Return all studies that have an owner."""
        return {row[0] for row in self._database.read(select(OWNED_STUDIES.c.key).distinct())}


def _held_by(owner: str, key: str) -> ColumnElement[bool]:
    return (OWNED_STUDIES.c.owner == owner) & (OWNED_STUDIES.c.key == key)


def _owned_study(row: Row[*tuple[Any, ...]]) -> OwnedStudy:
    return OwnedStudy(row.owner, row.key, row.bytes, bool(row.result), bool(row.shared), row.used)
