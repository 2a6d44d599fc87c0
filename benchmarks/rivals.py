"""Prints how sure the search for outputs that jump is beside searches of libraries, on the designs
of `benchmarks/search.py`: `python -m benchmarks.rivals --grid 2000`.

Needs the extra `rivals` (`pip install -e .[rivals] --constraint constraints.txt`). Every search may
spend as many evaluations, in several settings, with several seeds. A design counts as reached where
the best point evaluated is at or above the best of the grid, to 1e-6 of it: the tolerance that ours
is asked for, so that nobody loses by a distance to an edge. Ours is made of scipy's differential
evolution, which stands among the rivals with other settings.
"""  # noqa: D205

from __future__ import annotations

import contextlib
import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import cma
import numpy as np
from pymoo.algorithms.soo.nonconvex.cmaes import CMAES
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.es import ES
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from pymoo.termination import get_termination
from scipy import optimize

from benchmarks.options import options
from benchmarks.search import GRID, GRIDS, Design, cached_grid, designs
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.scipy_methods import SEARCH_BUDGET
from vibrafeed.core.optimise.search import search_maximum

NO_VALUE = 1e3  # stands in where there is none; all rivals but scipy's compare ranks alone
REACHED = 1e-6  # of the grid's best
BEYOND = 0.05  # of the box: a rival's box is wider by so much, and what lies outside is moved in


@dataclass(frozen=True)
class Known:
    """A function over the unit box whose largest value is known, in the place of a design."""

    name: str
    variables: int
    best: float
    function: Callable[[Array], Array]

    @property
    def lower(self) -> Array:
        """The lower bounds: zeros."""
        return np.zeros(self.variables)

    @property
    def upper(self) -> Array:
        """The upper bounds: ones."""
        return np.ones(self.variables)

    def velocity(self, points: Array) -> Array:
        """Return the values at points (n, variables)."""
        return self.function(points)


def hills(u: Array) -> Array:
    """Return Rastrigin's function, negated: fifty hills and more per variable."""
    x = (u - 0.637) * 10
    return 1 - np.sum(x * x + 10 * (1 - np.cos(2 * np.pi * x)), axis=1)


def edge_peak(u: Array) -> Array:
    """Return a function with a peak of width 0.004 on an edge."""
    return np.exp(-(((u[:, 0] - 0.4321) / 0.002) ** 2)) * u[:, 1]


def cliff(u: Array) -> Array:
    """Return a plane that ends abruptly along a slanted line, where it is largest."""
    along = u[:, 0] - u[:, 1]
    return np.where(u.sum(axis=1) < 1.1234, u.sum(axis=1) - (along - 0.2) ** 2, 0.0)


KNOWN = (
    Known("hills, 1", 1, 1.0, hills),
    Known("hills, 2", 2, 1.0, hills),
    Known("edge peak, 2", 2, 1.0, edge_peak),
    Known("cliff, 2", 2, 1.1234, cliff),
    Known("corner, 1", 1, 1.0, lambda u: u.mean(axis=1)),
    Known("corner, 4", 4, 1.0, lambda u: u.mean(axis=1)),
    Known("bowl, 4", 4, 1.0, lambda u: 1 - np.sum((u - 0.3712) ** 2, axis=1)),
)
"""The functions of `tests/unit_core/optimise/test_search.py`, on which no search may fall short."""

NARROW = 1e-5
"""By how much a search may fall short of `KNOWN`: what the tests ask for at a jump."""


class SpentError(Exception):
    """The budget is spent: some libraries count generations, and would go beyond it."""


class Judge:
    """The objective in the unit box: counts, keeps the best, and ends a search at its budget.

    The best often lies on an edge. What leaves the box is moved onto it, as in ours, for rivals
    that would otherwise only come near an edge.
    """

    def __init__(self, design: Design | Known, budget: int):
        self.design, self.budget = design, budget
        self.evaluations, self.best, self.found_at = 0, -np.inf, 0
        self.lower, self.span = design.lower, design.upper - design.lower
        self.variables = len(design.lower)

    def __call__(self, unit: Array) -> Array:
        """Return the negative velocity at points (n, variables) of the unit box, and count them."""
        if self.evaluations + len(unit) > self.budget:
            raise SpentError
        inside = np.clip(unit, 0.0, 1.0)
        values = self.design.velocity(
            np.where(inside == 1, self.design.upper, self.lower + inside * self.span)
        )
        self.evaluations += len(unit)
        values = np.where(np.isnan(values), -NO_VALUE, values)
        if values.max() > self.best:
            self.best, self.found_at = float(values.max()), self.evaluations
        return -values


Rival = Callable[[Judge, int], object]
"""Takes the objective and a seed, and searches until it ends or the budget is spent."""


def ours(judge: Judge, seed: int) -> None:
    """Run vibrafeed's own search."""
    ends = np.zeros(judge.variables), np.ones(judge.variables)
    search_maximum(lambda points: -judge(points), *ends, budget=judge.budget, seed=seed)


def by_cma(
    judge: Judge, seed: int, *, members: int | None, sigma: float, bipop: bool = False,
    growth: float = 2.0,
) -> None:  # fmt: skip
    """Run pycma with random restarts until the budget is used up."""
    random = np.random.default_rng(seed)
    settings: dict[str, Any] = {
        "bounds": [[-BEYOND] * judge.variables, [1 + BEYOND] * judge.variables],
        "maxfevals": judge.budget,
        "tolx": 1e-7,
        "tolfun": 1e-12,
        "tolfunhist": 1e-13,
        "seed": seed + 1,
        "verbose": -9,
    }
    if members is not None:
        settings["popsize"] = members
    cma.fmin2(
        None,
        lambda: random.uniform(0, 1, judge.variables),
        sigma,
        settings,
        parallel_objective=lambda points: judge(np.asarray(points)).tolist(),
        restarts=1000,
        incpopsize=growth,
        bipop=bipop,
    )


def by_scipy(judge: Judge, seed: int, *, members: int, strategy: str, **more: Any) -> None:
    """Run scipy's differential evolution repeatedly until the budget is used up.

    Sobol's points come in powers of 2: 40 members are 64, 200 are 256, 1,000 are 1,024.
    """
    for again in range(1000):
        optimize.differential_evolution(
            lambda unit: judge(unit.T),
            [(-BEYOND, 1 + BEYOND)] * judge.variables,
            strategy=strategy,
            popsize=members // judge.variables,
            maxiter=judge.budget // members,
            init="sobol",
            tol=0,
            atol=1e-8,
            polish=False,
            vectorized=True,
            updating="deferred",
            rng=1000 * seed + again,
            **more,
        )


class AsProblem(Problem):  # type: ignore[misc] # pymoo has no types
    """The objective as pymoo has it."""

    def __init__(self, judge: Judge):
        self.judge = judge
        super().__init__(n_var=judge.variables, n_obj=1, xl=-BEYOND, xu=1 + BEYOND)

    def _evaluate(self, x: Array, out: dict[str, Array], *_: Any, **__: Any) -> None:
        """Write the objective of points into pymoo's output."""
        out["F"] = self.judge(x)


def by_pymoo(judge: Judge, seed: int, *, make: Callable[[], Any]) -> None:
    """Run a pymoo search repeatedly until the budget is used up."""
    for again in range(1000):
        minimize(
            AsProblem(judge),
            make(),
            get_termination("soo", xtol=1e-8, cvtol=1e-8, ftol=1e-10, period=30),
            seed=1000 * seed + again,
        )


RIVALS: dict[str, Rival] = {
    "pycma, 6, IPOP": partial(by_cma, members=None, sigma=0.25),
    "pycma, 6, BIPOP": partial(by_cma, members=None, sigma=0.25, bipop=True),
    "pycma, 20, restarts": partial(by_cma, members=20, sigma=0.25, growth=1.0),
    "pycma, 20, small": partial(by_cma, members=20, sigma=0.08, growth=1.0),
    "pycma, 100, IPOP": partial(by_cma, members=100, sigma=0.3),
    "pycma, 400, IPOP": partial(by_cma, members=400, sigma=0.3),
    "scipy DE, 40, best1bin": partial(by_scipy, members=40, strategy="best1bin"),
    "scipy DE, 200, best1bin": partial(by_scipy, members=200, strategy="best1bin"),
    "scipy DE, 200, rand1bin": partial(by_scipy, members=200, strategy="rand1bin"),
    "scipy DE, 1000, rand1bin": partial(by_scipy, members=1000, strategy="rand1bin"),
    "scipy DE, 200, to best": partial(by_scipy, members=200, strategy="currenttobest1bin"),
    "scipy DE, 400, gentle": partial(
        by_scipy, members=400, strategy="rand1bin", mutation=(0.3, 0.7), recombination=0.9
    ),
    "scipy DE, 1000, best": partial(
        by_scipy, members=1000, strategy="best1bin", mutation=(0.3, 0.9), recombination=0.9
    ),
    "pymoo DE, 100": partial(by_pymoo, make=lambda: DE(pop_size=100)),
    "pymoo DE, 400, rand": partial(
        by_pymoo, make=lambda: DE(pop_size=400, variant="DE/rand/1/bin", CR=0.9)
    ),
    "pymoo PSO, 100": partial(by_pymoo, make=lambda: PSO(pop_size=100)),
    "pymoo PSO, 400": partial(by_pymoo, make=lambda: PSO(pop_size=400)),
    "pymoo GA, 200": partial(by_pymoo, make=lambda: GA(pop_size=200)),
    "pymoo ES, 100 of 700": partial(by_pymoo, make=lambda: ES(pop_size=100, n_offsprings=700)),
    "pymoo CMA-ES, BIPOP": partial(by_pymoo, make=lambda: CMAES(restarts=20, bipop=True)),
}
"""The rivals: library, method, members of the population, and what else is set."""


class Run(NamedTuple):
    """One search of one design: by how much it falls short, and what it spent."""

    design: int
    short: float
    evaluations: int
    found_at: int
    seconds: float


def run(
    number: int, design: Design | Known, best: float, budget: int, rival: Rival, seed: int
) -> Run:
    """Run one search on one design."""
    judge = Judge(design, budget)
    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of flat stretches and early ends
        with contextlib.suppress(SpentError):
            try:
                rival(judge, seed)
            except (ValueError, AssertionError, NotImplementedError) as error:
                print(f"   refused {design}: {str(error)[:80]}")
    seconds = time.perf_counter() - start
    return Run(number, 1 - judge.best / best, judge.evaluations, judge.found_at, seconds)


def told(name: str, seed: int, runs: Iterable[Run], tolerance: float) -> str:
    """Return a table row for a search method."""
    runs = list(runs)
    reached = [one for one in runs if one.short <= tolerance]
    missed = " ".join(f"{one.design}:{one.short:.0e}" for one in runs if one.short > tolerance)
    spent = np.array([one.evaluations for one in runs])
    found = np.array([one.found_at for one in reached] or [0])
    return (
        f"{name:26} {seed:4d} {len(reached):3d}/{len(runs)} {np.median(spent):8.0f} "
        f"{spent.max():8d} {np.median(found):8.0f} {found.max():8d} "
        f"{sum(one.seconds for one in runs):7.1f}  {missed}"
    )


def main() -> None:
    """Print the table of searches."""
    given = options(
        __doc__, grid=(2000, GRID), **GRIDS, known=(False, "functions of the tests instead"),
        budget=[SEARCH_BUDGET], seeds=[0, 1, 2], only=([""], "parts of names of searches"),
    )  # fmt: skip
    chosen: list[tuple[int, Design | Known, float]] = []
    for number, design in enumerate([] if given.known else designs(), 1):
        if not given.designs or number in given.designs:
            rough = design.restitution > 0 and given.rough_grid
            grid = cached_grid(number, design, rough or given.grid, given.cache)
            chosen.append((number, design, grid["value"]))
    if given.known:
        chosen = [(number, known, known.best) for number, known in enumerate(KNOWN, 1)]
        print(", ".join(f"{number} {known.name}" for number, known, _ in chosen))
    for budget in given.budget:
        print(f"{budget:,} evaluations a design at most")
        print(
            f"{'search':26} seed reached median of largest  median until largest        s  "
            "missed: design, share by which it falls short"
        )
        for name, rival in {"ours": ours, **RIVALS}.items():
            if not any(part in name for part in given.only):
                continue
            for seed in given.seeds:
                runs = [run(*one, budget, rival, seed) for one in chosen]
                print(told(name, seed, runs, NARROW if given.known else REACHED), flush=True)


if __name__ == "__main__":
    main()
