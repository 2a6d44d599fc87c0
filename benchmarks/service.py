"""What the service adds to the core's own time, and how fast it sends files.

`python -m benchmarks.service` starts a server, asks it and the core in turn for the same, and
prints medians. Bars: 2 ms more than the core for a slice of 10^5 values and a sweep of 10^4 cells,
serialisation counted apart; a warm download of 1 GB at 80 % of a bare sendfile loop. The column
"bare" is what a socket takes, without any service, to be asked for as many bytes and to send them:
how quick the machine is to wake a process up, and the least that any service adds. The column
"uvicorn" is the same with uvicorn and h11 before an application that sends ready bytes: the least
that a service on them adds. "added" is without core and writing, and with all of uvicorn.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import re
import socket
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import orjson
import uvicorn
from starlette.types import Receive, Scope, Send

from benchmarks.options import options
from benchmarks.serving import Served, percentile, served
from benchmarks.timing import timed
from vibrafeed.app.jobs.manifest import NETCDF
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.web.calculations import encode_binary
from vibrafeed.core.dataset.document import to_document
from vibrafeed.core.intake import prepare_content, read_json
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.sweep.slice import compute_slice, prepare_cut

FREE = {"alpha": 250, "beta": 400}  # 10^5 values
MILLION = {"alpha": 1000, "beta": 1000}
STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["acceleration_x"],
    "parameters": {
        "frequency": [50, 60],
        "amplitude": "0.5 mm",
        "friction": 0.3,
        "radius": "0.8 m",
        **{name: {"start": 0, "stop": 90, "num": size} for name, size in FREE.items()},
    },
}
SMALL = {
    **STUDY,
    "parameters": {
        **STUDY["parameters"],  # type: ignore[dict-item]
        "frequency": 50,
        "alpha": {"start": 0, "stop": 90, "num": 100},
        "beta": {"start": 0, "stop": 90, "num": 100},
    },
}
COMPILED = 150  # slices of 10^5 values after which their loop is compiled
GIGABYTE = 1_000_000_000
PIECE = 1 << 20
BUFFER = 1 << 24  # more than any of the replies compared
HEAD = re.compile(rb"(?is)HTTP/1.1 .*?\r\ncontent-length: (?P<length>[0-9]+).*?\r\n\r\n")


class Client:
    """One connection that stays open; a bare socket, since libraries parse as long as we compute.

    Attributes
    ----------
    size : int
        Bytes of the last reply, its head among them.
    """

    def __init__(self, address: tuple[str, int]):
        self._name = f"{address[0]}:{address[1]}"
        self._socket = socket.create_connection(address)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._buffer = bytearray(BUFFER)
        self.size = 0

    def ask(self, method: str, path: str, body: bytes = b"") -> None:
        """Send a request and receive the whole reply."""
        head = (
            f"{method} {path} HTTP/1.1\r\nHost: {self._name}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
        )
        self._socket.sendall(head.encode() + body)
        view, end, self.size = memoryview(self._buffer), 0, 0
        while not self.size or end < self.size:
            count = self._socket.recv_into(view[end:])
            if not count:
                raise RuntimeError(f"{method} {path}: cut short after {end:,} bytes")
            end += count
            if not self.size and (found := HEAD.match(self._buffer, 0, end)):
                self.size = found.end() + int(found["length"])
        if not self._buffer.startswith(b"HTTP/1.1 200 "):
            raise RuntimeError(f"{method} {path}: {bytes(view[:500])!r}")


def clocked(call: Callable[[], Any]) -> float:
    """Return the wall time of a call [ms]."""
    return 1e3 * timed(call)[1]


class Comparison:
    """Asks a service, a bare server, and the core in turn, and prints a line of medians."""

    def __init__(self, server: Served, pairs: int):
        self.client = Client(server.place)
        self.pairs = pairs
        listener = socket.create_server(("127.0.0.1", 0))
        process = multiprocessing.Process(target=_reply_for_ever, args=(listener,), daemon=True)
        process.start()
        self.bare = Client(listener.getsockname())
        listener = socket.create_server(("127.0.0.1", 0))
        multiprocessing.Process(target=_serve_for_ever, args=(listener,), daemon=True).start()
        self.uvicorn = Client(listener.getsockname())
        print(
            f"{'milliseconds':22} {'req/s':>7} {'p50':>8} {'p99':>8} {'core':>8} {'written':>8} "
            f"{'bare':>8} {'uvicorn':>8} {'added':>8}"
        )

    def line(self, name: str, wanted: tuple[Any, ...], computed: Callable[[], Any],
             written: Callable[[], Any]) -> None:  # fmt: skip
        """Print the time that the service adds to computing and writing."""
        self.client.ask(*wanted)
        size = self.client.size
        times = [
            (
                clocked(lambda: self.client.ask(*wanted)),
                clocked(computed),
                clocked(written),
                clocked(lambda: self.bare.ask("GET", f"/{size}")),
                clocked(lambda: self.uvicorn.ask("GET", f"/{size}")),
            )
            for _ in range(self.pairs + 5)
        ][5:]
        service, *others = (list(column) for column in zip(*times, strict=True))
        middle = statistics.median(service)
        print(
            f"{name:22} {1e3 / middle:7.0f} {middle:8.2f} {percentile(service, 0.99):8.2f} "
            + " ".join(f"{statistics.median(column):8.2f}" for column in others)
            + f" {statistics.median(one[0] - one[1] - one[2] for one in times):8.2f}"
        )


def requests(server: Served, pairs: int) -> None:
    """Print the times of slices and of a small sweep."""
    comparison = Comparison(server, pairs)
    piece, path = _slice_of(server, STUDY)
    taken = piece()
    assert np.size(taken["values"]["data"]) == 100_000
    for _ in range(COMPILED):  # until both are compiled
        comparison.client.ask("GET", f"{path}&format=binary")
        piece()
    comparison.line(
        "slice, JSON",
        ("GET", f"{path}&format=json"),
        piece,
        lambda: orjson.dumps(taken, option=orjson.OPT_SERIALIZE_NUMPY),
    )
    comparison.line(
        "slice, binary", ("GET", f"{path}&format=binary"), piece, lambda: encode_binary(taken)
    )
    spans = {name: {"start": 0, "stop": 90, "num": size} for name, size in MILLION.items()}
    large, path = _slice_of(server, {**STUDY, "parameters": {**STUDY["parameters"], **spans}})
    held = large()
    for _ in range(COMPILED // 5):
        comparison.client.ask("GET", f"{path}&format=binary")
        large()
    comparison.line(
        "slice of 10^6, binary",
        ("GET", f"{path}&format=binary"),
        large,
        lambda: encode_binary(held),
    )
    body = json.dumps(SMALL).encode()
    table = tabulate(prepare_content(SMALL))
    comparison.line(
        "sweep of 10^4 cells",
        ("POST", "/processes/sweep/execution", body),
        lambda: tabulate(prepare_content(read_json(body))),
        lambda: orjson.dumps(to_document(table), option=orjson.OPT_SERIALIZE_NUMPY),
    )


def _slice_of(server: Served, study: dict[str, Any]) -> tuple[Callable[[], dict[str, Any]], str]:
    """Return a function that cuts a slice in this process, and its URL on a server."""
    key = server.post("/sweeps", study)["id"]
    sweep = prepare_content(study)
    wishes = {"output": "acceleration_x", "axes": list(FREE), "at": {"frequency": "60"}}
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes={','.join(FREE)}&frequency=60"
    return lambda: compute_slice(prepare_cut(sweep, **wishes, most=10**6)), path  # type: ignore[arg-type]


def download(server: Served, pairs: int) -> None:
    """Print the speed of a warm download of 1 GB against a plain sendfile loop."""
    path = server.file_of(SMALL, GIGABYTE)
    file = Store(server.data).folder(path.split("/")[2]) / NETCDF
    ours = server.place
    request = f"GET {path} HTTP/1.1\r\nHost: {ours[0]}:{ours[1]}\r\n\r\n".encode()
    listener = socket.create_server(("127.0.0.1", 0))
    bare = multiprocessing.Process(target=_send_for_ever, args=(listener, str(file)), daemon=True)
    bare.start()
    theirs = listener.getsockname()
    times = [(received(ours, request), received(theirs, request)) for _ in range(pairs + 1)][1:]
    bare.terminate()
    service, loop = (statistics.median(column) for column in zip(*times, strict=True))
    ratios = [b / a for a, b in times]
    print(
        f"download of 1 GB       {GIGABYTE / service / 1e9:.2f} GB/s, sendfile "
        f"{GIGABYTE / loop / 1e9:.2f} GB/s; {statistics.median(ratios):.0%} of it (median of "
        f"{pairs} pairs, {min(ratios):.0%} to {max(ratios):.0%})"
    )


def received(address: tuple[str, int], request: bytes) -> float:
    """Return the time to receive a reply of 1 GB [s]."""
    buffer = bytearray(PIECE)
    started = time.perf_counter()
    with socket.create_connection(address) as connection:
        connection.sendall(request)
        head = b""
        while b"\r\n\r\n" not in head:
            head += connection.recv(65_536)
        length = len(head.partition(b"\r\n\r\n")[2])
        while length < GIGABYTE:
            count = connection.recv_into(buffer)
            if not count:
                raise RuntimeError(f"cut short after {length:,} bytes: {head[:200]!r}")
            length += count
    return time.perf_counter() - started


def _reply_for_ever(listener: socket.socket) -> None:
    """Answer requests on one connection with prepared bytes."""
    connection, _ = listener.accept()
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    replies: dict[int, bytes] = {}  # ready, so that only sending takes time
    while request := connection.recv(65_536):
        size = int(request.split(b" ")[1][1:])
        if size not in replies:
            head = b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n" % size
            replies[size] = head + os.urandom(size)
        connection.sendall(replies[size])


def _serve_for_ever(listener: socket.socket) -> None:
    """Answer requests by uvicorn with prepared bytes."""
    replies: dict[int, bytes] = {}

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        """Send as many bytes as the path of the request names."""
        size = int(scope["path"][1:])
        if size not in replies:
            replies[size] = os.urandom(size)
        head = [(b"content-length", b"%d" % size)]
        await send({"type": "http.response.start", "status": 200, "headers": head})
        await send({"type": "http.response.body", "body": replies[size]})

    config = uvicorn.Config(app, http="h11", ws="none", lifespan="off", log_config=None)
    uvicorn.Server(config).run([listener])


def _send_for_ever(listener: socket.socket, path: str) -> None:
    """Send a file of 1 GB to every client."""
    while True:
        connection, _ = listener.accept()
        with connection, Path(path).open("rb") as file:
            connection.recv(65_536)
            connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 1000000000\r\n\r\n")
            offset = 0
            while offset < GIGABYTE:
                offset += os.sendfile(connection.fileno(), file.fileno(), offset, GIGABYTE - offset)


def main() -> None:
    """Print all measurements."""
    wanted = options(__doc__, pairs=200, downloads=7)
    with served(warm_at_start=False) as server:  # compiling beside it would take a core
        requests(server, wanted.pairs)
        download(server, wanted.downloads)


if __name__ == "__main__":
    main()
