"""The outputs of the motion of a row, and the conditions of its regimes."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, ratio
from vibrafeed.core.motion import scales
from vibrafeed.core.motion.feeding import occupancy
from vibrafeed.core.motion.methods.rows import RowMotion, RowParts
from vibrafeed.core.motion.rates import parts_per_minute
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.quantities.row import MAX_NUMBERED
from vibrafeed.core.scenes.scene import Condition, Equation, fields

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
