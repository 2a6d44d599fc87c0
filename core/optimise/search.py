"""The global maximum of a function of one to eight variables over a box, without derivatives.

For mean velocities of a motion in time and the like: piecewise smooth with jumps, several hills,
and points without a value (theory 12.4). scipy's differential evolution from a population that
fills the box, and again from others until the evaluations are spent.

The populations live in a box that is wider, and points outside are moved onto the edge, where the
best velocities often lie: maxima on edges and in corners are met exactly. Random numbers come from
a fixed seed: a search repeats to the last digit.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.watch import Watch

Evaluate = Callable[[Array], Array]
"""Takes points (n, d), returns values (n,); what is not finite counts as no value."""

SearchStatus = Literal["converged", "budget_spent", "flat", "no_value", "stopped"]

MESSAGES: dict[SearchStatus, str] = {
    "converged": "a population closed in on the best point to the tolerance",
    "budget_spent": "the evaluations were spent before the tolerance was met",
    "flat": "all values are equal",
    "no_value": "no point has a value",
    "stopped": "the search was stopped early",
}

MAX_VARIABLES = 8
FEW = 4  # variables up to which all corners of a neighbourhood are evaluated
FEWEST_EVALUATIONS = 400  # the smallest budget
MEMBERS = 64  # of a population: a power of 2, as Sobol's points that fill the box come in these
CLOSE = 0.05  # of the box: distance from the best point within which the last population starts
BEYOND = 0.05  # of the box: what it is widened by on each side
NEARBY = 1e-3  # of the width of the box: distance at which `drop` is taken


class SearchResult(NamedTuple):
    """The result of a search.

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
    status : str
        A key of `MESSAGES`.
    message : str
        The same in words.
    """

    point: Array
    value: float
    drop: float
    evaluations: int
    status: SearchStatus
    message: str


def search_maximum(
    evaluate: Evaluate,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    budget: int,
    tolerance: float = 1e-6,
    seed: int = 0,
    watch: Watch | None = None,
) -> SearchResult:
    """Return the largest value of a function that a search of a box finds, and its point.

    It is for functions with jumps and several maxima, such as mean velocities.

    Parameters
    ----------
    evaluate : callable
        Returns the values, shape (n,), at points, shape (n, d); NaN or infinite without a value.
    lower, upper : array_like, shape (d,)
        Ends of the box; a variable whose ends are equal is held.
    budget : int
        The largest number of points to evaluate, at least 400.
    tolerance : float
        A population that is narrower than this share of the box has converged: another one starts.
    seed : int
        Seed of the random numbers.
    watch : Watch, optional
        May stop the search between batches of points.

    Returns
    -------
    SearchResult
        Best point, shape (d,), and its value, NaN without one; the largest loss beside it, infinite
        on the brink of a jump; number of evaluations, status and message.
    """
    lower, upper = (np.asarray(end, dtype=np.float64) for end in (lower, upper))
    _check(lower, upper, budget, tolerance)
    search = _Search(evaluate, lower, upper, watch or Watch())
    status: SearchStatus = "converged"
    try:
        if search.free.size:
            status = _evolve(search, budget - len(search.around), tolerance, seed)
        search.look_around()
    except _StoppedError:
        status = "stopped"
    return search.result_of(status)


def _check(lower: Array, upper: Array, budget: int, tolerance: float) -> None:
    """Raise ValueError for an invalid box, budget or tolerance.

    `lower` and `upper` are the ends of the box, shape (variables,).
    """
    if lower.shape != upper.shape or lower.ndim != 1:
        raise ValueError(
            "the arguments lower and upper have different shapes; give one bound of each "
            "for every variable"
        )
    if not 1 <= lower.size <= MAX_VARIABLES:
        raise ValueError(f"the search takes 1 to {MAX_VARIABLES} variables")
    if not (np.isfinite(lower).all() and np.isfinite(upper).all() and (lower <= upper).all()):
        raise ValueError(
            "the arguments lower and upper, the bounds of the variables, have to be finite, "
            "and lower at most upper"
        )
    if budget < FEWEST_EVALUATIONS:
        raise ValueError(f"the argument budget has to be at least {FEWEST_EVALUATIONS} evaluations")
    if not tolerance > 0:
        raise ValueError("the argument tolerance has to be a number above 0")


class _StoppedError(Exception):
    """The watch asked to stop."""


class _SpentError(Exception):
    """The next batch would go beyond the budget."""


class _Search:
    """Evaluates points of the unit box of the variables that are not held; keeps the best."""

    def __init__(self, evaluate: Evaluate, lower: Array, upper: Array, watch: Watch):
        """Search a function in a box; variables with equal bounds are held fixed."""
        self.evaluate, self.watch = evaluate, watch
        self.lower, self.upper = lower, upper
        self.free = np.flatnonzero(upper > lower)
        self.point = np.full(self.free.size, np.nan)
        self.value, self.least, self.drop = -math.inf, math.inf, math.nan
        self.used = 0

    def values(self, unit: Array) -> Array:
        """Return the values of the function to maximise at points; -inf without a value.

        `unit` are the points, shape (n, variables that are not held fixed), as shares of their
        bounds; the result has the shape (n,). Evaluations are counted, and the best point so far is
        kept in `point` and `value`.

        Raises
        ------
        _StoppedError
            If the watch stops the search.
        ValueError
            If the function returns another number of values.
        """
        if self.watch.stopped():
            raise _StoppedError
        values = np.asarray(self.evaluate(self.points_in_box(unit)), dtype=np.float64)
        if values.shape != unit.shape[:1]:
            raise ValueError(
                f"the function returned values of shape {values.shape} for {len(unit)} "
                "points; it has to return one value per point"
            )
        values = np.where(np.isfinite(values), values, -np.inf)
        self.used += len(unit)
        self.least = min(self.least, float(values.min()))
        best = int(values.argmax())
        if values[best] > self.value:
            self.point, self.value = unit[best], float(values[best])
        return values

    def points_in_box(self, unit: Array) -> Array:
        """Return points of the unit box as values of all variables, shape (n, variables).

        `unit` has the shape (n, free variables), those whose bounds differ; both bounds are met
        exactly.
        """
        points = np.tile(self.lower, (len(unit), 1))
        low, high = self.lower[self.free], self.upper[self.free]
        points[:, self.free] = np.where(unit == 1, high, low + unit * (high - low))
        return points

    @cached_property
    def around(self) -> Array:
        """The directions from a point to its neighbours in a search, shape (n, free variables).

        They are all combinations of -1, 0 and 1, or the point and its axes if the variables are
        many.
        """
        if self.free.size > FEW:
            axes = np.eye(self.free.size)
            return np.concatenate([np.zeros_like(axes[:1]), axes, -axes])
        return np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=self.free.size)))

    def look_around(self) -> None:
        """Evaluate the neighbours of the best point, and set `drop` to the largest loss there.

        They lie 1e-3 of the box away.
        """
        nearby = self.values(np.clip(np.nan_to_num(self.point) + NEARBY * self.around, 0.0, 1.0))
        self.drop = self.value - float(nearby.min())

    def result_of(self, status: SearchStatus) -> SearchResult:
        """Return the result of the search so far, with the best point and its value.

        It has, too, the largest loss beside that point and the number of evaluations. `status`
        becomes flat or no_value where that fits. Without a value the point is NaN.
        """
        point, value = np.full(self.lower.size, np.nan), math.nan
        if math.isfinite(self.value):
            point, value = self.points_in_box(self.point[None])[0], self.value
        if status != "stopped" and self.least == self.value:
            status = "flat" if math.isfinite(value) else "no_value"
        return SearchResult(point, value, self.drop, self.used, status, MESSAGES[status])


def parts_of(variables: int) -> int:
    """Return the number of populations into which the evaluations are divided.

    It is 1 for one or two variables, then 3, 5 and 7: several populations start from all over the
    box, since one alone may end on a lower hill, and the last starts around the best point.
    """
    return 2 * math.ceil(variables / 2) - 1


def _around(point: Array, random: np.random.Generator) -> Array:
    """Return a population around a point of the unit box, including the point, shape (64, d)."""
    away = CLOSE * random.uniform(-1, 1, (MEMBERS, point.size))
    away[0] = 0.0
    return np.clip(np.nan_to_num(point, nan=0.5) + away, -BEYOND, 1 + BEYOND)


def _evolve(search: _Search, budget: int, tolerance: float, seed: int) -> SearchStatus:
    """Evolve populations one after another until the budget is used; return the status.

    The status is ``"converged"`` if a population that found the best point narrowed to less than
    `tolerance`, a share of the box, else ``"budget_spent"``. `search` evaluates the points and
    keeps the best one, `budget` is their largest number, `seed` that of the random numbers.
    """

    def lost(wide: Array) -> Array:
        """Return the negated values of a population, shape (free, n), for scipy to minimise.

        Raises `_SpentError` when the budget is used up.
        """
        if search.used + wide.shape[1] > budget:
            raise _SpentError
        return -search.values(np.clip(wide.T, 0.0, 1.0))

    def narrow(result: Any) -> bool:
        """True if the population is narrower than the tolerance."""
        return bool(np.ptp(np.clip(result.population, 0.0, 1.0), axis=0).max() < tolerance)

    def over(intermediate_result: Any) -> bool:
        """True if the population is narrow, or its share of the evaluations is used up."""
        late = search.used - begun >= each and each < budget
        return late or narrow(intermediate_result)

    each = budget / parts_of(search.free.size)
    random, top = np.random.default_rng(seed), -math.inf
    try:
        while True:
            begun = search.used
            last = each < budget and budget - begun <= 1.5 * each
            ended = scipy.optimize.differential_evolution(
                lost,
                [(-BEYOND, 1 + BEYOND)] * search.free.size,
                strategy="best1bin",
                popsize=MEMBERS // search.free.size,  # a variable; scipy goes up to a power of 2
                maxiter=budget,
                init=_around(search.point, random) if last else "sobol",
                tol=0.0,  # of values: those of a flat stretch are equal
                callback=over,
                polish=False,
                vectorized=True,
                updating="deferred",
                rng=random,
            )
            if narrow(ended):
                top = max(top, -float(ended.fun))
    except _SpentError:
        return "converged" if top == search.value else "budget_spent"
    except RuntimeError as error:
        raise error.__cause__ or error from None  # scipy's own words hide those of the objective
