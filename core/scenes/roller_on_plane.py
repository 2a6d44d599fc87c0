"""A roller, tube, ring or hoop that lies on a plane, its axis in any direction, from rest."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics import round_parts, vibration
from vibrafeed.core.scenes.planar import ACCELERATIONS, FLOOR, PLANE, PLANE_DEFAULTS, UNILATERAL
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

SOURCE = "theory 18.1"
AXIS = (
    Equation("push_across_axis", round_parts.push_across_axis, SOURCE),
    Equation("push_along_axis", round_parts.push_along_axis, SOURCE),
)
PHYSICAL = (
    *PLANE,
    *UNILATERAL,
    *AXIS,
    Equation("rolling_factor", round_parts.tube_factor, SOURCE),
    Equation("rolling_share", round_parts.rolling_share, SOURCE),
    Equation("required_friction", round_parts.roller_friction, SOURCE),
    Equation("roll_root", round_parts.roller_root, SOURCE),
    Equation("axial_acceleration", round_parts.axial_acceleration, SOURCE),
    Equation("rolling_acceleration", round_parts.rolling_acceleration, SOURCE),
    Equation("acceleration_x", round_parts.roller_x, SOURCE),
    Equation("acceleration_y", round_parts.roller_y, SOURCE),
    Equation("angular_acceleration", round_parts.roller_spin, SOURCE),
)
MOTION = (ACCELERATIONS - {"sliding_fraction"}) | {
    "axial_acceleration", "rolling_acceleration", "angular_acceleration", "required_friction",
    "roll_root",
}  # fmt: skip
CONDITIONS = (
    Condition("flight", vibration.has_left_floor, FLOOR | MOTION, otherwise="contact"),
    Condition("roll", round_parts.rolls, MOTION, otherwise="slip"),
)

SCENE = Scene(
    name="roller-on-plane",
    title="Roller, tube, ring or hoop lying on a plane, its axis across the track",
    source="",
    validity="A snapshot at the drive's peak for a part at rest relative to the track. Its axis "
    "lies across the track unless axis_yaw turns it: 0 is along the track, as of "
    "cylinder-on-plane. Rolling resistance and drilling friction are neglected. Closed forms "
    "describe the part only while the throw number is below 1.",
    variants={"physical": PHYSICAL},
    default_variant="physical",
    conditions={"physical": CONDITIONS},
    defaults={
        **PLANE_DEFAULTS, "yaw": 0.0, "axis_yaw": np.pi / 2, "inner_diameter": 0.0,
        "rolling_factor": 2.0,
    },
)  # fmt: skip
