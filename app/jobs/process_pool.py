"""A pool of processes for what computes at once: each can be ended, whatever it is doing.

A thread cannot be ended, and one that computes holds the interpreter, for which everybody else then
waits. The processes are forked from one that has imported what they need: another takes the place
of an ended one within some hundredths of a second.
"""

from __future__ import annotations

import asyncio
import contextlib
import mmap
import multiprocessing
import os
import pickle
import signal
import time
import traceback
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import forkserver, reduction
from multiprocessing.connection import Connection
from typing import Any, TypeVar

from vibrafeed.core.errors import StoppedError, VibrafeedError
from vibrafeed.core.system import lower_priority

LOOK = 0.5  # s between checks that the client still waits for the result
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
"""What the server from which processes are forked is started with, unless it is set already."""

BYTES, LARGE, VALUE, ERROR = b"bytes", b"large", b"value", b"error"
"""Kinds of what a call sends back: bytes as they are, or in memory that both processes see, since
copies of megabytes would keep the event loop from its other clients; a pickled result; a pickled
error."""

SHARED = 1 << 20
"""Bytes from which on a result comes in memory that both processes see."""

_T = TypeVar("_T")


class EndedError(VibrafeedError):
    """A process of the pool has died of what it computed."""


class ProcessPool:
    """Runs functions in processes of its own.

    Parameters
    ----------
    most : int
        How many calls there are at a time, at most; a process each.
    modules : tuple of str
        What the processes have imported when they start.
    """

    def __init__(self, most: int, modules: tuple[str, ...]):
        """Allow at most `most` processes, which have loaded some modules when they start."""
        self._context = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(list(modules))
        self._threads = ThreadPoolExecutor(most, thread_name_prefix="process-pool")
        self._idle: list[_Process] = []
        self._is_closed = False

    def open(self) -> None:
        """Start the server that later forks the processes of the pool."""
        for name, value in ENVIRONMENT.items():
            os.environ.setdefault(name, value)
        forkserver.ensure_running()

    async def start(self) -> None:
        """Start a process before the first call needs it."""
        self._keep(await self._new())

    async def __call__(
        self,
        function: Callable[..., _T],
        *arguments: Any,
        seconds: float,
        look: Callable[[], Awaitable[None]] | None = None,
    ) -> _T:
        """Run a function in a process and return its result; kill the process on timeout.

        Parameters
        ----------
        function, arguments
            A function of a module, and its arguments; both are pickled, as is the result unless it
            is bytes. Of `SHARED` bytes or more it is returned as a `memoryview`.
        seconds : float
            Time limit [s], after which the process is ended.
        look : callable, optional
            Awaited every half second; if it raises, the process is ended and the error passed on.

        Raises
        ------
        StoppedError
            If the function takes longer than the limit.
        EndedError
            If the process dies.
        Exception
            What the function raises.
        """
        process = self._ready() or await self._new()
        loop = asyncio.get_running_loop()
        call = loop.run_in_executor(self._threads, process.call, function, arguments)
        until = time.monotonic() + seconds
        try:
            while True:
                left = until - time.monotonic()
                if (await asyncio.wait({call}, timeout=max(0.0, min(LOOK, left))))[0]:
                    return call.result()
                if left <= 0:
                    raise StoppedError(
                        f"The computation was stopped at the service's time limit of {seconds:g} s."
                    )
                if look is not None:
                    await look()
        finally:
            if call.done() and process.calls < CALLS:
                self._keep(process)
            else:
                process.kill()
                await asyncio.wait({call})  # it finds the end of the process
                if not call.cancelled():
                    call.exception()  # is no news
                process.close()

    def close(self) -> None:
        """Kill all processes of the pool."""
        self._is_closed = True
        while self._idle:
            process = self._idle.pop()
            process.kill()
            process.close()
        self._threads.shutdown(cancel_futures=True)

    async def _new(self) -> _Process:
        """Start a new process, in a thread."""
        return await asyncio.get_running_loop().run_in_executor(
            self._threads, _Process, self._context
        )

    def _ready(self) -> _Process | None:
        """Return an idle process that is alive, which the caller then has.

        None if there is none.
        """
        while self._idle:
            process = self._idle.pop()
            if process.is_alive():
                return process
            process.close()
        return None

    def _keep(self, process: _Process) -> None:
        """Keep an idle process for the next call; end it if the pool is closed meanwhile."""
        if self._is_closed:
            process.kill()
            process.close()
        else:
            self._idle.append(process)


class _Process:
    """A process that carries out one call after another."""

    def __init__(self, context: multiprocessing.context.ForkServerContext):
        """Start a process that waits for calls on a pipe."""
        self._pipe, there = context.Pipe()
        self._process = context.Process(target=_carry_out, args=(there,), daemon=True)
        self._process.start()
        there.close()
        self.calls = 0

    def is_alive(self) -> bool:
        """True if the process can take another call."""
        return self._process.is_alive()

    def call(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        """Run a function in the process and wait for its result, which is returned.

        An error that the function raises is raised here. `function` is one that can be pickled,
        `arguments` are its arguments.

        Raises
        ------
        EndedError
            If the process dies; it is then not used again.
        """
        self.calls += 1
        try:
            self._pipe.send((function, arguments))
            kind = self._pipe.recv_bytes()
            content = _received(self._pipe) if kind == LARGE else self._pipe.recv_bytes()
        except (OSError, EOFError, RuntimeError) as error:  # the last: a file has not arrived
            self.calls = CALLS  # it is not used again
            raise EndedError(
                "The process that computed the reply died, perhaps because memory ran out."
            ) from error
        if kind in (BYTES, LARGE):
            return content
        result = pickle.loads(content)
        if kind == ERROR:
            raise result
        return result

    def kill(self) -> None:
        """Kill the process at once."""
        self._process.kill()

    def close(self) -> None:
        """Free the resources of an ended process that no call uses."""
        self._pipe.close()


def _carry_out(pipe: Connection) -> None:
    """Run calls that arrive through a pipe until its other end is closed.

    This is the child process. A call is a pair of function and arguments; the reply is its kind,
    then the result or error.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal: the service ends us
    lower_priority(POLITE)
    with contextlib.suppress(AttributeError, OSError):  # else replies wait a little longer
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))  # never interrupts the server
    while True:
        try:
            function, arguments = pipe.recv()
        except EOFError:
            return
        try:
            content = result = function(*arguments)
            if isinstance(result, bytes):
                kind = LARGE if len(result) >= SHARED else BYTES
            else:
                kind, content = VALUE, pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
        except Exception as error:
            kind, content = ERROR, pickle.dumps(_portable(error))
        pipe.send_bytes(kind)
        if kind == LARGE:
            _hand_over(pipe, content)
        else:
            pipe.send_bytes(content)
        content = result = None  # free until the next call


def _hand_over(pipe: Connection, content: bytes) -> None:
    """Send a large result through a pipe as a file in memory, which the other process maps."""
    with open(os.memfd_create("result"), "wb", buffering=0) as file:  # noqa: PTH123 of a descriptor
        left = memoryview(content)
        while left:
            left = left[file.write(left) :]
        reduction.send_handle(pipe, file.fileno(), os.getppid())


def _received(pipe: Connection) -> memoryview:
    """Return a large result that `_hand_over` has sent; nothing is copied."""
    descriptor = reduction.recv_handle(pipe)
    try:
        return memoryview(mmap.mmap(descriptor, 0, prot=mmap.PROT_READ))  # all of it
    finally:
        os.close(descriptor)


def _portable(error: Exception) -> Exception:
    """Return an error that can be pickled, with its traceback as a note if it was unexpected.

    An error that cannot be pickled becomes a `RuntimeError` with its text.
    """
    if not isinstance(error, VibrafeedError):
        error.add_note(traceback.format_exc())
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        portable = RuntimeError(repr(error))
        portable.add_note(traceback.format_exc())
        return portable
    return error
