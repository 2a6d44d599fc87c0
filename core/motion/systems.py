"""The systems that can be simulated: a scene's coordinates and contacts, by method.

The systems are scenes of their own: the same parameters, other equations. What a closed-form scene
calls a variant is a method here. Nothing that computes is loaded before it is called.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from core.mechanics import vibration
from core.mechanics.arrays import Mask
from core.motion import methods, scales
from core.motion.motion import STATUS, Motion
from core.motion.planar import planar_motion
from core.motion.tumbling_scene import cylinder, rectangle, tumbling_scene
from core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Constraint,
    Equation,
    Scene,
)


def _has_status(*names: str) -> Callable[..., Mask]:
    values = [STATUS[name] for name in names]

    def has_status(*, motion: Motion) -> Mask:
        return np.isin(motion.status, values)

    has_status.__doc__ = f"Return where the status is {' or '.join(names)}."
    return has_status


def _is_stuck(*, motion: Motion) -> Mask:
    """Return where friction holds the part all the time."""
    return motion.stick == 1


def _is_period_doubled(*, motion: Motion) -> Mask:
    """Return where the motion repeats after two periods of the drive or more."""
    return motion.multiple > 1


def _hops_on(*, motion: Motion) -> Mask:
    """Return where the part is in the air all the time but for impacts."""
    return motion.flight >= 1 - 1e-12


def _hops(*, motion: Motion) -> Mask:
    """Return where the part is in the air for a part of the period."""
    return motion.flight > 0


def _sticks(*, motion: Motion) -> Mask:
    """Return where friction holds the part for a part of the period."""
    return motion.stick > 0


RESULTS = (
    Equation("conveying_velocity", scales.conveying_velocity, "theory 13.8"),
    Equation("conveying_velocity_spread", scales.conveying_velocity_spread, "theory 13.8"),
    Equation("conveying_velocity_error", scales.conveying_velocity_error, "theory 13.8"),
    Equation("efficiency", scales.efficiency, "theory 13.10"),
    Equation("stick_fraction", scales.stick_fraction, "theory 13.2"),
    Equation("forward_fraction", scales.forward_fraction, "theory 13.2"),
    Equation("backward_fraction", scales.backward_fraction, "theory 13.2"),
    Equation("flight_fraction", scales.flight_fraction, "theory 13.2"),
    Equation("impacts_per_period", scales.impacts_per_period, "theory 13.4"),
    Equation("period_multiple", scales.period_multiple, "theory 13.8"),
    Equation("landing_speed", scales.landing_speed, "theory 13.4"),
    Equation("hop_height", scales.hop_height, "theory 13.2"),
    Equation("motion_status", scales.motion_status, "theory 13.8"),
)
ANY_RESULT = frozenset(equation.gives for equation in RESULTS) | {"regime"}

CONDITIONS = (
    Condition(
        "unresolved",
        _has_status("not_computed", "limit_reached", "no_solution"),
        ANY_RESULT,
        otherwise="slip",
    ),
    Condition("runaway", _has_status("runaway"), ANY_RESULT),
    Condition("unbounded", scales.efficiency_is_unbounded, frozenset(("efficiency",))),
    Condition("aperiodic", _has_status("aperiodic"), ANY_RESULT),
    Condition("period_doubled", _is_period_doubled, ANY_RESULT),
    Condition("hop_after_hop", _hops_on, ANY_RESULT),
    Condition("hopping", _hops, ANY_RESULT),
    Condition("stick", _is_stuck, ANY_RESULT),
    Condition("stick_slip", _sticks, ANY_RESULT),
)

PLANAR_SCALES = (
    Equation("vibration_acceleration", vibration.vibration_acceleration, "theory 0.2"),
    Equation("drive_number", scales.drive_number, "theory 13.10"),
    Equation("drive_number_along", scales.drive_number_along, "theory 13.2"),
    Equation("drive_number_normal", scales.drive_number_normal, "theory 13.2"),
    Equation("gravity_number_along", scales.gravity_number_along, "theory 13.2"),
    Equation("gravity_number_normal", scales.gravity_number_normal, "theory 13.2"),
    Equation("throw_number", scales.throw_number, "theory 13.10"),
    Equation("velocity_scale", scales.velocity_scale, "theory 13.8"),
    Equation("length_scale", scales.length_scale, "theory 13.8"),
)

SPATIAL_SCALES = (
    *PLANAR_SCALES,
    Equation("drive_number_across", scales.drive_number_across, "theory 13.1"),
)
TRACK_SCALES = (
    *(e for e in SPATIAL_SCALES if e.gives != "gravity_number_normal"),
    Equation("gravity_number_across", scales.gravity_number_across, "theory 13.1"),
    Equation("gravity_number_normal", scales.leaning_gravity_number_normal, "theory 13.1"),
    Equation("curvature_number", scales.curvature_number, "theory 13.10"),
)

PLANE_DEFAULTS = {
    "alpha": 0.0,
    "gamma": 0.0,
    "gravity": STANDARD_GRAVITY,
    "restitution": 0.0,
    "tolerance": 1e-12,
    "most_periods": 1000.0,
}
STEPPING_DEFAULTS = {"steps_per_period": 1000.0, "most_periods": 200.0}
REGULARISED_DEFAULTS = {
    "tolerance": 1e-7,
    "most_periods": 100.0,
    "slip_speed": 1e-4,
    "contact_stiffness": 1e8,
}

PLANAR = Constraint(
    ("alpha",),
    lambda least, largest: least == largest == 0.0,
    "the method events follows motion in one vertical plane, with alpha = 0",
    "Leave alpha out, or set method = 'time-stepping'",
    variant="events",
)
DRIVEN = Constraint(
    ("frequency",),
    lambda least, largest: least >= 1e-9 and largest <= 1e12,
    "there is no period to take a mean over, or one that floating numbers do not hold",
    "Give a frequency from 1e-9 Hz to 1e12 Hz",
)
MOST_FRICTION = tuple(
    Constraint(
        (name,),
        lambda _, largest: largest <= 1000,
        "the reference method integrates friction, and loses its digits above 1000",
        "Give at most 1000, or set method = 'events'",
        variant="reference",
    )
    for name in ("friction", "friction_kinetic")
)
VALIDITY = (
    "The part is a point with contact conditions: it does not tip. It starts at rest on the floor. "
    "Mean values are those of the motion that it falls into."
)


def _plane(name: str, title: str, rolling: float) -> Scene:
    def motion(scale: tuple[Equation, ...], function: Callable[..., Motion], source: str) -> Any:
        return (*scale, Equation("motion", function, source), *RESULTS)

    variants = {
        "events": motion(PLANAR_SCALES, planar_motion, "theory 13.2-13.8"),
        "time-stepping": motion(SPATIAL_SCALES, methods.stepped_on_plane(rolling), "theory 13.9"),
        "reference": motion(SPATIAL_SCALES, methods.reference_on_plane(rolling), "theory 13.1"),
    }
    # Regularised friction acts on the part itself, so that only a block has it in space.
    solvers = {"regularised": "Radau", "regularised-BDF": "BDF", "regularised-LSODA": "LSODA"}
    if rolling == 0:
        variants |= {
            method: motion(SPATIAL_SCALES, methods.regularised_by(solver), "theory 13.1")
            for method, solver in solvers.items()
        }
    return Scene(
        name=name,
        title=title,
        source="theory 13",
        validity=VALIDITY,
        variants=variants,
        default_variant="time-stepping",
        conditions=dict.fromkeys(variants, CONDITIONS),
        defaults=PLANE_DEFAULTS,
        constraints=(STATIC_ABOVE_KINETIC, DRIVEN, PLANAR, *MOST_FRICTION),
        choice="method",
        variant_defaults={
            "time-stepping": STEPPING_DEFAULTS,
            "reference": {"most_periods": 100.0},
            **dict.fromkeys(solvers, REGULARISED_DEFAULTS),
        },
    )


TRACK = Scene(
    name="rectangle-on-track",
    title="Motion in time of a rectangular part on the track, with floor and wall",
    source="theory 13",
    validity=VALIDITY + " The wall has the friction and the restitution of the floor. The track is "
    "straight unless the study gives its radius.",
    variants={
        "time-stepping": (
            *TRACK_SCALES,
            Equation("motion", methods.stepped_on_track, "theory 13.1, 13.9"),
            *RESULTS,
        ),
        "reference": (
            *TRACK_SCALES,
            Equation("motion", methods.reference_on_track, "theory 13.1"),
            *RESULTS,
        ),
    },
    default_variant="time-stepping",
    conditions={"time-stepping": CONDITIONS, "reference": CONDITIONS},
    defaults={**PLANE_DEFAULTS, "delta": 0.0, "curvature_number": 0.0},
    constraints=(STATIC_ABOVE_KINETIC, DRIVEN, *MOST_FRICTION),
    choice="method",
    variant_defaults={"time-stepping": STEPPING_DEFAULTS, "reference": {"most_periods": 100.0}},
)


SYSTEMS: dict[str, Scene] = {
    system.name: system
    for system in (
        _plane("rectangle-on-plane", "Motion in time of a rectangular part on a plane", 0.0),
        _plane(
            "cylinder-on-plane",
            "Motion in time of a cylinder on a plane, its axis along the track",
            methods.SOLID_CYLINDER,
        ),
        TRACK,
        tumbling_scene("rectangle-isolated", "Tumbling rectangular part on a plane", rectangle),
        tumbling_scene("cylinder-isolated", "Tumbling cylindrical part on a plane", cylinder),
    )
}
"""Every system that can be simulated, by the name of its scene."""
