"""An hour of mixed use: does the server keep its size? `python -m benchmarks.mixed_use`.

3,000 requests of all kinds, one after another at random times, to a fresh server: sweeps, slices in
every form, chunks, files, motions, sensitivities, optimisations as jobs that are waited for,
conversions, lists, descriptions, and studies that are wrong. Studies are mostly new ones. Printed
are statuses, the longest time of each kind of request, and the memory of the server itself in each
tenth. The cache of chunks is small, so that it is full by the second tenth: what it may hold is a
setting, no growth. Exits with 1 if a request fails or the memory of the last tenth is beyond that
of the second by more than an allocator's leftovers may be. `--minutes 6 --requests 300` is a tenth
of it.
"""

from __future__ import annotations

import json
import random
import time
from collections import Counter, defaultdict
from statistics import median
from typing import Any

from benchmarks.attacks import LARGE, SMALL, varied
from benchmarks.options import options
from benchmarks.serving import Served, served
from benchmarks.timing import timed
from vibrafeed.app.web.execution import PROCESSES

MAX_GROWTH = 1.05
CACHE = 4_000_000  # bytes of chunks that are kept; a tenth of the hour reads as many
TENTHS = 10
FORMS = ("json", "json", "binary", "csv", "parquet", "xlsx")
GRID = {"start": 0, "stop": 60, "num": 60}
MOTION: dict[str, Any] = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {"frequency": 50, "amplitude": 2e-4, "beta": {**GRID, "start": 5}},
}


class User:
    """Asks for one thing after another, as the program's users do."""

    def __init__(self, server: Served, seed: int):
        self._server, self._random = server, random.Random(seed)
        self._number = 0
        self.statuses: Counter[str] = Counter()
        self.longest: defaultdict[str, float] = defaultdict(float)
        self.failed: list[str] = []

    def ask_something(self) -> None:
        """Perform one random task, perhaps with several requests."""
        self._number += 1
        actions = {
            self._slices: 6, self._file: 1, self._chunks: 2, self._motion: 4, self._job: 1,
            self._example: 2, self._converted: 2, self._read: 3, self._wrong: 2,
        }  # fmt: skip
        [action] = self._random.choices(list(actions), list(actions.values()))
        action()

    def _new(self, study: dict[str, Any]) -> dict[str, Any]:
        """Return a unique variation of a study."""
        return varied(study, friction=0.2 + self._number * 1e-5)

    def _slices(self) -> None:
        """Post a sweep and request random slices."""
        study = varied(LARGE, beta=GRID, gamma={**GRID, "stop": 20})
        key = self._ask("sweep", "POST", "/sweeps", self._new(study)).get("id")
        for _ in range(self._random.randint(1, 6)):
            form, more = self._random.choice(FORMS), "axes=beta,gamma"
            if self._random.random() < 0.5:
                more = f"axes=beta&gamma={20 * self._random.randrange(60) / 59!r}"
            query = f"output=acceleration_x&{more}&format={form}"
            self._ask(f"slice as {form}", "GET", f"/sweeps/{key}/slice?{query}")

    def _file(self) -> None:
        """Post a sweep and download its file."""
        study = varied(LARGE, beta={**GRID, "num": 300}, gamma={**GRID, "num": 300, "stop": 20})
        key = self._ask("sweep", "POST", "/sweeps", self._new(study)).get("id")
        self._ask("file", "GET", f"/sweeps/{key}/netcdf")

    def _chunks(self) -> None:
        """Post a sweep and read random chunks."""
        key = self._ask("sweep", "POST", "/sweeps", self._new(LARGE)).get("id")
        self._ask("chunk", "GET", f"/sweeps/{key}/zarr/zarr.json")
        for _ in range(3):
            at = "/".join(str(self._random.randrange(3)) for _ in range(2))
            path = f"/sweeps/{key}/zarr/chunks=beta:100,gamma:100/acceleration_x/c/{at}"
            self._ask("chunk", "GET", path)

    def _motion(self) -> None:
        """Run a motion at once."""
        self._ask("motion", "POST", "/processes/simulate/execution", self._new(MOTION))

    def _job(self) -> None:
        """Run a motion as a job."""
        study = self._new({**MOTION, "outputs": ["conveying_velocity", "flight_fraction"]})
        headers = {"Prefer": "respond-async, wait=60"}
        self._ask("job", "POST", "/processes/simulate/execution", study, headers)

    def _example(self) -> None:
        """Run the example of a random process."""
        kind = self._random.choice([name for name in PROCESSES if name != "accuracy"])
        path = f"/processes/{kind}/execution"
        self._ask(kind, "POST", path, PROCESSES[kind].example, {"Prefer": "wait=60"})

    def _converted(self) -> None:
        """Convert a motion to a random format."""
        to = self._random.choice(["toml", "json", "curl", "python"])
        self._ask("conversion", "POST", f"/convert?to={to}", self._new(MOTION))

    def _read(self) -> None:
        """Read a random document."""
        paths = (
            "/", "/scenes", "/scenes/rectangle-on-track", "/schema", "/openapi.json", "/figures",
            "/jobs?limit=100", "/metrics", "/processes/simulate", "/friction?words=steel",
        )  # fmt: skip
        self._ask("reading", "GET", self._random.choice(paths))

    def _wrong(self) -> None:
        """Post a random invalid study."""
        wrong = self._random.choice(
            [{**SMALL, "outputs": ["speed"]}, varied(SMALL, bta=1), {"kind": "swep"}, [1, 2]]
        )
        self._ask("mistake", "POST", "/sweeps", wrong, right=422)

    def _ask(
        self,
        kind: str,
        method: str,
        path: str,
        content: object = None,
        headers: dict[str, str] | None = None,
        *,
        right: int | None = None,
    ) -> dict[str, Any]:
        """Send a request, record its outcome, and return its JSON reply."""
        reply, seconds = timed(
            self._server.ask, method, path, content, timeout=120, **(headers or {})
        )
        self.statuses[str(reply.status)] += 1
        self.longest[kind] = max(self.longest[kind], seconds)
        if reply.status != right if right else reply.status >= 300:
            self.failed.append(f"{kind}: {reply.status} {reply.body[:200]!r}")
        found = json.loads(reply.body) if reply.headers.get_content_subtype() == "json" else {}
        return found if isinstance(found, dict) else {}


def main() -> int:
    """Print how the server performed; return 1 if a request failed or memory grew."""
    arguments = options(__doc__, minutes=60.0, requests=3000, seed=1)
    pause = 60 * arguments.minutes / arguments.requests
    with served(zarr_cache_bytes=CACHE) as server:
        user, chance = User(server, arguments.seed), random.Random(arguments.seed)
        memory: list[list[int]] = [[] for _ in range(TENTHS)]
        due = time.monotonic()
        while (done := user.statuses.total()) < arguments.requests:
            user.ask_something()
            tenth = min(TENTHS - 1, TENTHS * done // arguments.requests)
            memory[tenth].append(server.memory())
            due += (user.statuses.total() - done) * chance.expovariate(1 / pause)
            time.sleep(max(0.0, due - time.monotonic()))
    for kind, seconds in sorted(user.longest.items()):
        print(f"{kind:18} longest {seconds:7.2f} s")
    print("statuses:", ", ".join(f"{count} of {name}" for name, count in user.statuses.items()))
    for line in user.failed[:20]:
        print("  FAILED", line)
    sizes = [median(some) for some in memory if some]
    print("memory in each tenth:", ", ".join(f"{size / 1e6:.0f}" for size in sizes), "MB")
    growth = sizes[-1] / sizes[1]
    print(f"from the second to the last: {growth:.3f} times; at most {MAX_GROWTH:g}")
    return int(bool(user.failed) or growth > MAX_GROWTH)


if __name__ == "__main__":
    raise SystemExit(main())
