"""The optimisers, by name, and that of scipy: one design after the other, loaded when it runs."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.exact import by_exact
from vibrafeed.core.optimise.problem import (
    STATUS,
    Optima,
    OptimisationProblem,
    Solver,
    cells_of,
    chosen_cells,
    columns,
    statuses_of,
)
from vibrafeed.core.optimise.search import by_search
from vibrafeed.core.watch import Watch

TOLERANCE = 1e-8  # a violation over the outputs' sizes that still counts as none
ABOUT = 6_000  # evaluations of a design, for the progress
INFEASIBLE = 1e6  # anything that keeps the constraints is better
NO_VALUE = 1e9  # stands for a missing value where SLSQP needs a number
MOST_SHARE = 0.98  # of the progress of a design before its end: `ABOUT` is a guess


def by_scipy(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the best candidate of every design by scipy's differential evolution and SLSQP.

    SLSQP follows slopes: it polishes closed forms alone, not motions, which jump, nor values under
    uncertain parameters, which have kinks. Arguments and result as in `by_search`; designs after a
    stop are not computed.
    """
    cells = cells_of(design)
    x = np.full((len(problem.names), cells), np.nan)
    status = np.full(cells, STATUS["not_computed"], dtype=np.int8)
    evaluations = np.zeros(cells, dtype=np.int64)
    message = ""
    for cell in range(cells):
        if watch.stopped():
            break
        single_design = _Design(problem, chosen_cells(design, [cell]), chosen_cells(scales, [cell]),
                      watch.part(1 / cells))  # fmt: skip
        unit, message = single_design.best()
        if watch.stopped() and (problem.is_motion or not single_design.ended):
            break  # the last points were not evaluated
        value, beyond = single_design.judged(unit[:, None])
        status[cell] = statuses_of(value, beyond, TOLERANCE)[0]
        if status[cell] == STATUS["optimal"]:
            x[:, cell] = problem.from_unit_box(unit)
        evaluations[cell] = single_design.evaluations
        single_design.report(1.0)
    return Optima(x, status, evaluations=evaluations, says=message)


class _Design:
    def __init__(
        self,
        problem: OptimisationProblem,
        design: Mapping[str, Array],
        scales: Mapping[str, Array],
        watch: Watch,
    ):
        self.problem, self.watch = problem, watch
        self.design, self.scales = columns(design), columns(scales)
        self.size = float(problem.scale(scales)[0])
        self.evaluations, self.reported, self.ended = 0, 0.0, False

    def report(self, fraction: float) -> None:
        if fraction > self.reported:
            self.watch.advance(fraction - self.reported)
            self.reported = fraction

    def judged(self, unit: Array) -> tuple[Array, Array]:
        self.report(min(self.evaluations / ABOUT, MOST_SHARE))
        self.evaluations += unit.shape[1]
        silent = replace(self.watch, progress=None)
        x = self.problem.from_unit_box(unit)[:, None, :]
        value, violation, _ = self.problem.judged(x, self.design, self.scales, silent)
        return value[0] / self.size, violation[0]

    def penalised(self, unit: Array) -> Array:
        value, violation = self.judged(np.reshape(unit, (len(unit), -1)))
        return np.where(
            violation > 0, np.where(np.isfinite(violation), INFEASIBLE + violation, np.inf), -value
        )

    def best(self) -> tuple[Array, str]:
        # The best point of the unit box, and the messages of the optimisers.
        bounds = [(0.0, 1.0)] * len(self.problem.names)
        result = scipy.optimize.differential_evolution(
            lambda unit: self.penalised(unit) if unit.ndim > 1 else self.penalised(unit)[0],
            bounds,
            vectorized=True,
            updating="deferred",
            init="sobol",
            popsize=16,
            maxiter=300,
            tol=1e-14,
            atol=1e-14,
            polish=False,
            rng=1,
            callback=lambda intermediate_result: self.watch.stopped(),
        )
        self.ended = not self.watch.stopped()
        # SLSQP refines the point only where the objective is smooth.
        point, message = np.asarray(result.x), str(result.message)
        is_smooth = not self.problem.is_motion and self.problem.uncertain is None
        if not is_smooth or not self.ended or not np.isfinite(result.fun):
            return point, message
        inequalities = {
            "type": "ineq",
            "fun": lambda unit: self.scaled_objective_and_margins(unit)[1:],
        }
        polished = scipy.optimize.minimize(
            lambda unit: -float(self.scaled_objective_and_margins(unit)[0]),
            point,
            jac="3-point",
            method="SLSQP",
            bounds=bounds,
            constraints=[inequalities] if self.problem.constraints else [],
            options={"ftol": 1e-15, "maxiter": 200},
        )
        points = np.clip(np.stack([point, polished.x], axis=1), 0.0, 1.0)
        value, violation = self.judged(points)
        best = np.lexsort((-value, np.maximum(violation, TOLERANCE / 10)))[0]
        return points[:, best], f"{message} {polished.message}"

    def scaled_objective_and_margins(self, unit: Array) -> Array:
        problem = self.problem
        self.evaluations += 1
        quantities = problem.quantities(problem.from_unit_box(unit)[:, None, None], self.design)
        rows = [problem.objective(quantities) / self.size]
        for constraint in problem.constraints:
            rows.append(
                problem.margin(constraint, quantities, self.design) / self.scales[constraint.output]
            )
        values = np.array([float(np.broadcast_to(row, (1, 1))[0, 0]) for row in rows])
        return np.where(np.isfinite(values), values, -NO_VALUE)


@dataclass(frozen=True)
class OptimisationMethod:
    """An optimiser.

    Attributes
    ----------
    solve : callable
        Solves any number of designs, arrays of shape (cells,).
    tolerance : float
        A margin within so much of its output's scale counts as none: what the method leaves.
    says : str
        What it is, in one line.
    """

    solve: Solver
    tolerance: float
    says: str


METHODS: dict[str, OptimisationMethod] = {
    "exact": OptimisationMethod(by_exact, 1e-10, "closed form"),
    "search": OptimisationMethod(by_search, 1e-8, "differential evolution of all designs at once"),
    "scipy": OptimisationMethod(by_scipy, 1e-7, "scipy's differential evolution and SLSQP"),
}
"""Every optimiser, by the name that a study gives."""
