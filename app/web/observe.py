"""Around all else: a request has an identifier, a line in the log, a count, and safe headers."""

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
from vibrafeed.app.web.entry import path_of
from vibrafeed.app.web.guard import is_docs, is_page
from vibrafeed.app.web.metrics import Metrics
from vibrafeed.app.web.problems import unforeseen

if TYPE_CHECKING:
    from vibrafeed.app.spans import Traces

logger = logging.getLogger("vibrafeed.requests")

REQUEST_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
CLIENT_LEFT = 499  # the status that proxies log for a client that left before the reply
NO_ROUTE = "(none)"
ABSOLUTE = re.compile(r"https?://([^/?#]*)(.*)", re.IGNORECASE | re.DOTALL)

# No route sets one of them.
SAFE = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
API_POLICY = "default-src 'none'; frame-ancestors 'none'"
# Both pages: no script, style or handler within them, nothing that comes from elsewhere.
PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)


class Observe:
    """Outermost middleware: gives requests identifiers, logs and counts them, handles errors."""

    def __init__(self, app: ASGIApp, metrics: Metrics, traces: Traces | None = None):
        """Wrap an application; record its requests in metrics, traces and log."""
        self.app = app
        self.metrics, self.traces = metrics, traces

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request; write its log line, metrics and span when the reply has ended.

        An unforeseen error is logged, and becomes a 500 if the reply has not begun. The arguments
        are those of ASGI.
        """
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        _take_absolute_form(scope)
        path = path_of(scope)
        policy = PAGE_POLICY if is_docs(path) or is_page(path) else API_POLICY
        headers = Headers(scope=scope)
        sent_id = headers.get("x-request-id", "")
        request_id = sent_id if REQUEST_ID.fullmatch(sent_id) else uuid.uuid4().hex
        status, bytes_sent, has_ended = 0, 0, False

        async def send_and_record(message: Message) -> None:
            """Send a message; record status and size, and add headers to the start of a reply."""
            nonlocal status, bytes_sent, has_ended
            if message["type"] == "http.response.start":
                status = message["status"]
                added = {**SAFE, "Content-Security-Policy": policy, "X-Request-ID": request_id}
                MutableHeaders(scope=message).update(added)
            elif message["type"] == "http.response.body":
                bytes_sent += len(message.get("body", b""))
                has_ended = not message.get("more_body", False)
            await send(message)

        started = time.perf_counter()
        with (
            logs.request(request_id=request_id) as fields,
            self.metrics.under_way.track_inprogress(),
            self.traces.request(headers) if self.traces else nullcontext() as span,
        ):
            try:
                await self.app(scope, receive, send_and_record)
            except ClientDisconnect:
                status = status or CLIENT_LEFT
            except Exception as error:
                logger.error("unforeseen error in %s", route_of(scope), exc_info=error)
                # A reply that has begun cannot be taken back; the server cuts the connection.
                if not status:
                    await unforeseen(request_id)(scope, receive, send_and_record)
            finally:
                seconds = time.perf_counter() - started
                route = route_of(scope)
                cause = str(fields.get("problem", "")) if status >= 400 else ""
                self.metrics.count(scope["method"], route, status, seconds, cause)
                if self.traces and span is not None:
                    self.traces.answered(span, scope["method"], route, status)
                line = {
                    "method": scope["method"],
                    "route": route,
                    "status": status,
                    "milliseconds": round(seconds * 1e3, 2),
                    "bytes": bytes_sent,
                    "client": (scope.get("client") or (None,))[0],
                }
                if not has_ended:
                    line["cut_short"] = True
                logger.info("request", extra={**line, **fields})


def _take_absolute_form(scope: Scope) -> None:
    """Give a request for a whole URL, as clients send to proxies, its path and host (RFC 9112)."""
    root = scope.get("root_path", "")
    absolute = ABSOLUTE.fullmatch(scope["path"].removeprefix(root))
    if absolute:
        host, path = absolute.groups()
        scope["path"] = f"{root}{path or '/'}"
        others = [pair for pair in scope["headers"] if pair[0] != b"host"]
        scope["headers"] = [(b"host", host.encode()), *others]


def route_of(scope: Scope) -> str:
    """Return the route template of a request, such as `/sweeps/{key}`; `(none)` if no route fits.

    Real paths may be secret and are not recorded. `scope` is ASGI's description of the request.
    """
    route = scope.get("route")
    template = getattr(route, "path_format", None) or getattr(route, "path", None)
    if template is None and scope.get("endpoint") is not None:
        return f"{scope.get('root_path', '')}/{{path}}"  # files under a mount
    return template or NO_ROUTE
