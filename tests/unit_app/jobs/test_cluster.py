"""The cluster leaves no worker behind, whatever becomes of who asks for it."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
from collections.abc import Awaitable, Callable

import distributed
import pytest

from vibrafeed.app.jobs import cluster as clusters
from vibrafeed.app.jobs.cluster import POLITE, Cluster
from waiting import PATIENCE


def processes() -> set[int]:
    """Return the processes that this one has started and that are alive."""
    return {child.pid for child in multiprocessing.active_children() if child.pid is not None}


async def until(condition: Callable[[], object]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.02)


@pytest.fixture
def run():
    """Return a function that runs a test on a cluster; no process may be left after it."""

    def run(test: Callable[[Cluster], Awaitable[None]], address: str | None = None) -> None:
        async def closed() -> None:
            cluster = Cluster(address, 1)
            try:
                await test(cluster)
            finally:
                await cluster.close()
            assert not processes() - before

        before = processes()
        try:
            asyncio.run(closed())
        finally:
            for pid in processes() - before:
                os.kill(pid, signal.SIGKILL)

    return run


def test_workers_do_not_observe_themselves(run):
    """Idle, two of them and their scheduler took a twelfth of a processor."""

    async def test(cluster: Cluster) -> None:
        client = await cluster.client()
        own = await client.run(
            lambda dask_worker: {
                name: callback.callback_time
                for name, callback in dask_worker.periodic_callbacks.items()
            }
        )
        (milliseconds,) = own.values()
        assert not {"profile", "profile-cycle"} & milliseconds.keys()
        assert min(milliseconds.values()) >= 100, milliseconds

    run(test)


def test_all_who_ask_share_one_start(run):
    async def test(cluster: Cluster) -> None:
        first, second = await asyncio.gather(cluster.client(), cluster.client())
        assert first is second is await cluster.client()
        assert await cluster.workers() == 1

    run(test)


def test_who_is_cancelled_while_workers_start_leaves_none(run):
    async def test(cluster: Cluster) -> None:
        before = processes()
        asking = asyncio.create_task(cluster.client())
        await until(lambda: processes() - before)  # it is there, and the cluster is not yet
        asking.cancel()
        await asyncio.wait([asking])
        assert asking.cancelled()

    run(test)


def test_closing_while_workers_start_closes_what_comes_of_it(run):
    async def test(cluster: Cluster) -> None:
        before = processes()
        asking = asyncio.create_task(cluster.client())
        await until(lambda: processes() - before)
        await cluster.close()
        await until(lambda: not processes() - before)
        assert (await asking).status == "closed"
        assert (await cluster.client()).status == "running"  # as after any close

    run(test)


def test_a_client_that_fails_leaves_no_workers(run, monkeypatch):
    async def test(cluster: Cluster) -> None:
        before = processes()
        with monkeypatch.context() as broken:
            broken.setattr(clusters, "Client", fail)
            for _ in range(2):
                with pytest.raises(OSError, match="no client"):
                    await cluster.client()
                assert not processes() - before
        assert (await cluster.client()).status == "running"

    def fail(*arguments: object, **options: object) -> None:
        raise OSError("no client")

    run(test)


def test_a_worker_that_takes_the_place_of_a_dead_one_is_polite_too(run):
    async def test(cluster: Cluster) -> None:
        client = await cluster.client()
        own = os.nice(0)
        for _ in range(2):
            pid, nice = await client.submit(lambda: (os.getpid(), os.nice(0)), pure=False)
            assert nice == min(own + POLITE, 19)
            os.kill(pid, signal.SIGKILL)
        async with asyncio.timeout(PATIENCE):
            while await cluster.workers() > 0:  # the truth, while there is none
                await asyncio.sleep(0.002)
            # Distributed itself stumbles when it is closed while a worker is started again.
            while await cluster.workers() == 0:
                await asyncio.sleep(0.1)

    run(test)


def test_a_scheduler_elsewhere_may_have_no_workers(run):
    async def test(_: Cluster) -> None:
        async with distributed.Scheduler(
            host="127.0.0.1", port=0, dashboard_address="127.0.0.1:0"
        ) as scheduler:
            cluster = Cluster(scheduler.address, 1)
            assert await cluster.workers() == 0
            await cluster.close()

    run(test)


def test_closing_does_not_wait_for_a_scheduler_that_does_not_answer(run):
    async def test(cluster: Cluster) -> None:
        asking = asyncio.create_task(cluster.client())
        await asyncio.sleep(1)
        async with asyncio.timeout(15):  # the client itself tries for 20 s
            await cluster.close()
            await asyncio.wait([asking])

    run(test, "tcp://127.0.0.1:9")
