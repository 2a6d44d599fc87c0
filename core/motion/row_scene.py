"""The system of a row of parts; the names of a study say which of them have their own numbers."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.arrays import Array, Mask, ratio
from vibrafeed.core.motion import scales
from vibrafeed.core.motion.drives import limits
from vibrafeed.core.motion.feeding import DEFAULTS, occupancy, parts_per_minute
from vibrafeed.core.motion.method import STATUS, of_quantities, where
from vibrafeed.core.motion.rows import EVENTS, RowMotion, RowParts
from vibrafeed.core.quantities.row import MAX_NUMBERED, NUMBERS
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Equation,
    Scene,
    fields,
)

ROW = "row-on-plane"
SOURCE = "theory 17"
IN_TURN = 3.7241
"""The throw number above which hops take two periods: parts that start apart may hop in turn."""


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
    velocity = np.where(motion.platoons > 1, last * velocity_scale, conveying_velocity)
    return parts_per_minute(velocity=velocity, length=length / occupancy)


def own_masses(*, motion: RowMotion) -> Array:
    """Return 1, by which parts' own masses are scaled; NaN without a motion [kg]."""
    return np.where(np.isnan(motion.velocity), np.nan, 1.0)


def impact_energy(*, motion: RowMotion, mass_scale: Array, velocity_scale: Array) -> Array:
    """Return the energy that collisions of parts take in a period of the drive [J]."""
    return motion.impact * mass_scale * np.square(velocity_scale)


def tips(*, row: RowParts, friction_static: Array, height: Array, length: Array) -> Mask:
    """True where friction can tip a part of the row over, mu_s b > h.

    Neighbours and a stop push at half the height b of a part, and so have no moment about its
    centre of mass; friction has mu n m b/2, against n m h/2 of the floor at the length h. The
    largest static friction of all parts counts: of each its own in `row`, where that is NaN
    `friction_static`. `height` and `length` are those of a part along the track [m].
    """
    largest = np.zeros(())
    for n, own_friction in enumerate(row.friction):
        friction = np.where(np.isnan(own_friction), friction_static, own_friction)
        if row.shift:
            friction = np.maximum(0.0, friction + row.shift[n])
        largest = np.maximum(largest, np.where(n < row.number, friction, 0.0))
    return largest * height > length


def _has_status(motion: RowMotion, *names: str) -> Mask:
    return np.isin(motion.status, [STATUS[name] for name in names])


STOP_GAPS = {"track_stop_gap": "track", "fixed_stop_gap": "space"}
"""Parameters that put a stop in front of a row, and which; at most one of them is given."""

MAX_DEVIATIONS = 3.0
"""Standard deviations at which sampled frictions are cut off."""
DRAWN = 256
"""Deviations sampled for a seed: enough for the longest row after the cut."""

_NUMBERED = re.compile(rf"({'|'.join(NUMBERS)})_(\d+)")


@dataclass(frozen=True)
class NumberedParts:
    """The numbers that the parts of a row have of their own.

    Attributes
    ----------
    numbers
        By the stem of a parameter (`part_friction`, ...), the parts with their own value of it.
    count
        Smallest number of parts that these numbers imply; 0 if there are none.
    counted
        If the study gives the number of parts, too.
    stop_gap
        Parameter that puts a stop in front of the row; empty if none does.
    drawn
        If the frictions of the parts are sampled at random.
    """

    numbers: Mapping[str, tuple[int, ...]]
    count: int
    counted: bool
    stop_gap: str = ""
    drawn: bool = False

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities that the parts are made from, as an equation takes them."""
        numbered = [
            f"{stem}_{n}" for stem, part_numbers in self.numbers.items() for n in part_numbers
        ]
        common = ["mass"] if self.numbers["part_mass"] and not self.gives_all("part_mass") else []
        counted = ["parts"] if self.counted or not self.count else []
        drawn = ["friction_spread", "friction_seed"] if self.drawn else []
        stop = [self.stop_gap] if self.stop_gap else []
        return (*counted, *numbered, *common, *drawn, *stop, "part_restitution", "length_scale")

    def gives_all(self, stem: str) -> bool:
        """True if every part has its own number, such as a `part_mass`."""
        return not self.counted and 0 < len(self.numbers[stem]) == self.count

    def row(self, **quantities: Any) -> RowParts:
        """Return the parts of the row, from the quantities of `inputs` by name.

        A fractional number of parts is rounded up.
        """
        count = np.ceil(np.asarray(quantities.get("parts", float(self.count)), dtype=float))
        most_parts = max(self.count, int(count.max()))
        places = range(1, most_parts + 1)
        scale = quantities["length_scale"]
        common = quantities.get("mass", np.ones(()))
        parts = RowParts(
            number=np.maximum(count, self.count),
            friction=tuple(
                quantities.get(f"part_friction_{n}", np.full((), np.nan)) for n in places
            ),
            mass=tuple(quantities.get(f"part_mass_{n}", common) for n in places),
            gap=tuple(quantities.get(f"part_gap_{n}", np.zeros(())) / scale for n in places),
            restitution=quantities["part_restitution"],
        )
        if self.drawn:
            shift = (
                drawn_deviations(quantities["friction_seed"], most_parts)
                * quantities["friction_spread"]
            )
            parts = parts._replace(shift=tuple(shift))
        if self.stop_gap:
            gap = quantities[self.stop_gap] / scale
            parts = parts._replace(stop=STOP_GAPS[self.stop_gap], stop_gap=gap)
        return parts


def drawn_deviations(seed: Array, parts: int) -> Array:
    """Return random deviations of the friction of parts in a row, in standard deviations.

    Shape (parts, ...), with the shape of `seed` behind. Those of a longer row begin with those of a
    shorter one, so that rows can be compared.
    """
    seeds, seed_index = np.unique(np.asarray(seed), return_inverse=True)
    samples = [np.random.default_rng(int(number)).standard_normal(DRAWN) for number in seeds]
    deviations: Array = np.array(
        [sample[np.abs(sample) <= MAX_DEVIATIONS][:parts] for sample in samples]
    ).T
    return deviations[:, seed_index.reshape(np.shape(seed))]


def numbered(names: tuple[str, ...]) -> NumberedParts:
    """Return the numbers of their own that a study's parameter names give to parts of a row."""
    matches = [match for match in map(_NUMBERED.fullmatch, names) if match]
    numbers = {
        stem: tuple(sorted(int(match[2]) for match in matches if match[1] == stem))
        for stem in NUMBERS
    }
    last_numbered = max(
        (n + (stem == "part_gap") for stem, part_numbers in numbers.items() for n in part_numbers),
        default=0,
    )
    stop = next((name for name in STOP_GAPS if name in names), "")
    return NumberedParts(numbers, last_numbered, "parts" in names, stop, "friction_spread" in names)


def problems_of_row(names: tuple[str, ...]) -> Iterator[Problem]:
    """Yield the problems of a row's parameters that exclude each other."""
    if all(name in names for name in STOP_GAPS):
        yield Problem(
            "parameters.track_stop_gap",
            f"the study has two stops ({' and '.join(STOP_GAPS)}), but a row has only one",
            "Remove one of the two",
        )
    own = [name for name in names if name.startswith("part_friction_")]
    if "friction_spread" in names and own:
        yield Problem(
            "parameters.friction_spread",
            f"friction_spread makes the friction of each part random, but {own[0]} is given",
            "Remove friction_spread, or all part_friction_... parameters",
        )


def problems_of_load(names: tuple[str, ...]) -> Iterator[Problem]:
    """Yield the problem of a row whose load on its drive unit is not modelled, if it is not."""
    parts = numbered(names)
    if parts.drawn or parts.stop_gap or parts.numbers["part_friction"]:
        yield Problem(
            "parameters.conveyed_mass",
            "conveyed_mass can be used only for a row of parts with equal friction and no stop",
            "Give load_mass instead, or one friction and no stop",
        )


def _platoon_size(number: int, *, motion: RowMotion) -> Array:
    return (motion.part_platoon == number).sum(axis=0).astype(float)


def _platoon_velocity(number: int, *, motion: RowMotion, velocity_scale: Array) -> Array:
    in_platoon = motion.part_platoon == number
    total = np.where(in_platoon, motion.part_velocity, 0.0).sum(axis=0)
    return ratio(total, in_platoon.sum(axis=0), np.nan) * velocity_scale


RESULTS = (
    *(
        replace(one, source=SOURCE)
        for one in (
            scales.CONVEYING_VELOCITY,
            scales.CONVEYING_VELOCITY_SPREAD,
            scales.CONVEYING_VELOCITY_ERROR,
        )
    ),
    scales.product(
        "slowest_velocity", "motion.slowest", "velocity_scale", source=SOURCE,
        says="the mean velocity of the slowest part [m s-1]",
    ),
    scales.product(
        "fastest_part_velocity", "motion.fastest", "velocity_scale", source=SOURCE,
        says="the mean velocity of the fastest part [m s-1]",
    ),
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
    *(
        Equation(f"platoon_{what}_{n}", partial(function, n), SOURCE, says=says.format(n))
        for n in range(1, MAX_NUMBERED + 1)
        for what, function, says in (
            ("size", _platoon_size,
             "Return the parts of platoon {} from the rear; 0 if there is none [1]."),
            ("velocity", _platoon_velocity,
             "Return its mean velocity, NaN if there is none [m s-1]."),
        )
    ),
    scales.product(
        "mean_gap", "motion.gap", "length_scale", source=SOURCE,
        says="the mean gap between neighbours of one platoon, NaN if all are apart [m]",
    ),
    Equation("impact_energy", impact_energy, SOURCE),
    scales.product(
        "stop_force", "motion.stop_force", "mass_scale", "acceleration_scale", source=SOURCE,
        says="the mean force on the stop, strokes included; the least on one of the track [N]",
    ),
    scales.product(
        "stop_force_peak", "motion.stop_peak", "mass_scale", "acceleration_scale", source=SOURCE,
        says="the largest force on the stop between strokes [N]",
    ),
    scales.product(
        "stop_impulse", "motion.stop_impulse", "mass_scale", "velocity_scale", source=SOURCE,
        says="the impulse of all strokes against the stop in a period of the drive [N s]",
    ),
)  # fmt: skip
ANY_RESULT = frozenset(one.gives for one in RESULTS if one.gives != "occupancy") | {"regime"}
CONDITIONS = (
    where(
        "not_supported", "parts rebound from the floor, so that they hop separately",
        lambda *, restitution: restitution > 0.0, ANY_RESULT,
    ),
    where(
        "unresolved", "no motion was found",
        lambda *, motion: _has_status(motion, "not_computed", "limit_reached", "no_drive"),
        ANY_RESULT, otherwise="slip",
    ),
    where(
        "runaway", "the parts gain speed for ever",
        lambda *, motion: _has_status(motion, "runaway"), ANY_RESULT,
    ),
    where(
        "out_of_phase_possible", "hops take two periods, so that parts may hop in turn",
        lambda *, throw_number: throw_number > IN_TURN, ANY_RESULT,
    ),
    where(
        "separating", "platoons leave each other for ever",
        lambda *, motion: motion.platoons > 1, ANY_RESULT,
    ),
    where(
        "aperiodic", "the motion of the row does not repeat",
        lambda *, motion: _has_status(motion, "aperiodic", "sensitive"), ANY_RESULT,
    ),
    where(
        "period_doubled", "the motion of the row repeats after two periods of the drive or more",
        lambda *, motion: motion.multiple > 1, ANY_RESULT,
    ),
    where(
        "hopping", "the parts are in the air for a part of the period",
        lambda *, motion: motion.flight > 0, ANY_RESULT,
    ),
    where(
        "stick", "friction holds all parts all the time",
        lambda *, motion: _has_status(motion, "at_rest"), ANY_RESULT,
    ),
)  # fmt: skip


BEFORE_MOTION = 3
"""Conditions that say there is no motion; what a study's names add comes behind them."""
HELD: dict[str, Condition] = {
    gap: where(
        regime, "a stop at rest in space holds the row",
        lambda *, motion: motion.stop_contact > 0.0, ANY_RESULT,
    )
    for gap, regime in {
        "track_stop_gap": "indeterminate_force", "fixed_stop_gap": "blocked"
    }.items()
}  # fmt: skip
"""Conditions of a row that touches its stop, by the parameter that gives the stop."""


TIPPING = Condition("tipping", tips, ANY_RESULT)
"""Condition of a study that gives the height of the parts."""


def _equations_of_parts(parts: NumberedParts) -> tuple[Equation, ...]:
    # The equations that make the record `row` from the numbers that the study names, and the scale
    # of its masses.
    says = "the {} friction of the rearmost part, where each part has its own [1]"
    own = (
        scales.product(f"friction_{kind}", "part_friction_1", source=SOURCE, says=says.format(kind))
        for kind in ("static", "kinetic")
    )
    says = "Return the parts of the row, from the rear on."
    return (
        *(own if parts.gives_all("part_friction") else ()),
        Equation("row", parts.row, SOURCE, needs=parts.inputs, says=says),
        Equation("mass_scale", own_masses, SOURCE)
        if parts.numbers["part_mass"]
        else scales.product(
            "mass_scale", "mass", source=SOURCE,
            says="the common mass of equal parts, by which masses of the row are scaled [kg]",
        ),
    )  # fmt: skip


_IN_PLANE = (
    *(one for one in scales.PLANAR_SCALES if one.gives != "drive_number_along"),
    Equation("drive_number_along", scales.drive_number_in_plane, SOURCE),
    *limits("sine", ("along", "normal")),
    Equation(
        "groups",
        of_quantities,
        SOURCE,
        needs=(
            "drive_number_along", "drive_number_normal", "gravity_number_along", "load_number",
            "friction_static", "friction_kinetic", "restitution",
        ),
        says="Return the dimensionless groups of the parts of a row, as one record for the "
        "kernels.",
    ),
)  # fmt: skip


def row_of(names: tuple[str, ...]) -> Scene:
    """Return the scene of the row of parts that a study's parameter names define, under a sine.

    They say which numbers each part has of its own, if a stop stands in front, and if parts may
    tip.
    """
    parts = numbered(names)
    extra_conditions = (
        *((TIPPING,) if "height" in names else ()),
        *((HELD[parts.stop_gap],) if parts.stop_gap else ()),
    )
    return Scene(
        name=ROW,
        title="Motion in time of a row of parts in one lane",
        source=SOURCE,
        validity="The faces of the parts are equal, smooth and normal to the track. The parts "
        "start at rest and do not rebound from the floor, so that all parts hop at once (with "
        "restitution above 0 the regime is not_supported). Mean values are those of the motion "
        "that the row finally reaches. Parts can have numbers of their own (part_friction_1, "
        "...). fixed_stop_gap or track_stop_gap puts a stop in front of the row, and "
        "friction_spread samples the friction of its parts. If the study gives height, the regime "
        "tipping marks the cells in which friction can tip a part.",
        variants={
            "events": (
                *_IN_PLANE,
                *_equations_of_parts(parts),
                Equation("motion", EVENTS.follow, SOURCE),
                *RESULTS,
            )
        },
        default_variant="events",
        conditions={
            "events": (*CONDITIONS[:BEFORE_MOTION], *extra_conditions, *CONDITIONS[BEFORE_MOTION:])
        },
        defaults={
            "gamma": 0.0,
            "gravity": STANDARD_GRAVITY,
            "hold_down_number": 0.0,
            "restitution": 0.0,
            "part_restitution": 0.0,
            "friction_seed": 0.0,
            **DEFAULTS,
        },
        constraints=(STATIC_ABOVE_KINETIC, scales.DRIVEN),
        choice="method",
        variant_defaults={"events": EVENTS.defaults},
    )
