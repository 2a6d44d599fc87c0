"""Clients that mean harm: what they cost the service, and what they cost everybody else.

`python -m benchmarks.hostile` carries out each attack of `benchmarks.attacks` against a fresh
server that may open 1,024 files; names of attacks as arguments choose some. Meanwhile a process of
its own asks /healthz and for a small slice, again and again, each time on a new connection, and
from another address of this machine: it is another owner. Printed are the longest silences of both
(from the first try to the right answer), the server's memory at its peak and 10 s after the attack,
the processor time that the attack cost, how busy the server and its workers are 15 s after it, and
the bytes it wrote into the log. Exits with 1 if a limit is missed.
"""

from __future__ import annotations

import http.client
import multiprocessing
import resource
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import psutil

from benchmarks.attacks import ATTACKS, ELSEWHERE, MB, SMALL
from benchmarks.options import options
from benchmarks.serving import Served, served

OPEN_FILES = 1024
REST = 10.0  # s after an attack, until the memory is looked at again
STILL, LOOK = 5.0, 3.0  # s from then on, until it is looked whether somebody still works, and for


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


# --- what others notice


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


def main() -> None:
    """Print the effects of each attack; exit with 1 if a limit is exceeded."""
    arguments = options(__doc__, *ATTACKS, shorter=(1.0, "divides the time of each"))
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    limits = Limits()
    print(
        f"at most: /healthz silent {limits.health:g} s, another's slice {limits.small:g} s, "
        f"peak {limits.peak / MB:g} MB, after {limits.after / MB:g} MB, {limits.busy:g} cores busy"
    )
    print(f"{'':19} /healthz  slice   peak  after  processor    log   busy")
    missed = False
    for name in arguments.names or ATTACKS:
        attack, seconds = ATTACKS[name]
        found = suffered(attack, seconds / arguments.shorter)
        print(
            f"{name:19} {found.health:6.2f} s {found.small:5.2f} s {found.peak / MB:5.0f} "
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
