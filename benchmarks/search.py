"""Prints how near the global search comes to the best of a fine grid, on simulated conveying
velocity, beside scipy's DIRECT at the same budget: `python -m benchmarks.search --grid 2000`.

Of 20 random designs of a feeder 17 are without restitution; 5 of them bound the throw number, so
that the best lies on a curved edge beyond which there is no value. The grids take minutes each at
2,000: `--cache` keeps their results in a file.
"""  # noqa: D205

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import optimize

from benchmarks.motions import planar_motion
from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.scipy_methods import SEARCH_BUDGET
from vibrafeed.core.optimise.search import search_maximum

GRAVITY = 9.81
NO_VALUE = 1e3
PIECE = 200_000  # cells of a grid at a time


@dataclass(frozen=True)
class Design:
    """One feeder; beta and one of amplitude and frequency vary."""

    variable: str
    other: float  # the value of the other of the two
    friction: float
    gamma: float
    restitution: float
    throw_limit: float

    @property
    def lower(self) -> Array:
        """The lower bounds of beta and the other variable, SI units."""
        return np.array([math.radians(1), 2e-5 if self.variable == "amplitude" else 20.0])

    @property
    def upper(self) -> Array:
        """The upper bounds of beta and the other variable, SI units."""
        return np.array([math.radians(89), 2e-3 if self.variable == "amplitude" else 120.0])

    def velocity(self, points: Array) -> Array:
        """Return the conveying velocity at points (n, 2); NaN above the throw limit."""
        beta, varied = points.T
        by_amplitude = self.variable == "amplitude"
        frequency = np.full_like(beta, self.other) if by_amplitude else varied
        amplitude = varied if by_amplitude else np.full_like(beta, self.other)
        w = 2 * math.pi * frequency
        drive = amplitude * w * w / GRAVITY
        values = np.full(beta.shape, np.nan)
        kept = drive * np.sin(beta) <= self.throw_limit * math.cos(self.gamma)
        motion = planar_motion(
            drive_number_along=(drive * np.cos(beta))[kept],
            drive_number_normal=(drive * np.sin(beta))[kept],
            gravity_number_along=np.asarray(math.sin(self.gamma)),
            gravity_number_normal=np.asarray(math.cos(self.gamma)),
            friction_static=np.asarray(self.friction),
            friction_kinetic=np.asarray(self.friction),
            restitution=np.asarray(self.restitution),
            tolerance=np.asarray(1e-12),
            max_periods=np.asarray(1000.0 if self.restitution == 0 else 64.0),
        )
        values[kept] = motion.velocity * GRAVITY / w[kept]
        return values


GRID = "points of an axis of the grid"
GRIDS: dict[str, Any] = {
    "rough_grid": (int, "the same with restitution above 0"),
    "cache": (Path, "file that keeps the results of the grids"),
    "designs": ([int], "numbers of the designs, from 1"),
}
"""Options of this program and of `benchmarks.rivals`."""


def designs() -> list[Design]:
    """Return random designs of feeders."""
    random = np.random.default_rng(5)
    made = []
    for number in range(20):
        variable = ("amplitude", "frequency")[number % 2]
        frequency = random.uniform(20, 120)
        amplitude = 10 ** random.uniform(math.log10(2e-5), math.log10(2e-3))
        friction, gamma = random.uniform(0.1, 1), math.radians(random.uniform(-3, 6))
        restitution, limit = random.uniform(0.05, 0.5), random.uniform(0.8, 5)
        made.append(
            Design(
                variable,
                float(frequency if variable == "amplitude" else amplitude),
                float(friction),
                gamma,
                float(restitution) if number >= 17 else 0.0,
                float(limit) if number < 17 and number % 3 == 2 else np.inf,
            )
        )
    return made


def grid_points(design: Design, size: int) -> Iterator[Array]:
    """Yield the points of a grid, ends included, in pieces (n, 2)."""
    first, second = np.linspace(design.lower, design.upper, size).T
    rows = max(1, PIECE // size)
    for start in range(0, size, rows):
        some = first[start : start + rows]
        yield np.stack(np.broadcast_arrays(some[:, None], second), axis=-1).reshape(-1, 2)


def best_of_grid(design: Design, size: int) -> dict[str, float]:
    """Return the best value of a grid, its point, and the time."""
    start = time.perf_counter()
    best = {"value": -np.inf}
    for points in grid_points(design, size):
        values = design.velocity(points)
        if np.isnan(values).all():
            continue
        place = int(np.nanargmax(values))
        if values[place] > best["value"]:
            best = {
                "value": float(values[place]),
                "beta": float(points[place, 0]),
                "varied": float(points[place, 1]),
            }
    return {**best, "seconds": time.perf_counter() - start}


def cached_grid(number: int, design: Design, size: int, cache: Path | None) -> dict[str, float]:
    """Return the best value of a grid, read from the cache if possible."""
    known = json.loads(cache.read_text()) if cache is not None and cache.exists() else {}
    key = f"{number} {size} {design}"
    if key not in known:
        known[key] = best_of_grid(design, size)
        if cache is not None:
            cache.write_text(json.dumps(known, indent=1))
    return known[key]


class Counted:
    """The objective of DIRECT: -velocity, counted; a large number where there is no value."""

    def __init__(self, design: Design):
        self.design, self.evaluations, self.best = design, 0, -np.inf

    def __call__(self, point: Array) -> float:
        """Return the negative velocity at a point (2,), and count it."""
        value = float(np.nan_to_num(self.design.velocity(point[None])[0], nan=-NO_VALUE))
        self.evaluations += 1
        self.best = max(self.best, value)
        return -value


def by_direct(lost: Counted) -> None:
    """Run scipy's DIRECT with the whole budget, point by point."""
    ends = list(zip(lost.design.lower, lost.design.upper, strict=True))
    most = SEARCH_BUDGET
    optimize.direct(
        lost, ends, maxfun=most - 1, maxiter=most, vol_tol=0, len_tol=0, locally_biased=False
    )


def longer(design: Design, beta: float, varied: float) -> tuple[float, float]:
    """Return the velocity at a point over a hundred times as many periods, with its spread."""
    w = 2 * math.pi * (varied if design.variable == "frequency" else design.other)
    amplitude = design.other if design.variable == "frequency" else varied
    drive = amplitude * w * w / GRAVITY
    groups = {
        "drive_number_along": drive * math.cos(beta),
        "drive_number_normal": drive * math.sin(beta),
        "gravity_number_along": math.sin(design.gamma),
        "gravity_number_normal": math.cos(design.gamma),
        "friction_static": design.friction,
        "friction_kinetic": design.friction,
        "restitution": design.restitution,
        "tolerance": 1e-12,
        "max_periods": 6400.0,
    }
    motion = planar_motion(**{name: np.asarray(value) for name, value in groups.items()})
    return float(motion.velocity) * GRAVITY / w, float(motion.spread) * GRAVITY / w


def compare(number: int, design: Design, size: int, cache: Path | None) -> float:
    """Print a table row; return by how much the search falls short of the grid."""
    grid = cached_grid(number, design, size, cache)
    found, seconds = timed(
        search_maximum, design.velocity, design.lower, design.upper, budget=SEARCH_BUDGET
    )
    lost = Counted(design)
    _, spent = timed(by_direct, lost)
    beside = f" {1 - lost.best / grid['value']:+9.1e} {lost.evaluations:6d} {spent:5.1f}"
    short = 1 - found.value / grid["value"]
    limit = f"{design.throw_limit:.2f}" if np.isfinite(design.throw_limit) else "-"
    print(
        f"{number:2d} {design.variable:9} {design.restitution:4.2f} {limit:>5} {size:5d} "
        f"{grid['value']:10.6f} {grid['seconds']:6.1f} {found.value:10.6f} {short:+9.1e} "
        f"{found.evaluations:6d} {seconds:5.1f}{beside}",
        flush=True,
    )
    if design.restitution > 0:
        for name, beta, varied in (
            ("grid", grid["beta"], grid["varied"]),
            ("search", *map(float, found.point)),
        ):
            value, spread = longer(design, beta, varied)
            print(f"   best of the {name}, 6,400 periods: {value:.6f}, spread {spread:.6f}")
    return short


def main() -> None:
    """Print the table of the search against grids."""
    given = options(__doc__, grid=(200, GRID), **GRIDS)
    print(
        " # varies    rest limit  grid  best[m/s]      s     search  short of   evals     s "
        "   DIRECT  evals     s"
    )
    shorts = []
    for number, design in enumerate(designs(), 1):
        if given.designs and number not in given.designs:
            continue
        rough = given.rough_grid or given.grid
        size = given.grid if design.restitution == 0 else rough
        shorts.append(compare(number, design, size, given.cache))
    print(f"most short of the grid: {max(shorts):+.1e}")


if __name__ == "__main__":
    main()
