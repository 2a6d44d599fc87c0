"""Prints the error of the time stepping against the step, its order, and its speed.

`python -m benchmarks.stepping_order`. Exact values: theory 13.8 (v), (vi), the worked means
of core/assurance, and the reference method in space.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.motions import planar_stepped_motion, reference_motion, stepped_motion, stepped_path
from benchmarks.timing import timed
from benchmarks.worked_values import MEAN_VELOCITIES
from vibrafeed.core.assurance.accuracy.curves import fitted_slope

STEPS = (100, 300, 1000, 3000, 10000, 30000, 100000)
REST = {"drive_number_along": 0.0, "drive_number_across": 0.0, "drive_number_normal": 0.0}


def show(name: str, error: Callable[[int], float], steps: tuple[int, ...] = STEPS) -> None:
    """Print errors against steps, and the slope of their logarithms."""
    errors = [error(n) for n in steps]
    slope = -fitted_slope(list(zip(steps, errors, strict=True)))
    print(f"{name:24} slope {slope:4.2f}  " + "  ".join(f"{e:.1e}" for e in errors))


def disc(n: int) -> float:
    """Return the error of a disc's travel on an incline."""
    gamma, mu, u0, psi = math.radians(20.0), 0.6, 2.0, math.radians(70.0)
    a, nu = math.sin(gamma), mu / math.tan(gamma)
    t = math.tan(psi / 2.0)
    c = u0 * math.sin(psi) / t**nu
    down = t ** (2 * nu - 2) / (2 * nu - 2) - t ** (2 * nu + 2) / (2 * nu + 2)
    cross = t ** (2 * nu - 1) / (2 * nu - 1) + t ** (2 * nu + 1) / (2 * nu + 1)
    found = stepped_path(
        **REST, phases=[0.0, 8.0], steps_per_period=n, gravity_number_along=a,
        gravity_number_across=0.0, gravity_number_normal=math.cos(gamma), friction_static=mu,
        friction_kinetic=mu, velocity=(-u0 * math.cos(psi), u0 * math.sin(psi), 0.0),
    ).position[-1]  # fmt: skip
    return math.hypot(found[0] + c * c / (4 * a) * down, found[1] - c * c / (2 * a) * cross)


def chute(n: int) -> float:
    """Return the error of the speed in a curved chute."""
    gamma, delta, mu, curvature = math.radians(-25.0), math.radians(8.0), 0.2, 0.05
    k = -math.sin(gamma) - mu * math.cos(gamma) * (math.cos(delta) + math.sin(delta))
    exact = math.sqrt(k / (mu * curvature)) * math.tanh(5.0 * math.sqrt(mu * k * curvature))
    found = stepped_path(
        **REST, phases=[0.0, 5.0], steps_per_period=n, gravity_number_along=math.sin(gamma),
        gravity_number_across=math.cos(gamma) * math.sin(delta),
        gravity_number_normal=math.cos(gamma) * math.cos(delta), friction_static=mu,
        friction_kinetic=mu, wall_friction=mu, curvature_number=curvature, wall=True,
    ).velocity[-1, 0]  # fmt: skip
    return abs(found - exact)


def cells(count: int, across: bool) -> dict[str, Any]:
    """Return random cells: drives of 0.5 to 5 g, sliding and hopping."""
    random = np.random.default_rng(5)
    drive = 10.0 ** random.uniform(-0.3, 0.7, count)
    alpha = np.radians(random.uniform(-20.0, 40.0, count)) * across
    beta = np.radians(random.uniform(5.0, 40.0, count))
    gamma = np.radians(random.uniform(-2.0, 3.0, count))
    delta = np.radians(random.uniform(2.0, 15.0, count)) * across
    static = random.uniform(0.2, 0.6, count)
    groups = {
        "drive_number_along": drive * np.cos(beta) * np.cos(alpha),
        "drive_number_normal": drive * np.sin(beta),
        "gravity_number_along": np.sin(gamma),
        "gravity_number_normal": np.cos(gamma) * np.cos(delta),
        "friction_static": static, "friction_kinetic": static * random.uniform(0.6, 1.0, count),
        "restitution": random.choice([0.0, 0.3], count),
    }  # fmt: skip
    if across:
        groups |= {
            "drive_number_across": drive * np.cos(beta) * np.sin(alpha),
            "gravity_number_across": np.cos(gamma) * np.sin(delta),
            "wall_friction": random.uniform(0.1, 0.5, count),
        }
    return groups


def main() -> None:
    """Print errors, orders and speed of time stepping."""
    print("error against steps a period:", *STEPS)
    show("disc, travel", disc)
    show("chute, speed", chute)
    for name, case in MEAN_VELOCITIES.items():
        groups, mean = case.groups(), case.scaled

        def error(n: int, groups: dict[str, float] = groups, mean: float = mean) -> float:
            """Return the error of the mean velocity in the plane."""
            return abs(float(planar_stepped_motion(**groups, steps_per_period=n).velocity) - mean)

        show(name, error)
    one = {key: float(value[0]) for key, value in cells(1, True).items()}
    exact = float(reference_motion(**one, wall=True).velocity)

    def at_wall(n: int) -> float:
        """Return the error of the mean velocity at the wall."""
        found = stepped_motion(**one, wall=True, steps_per_period=n)
        return abs(float(found.velocity) - exact)

    show("at the wall, in space", at_wall, STEPS[:-1])
    scenes: dict[str, Callable[[int], object]] = {
        "planar": lambda n: planar_stepped_motion(**cells(n, False), steps_per_period=800),
        "wall, block": lambda n: stepped_motion(**cells(n, True), wall=True, steps_per_period=800),
        "wall, cylinder": lambda n: stepped_motion(
            **cells(n, True), wall=True, rolling=2.0, steps_per_period=800
        ),
    }
    for name, run in scenes.items():
        count = 2000 if name == "planar" else 200
        run(8)  # compiled
        rate = count / timed(run, count)[1]
        print(f"{name:16} {rate:8.0f} cells a second, at 800 and 1601 steps a period")


if __name__ == "__main__":
    main()
