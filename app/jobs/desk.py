"""Where jobs are handed in: room on the disk, the queue, results that are there already."""

from __future__ import annotations

import contextlib
import shutil
import threading
import time
from collections.abc import Callable, Mapping

from app.exceptions import NoRoomError
from app.jobs import work
from app.jobs.ledger import Job, Ledger
from app.settings import Settings
from app.store import Store, identifier
from core.kinds import KINDS
from core.sweep import Sweep
from core.sweep.pieces import Cut
from core.sweep.prepare import Prepared

DAY = 86_400.0
COUNTED_EVERY = 60.0  # s; counting looks at every file
MOST_JOBS = 100_000  # that are over, of which the ledger tells
REPORT_BYTES = 10_000_000  # of an accuracy report
SPARE = 0.01  # of the disk, left to others
MOST_SPARE = 100_000_000  # bytes


class Desk:
    """Takes jobs in, and keeps the data directory within its limits.

    Parameters
    ----------
    ledger, store
        Where jobs and their files are kept.
    settings : Settings
        The service's.
    wake : callable
        Tells whoever works that the queue has changed.
    """

    def __init__(
        self, ledger: Ledger, store: Store, settings: Settings, wake: Callable[[], object]
    ):
        self.ledger, self.store = ledger, store
        self._settings, self._wake = settings, wake
        self._counting = threading.Lock()
        self._counted = -COUNTED_EVERY  # when the bytes were counted [s]
        self._sizes: dict[str, int] = {}  # bytes of each study then, and what was let in since

    def post(self, prepared: Prepared, process: str) -> Job:
        """Enter a job for a study; it is on the disk when this returns.

        Raises
        ------
        NoRoomError
            If its result would not fit.
        QueueFullError
            If too much is waiting.
        """
        key = identifier(prepared.study, process)
        block_cells = work.block_cells(prepared, self._settings.block_seconds)
        blocks = len(Cut(prepared, block_cells)) if process in KINDS else 0
        # Blocks and the result are there at the same time, for a moment.
        needed = 2 * prepared.bytes if process in KINDS else REPORT_BYTES
        self._count()
        # In one transaction, so that what is found here is not removed before the job is entered.
        with self.ledger.transaction():
            manifest = self.store.manifest(key)
            if manifest is None and key not in self.ledger.promised():
                self.ledger.check_queue(self._settings.max_queue)
                self._make_room(key, needed)
                self.store.add(prepared.study, process)
            job = self.ledger.post(
                key,
                process,
                cells=prepared.cells,
                block_cells=block_cells,
                blocks=blocks,
                bytes_=needed,
                finished_seconds=None if manifest is None else manifest.seconds,
            )
        self._wake()
        return job

    def keep(self, sweep: Sweep) -> tuple[str, bool]:
        """Keep a sweep of which nothing is computed yet; return its identifier, and if it is new.

        Raises
        ------
        NoRoomError
            If the data directory is full.
        """
        key = identifier(sweep.study)
        self._count()
        with self.ledger.transaction():
            if not self.store.used(key):
                self._make_room(key, len(sweep.study.canonical()))
            return self.store.add(sweep.study)

    def dismiss(self, number: str) -> Job | None:
        """Dismiss a job; None if there is no such job."""
        job = self.ledger.dismiss(number)
        self._wake()
        return job

    def make_room(self, key: str, needed: int) -> None:
        """Remove what was used longest ago until a study fits; what is worked on stays.

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
        self._count()
        with self.ledger.transaction():
            self._make_room(key, needed)

    def _make_room(self, key: str, needed: int) -> None:
        promised = self.ledger.promised() | {key: needed}
        with self._counting:
            sizes = dict(self._sizes)
        taken = sum(size for other, size in sizes.items() if other not in promised)
        promises = sum(promised.values())
        quota = self._settings.disk_quota_bytes
        if promises > quota:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes, the quota is {quota:,}, and "
                f"{promises - needed:,} are promised to work under way."
            )
        leaving, freed = [], 0
        if taken + promises > quota:
            for other in self.store.studies():
                if other not in promised:
                    leaving.append(other)
                    freed += sizes.get(other, 0)
                    if taken + promises - freed <= quota:
                        break
        self._check_disk(needed, freed, promised, sizes)
        for other in leaving:
            self.store.remove(other)
        with self._counting:
            for other in leaving:
                self._sizes.pop(other, None)
            self._sizes[key] = needed

    def _check_disk(
        self, needed: int, freed: int, promised: Mapping[str, int], sizes: Mapping[str, int]
    ) -> None:
        """Raise `NoRoomError` if the disk lacks the room, others' promises kept."""
        with contextlib.suppress(FileNotFoundError):
            disk = shutil.disk_usage(self._settings.data_directory)
            free = disk.free - min(SPARE * disk.total, MOST_SPARE) + freed
            missing = sum(max(0, size - sizes.get(key, 0)) for key, size in promised.items())
            if missing > free:
                raise NoRoomError(
                    f"The study needs up to {needed:,} bytes; the disk has {disk.free:,} left."
                )

    def _count(self) -> None:
        """Count the bytes of all studies, if that was long ago."""
        with self._counting:
            if time.monotonic() - self._counted > COUNTED_EVERY:
                self._sizes = {key: self.store.bytes(key) for key in self.store.studies()}
                self._counted = time.monotonic()

    def tidy(self) -> None:
        """Remove what nobody uses: old jobs and studies, what killed writers and workers left."""
        before = time.time() - self._settings.retention_days * DAY
        self.ledger.forget(before, MOST_JOBS)
        self.store.sweep_up()
        for key in self.store.studies():
            with self.ledger.transaction():
                if key not in self.ledger.promised():
                    self.store.drop_blocks(key)
                    if self.store.used(key) < before:
                        self.store.remove(key)
