"""The system of a tumbling part: its equations and conditions."""

from __future__ import annotations

from collections.abc import Callable

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.motion.methods import METHODS
from vibrafeed.core.motion.methods.tumbling import (
    Part,
    Throw,
    Tumble,
    TumblingCylinder,
    TumblingRectangle,
)
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Equation,
    Scene,
    fields,
)


def rectangle(*, length: Array, height: Array) -> Part:
    """Return the rectangular part."""
    return TumblingRectangle(length, height)


def cylinder(*, length: Array, diameter: Array) -> Part:
    """Return the cylindrical part, seen along its side."""
    return TumblingCylinder(length, diameter)


def throw(
    *,
    tumbling_part: Part,
    friction_static: Array,
    friction_kinetic: Array,
    restitution: Array,
    duration: Array,
    gravity: Array,
    gamma: Array,
    frequency: Array,
    amplitude: Array,
    beta: Array,
    drop_height: Array,
    pitch: Array,
    velocity_along: Array,
    velocity_upward: Array,
    pitch_rate: Array,
) -> Throw:
    """Return the record of a tumbling part, the vibrating plane and the start, for its simulation.

    All numbers are arrays in SI units: `duration` is the simulated time, `gamma` the climb of the
    plane, `amplitude`, `frequency` and `beta` (elevation) the drive; the part starts with its
    lowest corner `drop_height` above the plane, at the angle `pitch`, with velocities along and
    normal to the plane and `pitch_rate`.
    """
    return Throw(
        part=tumbling_part,
        friction_static=friction_static,
        friction_kinetic=friction_kinetic,
        restitution=restitution,
        duration=duration,
        gravity=gravity,
        gamma=gamma,
        frequency=frequency,
        amplitude=amplitude,
        beta=beta,
        gap_normal=drop_height,
        pitch=pitch,
        velocity_along=velocity_along,
        velocity_upward=velocity_upward,
        pitch_rate=pitch_rate,
    )


def part_energy_lost(*, specific_energy_lost: Array, mass: Array) -> Array:
    """Return the energy that impacts and friction took from a part [J]."""
    return specific_energy_lost * mass


def _ended(name: str) -> Callable[..., Mask]:
    """Return the function of a condition: True where the tumbling ended with the status `name`.

    Regimes of a result are made from such conditions; names are such as "settled".
    """

    def ended(*, tumble: Tumble) -> Mask:
        return tumble.status == STATUS[name]

    ended.__doc__ = f"Return where the status is {name}."
    return ended


RESULTS = (
    *fields(
        "tumble",
        "theory 2.1",
        final_pitch=("pitch", "the pitch at the end, with all its turns [rad]"),
        resting_side=(
            "resting_side",
            "the side that lies on the plane at the end, 0 if none does [1]",
        ),
    ),
    *fields(
        "tumble",
        "theory 13.5",
        settling_time=(
            "settling_time",
            "the time from which the part lies at rest for good; NaN where it does not [s]",
        ),
    ),
    *fields(
        "tumble",
        "theory 13.4",
        impact_count=("impacts", "the number of impacts [1]"),
        largest_bounce=(
            "largest_bounce",
            "the largest height of the lowest corner after the first impact [m]",
        ),
    ),
    *fields(
        "tumble",
        "theory 13.8",
        drift_velocity=("velocity", "the displacement along the plane over the duration [m s-1]"),
    ),
    *fields(
        "tumble",
        "theory 5.3",
        specific_energy_lost=(
            "energy_lost",
            "the energy per mass that impacts and friction took [J kg-1]",
        ),
    ),
    Equation("part_energy_lost", part_energy_lost, "theory 5.3"),
    *fields(
        "tumble",
        "theory 2.3",
        motion_status=("status", "how the run ended, as a status"),
    ),
)
ANY_RESULT = frozenset(equation.gives for equation in RESULTS) | {"regime"}

CONDITIONS = (
    Condition("no_solution", _ended("no_solution"), ANY_RESULT, otherwise="unresolved"),
    Condition("rests", _ended("settled"), ANY_RESULT),
    Condition("tumbles", _ended("moving"), ANY_RESULT),
)


def tumbling_scene(name: str, title: str, part: Callable[..., Part]) -> Scene:
    """Return the scene, with equations and conditions, in which parts of one shape tumble.

    `name` and `title` identify it; `part` is the function of the equation that gives the part from
    its sizes.
    """
    numbers = (
        Equation("tumbling_part", part, "theory 2.1"),
        Equation("throw", throw, "theory 2.1"),
    )
    return Scene(
        name=name,
        title=title,
        source="theory 2, 13",
        validity="A rigid part in the vertical plane of the track, with one rotation: it strikes "
        "the plane with its corners, rocks, slides, and comes to rest on a side. After many "
        "impacts with much restitution its details depend on the last digit.",
        variants={
            method.name: (
                *numbers,
                Equation("tumble", method.follow(Contacts()), method.source),
                *RESULTS,
            )
            for method in METHODS["tumbling"].values()
        },
        default_variant="events",
        conditions=dict.fromkeys(METHODS["tumbling"], CONDITIONS),
        defaults={
            "gamma": 0.0,
            "gravity": STANDARD_GRAVITY,
            "frequency": 0.0,
            "amplitude": 0.0,
            "beta": 0.0,
            "drop_height": 0.0,
            "pitch": 0.0,
            "pitch_rate": 0.0,
            "velocity_along": 0.0,
            "velocity_upward": 0.0,
        },
        constraints=(STATIC_ABOVE_KINETIC,),
        choice="method",
    )
