"""What the service adds to the core's own time, and how fast it sends files.

`python -m benchmarks.service` starts a server, asks it and the core in turn for the same, and
prints medians. Bars: 2 ms more than the core for a slice of 10^5 values and a sweep of 10^4 cells,
serialisation counted apart; a warm download of 1 GB at 80 % of a bare sendfile loop.
"""

from __future__ import annotations

import argparse
import http.client
import json
import multiprocessing
import os
import socket
import statistics
import time
import urllib.parse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import orjson

from app.routes.sweeps import NUMPY, binary
from app.store import NETCDF, Store
from benchmarks.serving import Served, percentile, served
from core.dataset.document import to_document
from core.kinds import prepare_content, tabulate
from core.study.load import read_json
from core.sweep.slice import cut

FREE = {"alpha": 250, "beta": 400}  # 10^5 values
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
GIGABYTE = 1_000_000_000
PIECE = 1 << 20


class Client:
    """One connection that stays open."""

    def __init__(self, server: Served):
        self._connection = http.client.HTTPConnection(urllib.parse.urlsplit(server.address).netloc)
        self._connection.connect()
        self._connection.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def ask(self, method: str, path: str, body: bytes | None = None) -> bytes:
        """Return what is replied."""
        headers = {"Content-Type": "application/json"} if body else {}
        self._connection.request(method, path, body, headers)
        reply = self._connection.getresponse()
        content = reply.read()
        if reply.status != 200:
            raise RuntimeError(f"{method} {path}: {reply.status} {content[:500]!r}")
        return content


def clocked(call: Callable[[], Any]) -> float:
    """Return the wall time of a call in milliseconds."""
    started = time.perf_counter()
    call()
    return 1e3 * (time.perf_counter() - started)


def compare(name: str, asked: Callable[[], Any], computed: Callable[[], Any],
            written: Callable[[], Any], pairs: int) -> float:  # fmt: skip
    """Print and return what the service adds to computing and writing; they take turns."""
    times = [(clocked(asked), clocked(computed), clocked(written)) for _ in range(pairs + 5)][5:]
    service, core, serialised = (list(column) for column in zip(*times, strict=True))
    added = statistics.median(a - b - c for a, b, c in times)
    print(
        f"{name:22} {1e3 / statistics.median(service):7.0f} {statistics.median(service):8.2f} "
        f"{percentile(service, 0.99):8.2f} {statistics.median(core):8.2f} "
        f"{statistics.median(serialised):8.2f} {added:8.2f}"
    )
    return added


def requests(server: Served, pairs: int) -> None:
    """Print the times of slices and of a small sweep."""
    client = Client(server)
    key = server.post("/sweeps", STUDY)["id"]
    sweep = prepare_content(STUDY)
    axes = ",".join(FREE)
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes={axes}&frequency=60"

    def piece() -> dict[str, Any]:
        wishes = {"output": "acceleration_x", "axes": list(FREE), "at": {"frequency": "60"}}
        return cut(sweep, **wishes, most=10**6)  # type: ignore[arg-type]

    taken = piece()
    assert np.size(taken["values"]["data"]) == 100_000
    print(
        f"{'milliseconds':22} {'req/s':>7} {'p50':>8} {'p99':>8} {'core':>8} {'written':>8} added"
    )
    compare(
        "slice, JSON",
        lambda: client.ask("GET", f"{path}&format=json"),
        piece,
        lambda: orjson.dumps(taken, option=NUMPY),
        pairs,
    )
    compare(
        "slice, binary",
        lambda: client.ask("GET", f"{path}&format=binary"),
        piece,
        lambda: binary(taken),
        pairs,
    )
    body = json.dumps(SMALL).encode()
    table = tabulate(prepare_content(SMALL))
    compare(
        "sweep of 10^4 cells",
        lambda: client.ask("POST", "/processes/sweep/execution", body),
        lambda: tabulate(prepare_content(read_json(body))),
        lambda: orjson.dumps(to_document(table), option=NUMPY),
        pairs,
    )


def download(server: Served, pairs: int) -> None:
    """Print the speed of a warm download of 1 GB beside that of a bare sendfile loop."""
    path = server.file_of(SMALL, GIGABYTE)
    file = Store(server.data).folder(path.split("/")[2]) / NETCDF
    address = urllib.parse.urlsplit(server.address)
    request = f"GET {path} HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode()
    listener = socket.create_server(("127.0.0.1", 0))
    bare = multiprocessing.Process(target=_send_for_ever, args=(listener, str(file)), daemon=True)
    bare.start()
    ours = (str(address.hostname), int(address.port or 0))
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
    """Return the seconds that a reply with 1 GB takes."""
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


def _send_for_ever(listener: socket.socket, path: str) -> None:
    while True:
        connection, _ = listener.accept()
        with connection, Path(path).open("rb") as file:
            connection.recv(65_536)
            connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 1000000000\r\n\r\n")
            offset = 0
            while offset < GIGABYTE:
                offset += os.sendfile(connection.fileno(), file.fileno(), offset, GIGABYTE - offset)


def main() -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--downloads", type=int, default=7)
    wanted = parser.parse_args()
    with served() as server:
        requests(server, wanted.pairs)
        download(server, wanted.downloads)


if __name__ == "__main__":
    main()
