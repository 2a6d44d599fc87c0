"""Entry with a key: which one it is, what its role allows, and how often it may ask."""

from __future__ import annotations

import asyncio
import logging
import time

from limits import RateLimitItemPerMinute, RateLimitItemPerSecond
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter
from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import Scope

from vibrafeed.app import logs
from vibrafeed.app.jobs.fair_queue import OF_KEY
from vibrafeed.app.jobs.keys import NOBODY, Key, Keys, hash_of
from vibrafeed.app.web.replies import problem_document

logger = logging.getLogger("vibrafeed.keys")

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
# Figures of all owners together.
ADMIN_PATHS = frozenset({"/metrics"})
NOT_ALLOWED = "The role of the key does not allow it"
MAX_KEYS = 2  # in one request: each takes a look at all keys
SOON = 0.01  # s between checks that another request has read the keys
INVALID = RateLimitItemPerMinute(60)  # wrong keys of an address; more of them are answered by 429
FIRST = RateLimitItemPerMinute(1)  # of them, which is noted in the audit log
NOTED = RateLimitItemPerMinute(10)  # entries there in all: each is written to the disk


def path_of(scope: Scope) -> str:
    """Return the path of a request without the prefix that a proxy adds.

    `scope` is ASGI's description of the request.
    """
    path: str = scope.get("path", "")
    return path.removeprefix(scope.get("root_path", ""))


def owner_of(scope: Scope) -> str:
    """Return the account of a request: the name of its key, or its address without keys.

    `scope` is ASGI's description of the request. Shares of the service are counted per account.
    """
    name = getattr(scope.get("state", {}).get("key"), "name", "")
    return f"{OF_KEY}{name}" if name else str((scope.get("client") or ("",))[0])


class Entry:
    """Finds the API key of a request, and refuses requests that the key does not allow.

    Parameters
    ----------
    keys : Keys
        All keys that exist.
    """

    def __init__(self, keys: Keys):
        """Check requests against keys; wrong keys are counted."""
        self.keys = keys
        self._is_looking = False
        # In this process's memory: of several servers each allows so many.
        self._rates = MovingWindowRateLimiter(MemoryStorage())

    async def refresh_keys(self) -> None:
        """Read the API keys from the ledger if due; requests meanwhile use the keys read before.

        One request reads at a time, in a thread. The others wait only if the known keys are old.

        Raises
        ------
        Exception
            If the keys have never been read and the ledger cannot be read.
        """
        while self.keys.is_due:
            if not self._is_looking:
                self._is_looking = True
                try:
                    await asyncio.to_thread(self.keys.refresh)
                finally:
                    self._is_looking = False
            elif self.keys.is_fresh:
                return
            else:
                await asyncio.sleep(SOON)

    async def refusal(self, scope: Scope, headers: Headers) -> Response | None:
        """Return the error reply to a request without a valid key; None if its key is accepted.

        The reply is 401 without a valid key, 403 if its role does not allow the request, and 429
        for too many requests. An accepted key is stored in the state of the request. `scope` is
        ASGI's description of the request.
        """
        if not self.keys.are_needed:
            scope.setdefault("state", {})["key"] = NOBODY
            return None
        sent = set(_sent_keys(headers))
        if len(sent) > MAX_KEYS:
            return _key_needed(f"{len(sent):,} keys are sent. Send one.")
        if not sent:
            return _key_needed("Send a key: `Authorization: Bearer KEY`, or `X-API-Key: KEY`.")
        now = time.time()
        # One wrong key among right ones is refused: a client that sends it is mistaken.
        keys = [self.keys.of_hash(hash_of(secret)) for secret in sent]
        names = {key.name for key in keys if key is not None and key.in_force(now)}
        if len(names) != 1 or not all(key is not None and key.in_force(now) for key in keys):
            name = next((key.name for key in keys if key is not None), "")
            return await self._refuse_key(str((scope.get("client") or ("",))[0]), name)
        # All are one key: a name has only one key in force.
        (key,) = {key.hash: key for key in keys if key is not None}.values()
        logs.bind(key=key.name)
        scope.setdefault("state", {})["key"] = key
        return self._refuse_by_limits(scope, key)

    async def _refuse_key(self, address: str, name: str) -> Response:
        """Return the reply to a wrong key: 401, or 429 after very many of an address.

        The first of an address in a minute goes to the audit log. `name` is that of the key if it
        was in force once, else empty.
        """
        if self._rates.hit(FIRST, "first", address) and self._rates.hit(NOTED, "noted"):
            try:
                await asyncio.to_thread(self.keys.note_refused, address, name)
            except Exception:  # such as a full disk: the key is refused all the same
                logger.exception("a refused key cannot be noted")
        if self._rates.hit(INVALID, "invalid", address):
            return _key_needed("The access key is unknown.")
        return problem_document(
            429, "wrong-keys", "Too many wrong keys", "Repeat the request with the right key.",
            headers={"Retry-After": "60"},
        )  # fmt: skip

    def _refuse_by_limits(self, scope: Scope, key: Key) -> Response | None:
        """Return the reply to a request beyond what an API key allows; None if it may pass.

        It is 403 if its role does not allow the request: `read` may change nothing, and some paths
        need `admin`. It is 429 if it sends more requests per second than it may.
        """
        if key.role == "read" and scope["method"] not in SAFE_METHODS:
            detail = "The role of this key is `read`: it may post, change and dismiss nothing."
            return problem_document(403, "role", NOT_ALLOWED, detail)
        if key.role != "admin" and path_of(scope) in ADMIN_PATHS:
            detail = f"This needs a key of the role `admin`; the role of this one is `{key.role}`."
            return problem_document(403, "role", NOT_ALLOWED, detail)
        if key.requests is None or self._rates.hit(RateLimitItemPerSecond(key.requests), key.name):
            return None
        detail = f"Your key may send {key.requests:,} requests a second."
        return problem_document(
            429, "rate", "Too many requests", detail, headers={"Retry-After": "1"}
        )


def _key_needed(detail: str) -> Response:
    return problem_document(
        401, "key", "A key is needed", detail, headers={"WWW-Authenticate": "Bearer"}
    )


def _sent_keys(headers: Headers) -> list[str]:
    keys = headers.getlist("x-api-key")
    for value in headers.getlist("authorization"):
        scheme, _, key = value.partition(" ")
        if scheme.lower() == "bearer":
            keys.append(key.strip())
    return keys
