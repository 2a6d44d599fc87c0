"""The Dask cluster that the work runs on: one of our own, or any by its address."""

from __future__ import annotations

import asyncio
import importlib
import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from distributed import Client, LocalCluster

MOST_FAILURES = 10  # workers that die under one block
POLITE = 10  # niceness of our own workers: the service answers while they work


class Cluster:
    """Connects when it is first asked: a service without jobs starts no workers.

    Parameters
    ----------
    address : str or None
        That of a running scheduler; None for workers of our own.
    workers : int
        How many of our own, one process and one thread each.
    """

    def __init__(self, address: str | None, workers: int):
        self._address, self._workers = address, workers
        self._lock = asyncio.Lock()
        self._client: Client | None = None
        self._local: LocalCluster | None = None

    @property
    def started(self) -> bool:
        """Return whether there is a connection."""
        return self._client is not None

    async def client(self) -> Client:
        """Return the connection; make it if there is none or it has been lost.

        Raises
        ------
        OSError
            If the scheduler does not answer.
        """
        async with self._lock:
            if self._client is not None and self._client.status != "running":
                await self.close()
            if self._client is None:
                # The import takes half a second: not on the event loop.
                distributed = await asyncio.to_thread(importlib.import_module, "distributed")
                if self._address is None:
                    self._local = await _local(distributed, self._workers)
                self._client = await distributed.Client(
                    self._local or self._address, asynchronous=True, timeout=20
                )
                if self._local is not None:
                    await self._client.run(os.nice, POLITE)
            return self._client

    async def workers(self) -> int:
        """Return how many tasks can run at once, at least 1."""
        client = await self.client()
        threads: dict[str, int] = await client.nthreads()  # type: ignore[no-untyped-call]
        return max(1, sum(threads.values()))

    async def close(self) -> None:
        """Close the connection, and our own workers."""
        client, local = self._client, self._local
        self._client = self._local = None
        if client is not None:
            await client.close()  # type: ignore[no-untyped-call]
        if local is not None:
            await local.close()  # type: ignore[misc]


async def _local(distributed: Any, workers: int) -> LocalCluster:
    import dask

    # A worker may be killed for reasons that are not its block's.
    dask.config.set({"distributed.scheduler.allowed-failures": MOST_FAILURES})
    return await distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        # Its figures are served even so: on any port that is free, not on 8787.
        scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
        # Blocks have a known size, and results one below VIBRAFEED_MAX_BYTES.
        memory_limit=0,
        asynchronous=True,
        silence_logs="ERROR",
    )
