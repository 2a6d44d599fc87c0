"""Prints the time of a design in the batch solver of the drive angles, and in a loop over scipy:
`python -m benchmarks.optimise_batch`.
"""  # noqa: D205

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from scipy import optimize

from core.mechanics.arrays import Array
from core.optimise.newton import PROBLEMS, Problem, fastest

DESIGNS = 10_000
SAMPLE = 20  # designs of the loops over scipy
REPEATS = 5  # the best is printed
GRAVITY = 9.81
RIGHT = np.pi / 2
STARTS = [(a, b) for a in (0.1, 0.8, 1.4) for b in (0.1, 0.7)]


def designs(count: int) -> dict[str, Array]:
    """Return random designs."""
    random = np.random.default_rng(1)
    climb, lean = random.uniform(-0.3, 0.5, count), random.uniform(0.0, 0.5, count)
    return {
        "vibration_acceleration": GRAVITY * 10 ** random.uniform(-0.5, 1.2, count),
        "gravity_along": GRAVITY * np.sin(climb),
        "gravity_across": GRAVITY * np.cos(climb) * np.sin(lean),
        "gravity_normal": GRAVITY * np.cos(climb) * np.cos(lean),
        "friction_kinetic": random.uniform(0.05, 1.0, count),
        "limit": 10 ** random.uniform(-1, 1, count),
    }


def bounds(count: int) -> dict[str, Array]:
    """Return random bounds of the angles."""
    random = np.random.default_rng(2)
    alpha = np.sort(random.uniform(-0.5, 1.7, (2, count)), axis=0)
    beta = np.sort(random.uniform(-0.2, 1.5, (2, count)), axis=0)
    return {
        "alpha_lower": alpha[0],
        "alpha_upper": alpha[1],
        "beta_lower": beta[0],
        "beta_upper": beta[1],
    }


def microseconds(problem: Problem, threads: int, given: dict[str, Array]) -> float:
    """Return the time of a design."""
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        fastest(problem, **given, threads=threads)
        times.append(time.perf_counter() - start)
    return min(times) / DESIGNS * 1e6


class Design:
    """One design of the printed plane in scipy's terms, in units of the drive acceleration."""

    def __init__(self, given: dict[str, Array], i: int) -> None:
        drive = given["vibration_acceleration"][i]
        self.along = given["gravity_along"][i] / drive
        self.normal = given["gravity_normal"][i] / drive
        self.limit = given["limit"][i] / drive
        self.mu = given["friction_kinetic"][i]

    def lost(self, angles: Array) -> Array:
        """Return -a_x; angles (2,) or (2, n)."""
        n = self.normal - np.sin(angles[1])
        return -(np.cos(angles[1]) * np.cos(angles[0]) - self.along - self.mu * n)

    def kept(self, angles: Array) -> Array:
        """Return limit - a_y, limit + a_y and n0, which may not be negative."""
        n = self.normal - np.sin(angles[1])
        across = np.cos(angles[1]) * np.sin(angles[0]) - self.mu * n
        return np.stack([self.limit - across, self.limit + across, n])


def by_evolution(design: Design) -> float:
    """Return a_x of scipy's differential evolution."""
    answer = optimize.differential_evolution(
        design.lost,
        [(0.0, RIGHT)] * 2,
        constraints=optimize.NonlinearConstraint(design.kept, 0.0, np.inf),
        vectorized=True,
        updating="deferred",
        rng=1,
        tol=1e-12,
        atol=1e-12,
    )
    return -float(answer.fun)


def by_slsqp(design: Design) -> float:
    """Return the best a_x of SLSQP from six starts."""
    best = -np.inf
    for start in STARTS:
        answer = optimize.minimize(
            design.lost,
            start,
            method="SLSQP",
            bounds=[(0.0, RIGHT)] * 2,
            constraints={"type": "ineq", "fun": design.kept},
            options={"ftol": 1e-14, "maxiter": 300},
        )
        if design.kept(answer.x).min() > -1e-9:
            best = max(best, -float(answer.fun))
    return best


def main() -> None:
    """Print the times, then the comparison."""
    given, within = designs(DESIGNS), bounds(DESIGNS)
    for problem in PROBLEMS:
        kept = {} if problem.startswith("plane") else {"limit": np.full(DESIGNS, np.inf)}
        asked = {**given, **kept}
        fastest(problem, **asked)  # compiles
        one, two = (microseconds(problem, threads, asked) for threads in (1, 2))
        bounded = microseconds(problem, 1, {**asked, **within})
        print(
            f"{problem:15} {DESIGNS:,} designs: {one:5.2f} us a design on one thread, {two:5.2f} "
            f"on two; {bounded:5.2f} with random bounds on one"
        )
    ours = fastest("plane_thesis", **given)
    chosen = np.flatnonzero(ours.status == 0)[:SAMPLE]
    at_once = microseconds("plane_thesis", 1, given)
    loops: dict[str, Callable[[Design], float]] = {
        "differential_evolution(vectorized=True)": by_evolution,
        "SLSQP on the epigraph form, six starts": by_slsqp,
    }
    for name, loop in loops.items():
        start = time.perf_counter()
        found = np.array([loop(Design(given, i)) for i in chosen])
        singly = (time.perf_counter() - start) / SAMPLE * 1e6
        gap = ours.objective[chosen] / given["vibration_acceleration"][chosen] - found
        print(
            f"plane_thesis    {name}: {singly / 1e3:7.1f} ms a design, {singly / at_once:9,.0f} "
            f"times; batch less loop, of P: {gap.min():+.1e} to {gap.max():+.1e}"
        )


if __name__ == "__main__":
    main()
