"""What is written by hand or chosen, beside libraries: guard, downloads, console, ledger, digits.

`python -m benchmarks.libraries [guard|downloads|console|ledger|digits]...`, in an environment that
holds the rivals too: `pip install persist-queue huey litequeue secure tabulate python-flint`.
`docs/decisions` has the figures.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import hashlib
import http.client
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import timeit
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.timing import in_turns

MEGABYTES = 128
ROUNDS = 5


# --- guard


def guard() -> None:
    """Print the cost of the layers around a request."""
    import secure
    from secure.middleware import SecureASGIMiddleware
    from starlette.middleware.trustedhost import TrustedHostMiddleware

    from vibrafeed.app.jobs.keys import Keys, new_key
    from vibrafeed.app.jobs.ledger import Ledger
    from vibrafeed.app.settings import Settings
    from vibrafeed.app.web.guard import Guard, Limits, SafeHeaders

    key, digest = new_key()
    headers = [(b"host", b"localhost:8000"), (b"authorization", f"Bearer {key}".encode())]
    body = {"type": "http.response.body", "body": b""}

    async def inner(scope: Any, receive: Any, send: Any) -> None:
        """Send an empty reply."""
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send(body)

    async def receive() -> Any:
        """Return a request message without a body."""
        return {"type": "http.request"}

    async def send(message: Any) -> None:
        """Drop a message."""
        pass

    def called(app: Any, count: int = 10_000) -> Callable[[], None]:
        """Return a function that calls an application many times."""

        async def calls() -> None:
            """Call the application many times."""
            for _ in range(count):
                scope = {
                    "type": "http",
                    "method": "GET",
                    "path": "/scenes",
                    "headers": headers,
                    "server": ("127.0.0.1", 8000),
                }
                await app(scope, receive, send)

        return lambda: asyncio.run(calls())

    limits = Settings(api_key_hashes=digest)
    strict = secure.Secure.from_preset(secure.Preset.STRICT)
    layers = {
        "none": inner,
        "SafeHeaders": SafeHeaders(inner),
        "secure": SecureASGIMiddleware(inner, secure=strict),
        "Guard, keys, host and origin": Guard(
            inner, limits, Keys(Ledger(limits.ledger).database, [digest])
        ),
        "TrustedHostMiddleware, host only": TrustedHostMiddleware(inner, ["localhost"]),
        "Limits": Limits(inner, limits),
    }
    for name, seconds in zip(layers, in_turns(ROUNDS, *map(called, layers.values())), strict=True):
        print(f"{name:36} {min(seconds) / 10_000 * 1e6:6.2f} us a request")


# --- downloads

ASKED = {
    "If-None-Match: the ETag": {"If-None-Match": "ETAG"},
    "If-Match: another": {"If-Match": '"another"'},
    "Range: bytes=0-9": {"Range": "bytes=0-9"},
    "Range: no byte of it": {"Range": "bytes=99999999999-"},
    "Range: two of them": {"Range": "bytes=0-9,20-29"},
    "Range: other units": {"Range": "lines=0-9"},
    "Range: backwards": {"Range": "bytes=9-0"},
}


def downloads() -> None:
    """Print the speed of file downloads and the replies to kinds of request."""
    import uvicorn
    from fastapi import FastAPI, Request
    from starlette.responses import FileResponse

    from vibrafeed.app.web import problems
    from vibrafeed.app.web.downloads import file_reply

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "file"
        path.write_bytes(os.urandom(1 << 20) * MEGABYTES)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        app = FastAPI()
        problems.install(app)

        def by_hand(request: Request) -> Any:
            """Return the file by our own reply."""
            return file_reply(request, path, digest=digest, media_type="a/b", filename="f")

        class Larger(FileResponse):
            chunk_size = 1 << 20

        def plain(kind: type[FileResponse], request: Request) -> Any:
            """Return the file by a library's reply."""
            return kind(path, media_type="a/b", headers={"ETag": f'"{digest}"'})

        places = {
            "/ours": by_hand,
            "/starlette": functools.partial(plain, FileResponse),
            "/starlette-1MiB": functools.partial(plain, Larger),
        }
        for place, endpoint in places.items():
            app.add_route(place, endpoint)
        server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="critical"))
        thread = threading.Thread(target=server.run)
        thread.start()
        while not server.started:
            time.sleep(0.01)
        port = server.servers[0].sockets[0].getsockname()[1]

        def asked(place: str, **headers: str) -> http.client.HTTPResponse:
            """Send a request and return the reply."""
            connection = http.client.HTTPConnection("127.0.0.1", port)
            connection.request("GET", place, headers=headers)
            return connection.getresponse()

        def read(place: str) -> Callable[[], None]:
            """Return a function that downloads a path."""

            def whole() -> None:
                """Download the whole file."""
                reply = asked(place)
                while reply.read(1 << 20):
                    pass

            return whole

        for place, seconds in zip(places, in_turns(ROUNDS, *map(read, places)), strict=True):
            print(f"{place:18} {MEGABYTES / min(seconds):6.0f} MiB/s")
        for name, headers in ASKED.items():
            given = {k: v.replace("ETAG", f'"{digest}"') for k, v in headers.items()}
            told = []
            for place in ("/ours", "/starlette"):
                reply = asked(place, **given)
                told.append(f"{reply.status} {reply.headers.get_content_type()}")
            print(f"{name:26} ours {told[0]:32} starlette {told[1]}")
        path.unlink()
        print("removed:", *(f"{place} {asked(place).status}" for place in ("/ours", "/starlette")))
        server.should_exit = True
        thread.join()


# --- console


def console() -> None:
    """Print the processor time of loading libraries for tables."""
    for name in ("sys", "tabulate", "rich.table, rich.progress", "typer"):
        taken = []
        for _ in range(ROUNDS):
            before = os.times()
            subprocess.run([sys.executable, "-c", f"import {name}"], check=True)
            after = os.times()
            taken.append(sum(after[2:4]) - sum(before[2:4]))  # of children, so far
        print(f"import {name:28} {min(taken) * 1e3:5.0f} ms")


# --- ledger


Queue = tuple[Callable[[str], object], Callable[[], Any], Callable[[Any], object]]


def ours(folder: Path) -> Queue:
    """Return put, take and end operations of the ledger, as for the other libraries."""
    from vibrafeed.app.jobs.ledger import Ledger

    book = Ledger(folder / "ours.sqlite3")

    def put(word: str) -> None:
        """Put an item."""
        book.post(word, "sweep", cells=1, block_cells=1, blocks=1, bytes_=1, finished_seconds=None)

    return put, lambda: book.claim("server", 1.0), book.succeed


def persist_queue(folder: Path) -> Queue:
    """Return put, take and end operations of SQLiteAckQueue."""
    from persistqueue import Empty, SQLiteAckQueue

    queue = SQLiteAckQueue(str(folder / "persist"), multithreading=True)

    def take() -> Any:
        """Take an item; None if there is none."""
        with contextlib.suppress(Empty):
            return queue.get(block=False)
        return None

    return queue.put, take, queue.ack


def huey(folder: Path) -> Queue:
    """Return put, take and end operations of huey, which forgets items once handed out."""
    from huey.storage import SqliteStorage

    storage = SqliteStorage(filename=str(folder / "huey.sqlite3"), fsync=True)
    return lambda word: storage.enqueue(word.encode()), storage.dequeue, lambda item: None


def litequeue(folder: Path) -> Queue:
    """Return put, take and end operations of LiteQueue."""
    from litequeue import LiteQueue

    queue = LiteQueue(str(folder / "lite.sqlite3"))
    return queue.put, queue.pop, lambda item: queue.done(item.message_id)


def hold(kind: Callable[[Path], Queue], folder: Path, told: Any) -> None:
    """Take one item, report it, and wait to be killed."""
    _, take, _ = kind(folder)
    told.send(take() is not None)
    signal.pause()


def take_all(kind: Callable[[Path], Queue], folder: Path, told: Any) -> None:
    """Take all items, as another server would; report their number."""
    _, take, _ = kind(folder)
    count = 0
    while take() is not None:
        count += 1
    told.send(count)


def put_some(kind: Callable[[Path], Queue], folder: Path, told: Any) -> None:
    """Put ten items."""
    put, _, _ = kind(folder)
    for number in range(10):
        put(f"item {number}")
    told.send(None)


def begun(function: Any, kind: Any, folder: Path) -> tuple[Any, Any]:
    """Run a function in a process; return the process and its first message."""
    here, there = multiprocessing.Pipe()
    process = multiprocessing.Process(target=function, args=(kind, folder, there))
    process.start()
    return process, here.recv()


def ledger() -> None:
    """Print what becomes of items of living and killed servers, and the cost of one."""
    for kind in (ours, persist_queue, huey, litequeue):
        found = []
        for is_killed in (False, True):
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                begun(put_some, kind, folder)[0].join()
                holder, _ = begun(hold, kind, folder)
                if is_killed:
                    os.kill(holder.pid, signal.SIGKILL)
                    holder.join()
                    time.sleep(2.0)  # longer than the lease
                process, count = begun(take_all, kind, folder)
                process.join()
                holder.kill()
                holder.join()
                found.append(count)
        with tempfile.TemporaryDirectory() as name:
            put, take, done = kind(Path(name))
            started = time.perf_counter()
            for number in range(200):
                put(f"item {number}")
                done(take())
            seconds = (time.perf_counter() - started) / 200
        print(
            f"{kind.__name__:14} of ten, one held by a server: {found[0]} go to another while it "
            f"lives (right: 9), {found[1]} after it was killed (right: 10); "
            f"{seconds * 1e3:.2f} ms for put, take and done"
        )


def digits() -> None:
    """Print the speed and the decisions of Arb's balls against mpmath's numbers."""
    from flint import arb, ctx  # type: ignore[import-not-found]

    from vibrafeed.core.sweep.precise import CONTEXT, DIGITS

    ctx.dps = DIGITS
    a, b, x, y = CONTEXT.mpf(1) / 3, CONTEXT.mpf(2) / 7, arb(1) / 3, arb(2) / 7
    for name, by_mpmath, by_arb in (
        ("add", lambda: a + b, lambda: x + y),
        ("multiply", lambda: a * b, lambda: x * y),
        ("divide", lambda: a / b, lambda: x / y),
        ("less", lambda: a < b, lambda: x < y),
        ("sqrt", lambda: CONTEXT.sqrt(a), x.sqrt),
        ("sin", lambda: CONTEXT.sin(a), x.sin),
        ("exp", lambda: CONTEXT.exp(a), x.exp),
    ):
        ours, balls = (
            min(timeit.repeat(call, number=5000, repeat=ROUNDS)) for call in (by_mpmath, by_arb)
        )
        print(f"{name:9} {ours / balls:5.1f} times as fast")
    zero = 3 * x - 1
    print(f"1/3 * 3 - 1 is {zero}: == 0 {zero == 0}, < 0 {zero < 0}, >= 0 {zero >= 0}")


PARTS = {
    "guard": guard, "downloads": downloads, "console": console, "ledger": ledger, "digits": digits,
}  # fmt: skip

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        print(f"--- {part}")
        PARTS[part]()
