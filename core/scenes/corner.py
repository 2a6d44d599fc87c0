"""Equations that the scenes of an isolated part share: one corner on a fixed plane."""

from __future__ import annotations

from vibrafeed.core.mechanics import corner, vibration
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation

CORNER = (
    Equation("diagonal_angle", corner.diagonal_angle, "theory 2.1"),
    Equation("diagonal_direction", corner.diagonal_direction, "theory 2.1"),
    Equation("touching_height", corner.touching_height, "(3.2), (3.28)"),
    Equation("gap_normal", corner.gap_normal, "(3.2), (3.28)"),
    Equation("gap_tangential", corner.gap_tangential, "(3.2), (3.28)"),
    Equation("pivot_velocity_along", corner.pivot_velocity_along, "(3.3), (3.29)"),
    Equation("pivot_velocity_upward", corner.pivot_velocity_upward, "(3.3), (3.29)"),
    Equation("gap_normal_rate", corner.gap_normal_rate, "(3.3), (3.29)"),
    Equation("gap_tangential_rate", corner.gap_tangential_rate, "(3.3), (3.29)"),
    Equation("free_normal_acceleration", corner.free_normal_acceleration, "(3.6a), (3.33a)"),
    Equation("free_tangential_acceleration", corner.free_tangential_acceleration, "theory 2.2"),
    Equation("normal_response_right", corner.normal_response_right, "(3.6a), (3.33a)"),
    Equation("normal_response_left", corner.normal_response_left, "theory 2.2"),
    Equation("normal_response", corner.normal_response, "theory 2.2"),
    Equation("holding_normal_acceleration", corner.holding_normal_acceleration, "theory 2.4"),
    Equation(
        "holding_tangential_acceleration", corner.holding_tangential_acceleration, "theory 2.4"
    ),
    Equation("slip_direction", corner.slip_direction, "theory 2.4"),
    Equation("contact_case", corner.contact_case, "theory 2.3"),
    Equation("floor_acceleration", corner.floor_acceleration, "theory 2.3"),
    Equation("floor_force", vibration.floor_force, "theory 2.3"),
    Equation("friction_force", corner.friction_force, "theory 2.3"),
    Equation("acceleration_along", corner.acceleration_along, "(3.1), (3.25)"),
    Equation("acceleration_upward", corner.acceleration_upward, "(3.1), (3.25)"),
    Equation("pitch_acceleration", corner.pitch_acceleration, "(3.1), (3.26)"),
    Equation("gap_normal_acceleration", corner.gap_normal_acceleration, "(3.4), (3.30)"),
    Equation("inverse_limiting_friction", corner.inverse_limiting_friction, "(3.7), (3.34)"),
    Equation("limiting_friction_right", corner.limiting_friction_right, "(3.7), (3.34)"),
    Equation("limiting_friction_left", corner.limiting_friction_left, "theory 2.5"),
    Equation("least_limiting_friction", corner.least_limiting_friction, "theory 2.5"),
    Equation("least_limiting_pitch", corner.least_limiting_pitch, "theory 2.5"),
    Equation("impact_impulse_normal", corner.impact_impulse_normal, "theory 2.6"),
    Equation("impact_impulse_tangential", corner.impact_impulse_tangential, "theory 2.6"),
)

DERIVED = (
    *CORNER,
    Equation(
        "gap_tangential_acceleration",
        corner.gap_tangential_acceleration,
        "(3.6b), (3.33b)",
        "derived",
    ),
)

FORCES = frozenset(
    (
        "slip_direction",
        "normal_response",
        "floor_acceleration",
        "floor_force",
        "friction_force",
        "acceleration_along",
        "acceleration_upward",
        "pitch_acceleration",
        "gap_normal_acceleration",
        "gap_tangential_acceleration",
        "impact_impulse_normal",
        "impact_impulse_tangential",
        "regime",
    )
)
LIMITS = frozenset(("limiting_friction_right", "limiting_friction_left"))
CONDITIONS = (
    Condition("invalid_geometry", corner.another_corner_is_lower, FORCES | LIMITS),
    Condition("no_solution", corner.has_no_solution, FORCES),
    Condition("two_solutions", corner.has_two_solutions, FORCES),
    Condition("separation", corner.separates, FORCES),
    Condition("stick", corner.is_held, FORCES),
    Condition("sliding", corner.slides, FORCES, otherwise="sliding"),
    Condition(
        "unbounded",
        corner.right_is_unlimited,
        frozenset(("limiting_friction_right",)),
        otherwise="contact",
    ),
    Condition(
        "unbounded",
        corner.left_is_unlimited,
        frozenset(("limiting_friction_left",)),
        otherwise="contact",
    ),
)

# The two rates are 0, the corner touching and at rest, until a study gives the centre's velocity.
CORNER_DEFAULTS = {
    "gravity": STANDARD_GRAVITY,
    "pitch_rate": 0.0,
    "centre_along": 0.0,
    "gap_normal_rate": 0.0,
    "gap_tangential_rate": 0.0,
}

VALIDITY = (
    "Plane motion of a rigid part with one corner on a fixed plane, touching and neither "
    "approaching nor leaving it; an approach is an impact. Without velocity_along the corner is at "
    "rest along the plane. Where there are two solutions the forces are those of the one in "
    "contact; in the other there is no force."
)
