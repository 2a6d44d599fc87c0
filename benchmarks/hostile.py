"""Clients that mean harm, for tests/service/test_hostile.py: their cost for all others.

`suffered` carries out an attack against a fresh server that may open 1,024 files. Meanwhile a
process of its own asks /healthz and for a small slice, again and again, each time on a new
connection, and from another address of this machine: it is another owner.
"""

from __future__ import annotations

import http.client
import multiprocessing
import selectors
import socket
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import psutil

from benchmarks.serving import Served, served

OPEN_FILES = 1024
REST = 10.0  # s after an attack, until the memory is looked at again
STILL, LOOK = 5.0, 3.0  # s from then on, until it is looked whether somebody still works, and for
MB = 1_000_000
ELSEWHERE = "127.0.0.2"  # where another owner asks from: without keys an address is one
PLANE = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"]}
GRID = {"frequency": 50, "amplitude": 0.0005, "alpha": 5, "friction": 0.3}
SMALL: dict[str, Any] = {
    **PLANE,
    "parameters": {**GRID, "beta": {"start": 0, "stop": 90, "num": 10}},
}
LARGE: dict[str, Any] = {  # a slice of it has 10^6 values
    **PLANE,
    "parameters": {
        **GRID,
        "beta": {"start": 0, "stop": 90, "num": 1000},
        "gamma": {"start": 0, "stop": 20, "num": 1000},
    },
}


@dataclass(frozen=True)
class Limits:
    """What an attack may do at most: silences [s], memory [bytes], bytes of log a second.

    `busy` are cores that still work after it.
    """

    health: float = 1.0
    small: float = 3.0
    peak: float = 1000 * MB
    after: float = 300 * MB
    log: float = 100_000
    busy: float = 0.5


@dataclass
class Found:
    """What an attack did."""

    seconds: float = 0.0
    health: float = 0.0
    small: float = 0.0
    peak: int = 0
    after: int = 0
    processor: float = 0.0
    log: int = 0
    busy: float = 0.0

    def missed(self, limits: Limits) -> list[str]:
        """Return the limits that an attack has exceeded."""
        figures = {
            "health": self.health,
            "small": self.small,
            "peak": self.peak,
            "after": self.after,
            "log": self.log / max(1.0, self.seconds),
            "busy": self.busy,
        }
        return [
            f"{name}: {value:,.1f}, at most {getattr(limits, name):,}"
            for name, value in figures.items()
            if value > getattr(limits, name)
        ]


def silent(server: Served, seconds: float) -> None:
    """Attack: keep 1,200 connections open without sending anything."""
    _crowd(server, [b""] * 1200, seconds)


def deaf_slices(server: Served, seconds: float) -> None:
    """Attack: twice 200 clients request a slice of 10^6 values and read nothing."""
    path = _slice_of(server, LARGE, "beta,gamma")
    for _ in range(2):
        _crowd(server, [_request(server, "GET", path)] * 200, seconds / 2)


def _slice_of(server: Served, study: dict[str, Any], axes: str) -> str:
    """Return the path of a slice of a sweep over axes, with what else is asked."""
    key = server.post("/sweeps", study)["id"]
    return f"/sweeps/{key}/slice?output=acceleration_x&axes={axes}"


def _request(server: Served, method: str, path: str, *headers: str) -> bytes:
    """Return the bytes of a request's head."""
    host = "{}:{}".format(*server.place)
    return "\r\n".join([f"{method} {path} HTTP/1.1", f"Host: {host}", *headers, "", ""]).encode()


@dataclass
class _Hostile:
    """One connection of a crowd, and what it has not said yet."""

    socket: socket.socket
    left: bytes


def _crowd(
    server: Served,
    requests: list[bytes],
    seconds: float,
    *,
    at_once: int | None = None,
    bytes_a_second: int = 0,
    is_read: bool = False,
) -> None:
    """Open a connection for each request, say it, and keep the connection for so long.

    Connections that the server closes are opened anew, and nothing is read unless `is_read`: then
    the crowd leaves once all are answered. With `bytes_a_second` a request is said so slowly from
    the byte `at_once` on.
    """
    first = (at_once or 0) if bytes_a_second else None
    until = time.monotonic() + seconds
    chosen = selectors.DefaultSelector()

    def join(request: bytes) -> None:
        """Open a connection for a request and register it."""
        client = socket.socket()
        client.setblocking(False)
        client.connect_ex(server.place)
        chosen.register(client, selectors.EVENT_READ | selectors.EVENT_WRITE, (request, None))

    for request in requests:
        join(request)
    spoken: dict[socket.socket, _Hostile] = {}
    answered, due = 0, time.monotonic() + 1
    while (now := time.monotonic()) < until and answered < len(requests):
        for key, events in chosen.select(0.1):
            client, (request, _) = key.fileobj, key.data
            assert isinstance(client, socket.socket)
            if client not in spoken:
                if not events & selectors.EVENT_WRITE:
                    continue
                with suppress(OSError):
                    client.send(request[:first])
                spoken[client] = _Hostile(client, b"" if first is None else request[first:])
                chosen.modify(client, selectors.EVENT_READ, key.data)
                continue
            with suppress(OSError):
                if client.recv(1, socket.MSG_PEEK):  # an answer, which stays where it is
                    answered += is_read
                    chosen.unregister(client)
                    continue
            spoken.pop(client).socket.close()
            chosen.unregister(client)
            join(request)
        if bytes_a_second and now > due:
            due = now + 1
            for one in spoken.values():
                with suppress(OSError):
                    one.socket.send(one.left[:bytes_a_second])
                one.left = one.left[bytes_a_second:]
    for one in spoken.values():
        one.socket.close()
    for key in list(chosen.get_map().values()):
        key.fileobj.close()  # type: ignore[union-attr]


def watch(server: Served, small: str, telling: Connection) -> None:
    """Request /healthz and a path until told to stop; send the longest silence of each."""
    over = threading.Event()
    paths = {"/healthz": 0.05, small: 0.2}
    with ThreadPoolExecutor(len(paths)) as threads:
        running = [threads.submit(_silence, server, *asked, over) for asked in paths.items()]
        telling.send("watching")
        telling.recv()
        over.set()
        telling.send([one.result() for one in running])


def _silence(server: Served, path: str, every: float, over: threading.Event) -> float:
    """Return the longest time from a request to its answer."""
    longest, since = 0.0, time.monotonic()
    while not over.wait(every):
        with suppress(OSError, http.client.HTTPException):
            if server.ask("GET", path, source=ELSEWHERE, timeout=5).status == 200:
                longest, since = max(longest, time.monotonic() - since - every), time.monotonic()
    return max(longest, time.monotonic() - since - every)


def suffered(attack: Callable[[Served, float], None], seconds: float) -> Found:
    """Return the effects of an attack on a fresh server."""
    found = Found(seconds)
    with served(open_files=OPEN_FILES, workers=2) as server:
        key = server.post("/sweeps", SMALL)["id"]
        small = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta"
        server.get(small)
        here, there = multiprocessing.Pipe()
        watcher = multiprocessing.get_context("spawn").Process(
            target=watch, args=(server, small, there)
        )
        watcher.start()
        here.recv()
        process = psutil.Process(server.pid)
        before = process.cpu_times()
        attack(server, seconds)
        time.sleep(REST)
        after = process.cpu_times()
        found.processor = after.user + after.system - before.user - before.system
        found.after = server.memory()
        found.peak = _peak(server.pid)
        found.log = server.log.stat().st_size
        time.sleep(STILL)
        found.busy = _busy(process)
        here.send("over")
        found.health, found.small = here.recv()
        watcher.join()
    return found


def _busy(process: psutil.Process) -> float:
    """Return the number of cores that a process and its children keep busy."""

    def spent() -> dict[int, float]:
        """Return the processor time of each process."""
        found = {}
        for one in (process, *process.children(recursive=True)):
            with suppress(psutil.Error):
                times = one.cpu_times()
                found[one.pid] = times.user + times.system
        return found

    before = spent()
    time.sleep(LOOK)
    return sum(seconds - before.get(pid, 0.0) for pid, seconds in spent().items()) / LOOK


def _peak(pid: int) -> int:
    """Return the peak memory of a process [bytes]."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    (line,) = (line for line in lines if line.startswith("VmHWM:"))
    return int(line.split()[1]) * 1024
