"""The guard in front of the routes: names and origins, keys, limits.

A plain ASGI layer: it passes streams on piece by piece. What a key lets do is
`vibrafeed.app.web.entry`'s.
"""

from __future__ import annotations

import ipaddress
import logging
import re
import sqlite3
import threading
from collections import Counter

from fastapi import FastAPI
from fastapi.responses import Response
from starlette.datastructures import Headers
from starlette.middleware.cors import CORSMiddleware
from starlette.types import ASGIApp, Receive, Scope, Send

from vibrafeed.app.jobs import disk
from vibrafeed.app.jobs.fair_queue import OF_KEY
from vibrafeed.app.jobs.keys import Keys
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.entry import SAFE_METHODS, Entry, owner_of, path_of
from vibrafeed.app.web.replies import problem_document

logger = logging.getLogger("vibrafeed")

HEALTH = frozenset({"/healthz", "/readyz"})
DOCS = ("/docs", "/static-offline-docs")
OPEN = HEALTH | {"/openapi.json"}

LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "[::1]"})
MAX_QUERY = 8_192  # bytes of a query: the time to parse one grows faster than its length
MAX_NAMES = 256  # parameters of a query
# One key has at most 1/SHARE of the requests that may be under way; without keys one address
# leaves 1/SHARE of them to others.
SHARE = 4
SOON = {"Retry-After": "1"}
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_HOST = re.compile(r"([a-z0-9._-]+|\[[0-9a-f:.]+\])(:[0-9]{1,5})?")


def is_loopback(host: str) -> bool:
    """True if an address can only be reached from this machine, as `127.0.0.1`, `::1`, `localhost`.

    `host` is an address or a name; other names than localhost are never loopback.
    """
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return host.lower() == "localhost"
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback


def is_open(path: str) -> bool:
    """True if a path may be requested without a key."""
    return path in OPEN or is_docs(path) or is_page(path)


def is_docs(path: str) -> bool:
    """True if a path belongs to the page of the API documentation."""
    return path in DOCS or path.startswith(tuple(f"{start}/" for start in DOCS))


def is_page(path: str) -> bool:
    """True if a path belongs to the web page."""
    return path == "/" or path.startswith("/page/")


def install(app: FastAPI, settings: Settings, keys: Keys, stopping: threading.Event) -> None:
    """Add the middleware of this module to the application; the last one added runs first.

    It limits requests, checks keys and origins, and lets pages of the allowed origins in (CORS).
    Once `stopping` is set, new work is refused.
    """
    app.add_middleware(Guard, settings=settings, keys=keys, stopping=stopping)
    if settings.cors_origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.cors_origins,
            allow_methods=["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE"],
            allow_headers=[
                "Authorization", "Content-Type", "If-Match", "If-None-Match", "If-Range",
                "Last-Event-ID", "Prefer", "Range", "X-API-Key", "X-Request-ID",
            ],
            expose_headers=[
                "Accept-Ranges", "Content-Disposition", "Content-Range", "ETag", "Location",
                "Preference-Applied", "Repr-Digest", "Retry-After", "Vibrafeed-Note",
                "X-Request-ID",
            ],
        )  # fmt: skip


class Guard:
    """Middleware that refuses requests before their body is read.

    It lets in requests with a valid key or, without keys, those of this machine, within the limits
    of the service, and no new work once the service stops.
    """

    def __init__(self, app: ASGIApp, settings: Settings, keys: Keys, stopping: threading.Event):
        """Wrap an application, with the keys, the allowed origins and the limits."""
        self.app = app
        self.settings, self.stopping = settings, stopping
        self.entry = Entry(keys)
        self.under_way: Counter[str] = Counter()  # by owner

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, or refuse it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        # Requests for health are answered however much is under way.
        is_limited = path_of(scope) not in HEALTH
        refusal = await self._refuse_entry(scope)
        if refusal is None and is_limited:
            refusal = self._refuse_excess(scope)
        if refusal is not None or not is_limited:
            await (refusal or self.app)(scope, receive, send)
            return
        owner = owner_of(scope)
        self.under_way[owner] += 1
        try:
            await self.app(scope, receive, send)
        finally:
            self.under_way[owner] -= 1
            self.under_way = +self.under_way  # without owners who have none

    async def _refuse_entry(self, scope: Scope) -> Response | None:
        """Return the error reply to a request that may not enter; None if it may.

        Checked are path, query and host, the origin of the page that sent it, and the key. `scope`
        is ASGI's description of the request.
        """
        path = path_of(scope)
        if _CONTROL.search(path):  # routes do not tell a path from one with a line's end after it
            detail = "The path holds characters that no resource has in its name."
            return problem_document(404, "not-found", "There is no such resource", detail)
        query = scope["query_string"]
        if len(query) > MAX_QUERY or query.count(b"&") >= MAX_NAMES:
            detail = f"A query has at most {MAX_QUERY:,} bytes and {MAX_NAMES} names."
            return problem_document(414, "query", "The query is too long", detail)
        try:
            if not (is_open(path) and self.entry.keys.is_known):
                await self.entry.refresh_keys()
        except (OSError, sqlite3.Error) as error:
            if path in HEALTH:
                return None
            logger.error("keys cannot be read", exc_info=error)
            return problem_document(
                503, "busy", "The service is busy", f"{disk.cause_of(error)}.",
                headers={"Retry-After": "5"},
            )  # fmt: skip
        headers = Headers(scope=scope)
        host = headers.get("host", "").lower()
        host_parts = _HOST.fullmatch(host)
        if host and not host_parts:
            detail = "The header Host holds no name."
            return problem_document(400, "host", "The request names no host", detail)
        refusal = None
        if not self.entry.keys.are_needed:
            refusal = self._refuse_other_machine(scope, host_parts[1] if host_parts else "")
        refusal = refusal or self._refuse_other_page(scope["method"], headers, host)
        if refusal is None and not is_open(path):
            refusal = await self.entry.refusal(scope, headers)
        return refusal

    def _refuse_other_machine(self, scope: Scope, host_name: str) -> Response | None:
        """Return the reply 403 to a request from another machine while no keys exist; else None.

        A web page whose own name resolves to this machine gets the same reply: `host_name`
        must be a loopback name.
        """
        address = (scope.get("server") or ("",))[0] or "/"
        is_unix_socket = address.startswith("/")
        if not is_unix_socket and not is_loopback(address):
            reason = "No keys exist, so the service answers only on loopback addresses."
        elif host_name not in LOOPBACK_NAMES:
            # Any page can have a name of its own resolve to 127.0.0.1; its browser still sends it.
            reason = (
                "No keys exist, so the service answers only to the names localhost and 127.0.0.1."
            )
        else:
            return None
        fix = "`vibrafeed key add` makes a key."
        return problem_document(403, "no-keys", "The service has no keys", f"{reason} {fix}")

    def _refuse_other_page(self, method: str, headers: Headers, host: str) -> Response | None:
        """Return the reply 403 to a change that a page of another origin has its browser send.

        None if the request has no such origin, only reads, or comes from an allowed origin. `host`
        is the Host header in small letters.
        """
        origin = headers.get("origin")
        if origin is None or method in SAFE_METHODS or origin in self.settings.cors_origins:
            return None
        if host and origin.lower().partition("://")[2] == host:
            return None
        detail = "Pages of other origins may only read. VIBRAFEED_CORS_ORIGINS names exceptions."
        return problem_document(403, "origin", "The page comes from another origin", detail)

    def _refuse_excess(self, scope: Scope) -> Response | None:
        """Return the error reply to a request beyond the service's limits; None if it may pass.

        The reply is 429 if the account has its share of the requests under way, 503 if the service
        has as many as it takes, or stops. `scope` is ASGI's description of the request.
        """
        owner, max_requests = owner_of(scope), self.settings.max_requests
        is_full = self.under_way.total() >= max_requests
        share = max_requests // SHARE
        has_key = owner.startswith(OF_KEY)
        max_of_owner = max(1, share if has_key else max_requests - share)
        if self.under_way[owner] >= max_of_owner and not is_full:
            detail = f"You have {max_of_owner:,} requests under way, which is your share."
            return problem_document(429, "rate", "Too many requests", detail, headers=SOON)
        if is_full:
            detail = f"{max_requests:,} requests are under way, the most that are taken at a time."
            return problem_document(503, "busy", "The service is busy", detail, headers=SOON)
        if scope["method"] == "POST" and self.stopping.is_set():
            detail = "The service takes no new work. Accepted work continues on the next server."
            later = {"Retry-After": "5", "Connection": "close"}
            return problem_document(
                503, "stopping", "The service is stopping", detail, headers=later
            )
        return None
