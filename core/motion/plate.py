"""A part on a plate without a wall, which travels in any direction (theory 13.13).

Friction is isotropic: a drive that is turned turns the motion. A drive along a line, with the slope
along the same line, is followed in the plane of that line and the normal, in closed form.
"""

from dataclasses import replace
from functools import wraps
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, cosine, hypot, sine
from vibrafeed.core.motion import events, reference
from vibrafeed.core.motion.feeding import RESOLVED
from vibrafeed.core.motion.method import (
    Contacts,
    Follow,
    Groups,
    Method,
    Motion,
    Trajectory,
    TrajectoryRequest,
    displacement,
)
from vibrafeed.core.motion.scales import product
from vibrafeed.core.motion.turning import turn, turned
from vibrafeed.core.motion.waves import ACROSS
from vibrafeed.core.motion.weak_friction import with_limits
from vibrafeed.core.scenes.scene import Equation

PLATE = "part-on-plate"


def _on_plate(follow: Follow) -> Follow:
    @wraps(follow)
    # A method that follows the part in turned axes, and turns its velocity back.
    def follow_turned(*, groups: Groups, **settings: Any) -> Any:
        turned_groups, angle = turned(groups)
        result = follow(groups=turned_groups, **settings)
        if not isinstance(result, Motion):  # energy is the same in all axes
            return result
        velocity, across = turn(result.velocity, result.across, -angle)
        return result._replace(velocity=velocity, across=across)

    return follow_turned


def trajectory(request: TrajectoryRequest, contacts: Contacts) -> Trajectory:
    """Return the trajectory of one part: its path over the plate, and its height above it."""
    groups, length = request.groups, request.scale("length_scale")
    turned_groups, angle = turned(groups)
    turned_request = request._replace(arguments={**request.arguments, "groups": turned_groups})
    path, modes = events.path_of(turned_request, contacts)
    for vectors in (path.position, path.velocity):
        vectors[:, 0], vectors[:, 1] = turn(vectors[:, 0], vectors[:, 1], -angle)
    path.position[:, :2] -= path.position[0, :2]
    return {
        **request.trajectory(path, modes, wall=False),
        "position_across": path.position[:, 1] * length,
        "relative_velocity_across": path.velocity[:, 1] * request.scale("velocity_scale"),
        "track_across": displacement(groups, ACROSS, path.phase) * length,
    }


@wraps(events.EVENTS.follow)
def _settled(*, groups: Groups, **settings: Any) -> Motion:
    return with_limits(events.EVENTS.follow(groups=groups, **settings), groups)


METHODS: dict[str, Method] = {
    "events": replace(
        events.EVENTS,
        follow=_on_plate(_settled),
        energy=_on_plate(events.energy_by_events),
        course=trajectory,
    ),
    "reference": replace(reference.REFERENCE, follow=_on_plate(reference.REFERENCE.follow)),
}


# --- results


def travel_speed(*, velocity_x: Array, velocity_y: Array) -> Array:
    """Return the size of the mean velocity, |v| [m s-1]."""
    return hypot(velocity_x, velocity_y)


def travel_direction(
    *, velocity_x: Array, velocity_y: Array, motion: Motion, drive_number: Array,
    velocity_scale: Array,
) -> Array:  # fmt: skip
    """Return the direction of the mean velocity, from +x towards +y [rad].

    NaN for a part whose speed is no larger than its stated error, or than 1e-9 of the drive's.
    """
    error = np.where(np.isnan(motion.error), 0.0, motion.error)
    least = np.maximum(error, RESOLVED * drive_number) * velocity_scale
    rests = hypot(velocity_x, velocity_y) <= least
    return np.where(rests, np.nan, np.arctan2(velocity_y, velocity_x))


def velocity_towards(*, velocity_x: Array, velocity_y: Array, target_direction: Array) -> Array:
    """Return the mean velocity in a direction, v_x cos(chi) + v_y sin(chi) [m s-1]."""
    return velocity_x * cosine(target_direction) + velocity_y * sine(target_direction)


def slip_fraction(*, motion: Motion) -> Array:
    """Return the share of the period in which the part slides, in whatever direction [1]."""
    return motion.forward + motion.backward


RESULTS = (
    product(
        "velocity_x", "motion.velocity", "velocity_scale", source="theory 13.13",
        says="the mean velocity over the plate along x, over whole cycles [m s-1]",
    ),
    product(
        "velocity_y", "motion.across", "velocity_scale", source="theory 13.13",
        says="the mean velocity over the plate along y, over whole cycles [m s-1]",
    ),
    product(
        "velocity_error", "motion.error", "velocity_scale", source="theory 13.13",
        says="the method's own estimate of the error of each component of the velocity [m s-1]",
    ),
    Equation("travel_speed", travel_speed, "theory 13.13"),
    Equation("travel_direction", travel_direction, "theory 13.13"),
    Equation("velocity_towards", velocity_towards, "theory 13.13"),
    Equation("slip_fraction", slip_fraction, "theory 13.13"),
)  # fmt: skip
