"""Keys of the HTTP interface: who they belong to, what they may do, how much, and until when.

They are kept in the ledger as hashes, and made and withdrawn while the service runs. A name stands
for its owner: a new key of the same name, once the old one is withdrawn or over, has what belonged
to it.
"""

from __future__ import annotations

import hashlib
import logging
import re
import secrets
import threading
import time
import uuid
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal, get_args

from sqlalchemy import select

from vibrafeed.app.jobs import audit
from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.tables import KEYS
from vibrafeed.core.errors import Problem, VibrafeedError
from vibrafeed.core.suggestions import suggestion

logger = logging.getLogger("vibrafeed.keys")

Role = Literal["read", "run", "admin"]
ROLES = get_args(Role)
NAME = re.compile(r"[A-Za-z0-9._-]{1,40}")
CHECK_INTERVAL = 1.0  # s between looks at the ledger, in which keys may have been made or withdrawn
DAY = 86_400.0  # s
MAX_LIMIT = 10**18  # of a limit: what any database holds
MAX_DAYS = 36_500  # days that a key may be in force: a hundred years


@dataclass(frozen=True)
class Key:
    """A key, of which nothing is kept but a hash.

    Attributes
    ----------
    name : str
        Its owner; empty where no keys are needed.
    role : str
        ``read`` reads, ``run`` also posts and dismisses its own, ``admin`` does all.
    requests, jobs, cells, bytes : int or None
        Most requests a second, jobs at a time, cells of one study, bytes on the disk.
    created, ends, withdrawn : float or None
        When [s since the epoch].
    hash : str
        SHA-256 in hexadecimal.
    """

    name: str
    role: str
    requests: int | None = None
    jobs: int | None = None
    cells: int | None = None
    bytes: int | None = None
    created: float = 0.0
    ends: float | None = None
    withdrawn: float | None = None
    hash: str = ""

    def in_force(self, now: float) -> bool:
        """True if the key is in force at a time."""
        return self.withdrawn is None and (self.ends is None or now < self.ends)

    @property
    def sees_all(self) -> bool:
        """True if the key may also read what belongs to others."""
        return self.role == "admin"


NOBODY = Key("", "admin")  # who asks where no keys are needed


class InvalidKeyError(VibrafeedError):
    """A key cannot be made like this; `problems` holds all that is wrong."""

    def __init__(self, problems: Iterable[Problem]):
        """Keep all problems of the key, and make the message of them."""
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class NoSuchKeyError(VibrafeedError):
    """No key in force has this name."""


def new_key() -> tuple[str, str]:
    """Return a new random key and its hash."""
    key = f"vf_{secrets.token_urlsafe(32)}"
    return key, hash_of(key)


def hash_of(key: str) -> str:
    """Return the SHA-256 of a key; no slow hash is needed for 256 random bits."""
    return hashlib.sha256(key.encode("utf-8", "replace")).hexdigest()


class Keys:
    """The keys of the ledger; threads may use it at the same time.

    Parameters
    ----------
    database : Database
        The ledger's.
    """

    def __init__(self, database: Database):
        """Use the keys of a database."""
        self._database = database
        self._lock = threading.Lock()
        self._known: list[Key] | None = None  # None: never looked
        self._read_at = 0.0

    def add(self, key: Key, days: float | None = None) -> tuple[str, Key]:
        """Store a new API key with the given properties; return its secret text and its record.

        `key` has name, role and limits; `days` is how long it is in force, None for ever.

        Raises
        ------
        InvalidKeyError
            If its name, its role, a limit or the days are not valid, or the name is in use.
        """
        secret, digest = new_key()
        now = time.time()
        problems = _problems_of(key, days)
        with self._database.transaction() as connection:
            if any(other.name == key.name and other.in_force(now) for other in self.all()):
                fix = f"Give another name, or withdraw that key: vibrafeed key withdraw {key.name}"
                problems.append(
                    Problem("name", f"a valid key with the name {key.name!r} exists already", fix)
                )
            if problems:
                raise InvalidKeyError(problems)
            ends = None if days is None else now + days * DAY
            record = replace(key, hash=digest, created=now, ends=ends)
            connection.execute(KEYS.insert().values(id=uuid.uuid4().hex, **vars(record)))
            audit.note(self._database, "", "add key", key.name)
        return secret, record

    def withdraw(self, name: str) -> Key:
        """Withdraw the API key with a name, which is refused from then on; return its record.

        Raises `NoSuchKeyError` if no key in force has the name.
        """
        now = time.time()
        with self._database.transaction() as connection:
            in_force = {key.name: key for key in self.all() if key.in_force(now)}
            if name not in in_force:
                fix = suggestion(name, in_force) if in_force else "There are none"
                raise NoSuchKeyError(f"There is no valid key with the name {name[:40]!r}. {fix}")
            key = replace(in_force[name], withdrawn=now)
            connection.execute(KEYS.update().where(KEYS.c.hash == key.hash).values(withdrawn=now))
            audit.note(self._database, "", "withdraw key", name)
        return key

    def all(self) -> list[Key]:
        """Return all keys in the ledger, including expired and withdrawn ones, oldest first."""
        columns = select(*(column for column in KEYS.c if column.name != "id"))
        rows = self._database.read(columns.order_by(KEYS.c.created, KEYS.c.id))
        return [Key(**row._mapping) for row in rows]

    def note_refused(self, address: str, name: str) -> None:
        """Write into the audit log that a key was refused: its address, and its name if known."""
        audit.note(self._database, name, "refuse key", address)

    # --- what the guard asks

    @property
    def is_due(self) -> bool:
        """True if the keys have to be read from the ledger again."""
        return self._known is None or time.monotonic() - self._read_at > CHECK_INTERVAL

    @property
    def is_known(self) -> bool:
        """True if the keys have been read from the ledger."""
        return self._known is not None

    @property
    def is_fresh(self) -> bool:
        """True if the keys were read from the ledger within the last moments."""
        return self._known is not None and time.monotonic() - self._read_at < 2 * CHECK_INTERVAL

    def refresh(self) -> None:
        """Read the keys from the ledger, unless they were read within the last second.

        If the ledger cannot be read, the known keys stay; without any the error is raised.
        """
        with self._lock:
            if not self.is_due:
                return
            try:
                self._known = self.all()
            except Exception:
                if self._known is None:  # it may need keys
                    raise
                logger.exception("keys cannot be read")
            self._read_at = time.monotonic()

    @property
    def are_needed(self) -> bool:
        """True if requests need a key: one exists or has ever existed."""
        return bool(self._known)

    def of_hash(self, digest: str) -> Key | None:
        """Return the API key with a hash, in force or not; None if there is none.

        `digest` is the SHA-256 of the key's secret text, in hexadecimal.
        """
        match = None
        # Every hash is compared, so that the time taken tells nothing of which one came near.
        for key in self._known or ():
            if secrets.compare_digest(key.hash, digest):
                match = key
        return match


def _problems_of(key: Key, days: float | None) -> list[Problem]:
    problems = []
    if not NAME.fullmatch(key.name):
        fix = "Use 1 to 40 letters, digits, '.', '_' and '-'"
        problems.append(Problem("name", f"{key.name[:60]!r} is not a valid name of a key", fix))
    if key.role not in ROLES:
        fix = f"Choose one of {', '.join(ROLES)}"
        problems.append(Problem("role", f"{key.role[:60]!r} is not a role", fix))
    for name in ("requests", "jobs", "cells", "bytes"):
        limit = getattr(key, name)
        if limit is not None and not 1 <= limit <= MAX_LIMIT:
            fix = "Give a whole number of 1 or more, or leave it out for no limit"
            problems.append(Problem(name, f"{limit:g} is not a valid limit", fix))
    if days is not None and not 0 < days <= MAX_DAYS:
        fix = f"Give more than 0 and at most {MAX_DAYS:,}, or leave it out for a key without end"
        problems.append(Problem("days", f"a key cannot be valid for {days:g} days", fix))
    return problems
