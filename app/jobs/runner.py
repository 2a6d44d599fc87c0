"""Carries out the ledger's work on Dask, and resumes what a killed server has left."""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import functools
import logging
import os
import socket
import sqlite3
import time
import uuid
from collections import Counter
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, TypeVar

from app.errors import passes, storage_problem
from app.exceptions import OtherVersionError, TornBlockError
from app.jobs import work
from app.jobs.cluster import Cluster, by_name
from app.jobs.ledger import Ledger, Work
from app.settings import Settings
from app.store import Store
from core.errors import VibrafeedError

if TYPE_CHECKING:
    from distributed import Client

logger = logging.getLogger("vibrafeed.jobs")

POLL = 0.5  # s between looks at the ledger, in which other servers may have entered work
RETRY = 2.0  # s before a lost scheduler is tried again
LOOK = 1.0  # s between looks at whether work is still wanted
LOOK_AT_WORKERS = 5.0  # s between looks at whether there are some, while none has finished
THREADS = 2  # that wait for the ledger; downloads, which have the others, cannot make a lease late
MOST_TORN = 3  # times that one block is found damaged

_T = TypeVar("_T")


class Runner:
    """Claims work, has its blocks computed, and notes progress; one for each server.

    Parameters
    ----------
    ledger, store, cluster
        Where work is kept, where its files are, and where it runs.
    settings : Settings
        The service's.
    """

    def __init__(self, ledger: Ledger, store: Store, cluster: Cluster, settings: Settings):
        self._ledger, self._store, self._cluster = ledger, store, cluster
        self._settings = settings
        self._directory = str(settings.data_directory.resolve())
        self._server = f"{socket.gethostname()} {os.getpid()} {uuid.uuid4().hex[:8]}"
        self._threads = ThreadPoolExecutor(THREADS, thread_name_prefix="jobs")
        self._loop: asyncio.AbstractEventLoop | None = None
        self._wake = asyncio.Event()
        self._active: dict[str, asyncio.Task[None]] = {}
        self._main: asyncio.Task[None] | None = None
        self._alone: IO[bytes] | None = None
        self._trouble: str | None = None
        self._workers = 0  # when they were last looked at

    async def start(self) -> None:
        """Clear up what a killed server has left, and begin to work."""
        self._loop = asyncio.get_running_loop()
        await self._aside(self._clear_up)
        self._main = asyncio.create_task(self._run(), name="jobs")

    async def stop(self) -> None:
        """Stop; what is under way goes on with the next server, where it was."""
        tasks = [task for task in (self._main, *self._active.values()) if task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        try:
            await self._aside(self._ledger.release, self._server)
        except Exception:  # such as a full disk: the leases run out
            logger.exception("leases cannot be given up")
        try:
            await self._cluster.close()
        except Exception:
            logger.exception("the cluster did not close")
        self._threads.shutdown()
        if self._alone is not None:
            self._alone.close()

    def wake(self) -> None:
        """Tell, from any thread, that there is new work or less of it."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._wake.set)

    def wrong(self) -> str | None:
        """Return what keeps jobs from being carried out, or None."""
        if self._main is None or self._main.done():
            return "no work is looked for"
        return self._trouble

    def _clear_up(self) -> None:
        """Take over at once, if no other server uses the directory; leases say nothing then."""
        path = Path(self._directory)
        path.mkdir(parents=True, exist_ok=True)
        self._alone = (path / ".lock").open("ab")
        try:
            fcntl.flock(self._alone, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            fcntl.flock(self._alone, fcntl.LOCK_SH)
            return
        self._ledger.release()
        count = self._store.sweep_up(0)
        if count:
            logger.info("files of killed writers removed", extra={"count": count})
        fcntl.flock(self._alone, fcntl.LOCK_SH)

    async def _run(self) -> None:
        while True:
            try:
                await self._claim_some()
            except Exception:
                logger.exception("the ledger cannot be read")
            self._wake.clear()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._wake.wait(), POLL)

    async def _claim_some(self) -> None:
        while len(self._active) < self._settings.concurrent_jobs:
            lease = self._settings.lease_seconds
            item = await self._aside(self._ledger.claim, self._server, lease)
            if item is None:
                if not self._active:  # nothing waits for the workers
                    self._trouble = None
                return
            self._active[item.owner] = asyncio.create_task(self._keep(item), name=item.key)

    async def _keep(self, item: Work) -> None:
        """Carry out an item for as long as its lease is ours."""
        about = {"key": item.key, "kind": item.process, "blocks": item.blocks}
        carrying = asyncio.create_task(self._carry_out(item))
        try:
            logger.info("work started", extra=about)
            await self._hold(item, carrying)
            if not carrying.done():
                logger.info("work given up", extra=about)
                return
            problem = await self._problem_of(carrying)
            if problem is not None and await self._is_there(item):
                problem = None  # another server, which took this one for dead, has finished it
            if problem is None:
                await self._aside(self._ledger.succeed, item)
                logger.info("work done", extra=about)
            else:
                await self._aside(self._ledger.fail, item, problem)
        except _Lost as lost:
            logger.warning("work is tried again: %s", lost, extra=about)
            await asyncio.sleep(RETRY)
            await self._aside(self._ledger.release, item.owner)
        except Exception:
            # Such as a ledger on a full disk: the lease runs out, and the work is tried again.
            logger.exception("work interrupted", extra=about)
        finally:
            carrying.cancel()
            await asyncio.gather(carrying, return_exceptions=True)
            self._active.pop(item.owner, None)
            self._wake.set()

    async def _hold(self, item: Work, carrying: asyncio.Task[None]) -> None:
        """Keep the lease until work ends; return before that if it is lost or not wanted."""
        lease = self._settings.lease_seconds
        renewed = time.monotonic()
        while not carrying.done():
            await asyncio.wait([carrying], timeout=min(LOOK, lease / 4))
            if carrying.done() or not await self._aside(self._ledger.holds, item):
                return
            if time.monotonic() - renewed > lease / 4:
                renewed = time.monotonic()
                if not await self._aside(self._ledger.renew, item, lease):
                    return

    async def _problem_of(self, carrying: asyncio.Task[None]) -> Mapping[str, Any] | None:
        """Return why work failed as parts of a problem document; None if it did not."""
        try:
            await carrying
        except (_Lost, sqlite3.OperationalError):  # the study is not to blame: it is tried again
            raise
        except _TooLongError as error:
            return _problem(422, "limit", "The study takes longer than this service allows", error)
        except OtherVersionError as error:
            return _problem(409, "version", "The study is another version's", error)
        except TornBlockError as error:
            logger.exception("storage failed")
            return _problem(507, "storage", "The disk does not keep what is written", error)
        except OSError as error:
            if passes(error):
                raise _Lost(str(error)) from error
            logger.exception("storage failed")
            return storage_problem(error)
        except _WorkersDieError as error:
            return _problem(500, "workers", "The workers do not survive the study", error)
        except Exception:
            logger.exception("work failed")
            return _problem(
                500, "internal", "The service failed", "The error is in the service's log."
            )
        return None

    async def _carry_out(self, item: Work) -> None:
        """Have the missing blocks of an item computed, then its result written, within its time."""
        most = self._settings.max_job_seconds
        try:
            async with asyncio.timeout(most) as limit:
                await self._compute_and_write(item)
        except TimeoutError as error:
            if not limit.expired():
                raise
            raise _TooLongError(
                f"It was stopped after {most:g} s. Posted again, it goes on with the blocks that "
                "are done."
            ) from error

    async def _compute_and_write(self, item: Work) -> None:
        store, key, cells = self._store, item.key, item.block_cells
        spent = item.seconds
        torn: Counter[str] = Counter()
        while True:
            if await self._is_there(item):
                return
            missing = await self._aside(
                lambda: [i for i in range(item.blocks) if not store.has_block(key, cells, i)]
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
                return

    async def _is_there(self, item: Work) -> bool:
        """Return whether a result is there; blocks that a late worker left go then."""
        await self._aside(self._store.drop_blocks, item.key)
        return await self._aside(self._store.manifest, item.key) is not None

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
                        work.compute_block, item.key, item.process, item.block_cells, index
                    )
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
            raise _WorkersDieError(
                "A block took down each worker that it was given to, perhaps for want of memory."
            ) from error
        except (FutureCancelledError, CommClosedError) as error:
            raise _Lost(f"{type(error).__name__}: {error}") from error
        except asyncio.CancelledError:
            await _cancel(future)
            raise
        finally:
            result.cancel()
            await asyncio.gather(result, return_exceptions=True)

    async def _aside(self, function: Callable[..., _T], *arguments: Any, **options: Any) -> _T:
        """Run what waits for the ledger or the disk in a thread of our own."""
        call = functools.partial(function, *arguments, **options)
        return await asyncio.get_running_loop().run_in_executor(self._threads, call)

    async def _client(self) -> Client:
        """Return the connection; note how many workers there are, or why there are none."""
        try:
            client = await self._cluster.client()
            self._workers = await self._cluster.workers()
        except Exception as error:  # of many kinds: no scheduler, no worker process
            self._trouble = f"the workers cannot be reached: {type(error).__name__}"
            raise _Lost(str(error)) from error
        self._trouble = None if self._workers else "there are no workers"
        return client


async def _result_of(future: Any) -> float:
    seconds: float = await future
    return seconds


async def _cancel(future: Any) -> None:
    with contextlib.suppress(Exception):
        await future.cancel()


def _problem(status: int, kind: str, title: str, detail: object) -> dict[str, Any]:
    return {"status": status, "kind": kind, "title": title, "detail": str(detail)}


class _Lost(VibrafeedError):  # noqa: N818 - no error of the study: the work is tried again
    """The cluster is gone, or what else soon comes back."""


class _TooLongError(VibrafeedError):
    """A study takes longer than a job may."""


class _WorkersDieError(VibrafeedError):
    """A block takes its workers down."""
