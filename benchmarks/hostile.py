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
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import psutil

from benchmarks.serving import Served, served

OPEN_FILES = 1024
REST = 10.0  # s after an attack, until the memory is looked at again
STILL, LOOK = 5.0, 3.0  # s from then on, until it is looked whether somebody still works, and for
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


def silent(server: Served, seconds: float) -> None:
    """Attack: keep 1,200 connections open without sending anything."""
    _crowd(server, [b""] * 1200, seconds)


def deaf_slices(server: Served, seconds: float) -> None:
    """Attack: twice 200 clients request a slice of 10^6 values and read nothing."""
    key = server.post("/sweeps", LARGE)["id"]
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta,gamma"
    host = "{}:{}".format(*server.place)
    request = f"GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode()
    for _ in range(2):
        _crowd(server, [request] * 200, seconds / 2)


def _crowd(server: Served, requests: list[bytes], seconds: float) -> None:
    """Open a connection for each request, send it, read nothing, and keep it open for so long.

    Connections that the server closes are opened anew.
    """
    until = time.monotonic() + seconds
    chosen = selectors.DefaultSelector()

    def join(request: bytes) -> None:
        client = socket.socket()
        client.setblocking(False)
        client.connect_ex(server.place)
        chosen.register(client, selectors.EVENT_READ | selectors.EVENT_WRITE, request)

    for request in requests:
        join(request)
    sent: set[socket.socket] = set()
    while time.monotonic() < until and chosen.get_map():
        for key, events in chosen.select(0.1):
            client = key.fileobj
            assert isinstance(client, socket.socket)
            if client not in sent:
                if events & selectors.EVENT_WRITE:
                    with suppress(OSError):
                        client.send(key.data)
                    sent.add(client)
                    chosen.modify(client, selectors.EVENT_READ, key.data)
                continue
            chosen.unregister(client)
            with suppress(OSError):
                if client.recv(1, socket.MSG_PEEK):  # an answer, which stays where it is
                    continue
            sent.discard(client)
            client.close()
            join(key.data)
    for one in [*sent, *(key.fileobj for key in chosen.get_map().values())]:
        one.close()  # type: ignore[union-attr]


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


def suffered(attack: Callable[[Served, float], None], seconds: float) -> dict[str, float]:
    """Return the effects of an attack on a fresh server.

    `health` and `small` are the longest silences of /healthz and of another owner's slice [s],
    `peak` and `after` the server's memory, at most and 10 s after the attack [bytes], `log` the
    bytes of log a second, and `busy` the cores that work on 15 s after it.
    """
    with served(open_files=OPEN_FILES, workers=2) as server:
        key = server.post("/sweeps", SMALL)["id"]
        small = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta"
        server.get(small)
        here, there = multiprocessing.Pipe()
        spawn = multiprocessing.get_context("spawn")
        watcher = spawn.Process(target=watch, args=(server, small, there))
        watcher.start()
        here.recv()
        attack(server, seconds)
        time.sleep(REST)
        after, status = server.memory(), Path(f"/proc/{server.pid}/status").read_text()
        log = server.log.stat().st_size / max(1.0, seconds)
        time.sleep(STILL)
        busy = _busy(psutil.Process(server.pid))
        here.send("over")
        health, slice_ = here.recv()
        watcher.join()
    peak = 1024 * int(status.partition("VmHWM:")[2].split()[0])
    return {"health": health, "small": slice_, "peak": peak, "after": after, "log": log,
            "busy": busy}  # fmt: skip


def _busy(process: psutil.Process) -> float:
    """Return the number of cores that a process and its children keep busy."""

    def spent() -> dict[int, float]:
        times = {}
        for one in (process, *process.children(recursive=True)):
            with suppress(psutil.Error):
                times[one.pid] = sum(one.cpu_times()[:2])
        return times

    before = spent()
    time.sleep(LOOK)
    return sum(seconds - before.get(pid, 0.0) for pid, seconds in spent().items()) / LOOK
