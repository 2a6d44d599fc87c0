"""The whole trade-off between one output and the absolute value of another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.optimise.exact import closed_front
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.problem import LIMIT, Optima, OptimisationProblem, cells_of
from vibrafeed.core.study.optimise_study import Pareto, Weighted
from vibrafeed.core.study.values import evenly
from vibrafeed.core.watch import Watch

WIDE = 1e3  # of the other output's scale: a limit that never binds
HEAVY = 1e3  # weight that puts the other output first; a steeper ridge is harder to climb along
FLAT = 1e-9
SMALL = 1e-6  # of an output's scale: a smaller difference of two points is that of a search
SLACK = 1e-9  # of its scale, of a limit that only single points would keep


def find_front(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    method: str,
    watch: Watch,
) -> Optima:
    """Return the trade-off front of every design, from the largest output to the least other one.

    Without a closed form both ends are found first, then the largest output at equally spaced
    limits of the other one, all designs and limits at once. The arrays of the result have the shape
    (cells * points,), the points of a design one after the other.
    """
    criterion = problem.criterion
    assert isinstance(criterion, Pareto)
    points = criterion.points
    if method == "exact":
        return closed_front(problem, design, points)
    solve = METHODS[method].solve
    inner, scale = problem.limited(), scales[criterion.against]
    ends = replace(watch, progress=None)  # the many points between them are the progress
    top = solve(inner, {**design, LIMIT: WIDE * scale}, scales, ends)
    # At the other end the other output has a large weight in the objective.
    heavy = Weighted(output=criterion.output, against=criterion.against, weight=HEAVY)
    least = solve(replace(problem, criterion=heavy), design, scales, ends)
    cells = cells_of(design)
    x = np.repeat(least.x[:, :, None], points, axis=2)
    status = np.repeat(least.status[:, None], points, axis=1)
    evaluations = np.ones((cells, points), dtype=np.int64)
    optima = least
    most, there = (_value(problem, criterion.output, end, design) for end in (top, least))
    # Without a trade-off one choice is best in both outputs, and a front is one point.
    rest = np.flatnonzero(~(there >= most - SMALL * scales[criterion.output]))
    if rest.size:
        against = (np.abs(_value(problem, criterion.against, end, design)) for end in (top, least))
        first, last = (one[rest] for one in against)
        levels = first[:, None] + (last - first)[:, None] * evenly(0.0, 1.0, points)
        repeated = {name: np.repeat(values[rest], points) for name, values in design.items()}
        wide = {name: np.repeat(values[rest], points) for name, values in scales.items()}
        limits = np.where(np.isnan(levels), WIDE, levels + SLACK * scale[rest, None])
        optima = solve(inner, {**repeated, LIMIT: limits.ravel()}, wide, watch)
        x[:, rest] = optima.x.reshape(len(problem.names), -1, points)
        status[rest] = optima.status.reshape(-1, points)
        evaluations[rest] = np.broadcast_to(optima.evaluations, limits.size).reshape(-1, points)
        x[:, rest, 0], status[rest, 0] = top.x[:, rest], top.status[rest]
        x[:, rest, -1], status[rest, -1] = least.x[:, rest], least.status[rest]
    return Optima(
        x.reshape(len(problem.names), -1), status.ravel(), evaluations=evaluations.ravel(),
        says=optima.says,
    )  # fmt: skip


def distinct_points(output: Array, other: Array, sizes: Sequence[Array]) -> Array:
    """Return the number of distinct points of each trade-off front, 0 of one without a value.

    `output` and `other` are the two outputs, shape (cells, points), and `sizes` their scales, shape
    (cells, 1); the result has the shape (cells,). A front of one point is no trade-off.
    """
    pairs = zip((output, np.abs(other)), sizes, strict=True)
    moved = [np.abs(np.diff(one, axis=1)) > SMALL * size for one, size in pairs]
    return np.isfinite(output).any(axis=1) + np.logical_or(*moved).sum(axis=1, dtype=np.float64)


def _value(
    problem: OptimisationProblem, name: str, optima: Optima, design: Mapping[str, Array]
) -> Array:
    lost = np.isnan(optima.x).any(axis=0)
    x = np.where(lost, problem.lower[:, None], optima.x)
    value = problem.output(name, problem.known(x, design))
    return np.where(lost, np.nan, np.broadcast_to(value, lost.shape))


def knee(output: Array, other: Array) -> NDArray[np.int8]:
    """Return 1 at the knee of each trade-off front, where it bends most, else 0.

    `output` and `other` are the two outputs, shape (cells, points); the result is int8 of that
    shape. The knee is the point farthest from the chord between the ends, both outputs over their
    range; the first point of a front without range or without values.
    """

    def over_range(values: Array) -> Array:
        low, high = values.min(axis=1, keepdims=True), values.max(axis=1, keepdims=True)
        # A range of rounding is none.
        span = np.where(high - low > FLAT * np.maximum(np.abs(high), np.abs(low)), high - low, 0.0)
        return ratio(values - low, span, 0.0)

    lost = ~(np.isfinite(output) & np.isfinite(other)).all(axis=1, keepdims=True)
    x = over_range(np.where(lost, 0.0, output))
    y = over_range(np.where(lost, 0.0, np.abs(other)))
    # From (1, 1), the largest output, to (0, 0): what lies above the chord is better in both.
    away = x - y
    marks = np.zeros(output.shape, dtype=np.int8)
    marks[np.arange(len(away)), np.argmax(away, axis=1)] = 1
    return marks
