"""The quota of the disk and of each owner: what is taken, what is promised, what makes room.

All of it is counted in the ledger, so that several servers count the same: a study takes the bytes
that it was let in with, until they are measured.
"""

from __future__ import annotations

import contextlib
import shutil
import time
from typing import Any

from sqlalchemy import Row, case, func, select

from vibrafeed.app.jobs.errors import NoRoomError
from vibrafeed.app.jobs.keys import NOBODY, Key
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.jobs.ownership import Ownership
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.tables import OWNED_STUDIES, SIZES, WORK
from vibrafeed.app.settings import Settings

MAX_AGE = 1.0  # s; the largest age of a measurement before something is refused or removed
SPARE = 0.01  # share of the disk that is left to other programs, at most MAX_SPARE
MAX_SPARE = 100_000_000  # bytes

# What an owner is charged for a study: the study's own bytes, if no result was asked for; else what
# is promised for its files while it is in work, then what they take.
_CHARGED = case(
    (OWNED_STUDIES.c.result == 0, OWNED_STUDIES.c.bytes),
    else_=func.coalesce(WORK.c.bytes, SIZES.c.bytes, OWNED_STUDIES.c.bytes),
)
_CHARGES = (
    select(OWNED_STUDIES.c.key, _CHARGED.label("bytes"), WORK.c.key.label("in_work"))
    .select_from(
        OWNED_STUDIES.outerjoin(WORK, WORK.c.key == OWNED_STUDIES.c.key).outerjoin(
            SIZES, SIZES.c.key == OWNED_STUDIES.c.key
        )
    )
    .order_by(OWNED_STUDIES.c.used, OWNED_STUDIES.c.key)
)


class Quota:
    """Keeps the data directory within its quota, and some space of the disk free.

    Parameters
    ----------
    ledger, store
        Where bytes are counted, and where files are kept.
    settings : Settings
        The service's.
    """

    def __init__(self, ledger: Ledger, store: Store, settings: Settings):
        """Keep the store within the settings' quota; nothing is measured yet."""
        self._ledger, self._store, self._settings = ledger, store, settings
        self.ownership = Ownership(ledger.database)
        self._measured: float | None = None  # when [s, monotonic]

    def measure_if_short(self, key: str, needed: int, api_key: Key = NOBODY) -> None:
        """Measure all studies if room may be short; slow, so done before a transaction.

        Parameters
        ----------
        key : str
            Identifier of the study that needs room.
        needed : int
            Bytes that its files may take at most.
        api_key : Key
            The API key of its owner.
        """
        if self._measured is None:
            self.measure()
        missing = max(*self._missing_bytes(key, needed), self._bytes_beyond(key, needed, api_key))
        if missing > 0 and time.monotonic() - (self._measured or 0.0) > MAX_AGE:
            self.measure()

    def make_room(
        self, key: str, needed: int, api_key: Key = NOBODY, *, is_there: bool = False
    ) -> None:
        """Remove the least recently used studies until a new one fits; those in work stay.

        An owner's quota is kept by giving up the owner's records that were used longest ago; the
        quota of the service by removing studies that no other owner holds. Call it inside a
        transaction of the ledger, after `measure_if_short`.

        Parameters
        ----------
        key : str
            Identifier of the new study, which stays too.
        needed : int
            Bytes that all its files may take at most.
        api_key : Key
            The API key of its owner.
        is_there : bool
            True if the study takes no more of the disk: others have it, or it is promised to them.

        Raises
        ------
        NoRoomError
            If the study does not fit even then; nothing has been removed.
        """
        released = self._own_studies_to_release(key, needed, api_key)
        # Studies that others own too stay on the disk.
        removed = set(released) - self.ownership.of_others(api_key.name) if released else set()
        if not is_there:
            removed |= self._studies_to_remove(key, needed, api_key, removed)
        for study in released:
            self.ownership.release(study, api_key.name)
        for study in removed:
            self.remove(study)
        if not is_there:
            self._note_size(key, needed)

    def measure_one(self, key: str) -> None:
        """Measure a study that is no longer in work."""
        self._note_size(key, self._store.bytes(key))

    def remove(self, key: str) -> None:
        """Remove a study from the disk, and what the ledger has on its owners and its size."""
        self.ownership.release(key)
        with self._ledger.transaction() as connection:
            connection.execute(SIZES.delete().where(SIZES.c.key == key))
        self._store.remove(key)

    def measure(self) -> None:
        """Measure all studies on the disk; it looks at every file."""
        sizes = [{"key": key, "bytes": self._store.bytes(key)} for key in self._store.studies()]
        with self._ledger.transaction() as connection:
            connection.execute(SIZES.delete())
            if sizes:
                connection.execute(SIZES.insert(), sizes)
        self._measured = time.monotonic()

    def used(self) -> int:
        """Return the bytes of all studies; those not measured since count with their most."""
        [(used,)] = self._ledger.database.read(select(func.coalesce(func.sum(SIZES.c.bytes), 0)))
        return int(used)

    def _note_size(self, key: str, size: int) -> None:
        with self._ledger.transaction() as connection:
            connection.execute(SIZES.delete().where(SIZES.c.key == key))
            connection.execute(SIZES.insert().values(key=key, bytes=size))

    def _studies_to_remove(
        self, key: str, needed: int, api_key: Key, removed: set[str]
    ) -> set[str]:
        """Return the studies to remove from the disk so that a new one fits.

        `removed` are those that the owner gives up in any case. Raises `NoRoomError` if all are too
        few.
        """
        quota = self._settings.disk_quota_bytes
        promised = {**self._ledger.promised(), key: needed}
        if sum(promised.values()) > quota:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes on disk. The quota of the service "
                f"is {quota:,} bytes, of which {sum(promised.values()) - needed:,} are reserved "
                "for running jobs. Post a smaller study, or wait until they end."
            )
        missing_in_quota, missing_on_disk = self._missing_bytes(key, needed)
        if max(missing_in_quota, missing_on_disk) <= 0:
            return set()
        sizes = {row.key: row.bytes for row in self._ledger.database.read(select(SIZES))}
        of_others = self.ownership.of_others(api_key.name)
        staying = {*promised, *of_others, *removed}
        to_remove, freed = set(), sum(sizes.get(study, 0) for study in removed)
        for study in self._store.studies():  # least recently used first
            if freed >= missing_in_quota:
                break
            if study not in staying:
                to_remove.add(study)
                freed += sizes.get(study, 0)
        if missing_in_quota > freed and of_others:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes on disk, {missing_in_quota - freed:,} "
                "more than the quota of the service leaves, and none of your own results "
                "can be removed to make room. Post a smaller study."
            )
        if missing_on_disk > freed:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes, {missing_on_disk - freed:,} more than "
                "the disk of the service has free. Post a smaller study."
            )
        return to_remove

    def _own_studies_to_release(self, key: str, needed: int, api_key: Key) -> list[str]:
        """Return the studies that an owner gives up so that a new one fits into the owner's quota.

        The arguments are those of `make_room`. Raises `NoRoomError` if giving up all others is not
        enough.
        """
        beyond, to_release = self._bytes_beyond(key, needed, api_key), []
        for study in self._charges(key, api_key) if beyond > 0 else ():
            if beyond > 0 and study.in_work is None:
                to_release.append(study.key)
                beyond -= study.bytes
        if beyond > 0:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes; your key may store "
                f"{api_key.bytes:,} bytes, running jobs included. Post a smaller study, or "
                "dismiss a job."
            )
        return to_release

    def _bytes_beyond(self, key: str, needed: int, api_key: Key) -> int:
        """Return the bytes beyond the quota of a key; negative if there is room, 0 without one."""
        if api_key.bytes is None:
            return 0
        return sum(study.bytes for study in self._charges(key, api_key)) + needed - api_key.bytes

    def _charges(self, key: str, api_key: Key) -> list[Row[*tuple[Any, ...]]]:
        """Return the charges of an owner for all studies but one, least recently used first."""
        others = _CHARGES.where(OWNED_STUDIES.c.owner == api_key.name, OWNED_STUDIES.c.key != key)
        return self._ledger.database.read(others)

    def _missing_bytes(self, key: str, needed: int) -> tuple[int, int]:
        """Return the bytes that the quota and the disk are short of; negative if there is room.

        The second is for the free space of the disk, less a reserve for other programs.
        """
        others = select(WORK.c.bytes, WORK.c.done, WORK.c.blocks).where(WORK.c.key != key)
        in_work = self._ledger.database.read(others)
        is_idle = SIZES.c.key.not_in(select(WORK.c.key)) & (SIZES.c.key != key)
        idle = select(func.coalesce(func.sum(SIZES.c.bytes), 0)).where(is_idle)
        [(idle_bytes,)] = self._ledger.database.read(idle)
        promised = sum(row.bytes for row in in_work) + needed
        missing_in_quota = int(idle_bytes) + promised - self._settings.disk_quota_bytes
        # The blocks that are written of a promise take room already: only the rest needs more.
        unwritten = needed + sum(row.bytes * (1 - row.done / max(1, row.blocks)) for row in in_work)
        with contextlib.suppress(FileNotFoundError):
            disk = shutil.disk_usage(self._settings.data_directory)
            reserve = min(SPARE * disk.total, MAX_SPARE)
            return missing_in_quota, int(unwritten + reserve) - disk.free
        return missing_in_quota, 0
