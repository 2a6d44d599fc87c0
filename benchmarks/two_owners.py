"""What a small slice takes beside the load of another owner: `python -m benchmarks.two_owners`.

Without keys an address is an owner. One asks for a small slice again and again, each time on the same
connection; the other has nothing, or a job that keeps all workers busy and clients that post
motions, or read large slices, one after another. Quiet and load take turns, and what is told is the median
of a slice, quiet and loaded, and the median of the ratios of the pairs.
"""  # noqa: E501

from __future__ import annotations

import http.client
import itertools
import json
import multiprocessing
import os
import statistics
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress

from benchmarks.attacks import ELSEWHERE, LARGE, SMALL, varied
from benchmarks.load import MOVED
from benchmarks.options import options
from benchmarks.serving import Served, served

SECONDS = 3.0  # of each turn
BAR = 1.5
CLIENTS = 8
EVERY = 0.02  # s between two slices

Call = Callable[[int], tuple[str, str, bytes | None]]
"""From the number of a request to its method, path and body."""


def slices(server: Served, path: str, seconds: float) -> list[float]:
    """Return what small slices take [s]."""
    connection = http.client.HTTPConnection(
        *server.place, timeout=60, source_address=(ELSEWHERE, 0)
    )
    until, found = time.monotonic() + seconds, []
    while time.monotonic() < until:
        time.sleep(EVERY)
        started = time.monotonic()
        connection.request("GET", path)
        connection.getresponse().read()
        found.append(time.monotonic() - started)
    connection.close()
    return found


class Crowd:
    """Clients of the other owner, who ask one after another while the load is on.

    They are a process of their own, of low priority, as they would be another machine: what they
    read would else hold up the one who measures.
    """

    def __init__(self, server: Served, call: Call):
        self._server, self._call = server, call
        fork = multiprocessing.get_context("fork")  # a call may refer to anything
        self._on = fork.Event()
        self._process = fork.Process(target=self._ask_all, daemon=True)
        self._process.start()

    def turn(self, on: bool) -> None:
        """Begin to ask, or stop."""
        (self._on.set if on else self._on.clear)()

    def end(self) -> None:
        """End all clients."""
        self._process.terminate()
        self._process.join()

    def _ask_all(self) -> None:
        os.nice(19)
        numbers = itertools.count(1)
        threads = [threading.Thread(target=self._ask, args=(numbers,)) for _ in range(CLIENTS)]
        for thread in threads:
            thread.start()

    def _ask(self, numbers: Iterator[int]) -> None:
        while True:
            self._on.wait()
            method, path, body = self._call(next(numbers))
            connection = http.client.HTTPConnection(*self._server.place, timeout=60)
            with suppress(OSError, http.client.HTTPException):
                connection.request(method, path, body)
                connection.getresponse().read()
            connection.close()


def pairs(server: Served, small: str, call: Call, turns: int) -> tuple[list[float], list[float]]:
    """Return the medians of turns, quiet and beside the load of calls [s]."""
    crowd = Crowd(server, call)
    quiet, loaded = [], []
    try:
        for _ in range(turns):
            crowd.turn(on=False)
            time.sleep(1.0)
            quiet.append(statistics.median(slices(server, small, SECONDS)))
            crowd.turn(on=True)
            time.sleep(1.0)
            loaded.append(statistics.median(slices(server, small, SECONDS)))
    finally:
        crowd.end()
    return quiet, loaded


def main() -> None:
    """Print the table; exit with 1 if a load makes slices slower than the bar."""
    asked = options(__doc__, turns=4)
    missed = False
    with served(workers=2) as server:
        key = server.post("/sweeps", SMALL)["id"]
        small = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta"
        key = server.post("/sweeps", LARGE)["id"]
        large = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta,gamma&format=binary"
        motion = {
            "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
            "parameters": {
                "frequency": 50, "amplitude": {"start": 1e-4, "stop": 4e-4, "num": 40},
                "beta": {"start": 5, "stop": 60, "num": 40},
            },
        }  # fmt: skip

        def motions(number: int) -> tuple[str, str, bytes | None]:
            body = json.dumps(varied(motion, friction=0.3 + 1e-6 * number)).encode()
            return "POST", "/processes/simulate/execution", body

        loads: dict[str, Call] = {
            "large slices": lambda _: ("GET", large, None),
            "short motions": motions,
        }
        server.post("/processes/simulate/execution", varied(motion, friction=0.29))  # loads code
        slices(server, small, 2.0)
        for name, call in loads.items():
            missed |= _tell(name, *pairs(server, small, call, asked.turns))
        quiet = [statistics.median(slices(server, small, SECONDS)) for _ in range(asked.turns)]
        job = server.post("/processes/simulate/execution", MOVED, Prefer="respond-async")["jobID"]
        while server.get(f"/jobs/{job}")["cellsDone"] == 0:
            time.sleep(0.2)
        loaded = [statistics.median(slices(server, small, SECONDS)) for _ in range(asked.turns)]
        missed |= _tell("a job", quiet, loaded)
    raise SystemExit(missed)


def _tell(name: str, quiet: list[float], loaded: list[float]) -> bool:
    ratio = statistics.median(b / a for a, b in zip(quiet, loaded, strict=True))
    print(
        f"{name:14} quiet {1e3 * statistics.median(quiet):6.2f} ms, beside it "
        f"{1e3 * statistics.median(loaded):6.2f} ms: {ratio:.2f} times"
        f"{'' if ratio <= BAR else f'  MISSED: {BAR}'}",
        flush=True,
    )
    return ratio > BAR


if __name__ == "__main__":
    main()
