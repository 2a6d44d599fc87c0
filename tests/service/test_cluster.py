"""A Dask scheduler elsewhere takes calls as the service's own processes do."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable

import distributed
import pytest

from vibrafeed.app.jobs import cluster as clusters
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.process_pool import LostError
from waiting import awaited


async def nothing() -> None:
    """Begin."""


def connected(test: Callable[[Cluster], Awaitable[None]], workers: int) -> None:
    """Run a test with a cluster of threads in this process."""
    with distributed.LocalCluster(
        n_workers=workers, threads_per_worker=2, processes=False, host="127.0.0.1",
        dashboard_address="127.0.0.1:0", protocol="tcp",
    ) as local:  # fmt: skip
        cluster = Cluster(local.scheduler_address)

        async def run() -> None:
            try:
                await test(cluster)
            finally:
                await asyncio.to_thread(cluster.close)

        asyncio.run(run())


def test_calls_return_or_raise() -> None:
    async def test(cluster: Cluster) -> None:
        assert cluster.alive() == 0
        await cluster.prepare()
        assert (cluster.alive(), cluster.fair_queue.slots, cluster.trouble) == (2, 3, None)
        assert await cluster(divmod, 7, 2, began=nothing) == (3, 1)
        with pytest.raises(ZeroDivisionError):
            await cluster(divmod, 1, 0, began=nothing)

    connected(test, 1)


def test_what_is_given_up_is_left_to_itself() -> None:
    go_on = threading.Event()
    clusters.wait_for_test = go_on.wait

    async def test(cluster: Cluster) -> None:
        await cluster.prepare()
        begun = asyncio.Event()

        async def began() -> None:
            begun.set()

        call = asyncio.create_task(cluster(go_on_of_test, began=began, grace=0.1))
        await begun.wait()
        call.cancel()
        await asyncio.wait({call})
        assert call.cancelled()
        go_on.set()

    connected(test, 1)


def go_on_of_test() -> None:
    clusters.wait_for_test(60)


def test_a_scheduler_without_workers_is_told() -> None:
    async def test(cluster: Cluster) -> None:
        with pytest.raises(LostError, match="there are no workers"):
            await cluster.prepare()
        assert cluster.trouble == "there are no workers"

    connected(test, 0)


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clusters, "PATIENCE", 0.5)

    async def run() -> None:
        cluster = Cluster("tcp://127.0.0.1:9")
        with pytest.raises(LostError, match="cannot be reached"):
            await cluster.prepare()
        assert cluster.trouble
        cluster.close()

    asyncio.run(run())


def test_a_connection_that_is_lost_is_made_again() -> None:
    async def test(cluster: Cluster) -> None:
        await cluster.prepare()
        await asyncio.to_thread(cluster._client.close)
        await awaited(lambda: cluster._client.status == "closed")
        await cluster.prepare()
        assert await cluster(divmod, 7, 2, began=nothing) == (3, 1)

    connected(test, 1)
