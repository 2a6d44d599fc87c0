"""uvicorn as `vibrafeed serve` runs it."""

from __future__ import annotations

import asyncio
import contextlib
import ctypes
import logging
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType

import uvicorn
from fastapi import FastAPI

from vibrafeed.app.settings import Settings
from vibrafeed.app.web.connections import ACCEPTED_AT_ONCE, Connection
from vibrafeed.app.web.outgoing import Tide

logger = logging.getLogger("vibrafeed")

# Connections that wait to be taken in; the system drops one more, which comes back after seconds.
QUEUE = 4096
# s from the end of all replies to that of the process: jobs are handed on, workers ended, files
# written. Containers give 10 s in all.
LAST = 5.0
# Connections that have closed before their memory is given back to the system: each that read a
# file has held a megabyte.
CROWD = 64


class Server(uvicorn.Server):
    """Tells the app that a signal asks it to stop, and ends within a time that is known.

    New work is refused from then on, and replies without an end are ended. All else is answered for
    `drain_seconds`, and waited for `shutdown_seconds`.

    Parameters
    ----------
    config : uvicorn.Config
        What is served, and how.
    end : callable, optional
        Is called, on a thread of its own, if it has not ended in time.
    """

    def __init__(self, config: uvicorn.Config, end: Callable[[], object] = lambda: None):
        """Serve with uvicorn's configuration; `end` ends the process at last."""
        super().__init__(config)
        self._end = end
        self._drained = float("inf")  # when the draining ends [s, monotonic]
        self._crowd = Tide()  # of connections

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Record a signal to stop; a second one, or Ctrl-C, ends the waiting for open requests.

        `sig` is the signal's number; `frame` is not used. After SIGTERM requests are still answered
        for `drain_seconds`.
        """
        state = self.config.app.state  # type: ignore[union-attr]
        is_first = not state.stopping.is_set()
        state.stopping.set()
        super().handle_exit(sig, frame)
        drain = state.settings.drain_seconds if sig == signal.SIGTERM else 0.0
        if is_first:
            self.should_exit = drain == 0
            self._drained = time.monotonic() + drain
            timer = threading.Timer(drain + state.settings.shutdown_seconds + LAST, self._end)
            timer.daemon = True
            timer.start()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen for connections with a long queue, of which few are accepted at a time.

        uvicorn calls it once, with the `sockets` to listen on, if any are open already. Then
        kernels are compiled and a first process is started in the background, if the settings say
        so.
        """
        prepare_routes(self.config.app)  # type: ignore[arg-type]
        await super().startup(sockets)
        for listener in (one for server in self.servers for one in server.sockets):
            with socket.socket(fileno=os.dup(listener.fileno())) as same:
                same.listen(QUEUE)
        if self.config.app.state.settings.warm_at_start:  # type: ignore[union-attr]
            self.config.app.state.warmth.start()  # type: ignore[union-attr]
            self._first = asyncio.create_task(self.config.app.state.process_pool.start())  # type: ignore[union-attr]

    async def on_tick(self, counter: int) -> bool:
        """Check connections, free memory after a crowd, and end the draining; True to stop serving.

        uvicorn calls it ten times a second; `counter` is the number of the call.
        """
        if counter % 10 == 0:
            connections = list(self.server_state.connections)
            for connection in connections:
                connection.look()  # type: ignore[union-attr]
            is_crowd_gone = self._crowd.has_fallen(len(connections), CROWD)
            if self.config.app.state.unsent.has_fallen(KEPT) or is_crowd_gone:  # type: ignore[union-attr]
                await asyncio.to_thread(give_memory_back)
        self.should_exit |= time.monotonic() >= self._drained
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Stop compiling, finish or abort open requests, and wait a second for their log lines.

        uvicorn calls it once, with the `sockets` that it was started with, when the server is to
        stop.
        """
        await self.config.app.state.warmth.stop()  # type: ignore[union-attr]
        await super().shutdown(sockets)
        if self.server_state.tasks:  # cancelled, and their lines in the log not yet written
            await asyncio.wait(self.server_state.tasks, timeout=1)


def prepare_routes(app: FastAPI) -> None:
    """Let FastAPI analyse all routes now instead of when a request first reaches them.

    It takes a second in the event loop, which requests would wait for.
    """
    nowhere = {"type": "http", "method": "GET", "path": "/-", "root_path": "", "headers": []}
    for route in app.router.routes:
        route.matches(nowhere)


def _end() -> None:
    """End the process at once without cleaning up; everything of value is on disk."""
    logger.warning("stopping takes too long and is cut short")
    os._exit(1)


# s between turns of threads that compute; the event loop waits for one of them, at worst, each time
# it wakes up. The interpreter's own 5 ms show in every reply of a busy server.
TURN = 0.001


# Of glibc's mallopt: what to set, to how much. Arrays of a reply are given back to the system and
# taken again otherwise, page by page, and that takes longer than computing them.
KEPT = 128 << 20
MALLOPT = {
    -3: 32 << 20,  # M_MMAP_THRESHOLD: blocks up to here, its largest value, come from the heap
    -1: KEPT,  # M_TRIM_THRESHOLD: of the heap so much stays when it is free
    -8: 1,  # M_ARENA_MAX: one heap, or each thread would keep as much
}


def keep_memory() -> None:
    """Set how the C library keeps freed memory for reuse; does nothing with other C libraries.

    Memory that is given back at once costs the system much time to get again.
    """
    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):
        for name, value in MALLOPT.items():
            library.mallopt(name, value)


def give_memory_back() -> None:
    """Return free memory between used blocks to the system."""
    library = ctypes.CDLL(None)
    if hasattr(library, "malloc_trim"):
        library.malloc_trim(0)


def serve_until_stopped(app: FastAPI, settings: Settings, host: str, port: int) -> None:
    """Serve an application at an address until a signal ends it.

    Parameters
    ----------
    app : FastAPI
        The application, as `create_app` makes it.
    settings : Settings
        The service's.
    host, port : str, int
        Address and port on which it listens.
    """
    sys.setswitchinterval(TURN)
    keep_memory()
    config = uvicorn.Config(
        app,
        http=Connection,
        backlog=ACCEPTED_AT_ONCE,
        host=host,
        port=port,
        log_config=None,
        access_log=False,  # it writes paths and query strings; ours writes routes
        server_header=False,
        ws="none",
        root_path=settings.root_path,
        timeout_graceful_shutdown=settings.shutdown_seconds,
    )
    with contextlib.suppress(KeyboardInterrupt):
        Server(config, _end).run()
