"""What a reduced sweep costs: nanoseconds a cell, memory, and how well the time is predicted.

    python -m benchmarks.reduce [CELLS ...]

Seven axes of the narrow track, over two of which the best speed and where it lies are asked for.
"""

from __future__ import annotations

import resource
import statistics
import sys
import time
from typing import Any

import numpy as np

from core.intake import prepare_content
from core.kinds import tabulate

ASKED: dict[str, dict[str, Any]] = {
    "argmax": {"statistics": ["argmax"]},
    "max, mean": {"statistics": ["max", "mean"]},
    "all statistics": {"statistics": ["max", "min", "mean", "argmax", "argmin"]},
    "regimes": {"regimes": True},
    "share": {"shares": {"fast": ["regime == slip", "transport_velocity >= 10 mm/s"]}},
    "level": {
        "levels": {"reach": {"output": "transport_velocity", "level": "10 mm/s", "along": "beta"}}
    },
}
TABLE = ("frequency", "amplitude")
RUNS = 3


def study(cells: int, asked: dict[str, Any], kept: tuple[str, ...]) -> dict[str, Any]:
    """Return a study of about so many cells, reduced over all axes but those that are kept."""
    ranges = {
        "frequency": (20, 120),
        "amplitude": (2e-5, 2e-4),
        "alpha": (0, 60),
        "beta": (1, 30),
        "gamma": (0, 30),
        "friction": (0.1, 0.6),
        "distance": (1e-5, 1e-4),
    }
    left = cells
    axes = {}
    for done, (name, (start, stop)) in enumerate(ranges.items()):
        size = max(2, round(left ** (1 / (len(ranges) - done))))
        left = -(-left // size)
        axes[name] = {"start": start, "stop": stop, "num": size}
    over = [name for name in ranges if name not in kept]
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": ["transport_velocity"],
        "parameters": {**axes, "radius": "0.8 m"},
        "reduce": {"over": over, **asked},
    }


def measured(content: dict[str, Any], runs: int) -> tuple[float, list[float], int]:
    """Return the seconds that were predicted, those of some runs, and the number of cells."""
    predicted = prepare_content(content).work.seconds()  # type: ignore[attr-defined]
    times = []
    for _ in range(runs):
        prepared = prepare_content(content)
        started = time.perf_counter()
        tabulate(prepared)
        times.append(time.perf_counter() - started)
    return predicted, times, prepared.cells


def fill(cells: int = 1 << 24) -> float:
    """Return the nanoseconds a cell of a plain fill of a buffer that is used again."""
    buffer, times = np.empty(cells), []
    for _ in range(9):
        started = time.perf_counter()
        buffer.fill(1.0)
        times.append(time.perf_counter() - started)
    return statistics.median(times) / cells * 1e9


def main(sizes: list[int]) -> None:
    """Print the figures."""
    print(f"plain fill, one core: {fill():.2f} ns a cell")
    for name, asked in ASKED.items():
        for kept in (TABLE, ("beta", "distance")) if name == "argmax" else (TABLE,):
            if name == "level" and "beta" in kept:
                continue
            predicted, times, cells = measured(study(100_000_000, asked, kept), RUNS)
            print(
                f"{name:15} by {' and '.join(kept):22} {cells:,} cells: "
                f"{statistics.median(times) / cells * 1e9:.2f} ns a cell "
                f"({min(times):.2f} to {max(times):.2f} s, predicted {predicted:.2f} s)",
                flush=True,
            )
    for size in sizes:
        predicted, times, cells = measured(study(size, ASKED["argmax"], TABLE), 1)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"argmax, {cells:,} cells: {times[0]:.1f} s, {times[0] / cells * 1e9:.2f} ns a cell, "
            f"predicted {predicted:.1f} s; {memory:.0f} MiB at most",
            flush=True,
        )


if __name__ == "__main__":
    main([int(float(size)) for size in sys.argv[1:]] or [1_000_000_000])
