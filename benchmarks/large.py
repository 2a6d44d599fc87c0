"""What large sweeps cost, over an older tree, and over what a user would write with xarray.

    python -m benchmarks.large [--cells 1e9] [--stored 3e7] [--runs 3] [--older PATH]

Seven axes of the narrow track. In turns, each in a process of its own that has compiled before:

- the largest and the mean speed over two axes, and over five;
- the same with xarray in numpy blocks, over fewer cells and without regimes, which tell the cells
  that count;
- a sweep in memory, stored as NetCDF (zlib 1), and stored as Zarr;
- a slice of 10^5 values from a service, by the clock.

Each line has nanoseconds a cell, the least of the runs, by the clock and of the processor, which
other programs disturb less; and the ratio to the older tree, such as a clone of another commit.
"""

from __future__ import annotations

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from benchmarks.options import options
from benchmarks.service import Client
from benchmarks.serving import served
from benchmarks.timing import in_turns
from vibrafeed.core.intake import prepare_content

HERE = Path(__file__).parents[1]
SPEED = "transport_velocity"
SPANS = {
    "frequency": (20, 120),
    "amplitude": (2e-5, 2e-4),
    "alpha": (0, 60),
    "beta": (1, 30),
    "gamma": (0, 30),
    "friction": (0.1, 0.6),
    "distance": (1e-5, 1e-4),
}
RADIUS, GRAVITY = 0.8, 9.80665
TWO, FIVE = ("alpha", "beta"), ("alpha", "beta", "gamma", "friction", "distance")
PEER_CELLS = 30_000_000
"""Of xarray, which is slow."""
COMPILED, SLICES = 120, 200
"""Slices until the loop is compiled, and those that are measured."""

WORKER = """
import shutil, sys, time
from vibrafeed import sweep
try:
    from vibrafeed.app.cli import app
except ModuleNotFoundError:
    from app.cli import app
study, target, runs = sys.argv[1:]
for run in range(int(runs) + 1):
    clock, processor = time.perf_counter(), time.process_time()
    if target:
        app(["run", "-q", study, "-o", target], standalone_mode=False)
    else:
        sweep(study)
    took = time.perf_counter() - clock, time.process_time() - processor
    if run:
        print(*took)
    if target.endswith("zarr"):
        shutil.rmtree(target)
    elif target:
        __import__("os").remove(target)
"""
"""The command line as its users have it, and the result in memory; the first run compiles. Older
trees have their packages under other names."""


def study(cells: float, **more: Any) -> dict[str, Any]:
    """Return a sweep of about so many cells, with further keys."""
    left, axes = int(cells), {}
    for done, (name, (start, stop)) in enumerate(SPANS.items()):
        size = max(2, round(left ** (1 / (len(SPANS) - done))))
        left = -(-left // size)
        axes[name] = {"start": start, "stop": stop, "num": size}
    content = {"kind": "sweep", "scene": "rectangle-on-track", "outputs": [SPEED]}
    return {**content, "parameters": {**axes, "radius": f"{RADIUS} m"}, **more}


def reduced(cells: float, what: str, over: tuple[str, ...]) -> dict[str, Any]:
    """Return a sweep of which one statistic is asked."""
    return study(cells, reduce={"over": list(over), "statistics": [what]})


def by_xarray(content: dict[str, Any], what: str, over: tuple[str, ...]) -> xarray.DataArray:
    """Return a statistic of the speed as a user would write it, a block for each frequency."""
    grid = prepare_content(content).grid
    at = {name: xarray.DataArray(grid.coordinate(name), dims=name) for name in grid.axes}
    alpha, beta, gamma = (np.deg2rad(at[name]) for name in ("alpha", "beta", "gamma"))
    friction = at["friction"]
    decay = -np.expm1(-2 * friction * at["distance"] / RADIUS) * RADIUS / friction
    blocks = []
    for frequency in at["frequency"]:
        push = at["amplitude"] * (2 * np.pi * frequency) ** 2 * np.cos(beta)
        start = push * (np.cos(alpha) + friction * np.sin(alpha)) - GRAVITY * np.sin(gamma)
        speed = np.sqrt(start.clip(0) * decay)
        blocks.append(getattr(speed, what)(over))
    return xarray.concat(blocks, "frequency")


def peer(what: str, over: tuple[str, ...], runs: int) -> tuple[float, float]:
    """Return the least times of xarray, by the clock and of the processor [ns a cell]."""
    content, found = study(PEER_CELLS), []
    cells = prepare_content(content).cells
    for _ in range(runs):
        clock, processor = time.perf_counter(), time.process_time()
        by_xarray(content, what, over)
        found.append((time.perf_counter() - clock, time.process_time() - processor))
    return least(found, cells)


def least(found: list[tuple[float, float]], cells: int) -> tuple[float, float]:
    """Return the least of times [s] as nanoseconds a cell."""
    clock, processor = (min(one) * 1e9 / cells for one in zip(*found, strict=True))
    return clock, processor


def measured(tree: Path, file: Path, target: str, runs: int) -> list[tuple[float, float]]:
    """Return the times of runs of a study by the code of a tree [s]."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", WORKER, str(file), target, str(runs)],
        cwd=tree, env={**os.environ, "PYTHONPATH": str(tree)}, check=True, text=True,
        stdout=subprocess.PIPE,
    )  # fmt: skip
    lines = [line.split() for line in done.stdout.splitlines()]
    return [(float(clock), float(processor)) for clock, processor in lines]


def slices(trees: list[Path], pairs: int) -> list[float]:
    """Return the median times of a slice by services of several trees, asked in turns [s]."""
    content = study(1e12)
    path = f"output={SPEED}&axes=alpha,beta&" + "&".join(
        f"{name}={value['start']}" for name, value in content["parameters"].items()
        if name not in (*TWO, "radius")
    )  # fmt: skip
    for name, size in zip(TWO, (250, 400), strict=True):
        content["parameters"][name]["num"] = size
    with ExitStack() as stack:
        servers = [stack.enter_context(served(tree=tree)) for tree in trees]
        paths = [f"/sweeps/{one.post('/sweeps', content)['id']}/slice?{path}" for one in servers]
        asked = [
            partial(Client(one.place).ask, "GET", f"{where}&format=binary")
            for one, where in zip(servers, paths, strict=True)
        ]
        in_turns(COMPILED, *asked)
        return [statistics.median(times) for times in in_turns(pairs, *asked)]


def main() -> None:
    """Print all measurements."""
    asked = options(__doc__, cells=1e9, stored=3e7, runs=3, older=Path)
    print(f"{'':24} {'cells':>13}  ns a cell: clock, processor; older tree; ratios")
    with tempfile.TemporaryDirectory(prefix="large-") as name:
        folder = Path(name)
        ways = {
            f"{what} over {len(over)}": (reduced(asked.cells, what, over), "a.nc")
            for over in (TWO, FIVE)
            for what in ("max", "mean")
        }
        stored = study(asked.stored)
        ways |= {"in memory": (stored, ""), "NetCDF": (stored, "a.nc"), "Zarr": (stored, "a.zarr")}
        trees = [HERE] if asked.older is None else [HERE, asked.older.resolve()]
        for way, (content, result) in ways.items():
            file, cells = folder / "study.json", prepare_content(content).cells
            file.write_text(json.dumps(content))
            target = str(folder / result) if result else ""
            found: list[list[tuple[float, float]]] = [[] for _ in trees]
            for _ in range(asked.runs):
                for k, tree in enumerate(trees):
                    found[k] += measured(tree, file, target, 1)
                    shutil.rmtree(target, ignore_errors=True)
            times = [least(one, cells) for one in found]
            line = f"{way:24} {cells:13,}  {times[0][0]:7.2f} {times[0][1]:7.2f}"
            if len(times) > 1:
                ratios = [mine / old for mine, old in zip(*times, strict=True)]
                line += f"; {times[1][0]:7.2f} {times[1][1]:7.2f}; {ratios[0]:.2f} {ratios[1]:.2f}"
            if way in ("max over 2", "mean over 2"):
                clock, processor = peer(way.split()[0], TWO, asked.runs)
                line += f"; xarray {clock / times[0][0]:.0f} {processor / times[0][1]:.0f} times"
            print(line, flush=True)
        times = slices(trees, SLICES)
        ratio = f"; {times[1] * 1e3:.2f}; {times[0] / times[1]:.2f}" if len(times) > 1 else ""
        print(f"slice over HTTP, ms     {times[0] * 1e3:23.2f}{ratio}")


if __name__ == "__main__":
    main()
