"""Problems whose answer is known: which family a problem is of, and what its answers take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise import newton
from vibrafeed.core.optimise.families import OF_SYSTEM
from vibrafeed.core.optimise.families.family import Family
from vibrafeed.core.optimise.families.optimum import Optimum, ParetoSet
from vibrafeed.core.optimise.optima import Optima
from vibrafeed.core.optimise.problem import LIMIT, OptimisationProblem
from vibrafeed.core.study.optimise_study import Pareto

ANGLES = ("alpha", "beta")


@dataclass(frozen=True)
class Answered:
    """An answered problem: which, and what of it is kept."""

    family: Family
    floor: bool
    wall: bool


def answered(problem: OptimisationProblem) -> Answered | None:
    """Return the closed form that solves a problem of best drive angles, None if there is none.

    It depends on scene, variant, output and constraints; bounds and criterion are compared
    elsewhere. With the closed form comes whether contact with floor and wall is to be kept.
    Problems with uncertain parameters or of a smallest output have none.
    """
    plan, criterion = problem.plan, problem.criterion
    family = OF_SYSTEM.get((plan.scene.name, plan.variant, criterion.output))
    names = {kept.name for kept in problem.kept}
    if family is None or problem.uncertain is not None or problem.sign < 0:
        return None
    if not family.contacts <= names <= {LIMIT, "floor_contact", "wall_contact"}:
        return None
    if not _has_optimum(problem, family):
        return None
    return Answered(family, "floor_contact" in names, "wall_contact" in names)


def _has_optimum(problem: OptimisationProblem, family: Family) -> bool:
    """True if the closed forms of a family hold for the variables, limit and contacts of a problem.

    They hold for a part at rest, for drive angles within half a turn, for a limit of the family's
    own output, and for a drive as large in any direction: a vertical amplitude is not.
    """
    plan = problem.plan
    if plan.depends_on(problem.names).get("vibration_acceleration"):
        return False
    at_rest = "speed" not in plan.parameters and (
        plan.scene.name != "rectangle-on-track" or "centripetal_acceleration" in plan.defaults
    )
    is_limited_so = problem.against in (None, family.against)
    chooses = set(problem.names) <= set(ANGLES) and _within_reach(problem)
    return at_rest and is_limited_so and chooses


def _within_reach(problem: OptimisationProblem) -> bool:
    """True if the bounds of both drive angles are such that closed forms find the best ones.

    These are bounds within half a turn of the azimuth alpha, and from -90 to 90 degrees of the
    elevation beta. An angle that is no variable does not matter.
    """
    for variable in problem.variables:
        if variable.name == "alpha" and variable.upper - variable.lower > np.pi:
            return False
        if (
            variable.name == "beta"
            and not -np.pi / 2 <= variable.lower < variable.upper <= np.pi / 2
        ):
            return False
    return True


def is_closed(problem: OptimisationProblem) -> bool:
    """True if the optimum of a problem has a closed form.

    Both angles of the drive are then variables with bounds from 0 to 90 degrees, and scene,
    criterion and constraints are among those that were solved.
    """
    which = answered(problem)
    whole = (
        set(problem.names) == set(ANGLES)
        and bool(np.all(problem.lower == 0.0))
        and bool(np.all(problem.upper == np.pi / 2))
    )
    return which is not None and whole and type(problem.criterion) in which.family.closed


def is_compiled(problem: OptimisationProblem) -> bool:
    """True if the batch solver has the optimum, or that of each point of a front."""
    which = answered(problem)
    criterion = problem.limited().criterion if is_front(problem) else problem.criterion
    return which is not None and type(criterion) in which.family.batch


def is_front(problem: OptimisationProblem) -> bool:
    """True if the problem asks for a whole front."""
    return isinstance(problem.criterion, Pareto)


def groups(problem: OptimisationProblem, design: Mapping[str, Array]) -> dict[str, Array]:
    """Return the inputs of the closed forms and compiled methods in SI units, shape (cells,) each.

    They are the drive's acceleration, gravity along and normal (and across), friction, and the
    angles of the drive. `design` has the fixed parameters, SI units, shape (cells,). Variables
    stand at their lower bounds, on which none of these hangs but the angles themselves: closed
    forms do not read an angle that is a variable.
    """
    known = problem.known(np.broadcast_to(problem.lower[:, None], (len(problem.names), 1)), design)
    names = ("vibration_acceleration", "gravity_along", "gravity_normal", "friction_kinetic")
    inputs = {name: known[name] for name in names}
    for name in ("friction_static", "gravity_across"):
        if name in known:
            inputs[name] = known[name]
    for name in ANGLES:
        if name in known:
            inputs[name] = known[name]
    cells = next(iter(design.values())).shape
    return {n: np.broadcast_to(np.asarray(v, dtype=np.float64), cells) for n, v in inputs.items()}


def _closed(
    problem: OptimisationProblem, design: Mapping[str, Array], points: int = 0
) -> Optimum | ParetoSet:
    """Return the closed-form optimum of every design, or `points` points of its trade-off front.

    `design` has the fixed parameters, SI units, each of shape (cells,). The problem must be one
    that has a closed form (`is_closed`).
    """
    which = answered(problem)
    assert which is not None
    inputs = groups(problem, design)
    asked = {
        "limit": design.get(LIMIT, np.inf),
        "weight": problem.weight,
        "floor_contact": which.floor,
        "wall_contact": which.wall,
        "friction_static": inputs["friction_kinetic"],
        "points": points,
    }
    return which.family.closed_optimum(problem.criterion, asked | inputs)


def by_closed_form(problem: OptimisationProblem, design: Mapping[str, Array]) -> Optima:
    """Return the closed-form optimum of every design; `design` has the shape (cells,)."""
    best = _closed(problem, design)
    value = best.acceleration_x - problem.weight * np.abs(best.acceleration_y)
    return Optima(_ordered(problem, best.alpha, best.beta), best.status, value)


def by_closed_front(
    problem: OptimisationProblem, design: Mapping[str, Array], points: int
) -> Optima:
    """Return the closed-form front of every design, shape (cells * points,).

    `points` is the number of points of a front, which follow one another.
    """
    front = _closed(problem, design, points)
    x = _ordered(problem, front.alpha.ravel(), front.beta.ravel())
    return Optima(x, np.repeat(front.status, points), front.acceleration_x.ravel())


def by_newton(problem: OptimisationProblem, design: Mapping[str, Array]) -> Optima:
    """Return the best drive angles of every design by Newton's method in compiled code.

    `design` has the fixed parameters, SI units, each of shape (cells,). The problem has to be one
    of those that are compiled (`is_compiled`). An angle that is no variable has equal bounds. The
    result has the best angles, shape (variables, cells), NaN where there are none, statuses, values
    of the objective and residuals of the optimality conditions, shape (cells,).
    """
    which = answered(problem)
    assert which is not None
    inputs = groups(problem, design)
    bounds: dict[str, Any] = {}
    for name in ANGLES:
        if name in problem.names:
            place = problem.names.index(name)
            ends = (problem.lower[place], problem.upper[place])
        else:
            ends = (inputs[name], inputs[name])
        bounds[f"{name}_lower"], bounds[f"{name}_upper"] = ends
    bounds |= {name: values for name, values in inputs.items() if name not in ANGLES}
    best = newton.fastest(
        which.family.name,
        **bounds,
        limit=design.get(LIMIT, np.inf),
        floor_contact=which.floor,
        wall_contact=which.wall,
    )
    # The solver's residual is per radian, in units of the drive.
    span = float(np.max(problem.upper - problem.lower))
    residual = best.residual * inputs["vibration_acceleration"] * span
    return Optima(_ordered(problem, best.alpha, best.beta), best.status, best.objective, residual)


def _ordered(problem: OptimisationProblem, alpha: Array, beta: Array) -> Array:
    """Return the angles that are variables, shape (variables, cells)."""
    angles = {"alpha": alpha, "beta": beta}
    return np.stack([np.broadcast_to(angles[name], alpha.shape) for name in problem.names])
