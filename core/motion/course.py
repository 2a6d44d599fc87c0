"""The course of one part in time, as a study asks for it by `trajectory`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.motion.methods import SOLID_CYLINDER
from core.motion.planar import planar_path
from core.motion.stepping import stepped_path
from core.motion.tumbling import tumbling_path
from core.quantities import MOTION_MODES, Flag

SLOW = 1e-9  # in g/w: a normal velocity of a part that stays on the floor

COURSE_FLAGS: dict[str, Mapping[str, Flag]] = {"motion_mode": MOTION_MODES}
"""The flags of courses, with their meanings."""

Asked = int | tuple[float, ...]


class Course(NamedTuple):
    """Times [s] and what the part does at them: quantities, and flags of `COURSE_FLAGS`."""

    times: Array
    values: Mapping[str, Array]
    flags: Mapping[str, NDArray[np.int8]]


def _times(asked: Asked, known: dict[str, Any]) -> tuple[Array, Array]:
    """Return times [s] and phases of the drive over a cycle, or as asked."""
    pace = known["velocity_scale"].item() / known["length_scale"].item()  # circular frequency
    if isinstance(asked, int):
        cycle = np.nan_to_num(known["motion"].multiple.item(), nan=1.0)
        phases = np.linspace(0.0, 2 * np.pi * max(1.0, cycle), asked + 1)
        return phases / pace, phases
    times = np.array(asked)
    return times, pace * times


def _track(numbers: Mapping[str, float], swing: Array) -> dict[str, Array]:
    """Return the displacement of the track, from that of a drive number of 1."""
    return {
        "track_along": numbers["drive_number_along"] * swing,
        "track_normal": numbers["drive_number_normal"] * swing,
    }


def planar_course(asked: Asked, arguments: dict[str, Any], known: dict[str, Any]) -> Course:
    """Return the course over a cycle of a part that moves in one vertical plane.

    `arguments` are those of the motion, `known` every quantity of the plan, of one point.
    """
    speed, length = known["velocity_scale"].item(), known["length_scale"].item()
    times, phases = _times(asked, known)
    numbers = {name: value.item() for name, value in arguments.items()}
    path = planar_path(**numbers, phases=phases)
    values = {
        "position_along": path.along * length,
        "height_above_floor": path.height * length,
        "relative_velocity_along": path.velocity_along * speed,
        "relative_velocity_normal": path.velocity_normal * speed,
        **_track(numbers, length * np.sin(phases)),
    }
    return Course(times, values, {"motion_mode": path.mode})


def stepped_course(wall: bool, rolling: float) -> Callable[..., Course]:
    """Return the course by time stepping of a part with or without a wall, block or cylinder.

    The part starts at rest, and is shown after as many periods as the study follows it for; the
    steps are those of the finest run that gave its mean.
    """

    def course(asked: Asked, arguments: dict[str, Any], known: dict[str, Any]) -> Course:
        speed, length = known["velocity_scale"].item(), known["length_scale"].item()
        times, phases = _times(asked, known)
        numbers = {name: value.item() for name, value in arguments.items()}
        steps = 2 * int(numbers.pop("steps_per_period")) + 1
        before = 2 * np.pi * numbers.pop("most_periods")
        if wall:
            numbers["wall_friction"] = numbers["friction_kinetic"]
            numbers["wall_restitution"] = numbers["restitution"]
        numbers.setdefault("gravity_number_across", 0.0)
        path = stepped_path(
            **numbers, wall=wall, rolling=rolling, steps_per_period=steps,
            phases=np.concatenate([[0.0], before + phases]),
        )  # fmt: skip
        position, velocity = path.position[1:], path.velocity[1:]
        values = {
            "position_along": (position[:, 0] - position[0, 0]) * length,
            "height_above_floor": np.maximum(position[:, 2], 0.0) * length,
            "relative_velocity_along": velocity[:, 0] * speed,
            "relative_velocity_normal": velocity[:, 2] * speed,
            **_track(numbers, length * np.sin(phases)),
        }
        if wall:
            values["distance_from_wall"] = np.maximum(position[:, 1], 0.0) * length
        # On the floor the normal velocity is 0; gaps below what the drive covers in a step are the
        # method's own.
        gap = abs(numbers["drive_number_normal"]) * (2 * np.pi / steps) ** 2
        flies = (np.abs(velocity[:, 2]) > SLOW) | (position[:, 2] > gap)
        slides = np.where(velocity[:, 0] > 0, "forward", "backward")
        modes = np.where(flies, "flight", slides)
        modes = np.where((modes != "flight") & (velocity[:, 0] == 0), "stick", modes)
        modes = np.where(np.isnan(position[:, 0]), "unknown", modes)
        flags = np.array([MOTION_MODES[mode].value for mode in modes.tolist()], dtype=np.int8)
        return Course(times, values, {"motion_mode": flags})

    return course


def tumbling_course(asked: Asked, arguments: dict[str, Any], known: dict[str, Any]) -> Course:
    """Return the course of a tumbling part from its start."""
    numbers = dict(arguments)
    duration = numbers.pop("duration").item()
    part, gap = numbers.pop("tumbling_part"), numbers.pop("drop_height")
    times = np.linspace(0.0, duration, asked + 1) if isinstance(asked, int) else np.array(asked)
    path = tumbling_path(part=part, times=times, gap_normal=gap, **numbers)
    values = {
        "path_along": path.along,
        "path_height": path.upward,
        "path_pitch": np.rad2deg(path.pitch),
        "path_gap": path.gap_normal,
        "path_corners": path.touching.sum(axis=1).astype(float),
    }
    return Course(times, values, {})


COURSES: dict[str, dict[str, Callable[..., Course]]] = {
    "rectangle-on-plane": {"events": planar_course, "time-stepping": stepped_course(False, 0.0)},
    "cylinder-on-plane": {
        "events": planar_course,
        "time-stepping": stepped_course(False, SOLID_CYLINDER),
    },
    "rectangle-on-track": {"time-stepping": stepped_course(True, 0.0)},
    "rectangle-isolated": {"events": tumbling_course},
    "cylinder-isolated": {"events": tumbling_course},
}
"""What follows one part in time, by system and method."""
