"""The Dask cluster that the work runs on: one of our own, or any by its address."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from contextlib import AsyncExitStack, suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any

import dask
from distributed import Client, LocalCluster, WorkerPlugin, get_worker

from vibrafeed.core.system import lower_priority

if TYPE_CHECKING:
    _Made = tuple[Client, AsyncExitStack]  # what closes it, and the workers if they are ours

MAX_FAILURES = 10  # workers that die under one block
BEGUN = "vibrafeed-begun"  # Dask's topic under which workers report the calls that they begin
RESTART = 30.0  # s that a worker may take to end and come again
PATIENCE = 1.0  # s that a worker may take to end before it is killed
POLITE = 10  # niceness of our own workers: the service answers while they work


class Cluster:
    """Connects to the Dask cluster at first use, so that a service without jobs starts no workers.

    Parameters
    ----------
    address : str or None
        Address of a running scheduler; None for workers of our own.
    workers : int
        Number of our own workers, one process and one thread each.

    Attributes
    ----------
    begun : callable
        Called with the key of each call that a worker begins, the worker's address, and True if the
        worker has loaded its code: once when it takes the call up, once when it has.
    """

    def __init__(self, address: str | None, workers: int):
        """Note the scheduler's address, or the number of local workers; connect on first use."""
        self._address, self._workers = address, workers
        # A task of its own: who waits for it may be cancelled, and leaves nothing half made.
        self._start: asyncio.Task[_Made] | None = None
        self.begun: Callable[[str, str, bool], object] = lambda key, worker, is_loaded: None

    async def client(self) -> Client:
        """Return the client of the Dask cluster; connect if there is no connection or it is lost.

        Raises
        ------
        OSError
            If the scheduler does not answer.
        """
        if self._start is None or _is_lost(self._start):
            self._start = asyncio.create_task(self._connect(self._start))
        client, _ = await asyncio.shield(self._start)
        return client

    async def workers(self) -> int:
        """Return the number of tasks that the cluster can run at once: threads of all its workers.

        The number is 0 while no worker is there: ours are started again, or a scheduler elsewhere
        has none.
        """
        client = await self.client()
        threads: dict[str, int] = await client.nthreads()  # type: ignore[no-untyped-call]
        return sum(threads.values())

    async def has_nanny(self, worker: str) -> bool:
        """True if a worker would be restarted automatically after a kill, or is already gone.

        `worker` is its address. A nanny is the process of Dask that starts a worker again.
        """
        client = await self.client()
        # All of them: by default the scheduler tells of a few.
        scheduler: Any = client.scheduler
        known = (await scheduler.identity(n_workers=-1))["workers"]
        return worker not in known or known[worker]["nanny"] is not None

    async def restart(self, worker: str) -> None:
        """Restart the process of a worker, by force if need be, and wait for the new process.

        `worker` is its address; a worker that is gone is left out. Waits for 30 s at most.
        """
        client = await self.client()
        with contextlib.suppress(KeyError):  # it is gone
            await client.restart_workers([worker], timeout=RESTART, raise_for_error=False)

    def alive(self) -> int:
        """Return the number of workers at the last count; 0 before the cluster is used."""
        if self._start is None or not self._start.done() or _is_lost(self._start):
            return 0
        client, _ = self._start.result()
        told: Any = client.scheduler_info()  # of an asynchronous client: what it was last told
        return int(told.get("n_workers", 0))

    async def close(self) -> None:
        """Close the connection and the workers of this service.

        Wait for those that are starting.
        """
        start, self._start = self._start, None
        if start is not None:
            if self._address is not None:
                start.cancel()  # it may wait long for a scheduler, and has no processes
            await _end(start)

    async def _connect(self, lost: asyncio.Task[_Made] | None) -> _Made:
        """Connect to the cluster, starting local workers if no address is set.

        Parameters
        ----------
        lost : asyncio.Task or None
            The previous attempt, whose connection is closed first; None at the first.

        Returns
        -------
        tuple
            The client of Dask, and the stack that closes it and the workers if they are ours.
        """
        if lost is not None:
            await _end(lost)
        async with AsyncExitStack() as made:
            local = None
            if self._address is None:
                local = _local(self._workers)
                made.push_async_exit(local)
                await local
                made.push_async_callback(_end_workers, local)
            client = Client(
                local or self._address, asynchronous=True, set_as_default=False, timeout=20
            )  # type: ignore[no-untyped-call]
            made.push_async_callback(client.close)
            await client
            client.subscribe_topic(BEGUN, self._heard)  # type: ignore[no-untyped-call]
            if local is not None:
                await client.register_plugin(_polite())
            return client, made.pop_all()

    def _heard(self, event: tuple[float, dict[str, Any]]) -> None:
        """Pass a worker's report that it has begun with a call to `begun`.

        `event` is what Dask delivers: the time, and a dict with the call's `key`, the worker's
        address `worker`, and `is_loaded`.
        """
        told = event[1]
        self.begun(told["key"], told["worker"], told["is_loaded"])


def call_reported(module: str, name: str, *arguments: Any) -> Any:
    """Call a function on a worker, and report to the cluster's clients that it has begun.

    They are told when the worker takes the call up, and when it has imported `module`, which takes
    seconds on a busy machine in its first call.
    """
    _report(is_loaded=False)
    home = import_module(module)
    _report(is_loaded=True)
    return getattr(home, name)(*arguments)


def _report(*, is_loaded: bool) -> None:
    with suppress(ValueError):  # it is called elsewhere than on a worker
        worker = get_worker()
        told = {"key": worker.get_current_task(), "worker": worker.address}
        worker.log_event(BEGUN, {**told, "is_loaded": is_loaded})


def _is_lost(start: asyncio.Task[_Made]) -> bool:
    """True if a connection attempt has failed or its connection is closed.

    `start` is the task of `Cluster._connect`, which may still run: it is not lost then.
    """
    if not start.done():
        return False
    failed = start.cancelled() or start.exception() is not None
    return failed or start.result()[0].status != "running"


def _polite() -> WorkerPlugin:
    """Return a Dask plugin that lowers the process priority of every worker, restarted ones too."""

    class Polite(WorkerPlugin):
        def setup(self, worker: object) -> None:
            """Lower the priority of the worker's process."""
            lower_priority(POLITE)

    return Polite()


async def _end(start: asyncio.Task[_Made]) -> None:
    """Wait for a connection attempt to end, and close the connection that it made, if any."""
    await asyncio.wait([start])
    if not start.cancelled() and start.exception() is None:
        await start.result()[1].aclose()


async def _end_workers(cluster: Any) -> None:
    """Kill the processes of a local Dask cluster, whatever they compute.

    Blocks that are cut off are computed again later. Raises the error of a worker whose end fails;
    one that does not end in time has been killed and is no error.
    """
    nannies = list(cluster.workers.values())
    ends = await asyncio.gather(
        *(nanny.close(timeout=PATIENCE) for nanny in nannies), return_exceptions=True
    )
    for error in ends:
        # What does not end in time has been killed: on a busy machine its end comes later.
        if isinstance(error, BaseException) and not isinstance(error, TimeoutError):
            raise error


def _local(workers: int) -> Any:
    """Return a local Dask cluster with this number of workers, not started yet."""
    dask.config.set(
        {
            # A worker may be killed for reasons that are not its block's.
            "distributed.scheduler.allowed-failures": MAX_FAILURES,
            # Workers are forked from the server of `process_pool`, which has loaded what they need:
            # they are there at once, and share its memory.
            "distributed.worker.multiprocessing-method": "forkserver",
            # No pages beside ours.
            "distributed.scheduler.http.routes": [],
            "distributed.worker.http.routes": [],
            # Nobody looks at what Dask observes of itself, up to a hundred times a second: idle
            # processes would take a twelfth of a processor.
            "distributed.worker.profile.enabled": False,
            "distributed.admin.tick.interval": "1s",
            "distributed.admin.system-monitor.interval": "5s",
        }
    )
    return LocalCluster(  # type: ignore[no-untyped-call]
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        # They serve no pages; what listens does so on loopback only.
        dashboard_address="127.0.0.1:0",
        worker_dashboard_address="127.0.0.1:0",
        security=True,  # keys of its own: other users of the machine cannot give it work
        # Blocks have a known size, and results one below VIBRAFEED_MAX_BYTES.
        memory_limit=0,
        asynchronous=True,
        silence_logs="ERROR",
    )
