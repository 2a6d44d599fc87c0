"""Where jobs are handed in: room on the disk, the queue, results that are there already."""

from __future__ import annotations

import contextlib
import shutil
import time
from collections.abc import Callable

from app.exceptions import NoRoomError
from app.jobs import work
from app.jobs.ledger import Job, Ledger
from app.settings import Settings
from app.store import Store, identifier
from core.kinds import KINDS
from core.sweep.pieces import Cut
from core.sweep.prepare import Prepared

DAY = 86_400.0
COUNTED_EVERY = 60.0  # s; counting looks at every file
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
        self._known = (-COUNTED_EVERY, 0)  # when the bytes were counted [s], and how many

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
        manifest = self.store.manifest(key)
        if manifest is None:
            # Blocks and the result are there at the same time, for a moment.
            self.make_room(2 * prepared.bytes if process in KINDS else REPORT_BYTES)
        self.store.add(prepared.study, process)
        block_cells = work.block_cells(prepared, self._settings.block_seconds)
        blocks = len(Cut(prepared, block_cells)) if process in KINDS else 0
        job = self.ledger.post(
            key,
            process,
            cells=prepared.cells,
            block_cells=block_cells,
            blocks=blocks,
            finished_seconds=None if manifest is None else manifest.seconds,
            most_waiting=self._settings.max_queue,
        )
        self._wake()
        return job

    def dismiss(self, number: str) -> Job | None:
        """Dismiss a job; None if there is no such job."""
        job = self.ledger.dismiss(number)
        self._wake()
        return job

    def make_room(self, needed: int) -> None:
        """Remove what was used longest ago until so many bytes fit; what is worked on stays.

        Raises
        ------
        NoRoomError
            If they do not fit then.
        """
        quota = self._settings.disk_quota_bytes
        taken = self._taken()
        if taken + needed > quota:
            taken = self._taken(anew=True)
            wanted = self.ledger.wanted()
            for key in self.store.studies():
                if taken + needed <= quota:
                    break
                if key not in wanted:
                    taken -= self.store.bytes(key)
                    self.store.remove(key)
        if taken + needed > quota:
            raise NoRoomError(
                f"The study needs up to {needed:,} bytes, the quota is {quota:,}, and "
                f"{taken:,} are taken by work under way."
            )
        self._known = (self._known[0], taken + needed)
        with contextlib.suppress(FileNotFoundError):
            disk = shutil.disk_usage(self._settings.data_directory)
            if needed + min(SPARE * disk.total, MOST_SPARE) > disk.free:
                raise NoRoomError(
                    f"The study needs up to {needed:,} bytes; the disk has {disk.free:,} left."
                )

    def _taken(self, *, anew: bool = False) -> int:
        """Return the bytes taken; what was promised since they were last counted is added."""
        at, taken = self._known
        if anew or time.monotonic() - at > COUNTED_EVERY:
            taken = self.store.bytes()
            self._known = (time.monotonic(), taken)
        return taken

    def tidy(self) -> None:
        """Remove jobs and studies that nobody has used for the time of retention."""
        before = time.time() - self._settings.retention_days * DAY
        self.ledger.forget(before)
        wanted = self.ledger.wanted()
        for key in self.store.studies():
            if key not in wanted and self.store.used(key) < before:
                self.store.remove(key)
