"""Problems whose answer is known: closed forms and the compiled batch solver of theory 12."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from core.mechanics.arrays import Array
from core.optimise import exact, newton
from core.optimise.found import Optima
from core.optimise.problem import LIMIT, OptimisationProblem
from core.study.optimise_study import Limited, Maximise, Pareto, Weighted

Family = Literal[
    "plane_thesis",
    "plane_physical",
    "cylinder_physical",
    "track_thesis",
    "track_derived",
    "track_physical",
]

FAMILIES: dict[tuple[str, str, str], Family] = {
    ("rectangle-on-plane", "thesis", "acceleration_x"): "plane_thesis",
    ("rectangle-on-plane", "derived", "acceleration_x"): "plane_thesis",
    ("rectangle-on-plane", "physical", "acceleration_x"): "plane_physical",
    ("cylinder-on-plane", "thesis", "acceleration_x"): "plane_thesis",
    ("cylinder-on-plane", "derived", "acceleration_x"): "plane_thesis",
    ("cylinder-on-plane", "physical", "acceleration_x"): "cylinder_physical",
    ("rectangle-on-track", "thesis", "acceleration_x"): "track_thesis",
    ("rectangle-on-track", "thesis", "starting_acceleration"): "track_thesis",
    ("rectangle-on-track", "derived", "acceleration_x"): "track_derived",
    ("rectangle-on-track", "derived", "starting_acceleration"): "track_derived",
    ("rectangle-on-track", "physical", "acceleration_x"): "track_physical",
    ("rectangle-on-track", "physical", "starting_acceleration"): "track_derived",
}
"""The answered problem of a scene, its variant and the output that is to be largest."""

ANGLES = ("alpha", "beta")
CLOSED = {
    "plane_thesis": (Maximise, Limited, Weighted, Pareto),
    "plane_physical": (Maximise,),
    "cylinder_physical": (Maximise,),
    "track_thesis": (Maximise,),
    "track_derived": (Maximise,),
    "track_physical": (Maximise,),
}
"""The criteria for which `core.optimise.exact` has a closed form."""

COMPILED = {
    "plane_thesis": (Maximise, Limited),
    "plane_physical": (Maximise, Limited),
    "cylinder_physical": (),
    "track_thesis": (Maximise,),
    "track_derived": (Maximise,),
    "track_physical": (Maximise,),
}
"""The criteria for which `core.optimise.newton` has an answer; of a front, each of its points."""


@dataclass(frozen=True)
class Answered:
    """An answered problem: which, and what of it is kept."""

    family: Family
    floor: bool
    wall: bool


def answered(problem: OptimisationProblem) -> Answered | None:
    """Return the answered problem that a problem is, if any; its bounds and criterion apart."""
    plan, criterion = problem.plan, problem.criterion
    family = FAMILIES.get((plan.scene.name, plan.variant, criterion.output))
    names = {kept.name for kept in problem.kept}
    floor, wall = "floor_contact" in names, "wall_contact" in names
    if family is None or problem.uncertain is not None or problem.sign < 0:
        return None
    if not names <= {LIMIT, "floor_contact", "wall_contact"} or not _has_answer(problem, family):
        return None
    if (family.endswith("physical") and not floor) or (family == "track_physical" and not wall):
        return None
    return Answered(family, floor, wall)


def _has_answer(problem: OptimisationProblem, family: Family) -> bool:
    """True if a family has an answer for the variables, the limit and the track of a problem."""
    plan, against = problem.plan, problem.against
    at_rest = "speed" not in plan.parameters and (
        plan.scene.name != "rectangle-on-track" or "centripetal_acceleration" in plan.defaults
    )
    is_limited_so = against is None or (
        against == "acceleration_y" and not family.startswith("track")
    )
    chooses = set(problem.names) <= set(ANGLES) and _within_reach(problem)
    return at_rest and is_limited_so and chooses


def _within_reach(problem: OptimisationProblem) -> bool:
    """True if the bounds are within half a turn of alpha, and beta within a right angle."""
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
    """True if there is a closed form: both angles from 0 to 90 degrees."""
    which = answered(problem)
    whole = (
        set(problem.names) == set(ANGLES)
        and bool(np.all(problem.lower == 0.0))
        and bool(np.all(problem.upper == np.pi / 2))
    )
    return which is not None and whole and isinstance(problem.criterion, CLOSED[which.family])


def is_compiled(problem: OptimisationProblem) -> bool:
    """True if the batch solver has the answer, or that of each point of a front."""
    which = answered(problem)
    criterion = problem.limited().criterion if is_front(problem) else problem.criterion
    return which is not None and isinstance(criterion, COMPILED[which.family])


def is_front(problem: OptimisationProblem) -> bool:
    """True if a whole front is asked for."""
    return isinstance(problem.criterion, Pareto)


def groups(problem: OptimisationProblem, design: Mapping[str, Array]) -> dict[str, Array]:
    """Return what the answers take, each of shape (cells,): drive, gravity and friction."""
    known = problem.known(np.broadcast_to(problem.lower[:, None], (len(problem.names), 1)), design)
    names = ("vibration_acceleration", "gravity_along", "gravity_normal", "friction_kinetic")
    given = {name: known[name] for name in names}
    for name in ("friction_static", "gravity_across"):
        if name in known:
            given[name] = known[name]
    for name in ANGLES:
        if name in known:
            given[name] = known[name]
    cells = next(iter(design.values())).shape
    return {n: np.broadcast_to(np.asarray(v, dtype=np.float64), cells) for n, v in given.items()}


def by_closed_form(problem: OptimisationProblem, design: Mapping[str, Array]) -> Optima:
    """Return the closed answer of every design."""
    which = answered(problem)
    assert which is not None
    given = groups(problem, design)
    plane = {
        name: given[name] for name in ("vibration_acceleration", "gravity_along", "gravity_normal")
    } | {"friction_kinetic": given["friction_kinetic"]}
    static = given.get("friction_static", given["friction_kinetic"])
    criterion = problem.criterion
    best: exact.PlaneOptimum | exact.TrackOptimum
    if which.family == "plane_thesis" and isinstance(criterion, Weighted):
        best = exact.plane_thesis_weighted(
            **plane, weight=criterion.weight, floor_contact=which.floor
        )
    elif which.family == "plane_thesis":
        limit = design.get(LIMIT, np.inf)
        best = exact.plane_thesis_limited(**plane, limit=limit, floor_contact=which.floor)
    elif which.family == "plane_physical":
        best = exact.plane_physical_fastest(**plane, friction_static=static)
    elif which.family == "cylinder_physical":
        best = exact.cylinder_physical_fastest(**plane, friction_static=static)
    elif which.family == "track_physical":
        best = exact.track_physical_fastest(
            **plane, gravity_across=given["gravity_across"], friction_static=static
        )
    else:
        track = {name: values for name, values in plane.items() if name != "gravity_normal"}
        best = exact.track_fastest(
            variant="thesis" if which.family == "track_thesis" else "derived",
            **track,
            gravity_across=given["gravity_across"],
            wall_contact=which.wall,
        )
    if isinstance(best, exact.TrackOptimum):
        value = best.starting_acceleration
    else:
        value = best.acceleration_x - problem.weight * np.abs(best.acceleration_y)
    return Optima(_ordered(problem, best.alpha, best.beta), best.status, value)


def by_closed_front(
    problem: OptimisationProblem, design: Mapping[str, Array], points: int
) -> Optima:
    """Return the closed front of every design, as `by_closed_form`; shape (cells * points,)."""
    which = answered(problem)
    assert which is not None
    given = groups(problem, design)
    front = exact.plane_thesis_pareto(
        vibration_acceleration=given["vibration_acceleration"],
        gravity_along=given["gravity_along"],
        gravity_normal=given["gravity_normal"],
        friction_kinetic=given["friction_kinetic"],
        floor_contact=which.floor,
        points=points,
    )
    x = _ordered(problem, front.alpha.ravel(), front.beta.ravel())
    return Optima(x, np.repeat(front.status, points), front.acceleration_x.ravel())


def by_newton(problem: OptimisationProblem, design: Mapping[str, Array]) -> Optima:
    """Return the compiled answer of every design."""
    which = answered(problem)
    assert which is not None
    family = which.family
    assert family != "cylinder_physical"
    given = groups(problem, design)
    bounds: dict[str, Any] = {}
    for name in ANGLES:
        if name in problem.names:
            place = problem.names.index(name)
            ends = (problem.lower[place], problem.upper[place])
        else:
            ends = (given[name], given[name])
        bounds[f"{name}_lower"], bounds[f"{name}_upper"] = ends
    bounds |= {name: values for name, values in given.items() if name not in ANGLES}
    best = newton.fastest(
        family,
        **bounds,
        limit=design.get(LIMIT, np.inf),
        floor_contact=which.floor,
        wall_contact=which.wall,
    )
    # The solver's residual is per radian, in units of the drive.
    span = float(np.max(problem.upper - problem.lower))
    residual = best.residual * given["vibration_acceleration"] * span
    return Optima(_ordered(problem, best.alpha, best.beta), best.status, best.objective, residual)


def _ordered(problem: OptimisationProblem, alpha: Array, beta: Array) -> Array:
    """Return the angles that are variables, shape (variables, cells)."""
    angles = {"alpha": alpha, "beta": beta}
    return np.stack([np.broadcast_to(angles[name], alpha.shape) for name in problem.names])
