"""Does rounding pick the answer? Random cells with restitution, each parameter moved by 1 to 3 ulp.

`python -m benchmarks.restitution_ulps` prints, for the method `events`, in which share of the cells
the status changes, or the mean velocity by more than the cell's own stated error, when any one of
its parameters is the next floating number, or one of the two after it, up or down. The aim: at most
one cell in a thousand.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce

import numpy as np

from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.motion.method import STATUS
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.plan import plan_scene, run_equations
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY

Array = np.ndarray
Cells = dict[str, Array]
SCENE, METHOD = "rectangle-on-plane", "events"
ASKED = ("conveying_velocity", "conveying_velocity_error", "motion_status")
MOVED = (
    "frequency", "amplitude", "beta", "gamma", "friction_static", "friction_kinetic", "restitution",
)  # fmt: skip
ULPS = (-3, -2, -1, 1, 2, 3)
SHARE = 1e-3
"""Most cells that may change."""


def random_cells(count: int, seed: int) -> Cells:
    """Return random parameters in SI units as users type them, restitution from 0.1 to 0.95.

    One cell in ten has a static friction above the kinetic one, one in five lies on the level.
    """
    random = np.random.default_rng(seed)
    frequency = random.uniform(20, 100, count)
    beta = np.radians(random.uniform(5, 60, count))
    gamma = np.radians(random.uniform(-3, 5, count)) * (random.random(count) > 0.2)
    throw = random.uniform(1, 6, count)
    friction = random.uniform(0.1, 0.9, count)
    above = np.where(random.random(count) < 0.1, random.uniform(1, 1.5, count), 1.0)
    acceleration = throw * STANDARD_GRAVITY * np.cos(gamma) / np.sin(beta)
    return {
        "frequency": frequency,
        "amplitude": acceleration / np.square(2 * np.pi * frequency),
        "beta": beta,
        "gamma": gamma,
        "friction_static": friction * above,
        "friction_kinetic": friction,
        "restitution": random.uniform(0.1, 0.95, count),
    }


def moved(values: Array, ulps: int) -> Array:
    """Return floats moved by some units in the last place."""
    way = np.inf if ulps > 0 else -np.inf
    return reduce(lambda value, _: np.nextafter(value, way), range(abs(ulps)), values)


def neighbours(cells: Cells) -> list[Cells]:
    """Return the cells with one parameter moved by an ulp; equal frictions move together."""
    one = cells["friction_static"] == cells["friction_kinetic"]
    found = []
    for name in MOVED:
        for ulps in ULPS:
            other = cells | {name: moved(cells[name], ulps)}
            if name == "friction_static":
                other[name] = np.where(one, cells[name], np.maximum(
                    other[name], cells["friction_kinetic"]))  # fmt: skip
            if name == "friction_kinetic":
                other["friction_static"] = np.where(one, other[name], cells["friction_static"])
            found.append(other)
    return found


def followed(cells: Mapping[str, Array]) -> Cells:
    """Return velocity [m s-1], stated error and status of cells."""
    plan = plan_scene(SYSTEMS[SCENE], METHOD, ASKED, tuple(cells))
    known = run_equations(plan, dict(cells))
    return {name: np.asarray(known[name]) for name in ASKED}


@dataclass(frozen=True)
class Changes:
    """What moving parameters by a few ulp changed, a value a cell.

    Attributes
    ----------
    cells : dict of str to ndarray
        The cells.
    status : ndarray of int8
        Of the cells as they are.
    of_status, of_value : ndarray of bool
        Whether a neighbour has another status, or a mean velocity that is further off than the
        cell's own stated error.
    """

    cells: Cells
    status: Array
    of_status: Array
    of_value: Array

    @property
    def share(self) -> float:
        """The share of cells that change in status or velocity."""
        return float((self.of_status | self.of_value).mean())


def changes(cells: Cells) -> Changes:
    """Return the changes of results when any parameter moves by up to 3 ulp."""
    here = followed(cells)
    status, velocity = here["motion_status"], here["conveying_velocity"]
    has_value = np.isfinite(velocity)
    of_status = np.zeros(status.shape, dtype=bool)
    of_value = np.zeros(status.shape, dtype=bool)
    for other in neighbours(cells):
        there = followed(other)
        of_status |= there["motion_status"] != status
        apart = np.abs(there["conveying_velocity"] - velocity)
        of_value |= has_value & ~(apart <= here["conveying_velocity_error"])
    return Changes(cells, status, of_status, of_value)


def main() -> int:
    """Print shares of changes by restitution and status; 1 if they exceed the aim."""
    given = options(__doc__, cells=10_000, seed=14, show=(5, "cells that change, in full"))
    found, seconds = timed(changes, random_cells(given.cells, given.seed))
    names = {value: name for name, value in STATUS.items()}
    print(f"{given.cells:,} cells, {len(MOVED) * len(ULPS)} neighbours each, "
          f"{seconds:.0f} s")  # fmt: skip
    tenths = np.floor(found.cells["restitution"] * 10)
    groups = [
        (f"restitution {low / 10:.1f} to {low / 10 + 0.1:.1f}", tenths == low)
        for low in range(1, 10)
    ]
    groups += [(names[int(value)], found.status == value) for value in np.unique(found.status)]
    groups += [("all", np.ones(given.cells, dtype=bool))]
    print(f"{'':24} {'cells':>7} {'status changes':>15} {'value changes':>15}")
    for name, held in groups:
        if held.any():
            print(f"{name:24} {held.sum():7,} {found.of_status[held].mean():15.3%} "
                  f"{found.of_value[held].mean():15.3%}")  # fmt: skip
    print(f"changed in status or value: {found.share:.3%} (aim: {SHARE:.1%})")
    for cell in np.flatnonzero(found.of_status | found.of_value)[: given.show]:
        values = ", ".join(f"{name} {float(v[cell])!r}" for name, v in found.cells.items())
        print(f"  {names[int(found.status[cell])]}: {values}")
    return 0 if found.share <= SHARE else 1


if __name__ == "__main__":
    sys.exit(main())
