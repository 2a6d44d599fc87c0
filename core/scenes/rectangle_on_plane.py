"""A rectangular part on a horizontal or inclined plane; sections 3.2.2 and 3.2.3 of the source."""

from __future__ import annotations

from vibrafeed.core.mechanics import friction, vibration
from vibrafeed.core.scenes.planar import (
    ACCELERATIONS,
    FLOOR,
    PER_AXIS,
    PLANE,
    PLANE_DEFAULTS,
    UNILATERAL,
)
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

OFFSETS = frozenset(("pressure_offset_x", "pressure_offset_y"))

PHYSICAL = (
    *PLANE,
    *UNILATERAL,
    Equation("sliding_fraction", friction.sliding_fraction, "theory 3.2", "physical"),
    Equation("acceleration_x", friction.disc_acceleration_x, "theory 3.2", "physical"),
    Equation("acceleration_y", friction.disc_acceleration_y, "theory 3.2", "physical"),
    Equation("pressure_offset_x", friction.pressure_offset_x, "theory 4.4", "physical"),
    Equation("pressure_offset_y", friction.pressure_offset_y, "theory 4.4", "physical"),
)

FLIGHT = Condition(
    "flight", vibration.has_left_floor, FLOOR | ACCELERATIONS | OFFSETS, otherwise="contact"
)
STICK = Condition("stick", friction.is_stuck, ACCELERATIONS | OFFSETS, otherwise="slip")

SCENE = Scene(
    name="rectangle-on-plane",
    title="Rectangular part on a horizontal or inclined plane",
    source="3.2.2, 3.2.3",
    validity="A snapshot at the drive's peak for a part at rest relative to the track; it does not "
    "rotate. Closed forms describe the part only while the throw number is below 1.",
    variants={
        "thesis": (*PLANE, *PER_AXIS),
        "derived": (*PLANE, *PER_AXIS),
        "physical": PHYSICAL,
    },
    default_variant="physical",
    conditions={
        "thesis": (FLIGHT, STICK),
        "derived": (FLIGHT, STICK),
        "physical": (
            FLIGHT,
            Condition("tipping", friction.tips_x, frozenset(("pressure_offset_x",))),
            Condition("tipping", friction.tips_y, frozenset(("pressure_offset_y",))),
            STICK,
        ),
    },
    defaults={**PLANE_DEFAULTS, "yaw": 0.0},
    rounding_bound=8,
)
