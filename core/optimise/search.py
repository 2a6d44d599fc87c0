"""The global maximum of a function of one to four variables over a box, without derivatives.

For mean velocities of a motion in time and the like: piecewise smooth with jumps, several hills,
and points without a value (theory 12.4). Three steps, each of which evaluates many points at a
time:

1. A grid over the box finds the hills, and closer ones over its faces, as the best velocities often
   lie there: at the largest drive, on hills too narrow for the grid inside.
2. The best cells, at first those that top their neighbours, are sampled on half the scale, and
   again: at every scale the best cells of all go on, wherever they lie.
3. Around the best few points clouds of points climb to the tops (`core.optimise.clouds`).

Random numbers come from a fixed seed, and all designs share them: a search repeats to the last
digit, and a design gets the same answer alone or among others. Points that leave the box are moved
onto its edge, so that maxima on edges and in corners are met exactly.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.mechanics.arrays import Array
from core.optimise import clouds
from core.watch import Watch

Evaluate = Callable[[Array], Array]
"""Takes points (n, d), returns values (n,); what is not finite counts as no value."""

EvaluateMany = Callable[[NDArray[np.intp], Array], Array]
"""The same for points of many designs: takes the number of each one's design (n,) first."""

SearchStatus = Literal["converged", "budget_spent", "flat", "no_value", "stopped"]

MESSAGES: dict[SearchStatus, str] = {
    "converged": "the best hill was followed to the tolerance",
    "budget_spent": "the evaluations or generations were spent before the tolerance was met",
    "flat": "all values are equal",
    "no_value": "no point has a value",
    "stopped": "the search was stopped early",
}

MOST_VARIABLES = 4
FEWEST_EVALUATIONS = 400
SHARE_GRID, SHARE_FACES, SHARE_CELLS = 0.35, 0.2, 0.3  # of the budget; the rest is for clouds
SCALES = 8  # halvings of the second step
SAMPLES = 12  # points of a cell at each
CLOUDS = 8  # at most, at first
NEARBY = 1e-3  # of the width of the box: where `drop` looks


class Found(NamedTuple):
    """What a search found.

    Attributes
    ----------
    point : ndarray, shape (d,)
        The best point evaluated; NaN where none has a value. At a jump it lies on the better side.
    value : float
        Its value.
    drop : float
        What is lost at worst within 1e-3 of the box around it: large on the brink of a jump, and
        inf where a neighbour has no value. NaN if the search was stopped.
    evaluations : int
        Points evaluated.
    levels : int
        Batches they came in.
    status : str
        A key of `MESSAGES`.
    message : str
        The same in words.
    """

    point: Array
    value: float
    drop: float
    evaluations: int
    levels: int
    status: SearchStatus
    message: str


def search_maximum(
    evaluate: Evaluate,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    budget: int,
    tolerance: float = 1e-6,
    watch: Watch | None = None,
) -> Found:
    """Return the largest value that a search of a box finds, and where.

    Parameters
    ----------
    evaluate : callable
        Takes points (n, d), returns values (n,). NaN and infinite: no value there.
    lower, upper : array_like, shape (d,)
        Ends of the box; a variable whose ends are equal is held.
    budget : int
        Most points to evaluate, at least 400.
    tolerance : float
        The search ends when the last cloud is smaller than this share of the box.
    watch : Watch, optional
        Asked before each batch of points.
    """

    def evaluate_many(_: NDArray[np.intp], points: Array) -> Array:
        return evaluate(points)

    ends = (np.atleast_2d(np.asarray(end, dtype=np.float64)) for end in (lower, upper))
    return search_many(evaluate_many, *ends, budget=budget, tolerance=tolerance, watch=watch)[0]


def search_many(
    evaluate: EvaluateMany,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    budget: int,
    tolerance: float = 1e-6,
    watch: Watch | None = None,
) -> list[Found]:
    """Return what `search_maximum` finds for each of many designs, searched side by side.

    Parameters
    ----------
    evaluate : callable
        Takes the numbers of designs (n,) and points (n, d), returns values (n,).
    lower, upper : array_like, shape (m, d)
        Ends of the box of each design.
    budget : int
        Most points to evaluate of each design.
    tolerance, watch
        As in `search_maximum`.
    """
    lower, upper = (np.asarray(end, dtype=np.float64) for end in (lower, upper))
    _check(lower, upper, budget, tolerance)
    search = _Search(evaluate, lower, upper, budget, watch or Watch())
    try:
        sizes = _run(search, tolerance)
    except _StoppedError:
        return [search.found(design, "stopped") for design in range(len(lower))]
    return [
        search.found(design, "converged" if size < tolerance else "budget_spent")
        for design, size in enumerate(sizes)
    ]


def _check(lower: Array, upper: Array, budget: int, tolerance: float) -> None:
    if lower.shape != upper.shape or lower.ndim != 2:
        raise ValueError("lower and upper are of different shapes")
    if not 1 <= lower.shape[1] <= MOST_VARIABLES:
        raise ValueError(f"1 to {MOST_VARIABLES} variables can be searched")
    if not (np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= upper).all()):
        raise ValueError("lower and upper have to be finite, and in order")
    if budget < FEWEST_EVALUATIONS:
        raise ValueError(f"the budget has to be {FEWEST_EVALUATIONS} evaluations or more")
    if not tolerance > 0:
        raise ValueError("the tolerance has to be above 0")


class _StoppedError(Exception):
    """The watch asked to stop."""


class _Search:
    """The designs under search: evaluates points of the unit box and keeps the best."""

    def __init__(
        self, evaluate: EvaluateMany, lower: Array, upper: Array, budget: int, watch: Watch
    ):
        self.evaluate, self.watch, self.budget = evaluate, watch, budget
        self.lower, self.upper = lower, upper
        self.free = np.flatnonzero((upper > lower).any(axis=0))
        designs = len(lower)
        self.point = np.full((designs, self.free.size), np.nan)
        self.value = np.full(designs, -np.inf)
        self.least = np.full(designs, np.inf)
        self.drop = np.full(designs, np.nan)
        self.used = np.zeros(designs, dtype=np.intp)
        self.levels = 0

    def values(self, design: NDArray[np.intp], unit: Array) -> Array:
        """Return the values at points (n, free) of designs (n,); -inf where there is none."""
        if self.watch.stopped():
            raise _StoppedError
        values = np.asarray(self.evaluate(design, self.place(design, unit)), dtype=np.float64)
        if values.shape != design.shape:
            raise ValueError(f"{design.size} points gave values of shape {values.shape}")
        self.watch.advance(design.size / (self.budget * len(self.lower)))
        values = np.where(np.isfinite(values), values, -np.inf)
        self.used += np.bincount(design, minlength=len(self.lower))
        self.levels += 1
        np.minimum.at(self.least, design, values)
        order = np.lexsort((-values, design))  # stable: of equal values the first is kept
        numbers, first = np.unique(design[order], return_index=True)
        first = order[first]
        better = values[first] > self.value[numbers]
        self.point[numbers[better]] = unit[first[better]]
        self.value[numbers[better]] = values[first[better]]
        return values

    def place(self, design: NDArray[np.intp], unit: Array) -> Array:
        """Return points of the unit box (n, free) as points of their designs' boxes (n, d)."""
        lower, upper = self.lower[design], self.upper[design]
        points = lower.copy()
        low, high = lower[:, self.free], upper[:, self.free]
        # Both ends are met exactly.
        points[:, self.free] = np.where(unit == 1, high, low + unit * (high - low))
        return points

    def found(self, design: int, status: SearchStatus) -> Found:
        """Return what is known of one design."""
        value = float(self.value[design])
        point = np.full(self.lower.shape[1], np.nan)
        if math.isfinite(value):
            number = np.array([design])
            point = self.place(number, self.point[number])[0]
            if self.least[design] == value and status != "stopped":
                status = "flat"
        elif status != "stopped":
            status = "no_value"
        if not math.isfinite(value):
            value = math.nan
        drop, used = float(self.drop[design]), int(self.used[design])
        return Found(point, value, drop, used, self.levels, status, MESSAGES[status])


def _run(search: _Search, tolerance: float) -> Array:
    """Carry the search out; return the size of the last cloud of each design."""
    designs, d = search.point.shape
    if d == 0:
        search.values(np.arange(designs), np.empty((designs, 0)))
        search.drop[:] = 0.0
        return np.zeros(designs)
    random = np.random.default_rng(0)
    cells = max(1, int(SHARE_CELLS * search.budget / (SCALES * SAMPLES)))
    points, values, first, step = _grids(search)
    for scale in range(SCALES):
        best = _best_cells(points, first if scale == 0 else values, step, cells)
        centres = np.take_along_axis(points, best[..., None], axis=1)
        spread = random.uniform(-step, step, (best.shape[1], SAMPLES, d))
        nearby = np.clip(centres[:, :, None] + spread, 0.0, 1.0).reshape(designs, -1, d)
        points = np.concatenate([centres, nearby], axis=1)
        values = np.concatenate(
            [np.take_along_axis(values, best, axis=1), _of_all(search, nearby)], axis=1
        )
        step /= 2
    sizes = _follow_clouds(search, points, values, 4 * step, tolerance, random)
    around = np.array([o for o in itertools.product((-1, 0, 1), repeat=d) if any(o)]) * NEARBY
    nearby = np.clip(np.nan_to_num(search.point)[:, None] + around, 0.0, 1.0)
    some = np.isfinite(search.value)
    before = np.where(some, search.value, 0.0)
    search.drop[some] = (before - _of_all(search, nearby).min(axis=1))[some]
    return sizes


def _of_all(search: _Search, points: Array) -> Array:
    """Return the values (m, n) at points (m, n, d) of all designs."""
    designs, count, d = points.shape
    number = np.repeat(np.arange(designs), count)
    return search.values(number, points.reshape(-1, d)).reshape(designs, count)


def _grids(search: _Search) -> tuple[Array, Array, Array, float]:
    """Return points (m, n, d) of the box and of its faces, values, what ranks them, and the step.

    The step is the distance of the points of the box; those of the faces lie closer.
    """
    d = search.point.shape[1]
    size = int((SHARE_GRID * search.budget) ** (1 / d))
    parts = [_grid(search, np.linspace(0.0, 1.0, size), d, None)]
    if d > 1:
        face = int((SHARE_FACES * search.budget / (2 * d)) ** (1 / (d - 1)))
        axis = np.linspace(0.0, 1.0, face)
        ends = itertools.product(range(d), (0.0, 1.0))
        parts += [_grid(search, axis, d, end) for end in ends if face > size]
    points, values, estimates = (np.concatenate(part, axis=1) for part in zip(*parts, strict=True))
    return points, values, estimates, 1 / (size - 1)


def _grid(
    search: _Search, axis: Array, d: int, held: tuple[int, float] | None
) -> tuple[Array, Array, Array]:
    """Return points (m, n, d) of a grid, one variable held or none, values, and what ranks them."""
    axes = [axis] * d
    if held is not None:
        axes[held[0]] = np.array([held[1]])
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    shape = points.shape[:-1]
    designs = len(search.value)
    points = np.broadcast_to(points.reshape(-1, d), (designs, points.size // d, d))
    values = _of_all(search, points)
    box = values.reshape(designs, *shape)
    highest, lowest = box, np.where(np.isfinite(box), box, np.inf)
    for number in range(1, d + 1):
        highest = _widest(highest, number, np.maximum, -np.inf)
        lowest = _widest(lowest, number, np.minimum, np.inf)
    # A point that tops its neighbours may lie beside a peak as much higher than itself as it is
    # above the lowest of them: hills come first, by that estimate.
    tops = np.isfinite(box) & (box >= highest)
    depth = np.where(tops, box, 0.0) - np.where(tops, lowest, 0.0)
    return points, values, (box + depth).reshape(designs, -1)


def _widest(box: Array, axis: int, choose: Callable[..., Array], beyond: float) -> Array:
    """Return the largest (or least) of each cell and its two neighbours along an axis."""
    edge = np.full_like(box.take([0], axis), beyond)
    padded = np.concatenate([edge, box, edge], axis)
    size = box.shape[axis]
    return choose(
        box, choose(padded.take(range(size), axis), padded.take(range(2, size + 2), axis))
    )


def _best_cells(points: Array, values: Array, step: float, count: int) -> NDArray[np.intp]:
    """Return the places (m, count) of the best points (m, n, d), one a cell of size `step`.

    Where there are fewer cells, points of the best cells follow.
    """
    count = min(count, values.shape[1])
    considered = np.argsort(-values, axis=1, kind="stable")[:, : 16 * count]
    cell = np.rint(np.take_along_axis(points, considered[..., None], axis=1) / step).astype(
        np.int64
    )
    mark = cell[..., 0]
    for axis in range(1, cell.shape[-1]):
        mark = mark * 1_000_003 + cell[..., axis]
    order = np.argsort(mark, axis=1, kind="stable")
    sorted_mark = np.take_along_axis(mark, order, axis=1)
    repeated = np.zeros(mark.shape, dtype=np.bool_)
    again = np.zeros_like(repeated)
    again[:, 1:] = sorted_mark[:, 1:] == sorted_mark[:, :-1]
    np.put_along_axis(repeated, order, again, axis=1)
    chosen = np.argsort(repeated, axis=1, kind="stable")[:, :count]
    return np.take_along_axis(considered, chosen, axis=1)


def _follow_clouds(
    search: _Search,
    points: Array,
    values: Array,
    size: float,
    tolerance: float,
    random: np.random.Generator,
) -> Array:
    """Follow the best few points uphill, each by a cloud; return the size of each design's best."""
    designs, _, d = points.shape
    left = search.budget - int(search.used.max()) - 3**d
    count = max(1, min(CLOUDS, left // (4 * clouds.TURN * clouds.Rates.of(d).points)))
    best = _best_cells(points, values, 2 * size, count)
    first = clouds.start(
        np.repeat(np.arange(designs), best.shape[1]),
        np.take_along_axis(points, best[..., None], axis=1).reshape(-1, d),
        np.take_along_axis(values, best, axis=1).ravel(),
        size,
    )
    return clouds.follow(first, search.values, search.value, left, tolerance, random)
