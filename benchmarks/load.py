"""Many clients at once: errors, times, and whether the service stays alive and keeps its size.

`python -m benchmarks.load` starts a server with a job that runs all the while, and lets 200 clients
loose on it for two minutes: slices, small sweeps, looks at the job, downloads of 100 MB. A process
of its own asks /healthz every 20 ms. Bars: no status but 2xx, 429 and 503; /healthz within 50 ms at
the 99th percentile; no growth of memory from the first minute to the second.

Clients, the probe, the job's workers and the server share the machine's cores: what is measured is
the service of a saturated machine.
"""

from __future__ import annotations

import asyncio
import http.client
import multiprocessing
import os
import random
import time
import urllib.parse
from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection

import aiohttp

from benchmarks.options import options
from benchmarks.serving import Served, percentile, served

CLIENTS, SECONDS = 200, 120.0
DOWNLOADS = 4  # of the clients; they take what the network stack gives
EVERY = 0.02  # s between two looks at /healthz
MAX_HEALTH = 0.050  # s, at the 99th percentile
MAX_MEMORY = 600_000_000  # bytes of the server, its workers not counted
MAX_GROWTH = 1.05  # from the first half to the second: what an allocator's leftovers may be
PLANE = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"]}
ANGLES = {"start": 0, "stop": 90, "num": 100}
GRID = {"frequency": 50, "amplitude": [0.0005, 0.001], "alpha": 5, "friction": 0.3}
SLICED = {**PLANE, "parameters": {**GRID, "beta": ANGLES, "gamma": {**ANGLES, "stop": 20}}}
MOVED = {  # 2 10^7 points, the most that are taken, of bouncing parts: longer than any run here
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.05 mm", "stop": "0.75 mm", "num": 400},
        "beta": {"start": 5, "stop": 60, "num": 500},
        "friction": {"start": 0.1, "stop": 0.6, "num": 100},
        "gamma": 2,
        "restitution": 0.5,
    },
}


@dataclass
class Taken:
    """What the clients met."""

    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    statuses: Counter[str] = field(default_factory=Counter)
    bytes: int = 0


class Crowd:
    """The clients, all in one event loop."""

    def __init__(self, server: Served, job: str, sweep: str, file: str):
        self._address, self._job, self._sweep, self._file = server.address, job, sweep, file
        self.taken = Taken()
        self._number = 0

    async def run(self, clients: int, seconds: float) -> None:
        """Let clients send requests until the time is over."""
        until = time.monotonic() + seconds
        connector = aiohttp.TCPConnector(limit=0)
        whole = aiohttp.ClientTimeout(total=300)
        async with aiohttp.ClientSession(
            self._address, connector=connector, timeout=whole
        ) as session:
            await asyncio.gather(
                *(self._client(session, number, until) for number in range(clients))
            )

    async def _client(self, session: aiohttp.ClientSession, number: int, until: float) -> None:
        """Send requests of random kinds until the time is over."""
        chance = random.Random(number)
        while time.monotonic() < until:
            if number < DOWNLOADS:
                await self._ask(session, "download", "GET", self._file)
                continue
            kind = chance.choices(("slice", "sweep", "poll"), (5, 2, 3))[0]
            if kind == "slice":
                form = chance.choice(("json", "binary"))
                query = f"output=acceleration_x&axes=gamma,beta&amplitude=0.001&format={form}"
                await self._ask(session, kind, "GET", f"/sweeps/{self._sweep}/slice?{query}")
            elif kind == "poll":
                await self._ask(session, kind, "GET", f"/jobs/{self._job}")
            else:
                await self._new_sweep(session)

    async def _new_sweep(self, session: aiohttp.ClientSession) -> None:
        """Post a new sweep and request a slice of it."""
        self._number += 1
        parameters = {**GRID, "frequency": 20 + self._number * 1e-4, "beta": ANGLES}
        study = {**PLANE, "parameters": parameters}
        key = await self._ask(session, "post", "POST", "/sweeps", study)
        if key:
            query = "output=acceleration_x&axes=beta&amplitude=0.001&format=binary"
            await self._ask(session, "new slice", "GET", f"/sweeps/{key}/slice?{query}")

    async def _ask(
        self, session: aiohttp.ClientSession, kind: str, method: str, path: str, body: object = None
    ) -> str | None:
        """Send a request and record its time and status; return the identifier in its reply."""
        started = time.monotonic()
        try:
            async with session.request(method, path, json=body) as reply:
                async for piece in reply.content.iter_chunked(1 << 20):
                    self.taken.bytes += len(piece)
                status, location = str(reply.status), reply.headers.get("Location", "")
                retry = reply.headers.get("Retry-After")
        except (aiohttp.ClientError, TimeoutError) as error:
            self.taken.statuses[f"{kind}: {type(error).__name__}"] += 1
            return None
        if status in ("429", "503") and retry:
            self.taken.statuses[f"{status} with Retry-After"] += 1
            await asyncio.sleep(float(retry))
            return None
        if not status.startswith("2"):
            self.taken.statuses[f"{kind}: {status}"] += 1
            return None
        self.taken.seconds[kind].append(time.monotonic() - started)
        return location.rpartition("/")[2] or None


def probe(address: str, seconds: float, sending: Connection) -> None:
    """Request /healthz every 20 ms on one connection, and send the times."""
    netloc = urllib.parse.urlsplit(address).netloc
    connection = http.client.HTTPConnection(netloc, timeout=60)
    times = []
    due = time.monotonic()
    until = due + seconds
    while due < until:
        # One that was late is not made up for: the next is due 20 ms after it.
        time.sleep(max(0.0, due - time.monotonic()))
        started = time.monotonic()
        connection.request("GET", "/healthz")
        reply = connection.getresponse()
        reply.read()
        times.append(time.monotonic() - started if reply.status == 200 else float("inf"))
        due = max(due, started) + EVERY
    sending.send(times)


async def loaded(server: Served, crowd: Crowd, clients: int, seconds: float) -> list[int]:
    """Run the clients; return the server's memory at start, half time and end."""
    sizes = [server.memory()]
    running = asyncio.create_task(crowd.run(clients, seconds))
    for _ in range(2):
        # The largest of some looks: one of them may fall between two replies.
        await asyncio.sleep(seconds / 2 - 5)
        looks = []
        for _ in range(50):
            looks.append(server.memory())
            await asyncio.sleep(0.1)
        sizes.append(max(looks))
    await running
    return sizes


def measure(
    clients: int,
    seconds: float,
    tell: Callable[[str], object],
    most_health: float = MAX_HEALTH,
) -> list[str]:
    """Load a server and print measurements; return those that miss their bar."""
    with served() as server:
        sweep = server.post("/sweeps", SLICED)["id"]
        file = server.file_of(SLICED, 100_000_000)
        job = server.post("/processes/simulate/execution", MOVED, Prefer="respond-async")["jobID"]
        while server.get(f"/jobs/{job}")["cellsDone"] == 0:
            time.sleep(0.2)
        receiving, sending = multiprocessing.Pipe(duplex=False)
        process = multiprocessing.get_context("spawn").Process(
            target=probe, args=(server.address, seconds, sending)
        )
        process.start()
        crowd = Crowd(server, job, sweep, file)
        sizes = asyncio.run(loaded(server, crowd, clients, seconds))
        health = receiving.recv()
        process.join()
        state = server.get(f"/jobs/{job}")
        taken = crowd.taken
    tell(f"{clients} clients, {seconds:g} s, {os.cpu_count()} cores for all; the job: "
         f"{state['status']}, {state['cellsDone']:,} cells")  # fmt: skip
    for kind, times in sorted(taken.seconds.items()):
        tell(line(kind, times, seconds))
    most = percentile(health, 0.99)
    tell(line("/healthz", health, seconds) + f"   max {1e3 * max(health):.1f} ms")
    tell(f"received {taken.bytes / 1e6 / seconds:,.0f} MB/s")
    tell("memory " + ", ".join(f"{size / 1e6:.0f} MB" for size in sizes) + " (start, half, end)")
    tell(f"errors {dict(taken.statuses) or 'none'}")
    missed = [f"errors: {name}" for name in taken.statuses if "Retry-After" not in name]
    if most > most_health:
        missed.append(f"/healthz: {1e3 * most:.0f} ms at the 99th percentile")
    if max(sizes) > MAX_MEMORY:
        missed.append(f"memory: {max(sizes) / 1e6:.0f} MB")
    # In the first seconds threads and caches still get their first memory.
    if seconds >= 60 and sizes[2] > MAX_GROWTH * sizes[1]:
        missed.append(f"memory grows from {sizes[1] / 1e6:.0f} to {sizes[2] / 1e6:.0f} MB")
    if state["status"] != "running":
        missed.append(f"the job was {state['status']} and no load any more")
    return missed


def line(kind: str, times: list[float], seconds: float) -> str:
    """Return a text with count and times of a kind of request."""
    half, most = (1e3 * percentile(times, share) for share in (0.5, 0.99))
    rate = len(times) / seconds
    return f"{kind:10} {len(times):7,} {rate:7.1f}/s   p50 {half:8.1f} ms   p99 {most:8.1f} ms"


def main() -> None:
    """Print all measurements; exit with 1 if one misses its bar."""
    wanted = options(__doc__, clients=CLIENTS, seconds=SECONDS)
    missed = measure(wanted.clients, wanted.seconds, print)
    for what in missed:
        print("MISSED", what)
    raise SystemExit(bool(missed))


if __name__ == "__main__":
    main()
