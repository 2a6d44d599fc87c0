"""Many clients at once, as an office has them: times, requests a second, memory.

`python -m benchmarks.load` lets 50 clients loose on a server for ten minutes: slices, bare
requests, short simulations, looks at jobs, NetCDF files, optima, jobs. `--tree` names other source
trees whose servers are loaded in the same run, in turn with this one, a minute each, so that all
meet the same machine. Bars: no status but 2xx, 429 and 503; no growth of memory after the third
minute.
"""

from __future__ import annotations

import asyncio
import random
import time
from collections import Counter, defaultdict
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import aiohttp

from benchmarks.options import options
from benchmarks.serving import Served, percentile, served

CLIENTS, SECONDS = 50, 600.0
PIECE = 60.0  # s that one server is loaded before the next one
EARLY = 180.0  # s after which memory is first looked at
MAX_GROWTH = 1.05  # of memory from then to the end
KINDS = {
    "slice": 40,
    "bare": 25,
    "simulation": 10,
    "look": 8,
    "netcdf": 8,
    "optimum": 6,
    "job": 3,
}  # % of the requests
PLANE = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"]}
ANGLES = {"start": 0, "stop": 90, "num": 100}
GRID = {"frequency": 50, "amplitude": [0.0005, 0.001], "alpha": 5, "friction": 0.3}
SLICED = {**PLANE, "parameters": {**GRID, "beta": ANGLES, "gamma": {**ANGLES, "stop": 20}}}
CUT = "output=acceleration_x&axes=gamma,beta&amplitude=0.001"  # 10^4 values


@dataclass
class Taken:
    """Times, failures and memory of the clients of one server."""

    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    failures: Counter[str] = field(default_factory=Counter)
    memory: list[tuple[float, int]] = field(default_factory=list)  # after so many seconds of load


class Crowd:
    """The clients of one server, all in one event loop."""

    def __init__(self, server: Served):
        self.server, self.taken, self.loaded = server, Taken(), 0.0
        self._sweep = server.post("/sweeps", SLICED)["id"]
        self._job = server.post_job("sweep", SLICED)
        self._number = 0

    async def run(self, clients: int, seconds: float) -> None:
        """Let clients send requests for some time."""
        until = time.monotonic() + seconds
        connector, whole = aiohttp.TCPConnector(limit=0), aiohttp.ClientTimeout(total=300)
        async with aiohttp.ClientSession(
            self.server.address, connector=connector, timeout=whole
        ) as session:
            await asyncio.gather(*(self._client(session, n, until) for n in range(clients)))
        self.loaded += seconds
        self.taken.memory.append((self.loaded, self.server.memory()))

    async def _client(self, session: aiohttp.ClientSession, number: int, until: float) -> None:
        """Send requests of random kinds until the time is over."""
        chance = random.Random(f"{number} {self.loaded}")
        while time.monotonic() < until:
            kind = chance.choices(tuple(KINDS), tuple(KINDS.values()))[0]
            await self._ask(session, kind, *self._request(kind, chance))

    def _request(self, kind: str, chance: random.Random) -> tuple[str, str, Any, dict[str, str]]:
        """Return method, path, content and headers of a request of a kind."""
        self._number += 1
        hertz = 20 + self._number * 1e-4
        match kind:
            case "slice":
                form = chance.choice(("json", "binary"))
                return "GET", f"/sweeps/{self._sweep}/slice?{CUT}&format={form}", None, {}
            case "bare":
                path = chance.choice(("/healthz", "/scenes", "/processes", "/jobs"))
                return "GET", path, None, {}
            case "look":
                return "GET", f"/jobs/{self._job}", None, {}
            case "netcdf":
                return "GET", f"/sweeps/{self._sweep}/netcdf", None, {}
            case "optimum":
                study = {
                    "kind": "optimise",
                    "scene": "rectangle-on-plane",
                    "outputs": ["flight_fraction"],
                    "criterion": {"kind": "maximise", "output": "conveying_velocity"},
                    "variables": {"beta": {"lower": "5 deg", "upper": "60 deg"}},
                    "parameters": {"frequency": hertz, "amplitude": 0.0005, "friction": 0.4},
                }
                return "POST", "/processes/optimise/execution", study, {}
            case _:
                amplitudes = (
                    0.0005 if kind == "simulation" else {"start": 2e-4, "stop": 8e-4, "num": 50}
                )
                parameters = {
                    "frequency": hertz,
                    "amplitude": amplitudes,
                    "beta": 25,
                    "friction": 0.3,
                }
                study = {
                    "kind": "simulate", "scene": "rectangle-on-plane",
                    "outputs": ["conveying_velocity"], "parameters": parameters,
                }  # fmt: skip
                headers = {"Prefer": "respond-async"} if kind == "job" else {}
                return "POST", "/processes/simulate/execution", study, headers

    async def _ask(
        self, session: aiohttp.ClientSession, kind: str, method: str, path: str, content: object,
        headers: dict[str, str],
    ) -> None:  # fmt: skip
        """Send a request, and record its time or its failure."""
        started = time.monotonic()
        try:
            async with session.request(method, path, json=content, headers=headers) as reply:
                await reply.read()
                status, retry = reply.status, reply.headers.get("Retry-After")
        except (aiohttp.ClientError, TimeoutError) as error:
            self.taken.failures[f"{kind}: {type(error).__name__}"] += 1
            return
        if 200 <= status < 300:
            self.taken.seconds[kind].append(time.monotonic() - started)
            return
        self.taken.failures[f"{kind}: {status}"] += 1
        if status in (429, 503) and retry:
            await asyncio.sleep(float(retry))


def measure(clients: int, seconds: float, trees: list[str]) -> list[str]:
    """Load a server of this tree and of others in turn; print figures, return missed bars."""
    with ExitStack() as stack:
        crowds = {
            tree or "this": Crowd(stack.enter_context(served(Path(tree) if tree else None)))
            for tree in ("", *trees)
        }
        while any(crowd.loaded < seconds for crowd in crowds.values()):
            for crowd in crowds.values():
                asyncio.run(crowd.run(clients, min(PIECE, seconds - crowd.loaded)))
        for name, crowd in crowds.items():
            _tell(name, crowd.taken, seconds)
        return _missed(crowds["this"].taken)


def _tell(name: str, taken: Taken, seconds: float) -> None:
    """Print the figures of a server."""
    count = sum(map(len, taken.seconds.values()))
    print(f"{name}: {count / seconds:.1f} requests a second")
    for kind in KINDS:
        times = taken.seconds[kind]
        half, most = (1e3 * percentile(times, share) for share in (0.5, 0.95))
        print(f"  {kind:10} {len(times):7,}   p50 {half:8.1f} ms   p95 {most:8.1f} ms")
    sizes = ", ".join(f"{size / 1e6:.0f} MB after {at:.0f} s" for at, size in taken.memory)
    print(f"  memory {sizes}\n  failures {dict(taken.failures) or 'none'}", flush=True)


def _missed(taken: Taken) -> list[str]:
    """Return the bars that a server misses."""
    missed = [name for name in taken.failures if name[-3:] not in ("429", "503")]
    early = [size for at, size in taken.memory if at <= EARLY]
    last = taken.memory[-1]
    if last[0] > EARLY and last[1] > MAX_GROWTH * early[-1]:
        missed.append(f"memory grows from {early[-1] / 1e6:.0f} to {last[1] / 1e6:.0f} MB")
    return missed


def main() -> None:
    """Print all figures; exit with 1 if this tree misses a bar."""
    wanted = options(__doc__, clients=CLIENTS, seconds=SECONDS, tree=[str])
    missed = measure(wanted.clients, wanted.seconds, wanted.tree)
    for what in missed:
        print("MISSED", what)
    raise SystemExit(bool(missed))


if __name__ == "__main__":
    main()
