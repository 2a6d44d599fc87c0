"""The optimisers, by name.

Each takes the problem, the designs (arrays of shape (cells,)), the scales of the outputs, and a
watch. scipy's take one design after the other; the others all at once. scipy is loaded when one of
its optimisers runs.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from core.mechanics.arrays import Array
from core.optimise import known_answers
from core.optimise.exact import STATUS
from core.optimise.found import Found
from core.optimise.population import by_population
from core.optimise.problem import Problem, cells_of, chosen_cells
from core.optimise.single import NO_VALUE, Single, spread
from core.watch import Watch

Solver = Callable[[Problem, Mapping[str, Array], Mapping[str, Array], Watch], Found]
One = Callable[[Single], tuple[Array, str]]

STARTS = 8  # of the optimisers that follow slopes
SAMPLES = 256  # of which the best are the starts
DENSE = 129  # points of the search over one variable
SEARCH_BUDGET = 4000
GRID_POINTS = 40_000  # of the first grid of a design
GRID_WIDTH = 9  # points of each variable of a later grid
GRID_ROUNDS = 40
GRID_SHRINKS = 0.5


def _starts(single: Single, count: int = STARTS) -> Array:
    """Return the best of points that fill the box, shape (count, variables)."""
    points = spread(SAMPLES, single.variables)
    value, beyond = single.judged(points)
    order = np.lexsort((-value, beyond))
    # Half of them are the best, half are far apart.
    best = order[: count - count // 2]
    return points[:, np.concatenate([best, np.arange(count // 2)])].T


class _Smooth:
    """The problem without kinks: max output - w t with t >= |other|, for methods with slopes."""

    def __init__(self, single: Single):
        self.single, self.weight = single, single.problem.weight
        self.extra = 1 if self.weight else 0

    def start(self, unit: Array) -> Array:
        if not self.extra:
            return unit
        return np.append(unit, abs(self.single.rows(unit)[1, 0]))

    def bounds(self) -> list[tuple[float, float | None]]:
        return [(0.0, 1.0)] * self.single.variables + [(0.0, None)] * self.extra  # type: ignore[return-value]

    def value(self, z: Array) -> float:
        rows = self.single.rows(z[: self.single.variables])
        return float(-rows[0, 0] + (self.weight * z[-1] if self.extra else 0.0))

    def slope(self, z: Array) -> Array:
        slope = -self.single.slopes(z[: self.single.variables])[0]
        return np.append(slope, self.weight) if self.extra else slope

    def kept(self, z: Array) -> Array:
        rows = self.single.rows(z[: self.single.variables])[:, 0]
        return np.concatenate([rows[2:], [z[-1] - rows[1], z[-1] + rows[1]]]) if self.extra else (
            rows[2:]
        )

    def kept_slope(self, z: Array) -> Array:
        slopes = self.single.slopes(z[: self.single.variables])
        if not self.extra:
            return slopes[2:]
        rows = np.concatenate([slopes[2:], [-slopes[1], slopes[1]]])
        last = np.concatenate([np.zeros(len(slopes) - 2), np.ones(2)])
        return np.column_stack([rows, last])

    @property
    def constrained(self) -> bool:
        return bool(self.single.problem.kept) or self.extra > 0


def _best(single: Single, points: list[Array], tolerance: float) -> Array:
    """Return the best of the points, those within the tolerance of all constraints first."""
    units = np.clip(np.array(points).T, 0.0, 1.0)
    value, beyond = single.judged(units)
    return units[:, np.lexsort((-value, np.maximum(beyond, tolerance)))[0]]


def _slsqp(single: Single) -> tuple[Array, str]:
    from scipy import optimize

    smooth = _Smooth(single)
    constraints = {"type": "ineq", "fun": smooth.kept, "jac": smooth.kept_slope}
    ends, said = [], []
    for start in _starts(single):
        answer = optimize.minimize(
            smooth.value,
            smooth.start(start),
            jac=smooth.slope,
            method="SLSQP",
            bounds=smooth.bounds(),
            constraints=[constraints] if smooth.constrained else [],
            options={"ftol": 1e-15, "maxiter": 200},
        )
        ends.append(answer.x[: single.variables])
        said.append(str(answer.message))
    return _best(single, ends, 1e-9), max(set(said), key=said.count)


def _trust_constr(single: Single) -> tuple[Array, str]:
    from scipy import optimize

    smooth = _Smooth(single)
    constraints: list[Any] = []
    if smooth.constrained:
        constraints = [
            optimize.NonlinearConstraint(smooth.kept, 0.0, np.inf, jac=smooth.kept_slope)
        ]
    bounds = optimize.Bounds(
        [0.0] * (single.variables + smooth.extra),
        [1.0] * single.variables + [np.inf] * smooth.extra,
    )
    ends = []
    said = ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of flat steps, which are no harm
        for start in _starts(single, 4):
            answer = optimize.minimize(
                smooth.value,
                smooth.start(start),
                jac=smooth.slope,
                method="trust-constr",
                bounds=bounds,
                constraints=constraints,
                options={"gtol": 1e-12, "xtol": 1e-12, "barrier_tol": 1e-12, "maxiter": 500},
            )
            ends.append(answer.x[: single.variables])
            said = str(answer.message)
    return _best(single, ends, 1e-7), said


def _differential_evolution(single: Single) -> tuple[Array, str]:
    from scipy import optimize

    constraints: Any = ()
    if single.problem.kept:

        def kept(unit: Array) -> Array:
            rows = single.rows(np.ascontiguousarray(unit))[2:]
            return rows if np.ndim(unit) > 1 else rows[:, 0]

        constraints = optimize.NonlinearConstraint(kept, 0.0, np.inf)
    answer = optimize.differential_evolution(
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
    return np.asarray(answer.x), str(answer.message)


def _shgo(single: Single) -> tuple[Array, str]:
    from scipy import optimize

    # Its local searches need numbers; its sampling leaves out what the constraints refuse.
    answer = optimize.shgo(
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
    found = answer.x if answer.x is not None else _starts(single, 1)[0]
    return _best(single, [found, *_starts(single, 2)], 1e-9), str(answer.message)


def _direct(single: Single) -> tuple[Array, str]:
    from scipy import optimize

    answer = optimize.direct(
        lambda unit: float(single.penalised(unit)),
        [(0.0, 1.0)] * single.variables,
        maxfun=20_000,
        maxiter=2000,
        locally_biased=True,
        vol_tol=1e-24,
    )
    return np.asarray(answer.x), str(answer.message)


def _minimize_scalar(single: Single) -> tuple[Array, str]:
    from scipy import optimize

    points = np.linspace(0.0, 1.0, DENSE)
    values = single.penalised(points[None, :])
    ends = [points[[values.argmin()]]]
    for place in np.argsort(values)[:3]:
        bracket = points[max(place - 1, 0)], points[min(place + 1, DENSE - 1)]
        answer = optimize.minimize_scalar(
            lambda unit: float(single.penalised(np.array([unit]))),
            bounds=bracket,
            method="bounded",
            options={"xatol": 1e-13},
        )
        ends += [np.array([answer.x]), np.array([bracket[0]]), np.array([bracket[1]])]
    return _best(single, ends, 1e-9), "the best of the grid's deepest dips"


def one_by_one(one: One, tolerance: float) -> Solver:
    """Return the solver that takes one design after the other."""

    def solve(
        problem: Problem, design: Mapping[str, Array], scales: Mapping[str, Array], watch: Watch
    ) -> Found:
        cells = cells_of(design)
        x = np.full((len(problem.names), cells), np.nan)
        status = np.full(cells, STATUS["not_computed"], dtype=np.int8)
        evaluations = np.zeros(cells, dtype=np.int64)
        says = ""
        for cell in range(cells):
            if watch.stopped():
                break
            here = slice(cell, cell + 1)
            single = Single(problem, chosen_cells(design, here), chosen_cells(scales, here), watch)
            unit, says = one(single)
            value, beyond = single.judged(unit)
            status[cell] = _status(float(value[0]), float(beyond[0]), tolerance)
            if status[cell] == STATUS["optimal"]:
                x[:, cell] = single.place(unit)[:, 0]
            evaluations[cell] = single.evaluations
            watch.advance(1 / cells)
        return Found(x, status, evaluations=evaluations, says=says)

    return solve


def _status(value: float, beyond: float, tolerance: float) -> int:
    if beyond <= tolerance and np.isfinite(value):
        return STATUS["optimal"]
    return STATUS["infeasible"] if np.isfinite(beyond) else STATUS["no_value"]


def _exact(
    problem: Problem, design: Mapping[str, Array], scales: Mapping[str, Array], watch: Watch
) -> Found:
    return known_answers.by_closed_form(problem, design)


def _newton(
    problem: Problem, design: Mapping[str, Array], scales: Mapping[str, Array], watch: Watch
) -> Found:
    return known_answers.by_newton(problem, design)


def _search(
    problem: Problem, design: Mapping[str, Array], scales: Mapping[str, Array], watch: Watch
) -> Found:
    """Return what the global search for outputs that jump finds, all designs side by side."""
    search = import_module("core.optimise.search")
    cells = cells_of(design)
    size = problem.scale(scales)

    def evaluate(cell: Any, points: Array) -> Array:
        value, beyond = problem.judged(
            points.T, chosen_cells(design, cell), chosen_cells(scales, cell), watch
        )
        # Anything that keeps the constraints beats anything that does not.
        worse = np.where(np.isfinite(beyond), -NO_VALUE - beyond, np.nan)
        return np.where(beyond > 0, worse, value / size[cell])

    ends = (np.tile(end, (cells, 1)) for end in (problem.lower, problem.upper))
    found = search.search_many(evaluate, *ends, budget=SEARCH_BUDGET, watch=watch)
    stopped = np.array([one.status == "stopped" for one in found])
    value = np.array([one.value for one in found])
    status = np.where(value > -NO_VALUE / 2, STATUS["optimal"], STATUS["infeasible"])
    status = np.where(np.isfinite(value), status, STATUS["no_value"])
    status = np.where(stopped, STATUS["not_computed"], status).astype(np.int8)
    x = np.stack([one.point for one in found], axis=1)
    x = np.where(status == STATUS["optimal"], x, np.nan)
    evaluations = np.array([one.evaluations for one in found], dtype=np.int64)
    return Found(x, status, evaluations=evaluations, says=found[-1].message)


def _grid(
    problem: Problem, design: Mapping[str, Array], scales: Mapping[str, Array], watch: Watch
) -> Found:
    """Return the best point of a grid, then of ever finer ones around it."""
    cells, count = cells_of(design), len(problem.names)
    size = problem.scale(scales)
    low, high = np.zeros((count, cells)), np.ones((count, cells))
    best = np.full((count, cells), np.nan)
    rank = (np.full(cells, np.inf), np.full(cells, -np.inf))
    evaluations = 0
    for number in range(GRID_ROUNDS):
        if watch.stopped():
            break
        width = dense_width(count, cells, GRID_POINTS) if number == 0 else GRID_WIDTH
        shares = np.stack(np.meshgrid(*[np.linspace(0, 1, width)] * count, indexing="ij"))
        shares = shares.reshape(count, 1, -1)
        evaluations += shares.shape[2]
        unit = low[:, :, None] + (high - low)[:, :, None] * shares
        place, beyond, value = _top(problem, unit, design, scales)
        point = np.take_along_axis(unit, place[None, :, None], axis=2)[:, :, 0]
        better = (beyond < rank[0]) | ((beyond == rank[0]) & (value > rank[1]))
        best = np.where(better, point, best)
        rank = np.where(better, beyond, rank[0]), np.where(better, value, rank[1])
        reach = (high - low) * (2 / (width - 1) if number == 0 else GRID_SHRINKS / 2)
        low, high = np.maximum(best - reach, 0.0), np.minimum(best + reach, 1.0)
        watch.advance(1 / GRID_ROUNDS)
    status = np.array(
        [_status(v, b, 0.0) for v, b in zip(rank[1] / size, rank[0], strict=True)], dtype=np.int8
    )
    x = problem.lower[:, None] + (problem.upper - problem.lower)[:, None] * best
    x = np.where(status == STATUS["optimal"], x, np.nan)
    return Found(x, status, evaluations=np.full(cells, evaluations))


def dense_width(variables: int, cells: int, points: int) -> int:
    """Return the points of each variable of a grid that spends about so many on a design."""
    return max(5, min(201, int(min(points, 8_000_000 / cells) ** (1 / variables))))


def _top(
    problem: Problem, unit: Array, design: Mapping[str, Array], scales: Mapping[str, Array]
) -> tuple[Any, Array, Array]:
    """Return the place of the best of points (variables, cells, n), its violation and value."""
    cells = unit.shape[1]
    step = max(1, 262_144 // unit.shape[2])
    place = np.zeros(cells, dtype=np.intp)
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
        place[piece], beyond[piece], value[piece] = here, b[rows, here], v[rows, here]
    return place, beyond, value


def dense_grid(
    problem: Problem, design: Mapping[str, Array], scales: Mapping[str, Array], points: int
) -> Array:
    """Return the best objective on a grid of at most so many points a design; -inf without one."""
    count, cells = len(problem.names), cells_of(design)
    width = dense_width(count, cells, points)
    shares = np.stack(np.meshgrid(*[np.linspace(0, 1, width)] * count, indexing="ij"))
    unit = np.broadcast_to(shares.reshape(count, 1, -1), (count, cells, width**count))
    _, beyond, value = _top(problem, unit, design, scales)
    return np.where(beyond <= 0, value, -np.inf)


@dataclass(frozen=True)
class Method:
    """An optimiser.

    Attributes
    ----------
    solve : callable
        Solves any number of designs.
    tolerance : float
        A margin within so much of its output's scale counts as none: what the method leaves.
    says : str
        What it is, in one line.
    at_once : bool
        Whether it takes all designs at once.
    """

    solve: Solver
    tolerance: float
    says: str
    at_once: bool = False


METHODS: dict[str, Method] = {
    "exact": Method(_exact, 1e-10, "closed form", at_once=True),
    "newton": Method(_newton, 1e-10, "compiled batch solver", at_once=True),
    "population": Method(
        by_population, 1e-8, "differential evolution of all designs at once", at_once=True
    ),
    "search": Method(_search, 1e-6, "global search for outputs that jump", at_once=True),
    "grid": Method(_grid, 1e-6, "a dense grid, then finer ones around its best", at_once=True),
    "differential_evolution": Method(
        one_by_one(_differential_evolution, 1e-9), 1e-7, "scipy's differential evolution"
    ),
    "shgo": Method(one_by_one(_shgo, 1e-8), 1e-6, "scipy's simplicial homology search"),
    "direct": Method(one_by_one(_direct, 1e-3), 1e-3, "scipy's dividing rectangles"),
    "slsqp": Method(one_by_one(_slsqp, 1e-8), 1e-7, "scipy's SLSQP from several starts"),
    "trust-constr": Method(
        one_by_one(_trust_constr, 1e-6), 1e-6, "scipy's trust region from several starts"
    ),
    "minimize_scalar": Method(
        one_by_one(_minimize_scalar, 1e-8), 1e-6, "scipy's bounded search of one variable"
    ),
}
"""Every optimiser, by the name that a study gives."""


def refusal(name: str, problem: Problem) -> tuple[str, str] | None:
    """Return why a method cannot solve a problem and what could, or None if it can."""
    if name == "exact" and not known_answers.is_closed(problem):
        return "there is no closed form of this problem", "Leave method out"
    if name == "newton" and not known_answers.is_compiled(problem):
        return "the batch solver does not know this problem", "Leave method out"
    if name == "minimize_scalar" and len(problem.names) != 1:
        return f"it takes one variable, not {len(problem.names)}", "Leave method out"
    return None


def default_method(problem: Problem, cells: int) -> str:
    """Return the method of a study that names none.

    The known answers where there are; else what `benchmarks/optimise.py` shows to be the fastest
    of those that miss nothing.
    """
    if known_answers.is_front(problem):
        order = ("exact", "newton")
    else:
        order = ("newton", "exact")
    for name in order:
        if refusal(name, problem) is None:
            return name
    if problem.is_motion:
        return "search"
    return "population"
