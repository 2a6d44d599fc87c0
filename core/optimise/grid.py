"""Dense grids of candidates: to check what others find, and an optimiser of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.codes import STATUS
from vibrafeed.core.optimise.optima import Optima, status_of
from vibrafeed.core.optimise.problem import OptimisationProblem, cells_of, chosen_cells
from vibrafeed.core.optimise.reliable import most_reliable
from vibrafeed.core.optimise.single import spread
from vibrafeed.core.watch import Watch

FIRST_POINTS = 40_000  # of the first grid of a design
LATER_WIDTH = 9  # points along each variable of a later grid
MAX_GRIDDED = 4  # variables that a grid can have
ROUNDS = 40  # grids, each finer than the one before
SHRINKS = 0.5  # width of a grid over that of the one before
MAX_POINTS = 8_000_000  # of all designs together
REST_POINTS = 81  # of the grid on which rest is looked for, where no choice moves the part
BLOCK = 262_144  # points that are evaluated at a time


def by_grid(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the best point of a grid, then of successively finer grids around it, for each design.

    A point is a choice of the variables. The one with the smallest violation of constraints is
    best, then the one with the largest objective.

    Parameters
    ----------
    design, scales : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters of each design, SI units, and the sizes of its outputs, by which
        violations are divided.
    watch : Watch
        Takes the progress, and may stop the search after a grid.

    Returns
    -------
    Optima
        The best values, shape (variables, cells), NaN where there are none; statuses and numbers of
        evaluations, shape (cells,).
    """
    cells, count = cells_of(design), len(problem.names)
    size = problem.scale(scales)
    low, high = np.zeros((count, cells)), np.ones((count, cells))
    best = np.full((count, cells), np.nan)
    rank = (np.full(cells, np.inf), np.full(cells, -np.inf))
    evaluations = 0
    for number in range(ROUNDS):
        if watch.stopped():
            break
        width = dense_width(count, cells, FIRST_POINTS) if number == 0 else LATER_WIDTH
        shares = np.stack(np.meshgrid(*[np.linspace(0, 1, width)] * count, indexing="ij"))
        shares = shares.reshape(count, 1, -1)
        evaluations += shares.shape[2]
        unit = low[:, :, None] + (high - low)[:, :, None] * shares
        place, beyond, value = _top(problem, unit, design, scales)
        point = np.take_along_axis(unit, place[None, :, None], axis=2)[:, :, 0]
        better = (beyond < rank[0]) | ((beyond == rank[0]) & (value > rank[1]))
        best = np.where(better, point, best)
        rank = np.where(better, beyond, rank[0]), np.where(better, value, rank[1])
        reach = (high - low) * (2 / (width - 1) if number == 0 else SHRINKS / 2)
        low, high = np.maximum(best - reach, 0.0), np.minimum(best + reach, 1.0)
        watch.advance(1 / ROUNDS)
    status = np.array(
        [status_of(v, b, 0.0) for v, b in zip(rank[1] / size, rank[0], strict=True)], dtype=np.int8
    )
    if not evaluations:
        status[:] = STATUS["not_computed"]
    x = problem.lower[:, None] + (problem.upper - problem.lower)[:, None] * best
    x = np.where(status == STATUS["optimal"], x, np.nan)
    return Optima(x, status, evaluations=np.full(cells, evaluations))


def with_best_rest(
    problem: OptimisationProblem,
    optima: Optima,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the optima, with choices at which the part rests where none moves it forwards.

    Closed forms and compiled methods look for forward motion only. Without any, the best is a part
    that rests; where it slides back at every choice, a grid finds the best choice, or that none
    keeps the limits.

    Parameters
    ----------
    optima : Optima
        Results of such a method: points and statuses of all designs.
    design, scales : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters, and the sizes of outputs, by which violations are divided.
    watch : Watch
        Takes the progress, and may stop the grid.
    """
    still = np.flatnonzero((optima.status == STATUS["no_motion"]) & np.isnan(optima.x).any(axis=0))
    if not still.size:
        return optima
    x, status, count = optima.x.copy(), optima.status.copy(), len(problem.names)
    here, sizes = chosen_cells(design, still), chosen_cells(scales, still)
    shares = _filled(count, still.size, REST_POINTS)[:, np.newaxis]
    unit = np.broadcast_to(shares, (count, still.size, shares.shape[2]))
    place, beyond, value = _top(problem, unit, here, sizes)
    rests = (beyond <= 0) & (value >= 0)
    span = (problem.upper - problem.lower)[:, None]
    x[:, still[rests]] = problem.lower[:, None] + span * shares[:, 0, place[rests]]
    if not rests.all():
        others, left = np.flatnonzero(~rests), still[~rests]
        best = by_grid(problem, chosen_cells(here, others), chosen_cells(sizes, others), watch)
        x[:, left], status[left] = best.x, best.status
    return replace(optima, x=x, status=status)


def dense_width(variables: int, cells: int, points: int) -> int:
    """Return the number of points along each variable of a grid with about `points` per design.

    `cells` is the number of designs, whose points together are limited, too; the result is 5 to
    201.
    """
    return max(5, min(201, int(min(points, MAX_POINTS / cells) ** (1 / variables))))


def _filled(variables: int, cells: int, points: int) -> Array:
    """Return points that fill the unit box, shape (variables, n), about `points` of them.

    They are a grid, or an evenly spread sequence for more than four variables, where so coarse a
    grid would hold little but edges. `cells` is the number of designs for which they are used,
    which limits the grid.
    """
    width = dense_width(variables, cells, points)
    if variables > MAX_GRIDDED:
        return spread(points, variables)
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, width)] * variables, indexing="ij"))
    return grid.reshape(variables, -1)


def _top(
    problem: OptimisationProblem,
    unit: Array,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> tuple[Any, Array, Array]:
    """Return index, violation and objective of the best of some points of each design.

    The smallest violation counts first, then the largest objective. `unit` are the points as shares
    of the bounds, shape (variables, cells, n); `design` and `scales` have the fixed parameters and
    the sizes of outputs, by which violations are divided, shape (cells,), as have the results.
    """
    cells = unit.shape[1]
    step = max(1, BLOCK // (unit.shape[2] * problem.nodes))
    position = np.zeros(cells, dtype=np.intp)
    beyond, value = np.empty(cells), np.empty(cells)
    span = (problem.upper - problem.lower)[:, None, None]
    for start in range(0, cells, step):
        piece = slice(start, start + step)
        x = problem.lower[:, None, None] + span * unit[:, piece]
        column = {name: values[piece, None] for name, values in design.items()}
        sizes = {name: values[piece, None] for name, values in scales.items()}
        v, b = problem.judged(x, column, sizes)
        least = b.min(axis=1, keepdims=True)
        v = np.where(b == least, v, -np.inf)
        here = v.argmax(axis=1)
        rows = np.arange(len(here))
        position[piece], beyond[piece], value[piece] = here, b[rows, here], v[rows, here]
    return position, beyond, value


def reliable_grid(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    points: int,
) -> Array:
    """Return the best objective of each design on a grid, for outputs that are means of a motion.

    A motion that does not repeat has a mean with a statistical error: the best points are followed
    for longer before one is chosen. It is a check on the methods of search.

    Parameters
    ----------
    design, scales : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters, and the sizes of the outputs, by which violations are divided.
    points : int
        The number of points for each design.

    Returns
    -------
    ndarray, shape (cells,)
        -inf where no point keeps the constraints.
    """
    count, cells = len(problem.names), cells_of(design)
    unit = _filled(count, cells, points)
    x = problem.lower[:, None] + (problem.upper - problem.lower)[:, None] * unit
    best = np.full(cells, -np.inf)
    for cell in range(cells):
        here = slice(cell, cell + 1)
        inputs, sizes = chosen_cells(design, here), chosen_cells(scales, here)
        judged = problem.judged_with_error(x, inputs, sizes)
        if judged[1].min() <= 0:
            best[cell] = most_reliable(problem, unit, judged, inputs, sizes)[1]
    return best


def dense_grid(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    points: int,
) -> Array:
    """Return the best objective of each design on a dense grid, to check methods of search.

    At most `points` points are evaluated for a design. `design` and `scales` hold the fixed
    parameters and the sizes of the outputs, by which violations are divided, each of shape
    (cells,). The result has the shape (cells,), -inf where no point keeps the constraints.
    """
    count, cells = len(problem.names), cells_of(design)
    shares = _filled(count, cells, points)[:, np.newaxis]
    unit = np.broadcast_to(shares, (count, cells, shares.shape[2]))
    _, beyond, value = _top(problem, unit, design, scales)
    return np.where(beyond <= 0, value, -np.inf)
