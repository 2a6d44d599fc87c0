"""Optimisers on the same designs: gap of the objective and error of the variables, over time."""

from __future__ import annotations

import importlib
import math
import statistics
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.assurance.accuracy.cells import SEED, random_cells, sample_size
from vibrafeed.core.assurance.accuracy.curves import Curve, Measured, Point
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.methods import METHODS, refusal
from vibrafeed.core.optimise.optima import STATUS
from vibrafeed.core.optimise.optimisation import Optimisation
from vibrafeed.core.optimise.problem import LIMIT, OptimisationProblem, cells_of, chosen_cells
from vibrafeed.core.optimise.run import with_limit
from vibrafeed.core.study.optimise_study import Pareto
from vibrafeed.core.watch import Watch

DESIGNS = 20
DESIGNS_MOTION = 4
REPEATS = 5
SHORT = 0.1  # s; what takes longer is timed once
MISSED = 1e-4
"""A design whose objective is farther from the best, as a share of its scale, was missed."""
FRONT_LIMIT = 0.25  # of the other output's scale: the point of a front that is compared


@dataclass(frozen=True)
class OptimiserResult:
    """The result of a method for some designs.

    Attributes
    ----------
    value : ndarray, shape (cells,)
        Objective at the variables found; -inf where none were.
    x : ndarray, shape (variables, cells)
        Those variables, SI units.
    seconds : float
        Wall time for one design.
    evaluations : ndarray, shape (cells,)
        Points at which the outputs were computed.
    done : ndarray of bool, shape (cells,)
        The designs that were reached before it was stopped.
    """

    value: Array
    x: Array
    seconds: float
    evaluations: Array
    done: NDArray[np.bool_]


def run_optimiser(
    name: str,
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
    seconds: float = math.inf,
) -> OptimiserResult:
    """Run a method of optimisation on some designs; return results and the time of a design.

    A method that solves all designs at once is run on the first one before, so that no compilation
    is timed. Fast runs are repeated, and the median time counts.

    Parameters
    ----------
    name : str
        The method, a key of `METHODS`.
    problem : OptimisationProblem
        Variables with bounds, criterion and constraints.
    design, scales : mapping of str to ndarray
        Fixed parameters of the designs in SI units, shape (designs,), and the largest size of each
        output over the bounds.
    watch : Watch
        May stop it; designs that were not reached are not `done`.
    seconds : float
        Time after which it is stopped [s].
    """
    solve, first = METHODS[name].solve, slice(0, 1)
    if METHODS[name].at_once:
        cell = chosen_cells(design, first), chosen_cells(scales, first)
        solve(problem, *cell, replace(watch, progress=None))
    else:
        importlib.import_module("scipy.optimize")
    late = min(time.monotonic() + seconds, watch.deadline or math.inf)
    started = time.perf_counter()
    watch = replace(watch, progress=None, deadline=late)
    optimum = solve(problem, design, scales, watch)
    times = [time.perf_counter() - started]
    cells = cells_of(design)
    done = np.asarray(optimum.status != STATUS["not_computed"])
    while done.all() and times[0] < SHORT and len(times) < REPEATS and not watch.stopped():
        started = time.perf_counter()
        solve(problem, design, scales, watch)
        times.append(time.perf_counter() - started)
    seconds = statistics.median(times) / max(1, done.sum())
    lost = np.isnan(optimum.x).any(axis=0)
    x = np.where(lost, problem.lower[:, None], optimum.x)
    value = np.broadcast_to(problem.judged(x, design, scales)[0], cells)
    used = np.broadcast_to(np.asarray(optimum.evaluations, dtype=np.float64), cells)
    return OptimiserResult(np.where(lost, -np.inf, value), optimum.x, seconds, used, done)


def measure(
    optimisation: Optimisation, watch: Watch, seconds: float, methods: Collection[str] = METHODS
) -> Measured:
    """Measure error against time of the methods of optimisation on a study's problem.

    Each method solves the same random designs. The reference is an exact method where there is one,
    else the best that any method found; of a Pareto front one point is compared.

    Parameters
    ----------
    optimisation : Optimisation
        The prepared study.
    watch : Watch
        May stop it: what was measured by then is kept.
    seconds : float
        Time that all methods share [s].
    methods : collection of str
        Names of the methods to compare; those that cannot solve the problem are left out.
    """
    problem = optimisation.problem
    notes = []
    count = DESIGNS_MOTION if problem.is_motion else DESIGNS
    grid = optimisation.designs
    count = sample_size(grid, count)
    given = random_cells(grid, count, [*grid.axes, *grid.fixed])
    design = with_limit(problem, given, count)
    scales = problem.scales(design)
    if isinstance(problem.criterion, Pareto):
        against = problem.criterion.against
        problem = problem.limited()
        design = {**design, LIMIT: FRONT_LIMIT * scales[against]}
        notes.append(
            f"Of the front, the point is compared at which |{against}| is at most "
            f"{FRONT_LIMIT:g} of its scale."
        )
    names = [name for name in methods if refusal(name, problem) is None]
    results, late = _results_of(names, problem, design, scales, watch, seconds)
    if not results:
        return Measured("optimisers", (), ("It was stopped before the first method.",))
    best, x, note = _reference(results)
    notes.append(note)
    answered = np.isfinite(best)
    notes.insert(
        0,
        f"{count} different random designs of {grid.cells:,} (seed {SEED}), {answered.sum()} of "
        "them with an answer. Gap: of the objective, as a share of its scale, the largest size of "
        "the output over the bounds. Error of the variables: distance to the reference's, as a "
        "share of their range; where the objective hardly depends on them it is large and does "
        f"not matter. Missed: a gap above {MISSED:g}. Time: wall time for one design, all designs "
        "in one call.",
    )
    if late:
        notes.append(f"Stopped before all designs were done: {', '.join(late)}.")
    if not answered.any():
        return Measured("optimisers", (), (*notes, "No design has an answer."))
    size = np.broadcast_to(problem.scale(scales), answered.shape)
    span = (problem.upper - problem.lower)[:, None]
    used = {name: answered & result.done for name, result in results.items()}
    points = [
        _point(name, result, best, size, (np.abs(result.x - x) / span).max(axis=0), used[name])
        for name, result in results.items()
        if used[name].any()
    ]
    curves = (
        Curve("optimisers", problem.criterion.output, result.setting, (result,))
        for result in points
    )
    return Measured("optimisers", tuple(curves), tuple(notes))


def _results_of(
    names: Collection[str],
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
    seconds: float,
) -> tuple[dict[str, OptimiserResult], list[str]]:
    """Run methods of optimisation one after another, for a comparison of their gaps and times.

    The time that is left is shared equally among the methods that are still to run.

    Parameters
    ----------
    names : collection of str
        The methods.
    problem : OptimisationProblem
        Variables with bounds, criterion and constraints.
    design, scales : mapping of str to ndarray, shape (designs,)
        Fixed parameters of the designs in SI units; largest size of each output over the bounds.
    watch : Watch
        May stop it.
    seconds : float
        Time for all methods [s].

    Returns
    -------
    tuple of (dict, list)
        Results by method; methods that did not finish all designs.
    """
    results: dict[str, OptimiserResult] = {}
    ends = time.monotonic() + seconds
    for position, name in enumerate(names):
        if watch.stopped():
            break
        # What a fast method leaves over, the slow ones after it share.
        each = (ends - time.monotonic()) / (len(names) - position)
        results[name] = run_optimiser(name, problem, design, scales, watch, max(each, 0.0))
        watch.advance(1 / len(names))
    done = {name for name, result in results.items() if result.done.all()}
    return results, [name for name in names if name not in done]


def _reference(
    results: Mapping[str, OptimiserResult],
) -> tuple[Array, Array, str]:
    """Return the reference of an optimiser benchmark: best objective and variables of each design.

    It is the result of the exact method where it has one; else the best of all methods in
    `results`. The third member is a sentence for the report on what the reference is.
    Shapes (designs,) and (variables, designs), variables in SI units.
    """
    values = np.stack([result.value for result in results.values()])
    winner = np.asarray(values.argmax(axis=0))
    best = values.max(axis=0)
    x = np.stack([result.x for result in results.values()])[winner, :, np.arange(winner.size)].T
    if "exact" not in results:
        return best, x, (
            "Reference: the best that any method found, since there is no exact answer; a gap that "
            "all share would not show."
        )  # fmt: skip
    exact = results["exact"]
    has = np.isfinite(exact.value)
    note = "Reference: the closed form (method exact); its own gap is 0 by definition."
    return np.where(has, exact.value, best), np.where(has, exact.x, x), note


def _point(
    name: str,
    result: OptimiserResult,
    best: Array,
    size: Array,
    apart: Array,
    used: NDArray[np.bool_],
) -> Point:
    """Return the accuracy of an optimiser over several designs, as one point of a comparison.

    The gap is |best - value|/size; where no value was found, it is infinite. The point has the
    median and largest gap, the time of one design [s], the median of `apart` (1 where no value was
    found), the share of designs with a gap above `MISSED`, and the median number of evaluations.

    Parameters
    ----------
    name : str
        Name of the optimiser.
    result : OptimiserResult
        Its optimum of every design.
    best, size : ndarray, shape (designs,)
        Best known value of the objective and its typical size, in one unit.
    apart : ndarray, shape (designs,)
        Largest distance of a variable from the best one, as a share of its range; may be NaN.
    used : ndarray of bool, shape (designs,)
        True for the designs that count.
    """
    lost = ~np.isfinite(result.value[used])
    value = np.where(lost, best[used], result.value[used])
    gap = np.where(lost, np.inf, np.abs(best[used] - value) / size[used])
    apart = np.where(np.isnan(apart[used]), 1.0, apart[used])  # 1 where it found nothing
    more = {
        "variable_error": float(np.median(apart)),
        "missed": float(np.mean(gap > MISSED)),
        "evaluations": float(np.median(result.evaluations[used])),
    }
    median, largest = float(np.median(gap)), float(gap.max())
    return Point(name, np.nan, median, largest, result.seconds, int(used.sum()), more)
