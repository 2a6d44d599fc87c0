"""Room on the disk: what is taken, what is promised to work under way, what leaves for it."""

from __future__ import annotations

import contextlib
import shutil
import threading
import time
from collections.abc import Mapping

from app.jobs.errors import NoRoomError
from app.jobs.ledger import Ledger
from app.jobs.store import Store
from app.settings import Settings

COUNTED_EVERY = 60.0  # s; counting looks at every file
RIGHT_FOR = 1.0  # s; a count that something is refused or removed for is no older
SPARE = 0.01  # of the disk, left to others
MOST_SPARE = 100_000_000  # bytes


class Room:
    """Keeps the data directory within its quota, and off the end of the disk.

    Parameters
    ----------
    ledger, store
        Where promises and files are kept.
    settings : Settings
        The service's.
    """

    def __init__(self, ledger: Ledger, store: Store, settings: Settings):
        self._ledger, self._store, self._settings = ledger, store, settings
        self._counting = threading.Lock()
        self._counted = -COUNTED_EVERY  # when [s]
        self._sizes: Mapping[str, int] = {}  # bytes of each study then
        self._since: Mapping[str, int] = {}  # most bytes of what was let in since

    def look(self, key: str, needed: int) -> None:
        """Count anew where it matters; it takes long, and is done before a transaction for that."""
        self._count(COUNTED_EVERY)
        if max(self._lacking(self._promised(key, needed))) > 0:
            self._count(RIGHT_FOR)

    def make(self, key: str, needed: int) -> None:
        """Remove what was used longest ago until a study fits; what is worked on stays.

        To be called inside a transaction of the ledger, after `look`.

        Parameters
        ----------
        key : str
            The study, which stays too.
        needed : int
            Most bytes of all its files.

        Raises
        ------
        NoRoomError
            If they do not fit then; nothing has been removed.
        """
        promised = self._promised(key, needed)
        quota = self._settings.disk_quota_bytes
        promises = sum(promised.values())
        if promises > quota:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes, the quota is {quota:,}, and "
                f"{promises - needed:,} are promised to work under way."
            )
        if max(self._lacking(promised)) > 0:
            self._count(RIGHT_FOR)
        in_quota, on_disk = self._lacking(promised)
        leaving, freed = [], 0
        for other in self._store.studies() if in_quota > 0 else ():
            if other not in promised:
                leaving.append(other)
                freed += self._sizes.get(other, 0)
                if freed >= in_quota:
                    break
        if on_disk > freed:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes; the disk lacks {on_disk - freed:,} of "
                "them, what others were promised left aside."
            )
        for other in leaving:
            self._store.remove(other)
        with self._counting:
            self._sizes = {k: size for k, size in self._sizes.items() if k not in leaving}
            self._since = {**self._since, key: needed}

    def used(self) -> int:
        """Return the bytes of all studies, counted a minute ago at most."""
        self._count(COUNTED_EVERY)
        return sum({**self._sizes, **self._since}.values())

    def _promised(self, key: str, needed: int) -> dict[str, int]:
        return self._ledger.promised() | {key: needed}

    def _lacking(self, promised: Mapping[str, int]) -> tuple[int, int]:
        """Return how many bytes are lacking in the quota and on the disk; negative are left."""
        taken = {**self._sizes, **self._since}
        others = sum(size for key, size in taken.items() if key not in promised)
        in_quota = others + sum(promised.values()) - self._settings.disk_quota_bytes
        owed = sum(max(0, size - self._sizes.get(key, 0)) for key, size in promised.items())
        with contextlib.suppress(FileNotFoundError):
            disk = shutil.disk_usage(self._settings.data_directory)
            return in_quota, owed + int(min(SPARE * disk.total, MOST_SPARE)) - disk.free
        return in_quota, 0

    def _count(self, age: float) -> None:
        """Count the bytes of all studies, if that was longer ago."""
        with self._counting:
            if time.monotonic() - self._counted > age:
                self._sizes = {key: self._store.bytes(key) for key in self._store.studies()}
                self._since = {}
                self._counted = time.monotonic()
