"""Has the blocks of an item of work computed on Dask, and its result written."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections import Counter
from typing import TYPE_CHECKING, Any

from app.jobs import work
from app.jobs.aside import Aside
from app.jobs.cluster import Cluster, by_name
from app.jobs.errors import TornBlockError
from app.jobs.ledger import Ledger, Work
from app.jobs.store import Store
from app.settings import Settings
from core.errors import VibrafeedError

if TYPE_CHECKING:
    from distributed import Client

logger = logging.getLogger("vibrafeed.jobs")

LOOK_AT_WORKERS = 5.0  # s between looks at whether there are some, while none has finished
MOST_TORN = 3  # times that one block is found damaged


class LostError(VibrafeedError):
    """The cluster is gone, or what else soon comes back; the study is not to blame."""


class TooLongError(VibrafeedError):
    """A study takes longer than a job may."""


class WorkersDieError(VibrafeedError):
    """A block takes its workers down."""


class Carrier:
    """Carries out items of work on a cluster.

    Parameters
    ----------
    ledger, store, cluster
        Where progress is noted, where files are, and where the work runs.
    aside : Aside
        Runs what waits for the ledger or the disk.
    settings : Settings
        The service's.

    Attributes
    ----------
    trouble : str or None
        What keeps the work from being carried out.
    """

    def __init__(
        self, ledger: Ledger, store: Store, cluster: Cluster, aside: Aside, settings: Settings
    ):
        self._ledger, self._store, self._cluster = ledger, store, cluster
        self._aside, self._settings = aside, settings
        self._directory = str(settings.data_directory.resolve())
        self._workers = 0  # when they were last looked at
        self.trouble: str | None = None

    async def carry_out(self, item: Work) -> None:
        """Have the missing blocks of an item computed, then its result written, within its time."""
        most = self._settings.max_job_seconds
        try:
            async with asyncio.timeout(most) as limit:
                try:
                    await self._compute_and_write(item)
                except BaseException:
                    self._store.give_up(item.key, item.owner)
                    raise
        except TimeoutError as error:
            if not limit.expired():
                raise
            raise TooLongError(
                f"It was stopped after {most:g} s. Posted again, it goes on with the blocks that "
                "are done."
            ) from error

    async def _compute_and_write(self, item: Work) -> None:
        key, cells = item.key, item.block_cells
        spent = item.seconds
        torn: Counter[str] = Counter()
        while True:
            if await self.is_there(item):
                return
            missing = await self._aside(
                work.missing_blocks, self._directory, key, item.process, cells, item.blocks
            )
            spent += await self._compute(item, missing)
            try:
                await self._on_worker(work.write_result, key, item.process, cells, spent)
            except TornBlockError as error:
                torn[str(error)] += 1
                if torn[str(error)] == MOST_TORN:
                    raise
                logger.warning("a block is computed again: %s", error, extra={"key": key})
            else:
                await self._send(item)
                return

    async def is_there(self, item: Work) -> bool:
        """Return whether a result is there; blocks that a late worker left go then."""
        await self._aside(self._store.drop_blocks, item.key)
        if await self._aside(self._store.manifest, item.key) is None:
            return False
        await self._send(item)
        return True

    async def _send(self, item: Work) -> None:
        """Send a result to where results are kept besides."""
        try:
            await asyncio.to_thread(self._store.send, item.key)
        except OSError as error:
            raise LostError(f"the result cannot be sent: {error}") from error

    async def _compute(self, item: Work, missing: list[int]) -> float:
        """Have blocks computed, a few at a time; return the seconds that they took."""
        done, total = item.blocks - len(missing), 0.0
        await self._aside(self._ledger.advance, item, done=done, seconds=0.0)
        waiting = iter(missing)
        running: set[asyncio.Task[float]] = set()
        finished: set[asyncio.Task[float]] = set()
        try:
            while True:
                for index in waiting:
                    block = self._on_worker(
                        work.compute_block, item.key, item.process, item.block_cells, index,
                        item.owner,
                    )  # fmt: skip
                    running.add(asyncio.create_task(block))
                    # Enough to keep workers busy, few enough for other jobs to have a turn.
                    if len(running) >= max(1, 2 * self._workers):
                        break
                if not running:
                    return total
                finished, running = await asyncio.wait(running, return_when=asyncio.FIRST_COMPLETED)
                seconds = sum(task.result() for task in finished)
                done, total = done + len(finished), total + seconds
                await self._aside(self._ledger.advance, item, done=done, seconds=seconds)
        finally:
            for task in running:
                task.cancel()
            await asyncio.gather(*running, *finished, return_exceptions=True)

    async def _on_worker(self, function: Any, *arguments: Any) -> float:
        """Run a function of `app.jobs.work` on the cluster."""
        client = await self._client()
        from distributed import KilledWorker
        from distributed.client import FutureCancelledError
        from distributed.comm.core import CommClosedError

        future = client.submit(by_name(function), self._directory, *arguments, pure=False)
        result = asyncio.create_task(_result_of(future))
        try:
            while not (await asyncio.wait([result], timeout=LOOK_AT_WORKERS))[0]:
                await self._client()
            return result.result()
        except KilledWorker as error:
            raise WorkersDieError(
                "A block took down each worker that it was given to, perhaps for want of memory."
            ) from error
        except (FutureCancelledError, CommClosedError) as error:
            raise LostError(f"{type(error).__name__}: {error}") from error
        except asyncio.CancelledError:
            await _cancel(future)
            raise
        finally:
            result.cancel()
            await asyncio.gather(result, return_exceptions=True)

    async def _client(self) -> Client:
        """Return the connection; note how many workers there are, or why there are none."""
        try:
            client = await self._cluster.client()
            self._workers = await self._cluster.workers()
        except Exception as error:  # of many kinds: no scheduler, no worker process
            self.trouble = f"the workers cannot be reached: {type(error).__name__}"
            raise LostError(str(error)) from error
        self.trouble = None if self._workers else "there are no workers"
        return client


async def _result_of(future: Any) -> float:
    seconds: float = await future
    return seconds


async def _cancel(future: Any) -> None:
    with contextlib.suppress(Exception):
        await future.cancel()
