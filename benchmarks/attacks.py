"""Attacks on the service, for `benchmarks.hostile`: each a function of the server and its time [s].

The first ones are clients that say too little or read too slowly; then the table of requests that
are valid, cheap to send and dear to answer; last those found by reading what a client controls in
every route.
"""

from __future__ import annotations

import json
import math
import selectors
import socket
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from benchmarks.serving import Served
from vibrafeed.app.web.execution import PROCESSES

MB = 1_000_000
ELSEWHERE = "127.0.0.2"  # where another owner asks from: without keys an address is one

Study = dict[str, Any]

PLANE: Study = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"]}
GRID: Study = {"frequency": 50, "amplitude": 0.0005, "alpha": 5, "friction": 0.3}
SMALL: Study = {**PLANE, "parameters": {**GRID, "beta": {"start": 0, "stop": 90, "num": 10}}}
LARGE: Study = {  # a slice of it has 10^6 values
    **PLANE,
    "parameters": {
        **GRID,
        "beta": {"start": 0, "stop": 90, "num": 1000},
        "gamma": {"start": 0, "stop": 20, "num": 1000},
    },
}
HUGE: Study = {  # its file has 340 MB
    **PLANE,
    "parameters": {
        **LARGE["parameters"],
        "amplitude": {"start": 1e-4, "stop": 5e-4, "num": 19},
    },
}


def varied(study: Study, **parameters: object) -> Study:
    """Return a copy of a study with other parameters."""
    return {**study, "parameters": {**study["parameters"], **parameters}}


def unknown_outputs(server: Served, seconds: float) -> None:
    """Attack: post eight bodies at once that ask for 40,000 unknown outputs."""
    body = json.dumps({**SMALL, "outputs": [f"throw_numbre_{i}" for i in range(40_000)]}).encode()
    request = _request(server, "POST", "/sweeps", f"Content-Length: {len(body)}") + body
    _crowd(server, [request] * 8, seconds, is_read=True)


def silent(server: Served, seconds: float) -> None:
    """Attack: keep 1,200 connections open without sending anything."""
    _crowd(server, [b""] * 1200, seconds)


def slow_heads(server: Served, seconds: float) -> None:
    """Attack: send 1,200 request heads at a byte a second."""
    head = _request(server, "GET", "/scenes", f"X-Long: {'x' * 1000}")
    _crowd(server, [head] * 1200, seconds, bytes_a_second=1)


def slow_bodies(server: Served, seconds: float) -> None:
    """Attack: send 1,200 request bodies at a byte a second."""
    head = _request(server, "POST", "/sweeps", "Content-Length: 500000")
    _crowd(server, [head + b"x" * 1000] * 1200, seconds, at_once=len(head), bytes_a_second=1)


def slow_ends(server: Served, seconds: float) -> None:
    """Attack: send 70 kB of 1,200 request bodies, which the application begins with, then wait."""
    head = _request(server, "POST", "/sweeps", "Content-Length: 500000")
    begun = head + b"x" * 70_000
    _crowd(server, [begun + b"x" * 1000] * 1200, seconds, at_once=len(begun), bytes_a_second=1)


def deaf_slices(server: Served, seconds: float) -> None:
    """Attack: twice 200 clients request a slice of 10^6 values and read nothing."""
    path = _slice_of(server, LARGE, "beta,gamma")
    for _ in range(2):
        _crowd(server, [_request(server, "GET", path)] * 200, seconds / 2)


def deaf_downloads(server: Served, seconds: float) -> None:
    """Attack: 200 clients request a file of 100 MB and read nothing."""
    path = server.file_of(LARGE, 100 * MB)
    _crowd(server, [_request(server, "GET", path)] * 200, seconds)


def heads(server: Served, seconds: float) -> None:
    """Attack: HEAD of four uncomputed files of 340 MB, and GET of a small one."""
    studies = [varied(HUGE, frequency=50 + n) for n in range(4)]
    paths = [f"/sweeps/{server.post('/sweeps', study)['id']}/netcdf" for study in studies]
    small = _request(server, "GET", f"/sweeps/{server.post('/sweeps', SMALL)['id']}/netcdf")
    _crowd(server, [_request(server, "HEAD", path) for path in paths] + [small], seconds)


def long_cells(server: Served, seconds: float) -> None:
    """Attack: four small requests for cells that take hours; their jobs are dismissed at last."""
    _crowd(server, [_long_cell(server, n) for n in range(4)], seconds)
    _dismiss_all(server)


def long_jobs(server: Served, seconds: float) -> None:
    """Attack: four endless jobs, dismissed after half the time; a small job must then finish."""
    _dismissed(server, "simulate", [_long_study(n) for n in range(4)], seconds)


def many_jobs(server: Served, seconds: float) -> None:
    """Attack: six endless jobs that stay; a small job must finish beside them."""
    numbers = [server.post_job("simulate", _long_study(n)) for n in range(6)]
    _has_to_end(server, server.post_job("sweep", SMALL), seconds)
    for number in numbers:
        server.ask("DELETE", f"/jobs/{number}")


def accuracy_jobs(server: Served, seconds: float) -> None:
    """Attack: three accuracy jobs, dismissed while they run; a small job must then finish."""
    _dismissed(server, "accuracy", [varied(SMALL, frequency=50 + n) for n in range(3)], seconds)


def _dismissed(server: Served, process: str, studies: Sequence[Study], seconds: float) -> None:
    """Post jobs, and dismiss them after half of the time; a small one has to come through then."""
    numbers = [server.post_job(process, study) for study in studies]
    time.sleep(seconds / 2)
    for number in numbers:
        server.ask("DELETE", f"/jobs/{number}")
    _has_to_end(server, server.post_job("sweep", SMALL), seconds / 2)


def _slice_of(server: Served, study: Study, axes: str) -> str:
    """Return the path of a slice of a sweep over axes, with what else is asked."""
    key = server.post("/sweeps", study)["id"]
    return f"/sweeps/{key}/slice?output=acceleration_x&axes={axes}"


def _posts(server: Served, path: str, contents: Sequence[object], seconds: float) -> None:
    """Post bodies at once, repeating when all are answered; stop when the time is up."""
    bodies = [json.dumps(content).encode() for content in contents]
    requests = [
        _request(server, "POST", path, "Content-Type: application/json", f"Content-Length: {n}")
        + body
        for body in bodies
        for n in [len(body)]
    ]
    _crowd_again(server, requests, seconds)


def convert_values(server: Served, seconds: float) -> None:
    """Attack: eight clients convert a study of 9,000 values (60 kB) to TOML."""
    values = [1e-4 + 1e-8 * n for n in range(9_000)]
    study = varied(SMALL, amplitude=values)
    _posts(server, "/convert?to=toml", [study] * 8, seconds)


def convert_headings(server: Served, seconds: float) -> None:
    """Attack: sixteen clients convert a recording whose heading is 20,000 spaces."""
    text = f"time{' ' * 20_000}[s],a [m/s^2]\n" + "".join(f"{n / 1000},0\n" for n in range(20))
    _posts(server, "/convert?to=toml", [_recorded(text)] * 16, seconds)


def convert_recordings(server: Served, seconds: float) -> None:
    """Attack: sixteen clients convert valid recordings of 20,000 rows."""
    rows = (
        f"{n / 2000:.4f},{30 * math.sin(0.157 * n):.3f},{10 * math.sin(0.157 * n):.3f}"
        for n in range(20_000)
    )
    text = "time [s],ax [m/s^2],az [m/s^2]\n" + "\n".join(rows) + "\n"
    _posts(server, "/convert?to=toml", [_recorded(text)] * 16, seconds)


def _recorded(text: str) -> dict[str, object]:
    """Return a study of motion with a recorded drive."""
    drive = {"data": text, "along": "ax", "normal": "az", "line_frequency": 50}
    motion = {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"]}
    return {**motion, "drive": drive, "parameters": {"friction": 0.3}}


def many_names(server: Served, seconds: float) -> None:
    """Attack: 64 clients request slices with 5,000 query names."""
    key = server.post("/sweeps", LARGE)["id"]
    names = "&".join(f"n{n}=1" for n in range(5_000))
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta&{names}"
    _ask_again(server, path, 64, seconds)


def short_motions(server: Served, seconds: float) -> None:
    """Attack: 64 clients post distinct motions that are answered at once."""
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
    """Attack: 64 clients request a small slice of a sweep with 100,000 values on a fixed axis."""
    values = [1e-4 + 1e-9 * n for n in range(60_000)]
    study = varied(SMALL, amplitude=values)
    _ask_again(server, _slice_of(server, study, "beta&amplitude=0.0001"), 64, seconds)


def waiting(server: Served, seconds: float) -> None:
    """Attack: 520 clients post a long study and wait for its job; all are dismissed at the end."""
    server.post_job("simulate", _long_study(0))
    body = json.dumps(_long_study(0)).encode()
    head = ("Prefer: respond-async, wait=60", f"Content-Length: {len(body)}")
    request = _request(server, "POST", "/processes/simulate/execution", *head) + body
    _crowd(server, [request] * 520, seconds)
    _dismiss_all(server)


def crumbs(server: Served, seconds: float) -> None:
    """Attack: 50 clients send bodies in one-byte chunks with extensions of 1,000 bytes."""
    head = _request(server, "POST", "/sweeps", "Transfer-Encoding: chunked")
    crumb = b"1;x=" + b"x" * 1_000 + b"\r\nx\r\n"
    _stream_again(server, head, crumb * 200, 50, seconds)


def plain_crumbs(server: Served, seconds: float) -> None:
    """Attack: 50 clients send bodies in one-byte chunks."""
    head = _request(server, "POST", "/sweeps", "Transfer-Encoding: chunked")
    _stream_again(server, head, b"1\r\nx\r\n" * 20_000, 50, seconds)


def short_sweeps(server: Served, seconds: float) -> None:
    """Attack: 64 clients post sweeps of 10^6 values that are answered at once."""
    sweeps = [varied(LARGE, frequency=50 + n) for n in range(64)]
    _posts(server, "/processes/sweep/execution", sweeps, seconds)


def short_sensitivities(server: Served, seconds: float) -> None:
    """Attack: 64 clients post sensitivity studies that are answered at once."""
    example = json.loads(json.dumps(PROCESSES["sensitivity"].example))
    studies = [{**example, "seed": n} for n in range(64)]
    _posts(server, "/processes/sensitivity/execution", studies, seconds)


def fixed_axis(server: Served, seconds: float) -> None:
    """Attack: 64 clients request a small slice of a sweep with 10^6 values on a fixed axis."""
    axis = {"start": 1e-4, "stop": 5e-4, "num": 1_000_000}
    study = varied(SMALL, amplitude=axis)
    _ask_again(server, _slice_of(server, study, "beta&amplitude=0.0001"), 64, seconds)


def netcdf_files(server: Served, seconds: float) -> None:
    """Attack: one owner requests six large files; a small one of another owner must finish."""
    keys = [server.post("/sweeps", varied(HUGE, frequency=50 + n))["id"] for n in range(6)]
    small = server.post("/sweeps", SMALL)["id"]
    with ThreadPoolExecutor(1) as other:
        waited = other.submit(_waited_for, server, f"/sweeps/{small}/netcdf", seconds)
        requests = [_request(server, "GET", f"/sweeps/{key}/netcdf") for key in keys]
        _crowd(server, requests, seconds)
        print(f"  another's small file came after {waited.result():.1f} s")


def _waited_for(server: Served, path: str, seconds: float) -> float:
    """Return the time until a path is answered to another client during an attack [s]."""
    time.sleep(1.0)
    started = time.monotonic()
    try:
        server.ask("GET", path, source=ELSEWHERE, timeout=seconds)
    except OSError:
        print(f"  MISSED another's small file had not come after {seconds:g} s")
    return time.monotonic() - started


def fast_samples(server: Served, seconds: float) -> None:
    """Attack: recordings with impossible rates and studies without outputs must not cause a 500."""
    recorded = _recorded("ax [m/s^2],az [m/s^2]\n" + "1,2\n" * 50)
    rates = [{**recorded, "drive": {**recorded["drive"], "sampling_rate": rate}} for rate in RATES]
    bare = {k: v for k, v in PROCESSES["sensitivity"].example.items() if k != "outputs"}
    for kind, study in [*(("simulate", one) for one in rates), ("sensitivity", bare)]:
        status = server.ask("POST", f"/processes/{kind}/execution", study).status
        if status >= 500:
            print(f"  MISSED {kind}: {status}")


RATES = (1e-300, 1e300, 5e-324, 0, -1, 1e-9)


# --- ten more, found by reading what a client controls in every route


def descriptions(server: Served, seconds: float) -> None:
    """Attack: 64 clients request the description of every process."""
    requests = [_request(server, "GET", f"/processes/{name}") for name in PROCESSES]
    _crowd_again(server, (requests * 11)[:64], seconds)


def documents(server: Served, seconds: float) -> None:
    """Attack: 64 clients request the OpenAPI document and the schema from the start.

    The document was made and written in the event loop.
    """
    requests = [_request(server, "GET", path) for path in ("/openapi.json", "/schema")]
    _crowd_again(server, requests * 32, seconds)


def many_headers(server: Served, seconds: float) -> None:
    """Attack: 100 clients send request heads of 15,000 lines."""
    head = _request(server, "GET", "/scenes", *["a:"] * 15_000)
    _crowd_again(server, [head] * 100, seconds)


def pipelined(server: Served, seconds: float) -> None:
    """Attack: 50 clients pipeline 1,000 requests at a time without reading replies."""
    _stream_again(server, b"", _request(server, "GET", "/scenes") * 1_000, 50, seconds)


def packed_slices(server: Served, seconds: float) -> None:
    """Attack: 32 clients request compressed slices of 10^6 values."""
    path = _slice_of(server, LARGE, "beta,gamma")
    _ask_again(server, path, 32, seconds, "Accept-Encoding: gzip")


def workbooks(server: Served, seconds: float) -> None:
    """Attack: 16 clients request slices of 100,000 rows as workbooks."""
    study = varied(LARGE, gamma={"start": 0, "stop": 9, "num": 100})
    _ask_again(server, _slice_of(server, study, "beta,gamma&format=xlsx"), 16, seconds)


def chunks(server: Served, seconds: float) -> None:
    """Attack: 64 clients read ever-different chunks of a sweep of 10^9 cells."""
    parameters = {
        **LARGE["parameters"],
        "amplitude": {"start": 1e-4, "stop": 5e-4, "num": 1000},
    }
    key = server.post("/sweeps", {**LARGE, "parameters": parameters})["id"]
    paths = [
        f"/sweeps/{key}/zarr/chunks={axis}:{length}/acceleration_x/c/{n % 7}/0/0"
        for n in range(512)
        for axis, length in [(("amplitude", "beta", "gamma")[n % 3], 10 + n)]
    ]
    for start in range(0, len(paths), 64):
        _crowd(server, [_request(server, "GET", one) for one in paths[start : start + 64]],
               seconds / 8, is_read=True)  # fmt: skip


def followers(server: Served, seconds: float) -> None:
    """Attack: 250 clients follow the events of one long job."""
    number = server.post_job("simulate", _long_study(0))
    _crowd(server, [_request(server, "GET", f"/jobs/{number}/events")] * 250, seconds)
    server.ask("DELETE", f"/jobs/{number}")


def lists(server: Served, seconds: float) -> None:
    """Attack: 64 clients list a thousand jobs at a time with all filters."""
    for n in range(90):
        study = varied(SMALL, frequency=50 + n % 9)
        server.ask("POST", "/processes/sweep/execution", study, Prefer="respond-async")
    query = "&".join(["status=successful", "processID=sweep"] * 20)
    path = f"/jobs?limit=1000&minDuration=0&datetime=2000-01-01T00:00:00Z/..&{query}"
    _ask_again(server, path, 64, seconds)


def unknown_names(server: Served, seconds: float) -> None:
    """Attack: 16 clients post studies with 40,000 unknown parameters."""
    study = {**SMALL, "parameters": {f"amplitude_along_{n}": 1 for n in range(11, 30_000)}}
    _posts(server, "/sweeps", [study] * 16, seconds)


def ranges(server: Served, seconds: float) -> None:
    """Attack: 64 clients request 1,000 ranges of a file of 100 MB, and single bytes."""
    path = server.file_of(LARGE, 100 * MB)
    many = "Range: bytes=" + ",".join(f"{n}-{n}" for n in range(1_000))
    requests = [
        _request(server, "GET", path, many),
        _request(server, "GET", path, "Range: bytes=5-5"),
    ]
    _crowd_again(server, requests * 32, seconds)


def _stream_again(server: Served, head: bytes, piece: bytes, clients: int, seconds: float) -> None:
    """Send a head, then one piece again and again, on many connections; reopen closed ones."""
    until = time.monotonic() + seconds

    def stream(_: int) -> None:
        """Send the head and the pieces on one connection until the time is up."""
        while time.monotonic() < until:
            with suppress(OSError), socket.create_connection(server.place, 5) as client:
                client.settimeout(1.0)
                client.sendall(head)
                while time.monotonic() < until:
                    client.sendall(piece)

    with ThreadPoolExecutor(clients) as threads:
        list(threads.map(stream, range(clients)))


def _ask_again(server: Served, path: str, clients: int, seconds: float, *headers: str) -> None:
    """Have so many clients ask for a path, again whenever all are answered."""
    _crowd_again(server, [_request(server, "GET", path, *headers)] * clients, seconds)


def _crowd_again(server: Served, requests: list[bytes], seconds: float) -> None:
    """Send requests on many connections, again and again, until the time is up."""
    until = time.monotonic() + seconds
    while (left := until - time.monotonic()) > 0:
        _crowd(server, requests, left, is_read=True)


def _long_study(n: int) -> dict[str, object]:
    """Return a study that takes long; `n` makes it unique."""
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
    """Return the bytes of a request for a long study."""
    body = json.dumps(_long_study(n)).encode()
    path = "/processes/simulate/execution"
    return _request(server, "POST", path, f"Content-Length: {len(body)}") + body


def _dismiss_all(server: Served) -> None:
    """Dismiss the jobs of the attacker that still wait or run: else they go on, as promised."""
    path = "/jobs?limit=1000&status=accepted&status=running"
    while (reply := server.ask("GET", path)).status == 429:  # its clients have not gone yet
        time.sleep(0.5)
    for job in json.loads(reply.body)["jobs"]:
        server.ask("DELETE", f"/jobs/{job['jobID']}")


def _has_to_end(server: Served, number: str, seconds: float) -> None:
    """Print how long a small job takes, and MISSED if it does not finish in time."""
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
    "slow_ends": (slow_ends, 20),
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
    "crumbs": (crumbs, 20),
    "plain_crumbs": (plain_crumbs, 20),
    "short_sweeps": (short_sweeps, 20),
    "short_sensitivities": (short_sensitivities, 20),
    "fixed_axis": (fixed_axis, 20),
    "netcdf_files": (netcdf_files, 60),
    "fast_samples": (fast_samples, 5),
    "descriptions": (descriptions, 20),
    "documents": (documents, 20),
    "many_headers": (many_headers, 20),
    "pipelined": (pipelined, 20),
    "packed_slices": (packed_slices, 20),
    "workbooks": (workbooks, 30),
    "chunks": (chunks, 24),
    "followers": (followers, 20),
    "lists": (lists, 20),
    "unknown_names": (unknown_names, 20),
    "ranges": (ranges, 20),
}
"""Every attack, and how long it lasts [s]."""


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
