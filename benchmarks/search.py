"""Prints how near the search comes to the best of a fine grid, on simulated conveying velocity:
`python -m benchmarks.search --grid 2000`.

Of 20 random designs of a feeder 17 are without restitution; 5 of them bound the throw number, so
that the best lies on a curved edge beyond which there is no value. The grids take minutes each at
2,000: `--cache` keeps their results in a file, and the best that any search found, too.
"""  # noqa: D205

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.motions import planar_motion
from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.search import Candidates, best_points
from vibrafeed.core.watch import Watch

GRAVITY = 9.81
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
        return self.velocity_and_error(points)[0]

    def velocity_and_error(self, points: Array) -> tuple[Array, Array]:
        """Return the velocity at points (n, 2), and 1 where the motion does not repeat, else 0."""
        beta, varied = points.T
        by_amplitude = self.variable == "amplitude"
        frequency = np.full_like(beta, self.other) if by_amplitude else varied
        amplitude = varied if by_amplitude else np.full_like(beta, self.other)
        w = 2 * math.pi * frequency
        drive = amplitude * w * w / GRAVITY
        values, errors = np.full(beta.shape, np.nan), np.zeros(beta.shape)
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
        errors[kept] = motion.multiple == 0
        return values, errors

    def judge(self, unit: Array, numbers: NDArray[np.intp]) -> Candidates:
        """Judge points, shares of the bounds of shape (2, 1, n), for the search."""
        points = (self.lower[:, None] + (self.upper - self.lower)[:, None] * unit[:, 0]).T
        value, error = self.velocity_and_error(points)
        lost = np.isnan(value)
        beyond, value = np.where(lost, np.inf, 0.0), np.where(lost, -np.inf, value)
        return Candidates(unit, beyond[None], value[None], error[None])


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


def key_of(number: int, design: Design, size: int) -> str:
    """Return the key of a grid in the cache."""
    return f"{number} {size} {design}"


def cached_grid(number: int, design: Design, size: int, cache: Path | None) -> dict[str, float]:
    """Return the best value of a grid, read from the cache if possible."""
    known = json.loads(cache.read_text()) if cache is not None and cache.exists() else {}
    key = key_of(number, design, size)
    if key not in known:
        known[key] = best_of_grid(design, size)
        if cache is not None:
            cache.write_text(json.dumps(known, indent=1))
    return known[key]


def compare(number: int, design: Design, size: int, cache: Path | None) -> float:
    """Print a table row; return by how much the search falls short of the best known value."""
    grid = cached_grid(number, design, size, cache)
    found, seconds = timed(best_points, design.judge, 2, 1, Watch(), jumps=True)
    value = float(found.best.value[0, 0])
    known = max(grid["value"], grid.get("known", value), value)
    short = 1 - value / known
    limit = f"{design.throw_limit:.2f}" if np.isfinite(design.throw_limit) else "-"
    print(
        f"{number:2d} {design.variable:9} {design.restitution:4.2f} {limit:>5} {size:5d} "
        f"{grid['value']:13.9f} {grid['seconds']:6.1f} {value:13.9f} {short:+9.1e} "
        f"{int(found.evaluations[0]):6d} {seconds:5.1f}",
        flush=True,
    )
    if cache is not None:
        kept = json.loads(cache.read_text())
        kept[key_of(number, design, size)]["known"] = known
        cache.write_text(json.dumps(kept, indent=1))
    return short


def main() -> None:
    """Print the table of the search against grids."""
    given = options(
        __doc__,
        grid=(200, "points of an axis of the grid"),
        rough_grid=(int, "the same with restitution above 0"),
        cache=(Path, "file that keeps the results of the grids"),
        designs=([int], "numbers of the designs, from 1"),
    )
    print(
        " # varies    rest limit  grid     best[m/s]      s        search  short of   evals     s"
    )
    shorts = []
    for number, design in enumerate(designs(), 1):
        if given.designs and number not in given.designs:
            continue
        rough = given.rough_grid or given.grid
        size = given.grid if design.restitution == 0 else rough
        shorts.append(compare(number, design, size, given.cache))
    print(f"most short of the best known: {max(shorts):+.1e}")


if __name__ == "__main__":
    main()
