"""The system of a row of parts; the names of a study say which of them have their own numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, ratio
from vibrafeed.core.motion import limits, scales
from vibrafeed.core.motion.drive_units import ChosenUnit
from vibrafeed.core.motion.drives import driven, shape_of
from vibrafeed.core.motion.feeding import DEFAULTS, occupancy, parts_per_minute
from vibrafeed.core.motion.groups import BLOCK_ON_FLOOR, row_groups
from vibrafeed.core.motion.methods import METHODS
from vibrafeed.core.motion.methods.rows import RowMotion, RowParts
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.motion.row_parts import NumberedParts, contradictions, numbered
from vibrafeed.core.quantities.row import MAX_NUMBERED
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Constraint,
    Equation,
    Scene,
    fields,
)

SOURCE = "theory 17"
IN_TURN = 3.7241
"""The throw number above which hops take two periods: parts that start apart may hop in turn."""


def own_static(*, part_friction_1: Array) -> Array:
    """Return the static friction of the rearmost part, where each part has its own [1]."""
    return part_friction_1


def own_kinetic(*, part_friction_1: Array) -> Array:
    """Return the kinetic friction of the rearmost part, where each part has its own [1]."""
    return part_friction_1


def slowest_velocity(*, motion: RowMotion, velocity_scale: Array) -> Array:
    """Return the mean velocity of the slowest part [m s-1]."""
    return motion.slowest * velocity_scale


def fastest_part_velocity(*, motion: RowMotion, velocity_scale: Array) -> Array:
    """Return the mean velocity of the fastest part [m s-1]."""
    return motion.fastest * velocity_scale


def feed_rate(
    *, motion: RowMotion, conveying_velocity: Array, velocity_scale: Array, length: Array,
    occupancy: Array,
) -> Array:  # fmt: skip
    """Return the parts a minute that leave, 60 v occupancy/length, those that come behind alike.

    v is the velocity of the row; where platoons leave each other, of the last of them: where it
    comes from the lane is full, and what is faster in front only gets farther apart. It is 0 where
    platoons leave to both sides, and below 0 where all travel back.
    """
    last = np.maximum(motion.slowest, 0.0) + np.minimum(motion.fastest, 0.0)
    velocity = np.where(separates(motion=motion), last * velocity_scale, conveying_velocity)
    return parts_per_minute(velocity=velocity, length=length / occupancy)


def mean_gap(*, motion: RowMotion, length_scale: Array) -> Array:
    """Return the mean gap between neighbours of one platoon, NaN if all are apart [m]."""
    return motion.gap * length_scale


def common_mass(*, mass: Array) -> Array:
    """Return the common mass of equal parts, by which masses of the row are scaled [kg]."""
    return mass


def own_masses(*, motion: RowMotion) -> Array:
    """Return 1, by which parts' own masses are scaled; NaN without a motion [kg]."""
    return np.where(np.isnan(motion.velocity), np.nan, 1.0)


def impact_energy(*, motion: RowMotion, mass_scale: Array, velocity_scale: Array) -> Array:
    """Return the energy that collisions of parts take in a period of the drive [J]."""
    return motion.impact * mass_scale * np.square(velocity_scale)


def stop_force(*, motion: RowMotion, mass_scale: Array, acceleration_scale: Array) -> Array:
    """Return the mean force on the stop, strokes included; the least on one of the track [N]."""
    return motion.stop_force * mass_scale * acceleration_scale


def stop_force_peak(*, motion: RowMotion, mass_scale: Array, acceleration_scale: Array) -> Array:
    """Return the largest force on the stop between strokes [N]."""
    return motion.stop_peak * mass_scale * acceleration_scale


def stop_impulse(*, motion: RowMotion, mass_scale: Array, velocity_scale: Array) -> Array:
    """Return the impulse of all strokes against the stop in a period of the drive [N s]."""
    return motion.stop_impulse * mass_scale * velocity_scale


def rebounds(*, restitution: Array) -> Mask:
    """True where parts rebound from the floor, so that they hop separately."""
    return restitution > 0.0


def tips(*, row: RowParts, friction_static: Array, height: Array, length: Array) -> Mask:
    """True where friction can tip a part of the row over, mu_s b > h.

    Neighbours and a stop push at half the height b of a part, and so have no moment about its
    centre of mass; friction has mu n m b/2, against n m h/2 of the floor at the length h. The
    largest static friction of all parts counts: of each its own in `row`, where that is NaN
    `friction_static`. `height` and `length` are those of a part along the track [m].
    """
    most = np.zeros(())
    for n, own in enumerate(row.friction):
        mu = np.where(np.isnan(own), friction_static, own)
        if row.shift:
            mu = np.maximum(0.0, mu + row.shift[n])
        most = np.maximum(most, np.where(n < row.number, mu, 0.0))
    return most * height > length


def is_blocked(*, motion: RowMotion) -> Mask:
    """True where a stop at rest in space holds the row."""
    return motion.stop_contact > 0.0


def is_unresolved(*, motion: RowMotion) -> Mask:
    """True where no motion was found."""
    none = ("not_computed", "limit_reached", "no_drive")
    return np.isin(motion.status, [STATUS[name] for name in none])


def runs_away(*, motion: RowMotion) -> Mask:
    """True where the parts gain speed for ever."""
    return motion.status == STATUS["runaway"]


def may_hop_in_turn(*, throw_number: Array) -> Mask:
    """True where hops take two periods, so that parts may hop in turn."""
    return throw_number > IN_TURN


def separates(*, motion: RowMotion) -> Mask:
    """True where platoons leave each other for ever."""
    return motion.platoons > 1


def does_not_repeat(*, motion: RowMotion) -> Mask:
    """True where the motion of the row does not repeat."""
    return np.isin(motion.status, [STATUS["aperiodic"], STATUS["sensitive"]])


def takes_several_periods(*, motion: RowMotion) -> Mask:
    """True where the motion of the row repeats after two periods of the drive or more."""
    return motion.multiple > 1


def hops(*, motion: RowMotion) -> Mask:
    """True where the parts are in the air for a part of the period."""
    return motion.flight > 0


def rests(*, motion: RowMotion) -> Mask:
    """True where friction holds all parts all the time."""
    return motion.status == STATUS["at_rest"]


RESULTS = (
    Equation("conveying_velocity", scales.conveying_velocity, SOURCE),
    Equation("conveying_velocity_spread", scales.conveying_velocity_spread, SOURCE),
    Equation("conveying_velocity_error", scales.conveying_velocity_error, SOURCE),
    Equation("slowest_velocity", slowest_velocity, SOURCE),
    Equation("fastest_part_velocity", fastest_part_velocity, SOURCE),
    *fields(
        "motion",
        SOURCE,
        stop_contact_fraction=(
            "stop_contact",
            "the share of the time in which the row touches its stop [1]",
        ),
        platoons=("platoons", "the groups of parts that have left each other for ever [1]"),
        contact_fraction=("contact", "the share of the time in which neighbours touch [1]"),
        collisions_per_period=("collisions", "the contacts that close in a period [1]"),
        flight_fraction=("flight", "share of the period in which the parts are off the floor [1]"),
        period_multiple=(
            "multiple",
            "after how many periods of the drive the motion repeats; 0 where it does not [1]",
        ),
        motion_status=("status", "how the motion ended, as a status"),
    ),
    Equation("occupancy", occupancy, "theory 13.12"),
    Equation("feed_rate", feed_rate, SOURCE),
)


def _of_platoon(number: int) -> tuple[Equation, Equation]:
    """Return the equations of size and mean velocity of one platoon of a row of parts.

    A platoon is a group of parts that stay together; `number` counts them from 1 at the rear.
    Without such a platoon the size is 0 and the velocity NaN.
    """

    def size(*, motion: RowMotion) -> Array:
        """Return the number of parts in the platoon."""
        return (motion.part_platoon == number).sum(axis=0).astype(float)

    def velocity(*, motion: RowMotion, velocity_scale: Array) -> Array:
        """Return the mean velocity of the platoon [m s-1]."""
        inside = motion.part_platoon == number
        total = np.where(inside, motion.part_velocity, 0.0).sum(axis=0)
        return ratio(total, inside.sum(axis=0), np.nan) * velocity_scale

    size.__doc__ = f"Return the parts of platoon {number} from the rear; 0 if there is none [1]."
    velocity.__doc__ = "Return its mean velocity, NaN if there is none [m s-1]."
    return (
        Equation(f"platoon_size_{number}", size, SOURCE),
        Equation(f"platoon_velocity_{number}", velocity, SOURCE),
    )


RESULTS = (
    *RESULTS,
    *(one for n in range(1, MAX_NUMBERED + 1) for one in _of_platoon(n)),
    Equation("mean_gap", mean_gap, SOURCE),
    *(
        Equation(one.__name__, one, SOURCE)
        for one in (impact_energy, stop_force, stop_force_peak, stop_impulse)
    ),
)
ANY_RESULT = frozenset(one.gives for one in RESULTS if one.gives != "occupancy") | {"regime"}
CONDITIONS = (
    Condition("not_supported", rebounds, ANY_RESULT),
    Condition("unresolved", is_unresolved, ANY_RESULT, otherwise="slip"),
    Condition("runaway", runs_away, ANY_RESULT),
    Condition("out_of_phase_possible", may_hop_in_turn, ANY_RESULT),
    Condition("separating", separates, ANY_RESULT),
    Condition("aperiodic", does_not_repeat, ANY_RESULT),
    Condition("period_doubled", takes_several_periods, ANY_RESULT),
    Condition("hopping", hops, ANY_RESULT),
    Condition("stick", rests, ANY_RESULT),
)


BEFORE_MOTION = 3
"""Conditions that say there is no motion; what a study's names add comes behind them."""
HELD: dict[str, Condition] = {
    "track_stop_gap": Condition("indeterminate_force", is_blocked, ANY_RESULT),
    "fixed_stop_gap": Condition("blocked", is_blocked, ANY_RESULT),
}
"""Conditions of a row that touches its stop, by the parameter that gives the stop."""


TIPPING = Condition("tipping", tips, ANY_RESULT)
"""Condition of a study that gives the height of the parts."""


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
