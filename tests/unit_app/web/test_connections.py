"""Connections of a running server: when the application begins, and who makes room."""

from __future__ import annotations

import socket
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from types import SimpleNamespace

import h11
import pytest
import uvicorn

from vibrafeed.app.web.connections import SPARE, UPLOADS, Connection, ThriftyParser
from waiting import PATIENCE, wait_for

LONGEST = 1_000_000  # bytes of a body
HEAD = "POST /posted HTTP/1.1\r\nHost: localhost\r\n"
LOOK = b"GET /looked HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"

several_addresses = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="an address of its own for each client"
)


class Application:
    """Tells how many bytes a body has; `begun` are the paths of the requests it began with."""

    def __init__(self):
        self.begun = []
        self.state = SimpleNamespace(
            settings=SimpleNamespace(max_requests=1, max_body_bytes=LONGEST), uploads=Counter()
        )

    async def __call__(self, scope, receive, send):
        self.begun.append(scope["path"])
        size, more = 0, True
        while more:
            message = await receive()
            if message["type"] == "http.disconnect":
                return
            size, more = size + len(message["body"]), message["more_body"]
        body = b"%d bytes" % size
        headers = [(b"content-length", b"%d" % len(body))]
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": body})


class Running:
    """A server, and clients that stay until the test is over."""

    def __init__(self, server: uvicorn.Server, application: Application, stack: ExitStack):
        self.server, self.begun = server, application.begun
        self.uploads = application.state.uploads
        self._stack = stack
        self._port = server.servers[0].sockets[0].getsockname()[1]

    def client(self, *pieces: bytes, source: str = "127.0.0.1") -> socket.socket:
        """Return a connection from an address, on which pieces have been sent."""
        client = socket.create_connection(("127.0.0.1", self._port), PATIENCE, (source, 0))
        self._stack.enter_context(closing(client))
        for piece in pieces:
            client.sendall(piece)
        return client

    def catch_up(self) -> None:
        """Wait until what was sent before has been read: the loop reads what is there at once."""
        for _ in range(2):
            assert self.client(LOOK).recv(1000).startswith(b"HTTP/1.1 200")

    def posted(self) -> int:
        """Return how many posts the application has begun with."""
        self.catch_up()
        return self.begun.count("/posted")


@pytest.fixture
def running() -> Iterator[Callable[[], Running]]:
    """A server of one process whose application tells when it begins."""
    application = Application()
    config = uvicorn.Config(
        application, http=Connection, port=0, log_config=None, lifespan="off", ws="none",
        timeout_graceful_shutdown=1,
    )  # fmt: skip
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    wait_for(lambda: server.started)
    try:
        with ExitStack() as stack:
            yield Running(server, application, stack)
    finally:
        server.should_exit = True
        thread.join(PATIENCE)


def head(*lines: str) -> bytes:
    return (HEAD + "".join(f"{line}\r\n" for line in lines) + "\r\n").encode()


def reply(client: socket.socket) -> bytes:
    """Return the reply of the application, which may come in pieces."""
    received = b""
    while not received.endswith(b" bytes") and (piece := client.recv(1000)):
        received += piece
    return received


def is_open(client: socket.socket) -> bool:
    """True if the server has not closed a connection that owes no answer."""
    client.setblocking(False)
    try:
        return client.recv(1, socket.MSG_PEEK) != b""
    except BlockingIOError:
        return True
    except ConnectionResetError:
        return False


def test_the_application_begins_once_the_body_is_here(running):
    client = running.client(head("Content-Length: 20"), *[b"x"] * 19)
    assert running.posted() == 0
    client.sendall(b"x")
    assert reply(client).endswith(b"20 bytes")
    client.sendall(head("Transfer-Encoding: chunked") + b"3\r\nabc\r\n")
    assert running.posted() == 1
    client.sendall(b"2\r\nde\r\n0\r\n\r\n")
    assert reply(client).endswith(b"5 bytes")
    assert running.posted() == 2


def test_the_application_never_begins_for_who_leaves_before(running):
    with running.client(head("Content-Length: 20"), b"x"):
        assert running.posted() == 0
    running.catch_up()
    wait_for(lambda: not running.server.server_state.tasks)
    assert running.posted() == 0


@pytest.mark.parametrize(
    ("line", "size"),
    [
        (f"Content-Length: {LONGEST + 1}", 0),  # is refused by its length
        (f"Content-Length: {LONGEST}", 200_000),  # more than a connection takes by itself
        ("Transfer-Encoding: chunked", 200_000),
    ],
)
def test_it_begins_before_where_it_has_to(running, line, size):
    client = running.client(head(line))
    if size:
        assert running.posted() == 0
        content = bytes(size)
        client.sendall(b"%x\r\n%s\r\n" % (size, content) if "chunked" in line else content)
    wait_for(lambda: running.posted() == 1)


@several_addresses
def test_of_long_bodies_of_an_address_it_begins_with_a_few(running):
    begun = head("Content-Length: 200000") + bytes(100_000)
    clients = [running.client(begun) for _ in range(UPLOADS + 2)]
    wait_for(lambda: running.posted() == UPLOADS)
    other = running.client(begun, bytes(100_000), source="127.0.0.2")
    assert reply(other).endswith(b"200000 bytes")
    for client in clients:  # each that ends makes room for the next
        client.sendall(bytes(100_000))
        assert reply(client).endswith(b"200000 bytes")
    wait_for(lambda: not running.uploads)  # of who sends no more nothing is kept


def test_who_asks_whether_to_send_is_answered(running):
    client = running.client(head("Content-Length: 4", "Expect: 100-continue"))
    assert client.recv(1000).startswith(b"HTTP/1.1 100")
    client.sendall(b"abcd")
    assert reply(client).endswith(b"4 bytes")


def test_a_server_that_stops_begins_with_what_it_awaits(running):
    running.client(head("Content-Length: 20"), b"x")
    assert running.posted() == 0
    running.server.should_exit = True
    wait_for(lambda: running.begun.count("/posted") == 1)


SLOW = head("Content-Length: 20") + b"x"


@several_addresses
def test_who_has_the_most_connections_makes_room(running):
    first = [running.client(SLOW, source="127.0.0.3") for _ in range(10)]
    many = [running.client(SLOW) for _ in range(2 * SPARE)]
    assert running.client(LOOK, source="127.0.0.2").recv(1000).startswith(b"HTTP/1.1 200")
    wait_for(lambda: sum(map(is_open, many)) <= SPARE)
    assert all(map(is_open, first))
    assert is_open(many[-1])


@several_addresses
def test_behind_a_trusted_proxy_the_address_is_that_of_the_client(running):
    def slow(address: str) -> bytes:
        return head(f"X-Forwarded-For: {address}", "Content-Length: 20") + b"x"

    first = [running.client(slow("192.0.2.1")) for _ in range(10)]
    running.catch_up()
    many = [running.client(slow("192.0.2.2")) for _ in range(2 * SPARE)]
    wait_for(lambda: sum(map(is_open, many)) <= SPARE)
    assert all(map(is_open, first))
    # Of whoever is no proxy it is not believed.
    others = [running.client(slow(f"192.0.2.{n}"), source="127.0.0.3") for n in range(2 * SPARE)]
    wait_for(lambda: sum(map(is_open, others)) <= SPARE)
    assert all(map(is_open, first))


def test_a_piece_of_a_reply_is_not_copied():
    parser, piece = ThriftyParser(), memoryview(bytes(1000))
    parser.receive_data(b"GET / HTTP/1.1\r\nHost: here\r\n\r\n")
    while not isinstance(parser.next_event(), h11.EndOfMessage):
        pass
    head = h11.Response(status_code=200, headers=[("Content-Length", "1000")])
    assert parser.send(head).endswith(b"\r\n\r\n")
    assert parser.send(h11.Data(data=piece)) is piece
    assert parser.send(h11.EndOfMessage()) == b""
    assert parser.send(h11.ConnectionClosed()) is None
