"""The method `exact`: closed forms of the problems whose answer is known (theory 12)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.families import OF_SYSTEM
from vibrafeed.core.optimise.families.family import Family, Optimum, ParetoSet
from vibrafeed.core.optimise.optima import STATUS, Optima
from vibrafeed.core.optimise.problem import LIMIT, OptimisationProblem, chosen_cells, columns
from vibrafeed.core.optimise.search import by_search, filled
from vibrafeed.core.study.section_names import DRIVE_ANGLES
from vibrafeed.core.watch import Watch

REST_POINTS = 81  # of the grid on which rest is looked for, where no choice moves the part


def by_exact(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the closed-form optimum of every design.

    Closed forms look for forward motion only. Without any, the best is a part that rests; where it
    slides back at every choice, `search` finds the best one, or that none keeps the limits. So it
    does at an edge of stick whose angles have no closed form.
    """
    optima = closed_optima(problem, design)
    assert optima.value is not None
    x, status, value = optima.x.copy(), optima.status.copy(), optima.value.copy()
    without: NDArray[np.bool_] = np.asarray(np.isnan(x).any(axis=0))
    still = np.flatnonzero((status == STATUS["no_motion"]) & without)
    if still.size:
        unit = filled(len(problem.names), still.size, REST_POINTS)
        here = columns(chosen_cells(design, still)), columns(chosen_cells(scales, still))
        judged, beyond = problem.judged(problem.inside(unit)[:, None], *here)
        rests = (beyond <= 0) & (judged >= 0)
        found = rests.any(axis=1)
        x[:, still[found]] = problem.inside(unit[:, rests[found].argmax(axis=1)])
        without[still[found]] = False
    left = np.flatnonzero(without & np.isin(status, (STATUS["no_motion"], STATUS["not_attained"])))
    if left.size:
        here = chosen_cells(design, left), chosen_cells(scales, left)
        best = by_search(problem, *here, replace(watch, progress=None))
        lost = np.isnan(best.x).any(axis=0)
        values = problem.judged(np.where(lost, problem.lower[:, None], best.x), *here)[0]
        x[:, left], value[left] = best.x, np.where(lost, np.nan, values)
        status[left] = np.where(
            status[left] == STATUS["not_attained"], STATUS["not_attained"], best.status
        )
    watch.advance(1.0)
    return replace(optima, x=x, status=status, value=value)


def closed_optima(problem: OptimisationProblem, design: Mapping[str, Array]) -> Optima:
    """Return the closed-form optimum of every design as it is, NaN where a part does not move.

    `design` has the fixed parameters, SI units, shape (cells,).
    """
    best = _closed(problem, design)
    value = best.acceleration_x - problem.weight * np.abs(best.acceleration_y)
    return Optima(_ordered(problem, best.alpha, best.beta), best.status, value)


def closed_front(problem: OptimisationProblem, design: Mapping[str, Array], points: int) -> Optima:
    """Return the closed-form front of every design, shape (cells * points,).

    `points` is the number of points of a front, which follow one another.
    """
    front = _closed(problem, design, points)
    x = _ordered(problem, front.alpha.ravel(), front.beta.ravel())
    return Optima(x, np.repeat(front.status, points), front.acceleration_x.ravel())


def is_closed(problem: OptimisationProblem) -> bool:
    """True if the optimum of a problem has a closed form.

    Both angles of the drive are then variables with bounds from 0 to 90 degrees, and scene,
    criterion and constraints are among those that were solved.
    """
    family = _family(problem)
    whole = (
        set(problem.names) == set(DRIVE_ANGLES)
        and bool(np.all(problem.lower == 0.0))
        and bool(np.all(problem.upper == np.pi / 2))
    )
    return family is not None and whole and type(problem.criterion) in family.closed


def _family(problem: OptimisationProblem) -> Family | None:
    plan, criterion = problem.plan, problem.criterion
    family = OF_SYSTEM.get((plan.scene.name, plan.variant, criterion.output))
    names = {kept.name for kept in problem.kept}
    if family is None or problem.uncertain is not None or problem.sign < 0:
        return None
    if not family.contacts <= names <= {LIMIT, "floor_contact", "wall_contact"}:
        return None
    if problem.against not in (None, family.against):
        return None
    # The drive is as large in any direction: a vertical amplitude is not.
    if plan.depends_on(problem.names).get("vibration_acceleration"):
        return None
    at_rest = "speed" not in plan.parameters and (
        plan.scene.name != "rectangle-on-track" or "centripetal_acceleration" in plan.defaults
    )
    return family if at_rest else None


def _closed(
    problem: OptimisationProblem, design: Mapping[str, Array], points: int = 0
) -> Optimum | ParetoSet:
    family = _family(problem)
    assert family is not None
    inputs = _inputs(problem, design)
    kept = {one.name for one in problem.kept}
    asked = {
        "limit": design.get(LIMIT, np.inf),
        "weight": problem.weight,
        "floor_contact": "floor_contact" in kept,
        "wall_contact": "wall_contact" in kept,
        "friction_static": inputs["friction_kinetic"],
        "points": points,
    }
    return family.closed_optimum(problem.criterion, asked | inputs)


def _inputs(problem: OptimisationProblem, design: Mapping[str, Array]) -> dict[str, Array]:
    # Variables stand at their lower bounds: none of these depends on the angles.
    known = problem.known(np.broadcast_to(problem.lower[:, None], (len(problem.names), 1)), design)
    names = ("vibration_acceleration", "gravity_along", "gravity_normal", "friction_kinetic")
    more = (name for name in ("friction_static", "gravity_across") if name in known)
    cells = next(iter(design.values())).shape
    return {
        name: np.broadcast_to(np.asarray(known[name], dtype=np.float64), cells)
        for name in (*names, *more)
    }


def _ordered(problem: OptimisationProblem, alpha: Array, beta: Array) -> Array:
    angles = {"alpha": alpha, "beta": beta}
    return np.stack([np.broadcast_to(angles[name], alpha.shape) for name in problem.names])
