"""Around nearly all else: a request has an identifier, a line in the log, and is counted."""

from __future__ import annotations

import logging
import re
import time
import uuid
from contextlib import nullcontext
from typing import TYPE_CHECKING

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from vibrafeed.app import logs
from vibrafeed.app.web.metrics import Metrics
from vibrafeed.app.web.problems import unforeseen

if TYPE_CHECKING:
    from vibrafeed.app.spans import Traces

logger = logging.getLogger("vibrafeed.requests")

REQUEST_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
CLIENT_LEFT = 499  # the status that proxies log for a client that left before the reply
MAX_LEFT_LINES = 20  # log lines a second on clients that left
MAX_READ_LINES = 150  # log lines a second on requests that only read: 4 GB a day at 300 bytes each
NO_ROUTE = "(none)"


class Observe:
    """Outermost middleware: gives requests identifiers, logs and counts them, handles errors."""

    def __init__(self, app: ASGIApp, metrics: Metrics, traces: Traces | None = None):
        """Wrap an application; record its requests in metrics, traces and log."""
        self.app = app
        self.metrics, self.traces = metrics, traces
        self._left = logs.Sparing(
            MAX_LEFT_LINES,
            "requests of clients that left before they were answered are not counted",
        )
        self._read = logs.Sparing(MAX_READ_LINES, "requests that read have no lines of their own")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request; write its log line, metrics and span when the reply has ended.

        An unforeseen error is logged, and becomes a 500 if the reply has not begun. The arguments
        are those of ASGI.
        """
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        given = headers.get("x-request-id", "")
        request_id = given if REQUEST_ID.fullmatch(given) else uuid.uuid4().hex
        status, sent, ended = 0, 0, False

        async def watched(message: Message) -> None:
            """Send a message; record status and size, and add the request's identifier."""
            nonlocal status, sent, ended
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["X-Request-ID"] = request_id
            elif message["type"] == "http.response.body":
                sent += len(message.get("body", b""))
                ended = not message.get("more_body", False)
            await send(message)

        started = time.perf_counter()
        with (
            logs.request(request_id=request_id) as fields,
            self.metrics.under_way.track_inprogress(),
            self.traces.request(headers) if self.traces else nullcontext() as span,
        ):
            try:
                await self.app(scope, receive, watched)
            except ClientDisconnect:
                status = status or CLIENT_LEFT
            except Exception as error:
                logger.error("unforeseen error in %s", route_of(scope), exc_info=error)
                # A reply that has begun cannot be taken back; the server cuts the connection.
                if not status:
                    await unforeseen(request_id)(scope, receive, watched)
            finally:
                seconds = time.perf_counter() - started
                route = route_of(scope)
                self.metrics.count(scope["method"], route, status, seconds)
                if self.traces and span is not None:
                    self.traces.answered(span, scope["method"], route, status)
                line = {
                    "method": scope["method"],
                    "route": route,
                    "status": status,
                    "milliseconds": round(seconds * 1e3, 2),
                    "bytes": sent,
                    "client": (scope.get("client") or (None,))[0],
                }
                if not ended:
                    line["cut_short"] = True
                if self._has_room(scope["method"], status):
                    logger.info("request", extra={**line, **fields})

    def _has_room(self, method: str, status: int) -> bool:
        """True if a request has a line: all that change something, or went wrong here, have one."""
        if status == CLIENT_LEFT:
            return self._left.has_room()
        return method not in ("GET", "HEAD") or status >= 500 or self._read.has_room()


def route_of(scope: Scope) -> str:
    """Return the route template of a request, such as `/sweeps/{key}`; `(none)` if no route fits.

    Real paths may be secret and are not recorded. `scope` is ASGI's description of the request.
    """
    route = scope.get("route")
    template = getattr(route, "path_format", None) or getattr(route, "path", None)
    if template is None and scope.get("endpoint") is not None:
        return f"{scope.get('root_path', '')}/{{path}}"  # files under a mount
    return template or NO_ROUTE
