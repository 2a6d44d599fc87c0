"""The system of a row of parts; the names of a study say which of them have their own numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.angles import cosine
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import limits
from vibrafeed.core.motion.drive_units import ChosenUnit
from vibrafeed.core.motion.driven import driven
from vibrafeed.core.motion.drives import shape_of
from vibrafeed.core.motion.feeding import DEFAULTS
from vibrafeed.core.motion.groups import BLOCK_ON_FLOOR, row_groups
from vibrafeed.core.motion.methods import METHODS
from vibrafeed.core.motion.row_parts import NumberedParts, contradictions, numbered
from vibrafeed.core.motion.row_results import (
    BEFORE_MOTION,
    CONDITIONS,
    HELD,
    RESULTS,
    SOURCE,
    TIPPING,
    common_mass,
    own_kinetic,
    own_masses,
    own_static,
)
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Constraint,
    Equation,
    Scene,
)

ROW = "row-on-plane"


def drive_number_along(*, drive_number: Array, beta: Array) -> Array:
    """Return the drive number along the track, p cos(beta) [1]."""
    return drive_number * cosine(beta)


def row_scene(scales_of_drive: tuple[Equation, ...], driven_within: Constraint) -> Scene:
    """Return the scene in which a row of equal parts moves along a track, with its equations.

    `scales_of_drive` are the equations of the drive's scales, such as g/w, `driven_within` is the
    constraint on the drive's frequency. Parts with numbers of their own change it later.
    """
    in_space = (
        *(one for one in scales_of_drive if one.gives != "drive_number_along"),
        Equation("drive_number_along", drive_number_along, SOURCE),
        *limits.equations("sine", ("along", "normal")),
        Equation("groups", row_groups, SOURCE),
    )
    return Scene(
        name=ROW,
        title="Motion in time of a row of parts in one lane",
        source=SOURCE,
        validity="Equal faces, smooth and normal to the track; parts start at rest, and do not "
        "rebound from the floor, so that all hop at once (restitution above 0: not_supported). "
        "Mean values are those of the motion that the row falls into. Parts may have numbers of "
        "their own (part_friction_1, ...); "
        "fixed_stop_gap or track_stop_gap put a stop in front of the row, friction_spread draws "
        "the frictions of its parts; with height, tipping is where friction can tip a part.",
        variants={
            name: (*in_space, *_equations_of_parts(numbered(())), *_equations_of_method(method))
            for name, method in METHODS["row"].items()
        },
        default_variant="events",
        conditions=dict.fromkeys(METHODS["row"], CONDITIONS),
        defaults={
            "gamma": 0.0,
            "gravity": STANDARD_GRAVITY,
            "hold_down_number": 0.0,
            "restitution": 0.0,
            "part_restitution": 0.0,
            "friction_seed": 0.0,
            **DEFAULTS,
        },
        constraints=(
            STATIC_ABOVE_KINETIC,
            driven_within,
            *(refusal for method in METHODS["row"].values() for refusal in method.refuses),
        ),
        choice="method",
        variant_defaults={name: method.defaults for name, method in METHODS["row"].items()},
    )


def _equations_of_method(method: Any) -> tuple[Equation, ...]:
    """Return the equations of the motion by a method, and of its results."""
    return (Equation("motion", method.follow(BLOCK_ON_FLOOR), method.source), *RESULTS)


def _equations_of_parts(parts: NumberedParts) -> tuple[Equation, ...]:
    """Return the equations that give the parts of a row, and the scale of their masses.

    `parts` says which numbers the parts have of their own. If every part has its own friction, that
    of the track need not be given.
    """
    own = (
        Equation("friction_static", own_static, SOURCE),
        Equation("friction_kinetic", own_kinetic, SOURCE),
    )
    return (
        *(own if parts.has_all_frictions else ()),
        Equation(
            "row",
            parts.row,
            SOURCE,
            needs=parts.inputs,
            says="Return the parts of the row, from the rear on.",
        ),
        Equation("mass_scale", own_masses if parts.has_own_masses else common_mass, SOURCE),
    )


def choose_row(system: Scene, names: tuple[str, ...]) -> tuple[Scene, list[Problem]]:
    """Return the scene of the row of parts that a study's parameter names define, and problems.

    The names say which numbers each part has of its own, whether a stop stands in front, whether
    parts may tip, and what the drive is. `system` is the scene of rows in general. The problems are
    names that exclude each other or define no drive.
    """
    parts, problems = numbered(names), contradictions(names)
    known = {
        name: tuple(
            one
            for equation in equations
            if equation.gives != "mass_scale"
            for one in (_equations_of_parts(parts) if equation.gives == "row" else (equation,))
        )
        for name, equations in system.variants.items()
    }
    system = replace(system, variants=known)
    more = (
        *((TIPPING,) if "height" in names else ()),
        *((HELD[parts.stop_gap],) if parts.stop_gap else ()),
    )
    said = (*CONDITIONS[:BEFORE_MOTION], *more, *CONDITIONS[BEFORE_MOTION:])
    system = replace(system, conditions=dict.fromkeys(system.conditions, said))
    shape, wrong = shape_of(names)
    if shape is not None:
        system = driven(system, shape)
    return system, [*problems, *wrong]


def of_unit(unit: ChosenUnit | None, names: tuple[str, ...]) -> list[Problem]:
    """Return the problems of a drive unit whose load by a row of such parts is not modelled.

    `unit` is the drive unit of the study, `names` are its parameter names. Empty if there is no
    unit, or no problem.
    """
    if unit is None:
        return []
    problems, parts = [], numbered(names)
    if unit.loaded and (parts.drawn or parts.stop_gap or parts.numbers["part_friction"]):
        message = (
            "the effect of a row on its drive unit is modelled only for free parts of one friction"
        )
        fix = "Give load_mass in its place, or one friction and no stop"
        problems.append(Problem("parameters.conveyed_mass", message, fix))
    return problems
