"""A Dask scheduler elsewhere takes calls as the service's own processes do."""

from __future__ import annotations

import asyncio
import threading

import distributed
import pytest

from vibrafeed.app.jobs import cluster as clusters
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.process_pool import LostError
from waiting import PATIENCE, awaited

GO_ON, BEGUN = threading.Event(), threading.Event()


def go_on() -> None:
    BEGUN.set()
    GO_ON.wait(PATIENCE)


async def nothing() -> None:
    """Begin."""


async def plays(cluster: Cluster, local: distributed.LocalCluster) -> None:
    with pytest.raises(LostError, match="there are no workers"):
        await cluster.prepare()
    assert cluster.trouble == "there are no workers"
    assert cluster.alive() == 0
    local.scale(1)
    await asyncio.to_thread(local.wait_for_workers, 1)
    await cluster.prepare()
    assert (cluster.alive(), cluster.fair_queue.slots, cluster.trouble) == (2, 3, None)
    assert await cluster(divmod, 7, 2, began=nothing) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        await cluster(divmod, 1, 0, began=nothing)
    # What is given up is left to itself.
    call = asyncio.create_task(cluster(go_on, began=nothing, grace=0.1))
    await awaited(BEGUN.is_set)
    call.cancel()
    await asyncio.wait({call})
    assert call.cancelled()
    GO_ON.set()
    # A connection that is lost is made again.
    await asyncio.to_thread(cluster._client.close)
    await awaited(lambda: cluster._client.status == "closed")
    await cluster.prepare()
    assert await cluster(divmod, 7, 2, began=nothing) == (3, 1)
    await asyncio.to_thread(cluster.close)


def test_calls_return_or_raise_whatever_becomes_of_the_cluster() -> None:
    """With a cluster of threads in this process."""
    with distributed.LocalCluster(
        n_workers=0, threads_per_worker=2, processes=False, host="127.0.0.1",
        dashboard_address="127.0.0.1:0", protocol="tcp",
    ) as local:  # fmt: skip
        asyncio.run(plays(Cluster(local.scheduler_address), local))


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clusters, "PATIENCE", 0.5)

    async def run() -> None:
        cluster = Cluster("tcp://127.0.0.1:9")
        with pytest.raises(LostError, match="cannot be reached"):
            await cluster.prepare()
        assert cluster.trouble
        cluster.close()

    asyncio.run(run())
