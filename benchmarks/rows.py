"""What rows of parts take, in milliseconds; `python -m benchmarks.rows`.

Processor time of a cell on one core: rows of random friction from event to event, each for all of
100 periods, studies of them, which end where a row repeats, free and at a stop, and rows of one
friction beside a part alone. `--service 10000` has a server carry out so many rows of 10 parts in a
job, and dismisses the same job half done.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import vibrafeed
from benchmarks.options import options
from benchmarks.serving import served
from benchmarks.timing import least
from vibrafeed.core.motion.kernels.rows import path_of_row, path_of_waved_row
from vibrafeed.core.motion.kernels.rows.tables import NO_STOP, Head

DRIVE: dict[str, Any] = {"frequency": 50, "beta": 25, "outputs": ["conveying_velocity"]}
ROW: dict[str, Any] = {"scene": "row-on-plane", "friction": 0.4, "max_periods": 100}
MAX_AMPLITUDE = 6e-4  # m, a throw number of 2.5
LOOK = 0.2  # s between two looks at a job


def whole_rows(parts: int, rows: int, orders: int = 0) -> tuple[float, float]:
    """Return mean and largest processor time of random rows over 100 periods [ms].

    Under a sine, or under as many harmonics on both axes.
    """
    random, times = np.random.default_rng(parts), []
    end, places, gaps = np.array([200 * np.pi]), np.empty((1, parts)), np.empty((1, parts - 1))
    for _ in range(rows + 1):
        along, normal = random.uniform(0.5, 3.0), random.uniform(0.1, 2.5)
        friction, mass = random.uniform(0.2, 0.6, parts), random.uniform(0.5, 2.0, parts)
        head = Head(along, normal, 0.0, 1.0, 0.0, 100.0, NO_STOP, 0.0, parts, parts)
        cell = np.array([*head, *friction, *friction, *mass, *np.zeros(parts)])
        if orders:
            pushes = random.normal(size=(3, 2, orders)) / np.arange(1, orders + 1)
            pushes *= np.array([along, 0.0, normal]).reshape(3, 1, 1) / 2.0
            cell = np.array([*cell, orders, 0, *pushes.ravel()])
        follow = path_of_waved_row if orders else path_of_row
        once = partial(follow, cell, end, places, gaps)
        times.append(least(1, once, time.process_time) * 1e3)
    return float(np.mean(times[1:])), max(times[1:])


def milliseconds(study: Callable[[int], object], cells: int) -> float:
    """Return the processor time per cell beyond the first [ms]."""
    study(1)
    return least(1, partial(study, cells), time.process_time) / cells * 1e3


def of_rows(parts: int, **more: Any) -> Callable[[int], object]:
    """Return a function that makes studies of rows with random friction and drive."""

    def study(cells: int) -> object:
        """Run a study of so many rows."""
        amplitudes = np.random.default_rng(cells).uniform(1e-4, MAX_AMPLITUDE, 20)
        return vibrafeed.simulate(
            **ROW, **DRIVE, **more, parts=parts, friction_spread=0.08,
            amplitude=np.sort(amplitudes[: max(1, cells // 50)]),
            friction_seed=np.arange(min(cells, 50)),
        )  # fmt: skip

    return study


def over_http(cells: int) -> None:
    """Print how a server runs a study of rows as a job, and how it dismisses one."""
    study: dict[str, Any] = {
        "kind": "simulate", "scene": "row-on-plane", "max_periods": 100,
        "outputs": ["conveying_velocity", "platoons"],
        "parameters": {
            "frequency": 50, "beta": 25, "parts": 10, "friction": 0.4, "friction_spread": 0.08,
            "amplitude": {"start": 1e-4, "stop": MAX_AMPLITUDE, "num": cells // 100},
            "friction_seed": {"start": 0, "stop": 99, "num": 100},
        },
    }  # fmt: skip
    with served() as server:
        job, seen = server.post_job("simulate", study), set()
        start = time.perf_counter()
        while (now := server.get(f"/jobs/{job}"))["status"] in ("accepted", "running"):
            seen.add(now["progress"])
            time.sleep(LOOK)
        taken = time.perf_counter() - start
        print(f"{cells} rows of 10 parts in a job: {now['status']} after {taken:.0f} s,")
        print(f"  {len(seen)} values of its progress seen on the way")
        study["parameters"]["frequency"] = 60
        job = server.post_job("simulate", study)
        while server.get(f"/jobs/{job}")["progress"] < 50:
            time.sleep(LOOK)
        start = time.perf_counter()
        server.ask("DELETE", f"/jobs/{job}")
        few = {**study, "parameters": {**study["parameters"], "friction_seed": 0}}
        number = server.post_job("simulate", few)
        while (small := server.get(f"/jobs/{number}"))["status"] in ("accepted", "running"):
            time.sleep(LOOK)
        ended = server.get(f"/jobs/{job}")
        print(f"  the same, dismissed half done: {ended['status']} at {ended['progress']} %;")
        after = time.perf_counter() - start
        print(f"  {cells // 100} rows more are {small['status']} {after:.1f} s after")


def main() -> None:
    """Print all measurements."""
    asked = options(
        __doc__,
        cells=(1000, "cells of a study, 50 or more"),
        service=(0, "cells of a study over HTTP"),
    )
    if asked.service:
        over_http(asked.service)
        return
    cells = max(50, asked.cells // 50 * 50)
    print("random drive and friction, all of 100 periods     ms a row   at most")
    for parts in (2, 5, 10, 20):
        mean, most = whole_rows(parts, cells // 5)
        print(f"{parts:5} parts {mean:45.2f} {most:9.2f}")
    for orders in (2, 3, 10):
        mean, most = whole_rows(10, cells // 5, orders)
        print(f"   10 parts under {orders:2} harmonics {mean:24.2f} {most:9.2f}")
    print("random friction, 100 periods at most     ms a cell")
    for parts in (2, 5, 10, 20):
        print(f"{parts:5} parts {milliseconds(of_rows(parts), cells):34.2f}")
    held = of_rows(10, fixed_stop_gap=0)
    print(f"   10 parts at a fixed stop {milliseconds(held, cells):17.2f}")
    amplitudes = np.linspace(1e-4, MAX_AMPLITUDE, cells)

    def equal(scene: str, **more: Any) -> Callable[[int], object]:
        """Return a function that simulates equal rows, or single parts."""
        return lambda count: vibrafeed.simulate(
            scene=scene, friction=0.4, amplitude=amplitudes[:count], **DRIVE, **more
        )

    one = milliseconds(equal("rectangle-on-plane"), cells)
    row = milliseconds(equal("row-on-plane", parts=20), cells)
    print(f"20 parts of one friction take {row / one:.2f} times as long as one part ({row:.4f} ms)")


if __name__ == "__main__":
    main()
