"""The processes in which the service reads, prices and computes studies: each can be killed.

A thread cannot be ended, and one that computes holds the interpreter, for which everybody else then
waits. A process that is killed or dies is replaced.
"""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import pickle
import signal
import threading
import time
import traceback
from collections.abc import Awaitable, Callable
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any, TypeVar

import psutil

from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.core.errors import StoppedError, VibrafeedError
from vibrafeed.core.system import end_with_parent, lower_priority

CHECK_INTERVAL = 0.5  # s between checks that the client still waits for the result
CALLS = 500  # calls of a process before a new one replaces it: memory does not pile up
POLITE = 5  # niceness: the event loop comes first
ENVIRONMENT = {
    # Calculations share the cores: each has one thread.
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    # What is freed goes back to the machine.
    "MALLOC_TRIM_THRESHOLD_": "65536",
}
"""What processes are started with, unless it is set already."""

_T = TypeVar("_T")


class EndedError(VibrafeedError):
    """A process of the pool has died of what it computed."""


class LostError(VibrafeedError):
    """The workers are gone, or what else soon comes back; the study is not to blame."""


class SlowError(StoppedError):
    """A computation was stopped that had the processor for less than half of its time."""


class ProcessPool:
    """Runs functions in processes, one call at a time in each.

    Parameters
    ----------
    workers : int
        How many processes may compute what takes long; one more is left to short calls.
    modules : tuple of str
        What the processes import when they start.

    Attributes
    ----------
    fair_queue : FairQueue
        Gives out the processes; whoever makes a call holds a place.
    trouble : None
        Processes of this machine are always there.
    """

    trouble = None

    def __init__(self, workers: int, modules: tuple[str, ...]):
        """Allow some calls at a time, in processes that have loaded some modules."""
        self.fair_queue = FairQueue(workers + 1)
        self._modules = modules
        self._idle: list[_Process] = []
        self._busy: set[_Process] = set()
        self._is_closed = False

    def open(self) -> None:
        """Set what the processes find in their environment."""
        for name, value in ENVIRONMENT.items():
            os.environ.setdefault(name, value)

    async def start(self) -> None:
        """Start the processes before the first calls need them."""
        while len(self._idle) + len(self._busy) < self.fair_queue.slots:
            process = await self._start_process()
            await asyncio.wait({_awaitable(process.ready)})
            self._reuse_or_kill(process)

    async def prepare(self) -> None:
        """Do nothing: a process is started when a call needs it."""

    async def __call__(
        self,
        function: Callable[..., _T],
        *arguments: Any,
        seconds: float = float("inf"),
        check: Callable[[], Awaitable[None]] | None = None,
        on_start: Callable[[], Awaitable[None]] | None = None,
        grace: float = 0.0,
    ) -> _T:
        """Run a function in a process and return its result; kill the process on timeout.

        Parameters
        ----------
        function, arguments
            A function of a module, and its arguments; both are pickled, as is the result.
        seconds : float
            Time limit [s], after which the process is killed; the loading of code does not count.
        check : callable, optional
            Awaited every half second; if it raises, the process is killed and the error passed on.
        on_start : callable, optional
            Awaited once the process has started and takes the call.
        grace : float
            Time that the function may go on after the caller is cancelled [s].

        Raises
        ------
        StoppedError
            If the function takes longer than the limit.
        SlowError
            If it does so because the machine is busy.
        EndedError
            If the process dies.
        LostError
            If the pool is closed.
        Exception
            What the function raises.
        """
        process, call = await self._submit(function, arguments)
        try:
            ready = _awaitable(process.ready)
            await _until_done(ready, float("inf"), check)
            ready.result()
            busy_before = process.busy_seconds()
            if on_start is not None:
                await on_start()
            if not await _until_done(call, seconds, check):
                if process.busy_seconds() - busy_before < seconds / 2:
                    raise SlowError(
                        "The machine of the service is busy: the computation was not ready after "
                        f"{seconds:g} s. Send the request again."
                    )
                raise StoppedError(
                    f"The computation was stopped at the service's time limit of {seconds:g} s."
                )
            return call.result()
        except (BrokenProcessPool, psutil.NoSuchProcess) as error:
            if self._is_closed:
                raise LostError("The service stops.") from error
            raise EndedError(
                "The process that computed the reply died, perhaps because memory ran out."
            ) from error
        finally:
            if not call.done() and grace:
                await asyncio.wait({call}, timeout=0.0 if self._is_closed else grace)
            self._busy.discard(process)
            if call.done() and not isinstance(call.exception(), BrokenProcessPool):
                self._reuse_or_kill(process)
            else:
                process.kill()
                await asyncio.wait({call})  # it finds the end of the process

    def alive(self) -> int:
        """Return the number of processes that have been started."""
        return len(self._idle) + len(self._busy)

    def close(self) -> None:
        """Kill all processes of the pool; calls that run raise `LostError`."""
        self._is_closed = True
        while self._idle:
            self._idle.pop().kill()
        for process in self._busy:
            process.kill()

    async def _submit(
        self, function: Callable[..., _T], arguments: tuple[Any, ...]
    ) -> tuple[_Process, asyncio.Future[_T]]:
        while True:
            process = self._idle.pop() if self._idle else await self._start_process()
            self._busy.add(process)
            try:
                return process, _awaitable(process.submit(function, arguments))
            except BrokenProcessPool:  # it died while it was idle
                self._busy.discard(process)

    async def _start_process(self) -> _Process:
        if self._is_closed:
            raise LostError("The service stops.")
        return await asyncio.to_thread(_Process, self._modules)

    def _reuse_or_kill(self, process: _Process) -> None:
        is_spare = len(self._idle) + len(self._busy) >= self.fair_queue.slots
        if self._is_closed or is_spare or process.calls >= CALLS:
            process.kill()
        else:
            self._idle.append(process)


class _Process:
    """A process that carries out one call after another, and a thread that waits for it."""

    def __init__(self, modules: tuple[str, ...]):
        """Start a process, with the method that every system has."""
        spawn = multiprocessing.get_context("spawn")
        self._connection, child_end = spawn.Pipe()
        # Daemonic: one that nobody has killed ends with this process, which else waits for it.
        self._process = spawn.Process(target=_serve, args=(child_end, modules), daemon=True)
        self._process.start()
        threading.Thread(target=self._process.join, daemon=True).start()  # no zombie stays
        # Nobody else may hold this end: a process that dies amid its reply is seen by that alone.
        child_end.close()
        self._thread = ThreadPoolExecutor(1)
        self.ready: Future[None] = self._thread.submit(self._receive)
        self.calls = 0

    def submit(self, function: Callable[..., _T], arguments: tuple[Any, ...]) -> Future[_T]:
        """Give the process a call; raises `BrokenProcessPool` if it has died."""
        if not self._process.is_alive():
            raise BrokenProcessPool
        self.calls += 1
        return self._thread.submit(self._call, function, arguments)

    def busy_seconds(self) -> float:
        """Return the processor time that the process has had so far [s]."""
        times = psutil.Process(self._process.pid).cpu_times()
        return float(times.user + times.system)

    def kill(self) -> None:
        """Kill the process at once."""
        self._process.kill()
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _call(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        try:
            self._connection.send((function, arguments))
        except OSError as error:
            raise BrokenProcessPool from error
        return self._receive()

    def _receive(self) -> Any:
        try:
            error, result = self._connection.recv()
        except (EOFError, OSError) as ended:
            raise BrokenProcessPool from ended
        if error is not None:
            raise error
        return result


def _awaitable(call: Future[_T]) -> asyncio.Future[_T]:
    # Nobody may ask for the error of a call whose process was killed: asyncio would log it.
    future = asyncio.wrap_future(call)
    future.add_done_callback(lambda done: done.cancelled() or done.exception())
    return future


async def _until_done(
    call: asyncio.Future[Any], seconds: float, check: Callable[[], Awaitable[None]] | None
) -> bool:
    """Wait for a call, at most some seconds, with a check now and then; True if it is done."""
    deadline = time.monotonic() + seconds
    while not call.done() and (remaining := deadline - time.monotonic()) > 0:
        await asyncio.wait({call}, timeout=min(CHECK_INTERVAL, remaining))
        if check is not None and not call.done():
            await check()
    return call.done()


def _serve(connection: Connection, modules: tuple[str, ...]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal: the service ends us
    end_with_parent()
    for module in modules:
        import_module(module)
    lower_priority(POLITE)  # from now on: a call may be waiting for the process
    connection.send((None, None))  # it is ready
    while True:
        function, arguments = connection.recv()
        reply = _carry_out(function, arguments)
        try:
            connection.send(reply)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            connection.send((RuntimeError(repr(error)), None))


def _carry_out(
    function: Callable[..., Any], arguments: tuple[Any, ...]
) -> tuple[Exception | None, Any]:
    """Return the error or the result of a call; what cannot be sent is a `RuntimeError`."""
    try:
        return None, function(*arguments)
    except Exception as error:
        if not isinstance(error, VibrafeedError):
            error.add_note(traceback.format_exc())
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            return RuntimeError(f"{error!r}\n{traceback.format_exc()}"), None
        return error, None
