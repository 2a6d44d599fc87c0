"""A truncated cone on its side, which rolls about the vertical through its apex, from rest."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics import resting, round_parts, toppling, vibration
from vibrafeed.core.scenes.planar import FLOOR, PLANE, PLANE_DEFAULTS, UNILATERAL
from vibrafeed.core.scenes.roller_on_plane import AXIS, SOURCE
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

PHYSICAL = (
    *(e for e in PLANE if not e.gives.startswith("rotated")),
    *UNILATERAL,
    *AXIS,
    Equation("mass_height", resting.cone_centre, "theory 16.1"),
    Equation("side_foot", resting.side_foot, "theory 16.1"),
    Equation("gyration", toppling.cone_gyration, "theory 16.2"),
    Equation("axial_gyration", round_parts.axial_gyration, SOURCE),
    Equation("cone_half_angle", round_parts.cone_half_angle, SOURCE),
    Equation("centre_radius", round_parts.centre_radius, SOURCE),
    Equation("cone_factor", round_parts.cone_factor, SOURCE),
    Equation("rolling_acceleration", round_parts.cone_acceleration, SOURCE),
    Equation("turning_acceleration", round_parts.cone_turning, SOURCE),
    Equation("required_friction", round_parts.cone_friction, SOURCE),
)
SHAPE = frozenset(("cone_factor",))
MOTION = frozenset(
    ("rolling_acceleration", "turning_acceleration", "required_friction", "regime")
)  # fmt: skip
CONDITIONS = (
    Condition("flight", vibration.has_left_floor, FLOOR | MOTION, otherwise="contact"),
    Condition("unstable_side", resting.is_side_unstable, SHAPE | MOTION, otherwise="contact"),
    Condition("roll", round_parts.rolls, MOTION, otherwise="slip"),
)

SCENE = Scene(
    name="cone-on-plane",
    title="Truncated cone on its side, rolling about its apex",
    source="",
    validity="A snapshot at the drive's peak for a cone at rest relative to the track, which rolls "
    "about the vertical through its apex. Its line of contact lies across the track unless "
    "axis_yaw turns it. Where it slips the values are those that pure rolling would ask for; the "
    "friction that it needs is that of the resultant. Rolling resistance is neglected.",
    variants={"physical": PHYSICAL},
    default_variant="physical",
    conditions={"physical": CONDITIONS},
    defaults={**PLANE_DEFAULTS, "axis_yaw": np.pi / 2},
)
