"""scipy's optimisers, and the search that is made of one of them: one design after the other.

scipy is loaded when one of them runs.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.codes import STATUS
from vibrafeed.core.optimise.optima import Optima, Solver, status_of
from vibrafeed.core.optimise.problem import OptimisationProblem, cells_of, chosen_cells
from vibrafeed.core.optimise.search import parts_of, search_maximum
from vibrafeed.core.optimise.single import NO_VALUE, Single, spread
from vibrafeed.core.watch import Watch

DesignSearch = Callable[[Single], tuple[Array, str]]
"""Takes one design; returns the best point of the unit box, and what the method says."""

STARTS = 8  # starts of the optimisers that follow slopes
SAMPLES = 256  # points whose best are starts
DENSE = 129  # points of the search over one variable
MAX_DIRECT = 20_000  # points of a design that dividing rectangles may take
SEARCH_BUDGET = 12_000
"""Points of a design that the search for outputs that jump may take, of one or two variables."""


class SearchStoppedError(Exception):
    """The watch asked to stop amid a design."""


def _starts(single: Single, count: int = STARTS) -> Array:
    """Return points from which a method that follows slopes is started, shape (count, variables).

    They are shares of the bounds: half are the best of 256 evenly spread points, half far apart, so
    that not all lead to one local maximum. `single` is the problem of one design.
    """
    points = spread(SAMPLES, single.variables)
    value, beyond = single.judged(points)
    order = np.lexsort((-value, beyond))
    # Half of them are the best, half are far apart.
    best = order[: count - count // 2]
    return points[:, np.concatenate([best, np.arange(count // 2)])].T


class _Smooth:
    """The problem without kinks: max output - w t with t >= |other|, for methods with slopes."""

    def __init__(self, single: Single):
        """Add a variable for the other output's absolute value, if it has a weight."""
        self.single, self.weight = single, single.problem.weight
        self.extra = 1 if self.weight else 0

    def start(self, unit: Array) -> Array:
        """Return the start in the variables of the smooth problem: shares of the bounds, and t."""
        if not self.extra:
            return unit
        return np.append(unit, abs(self.single.rows(unit)[1, 0]))

    def bounds(self) -> list[tuple[float, float | None]]:
        """Return the bounds of the smooth problem's variables."""
        return [(0.0, 1.0)] * self.single.variables + [(0.0, None)] * self.extra

    def value(self, z: Array) -> float:
        """Return the value to minimise at a point z of the smooth problem.

        z holds the shares of the bounds, and t if there is a weight.
        """
        rows = self.single.rows(z[: self.single.variables])
        return float(-rows[0, 0] + (self.weight * z[-1] if self.extra else 0.0))

    def slope(self, z: Array) -> Array:
        """Return the derivatives of the value to minimise."""
        slope = -self.single.slopes(z[: self.single.variables])[0]
        return np.append(slope, self.weight) if self.extra else slope

    def kept(self, z: Array) -> Array:
        """Return the constraints of a smooth problem at a point `z`, which have to be positive.

        `z` holds the variables as shares of their bounds. Of the rows of the search the first is
        the output to maximise, the second the output whose size the criterion weighs (if `extra`),
        and the others are constraints. The size has a kink: the last of `z`, a variable of its
        own, takes its place and bounds the output from both sides.
        """
        rows = self.single.rows(z[: self.single.variables])[:, 0]
        return (
            np.concatenate([rows[2:], [z[-1] - rows[1], z[-1] + rows[1]]])
            if self.extra
            else (rows[2:])
        )

    def kept_slope(self, z: Array) -> Array:
        """Return the derivatives of the constraints of a smooth problem at a point `z`.

        The shape is (constraints, variables of the smooth problem). The size of another output is a
        variable of its own, the last of `z`, if `extra` is true.
        """
        slopes = self.single.slopes(z[: self.single.variables])
        if not self.extra:
            return slopes[2:]
        rows = np.concatenate([slopes[2:], [-slopes[1], slopes[1]]])
        last = np.concatenate([np.zeros(len(slopes) - 2), np.ones(2)])
        return np.column_stack([rows, last])

    @property
    def constrained(self) -> bool:
        """True if the problem has constraints."""
        return bool(self.single.problem.kept) or self.extra > 0


def _best(single: Single, points: list[Array], tolerance: float) -> Array:
    """Return the best of some points, shares of the bounds; those that keep all constraints first.

    A violation up to `tolerance` counts as none.
    """
    units = np.clip(np.array(points).T, 0.0, 1.0)
    value, beyond = single.judged(units)
    return units[:, np.lexsort((-value, np.maximum(beyond, tolerance)))[0]]


def slsqp(single: Single) -> tuple[Array, str]:
    """Return the best point of sequential quadratic programming from several starts, and a message.

    It is one of scipy's methods that a study may choose. `single` is the problem of one design; the
    point is in shares of the bounds, shape (variables,).
    """
    smooth = _Smooth(single)
    constraints = {"type": "ineq", "fun": smooth.kept, "jac": smooth.kept_slope}
    ends, said = [], []
    for start in _starts(single):
        result = scipy.optimize.minimize(
            smooth.value,
            smooth.start(start),
            jac=smooth.slope,
            method="SLSQP",
            bounds=smooth.bounds(),
            constraints=[constraints] if smooth.constrained else [],
            options={"ftol": 1e-15, "maxiter": 200},
        )
        ends.append(result.x[: single.variables])
        said.append(str(result.message))
    return _best(single, ends, 1e-9), max(set(said), key=said.count)


def trust_constr(single: Single) -> tuple[Array, str]:
    """Return the best point of scipy's trust-region interior point method, and scipy's message.

    It is one of scipy's methods that a study may choose; it starts from four points. `single` is
    the problem of one design; the point is in shares of the bounds, shape (variables,).
    """
    smooth = _Smooth(single)
    constraints: list[Any] = []
    if smooth.constrained:
        constraints = [
            scipy.optimize.NonlinearConstraint(smooth.kept, 0.0, np.inf, jac=smooth.kept_slope)
        ]
    bounds = scipy.optimize.Bounds(
        [0.0] * (single.variables + smooth.extra),
        [1.0] * single.variables + [np.inf] * smooth.extra,
    )
    ends = []
    said = ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of flat steps, which are no harm
        for start in _starts(single, 4):
            try:
                result = scipy.optimize.minimize(
                    smooth.value,
                    smooth.start(start),
                    jac=smooth.slope,
                    method="trust-constr",
                    bounds=bounds,
                    constraints=constraints,
                    options={"gtol": 1e-9, "xtol": 1e-10, "barrier_tol": 1e-9, "maxiter": 500},
                )
            except ValueError as error:  # its barrier can overflow where several constraints meet
                said = str(error)
                ends.append(start)
                continue
            ends.append(result.x[: single.variables])
            said = str(result.message)
    return _best(single, ends, 1e-7), said


def differential_evolution(single: Single) -> tuple[Array, str]:
    """Return the best point by scipy's differential evolution, and scipy's message.

    It is one of scipy's methods that a study may choose. Whole populations are evaluated at once.
    `single` is the problem of one design; the point is in shares of the bounds, shape (variables,).
    """
    constraints: Any = ()
    if single.problem.kept:

        def kept(unit: Array) -> Array:
            """Return the smooth margins of points, over their scales."""
            rows = single.rows(np.ascontiguousarray(unit))[2:]
            return rows if np.ndim(unit) > 1 else rows[:, 0]

        constraints = scipy.optimize.NonlinearConstraint(kept, 0.0, np.inf)
    result = scipy.optimize.differential_evolution(
        single.lost,
        [(0.0, 1.0)] * single.variables,
        constraints=constraints,
        vectorized=True,
        updating="deferred",
        init="sobol",
        popsize=16,
        maxiter=300,
        tol=1e-14,
        atol=1e-14,
        polish=False,
        rng=1,
    )
    return np.asarray(result.x), str(result.message)


def search_budget(variables: int) -> int:
    """Return the number of points of the search: 3, 5 or 7 times as many for more variables."""
    return SEARCH_BUDGET * parts_of(variables)


def search(single: Single, budget: int | None = None) -> tuple[Array, str]:
    """Return the best point of a global search for outputs with jumps, and its message.

    It is the method for motions, whose best points are confirmed by longer runs. The point is in
    shares of the bounds, shape (variables,).

    Parameters
    ----------
    single : Single
        The problem of one design.
    budget : int, optional
        The largest number of points to evaluate.

    Raises
    ------
    SearchStoppedError
        If the watch stops it.
    """
    budget = budget or search_budget(single.variables)
    seen: list[tuple[Array, ...]] = []

    def ranked(points: Array) -> Array:
        """Return values that rank points: every feasible one above all infeasible ones.

        `points` has the shape (n, variables).
        """
        value, beyond, chance_error = single.judged_with_error(points.T)
        seen.append((points.T, value, beyond, chance_error))
        # Anything that keeps the constraints beats anything that does not.
        worse = np.where(np.isfinite(beyond), -NO_VALUE - beyond, np.nan)
        return np.where(beyond > 0, worse, value)

    ends = np.zeros(single.variables), np.ones(single.variables)
    result = search_maximum(ranked, *ends, budget=budget, watch=single.watch)
    if result.status == "stopped":
        raise SearchStoppedError
    if single.problem.is_motion and np.isfinite(result.value):
        unit, *judged = (np.concatenate(parts, axis=-1) for parts in zip(*seen, strict=True))
        return unit[:, single.most_reliable(unit, *judged)], result.message
    return np.nan_to_num(result.point), result.message  # without any value, the lower bounds


def shgo(single: Single) -> tuple[Array, str]:
    """Return the best point by simplicial homology global optimisation, and scipy's message.

    It is one of scipy's methods that a study may choose. `single` is the problem of one design. The
    point is in shares of the bounds, shape (variables,); it is refined by local searches.
    """
    # Its local searches need numbers; its sampling leaves out what the constraints refuse.
    result = scipy.optimize.shgo(
        lambda unit: float(single.penalised(unit)),
        [(0.0, 1.0)] * single.variables,
        constraints=(
            [{"type": "ineq", "fun": lambda unit: single.rows(unit)[2:, 0]}]
            if single.problem.kept
            else None
        ),
        n=64,
        iters=2,
        sampling_method="sobol",
        minimizer_kwargs={"method": "SLSQP", "options": {"ftol": 1e-14}},
    )
    found = result.x if result.x is not None else _starts(single, 1)[0]
    return _best(single, [found, *_starts(single, 2)], 1e-9), str(result.message)


def direct(single: Single) -> tuple[Array, str]:
    """Return the best point by dividing rectangles (DIRECT), and scipy's message.

    It is one of scipy's methods that a study may choose. Violations of constraints are penalised.
    `single` is the problem of one design; the point is in shares of the bounds, shape (variables,).
    """
    result = scipy.optimize.direct(
        lambda unit: float(single.penalised(unit)),
        [(0.0, 1.0)] * single.variables,
        maxfun=MAX_DIRECT,
        maxiter=2000,
        locally_biased=True,
        vol_tol=1e-24,
    )
    return np.asarray(result.x), str(result.message)


def minimize_scalar(single: Single) -> tuple[Array, str]:
    """Return the best point of one variable, by scipy's bounded search around minima of a grid.

    It is one of scipy's methods that a study may choose; the three deepest minima are followed.
    `single` is the problem of one design; the point is a share of the bounds, shape (1,). The
    second result is a message.
    """
    points = np.linspace(0.0, 1.0, DENSE)
    values = single.penalised(points[None, :])
    ends = [points[[values.argmin()]]]
    for lowest in np.argsort(values)[:3]:
        bracket = points[max(lowest - 1, 0)], points[min(lowest + 1, DENSE - 1)]
        result = scipy.optimize.minimize_scalar(
            lambda unit: float(single.penalised(np.array([unit]))),
            bounds=bracket,
            method="bounded",
            options={"xatol": 1e-13},
        )
        ends += [np.array([result.x]), np.array([bracket[0]]), np.array([bracket[1]])]
    return _best(single, ends, 1e-9), "the best of the grid's deepest dips"


def one_by_one(
    search_design: DesignSearch, tolerance: float, about: Callable[[int], int]
) -> Solver:
    """Return a method of optimisation that solves designs one after the other.

    Parameters
    ----------
    search_design : callable
        Solves one design; returns the best point, as shares of the bounds, and a message.
    tolerance : float
        Violation of constraints that still counts as none, over the outputs' sizes.
    about : callable
        Returns the approximate number of evaluations of a design for a number of variables, for the
        progress.
    """

    def solve(
        problem: OptimisationProblem,
        design: Mapping[str, Array],
        scales: Mapping[str, Array],
        watch: Watch,
    ) -> Optima:
        """Return the optima of all designs, solved one by one.

        Those after a stop are not computed.
        """
        cells = cells_of(design)
        x = np.full((len(problem.names), cells), np.nan)
        status = np.full(cells, STATUS["not_computed"], dtype=np.int8)
        evaluations = np.zeros(cells, dtype=np.int64)
        says = ""
        points = about(len(problem.names))
        for cell in range(cells):
            if watch.stopped():
                break
            here = slice(cell, cell + 1)
            single = Single(
                problem,
                chosen_cells(design, here),
                chosen_cells(scales, here),
                watch.part(1 / cells),
                points,
            )
            try:
                unit, says = search_design(single)
            except SearchStoppedError:
                break
            if problem.is_motion and watch.stopped():
                break  # the points that were asked for last have no value
            value, beyond = single.judged(unit)
            status[cell] = status_of(float(value[0]), float(beyond[0]), tolerance)
            if status[cell] == STATUS["optimal"]:
                x[:, cell] = single.points_in_box(unit)[:, 0]
            evaluations[cell] = single.evaluations
            single.end()
        return Optima(x, status, evaluations=evaluations, says=says)

    return solve
