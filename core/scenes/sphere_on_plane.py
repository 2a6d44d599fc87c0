"""A ball or a shell on a horizontal or inclined plane, from rest."""

from __future__ import annotations

from vibrafeed.core.mechanics import round_parts, vibration
from vibrafeed.core.scenes.planar import ACCELERATIONS, FLOOR, PLANE, PLANE_DEFAULTS, UNILATERAL
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

SOURCE = "theory 18.1"
PHYSICAL = (
    *PLANE,
    *UNILATERAL,
    Equation("rolling_factor", round_parts.ball_factor, SOURCE),
    Equation("rolling_share", round_parts.rolling_share, SOURCE),
    Equation("required_friction", round_parts.ball_friction, SOURCE),
    Equation("moved_fraction", round_parts.ball_fraction, SOURCE),
    Equation("acceleration_x", round_parts.fraction_x, SOURCE),
    Equation("acceleration_y", round_parts.fraction_y, SOURCE),
    Equation("angular_acceleration", round_parts.ball_spin, SOURCE),
)
MOTION = (ACCELERATIONS - {"sliding_fraction"}) | {
    "moved_fraction", "angular_acceleration", "required_friction",
}  # fmt: skip
CONDITIONS = (
    Condition("flight", vibration.has_left_floor, FLOOR | MOTION, otherwise="contact"),
    Condition("roll", round_parts.rolls, MOTION, otherwise="slip"),
)

SCENE = Scene(
    name="sphere-on-plane",
    title="Ball or hollow ball on a horizontal or inclined plane",
    source="",
    validity="A snapshot at the drive's peak for a ball at rest relative to the track, on a floor "
    "without a wall. Rolling resistance is neglected: simulate it for that. Closed forms describe "
    "the ball only while the throw number is below 1.",
    variants={"physical": PHYSICAL},
    default_variant="physical",
    conditions={"physical": CONDITIONS},
    defaults={**PLANE_DEFAULTS, "yaw": 0.0, "inner_diameter": 0.0, "rolling_factor": 2.5},
)
