"""Execution of single calls by workers, in the order of the fair queue, each with its end."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from distributed import KilledWorker
from distributed.client import FutureCancelledError
from distributed.comm.core import CommClosedError

from vibrafeed.app.jobs.cluster import Cluster, call_reported
from vibrafeed.app.jobs.fair_queue import FairQueue, Slot
from vibrafeed.core.errors import VibrafeedError

if TYPE_CHECKING:
    from distributed import Client

logger = logging.getLogger("vibrafeed.jobs")
_T = TypeVar("_T")

LOOK_AT_WORKERS = 5.0  # s between looks at whether there are some, while a call does not end
SETTLE = 1.0  # s within which a worker that was given a call reports that it has begun


class LostError(VibrafeedError):
    """The cluster is gone, or what else soon comes back; the study is not to blame."""


class WorkersDieError(VibrafeedError):
    """A block takes its workers down."""


@dataclass(eq=False)
class _Call:
    """A call on its way: the cluster's future, its end, and which worker has it once it begins.

    It has `begun` once a worker has taken it up, and is `loaded` once that one has its code.
    """

    future: Any
    result: asyncio.Task[Any]
    begun: asyncio.Future[None]
    loaded: asyncio.Future[None]
    worker: str = ""


class Executor:
    """Carries out calls on a cluster, as many at a time as it has threads.

    Parameters
    ----------
    cluster : Cluster
        Where they run.
    fair_queue : FairQueue
        Decides which call is next.
    grace : float
        Time that a worker may go on with an abandoned call before it is killed [s].

    Attributes
    ----------
    trouble : str or None
        The reason why calls cannot be carried out.
    workers : int
        Number of calls that can run at a time, at the last look.
    """

    def __init__(self, cluster: Cluster, fair_queue: FairQueue, grace: float):
        """Run calls on a cluster; abandoned calls are killed after `grace` seconds."""
        self._cluster, self._fair_queue, self._grace = cluster, fair_queue, grace
        self._calls: dict[object, _Call] = {}
        self._killed: set[str] = set()  # addresses of workers; one is never used again
        self._ending: set[asyncio.Task[None]] = set()
        self.trouble: str | None = None
        self.workers = 0
        cluster.begun = self._heard

    async def run(
        self,
        share: str,
        seconds: float,
        began: Callable[[], Awaitable[None]],
        function: Callable[..., _T],
        *arguments: Any,
    ) -> _T:
        """Run a function on a worker of the cluster when its turn comes, and return its result.

        A caller that is cancelled need not wait for the worker: the call is then abandoned, and a
        worker that does not end it within the grace period is killed.

        Parameters
        ----------
        share : str
            The account that the call is charged to in the fair queue.
        seconds : float
            The expected time of the call [s].
        began : callable
            Awaited once a worker has begun with the call and has loaded its code.
        function : callable
            A function of a module; workers import it by its name.
        arguments
            Its arguments.

        Raises
        ------
        LostError
            If the connection to the cluster is lost.
        WorkersDieError
            If the call crashes its workers.
        """
        if not self.workers:
            await self._client()
        slot = await self._fair_queue.take(share, seconds)
        kept = False
        try:
            while True:
                call = await self._submit(function, arguments)
                try:
                    result: _T = await self._await_result(call, began)
                    return result
                except KilledWorker as error:
                    if error.last_worker.address not in self._killed:
                        raise WorkersDieError(
                            "The job failed: a block crashed every worker that ran it, perhaps "
                            "because memory ran out. Post a smaller study, or give the workers "
                            "more memory."
                        ) from error
                    logger.info("a call goes to another worker: its own was killed for another")
                finally:
                    if not call.result.done():
                        kept = True
                        self._see_off(call, slot)
                    else:
                        self._calls.pop(call.future.key, None)
                        await asyncio.gather(call.result, return_exceptions=True)
        finally:
            if not kept:
                self._fair_queue.leave(slot)

    async def close(self) -> None:
        """Stop waiting for abandoned calls to end."""
        for task in self._ending:
            task.cancel()
        await asyncio.gather(*self._ending, return_exceptions=True)

    def waits(self) -> str | None:
        """Return the reason why new work has to wait, such as busy workers; None if it has not."""
        return self.trouble or ("all workers are busy" if self._fair_queue.waiting else None)

    async def _submit(self, function: Callable[..., Any], arguments: Any) -> _Call:
        """Submit a call to the Dask cluster, register it, and return its record.

        `function` is a module function; it is sent by name, as workers import their own code.
        `arguments` are its arguments. The record has the future of the result, and two futures that
        the worker's reports set: when it has begun, and when its code is loaded.
        """
        client, name = await self._client(), function.__name__
        future = client.submit(call_reported, function.__module__, name, *arguments, pure=False)
        loop = asyncio.get_running_loop()
        begun, loaded = loop.create_future(), loop.create_future()
        call = _Call(future, asyncio.create_task(_result_of(future)), begun, loaded)
        self._calls[future.key] = call
        return call

    def _heard(self, key: str, worker: str, is_loaded: bool) -> None:
        """Record a worker's report that it has begun with a call, or has loaded the call's code.

        `key` is Dask's key of the call; `worker` is the worker's address. A call that is no longer
        known is ignored.
        """
        call = self._calls.get(key)
        if call is not None:
            call.worker = worker  # another one, if the first has died
            event = call.loaded if is_loaded else call.begun
            if not event.done():
                event.set_result(None)

    async def _await_result(self, call: _Call, began: Callable[[], Awaitable[None]]) -> Any:
        """Wait for the result of a call on a worker and return it.

        `began` is awaited once, when a worker has loaded the code of the call. While nothing
        happens, the cluster is looked at every few seconds. Raises the error of the call;
        `LostError` if the cluster is lost.
        """
        announced = False
        while True:
            events: set[asyncio.Future[Any]] = {call.result}
            if not announced:
                events.add(call.loaded)
            done, _ = await asyncio.wait(
                events, timeout=LOOK_AT_WORKERS, return_when=asyncio.FIRST_COMPLETED
            )
            try:
                if call.result.done() and call.result.exception() is not None:
                    return call.result.result()
            except (FutureCancelledError, CommClosedError) as error:
                raise LostError(f"{type(error).__name__}: {error}") from error
            if done and not announced:
                announced = True
                await began()
            if call.result.done():
                return call.result.result()
            if not done:
                await self._client()

    def _see_off(self, call: _Call, slot: Slot) -> None:
        """Watch an abandoned call in the background until it ends, then free its slot."""
        task = asyncio.create_task(self._await_end(call, slot))
        self._ending.add(task)
        task.add_done_callback(self._ending.discard)

    async def _await_end(self, call: _Call, slot: Slot) -> None:
        """Wait until an abandoned call ends, killing its worker if need be; then free its slot.

        A worker that has begun with the call gets the grace period to end it by itself. `slot` is
        the place on a worker that the fair queue counts as taken until then.
        """
        try:
            either: set[asyncio.Future[Any]] = {call.result, call.begun}
            await asyncio.wait(either, timeout=SETTLE, return_when=asyncio.FIRST_COMPLETED)
            if call.begun.done() and not call.result.done():
                await asyncio.wait({call.result}, timeout=self._grace)
            if call.begun.done() and not call.result.done():
                await self._kill(call)
        except Exception:  # such as a scheduler that is gone
            logger.exception("work that was given up cannot be ended")
        finally:
            with contextlib.suppress(Exception):
                await call.future.cancel()
            call.result.cancel()
            await asyncio.gather(call.result, return_exceptions=True)
            self._calls.pop(call.future.key, None)
            self._fair_queue.leave(slot)

    async def _kill(self, call: _Call) -> None:
        """Kill and restart the worker of a call that was abandoned and has not ended by itself.

        `call` is the record of the call, with the worker's address. A worker is restarted by its
        nanny, a process of Dask; one without is not killed, but its call waited for.
        """
        about = {"worker": call.worker}
        if not await self._cluster.has_nanny(call.worker):
            logger.error(
                "a worker does not stop what was given up, and has no nanny to start it again: it "
                "is waited for",
                extra=about,
            )
            await asyncio.wait({call.result})
            return
        logger.warning("a worker that does not stop what was given up is killed", extra=about)
        self._killed.add(call.worker)
        await call.future.cancel()  # first: else another worker would be given it
        await self._cluster.restart(call.worker)

    async def _client(self) -> Client:
        """Return the Dask client; record the number of workers, or why there are none.

        The fair queue gets as many slots as there are workers. Raises `LostError` if the cluster
        cannot be reached; `trouble` then says so.
        """
        try:
            client = await self._cluster.client()
            self.workers = await self._cluster.workers()
        except Exception as error:  # of many kinds: no scheduler, no worker process
            self.trouble = f"the workers cannot be reached: {type(error).__name__}"
            raise LostError(str(error)) from error
        self.trouble = None if self.workers else "there are no workers"
        self._fair_queue.resize(self.workers)
        return client


async def _result_of(future: Any) -> Any:
    """Wait for a future of the cluster and return its result."""
    return await future
