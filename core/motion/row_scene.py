"""The system of a row of parts; the names of a study say which of them have their own numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from core.errors import Problem
from core.mechanics.angles import cosine
from core.mechanics.arrays import Array, Mask, ratio
from core.motion import limits, scales
from core.motion.drive_units import ChosenUnit
from core.motion.driven import driven
from core.motion.drives import Harmonics, Shape, Steps, shape_of
from core.motion.feeding import DEFAULTS, feed_rate, occupancy
from core.motion.groups import BLOCK_ON_FLOOR, row_groups
from core.motion.methods import METHODS
from core.motion.methods.rows import RowMotion
from core.motion.result import STATUS
from core.motion.row_parts import NumberedParts, contradictions, numbered
from core.quantities.row import MAX_NUMBERED
from core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Constraint,
    Equation,
    Scene,
    fields,
)

ROW = "row-on-plane"
SOURCE = "theory 17"
IN_TURN = 3.7241
"""The throw number above which hops take two periods: parts that start apart may hop in turn."""
# --- equations


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


def mean_gap(*, motion: RowMotion, length_scale: Array) -> Array:
    """Return the mean gap between neighbours of one platoon, NaN if all are apart [m]."""
    return motion.gap * length_scale


def common_mass(*, mass: Array) -> Array:
    """Return what the masses of a row of equal parts are counted in [kg]."""
    return mass


def own_masses(*, motion: RowMotion) -> Array:
    """Return 1, in which the parts' own masses are counted [kg]."""
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
        collisions_per_period=("collisions", "the collisions in a period of the drive [1]"),
        flight_fraction=("flight", "share of the period in which the parts are off the floor [1]"),
        period_multiple=(
            "multiple",
            "after how many periods of the drive the motion repeats; 0 where it does not [1]",
        ),
        motion_status=("status", "how the motion ended, as a status"),
    ),
    Equation("occupancy", occupancy, "theory 13.12"),
    Equation("feed_rate", feed_rate, "theory 13.12"),
)


def _of_platoon(number: int) -> tuple[Equation, Equation]:
    """Return the equations of size and velocity of a platoon, 1 at the rear."""

    def size(*, motion: RowMotion) -> Array:
        return (motion.part_platoon == number).sum(axis=0).astype(float)

    def velocity(*, motion: RowMotion, velocity_scale: Array) -> Array:
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
    Condition("unresolved", is_unresolved, ANY_RESULT, otherwise="slip"),
    Condition("runaway", runs_away, ANY_RESULT),
    Condition("out_of_phase_possible", may_hop_in_turn, ANY_RESULT),
    Condition("separating", separates, ANY_RESULT),
    Condition("aperiodic", does_not_repeat, ANY_RESULT),
    Condition("period_doubled", takes_several_periods, ANY_RESULT),
    Condition("hopping", hops, ANY_RESULT),
    Condition("stick", rests, ANY_RESULT),
)


HELD: dict[str, Condition] = {
    "track_stop_gap": Condition("indeterminate_force", is_blocked, ANY_RESULT),
    "fixed_stop_gap": Condition("blocked", is_blocked, ANY_RESULT),
}
"""What is said where a row touches its stop, by the parameter that gives one."""


def drive_number_along(*, drive_number: Array, beta: Array) -> Array:
    """Return the drive number along the track, p cos(beta) [1]."""
    return drive_number * cosine(beta)


def row_scene(scales_of_drive: tuple[Equation, ...], driven_within: Constraint) -> Scene:
    """Return the system of a row whose parts have no numbers of their own."""
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
        "rebound from the floor, so that all hop at once. Mean values are those of the motion that "
        "the row falls into. Parts may have numbers of their own (part_friction_1, ...); "
        "fixed_stop_gap or track_stop_gap put a stop in front of the row, friction_spread draws "
        "the frictions of its parts.",
        variants={
            name: (*in_space, *_given_by(numbered(())), *_followed(method))
            for name, method in METHODS["row"].items()
        },
        default_variant="events",
        conditions=dict.fromkeys(METHODS["row"], CONDITIONS),
        defaults={
            "gamma": 0.0,
            "gravity": STANDARD_GRAVITY,
            "hold_down_number": 0.0,
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


def _followed(method: Any) -> tuple[Equation, ...]:
    return (Equation("motion", method.follow(BLOCK_ON_FLOOR), method.source), *RESULTS)


def _given_by(parts: NumberedParts) -> tuple[Equation, ...]:
    own = (
        Equation("friction_static", own_static, SOURCE),
        Equation("friction_kinetic", own_kinetic, SOURCE),
    )
    return (
        *(own if parts.has_all_frictions else ()),
        Equation("row", parts, SOURCE),
        Equation("mass_scale", own_masses if parts.has_own_masses else common_mass, SOURCE),
    )


def choose_row(system: Scene, method: str, names: tuple[str, ...]) -> tuple[Scene, list[Problem]]:
    """Return the system of the row that the names of a study's parameters tell of.

    The second is what is wrong with them, and with the drive of a row by this method.
    """
    parts, problems = numbered(names), contradictions(names)
    known = {
        name: tuple(
            one
            for equation in equations
            if equation.gives != "mass_scale"
            for one in (_given_by(parts) if equation.gives == "row" else (equation,))
        )
        for name, equations in system.variants.items()
    }
    system = replace(system, variants=known)
    if parts.stop_gap:
        held = (*CONDITIONS[:2], HELD[parts.stop_gap], *CONDITIONS[2:])
        system = replace(system, conditions=dict.fromkeys(system.conditions, held))
    shape, wrong = shape_of(names)
    if shape is not None:
        wrong = [*wrong, *(_beside_events(shape) if method == "events" else [])]
        system = driven(system, shape)
    return system, [*problems, *wrong]


def of_unit(unit: ChosenUnit | None, method: str, names: tuple[str, ...]) -> list[Problem]:
    """Return why a drive unit cannot move the row that the names of parameters tell of."""
    if unit is None:
        return []
    problems, parts = [], numbered(names)
    if unit.loaded and (parts.drawn or parts.stop_gap or parts.numbers["part_friction"]):
        message = "what a row does to its drive unit is known of free parts of one friction"
        fix = "Give load_mass in its place, or one friction and no stop"
        problems.append(Problem("parameters.conveyed_mass", message, fix))
    if unit.shape is not None and method == "events":
        problems += [
            replace(one, place="parameters.force_harmonic")
            for one in _beside_events(Harmonics((("along", 2),)))
        ]
    return problems


def _beside_events(shape: Shape) -> list[Problem]:
    """Return why a row under a drive cannot be followed from event to event."""
    fix = "Set method = 'time-stepping', or give amplitude and beta of a sine, or steps along"
    if isinstance(shape, Harmonics):
        axis, order = shape.terms[0]
        message = "the method events follows rows under a plain sine and steps along the track"
        return [Problem(f"parameters.amplitude_{axis}_{order}", message, fix)]
    assert isinstance(shape, Steps)
    message = "the method events follows rows under steps along the track only"
    return [
        Problem(f"parameters.acceleration_{axis}_{n}", message, fix)
        for axis, n in shape.levels
        if axis != "along"
    ]
