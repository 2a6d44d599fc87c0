"""The system of a row of parts; the names of a study say which of them have their own numbers."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from core.errors import Problem
from core.mechanics.angles import cosine
from core.mechanics.arrays import Array, Mask
from core.motion import limits, scales
from core.motion.driven import driven
from core.motion.drives import Harmonics, Shape, Steps, shape_of
from core.motion.feeding import DEFAULTS, feed_rate, occupancy
from core.motion.groups import BLOCK_ON_FLOOR, row_groups
from core.motion.methods import METHODS
from core.motion.methods.rows import RowMotion, RowParts
from core.motion.result import STATUS
from core.quantities.row import NUMBERS
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
_NUMBERED = re.compile(rf"({'|'.join(NUMBERS)})_(\d+)")


@dataclass(frozen=True)
class NumberedParts:
    """The function of the equation that gives the parts of a row.

    Attributes
    ----------
    numbers : mapping of str to tuple of int
        Which parts have a friction, a mass, a gap of their own.
    count : int
        Parts that these numbers tell of; 0 if there are none.
    counted : bool
        Whether the study gives the number of parts, too.
    """

    numbers: Mapping[str, tuple[int, ...]]
    count: int
    counted: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "__doc__", "Return the parts of the row, from the rear on.")

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities that the parts need."""
        numbered = [f"{stem}_{n}" for stem, which in self.numbers.items() for n in which]
        common = ["mass"] if 0 < len(self.numbers["part_mass"]) < self.count or self._more else []
        counted = ["parts"] if self.counted or not self.count else []
        return (*counted, *numbered, *common, "part_restitution", "length_scale")

    @property
    def _more(self) -> bool:
        """Whether there may be parts without numbers, behind some that have a mass."""
        return self.counted and bool(self.numbers["part_mass"])

    @property
    def has_all_frictions(self) -> bool:
        """Whether no part needs a common friction."""
        return not self.counted and 0 < len(self.numbers["part_friction"]) == self.count

    @property
    def __signature__(self) -> inspect.Signature:
        """One argument a quantity."""
        keyword = inspect.Parameter.KEYWORD_ONLY
        return inspect.Signature([inspect.Parameter(name, keyword) for name in self.inputs])

    def __call__(self, **given: Any) -> RowParts:
        """Return the parts; of a mean number of parts, as in a search, the next whole one."""
        count = np.ceil(np.asarray(given.get("parts", float(self.count)), dtype=float))
        most = max(self.count, int(count.max()))
        places = range(1, most + 1)
        scale = given["length_scale"]
        common = given.get("mass", np.ones(()))
        return RowParts(
            number=np.maximum(count, self.count),
            friction=tuple(given.get(f"part_friction_{n}", np.full((), np.nan)) for n in places),
            mass=tuple(given.get(f"part_mass_{n}", common) for n in places),
            gap=tuple(given.get(f"part_gap_{n}", np.zeros(())) / scale for n in places),
            restitution=given["part_restitution"],
        )


def numbered(names: Iterable[str]) -> NumberedParts:
    """Return the parts that the names of a study's parameters tell of."""
    names = tuple(names)
    found = [match for match in map(_NUMBERED.fullmatch, names) if match]
    numbers = {
        stem: tuple(sorted(int(match[2]) for match in found if match[1] == stem))
        for stem in NUMBERS
    }
    behind = max(
        (n + (stem == "part_gap") for stem, which in numbers.items() for n in which), default=0
    )
    return NumberedParts(numbers, behind, "parts" in names)


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
        "the row falls into.",
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
            **DEFAULTS,
        },
        constraints=(STATIC_ABOVE_KINETIC, driven_within),
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
    return (*(own if parts.has_all_frictions else ()), Equation("row", parts, SOURCE))


def choose_row(system: Scene, names: tuple[str, ...]) -> tuple[Scene, list[Problem]]:
    """Return the system of the row that the names of a study's parameters tell of.

    The second is what is wrong with its drive.
    """
    parts = numbered(names)
    known = {
        name: tuple(
            one
            for equation in equations
            for one in (_given_by(parts) if equation.gives == "row" else (equation,))
        )
        for name, equations in system.variants.items()
    }
    system = replace(system, variants=known)
    shape, problems = shape_of(names)
    if shape is not None:
        problems = _beside_the_row(shape)
        system = driven(system, shape)
    return system, problems


def _beside_the_row(shape: Shape) -> list[Problem]:
    """Return why a drive moves no row that is known."""
    fix = "Give amplitude and beta of a sine, or steps along the track"
    if isinstance(shape, Harmonics):
        axis, order = shape.terms[0]
        message = "a row is known under a plain sine and under steps along the track"
        return [Problem(f"parameters.amplitude_{axis}_{order}", message, fix)]
    assert isinstance(shape, Steps)
    return [
        Problem(f"parameters.acceleration_{axis}_{n}", "a row is known under steps along", fix)
        for axis, n in shape.levels
        if axis != "along"
    ]
