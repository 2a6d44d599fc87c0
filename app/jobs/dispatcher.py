"""Dispatch of the blocks of an item of work to workers, and the writing of its result."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from vibrafeed.app.jobs import work
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.errors import TornBlockError
from vibrafeed.app.jobs.fair_queue import OF_KEY
from vibrafeed.app.jobs.ledger import Ledger, Work
from vibrafeed.app.jobs.process_pool import EndedError, ProcessPool
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.work_progress import WorkProgress
from vibrafeed.app.settings import Settings
from vibrafeed.core.code_version import code_version
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.kinds import KINDS

logger = logging.getLogger("vibrafeed.jobs")
_T = TypeVar("_T")

MAX_TORN = 3  # times that one block is found damaged
MAX_DEATHS = 3  # workers that die of one call
MORE = 4  # ratio of the numbers of blocks of a call and of the one that ended before


class TooLongError(VibrafeedError):
    """A study takes longer than a job may."""


class WorkersDieError(VibrafeedError):
    """A block takes its workers down."""


def owner_of(item: Work) -> str:
    """Return the account that an item of work is charged to: its owner, or itself without keys."""
    return f"{OF_KEY}{item.asker}" if item.asker else item.key


class RunningTime:
    """The time during which workers really work on an item: what waits does not run.

    Parameters
    ----------
    most : float
        Time limit of the item [s].
    limit : asyncio.Timeout
        The timeout that is set off when the running time reaches the limit.
    """

    def __init__(self, most: float, limit: asyncio.Timeout):
        """Limit the working time of an item to `most` seconds, by an asyncio timeout."""
        self._left, self._limit = most, limit
        self._blocks, self._since = 0, 0.0

    def begin(self) -> None:
        """Note that one more worker has begun with a block of the item of work.

        The first worker starts the clock of the item's time limit, which stands while none works on
        it.
        """
        self._blocks += 1
        if self._blocks == 1 and not self._limit.expired():
            self._since = asyncio.get_running_loop().time()
            self._limit.reschedule(self._since + self._left)

    def end(self) -> None:
        """Note that a worker has ended its block of the item of work.

        The last worker stops the clock of the item's time limit, which stands while none works on
        it.
        """
        self._blocks -= 1
        if self._blocks == 0 and not self._limit.expired():
            self._left -= asyncio.get_running_loop().time() - self._since
            self._limit.reschedule(None)


@dataclass
class _Progress:
    """The progress of an item of work.

    Attributes
    ----------
    item : Work
        The item.
    seconds : float
        Expected time of one of its blocks [s]: of the call that ended last, once one has.
    blocks : int
        Number of its blocks in one call of a worker.
    running : RunningTime
        Its running time, against its limit.
    done : int
        Number of its stored blocks.
    began : float
        The `time.monotonic` at which the first block began [s].
    first_note : asyncio.Task or None
        Writes the first note into the ledger, which all others wait for.
    """

    item: Work
    seconds: float
    running: RunningTime
    blocks: int = 1
    done: int = 0
    began: float = 0.0
    first_note: asyncio.Task[None] | None = None


class Dispatcher:
    """Carries out items of work on workers.

    Parameters
    ----------
    ledger, store, workers
        Where progress is noted, where files are, and where the work runs.
    settings : Settings
        The service's.

    Attributes
    ----------
    work_progress : WorkProgress
        Receives reports of finished blocks.
    """

    def __init__(
        self, ledger: Ledger, store: Store, workers: ProcessPool | Cluster, settings: Settings
    ):
        """Dispatch the work of a ledger to workers; results go to the store."""
        self._ledger, self._store, self._workers = ledger, store, workers
        self._settings = settings
        self._directory = str(settings.data_directory.resolve())
        self.work_progress = WorkProgress()

    async def carry_out(self, item: Work, seconds: float) -> None:
        """Compute missing blocks of an item of work and write its result, within the time limit.

        The item is a study that jobs wait for. `seconds` is the expected time of one of its blocks
        [s]. Raises `TooLongError` beyond the time limit of a job; finished blocks are kept. If it
        is cut off, workers are told to stop its blocks.
        """
        most = self._settings.max_job_seconds
        try:
            async with asyncio.timeout(None) as limit:
                await self._compute_and_write(_Progress(item, seconds, RunningTime(most, limit)))
        except TimeoutError as error:
            if not limit.expired():
                raise
            raise TooLongError(
                f"The job was stopped at the service's time limit of {most:g} s. Post its study "
                "again to continue with the blocks that are done."
            ) from error

    async def is_there(self, item: Work) -> bool:
        """True if the complete result of a study exists on disk, so that it need not be computed.

        Blocks that were stored while it was computed are then removed. `item` is the item of work:
        the study that jobs wait for.
        """
        await asyncio.to_thread(self._store.drop_blocks, item.key)
        return await asyncio.to_thread(self._store.manifest, item.key) is not None

    async def _compute_and_write(self, progress: _Progress) -> None:
        """Compute missing blocks of an item and write its result; repeat while any is damaged.

        Writing checks each block and removes damaged ones. Raises `TornBlockError` if the same
        block is damaged for the third time. `progress` has the item and its running time.
        """
        item = progress.item
        about = item.key, item.process, item.block_cells
        spent = item.seconds
        torn: Counter[str] = Counter()
        while True:
            if await self.is_there(item):
                return
            missing = await asyncio.to_thread(
                work.missing_blocks, self._directory, *about, item.blocks
            )
            spent += await self._compute(progress, missing)
            try:
                await self._on_worker(progress, 1, work.write_result, *about, spent)
            except TornBlockError as error:
                torn[str(error)] += 1
                if torn[str(error)] == MAX_TORN:
                    raise
                logger.warning("a block is computed again: %s", error, extra={"key": item.key})
            else:
                return

    async def _compute(self, progress: _Progress, missing: list[int]) -> float:
        """Compute blocks of an item, two calls per worker at a time; return seconds.

        `missing` are the numbers of the blocks. The seconds [s] are summed over all workers;
        `progress`, the ledger and observers are updated after each call. If one fails or this is
        cancelled, the others are cancelled.
        """
        item, total = progress.item, 0.0
        progress.done = max(0, item.blocks - len(missing))
        waiting = deque(missing)
        running: dict[asyncio.Task[list[float]], list[int]] = {}
        finished: set[asyncio.Task[list[float]]] = set()
        try:
            while True:
                # Most of them wait for their turn; no worker is to wait for them.
                calls = 2 * self._workers.fair_queue.slots
                while waiting and len(running) < calls:
                    count = min(progress.blocks, max(1, len(waiting) // calls))
                    indices = [waiting.popleft() for _ in range(count)]
                    call = self._on_worker(
                        progress, count, work.compute_blocks, item.key, item.process,
                        item.block_cells, indices, item.owner, self._settings.block_seconds,
                        code_version(),
                    )  # fmt: skip
                    running[asyncio.create_task(call)] = indices
                if not running:
                    return total
                finished, _ = await asyncio.wait(running, return_when=asyncio.FIRST_COMPLETED)
                seconds: list[float] = []
                for task in finished:
                    indices, took = running.pop(task), task.result()
                    waiting.extendleft(reversed(indices[len(took) :]))
                    self._plan_calls(progress, took)
                    seconds += took
                self.work_progress.computed(item, seconds)
                progress.done += len(seconds)
                total += sum(seconds)
                await self._note(progress, sum(seconds))
        finally:
            if running:  # else they would go on to the end
                self._store.give_up(item.key, item.owner)
            for task in running:
                task.cancel()
            await asyncio.gather(*running, *finished, return_exceptions=True)

    def _plan_calls(self, progress: _Progress, took: list[float]) -> None:
        """Let the next calls of an item have as many blocks as a worker computes in a block's time.

        A call takes some 10 ms of this server and of a worker besides, and blocks that turn out
        shorter than they were priced would take less than that each. `took` are the times of the
        blocks of a call that has ended [s].
        """
        if progress.item.process not in KINDS:  # those of an accuracy report differ
            return
        progress.seconds = sum(took) / len(took)
        fitting = int(self._settings.block_seconds / max(progress.seconds, 1e-6))
        progress.blocks = max(1, min(fitting, MORE * len(took)))

    async def _on_worker(
        self, progress: _Progress, blocks: int, function: Callable[..., _T], *arguments: Any
    ) -> _T:
        """Run a function on a worker when its turn comes, and return its result.

        The time limit of the item runs only while a worker executes the call. A call that is given
        up gets a grace period to end by itself.

        Parameters
        ----------
        progress : _Progress
            The item of work (a study), its running time, and the expected time of one block [s].
        blocks : int
            Number of blocks in whose expected time the call ends.
        function : callable
            A function of `vibrafeed.app.jobs.work`, which is called with the data directory and
            `arguments`.

        Raises
        ------
        WorkersDieError
            If the call crashes its workers.
        """
        has_begun = False

        async def began() -> None:
            """Start the clock of the item, and note in the ledger that it has begun."""
            nonlocal has_begun
            if not has_begun:  # it begins again on another worker, if the first dies
                progress.running.begin()
            has_begun = True
            if progress.first_note is None:
                progress.began = time.monotonic()
                progress.first_note = asyncio.create_task(self._note(progress, 0.0))
            await asyncio.shield(progress.first_note)  # before any other note

        await self._workers.prepare()
        owner, seconds = owner_of(progress.item), blocks * progress.seconds
        async with self._workers.fair_queue.slot(owner, seconds):
            try:
                for _ in range(MAX_DEATHS):
                    with contextlib.suppress(EndedError):  # perhaps of something else
                        return await self._workers(
                            function, self._directory, *arguments,
                            began=began, grace=self._settings.grace_seconds,
                        )  # fmt: skip
            finally:
                if has_begun:
                    progress.running.end()
        raise WorkersDieError(
            "The job failed: a block crashed every worker that ran it, perhaps because memory ran "
            "out. Post a smaller study, or give the workers more memory."
        )

    async def _note(self, progress: _Progress, seconds: float) -> None:
        """Write the number of finished blocks of an item into the ledger, for its jobs to show.

        `seconds` is the computing time since the last note [s], summed over workers. `progress` has
        the item, the number, and when the first block began.
        """
        await asyncio.to_thread(
            self._ledger.advance, progress.item, done=progress.done, seconds=seconds,
            elapsed=time.monotonic() - progress.began,
        )  # fmt: skip
