"""What workers are given ends, whatever it does: with real workers."""

from __future__ import annotations

import asyncio
import contextlib
import os
import time

from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.executor import Executor
from vibrafeed.app.jobs.fair_queue import FairQueue


async def nothing() -> None:
    pass


class _Given(asyncio.Future):
    """A call as Dask's client gives it back."""

    key = "the call"


class _Loading:
    """A cluster with one worker, which loads its code as slowly as the test says."""

    def __init__(self) -> None:
        self.begun = lambda key, worker, is_loaded: None
        self.given: _Given | None = None

    async def client(self) -> _Loading:
        return self

    async def workers(self) -> int:
        return 1

    def submit(self, call: object, *arguments: object, pure: bool) -> _Given:
        self.given = _Given()
        return self.given


def test_a_call_has_begun_once_its_worker_has_loaded_its_code():
    async def scene() -> None:
        cluster, began = _Loading(), []
        executor = Executor(cluster, FairQueue(1000.0), grace=60)

        async def begin() -> None:
            began.append(True)

        call = asyncio.create_task(executor.run("one", 1.0, begin, os.getpid))
        while cluster.given is None or not executor._calls:
            await asyncio.sleep(0)
        cluster.begun("the call", "a worker", False)
        for _ in range(10):
            await asyncio.sleep(0)
        assert not began  # its time limit does not run yet
        cluster.begun("the call", "a worker", True)
        while not began:
            await asyncio.sleep(0)
        cluster.given.set_result(1.0)
        assert await call == 1.0
        await executor.close()

    asyncio.run(scene())


def test_what_does_not_stop_is_killed_and_others_are_not_to_blame():
    async def scene() -> None:
        cluster, fair_queue = Cluster(None, 1), FairQueue(1000.0)
        executor = Executor(cluster, fair_queue, grace=0.5)
        try:
            worker = await executor.run("first", 1.0, nothing, os.getpid)
            begun = asyncio.Event()

            async def began() -> None:
                begun.set()

            stubborn = asyncio.create_task(
                executor.run("stubborn", 1.0, began, time.sleep, 600)  # type: ignore[arg-type]
            )
            await asyncio.wait_for(begun.wait(), 60)
            # As if another service gave its work to the same workers: it waits behind that.
            waits = cluster.workers
            cluster.workers = two  # type: ignore[method-assign]
            innocent = asyncio.create_task(executor.run("innocent", 1.0, nothing, os.getpid))
            while len(executor._calls) < 2:
                await asyncio.sleep(0.02)
            cluster.workers = waits  # type: ignore[method-assign]
            stubborn.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.wait_for(stubborn, 5)  # who gives up does not wait
            assert await asyncio.wait_for(innocent, 60) != worker
            while executor._ending:
                await asyncio.sleep(0.02)
            assert (
                await asyncio.wait_for(executor.run("next", 1.0, nothing, os.getpid), 60) != worker
            )
            assert not executor._calls
        finally:
            await executor.close()
            await cluster.close()

    async def two() -> int:
        return 2

    asyncio.run(scene())


def test_what_ends_in_time_keeps_its_worker():
    async def scene() -> None:
        cluster, fair_queue = Cluster(None, 1), FairQueue(1000.0)
        executor = Executor(cluster, fair_queue, grace=60)
        try:
            worker = await executor.run("first", 1.0, nothing, os.getpid)
            begun = asyncio.Event()

            async def began() -> None:
                begun.set()

            slow = asyncio.create_task(executor.run("slow", 1.0, began, time.sleep, 1))  # type: ignore[arg-type]
            await asyncio.wait_for(begun.wait(), 60)
            slow.cancel()
            assert (
                await asyncio.wait_for(executor.run("next", 1.0, nothing, os.getpid), 60) == worker
            )
        finally:
            await executor.close()
            await cluster.close()

    asyncio.run(scene())
