"""A service that stops takes no new work, and says so at once."""

from __future__ import annotations

import threading

from starlette.types import ASGIApp, Receive, Scope, Send

from vibrafeed.app.web.replies import problem_document

RETRY = "5"  # s after which another server, or the next one, may answer


class Stopping:
    """Refuses new work once the service has been told to stop; reading and dismissing go on."""

    def __init__(self, app: ASGIApp, stopping: threading.Event):
        """Wrap an application; `stopping` is set once the service is to stop."""
        self.app = app
        self.stopping = stopping

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, or refuse it if it asks for new work while the service stops."""
        if scope["type"] == "http" and scope["method"] == "POST" and self.stopping.is_set():
            detail = "The service takes no new work. Accepted work continues on the next server."
            headers = {"Retry-After": RETRY, "Connection": "close"}
            reply = problem_document(
                503, "stopping", "The service is stopping", detail, headers=headers
            )
            await reply(scope, receive, send)
            return
        await self.app(scope, receive, send)
