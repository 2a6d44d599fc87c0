"""A cylinder that lies on a plane, axis along the track; sections 3.3.2 and 3.3.3 of the source."""

from __future__ import annotations

from vibrafeed.core.mechanics import rolling, vibration
from vibrafeed.core.scenes.planar import (
    ACCELERATIONS,
    FLOOR,
    PER_AXIS,
    PLANE,
    PLANE_DEFAULTS,
    UNILATERAL,
)
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

MOTION = ACCELERATIONS - {"sliding_fraction"} | {"angular_acceleration"}

THESIS = (
    *PLANE,
    *PER_AXIS,
    Equation("angular_acceleration", rolling.printed_angular_acceleration, "(3.36)", "thesis"),
)
DERIVED = (
    *PLANE,
    *PER_AXIS,
    Equation("angular_acceleration", rolling.rolling_angular_acceleration, "(3.36)", "derived"),
)
PHYSICAL = (
    *PLANE,
    *UNILATERAL,
    Equation("roll_root", rolling.roll_root, "theory 7.3", "physical"),
    Equation("acceleration_x", rolling.slipping_acceleration_x, "theory 7.3", "physical"),
    Equation("acceleration_y", rolling.slipping_acceleration_y, "theory 7.3", "physical"),
    Equation(
        "angular_acceleration", rolling.slipping_angular_acceleration, "theory 7.3", "physical"
    ),
)
CONDITIONS = (
    Condition("flight", vibration.has_left_floor, FLOOR | MOTION | {"roll_root"}, "contact"),
    Condition("stick", rolling.is_at_rest, MOTION),
    Condition("roll", rolling.is_rolling, MOTION | {"roll_root"}, otherwise="slip"),
)

SCENE = Scene(
    name="cylinder-on-plane",
    title="Cylindrical part lying on a plane, its axis along the track",
    source="3.3.2, 3.3.3",
    validity="A snapshot at the drive's peak for a part at rest relative to the track. Rolling "
    "resistance and drilling friction are neglected. Closed forms describe the part only while the "
    "throw number is below 1.",
    variants={"thesis": THESIS, "derived": DERIVED, "physical": PHYSICAL},
    default_variant="physical",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS, "physical": CONDITIONS},
    defaults={**PLANE_DEFAULTS, "yaw": 0.0},
    rounding_bound=8,
)
