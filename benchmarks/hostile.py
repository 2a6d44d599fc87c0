"""Clients that mean harm, for tests/night/test_hostile.py: their cost for all others.

`suffered` carries out an attack against a fresh server. Meanwhile a process of its own asks
/healthz and for a small slice, again and again, each time on a new connection, and from another
address of this machine: it is another owner. Slow clients are the proxy's
(tests/service/test_operations_page.py); these ask for what is dear. `python -m benchmarks.hostile`
prints the effects of all attacks, or of those that it names.
"""

from __future__ import annotations

import copy
import http.client
import itertools
import math
import multiprocessing
import sqlite3
import threading
import time
import tomllib
import uuid
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import psutil

from benchmarks.options import options
from benchmarks.serving import Served, served

ROOT = Path(__file__).parents[1]
CLIENTS = 16
JOBS = 100_000  # in the ledger: what one owner may keep
ROWS = 20_000  # of a recording: as many as are taken
REST = 10.0  # s after an attack, until the memory is looked at again
STILL, LOOK = 5.0, 3.0  # s from then on, until it is looked whether somebody still works, and for
ELSEWHERE = "127.0.0.2"  # where another owner asks from: without keys an address is one
ASYNC = {"Prefer": "respond-async"}
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
Attack = Callable[[Served, float], None]
Request = tuple[str, str, Any, dict[str, Any]]
"""Method, path, content and headers."""


def _ask_again_and_again(server: Served, requests: Iterator[Request], seconds: float) -> None:
    """Let clients send requests, each the next one as soon as it is answered."""
    until, lock = time.monotonic() + seconds, threading.Lock()

    def ask() -> None:
        while time.monotonic() < until:
            with lock:
                method, path, content, headers = next(requests)
            with suppress(OSError, http.client.HTTPException):
                server.ask(method, path, content, **headers)

    with ThreadPoolExecutor(CLIENTS) as threads:
        for one in [threads.submit(ask) for _ in range(CLIENTS)]:
            one.result()


def _executions(
    study: dict[str, Any], varied: str, process: str = "", path: str = ""
) -> Iterator[Request]:
    """Yield posts of a study, each with another value of a parameter, in turn now and as jobs."""
    path = path or f"/processes/{process or study['kind']}/execution"
    for number in itertools.count():
        posted = copy.deepcopy(study)
        posted["parameters"][varied] *= 1 + 1e-6 * number
        yield "POST", path, posted, ASYNC if number % 2 else {}


def _configured(name: str, **parameters: Any) -> dict[str, Any]:
    """Return a study of configs/ with other values of some parameters."""
    study = tomllib.loads((ROOT / "configs" / f"{name}.toml").read_text(encoding="utf-8"))
    study["parameters"].update(parameters)
    return study


def async_recordings(server: Served, seconds: float) -> None:
    """Attack: jobs of recordings of 20,000 rows, which are fitted before the job is accepted."""
    lines = [f"{n * 1e-4:.4f},{math.sin(n * 0.0314):.4f}" for n in range(ROWS)]
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "drive": {"data": "\n".join(["time [s],ax [g]", *lines]), "along": "ax"},
        "parameters": {"friction": 0.3, "drive_factor": 1.0},
    }
    path = "/processes/simulate/execution"
    requests = (
        ("POST", path, content, ASYNC) for _, _, content, _ in _executions(study, "drive_factor")
    )
    _ask_again_and_again(server, requests, seconds)


def many_jobs(server: Served, seconds: float) -> None:
    """Attack: ask for the list of 100,000 jobs, by state and time."""
    server.post_job("sweep", SMALL)
    with closing(sqlite3.connect(server.data / "jobs.sqlite3", timeout=60)) as ledger:
        names = [row[1] for row in ledger.execute("PRAGMA table_info(jobs)")]
        first = dict(zip(names, ledger.execute("SELECT * FROM jobs").fetchone(), strict=True))
        rows = [
            {**first, "id": str(uuid.uuid4()), "created": first["created"] - n} for n in range(JOBS)
        ]
        marks = ", ".join(f":{name}" for name in names)
        ledger.executemany(f"INSERT INTO jobs VALUES ({marks})", rows)
        ledger.commit()
    path = "/jobs?limit=1000&minDuration=0&processID=sweep&datetime=2000-01-01T00:00:00Z/.."
    _ask_again_and_again(server, itertools.repeat(("GET", path, None, {})), seconds)


def large_slices(server: Served, seconds: float) -> None:
    """Attack: ask for slices of 10^6 values in every form."""
    key = server.post("/sweeps", LARGE)["id"]
    path = f"/sweeps/{key}/slice?output=acceleration_x&axes=beta,gamma&format="
    forms = itertools.cycle(("json", "binary", "csv", "parquet"))
    _ask_again_and_again(server, (("GET", path + form, None, {}) for form in forms), seconds)


def posted(study: dict[str, Any], varied: str, process: str = "", path: str = "") -> Attack:
    """Return the attack that posts a study again and again."""
    return lambda server, seconds: _ask_again_and_again(
        server, _executions(study, varied, process, path), seconds
    )


ROW = _configured("row", frequency=50.0, amplitude={"start": 1e-4, "stop": 4e-4, "num": 200})
ROW.pop("trajectory")  # of one point only
ATTACKS: dict[str, Attack] = {
    "async_recordings": async_recordings,
    "many_jobs": many_jobs,
    "large_slices": large_slices,
    "rows": posted(ROW, "frequency"),
    "drive_units": posted(_configured("linear-drive-unit", moving_mass=10.0), "moving_mass"),
    "lines": posted(_configured("orienting-line", arrival_rate=5.0), "arrival_rate"),
    "resting": posted(_configured("resting-part", diameter=0.02), "diameter"),
    "calibrate": posted(_configured("calibrate-friction", frequency=50.0), "frequency"),
    "reports": posted(_configured("track-motion", frequency=50.0), "frequency", "accuracy"),
    "tumbling": posted(_configured("tumbling", length=0.02), "length"),
    "robust_optima": posted(_configured("optimise-robust", frequency=50.0), "frequency"),
    "fronts": posted(_configured("optimise-pareto", frequency=60.0), "frequency"),
    "row_sheets": posted(ROW, "frequency", path="/convert?to=python"),
    "drive_unit_sweeps": posted(
        _configured("linear-drive-unit", moving_mass=10.0), "moving_mass", path="/sweeps"
    ),
    "report_pictures": posted(
        _configured("track-motion", frequency=50.0, alpha=[0, 1, 2, 3, 4]), "frequency", "accuracy"
    ),
}


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
    with served(workers=2) as server:
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


def main() -> None:
    """Print what the attacks do to others."""
    wanted = options(__doc__, *ATTACKS, seconds=14.0)
    for name in wanted.names or ATTACKS:
        found = suffered(ATTACKS[name], wanted.seconds)
        health, small = found["health"], found["small"]
        memory = [f"{found[when] / 1e6:.0f} MB" for when in ("peak", "after")]
        print(f"{name:18} /healthz silent {health:6.2f} s, another's slice {small:6.2f} s")
        print(f"{'':18} memory {' then '.join(memory)}, {found['busy']:.1f} cores busy", flush=True)


if __name__ == "__main__":
    main()
