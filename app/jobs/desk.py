"""Where jobs are handed in: the queue, room for them, results that are there already."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from app.jobs import work
from app.jobs.errors import NotFoundError
from app.jobs.ledger import Job, Ledger
from app.jobs.room import Room
from app.jobs.scrub import BROKEN, scrub
from app.jobs.store import Store
from app.jobs.studies import identifier
from app.settings import Settings
from core.errors import StudyError
from core.kinds import KINDS
from core.plan.prepared import Prepared
from core.sweep import Sweep

logger = logging.getLogger("vibrafeed.store")

SCRUBBED = 4_000_000_000  # bytes that a turn of scrubbing reads, or one result more
DAY = 86_400.0
MOST_JOBS = 100_000  # that are over, of which the ledger tells
REPORT_BYTES = 10_000_000  # of an accuracy report


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
    waits : callable
        Tells what work that has not begun waits for, besides its turn.
    """

    def __init__(
        self,
        ledger: Ledger,
        store: Store,
        settings: Settings,
        wake: Callable[[], object],
        waits: Callable[[], str | None] = lambda: None,
    ):
        self.ledger, self.store = ledger, store
        self._settings, self._wake = settings, wake
        self.waits = waits
        self._room = Room(ledger, store, settings)
        self.posted: Callable[[str], object] = lambda key: None  # told before others may claim it
        self._scrubbed = ""  # the study that was looked at last

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
        block_cells, blocks, needed = self._measured(prepared, process)
        self._room.look(key, needed)
        if self.store.manifest(key) is None:
            try:
                self.store.fetch(key)
            except OSError:  # it is computed again, then
                logger.exception("a result cannot be fetched: %s", key)
        # In one transaction, so that what is found here is not removed before the job is entered.
        with self.ledger.transaction():
            manifest = self.store.manifest(key)
            if manifest is None and key not in self.ledger.promised():
                self.ledger.check_queue(self._settings.max_queue)
                self._room.make(key, needed)
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
            if manifest is None:
                self.posted(key)
        self._wake()
        return job

    def mend(self, job: Job) -> bool:
        """Have the result of a job that was successful computed again, if it is there no more.

        Its jobs are accepted again then. Return False if the study itself is gone.

        Raises
        ------
        NoRoomError
            If its result would not fit.
        """
        if self.store.fetch(job.key) is not False:
            return True
        try:
            prepared = self.store.get(job.key)
        except (NotFoundError, StudyError):
            return False
        block_cells, blocks, needed = self._measured(prepared, job.process)
        self._room.look(job.key, needed)
        with self.ledger.transaction():
            if self.store.manifest(job.key) is None:
                if not self.store.used(job.key):  # it has just made room for another
                    return False
                self._room.make(job.key, needed)
                self.ledger.reenter(
                    job.key,
                    job.process,
                    cells=prepared.cells,
                    block_cells=block_cells,
                    blocks=blocks,
                    bytes_=needed,
                )
        logger.warning("a result is computed again: %s", job.key)
        self._wake()
        return True

    def _measured(self, prepared: Prepared, process: str) -> tuple[int, int, int]:
        """Return the cells of a block, the number of blocks, and the bytes that it all takes."""
        cells, blocks = work.blocks(prepared, process, self._settings)
        # Blocks and the result are there at the same time, for a moment.
        needed = prepared.bytes + prepared.computed_bytes if process in KINDS else REPORT_BYTES
        return cells, blocks, needed

    def keep(self, sweep: Sweep) -> tuple[str, bool]:
        """Keep a sweep of which nothing is computed yet; return its identifier, and if it is new.

        Raises
        ------
        NoRoomError
            If the data directory is full.
        """
        key, needed = identifier(sweep.study), len(sweep.study.canonical())
        if self.store.used(key):
            return self.store.add(sweep.study)
        self._room.look(key, needed)
        with self.ledger.transaction():
            self._room.make(key, needed)
            return self.store.add(sweep.study)

    def dismiss(self, number: str) -> Job | None:
        """Dismiss a job; None if there is no such job."""
        job = self.ledger.dismiss(number)
        self._wake()
        return job

    def make_room(self, key: str, needed: int) -> None:
        """Make room for the files of a study; raise `NoRoomError` if they would not fit."""
        self._room.look(key, needed)
        with self.ledger.transaction():
            self._room.make(key, needed)

    def tidy(self) -> None:
        """Remove what nobody uses: old jobs and studies, what killed writers and workers left."""
        before = time.time() - self._settings.retention_days * DAY
        self.ledger.forget(before, MOST_JOBS)
        self.store.remove_leftovers()
        for key in self.store.studies():
            with self.ledger.transaction():
                if key not in self.ledger.promised():
                    self.store.drop_blocks(key)
                    if self.store.used(key) < before:
                        self.store.remove(key)

    def scrub(self, stopped: Callable[[], bool]) -> None:
        """Compare some results with their digests, those after the ones of the last turn.

        What is broken is taken away; it is computed again when it is asked for.
        """
        read = 0
        for found in scrub(self.store, self._scrubbed, stopped):
            self._scrubbed = found.name
            if found.state == BROKEN:
                path = self.store.folder(found.name) / found.files[0]
                self.store.take_away(found.name, path)
            read += found.bytes
            if read >= SCRUBBED:
                return
        self._scrubbed = ""

    def used_bytes(self) -> int:
        """Return what all studies take on the disk, counted a minute ago at most."""
        return self._room.used()
