"""What a sweep of 10^12 cells takes: its price, a hundredth of it measured, in shares, one killed.

    python -m benchmarks.large_sweep [--cells 1e10] [--shares 16] [--whole 1e12] [--only-shares]

The largest speed of a part on the narrow track for each drive, over five other axes: the drive has
two axes, which stay. In order:

- `vibrafeed run --dry-run` of the whole, its hundredth and a thousandth, and what they cost;
- the thousandth and the hundredth at once, on all cores;
- the hundredth in shares, a process with a core of its own for each at a time. One is killed by
  SIGKILL half way; a run without `--share` says which is missing, and it is computed again;
- whether both results have the same values, to the bit;
- the whole, by some of 2,048 shares of it, drawn at random and computed on all cores: what a cell
  takes hangs on the lengths of axes. Its error is twice that of their mean.
"""

from __future__ import annotations

import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from benchmarks.options import options
from benchmarks.reduce import prepared, study
from benchmarks.timing import timed
from vibrafeed.core.reduce.run import cores

COMMAND = [sys.executable, "-c", "from vibrafeed.app.cli import main; main()"]
ASKED = {"statistics": ["max"]}
SHARES, SAMPLE = 2048, 12


@dataclass(frozen=True)
class Sweep:
    """A study in a file, and where its result goes."""

    folder: Path
    name: str
    cells: float

    @property
    def file(self) -> Path:
        """The study, written at the first call."""
        path = self.folder / f"{self.name}.json"
        if not path.exists():
            path.write_text(json.dumps(study(self.cells, ASKED)))
        return path

    @property
    def result(self) -> Path:
        """The result."""
        return self.folder / f"{self.name}.nc"


def command(*words: object, **how: Any) -> subprocess.CompletedProcess[str]:
    """Carry out `vibrafeed` and return what it said."""
    given = [*COMMAND, *map(str, words)]
    return subprocess.run(given, capture_output=True, text=True, check=False, **how)


def price(sweep: Sweep) -> tuple[int, float]:
    """Print the price of a sweep; return its cells, and its seconds as they are predicted."""
    started = time.perf_counter()
    told = command("run", sweep.file, "--dry-run", "--json")
    took = time.perf_counter() - started
    plan = json.loads(told.stdout)["plans"][0]
    cells, seconds = int(plan["cells"]), float(plan["seconds"])
    size = f"{plan['bytes']:,} bytes"
    print(f"price of {cells:,} cells: {seconds:,.1f} s, {size}; said in {took:.1f} s", flush=True)
    return cells, seconds


def processor() -> float:
    """Return the seconds of the processor of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def at_once(sweep: Sweep, cells: int, predicted: float) -> None:
    """Print what a sweep takes on all cores."""
    started, before = time.perf_counter(), processor()
    command("run", sweep.file, "-o", sweep.result, "--quiet").check_returncode()
    took, worked = time.perf_counter() - started, processor() - before
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(
        f"at once: {cells:,} cells in {took:.1f} s, {took / cells * 1e9:.2f} ns a cell, "
        f"{predicted / took:.2f} of it predicted; {worked:.1f} s of the processor; "
        f"{memory:.0f} MiB at most",
        flush=True,
    )


def extrapolated(sweep: Sweep) -> None:
    """Print what the whole takes, by some random shares of it."""
    whole = prepared(study(sweep.cells, ASKED))
    shares = whole.shares(str(sweep.folder / "whole.nc"), SHARES)
    chosen = np.random.default_rng(36).choice(SHARES, SAMPLE + 1, replace=False)
    seconds = [timed(shares.compute, int(share))[1] for share in chosen]
    del seconds[0]  # which may compile
    hours, error = (
        value * SHARES / 3600
        for value in (statistics.mean(seconds), 2 * statistics.stdev(seconds) / math.sqrt(SAMPLE))
    )
    pace = statistics.mean(seconds) * SHARES / whole.cells * 1e9
    print(
        f"{whole.cells:,} cells, by {SAMPLE} of {SHARES:,} shares of {min(seconds):.2f} to "
        f"{max(seconds):.2f} s: {pace:.2f} ns each, {hours:.2f} h within {error:.2f} h"
    )


class Shares:
    """Computes the shares of a sweep, one on each core at a time."""

    def __init__(self, sweep: Sweep, count: int):
        self.sweep, self.count = sweep, count
        self.result = sweep.folder / "shares.nc"
        self.seconds: dict[int, float] = {}
        self._cores = deque(sorted(os.sched_getaffinity(0)))

    def compute(self, share: int, kill_after: float | None = None) -> None:
        """Compute a share in a process; kill that after some seconds if they are given."""
        core = self._cores.popleft()
        which = f"{share}/{self.count}"
        words = ["run", self.sweep.file, "--share", which, "-o", self.result, "-q"]
        started = time.perf_counter()
        process = subprocess.Popen(
            [*COMMAND, *map(str, words)], preexec_fn=lambda: os.sched_setaffinity(0, {core})
        )
        try:
            process.wait(kill_after)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            print(f"share {share}: killed after {kill_after:.1f} s", flush=True)
        else:
            if process.returncode == 0:
                self.seconds[share] = time.perf_counter() - started
        self._cores.append(core)

    def run(self) -> float:
        """Compute all shares, one of which is killed and computed again; return the seconds."""
        started = time.perf_counter()
        self.compute(0)
        with ThreadPoolExecutor(cores()) as pool:
            half = self.seconds[0] / 2
            killed = self.count // 2
            for share in range(1, self.count):
                pool.submit(self.compute, share, half if share == killed else None)
        said = command("run", self.sweep.file, "-o", self.result)
        print(f"join: {' '.join((said.stdout + said.stderr).split())}", flush=True)
        for share in set(range(self.count)) - set(self.seconds):
            self.compute(share)
        joining = time.perf_counter()
        command("run", self.sweep.file, "-o", self.result).check_returncode()
        print(f"joined in {time.perf_counter() - joining:.1f} s", flush=True)
        return time.perf_counter() - started


def same_values(one: Path, other: Path) -> bool:
    """True if two results have the same values to the bit."""
    with xarray.open_dataset(one) as first, xarray.open_dataset(other) as second:
        return all(
            np.asarray(first[name]).tobytes() == np.asarray(second[name]).tobytes()
            for name in first.variables
        )


def main() -> None:
    """Print the figures."""
    asked = options(__doc__, cells=1e10, shares=16, whole=1e12, only_shares=False)
    with tempfile.TemporaryDirectory() as path:
        folder = Path(path)
        whole, part = Sweep(folder, "whole", asked.whole), Sweep(folder, "part", asked.cells)
        small = Sweep(folder, "small", asked.cells / 10)
        price(whole)
        cells, predicted = price(part)
        if not asked.only_shares:
            at_once(small, *price(small))
            at_once(part, cells, predicted)
        shares = Shares(part, asked.shares)
        before = processor()
        took, worked = shares.run(), processor() - before
        each = list(shares.seconds.values())
        print(
            f"in {asked.shares} shares, one killed: {took:.1f} s, {took / cells * 1e9:.2f} ns "
            f"a cell; {worked:.1f} s of the processor; a part {min(each):.1f} to {max(each):.1f} s"
        )
        if not asked.only_shares:
            print(f"same values: {same_values(part.result, shares.result)}")
        extrapolated(whole)


if __name__ == "__main__":
    main()
