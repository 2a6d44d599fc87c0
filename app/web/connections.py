"""Connections: how many there may be, and how long a client may keep one waiting.

A client that sends its request, or reads its reply, too slowly is cut off; where there are too many
connections, one without a request under way makes room for the next, so that whoever comes last is
heard, /healthz too. It is one of the address that has the most of them: an address that opens many
closes its own. The application begins with a request when its body has come, since beginning costs
more than all that a slow client sends; of the bodies that are longer than a connection holds, it
begins with a few of each address. A body in crumbs costs a thousand times what it holds, and is
refused.
"""

from __future__ import annotations

import asyncio
import heapq
import re
from collections import Counter
from typing import Any

import h11
from starlette.types import Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware
from uvicorn.protocols.http.flow_control import HIGH_WATER_LIMIT
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

HEAD_SECONDS = 10.0  # s for the head of a request, and before its body has to keep its rate
BODY_RATE = 10_000.0  # bytes/s of a body, at least
SEND_SECONDS = (
    20.0  # s within which what is sent at once (`vibrafeed.app.web.outgoing.WHOLE`) has to leave
)

MAX_HEAD = 16_384  # bytes of the head of a request
MAX_LINES = 100  # of a head: each is parsed, and searched by every layer; browsers send some twenty
# Of a body in chunks: each takes as long as 10 kB of a body at one piece.
FREE_CHUNKS, LEAST_CHUNK = 500, 16  # chunks of any size, and bytes on average of those beyond
FREE_BYTES = 64_000  # that may have come beside twice the body: sizes and extensions of chunks

UPLOADS = 16  # requests of an address that may have begun before their whole body is here
ACCEPTED_AT_ONCE = 64  # between two of them connections that make room are really closed
SPARE = 64  # connections beyond the requests that may be under way
CUT_AT_ONCE = 32  # connections closed at a time: finding the longest idle ones takes time
# Files beside those of connections and of downloads: ledger, workers, connections that are closing.
OTHER_FILES = 256 + 2 * ACCEPTED_AT_ONCE

_END_OF_HEAD = re.compile(rb"\n\r?\n")


def raise_open_files() -> int:
    """Raise this process's limit of open files to the allowed maximum; return the limit."""
    import resource  # Windows has none

    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    return hard


def most_requests(open_files: int) -> int:
    """Return the number of requests that can be under way within a limit of open files.

    Each request needs two files, a connection and a file that is downloaded; some are kept free for
    the ledger and the workers.
    """
    if open_files < 0:  # so Linux says that there is no limit
        return 10**9
    return max(1, (open_files - OTHER_FILES - SPARE) // 2)


class ThriftyParser(h11.Connection):
    """A parser of HTTP/1.1 requests that refuses those that cost more than they hold.

    These are heads of very many lines, refused before they are parsed (h11 limits only heads that
    have not come whole), and bodies in very small chunks, or with long chunk extensions.
    """

    def __init__(self) -> None:
        """Begin to parse requests of a limited head size."""
        super().__init__(h11.SERVER, MAX_HEAD)
        self._chunks = self._body = self._raw = 0
        self._is_padded = False

    def receive_data(self, data: bytes) -> None:
        """Add received bytes to the parser's buffer."""
        self._is_padded = self._raw > FREE_BYTES + 2 * self._body  # all of it has been read
        self._raw += len(data)
        super().receive_data(data)

    def next_event(self) -> Any:
        """Return the next HTTP event parsed from the bytes of a connection, as h11 has them.

        Costly requests are refused by an error, which closes the connection.

        Raises
        ------
        h11.RemoteProtocolError
            If the bytes are not HTTP, or the head is too long, or the body comes in tiny chunks.
        """
        if self.their_state is h11.IDLE:
            self._check_head()
        event = super().next_event()
        if isinstance(event, h11.Request):
            self._chunks = self._body = self._raw = 0
        elif isinstance(event, h11.Data):
            self._chunks += event.chunk_start
            self._body += len(event.data)
            if self._is_padded or self._chunks > FREE_CHUNKS + self._body // LEAST_CHUNK:
                raise h11.RemoteProtocolError(
                    "The body of the request arrives in too many tiny chunks. Send larger chunks."
                )
        return event

    def send(self, event: Any) -> Any:
        """Return the bytes to send for an event of a reply; a piece of a body is not copied.

        None if the connection is closed. h11 joins pieces, which copies a `memoryview`: a tenth of
        a millisecond for a megabyte.
        """
        pieces = self.send_with_data_passthrough(event)
        if pieces is None:
            return None
        return pieces[0] if len(pieces) == 1 else b"".join(pieces)

    def _check_head(self) -> None:
        """Raise `h11.RemoteProtocolError` if a request's head is too long or has too many lines.

        It looks at the received bytes before they are parsed, as parsing many lines takes long.
        """
        waiting, _ = self.trailing_data
        end = _END_OF_HEAD.search(waiting, 0, MAX_HEAD)
        head = waiting[: end.start() if end else MAX_HEAD]
        if head.count(b"\n") > MAX_LINES or (end is None and len(waiting) > MAX_HEAD):
            raise h11.RemoteProtocolError(
                "The head of the request (its request line and headers) is too long. Shorten it.",
                error_status_hint=431,
            )


class Connection(H11Protocol):
    """uvicorn's, with an eye on the time that its client takes."""

    def __init__(self, *arguments: Any, **options: Any):
        """Begin a connection with the thrifty parser and the application's limits."""
        super().__init__(*arguments, **options)
        self.conn = ThriftyParser()
        self._serve, self.app = self.app, self._serve_when_here
        state = self.config.app.state  # type: ignore[union-attr]
        settings, self._uploads = state.settings, state.uploads
        self._most = settings.max_requests + SPARE
        self._longest_body = settings.max_body_bytes
        self._address = ""
        self._is_stopping = self._waits_for_others = False
        self._since = self._sent = self.loop.time()
        self._received = 0
        self._was_answered = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Accept a new connection; if there are too many, close some idle ones first."""
        if len(self.connections) >= self._most:
            self._cut_others()
        super().connection_made(transport)
        self._address = self.client[0] if self.client else ""

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove the connection from the list; `exc` is the error that ended it, None for a close.

        Without this, uvicorn keeps a connection that the client has reset, with its request, until
        the timer of its next request is over.
        """
        self._unset_keepalive_if_required()
        super().connection_lost(exc)
        self.app = self._serve  # or it would refer to itself, and stay until memory is searched

    def shutdown(self) -> None:
        """Let a request whose body is awaited be answered now: the service stops."""
        self._is_stopping = True
        if self.cycle is not None:
            self.cycle.message_event.set()
        super().shutdown()

    def data_received(self, data: bytes) -> None:
        """Handle bytes from the client, and note the time."""
        self._received += len(data)
        super().data_received(data)

    def resume_writing(self) -> None:
        """Note the time at which the client has taken enough to go on writing."""
        self._sent = self.loop.time()
        super().resume_writing()

    def on_response_complete(self) -> None:
        """Note the time from which the client may send its next request."""
        self._since, self._received, self._was_answered = self.loop.time(), 0, True
        super().on_response_complete()

    def look(self) -> None:
        """Close the connection if its client sends or reads too slowly; called about once a second.

        A piece of a reply has to leave within `SEND_SECONDS`, and a request has to arrive by the
        time of `_due`.
        """
        now = self.loop.time()
        if self.transport.get_write_buffer_size() == 0:
            self._sent = now
        # Not closed: that waits until all is sent.
        if now > self._sent + SEND_SECONDS or now > self._due():
            self.transport.abort()

    @property
    def _is_idle(self) -> bool:
        """True if no request is under way."""
        is_whole = self.conn.their_state not in (h11.IDLE, h11.SEND_BODY)
        return not is_whole or self.cycle is None or self.cycle.response_complete

    def _due(self) -> float:
        """Return the time by which the rest of the request has to arrive [s on the loop's clock].

        A head has `HEAD_SECONDS`; a body has as much longer as its bytes so far take at
        `BODY_RATE`. The time is infinite while no part of a request is awaited.
        """
        if not self.transport.is_closing() and self.transport.get_write_buffer_size() == 0:
            if self.conn.their_state is h11.IDLE:
                return self._since + HEAD_SECONDS
            if self.conn.their_state is h11.SEND_BODY and not self.flow.read_paused:
                return self._since + HEAD_SECONDS + self._received / BODY_RATE
        return float("inf")

    async def _serve_when_here(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Run the application on a request once its body is here; not at all if the client left.

        The arguments are those of ASGI.
        """
        cycle = self.cycle
        self._address = self._client_address(scope)
        while self._is_awaited(cycle):
            cycle.message_event.clear()
            await cycle.message_event.wait()
        self._waits_for_others = False
        if cycle.disconnected:
            return
        if not cycle.more_body:
            await self._serve(scope, receive, send)
            return
        address = self._address  # another request may tell another one, behind a proxy
        self._uploads[address] += 1
        try:
            await self._serve(scope, receive, send)
        finally:
            self._uploads[address] -= 1
            if not self._uploads[address]:
                del self._uploads[address]
            self._wake_waiting()

    def _wake_waiting(self) -> None:
        """Let requests that wait for the body of another one look whether they may begin."""
        for one in self.connections:
            if isinstance(one, Connection) and one._waits_for_others:
                one.cycle.message_event.set()

    def _is_awaited(self, cycle: RequestResponseCycle) -> bool:
        """True while the rest of a request's body has to come before the application begins.

        It begins at once with what is refused by its length, and with a client that asks whether to
        send its body at all; of a long body, when as much of it is here as a connection takes, and
        few others of its address are on their way.
        """
        if not cycle.more_body or cycle.disconnected or self._is_stopping:
            return False
        if cycle.waiting_for_100_continue:
            return False
        if len(cycle.body) > HIGH_WATER_LIMIT:
            self._waits_for_others = self._uploads[self._address] >= UPLOADS
            return self._waits_for_others
        lengths = [value for name, value in self.headers if name == b"content-length"]
        return not lengths or int(lengths[0]) <= self._longest_body

    def _client_address(self, scope: Scope) -> str:
        """Return the address of a request's client, as a trusted proxy tells it if one sent it.

        `scope` is ASGI's description of the request.
        """
        peer = self.client[0] if self.client else ""
        proxies = self._serve
        if isinstance(proxies, ProxyHeadersMiddleware) and peer in proxies.trusted_hosts:
            told = [value for name, value in scope["headers"] if name == b"x-forwarded-for"]
            words = b", ".join(told).decode("latin1")
            return proxies.trusted_hosts.get_trusted_client_address(words)[0] or peer
        return peer

    def _cut_others(self) -> None:
        """Close idle connections of the address that has most, first those that sent nothing.

        Of those the ones that have waited longest. Few are closed of an address that has few, or
        addresses would take turns in closing all of one another.
        """
        others = [one for one in self.connections if isinstance(one, Connection)]
        idle = [one for one in others if one._is_idle]
        if not idle:
            return
        count = Counter(one._address for one in others)
        most = max((count[one._address], one._address) for one in idle)
        own = [one for one in idle if one._address == most[1]]
        number = min(CUT_AT_ONCE, 1 + most[0] // 4)
        for one in heapq.nsmallest(number, own, lambda one: (one._was_answered, one._since)):
            self.connections.discard(one)
            one.transport.abort()
