"""uvicorn as `vibrafeed serve` runs it: it drains before it stops, within a known time."""

from __future__ import annotations

import logging
import os
import signal
import socket
import threading
from collections.abc import Callable
from types import FrameType

import uvicorn
from fastapi import FastAPI

from vibrafeed.app.settings import Settings

logger = logging.getLogger("vibrafeed")

# s from the end of all replies to that of the process: jobs are handed on, workers ended, files
# written. Containers give 10 s in all.
LAST = 5.0
MAX_HEAD = 16_384  # bytes of the head of a request
# s that an idle connection is kept: longer than nginx (60) and Caddy (120) keep theirs, or what
# they send could meet the end of it.
KEEP_ALIVE = 150


class Server(uvicorn.Server):
    """Tells the application that a signal asks it to stop, and ends within a time that is known.

    New work is refused from then on, and replies without an end are ended. All else is answered for
    `drain_seconds`, and waited for `shutdown_seconds`. The exit code is 0: uvicorn would raise the
    signal again.
    """

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to stop; Ctrl-C or a second signal ends the draining, a further one all waiting."""
        state = self.config.app.state  # type: ignore[union-attr]
        is_first = not state.stopping.is_set()
        state.stopping.set()
        drains = is_first and sig != signal.SIGINT
        seconds = state.settings.drain_seconds if drains else 0.0
        self.force_exit = self.should_exit  # True from the signal after the draining on
        if seconds:
            _after(seconds, self._end_draining)
        else:
            self._end_draining()
        if is_first:
            _after(seconds + state.settings.shutdown_seconds + LAST, _cut_short)

    def _end_draining(self) -> None:
        self.should_exit = True

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Finish or abort open requests, then stop the application."""
        await super().shutdown(sockets)
        if self.force_exit:  # uvicorn leaves the application as it is then
            await self.lifespan.shutdown()


def _after(seconds: float, call: Callable[[], None]) -> None:
    timer = threading.Timer(seconds, call)
    timer.daemon = True
    timer.start()


def _cut_short() -> None:
    logger.warning("stopping takes too long and is cut short")
    os._exit(0)


def serve_until_stopped(
    app: FastAPI, settings: Settings, host: str, port: int, *, behind_proxy: bool = False
) -> None:
    """Serve an application at an address until a signal ends it.

    Parameters
    ----------
    app : FastAPI
        The application, as `create_app` makes it.
    settings : Settings
        The service's.
    host, port : str, int
        Address and port on which it listens.
    behind_proxy : bool
        Believe the client's address and scheme as a proxy forwards them. The proxy has an address
        of this machine, or one that uvicorn's variable `FORWARDED_ALLOW_IPS` names.
    """
    config = uvicorn.Config(
        app,
        host=host,
        port=port,
        http="h11",  # whatever else is installed: it limits heads
        h11_max_incomplete_event_size=MAX_HEAD,
        ws="none",
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=settings.shutdown_seconds,
        proxy_headers=behind_proxy,
        root_path=settings.root_path,
        server_header=False,
        log_config=None,
        access_log=False,  # it writes paths and query strings; ours writes routes
    )
    server = Server(config)
    hangup = getattr(signal, "SIGHUP", None)  # Windows has none, and `nohup` ignores it
    if hangup and signal.getsignal(hangup) is signal.SIG_DFL:
        signal.signal(hangup, server.handle_exit)
    server.run()
    if not (server.started or app.state.stopping.is_set()):
        raise SystemExit(1)  # the log says why it did not start
