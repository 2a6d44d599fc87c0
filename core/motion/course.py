"""The course of one part in time, as a study asks for it by `trajectory`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.motion.planar import planar_path
from core.motion.tumbling import tumbling_path
from core.quantities import MOTION_MODES, Flag

Asked = int | tuple[float, ...]


class Course(NamedTuple):
    """Times [s] and what the part does at them: quantities, and flags with their meanings."""

    times: Array
    values: Mapping[str, Array]
    flags: Mapping[str, tuple[NDArray[np.int8], Mapping[str, Flag]]]


def planar_course(asked: Asked, arguments: dict[str, Any], known: dict[str, Any]) -> Course:
    """Return the course over a cycle of a part that moves in one vertical plane.

    `arguments` are those of the motion, `known` every quantity of the plan, of one point.
    """
    speed, length = known["velocity_scale"].item(), known["length_scale"].item()
    pace = speed / length  # the circular frequency
    if isinstance(asked, int):
        phases = np.linspace(0.0, 2 * np.pi * max(1.0, known["motion"].multiple.item()), asked + 1)
        times = phases / pace
    else:
        times = np.array(asked)
        phases = pace * times
    numbers = {name: value.item() for name, value in arguments.items()}
    path = planar_path(**numbers, phases=phases)
    values = {
        "position_along": path.along * length,
        "height_above_floor": path.height * length,
        "relative_velocity_along": path.velocity_along * speed,
        "relative_velocity_normal": path.velocity_normal * speed,
        "track_along": numbers["drive_number_along"] * length * np.sin(phases),
        "track_normal": numbers["drive_number_normal"] * length * np.sin(phases),
    }
    return Course(times, values, {"motion_mode": (path.mode, MOTION_MODES)})


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


COURSES: dict[str, Callable[[Asked, dict[str, Any], dict[str, Any]], Course]] = {
    "motion": planar_course,
    "tumble": tumbling_course,
}
"""What follows one part in time, by the quantity that holds its motion."""
