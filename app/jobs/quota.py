"""The quota of the disk: bytes taken, bytes reserved for work under way, and what makes room."""

from __future__ import annotations

import contextlib
import shutil
import threading
import time
from collections.abc import Mapping

from vibrafeed.app.jobs.errors import NoRoomError
from vibrafeed.app.jobs.keys import NOBODY, Key
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.jobs.ownership import OwnedStudy, Ownership
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings

COUNTED_EVERY = 60.0  # s; counting looks at every file
RIGHT_FOR = 1.0  # s; the largest age of a count before something is refused or removed
SPARE = 0.01  # share of the disk that is left to other programs, at most MAX_SPARE
MAX_SPARE = 100_000_000  # bytes


class Quota:
    """Keeps the data directory within its quota, and some space of the disk free.

    Parameters
    ----------
    ledger, store
        Where reserved bytes and files are kept.
    settings : Settings
        The service's.
    """

    def __init__(self, ledger: Ledger, store: Store, settings: Settings):
        """Keep the store within the settings' quota; nothing is counted yet."""
        self._ledger, self._store, self._settings = ledger, store, settings
        self.ownership = Ownership(ledger.database)
        self._counting = threading.Lock()
        self._counted = -COUNTED_EVERY  # when [s]
        self._sizes: Mapping[str, int] = {}  # bytes of each study then
        self._since: Mapping[str, int] = {}  # most bytes of what was let in since

    def look(self, key: str, needed: int, who: Key = NOBODY) -> None:
        """Count used bytes again if room may be short; slow, so done before a transaction.

        Parameters
        ----------
        key : str
            Identifier of the study that needs room.
        needed : int
            Bytes that its files may take at most.
        who : Key
            The API key of its owner.
        """
        self._count(COUNTED_EVERY)
        promised = self._promised(key, needed)
        if who.bytes is not None:
            self._measure(promised, who)
        if max(*self._lacking(promised), self._beyond(promised, key, who)) > 0:
            self._count(RIGHT_FOR)

    def make(self, key: str, needed: int, who: Key = NOBODY, *, is_there: bool = False) -> None:
        """Remove the least recently used studies until a new one fits; those in work stay.

        An owner's quota is kept by giving up the owner's records that were used longest ago; the
        quota of the service by removing studies that no other owner holds. Call it inside a
        transaction of the ledger, after `look`.

        Parameters
        ----------
        key : str
            Identifier of the new study, which stays too.
        needed : int
            Bytes that all its files may take at most.
        who : Key
            The API key of its owner.
        is_there : bool
            True if the study takes no more of the disk: others have it, or it is promised to them.

        Raises
        ------
        NoRoomError
            If the study does not fit even then; nothing has been removed.
        """
        promised = self._promised(key, needed)
        own = self._own_studies_to_remove(promised, key, who)
        pinned = set()
        if own or max(self._lacking(promised)) > 0:  # long to find out where there is much
            pinned = self.ownership.of_others(who.name)
        leaving = (
            [] if is_there else self._studies_to_remove(promised, needed, pinned, set(own) - pinned)
        )
        for other in own:
            self.ownership.let_go(other, who.name)
        for other in {*leaving, *(set(own) - pinned)}:
            self.remove(other)
        with self._counting:
            gone = {*leaving, *(set(own) - pinned)}
            self._sizes = {k: size for k, size in self._sizes.items() if k not in gone}
            self._since = {k: size for k, size in self._since.items() if k not in gone}
            if not is_there:
                self._since = {**self._since, key: needed}

    def _studies_to_remove(
        self, promised: Mapping[str, int], needed: int, pinned: set[str], own: set[str]
    ) -> list[str]:
        """Return the identifiers of the studies to remove from the disk so that a new one fits.

        Raises `NoRoomError` if they are too few.

        Parameters
        ----------
        promised : mapping
            Bytes reserved for each study in work, the new one included; these stay.
        needed : int
            Bytes that the new study may take at most.
        pinned : set of str
            Studies that other owners hold, which stay.
        own : set of str
            Studies that the owner gives up in any case; they are not in the result.
        """
        quota = self._settings.disk_quota_bytes
        promises = sum(promised.values())
        if promises > quota:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes on disk. The quota of the service "
                f"is {quota:,} bytes, of which {promises - needed:,} are reserved for "
                "running jobs. Post a smaller study, or wait until they end."
            )
        if max(self._lacking(promised)) > 0:
            self._count(RIGHT_FOR)
        in_quota, on_disk = self._lacking(promised)
        leaving, freed = [], sum(self._size(other) for other in own)
        for other in self._store.studies() if in_quota > freed else ():
            if other not in promised and other not in pinned and other not in own:
                leaving.append(other)
                freed += self._size(other)
                if freed >= in_quota:
                    break
        if in_quota > freed and pinned:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes on disk, {in_quota - freed:,} "
                "more than the quota of the service leaves, and none of your own results "
                "can be removed to make room. Post a smaller study."
            )
        if on_disk > freed:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes, {on_disk - freed:,} more than "
                "the disk of the service has free. Post a smaller study."
            )
        return leaving

    def _own_studies_to_remove(self, promised: Mapping[str, int], key: str, who: Key) -> list[str]:
        """Return the studies that an owner gives up so that a new one fits into the owner's quota.

        `promised` holds the bytes reserved for each study in work, that of `key`, the new one,
        included; `who` is the owner's API key. Raises `NoRoomError` if giving up all others is not
        enough.
        """
        if self._beyond(promised, key, who) <= 0:
            return []
        self._count(RIGHT_FOR)
        beyond, leaving = self._beyond(promised, key, who), []
        for held in self.ownership.of_owner(who.name):
            if beyond <= 0:
                break
            if held.key not in promised:
                leaving.append(held.key)
                beyond -= self._charged(held, promised)
        if beyond > 0:
            raise NoRoomError(
                f"The study needs up to {promised[key]:,} bytes; your key may store "
                f"{who.bytes:,} bytes, running jobs included. Post a smaller study, or "
                "dismiss a job."
            )
        return leaving

    def remove(self, key: str) -> None:
        """Remove a study from the disk, and its owners' records."""
        self.ownership.let_go(key)
        self._store.remove(key)

    def _beyond(self, promised: Mapping[str, int], key: str, who: Key) -> int:
        """Return the bytes by which an API key would exceed its quota of storage with a new study.

        The result is negative if there is room, and 0 for a key without quota.

        Parameters
        ----------
        promised : mapping of str to int
            Bytes that the result of each study in work may take, by identifier; the new one is
            included.
        key : str
            Identifier of the new study.
        who : Key
            The API key, whose stored studies are counted.
        """
        if who.bytes is None:
            return 0
        held = self.ownership.of_owner(who.name)
        others = sum(self._charged(one, promised) for one in held if one.key != key)
        return others + promised[key] - who.bytes

    def _measure(self, promised: Mapping[str, int], who: Key) -> None:
        """Measure results of an owner that were finished since all studies were counted.

        Until then such a study counts with the bytes that were reserved for it. `promised` has the
        studies still in work by identifier, which stay as reserved; `who` is the owner's API key.
        """
        held = {one.key for one in self.ownership.of_owner(who.name)}
        made = [key for key in self._since if key in held and key not in promised]
        sizes = {key: self._store.bytes(key) for key in made}
        with self._counting:
            self._since = {**self._since, **sizes}

    def _size(self, key: str) -> int:
        """Return the bytes of a study, from its record or the disk."""
        return self._since.get(key) or self._sizes.get(key, 0)

    def _charged(self, held: OwnedStudy, promised: Mapping[str, int]) -> int:
        """Return the bytes of a study that are charged to its owner.

        These are the study's own if the owner has not asked for a result; else what is reserved for
        its files while it is in work (`promised`), then what they take.
        """
        if not held.result:
            return held.bytes
        return promised.get(held.key) or self._size(held.key) or held.bytes

    def used(self) -> int:
        """Return the bytes of all studies on disk, counted at most a minute ago.

        Studies that were accepted since count with the most that they may take.
        """
        self._count(COUNTED_EVERY)
        return sum({**self._sizes, **self._since}.values())

    def _promised(self, key: str, needed: int) -> dict[str, int]:
        """Return the bytes promised to unfinished work, with those of a new study."""
        return self._ledger.promised() | {key: needed}

    def _lacking(self, promised: Mapping[str, int]) -> tuple[int, int]:
        """Return the bytes that the quota and the disk are short of; negative if there is room.

        `promised` holds the bytes reserved for each study in work. The first result is for the
        quota of the service, the second for the free space of the disk, less a reserve for other
        programs.
        """
        taken = {**self._sizes, **self._since}
        others = sum(size for key, size in taken.items() if key not in promised)
        in_quota = others + sum(promised.values()) - self._settings.disk_quota_bytes
        owed = sum(max(0, size - self._sizes.get(key, 0)) for key, size in promised.items())
        with contextlib.suppress(FileNotFoundError):
            disk = shutil.disk_usage(self._settings.data_directory)
            return in_quota, owed + int(min(SPARE * disk.total, MAX_SPARE)) - disk.free
        return in_quota, 0

    def _count(self, age: float) -> None:
        """Count the bytes of all studies on disk if the last count is older than `age` [s].

        Counting looks at every file, so that callers who only need an estimate accept an older
        count.
        """
        with self._counting:
            if time.monotonic() - self._counted > age:
                self._sizes = {key: self._store.bytes(key) for key in self._store.studies()}
                self._since = {}
                self._counted = time.monotonic()
