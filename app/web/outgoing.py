"""Replies on their way out: in pieces, and no more of them in memory than a bound allows."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable

from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from vibrafeed.app.web.problems import STATUS, BusyError
from vibrafeed.app.web.replies import problem_document

WHOLE = 1 << 20  # bytes of the longest body that is sent at once: pieces cost it a third more time
PIECE = 1 << 18  # bytes of a longer one that are sent at a time: others wait no longer than for one
SMALL = 1 << 16  # bytes of a body that is not counted: a connection holds as much anyway


class Tide:
    """Detects that a number has fallen far below the largest value that it had."""

    def __init__(self) -> None:
        """Begin with a largest value of 0."""
        self._highest = 0

    def rise(self, now: int) -> None:
        """Record the current value; the largest one is kept."""
        self._highest = max(self._highest, now)

    def has_fallen(self, now: int, by: int) -> bool:
        """True if a value is `by` or more below its largest since this was last true.

        `now` is the present value, such as a number of connections. It then is a good time to give
        freed memory back to the system.
        """
        self.rise(now)
        if self._highest - now < by:
            return False
        self._highest = now
        return True


class Unsent:
    """Counts the bytes of replies that are made or wait for their readers.

    Threads may use it at the same time.

    Parameters
    ----------
    most : int
        The bound; a single reply may be larger, so that it can be sent at all.
    """

    def __init__(self, most: int):
        """Allow at most `most` unsent bytes."""
        self._most, self._lock = most, threading.Lock()
        self._bytes = 0
        self._tide = Tide()

    def take(self, size: int) -> None:
        """Add the bytes of a reply to the count of unsent ones; `BusyError` beyond the bound.

        A single reply may be larger than the bound. `size` is in bytes; `give_back` subtracts them
        when they have left.
        """
        with self._lock:
            if self._bytes and self._bytes + size > self._most:
                raise BusyError(
                    "The service holds too many replies that clients have not read. Send the "
                    "request again later."
                )
            self._bytes += size
            self._tide.rise(self._bytes)

    def give_back(self, size: int) -> None:
        """Subtract bytes from the count."""
        with self._lock:
            self._bytes -= size

    def has_fallen(self, by: int) -> bool:
        """True if the count is `by` or more below its largest since this was last true."""
        with self._lock:
            return self._tide.has_fallen(self._bytes, by)


class _Share:
    """The share of the output buffer that one request has taken."""

    def __init__(self, unsent: Unsent):
        """Begin with no reserved bytes."""
        self._unsent, self.size = unsent, 0

    def enlarge(self, size: int) -> None:
        """Reserve more unsent bytes for this request, if `size` exceeds what it has reserved.

        Raises `BusyError` if all requests together would exceed the bound.
        """
        if size > max(self.size, SMALL):
            self._unsent.take(size - self.size)
            self.size = size

    def close(self) -> None:
        """Free the share of this request."""
        self._unsent.give_back(self.size)


def reserve_bytes(request: Request, size: int) -> None:
    """Reserve the bytes of a reply before making it; raise `BusyError` if there are too many."""
    enlarge: Callable[[int], None] = request.state.enlarge
    enlarge(size)


class Outgoing:
    """Sends bodies in pieces, the next when the last has left; what is too much becomes a 503.

    In each turn of the event loop one piece is sent, of whichever reply: hundreds of them, copied
    one after another, would keep all others waiting.
    """

    def __init__(self, app: ASGIApp, unsent: Unsent):
        """Wrap an application; its replies count as unsent bytes."""
        self.app, self.unsent = app, unsent
        self._turn = asyncio.Lock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, sending its reply in pieces and limiting unsent bytes."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def send_in_turn(message: Message) -> None:
            """Send a message, if it is large in a turn of the event loop of its own."""
            if len(message.get("body", b"")) > SMALL:
                async with self._turn:
                    await asyncio.sleep(0)
            await send(message)

        share = _Share(self.unsent)
        scope.setdefault("state", {})["enlarge"] = share.enlarge
        try:
            await self.app(scope, receive, _hold_back_head(scope, receive, send_in_turn, share))
        finally:
            share.close()


def _hold_back_head(scope: Scope, receive: Receive, send: Send, share: _Share) -> Send:
    """Return a `send` that holds back the head of a reply until its body is counted.

    A body that does not fit the bound of unsent bytes is replaced by a 503; a large one is sent in
    pieces. `scope`, `receive` and `send` are those of ASGI; `share` is what the request has
    reserved.
    """
    head: Message | None = None
    is_refused = False

    async def bounded(message: Message) -> None:
        """Send a message; refuse the reply if the output buffer is full."""
        nonlocal head, is_refused
        if is_refused:
            return
        if message["type"] == "http.response.start":
            head = message
            return
        body = message.get("body", b"")
        if head is not None:
            try:
                share.enlarge(len(body))
            except BusyError as error:
                is_refused = True
                await _busy(scope, receive, send, error)
                return
            await send(head)
            head = None
        if len(body) <= WHOLE:
            await send(message)
            return
        view = memoryview(body)
        for start in range(0, len(body), PIECE):
            piece = view[start : start + PIECE]
            await send({"type": "http.response.body", "body": piece, "more_body": True})
        # This waits until nearly all has left.
        await send({**message, "body": b""})

    return bounded


async def _busy(scope: Scope, receive: Receive, send: Send, error: BusyError) -> None:
    """Send the reply 503 instead of a reply that does not fit the output buffer."""
    reply = problem_document(*STATUS[BusyError], str(error), headers={"Retry-After": "1"})
    await reply(scope, receive, send)
