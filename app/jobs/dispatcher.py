"""Dispatch of the blocks of an item of work to workers, and the writing of its result."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from vibrafeed.app.jobs import work
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.errors import TornBlockError
from vibrafeed.app.jobs.fair_queue import OF_KEY
from vibrafeed.app.jobs.ledger import Ledger, Work
from vibrafeed.app.jobs.process_pool import EndedError, ProcessPool
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings
from vibrafeed.core.code_version import code_version
from vibrafeed.core.errors import VibrafeedError

logger = logging.getLogger("vibrafeed.jobs")
_T = TypeVar("_T")

MAX_TORN = 3  # times that one block is found damaged
MAX_DEATHS = 3  # workers that die of one call


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
    max_seconds : float
        Time limit of the item [s].
    limit : asyncio.Timeout
        The timeout that is set off when the running time reaches the limit.
    """

    def __init__(self, max_seconds: float, limit: asyncio.Timeout):
        """Limit the working time of an item, by an asyncio timeout."""
        self._remaining, self._limit = max_seconds, limit
        self._active_blocks, self._since = 0, 0.0

    def begin(self) -> None:
        """Note that one more worker has begun with a block of the item of work.

        The first worker starts the clock of the item's time limit, which stands while none works on
        it.
        """
        self._active_blocks += 1
        if self._active_blocks == 1 and not self._limit.expired():
            self._since = asyncio.get_running_loop().time()
            self._limit.reschedule(self._since + self._remaining)

    def end(self) -> None:
        """Note that a worker has ended its block of the item of work.

        The last worker stops the clock of the item's time limit, which stands while none works on
        it.
        """
        self._active_blocks -= 1
        if self._active_blocks == 0 and not self._limit.expired():
            self._remaining -= asyncio.get_running_loop().time() - self._since
            self._limit.reschedule(None)


@dataclass
class _Progress:
    """The progress of an item of work.

    Attributes
    ----------
    item : Work
        The item.
    on_block : callable
        Called with the computing time of each block [s].
    running : RunningTime
        Its running time, against its limit.
    done : int
        Number of its stored blocks.
    began : float or None
        The `time.monotonic` at which the first block began [s].
    recording : asyncio.Lock
        Held while the progress is written into the ledger: one note after another.
    """

    item: Work
    on_block: Callable[[float], None]
    running: RunningTime
    done: int = 0
    began: float | None = None
    recording: asyncio.Lock = field(default_factory=asyncio.Lock)


class Dispatcher:
    """Carries out items of work on workers.

    Parameters
    ----------
    ledger, store, workers
        Where progress is noted, where files are, and where the work runs.
    settings : Settings
        The service's.
    """

    def __init__(
        self, ledger: Ledger, store: Store, workers: ProcessPool | Cluster, settings: Settings
    ):
        """Dispatch the work of a ledger to workers; results go to the store."""
        self._ledger, self._store, self._workers = ledger, store, workers
        self._settings = settings
        self._directory = str(settings.data_directory.resolve())

    async def carry_out(self, item: Work, on_block: Callable[[float], None]) -> None:
        """Compute missing blocks of an item of work and write its result, within the time limit.

        The item is a study that jobs wait for; `on_block` is called with the seconds of each block.
        Raises `TooLongError` beyond the time limit of a job; finished blocks are kept.
        """
        max_seconds = self._settings.max_job_seconds
        try:
            async with asyncio.timeout(None) as limit:
                await self._compute_and_write(
                    _Progress(item, on_block, RunningTime(max_seconds, limit))
                )
        except TimeoutError as error:
            if not limit.expired():
                raise
            raise TooLongError(
                f"The job was stopped at the service's time limit of {max_seconds:g} s. Post its "
                "study again to continue with the blocks that are done."
            ) from error

    async def has_result(self, item: Work) -> bool:
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
        study = item.key, item.process, item.block_cells
        seconds = item.seconds
        damages: Counter[str] = Counter()  # by block
        while True:
            if await self.has_result(item):
                return
            missing = await self._on_worker(progress, work.missing_blocks, *study, item.blocks)
            seconds += await self._compute(progress, missing)
            try:
                await self._on_worker(progress, work.write_result, *study, seconds)
            except TornBlockError as error:
                damages[str(error)] += 1
                if damages[str(error)] == MAX_TORN:
                    raise
                logger.warning("a block is computed again: %s", error, extra={"key": item.key})
            else:
                return

    async def _compute(self, progress: _Progress, missing: list[int]) -> float:
        """Compute blocks of an item, two calls per worker at a time; return seconds.

        `missing` are the numbers of the blocks. The seconds [s] are summed over all workers;
        `progress`, the ledger and observers are updated after each block. If one fails or this is
        cancelled, the others are cancelled.
        """
        item = progress.item
        progress.done = max(0, item.blocks - len(missing))
        waiting = iter(missing)  # all calls take the next block from it

        async def compute_blocks() -> float:
            total = 0.0
            for index in waiting:
                seconds = await self._on_worker(
                    progress, work.compute_block, item.key, item.process, item.block_cells, index,
                    code_version(),
                )  # fmt: skip
                progress.on_block(seconds)
                progress.done += 1
                total += seconds
                await self._record(progress, seconds)
            return total

        await self._workers.prepare()
        # Half of them wait for their turn; no worker is to wait for them.
        calls = [
            asyncio.create_task(compute_blocks()) for _ in range(2 * self._workers.fair_queue.slots)
        ]
        try:
            return sum(await asyncio.gather(*calls))
        finally:
            for call in calls:
                call.cancel()
            await asyncio.gather(*calls, return_exceptions=True)

    async def _on_worker(
        self, progress: _Progress, function: Callable[..., _T], *arguments: Any
    ) -> _T:
        """Run a function on a worker when its turn comes, and return its result.

        The time limit of the item runs only while a worker executes the call. A call that is given
        up gets a grace period to end by itself.

        Parameters
        ----------
        progress : _Progress
            The item of work (a study), and its running time.
        function : callable
            A function of `vibrafeed.app.jobs.work`, which is called with the data directory and
            `arguments`.

        Raises
        ------
        WorkersDieError
            If the call crashes its workers.
        """
        has_begun = False

        async def on_start() -> None:
            """Start the clock of the item, and note in the ledger that it has begun."""
            nonlocal has_begun
            if not has_begun:  # the call starts again on another worker, if the first dies
                progress.running.begin()
            has_begun = True
            if progress.began is None:
                progress.began = time.monotonic()
                await self._record(progress, 0.0)

        await self._workers.prepare()
        item = progress.item
        seconds = item.price / max(1, item.blocks)
        async with self._workers.fair_queue.slot(owner_of(item), seconds):
            try:
                for _ in range(MAX_DEATHS):
                    with contextlib.suppress(EndedError):  # perhaps of something else
                        return await self._workers(
                            function, self._directory, *arguments,
                            on_start=on_start, grace=self._settings.grace_seconds,
                        )  # fmt: skip
            finally:
                if has_begun:
                    progress.running.end()
        raise WorkersDieError(
            "The job failed: a block crashed every worker that ran it, perhaps because memory ran "
            "out. Post a smaller study, or give the workers more memory."
        )

    async def _record(self, progress: _Progress, seconds: float) -> None:
        """Write the number of finished blocks of an item into the ledger, for its jobs to show.

        `seconds` is the computing time since the last note [s], summed over workers. `progress` has
        the item, the number, and when the first block began.
        """
        assert progress.began is not None
        async with progress.recording:
            await asyncio.to_thread(
                self._ledger.advance, progress.item, done=progress.done, seconds=seconds,
                elapsed=time.monotonic() - progress.began,
            )  # fmt: skip
