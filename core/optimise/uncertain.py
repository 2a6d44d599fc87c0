"""Values under what is not known: the worst case, the mean or a quantile (theory 12.4).

The best of many candidates at some points owes part of its value to these points. At others, drawn
from the same distributions, nothing favours it: mean, quantile and the share of units that break a
limit are true there, with errors from independent scramblings, as in a study of sensitivity.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.optimise.problem import (
    How,
    OptimisationProblem,
    OutputBound,
    Uncertain,
    cells_of,
    chosen_cells,
)
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plan.statistics import (
    REPLICATES,
    Estimate,
    fraction_of,
    mean_and_deviation,
    points,
    probability,
    quantiles,
    values_at,
)
from vibrafeed.core.study.distributions import Distribution, tolerance
from vibrafeed.core.study.values import Between

NODES = 9  # over the interval of an uncertain parameter
SAMPLES = 64  # points drawn from distributions, for all candidates of a search
BEYOND = 3.2  # of these points lie beyond a quantile, at least
LEAST_SHARE = 1e-3  # of a quantile, from either end: a rarer one takes too many points
SEED = 0  # of the points of a search
LEVELS = {1: NODES, 2: 5, 3: 3}
"""Nodes of each of so many parameters, all with all, for the worst case; of more the two ends."""
MAX_UNCERTAIN = 6


def uncertain_of(
    distributions: Mapping[str, Distribution],
    how: How,
    quantile: float | None,
    *,
    is_limited: bool = False,
) -> Uncertain:
    """Return the points of uncertain parameters at which each candidate of an optimum is judged.

    The worst case has points all over the box of the tolerances, ends included. Mean and quantile
    have points that are sampled once for all candidates, or those of Gauss for the mean over one
    interval; if limits are to be kept, the points of the box come after them.
    """
    (name, distribution), *others = distributions.items()
    level = 0.5 if quantile is None else quantile
    weights = None
    if how == "worst":
        return Uncertain(distributions, _tolerance_box(distributions), how)
    if how == "mean" and not others and isinstance(distribution, Between):
        low, high = parameter_to_si(name, np.array([distribution.lower, distribution.upper]))
        # Gauss-Legendre quadrature, whose weights add up to 2.
        roots, weights = np.polynomial.legendre.leggauss(NODES)
        values, weights = {name: low + (high - low) * (roots + 1) / 2}, weights / 2
    else:
        count = samples_of(how, level)
        values = values_at(distributions, points(len(distributions), count, SEED)[:, 0])
    uncertain = Uncertain(distributions, values, how, weights, level)
    if not is_limited:
        return uncertain
    return replace(uncertain.with_nodes(_tolerance_box(distributions)), in_statistic=uncertain.size)


def samples_of(how: How, quantile: float) -> int:
    """Return the number of sampled points for a mean or a quantile, a power of two."""
    rare = min(quantile, 1 - quantile) if how == "quantile" else 0.5
    return max(SAMPLES, 1 << math.ceil(math.log2(BEYOND / rare)))


def _tolerance_box(distributions: Mapping[str, Distribution]) -> dict[str, Array]:
    # All combinations of evenly spaced values of the tolerances, SI units; of the two ends alone
    # the middle is added.
    count = len(distributions)
    levels = np.linspace(0.0, 1.0, LEVELS.get(count, 2))
    nodes = np.array(list(product(levels, repeat=count)))
    if levels.size == 2:
        nodes = np.concatenate([nodes, np.full((1, count), 0.5)])
    values = {}
    for (name, distribution), fractions in zip(distributions.items(), nodes.T, strict=True):
        lower, upper = tolerance(name, distribution)
        values[name] = parameter_to_si(name, lower + (upper - lower) * fractions)
    return values


TIMES, TIMES_MOTION = 16, 4  # the points of a search in each scrambling; motions take long
BLOCK = 1 << 18  # evaluations at a time, which bounds the memory
CLOSE = 1e-4
"""Of an output's scale: a limit that fresh points break by less is kept."""

OBJECTIVE = "objective"


@dataclass(frozen=True)
class FreshEvaluation:
    """Optima judged at fresh points of the uncertain parameters; arrays of shape (cells,).

    Attributes
    ----------
    points : mapping of str to ndarray
        The points: values of each parameter, SI units, shape (points,).
    objective : Estimate
        The mean or the quantile of the objective to maximise; its least value for the worst case.
    left_out : ndarray
        Share of the points at which the objective has no value.
    broken : mapping of str to Estimate
        The probability that a unit breaks each constraint, by name. No value breaks it.
    worst : mapping of str to ndarray
        The least margin of each constraint over the points within all tolerances, by name; -inf
        where there is no value. In a worst case the objective is among them.
    worst_at : mapping of str to ndarray of int
        The indices of the points of each of these, shape (cells, sets): the worst in each
        scrambling.
    """

    points: Mapping[str, Array]
    objective: Estimate
    left_out: Array
    broken: Mapping[str, Estimate]
    worst: Mapping[str, Array]
    worst_at: Mapping[str, NDArray[np.intp]]

    def worse_than_nodes(
        self,
        problem: OptimisationProblem,
        x: Array,
        design: Mapping[str, Array],
        scales: Mapping[str, Array],
    ) -> tuple[Mask, dict[int, dict[str, Array]]]:
        """Return the designs in which fresh points are worse than the nodes of the search.

        They break a constraint, or, of closed forms, have a worse worst case. Arguments as in
        `evaluated_at_fresh_points`.
        """
        without_optimum = np.isnan(x).any(axis=0)
        worse = {
            constraint.name: (self.worst[constraint.name] < -CLOSE * scales[constraint.output])
            & ~without_optimum
            for constraint in problem.constraints
        }
        broken: Mask = np.any([*worse.values(), np.zeros_like(without_optimum)], axis=0)
        if OBJECTIVE in self.worst and not problem.is_motion:
            by_nodes = problem.judged(lower_bounds_where_missing(problem, x), design, scales)[0]
            worse[OBJECTIVE] = self.worst[OBJECTIVE] < by_nodes - CLOSE * problem.scale(scales)
            worse[OBJECTIVE] &= ~without_optimum
        cells = np.flatnonzero(np.any([*worse.values(), broken], axis=0)).tolist()
        worst_points = {
            cell: np.concatenate(
                [self.worst_at[name][cell] for name, is_worse in worse.items() if is_worse[cell]]
            )
            for cell in cells
        }
        return broken, {
            cell: {name: values[indices] for name, values in self.points.items()}
            for cell, indices in worst_points.items()
        }

    def at_worst(self, name: str) -> dict[str, Array]:
        """Return the uncertain parameters at the worst points, SI units, shape (sets, cells)."""
        return {
            parameter: values[self.worst_at[name].T] for parameter, values in self.points.items()
        }


def with_fresh_nodes(problem: OptimisationProblem) -> OptimisationProblem:
    """Return a problem whose nodes are one scrambling of the fresh points, to draw it.

    The worst case, and motions, which take long, keep their nodes.
    """
    if problem.uncertain is None or not problem.is_sampled or problem.is_motion:
        return problem
    fresh, _ = _fresh_points(problem.uncertain, False, SEED + 1)
    values = {name: numbers[: fresh.size // REPLICATES] for name, numbers in fresh.values.items()}
    return replace(problem, uncertain=replace(fresh, values=values))


def lower_bounds_where_missing(problem: OptimisationProblem, x: Array) -> Array:
    """Return choices with the lower bounds where there is no optimum, so that all have outputs."""
    return np.where(np.isnan(x).any(axis=0), problem.lower[:, None], x)


def evaluated_at_fresh_points(
    problem: OptimisationProblem,
    x: Array,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    tolerance: float,
    number: int = 1,
) -> FreshEvaluation:
    """Return statistic, margins and broken fractions of choices at fresh uncertain parameters."""
    assert problem.uncertain is not None
    x = lower_bounds_where_missing(problem, x)
    fresh, in_tolerances = _fresh_points(problem.uncertain, problem.is_motion, SEED + number)
    problem_at_points = replace(problem, uncertain=fresh)
    cells, cells_at_a_time = cells_of(design), max(1, BLOCK // fresh.size)
    pieces = [slice(start, start + cells_at_a_time) for start in range(0, cells, cells_at_a_time)]
    parts = [
        _evaluated_piece(problem_at_points, x[:, piece], chosen_cells(design, piece), in_tolerances,
                {n: tolerance * size[piece] for n, size in scales.items()})
        for piece in pieces
    ]  # fmt: skip

    def joined_estimates(parts: list[Estimate]) -> Estimate:
        return Estimate(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))

    return FreshEvaluation(
        fresh.values,
        joined_estimates([part.objective for part in parts]),
        np.concatenate([part.left_out for part in parts]),
        {name: joined_estimates([part.broken[name] for part in parts]) for name in parts[0].broken},
        {name: np.concatenate([part.worst[name] for part in parts]) for name in parts[0].worst},
        {name: np.concatenate([part.worst_at[name] for part in parts]) for name in parts[0].worst},
    )


def _fresh_points(uncertain: Uncertain, is_motion: bool, seed: int) -> tuple[Uncertain, Mask]:
    # New points in scramblings of their own, and which of them are within all tolerances.
    distributions = uncertain.distributions
    factor = TIMES_MOTION if is_motion else TIMES
    count = factor * samples_of(uncertain.how, uncertain.quantile)
    fractions = points(len(distributions), count, seed, REPLICATES).reshape(len(distributions), -1)
    values = values_at(distributions, fractions)
    in_tolerances = np.ones(fractions.shape[1], dtype=np.bool_)
    for name, distribution in distributions.items():
        lower, upper = parameter_to_si(name, np.array(tolerance(name, distribution)))
        in_tolerances &= (values[name] >= lower) & (values[name] <= upper)
    return replace(uncertain, values=values, weights=None, in_statistic=None), in_tolerances


def _evaluated_piece(
    problem: OptimisationProblem,
    x: Array,
    design: Mapping[str, Array],
    in_tolerances: Mask,
    allowed: Mapping[str, Array],
) -> FreshEvaluation:
    uncertain = problem.uncertain
    assert uncertain is not None
    design_at_points = problem.at_nodes(design, x)
    quantities = problem.quantities(x, design_at_points, plan=problem.bare)
    shape = (cells_of(design), uncertain.size)

    def by_cell(values: Array) -> Array:
        return np.broadcast_to(values, shape[::-1]).T

    values = by_cell(problem.objective(quantities))
    margins = {
        constraint.name: by_cell(problem.margin(constraint, quantities, design_at_points))
        for constraint in problem.constraints
    }
    ranked = dict(margins)
    if uncertain.how == "worst":
        ranked[OBJECTIVE] = values
    # Points beyond the tolerances do not count as a worst case; one without a value is the worst.
    ranked = {
        name: np.where(
            in_tolerances, np.where(np.isnan(values_of_one), -np.inf, values_of_one), np.inf
        )
        for name, values_of_one in ranked.items()
    }
    # Each scrambling of the points is a set of its own, along the second axis.
    in_sets = (shape[0], REPLICATES, -1)
    set_starts = np.arange(0, uncertain.size, uncertain.size // REPLICATES)
    worst_at = {
        name: set_starts + values_of_one.reshape(in_sets).argmin(axis=2)
        for name, values_of_one in ranked.items()
    }
    bounds: dict[str, OutputBound] = {
        constraint.name: constraint for constraint in problem.constraints
    }
    return FreshEvaluation(
        uncertain.values,
        _objective(uncertain, values.reshape(in_sets), problem.sign),
        np.asarray(fraction_of(np.isnan(values.reshape(in_sets)))),
        {
            name: probability(
                ~(values_of_one >= -allowed[bounds[name].output][:, None]).reshape(in_sets)
            )
            for name, values_of_one in margins.items()
        },
        {name: values_of_one.min(axis=1) for name, values_of_one in ranked.items()},
        worst_at,
    )


def _objective(uncertain: Uncertain, values: Array, sign: float) -> Estimate:
    if uncertain.how == "mean":
        return mean_and_deviation(values)[0]
    quantile = uncertain.quantile if sign > 0 else 1 - uncertain.quantile
    level = 0.0 if uncertain.how == "worst" else quantile
    value, error = quantiles(values, np.array([level]))
    return Estimate(value[0], error[0])
