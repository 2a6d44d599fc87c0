"""Clients that mean harm: what they cost the service, and what they cost everybody else.

`python -m benchmarks.hostile` carries out each attack against a fresh server that may open 1,024
files; names of attacks as arguments choose some. Meanwhile a process of its own asks /healthz and
for a small slice, again and again, each time on a new connection. Printed are the longest silences
of both (from the first try to the right answer), the server's memory at its peak and 10 s after the
attack, the processor time that the attack cost, how busy the server and its workers are 15 s after
it, and the bytes it wrote into the log. Exits with 1 if a limit is missed.
"""

from __future__ import annotations

import argparse
import http.client
import json
import math
import multiprocessing
import resource
import selectors
import socket
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import psutil

from benchmarks.serving import Served, served

OPEN_FILES = 1024
REST = 10.0  # s after an attack, until the memory is looked at again
STILL, LOOK = 5.0, 3.0  # s from then on, until it is looked whether somebody still works, and for
MB = 1_000_000

PLANE = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"]}
GRID = {"frequency": 50, "amplitude": 0.0005, "alpha": 5, "friction": 0.3}
SMALL = {**PLANE, "parameters": {**GRID, "beta": {"start": 0, "stop": 90, "num": 10}}}
LARGE = {  # a slice of it has 10^6 values
    **PLANE,
    "parameters": {
        **GRID,
        "beta": {"start": 0, "stop": 90, "num": 1000},
        "gamma": {"start": 0, "stop": 20, "num": 1000},
    },
}
HUGE = {  # its file has 340 MB
    **PLANE,
    "parameters": {
        **LARGE["parameters"],  # type: ignore[dict-item]
        "amplitude": {"start": 1e-4, "stop": 5e-4, "num": 19},
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
        """Return what is beyond its limit."""
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


# --- the attacks, each a function of the server and of how long it lasts [s]


def unknown_outputs(server: Served, seconds: float) -> None:
    """Eight bodies at once that ask for 40,000 outputs that there are not."""
    body = json.dumps({**SMALL, "outputs": [f"throw_numbre_{i}" for i in range(40_000)]}).encode()
    request = _request(server, "POST", "/sweeps", f"Content-Length: {len(body)}") + body
    _crowd(server, [request] * 8, seconds, is_read=True)


def silent(server: Served, seconds: float) -> None:
    """1,200 connections that say nothing, opened anew when they are closed."""
    _crowd(server, [b""] * 1200, seconds)


def slow_heads(server: Served, seconds: float) -> None:
    """1,200 heads that come a byte a second."""
    head = _request(server, "GET", "/scenes", f"X-Long: {'x' * 1000}")
    _crowd(server, [head] * 1200, seconds, bytes_a_second=1)


def slow_bodies(server: Served, seconds: float) -> None:
    """1,200 bodies that come a byte a second."""
    head = _request(server, "POST", "/sweeps", "Content-Length: 500000")
    _crowd(server, [head + b"x" * 1000] * 1200, seconds, at_once=len(head), bytes_a_second=1)


def deaf_slices(server: Served, seconds: float) -> None:
    """Twice 200 clients that ask for a slice of 10^6 values and read nothing."""
    key = server.post("/sweeps", LARGE)["id"]
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta,gamma"
    for _ in range(2):
        _crowd(server, [_request(server, "GET", path)] * 200, seconds / 2)


def deaf_downloads(server: Served, seconds: float) -> None:
    """200 clients that ask for a file of 100 MB and read nothing."""
    path = server.file_of(LARGE, 100 * MB)
    _crowd(server, [_request(server, "GET", path)] * 200, seconds)


def heads(server: Served, seconds: float) -> None:
    """HEAD of four files of 340 MB that are not made yet, and GET of one of a few values."""
    studies = [
        {**HUGE, "parameters": {**HUGE["parameters"], "frequency": 50 + n}}  # type: ignore[dict-item]
        for n in range(4)
    ]
    paths = [f"/sweeps/{server.post('/sweeps', study)['id']}/netcdf" for study in studies]
    small = _request(server, "GET", f"/sweeps/{server.post('/sweeps', SMALL)['id']}/netcdf")
    _crowd(server, [_request(server, "HEAD", path) for path in paths] + [small], seconds)


def long_cells(server: Served, seconds: float) -> None:
    """Four requests of 200 bytes for a cell that takes hours; they are left when time is up."""
    _crowd(server, [_long_cell(server, n) for n in range(4)], seconds)


def long_jobs(server: Served, seconds: float) -> None:
    """Four such jobs, dismissed after half of the time; a small job has to come through then."""
    numbers = []
    for n in range(4):
        numbers.append(_posted(server, "simulate", _long_study(n)))
    time.sleep(seconds / 2)
    for number in numbers:
        _delete(server, f"/jobs/{number}")
    _has_to_end(server, _posted(server, "sweep", SMALL), seconds / 2)


def many_jobs(server: Served, seconds: float) -> None:
    """Six such jobs, which stay; a small job has to come through beside them."""
    numbers = [_posted(server, "simulate", _long_study(n)) for n in range(6)]
    _has_to_end(server, _posted(server, "sweep", SMALL), seconds)
    for number in numbers:
        _delete(server, f"/jobs/{number}")


def accuracy_jobs(server: Served, seconds: float) -> None:
    """Three accuracy jobs, dismissed as they run; a small job has to come through then."""
    numbers = []
    for n in range(3):
        study = {**SMALL, "parameters": {**SMALL["parameters"], "frequency": 50 + n}}  # type: ignore[dict-item]
        numbers.append(_posted(server, "accuracy", study))
    time.sleep(seconds / 2)
    for number in numbers:
        _delete(server, f"/jobs/{number}")
    _has_to_end(server, _posted(server, "sweep", SMALL), seconds / 2)


def _posts(server: Served, path: str, contents: Sequence[object], seconds: float) -> None:
    """Post bodies at once, and again whenever all are answered; leave when time is up."""
    bodies = [json.dumps(content).encode() for content in contents]
    requests = [
        _request(server, "POST", path, "Content-Type: application/json", f"Content-Length: {n}")
        + body
        for body in bodies
        for n in [len(body)]
    ]
    _crowd_again(server, requests, seconds)


def convert_values(server: Served, seconds: float) -> None:
    """Eight clients that have a study of 9,000 values (60 kB) written as TOML."""
    values = [1e-4 + 1e-8 * n for n in range(9_000)]
    study = {**SMALL, "parameters": {**SMALL["parameters"], "amplitude": values}}  # type: ignore[dict-item]
    _posts(server, "/convert?to=toml", [study] * 8, seconds)


def convert_headings(server: Served, seconds: float) -> None:
    """Sixteen clients that convert a recording whose heading is 20,000 spaces."""
    text = f"time{' ' * 20_000}[s],a [m/s^2]\n" + "".join(f"{n / 1000},0\n" for n in range(20))
    _posts(server, "/convert?to=toml", [_recorded(text)] * 16, seconds)


def convert_recordings(server: Served, seconds: float) -> None:
    """Sixteen clients that convert honest recordings of 20,000 rows."""
    rows = (
        f"{n / 2000:.4f},{30 * math.sin(0.157 * n):.3f},{10 * math.sin(0.157 * n):.3f}"
        for n in range(20_000)
    )
    text = "time [s],ax [m/s^2],az [m/s^2]\n" + "\n".join(rows) + "\n"
    _posts(server, "/convert?to=toml", [_recorded(text)] * 16, seconds)


def _recorded(text: str) -> dict[str, object]:
    drive = {"data": text, "along": "ax", "normal": "az", "line_frequency": 50}
    motion = {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"]}
    return {**motion, "drive": drive, "parameters": {"friction": 0.3}}


def many_names(server: Served, seconds: float) -> None:
    """64 clients that ask for slices with 5,000 names in their queries."""
    key = server.post("/sweeps", LARGE)["id"]
    names = "&".join(f"n{n}=1" for n in range(5_000))
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta&{names}"
    _crowd_again(server, [_request(server, "GET", path)] * 64, seconds)


def short_motions(server: Served, seconds: float) -> None:
    """64 clients that post motions which are answered at once, other ones each time."""
    motions = [
        {
            "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
            "parameters": {
                "frequency": 50, "friction": 0.3 + n * 1e-4,
                "amplitude": {"start": 1e-4, "stop": 4e-4, "num": 40},
                "beta": {"start": 5, "stop": 60, "num": 40},
            },
        }
        for n in range(64)
    ]  # fmt: skip
    _posts(server, "/processes/simulate/execution", motions, seconds)


def dear_slices(server: Served, seconds: float) -> None:
    """64 clients that ask for a small slice of a sweep with 100,000 values on a fixed axis."""
    values = [1e-4 + 1e-9 * n for n in range(60_000)]
    study = {**SMALL, "parameters": {**SMALL["parameters"], "amplitude": values}}  # type: ignore[dict-item]
    key = server.post("/sweeps", study)["id"]
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta&amplitude=0.0001"
    _crowd_again(server, [_request(server, "GET", path)] * 64, seconds)


def waiting(server: Served, seconds: float) -> None:
    """520 clients that wait for one long job, up to 60 s each."""
    number = _posted(server, "simulate", _long_study(0))
    request = _request(server, "GET", f"/jobs/{number}", "Prefer: wait=60")
    _crowd(server, [request] * 520, seconds)
    _delete(server, f"/jobs/{number}")


def _crowd_again(server: Served, requests: list[bytes], seconds: float) -> None:
    until = time.monotonic() + seconds
    while (left := until - time.monotonic()) > 0:
        _crowd(server, requests, left, is_read=True)


def _long_study(n: int) -> dict[str, object]:
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "method": "reference",
        "parameters": {
            "frequency": 50 + n * 1e-6,
            "amplitude": "2.1 mm",
            "beta": 41,
            "friction": 0.4,
            "restitution": 0.6,
        },
        "max_periods": 100_000,
    }


def _long_cell(server: Served, n: int) -> bytes:
    body = json.dumps(_long_study(n)).encode()
    path = "/processes/simulate/execution"
    return _request(server, "POST", path, f"Content-Length: {len(body)}") + body


def _posted(server: Served, process: str, study: object) -> str:
    path = f"/processes/{process}/execution"
    return str(server.post(path, study, Prefer="respond-async")["jobID"])


def _delete(server: Served, path: str) -> None:
    connection = http.client.HTTPConnection(*server.place, timeout=30)
    connection.request("DELETE", path)
    connection.getresponse().read()
    connection.close()


def _has_to_end(server: Served, number: str, seconds: float) -> None:
    started = time.monotonic()
    until = started + seconds
    while (status := server.get(f"/jobs/{number}")["status"]) != "successful":
        if time.monotonic() > until:
            print(f"  MISSED a small job is {status} after {seconds:g} s")
            return
        time.sleep(0.1)
    print(f"  a small job is successful after {time.monotonic() - started:.1f} s")


ATTACKS: dict[str, tuple[Callable[[Served, float], None], float]] = {
    "unknown_outputs": (unknown_outputs, 5),
    "silent": (silent, 20),
    "slow_heads": (slow_heads, 20),
    "slow_bodies": (slow_bodies, 20),
    "deaf_slices": (deaf_slices, 30),
    "deaf_downloads": (deaf_downloads, 20),
    "heads": (heads, 10),
    "long_cells": (long_cells, 40),
    "long_jobs": (long_jobs, 60),
    "many_jobs": (many_jobs, 60),
    "accuracy_jobs": (accuracy_jobs, 60),
    "convert_values": (convert_values, 20),
    "convert_headings": (convert_headings, 20),
    "convert_recordings": (convert_recordings, 20),
    "many_names": (many_names, 20),
    "short_motions": (short_motions, 30),
    "dear_slices": (dear_slices, 20),
    "waiting": (waiting, 30),
}
"""Every attack, and how long it lasts [s]."""


def _request(server: Served, method: str, path: str, *headers: str) -> bytes:
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


# --- what others notice


def watch(place: tuple[str, int], small: str, telling: Connection) -> None:
    """Ask for /healthz and for a path until told to stop; send the longest silence of each."""
    over = threading.Event()
    paths = {"/healthz": 0.05, small: 0.2}
    with ThreadPoolExecutor(len(paths)) as threads:
        running = [threads.submit(_silence, place, *asked, over) for asked in paths.items()]
        telling.send("watching")
        telling.recv()
        over.set()
        telling.send([one.result() for one in running])


def _silence(place: tuple[str, int], path: str, every: float, over: threading.Event) -> float:
    """Return the longest time from asking for a path to its answer, other tries in between."""
    longest, since = 0.0, time.monotonic()
    while not over.wait(every):
        connection = http.client.HTTPConnection(*place, timeout=5)
        with suppress(OSError, http.client.HTTPException):
            connection.request("GET", path)
            reply = connection.getresponse()
            reply.read()
            if reply.status == 200:
                longest, since = max(longest, time.monotonic() - since - every), time.monotonic()
        connection.close()
    return max(longest, time.monotonic() - since - every)


def suffered(attack: Callable[[Served, float], None], seconds: float) -> Found:
    """Return what an attack does to a fresh server."""
    found = Found(seconds)
    with served(open_files=OPEN_FILES, workers=2) as server:
        key = server.post("/sweeps", SMALL)["id"]
        small = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta"
        server.get(small)
        here, there = multiprocessing.Pipe()
        watcher = multiprocessing.get_context("spawn").Process(
            target=watch, args=(server.place, small, there)
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
    """Return how many cores a process and its children keep busy."""

    def spent() -> dict[int, float]:
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
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    (line,) = (line for line in lines if line.startswith("VmHWM:"))
    return int(line.split()[1]) * 1024


def main() -> None:
    """Print what each attack does; exit with 1 if a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("attacks", nargs="*", choices=[[], *ATTACKS], default=[])
    wanted = parser.parse_args().attacks or list(ATTACKS)
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    print(f"{'':16} /healthz  slice   peak  after  processor    log   busy")
    missed = False
    for name in wanted:
        found = suffered(*ATTACKS[name])
        print(
            f"{name:16} {found.health:6.2f} s {found.small:5.2f} s {found.peak / MB:5.0f} "
            f"{found.after / MB:5.0f} MB {found.processor:6.1f} s {found.log / 1000:7.0f} kB "
            f"{found.busy:5.2f}",
            flush=True,
        )
        for what in found.missed(Limits()):
            print("  MISSED", what)
            missed = True
    raise SystemExit(missed)


if __name__ == "__main__":
    main()
