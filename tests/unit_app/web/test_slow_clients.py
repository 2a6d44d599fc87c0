"""Clients that keep a connection waiting, and replies that wait for their readers."""

from __future__ import annotations

import asyncio
import contextlib
import resource
import subprocess
import sys
import threading
from collections import Counter
from types import SimpleNamespace

import pytest
import uvicorn
from fastapi import FastAPI, Response

from local_client import local_client
from posted_sweeps import STUDY, problem
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web import connections
from vibrafeed.app.web.connections import BODY_RATE, HEAD_SECONDS, SEND_SECONDS, Connection
from vibrafeed.app.web.outgoing import PIECE, Outgoing, Unsent
from vibrafeed.app.web.problems import BusyError

HEAD = b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 500000\r\n\r\n"


class Task:
    """One that never runs."""

    def add_done_callback(self, callback):
        pass


class Clock:
    """An event loop, as far as a connection looks at it, whose time is set by hand."""

    def __init__(self):
        self.now = 0.0

    def time(self):
        return self.now

    def create_task(self, coroutine, **options):
        coroutine.close()
        return Task()

    def call_later(self, delay, callback):
        timer = SimpleNamespace(is_cancelled=False)
        timer.cancel = lambda: setattr(timer, "is_cancelled", True)
        return timer


class Wire:
    """A transport that is told how much is unsent."""

    def __init__(self):
        self.unsent, self.is_cut, self.sent = 0, False, b""

    def get_write_buffer_size(self):
        return self.unsent

    def abort(self):
        self.is_cut = True

    def write(self, data):
        self.sent += data

    close = abort

    def is_closing(self):
        return self.is_cut

    def get_extra_info(self, name, default=None):
        return default

    def pause_reading(self):
        pass

    def resume_reading(self):
        pass


@pytest.fixture
def connect():
    """Return a function that opens a connection to one server; the clock is its attribute."""
    app = FastAPI()
    app.state.settings = SimpleNamespace(max_requests=1, max_body_bytes=1_000_000)
    app.state.uploads = Counter()
    config = uvicorn.Config(app, log_config=None, ws="none")
    config.load()
    state, clock = uvicorn.server.ServerState(), Clock()

    def open_one():
        one = Connection(config=config, server_state=state, app_state={}, _loop=clock)
        one.connection_made(Wire())
        return one

    open_one.clock, open_one.state = clock, state
    return open_one


def is_cut(connect, connection, at):
    connect.clock.now = at
    connection.look()
    return connection.transport.is_cut


def test_a_head_has_its_time(connect):
    silent, slow = connect(), connect()
    slow.data_received(b"GET / HTTP/1.1\r\n")
    for one in (silent, slow):
        assert not is_cut(connect, one, HEAD_SECONDS - 1)
        assert is_cut(connect, one, HEAD_SECONDS + 1)


def test_a_body_has_its_rate(connect):
    slow, steady = connect(), connect()
    slow.data_received(HEAD)
    steady.data_received(HEAD + bytes(int(10 * BODY_RATE)))
    steady.flow.read_paused = False  # else the service is who waits
    assert is_cut(connect, slow, HEAD_SECONDS + 1)
    assert not is_cut(connect, steady, HEAD_SECONDS + 9)
    assert is_cut(connect, steady, HEAD_SECONDS + 11)


@pytest.mark.parametrize("line", [b"a:", b"a:" + bytes([120]) * 1_000])
def test_a_head_of_many_lines_is_refused_before_it_is_parsed(connect, line, monkeypatch):
    one = connect()
    monkeypatch.setattr(connections.h11.Connection, "next_event", None)
    one.data_received(b"GET / HTTP/1.1\r\n" + (line + b"\r\n") * 15_000 + b"\r\n")
    assert b"400 Bad Request" in one.transport.sent
    assert one.transport.is_closing()


def test_an_honest_head_is_read(connect):
    one = connect()
    fields = b"".join(b"x-%d: %s\r\n" % (n, b"y" * 100) for n in range(90))
    one.data_received(HEAD[:-2] + fields + b"\r\n" + bytes(60_000) * 8)
    assert not one.transport.is_closing()
    assert len(one.cycle.body) == 480_000


CHUNKED = HEAD[: HEAD.index(b"Content")] + b"Transfer-Encoding: chunked\r\n\r\n"


@pytest.mark.parametrize("extension", [b"", b";x=" + bytes([120]) * 1_000])
def test_a_body_in_crumbs_is_refused(connect, extension):
    crumbs = connect()
    crumbs.data_received(CHUNKED)
    crumb = b"1" + extension + b"\r\nx\r\n"
    for _ in range(30):
        if crumbs.transport.is_closing():
            break
        crumbs.data_received(crumb * 100)
    assert b"400 Bad Request" in crumbs.transport.sent
    assert len(crumbs.cycle.body) <= connections.FREE_CHUNKS + 200  # and no more of it was read


@pytest.mark.parametrize("size", [40, 65_536])
def test_a_body_in_honest_chunks_is_read(connect, size):
    honest = connect()
    honest.data_received(CHUNKED)
    chunk = b"%x\r\n%s\r\n" % (size, bytes(size))
    count = 900_000 // size
    honest.data_received(chunk * count)
    honest.data_received(b"0\r\n\r\n")
    assert not honest.transport.is_closing()
    assert len(honest.cycle.body) == size * count
    assert not honest.cycle.more_body


def test_a_head_of_thousands_of_lines_is_refused(connect):
    one = connect()
    one.data_received(b"GET / HTTP/1.1\r\n" + b"a:\r\n" * 5_000)
    assert b"400 Bad Request" in one.transport.sent


def test_a_piece_of_a_reply_has_its_time(connect):
    deaf, slow = connect(), connect()
    for one in (deaf, slow):
        one.data_received(HEAD[: HEAD.index(b"Content")] + b"Content-Length: 0\r\n\r\n")
        one.transport.unsent = PIECE
    connect.clock.now = SEND_SECONDS - 1
    slow.resume_writing()
    assert is_cut(connect, deaf, SEND_SECONDS + 1)
    assert not is_cut(connect, slow, SEND_SECONDS + 1)


def test_the_longest_silent_make_room(connect):
    busy = connect()
    busy.data_received(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
    others = []
    for number in range(5 * connections.SPARE):
        connect.clock.now = 0.001 * number
        others.append(connect())
    assert len(connect.state.connections) <= 1 + connections.SPARE
    assert not busy.transport.is_cut
    assert others[0].transport.is_cut
    assert not others[-1].transport.is_cut


def test_a_client_that_resets_its_connection_is_forgotten(connect):
    gone = connect()
    gone.cycle = SimpleNamespace(
        response_complete=True, disconnected=False, message_event=asyncio.Event()
    )
    timer = gone.timeout_keep_alive_task = connect.clock.call_later(5.0, None)
    gone.connection_lost(ConnectionResetError())
    # The timer would hold the connection, and that its request, until it is due.
    assert timer.is_cancelled
    assert gone not in connect.state.connections


def test_few_open_files_mean_few_requests():
    for files in (1024, 4096):
        requests = connections.most_requests(files)
        assert 100 < 2 * requests + connections.SPARE < files - connections.ACCEPTED_AT_ONCE
    assert connections.most_requests(resource.RLIM_INFINITY) > 10**6


def test_the_soft_limit_of_open_files_is_raised():
    code = (
        "import resource as r; h = r.getrlimit(r.RLIMIT_NOFILE)[1];"
        "r.setrlimit(r.RLIMIT_NOFILE, (64, h));"
        "from vibrafeed.app.web.connections import raise_open_files as f;"
        "print(f() == h == r.getrlimit(r.RLIMIT_NOFILE)[0])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True"]


# --- what waits to be sent

CONTENT = bytes(range(256)) * 4096 * 3


def large_reply(unsent):
    """Return the app of one large reply, to be called with a `send`."""

    async def app(scope, receive, send):
        await Response(CONTENT)(scope, receive, send)

    outgoing = Outgoing(app, unsent)
    scope = {"type": "http", "method": "GET", "path": "/", "headers": []}
    return lambda send: outgoing(dict(scope), None, send)


def served(unsent, send):
    """Return the call of a new app of one large reply, as a coroutine."""
    return large_reply(unsent)(send)


def test_one_large_piece_is_sent_in_a_turn_of_the_event_loop():
    replies, pieces = 20, -(-len(CONTENT) // PIECE)

    async def many():
        turn, sent = 0, Counter()

        async def count(message):
            sent[turn] += bool(message.get("body"))

        async def tick():
            nonlocal turn
            while True:
                await asyncio.sleep(0)
                turn += 1

        ticking = asyncio.create_task(tick())
        reply = large_reply(Unsent(replies * len(CONTENT)))
        await asyncio.gather(*(reply(count) for _ in range(replies)))
        ticking.cancel()
        return sent

    sent = asyncio.run(many())
    assert sent.total() == replies * pieces
    assert max(sent.values()) == 1


def test_a_reply_that_waits_keeps_others_from_being_made():
    unsent = Unsent(len(CONTENT) * 3 // 2)

    async def two():
        release, first, second = asyncio.Event(), [], []

        async def deaf(message):
            first.append(message)
            await release.wait()

        async def told(message):
            second.append(message)

        waiting = asyncio.create_task(served(unsent, deaf))
        await asyncio.sleep(0)
        await served(unsent, told)
        refused, second[:] = second[0], []
        release.set()
        await waiting
        await served(unsent, told)
        return refused, first, second

    refused, first, second = asyncio.run(two())
    assert refused["status"] == 503
    assert (b"retry-after", b"1") in refused["headers"]
    for messages in (first, second):
        assert messages[0]["status"] == 200
        bodies = [bytes(message["body"]) for message in messages[1:]]
        assert b"".join(bodies) == CONTENT
        assert max(map(len, bodies)) <= PIECE
        # The end of the reply waits until its last piece has left.
        assert [message.get("more_body", False) for message in messages[-2:]] == [True, False]


def test_a_single_reply_may_be_larger_than_the_bound():
    unsent = Unsent(10)
    unsent.take(100)
    with pytest.raises(BusyError):
        unsent.take(1)
    unsent.give_back(100)
    unsent.take(100)


def test_what_a_failed_reply_took_is_given_back():
    unsent = Unsent(len(CONTENT))

    async def left(message):
        raise OSError

    for _ in range(2):
        with contextlib.suppress(OSError):
            asyncio.run(served(unsent, left))
    unsent.take(len(CONTENT))


def test_memory_is_looked_at_once_after_much_has_left():
    unsent = Unsent(1000)
    unsent.take(600)
    assert not unsent.has_fallen(500)
    unsent.give_back(600)
    assert unsent.has_fallen(500)
    assert not unsent.has_fallen(500)


def test_a_slice_is_refused_before_it_is_computed(tmp_path, monkeypatch):
    settings = Settings(data_directory=tmp_path, max_unsent_bytes=1_000_000)
    with local_client(create_app(settings)) as client:
        large = {**STUDY["parameters"], "alpha": {"start": 0, "stop": 90, "num": 10_000}}
        key = client.post("/sweeps", json={**STUDY, "parameters": large}).json()["id"]
        path = f"/sweeps/{key}/slice?output=acceleration_x&axes=alpha,beta&amplitude=0.35 mm"
        path += "&frequency=20 Hz"
        client.app.state.unsent.take(900_000)
        with monkeypatch.context() as patch:
            for module in ("vibrafeed.app.web.routes.sweeps", "vibrafeed.app.web.calculations"):
                patch.setattr(f"{module}.compute_slice", lambda *_, **__: pytest.fail("computed"))
            problem(client.get(path), 503)
            problem(client.get(f"/sweeps/{key}/zarr/acceleration_x/c/0/0/0/0"), 503)
        assert client.get(path.replace("alpha,beta", "beta&alpha=0")).status_code == 200
        client.app.state.unsent.give_back(900_000)
        assert client.get(path).status_code == 200


def test_head_of_a_file_that_is_not_made_computes_nothing(client, address, monkeypatch):
    begun = threading.Event()
    writer = client.app.state.writer
    with monkeypatch.context() as patch:
        patch.setattr(writer, "write", lambda *_: begun.set())
        head = client.head(f"{address}/netcdf")
    assert head.status_code == 200
    assert not begun.is_set()
    assert "content-length" not in head.headers
    assert "etag" not in head.headers
    made = client.get(f"{address}/netcdf")
    assert made.headers["content-type"] == head.headers["content-type"]
    assert client.head(f"{address}/netcdf").headers["etag"] == made.headers["etag"]
