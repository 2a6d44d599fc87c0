"""Isolated parts on one corner: a rectangle, and a cylinder in the plane of its axis."""

from functools import partial

import numpy as np

from vibrafeed.core.mechanics import corner, floor
from vibrafeed.core.mechanics.arrays import Array, hypot
from vibrafeed.core.mechanics.corner import Direction
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene, under_names

# --- Equations that the scenes of an isolated part share: one corner on a fixed plane.

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
    Equation("floor_force", floor.floor_force, "theory 2.3"),
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
CONDITIONS = (
    Condition("invalid_geometry", lambda *, pitch: (pitch < 0) | (pitch > np.pi / 2),
              FORCES | {"limiting_friction_right", "limiting_friction_left"},
              says="True where another corner would be in the plane: xi < 0 or xi > 90 degrees."),
    *(
        Condition(regime, partial(corner.is_case, case), FORCES, otherwise, says=f"True {says}.")
        for regime, case, otherwise, says in (
            ("no_solution", corner.NO_SOLUTION, "",
             "where no force satisfies the contact: Painleve's paradox"),
            ("two_solutions", corner.TWO_SOLUTIONS, "",
             "where separation and contact both satisfy the equations, or every force does"),
            ("separation", corner.SEPARATION, "", "where the corner leaves the plane"),
            ("stick", corner.STICK, "", "where friction keeps the corner at rest"),
            ("sliding", corner.SLIDING, "sliding", "where the corner slides, or starts to"),
        )
    ),
    Condition(
        "unbounded",
        lambda *, inverse_limiting_friction: inverse_limiting_friction <= 0,
        frozenset(("limiting_friction_right",)),
        otherwise="contact",
        says="True where slip to the right has one solution at every friction.",
    ),
    Condition(
        "unbounded",
        lambda *, inverse_limiting_friction: inverse_limiting_friction >= 0,
        frozenset(("limiting_friction_left",)),
        otherwise="contact",
        says="True where slip to the left has one solution at every friction.",
    ),
)  # fmt: skip

# The two rates are 0, the corner touching and at rest, until a study gives the centre's velocity.
CORNER_DEFAULTS = {
    "gravity": STANDARD_GRAVITY,
    "pitch_rate": 0.0,
    "centre_along": 0.0,
    "gap_normal_rate": 0.0,
    "gap_tangential_rate": 0.0,
}

VALIDITY = (
    "The part is rigid, moves in a plane, and touches a fixed plane with one corner. The corner "
    "neither approaches nor leaves the plane; an approach is an impact. If the study gives no "
    "velocity_along, the corner is at rest along the plane. If there are two solutions, the forces "
    "are those of the solution in contact; the other solution has no force."
)


# --- A rectangular part with one lower corner on a fixed plane; section 3.2.1 of the source.


def corner_angle(*, height: Array, length: Array) -> Array:
    """Return the angle of the diagonal in the part, zeta = atan2(b, h) [rad]."""
    return np.arctan2(height, length)


def corner_direction(*, height: Array, length: Array) -> Direction:
    """Return sine and cosine of zeta."""
    hypotenuse = np.hypot(height, length)
    return height / hypotenuse, length / hypotenuse


def half_diagonal(*, height: Array, length: Array) -> Array:
    """Return the distance from the centre to the corner, rho = sqrt(b^2 + h^2)/2 [m]."""
    return hypot(height, length) / 2


def rectangle_inertia_ratio() -> Array:
    """Return the inertia ratio, kappa = m rho^2/I = 3, the same for every rectangle [1]."""
    return np.full((), 3.0)


def rectangle_printed_gap_tangential_acceleration(
    *,
    contact_case: Array,
    slip_direction: Array,
    floor_acceleration: Array,
    free_tangential_acceleration: Array,
    diagonal_direction: Direction,
    friction_kinetic: Array,
) -> Array:
    """Return the acceleration of slip as printed in (3.6b), with +mu: 2 mu n too large [m s-2].

    The source knows slip to the right only; to the left its mirror image is taken. 0 if the corner
    sticks.
    """
    s, c = diagonal_direction
    sigma_mu = slip_direction * friction_kinetic
    by_contact = (sigma_mu + 3.0 * s * (c - sigma_mu * s)) * floor_acceleration
    sliding = by_contact + free_tangential_acceleration
    return corner.by_case(
        contact_case, slip_direction, free_tangential_acceleration, np.zeros(()), sliding
    )


RECTANGLE_BODY = (
    Equation("corner_angle", corner_angle, "(3.2)"),
    Equation("corner_direction", corner_direction, "(3.2)"),
    Equation("half_diagonal", half_diagonal, "(3.2)"),
    Equation("inertia_ratio", rectangle_inertia_ratio, "theory 2.1"),
)

RECTANGLE_SCENE = Scene(
    name="rectangle-isolated",
    title="Rectangular part with one corner on a plane",
    source="3.2.1",
    validity=VALIDITY,
    variants={
        "thesis": (
            *RECTANGLE_BODY,
            *CORNER,
            Equation(
                "gap_tangential_acceleration",
                rectangle_printed_gap_tangential_acceleration,
                "(3.6b)",
                "thesis",
            ),
        ),
        "derived": (*RECTANGLE_BODY, *DERIVED),
    },
    default_variant="derived",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS},
    defaults=CORNER_DEFAULTS,
    rounding_bound=8,
)


# --- A cylindrical part with one point of its rim on a fixed plane; section 3.3.1 of the source.
#
# The motion is in the plane that holds the axis, so that the part shows as a rectangle d by h.


def cylinder_inertia_ratio(*, corner_direction: Direction) -> Array:
    """Return the inertia ratio, kappa = m rho^2/I = 12/(3 + cos^2 zeta) [1].

    From 3 (needle) to 4 (disc).
    """
    _, cosine = corner_direction
    return 12.0 / (3.0 + cosine * cosine)


def cylinder_printed_gap_tangential_acceleration(
    *,
    contact_case: Array,
    slip_direction: Array,
    floor_acceleration: Array,
    free_tangential_acceleration: Array,
    inertia_ratio: Array,
    diagonal_direction: Direction,
    friction_kinetic: Array,
) -> Array:
    """Return the acceleration of slip as printed in (3.33b), with +mu and cos^2 [m s-2].

    The source prints +mu and cos^2 where -mu and sin^2 are right, and knows slip to the right only;
    to the left its mirror image is taken. 0 if the corner sticks.
    """
    s, c = diagonal_direction
    sigma_mu = slip_direction * friction_kinetic
    by_contact = (sigma_mu + inertia_ratio * c * (s - sigma_mu * c)) * floor_acceleration
    sliding = by_contact + free_tangential_acceleration
    return corner.by_case(
        contact_case, slip_direction, free_tangential_acceleration, np.zeros(()), sliding
    )


CYLINDER_BODY = (
    under_names(
        "corner_angle", corner_angle, "(3.28)",
        "the angle of the diagonal in the part, zeta = atan2(d, h) [rad]", height="diameter",
    ),
    under_names(
        "corner_direction", corner_direction, "(3.28)", "sine and cosine of zeta",
        height="diameter",
    ),
    under_names(
        "half_diagonal", half_diagonal, "(3.28)",
        "the distance from the centre to the rim, rho = sqrt(d^2 + h^2)/2 [m]", height="diameter",
    ),
    Equation("inertia_ratio", cylinder_inertia_ratio, "theory 6"),
)  # fmt: skip

CYLINDER_SCENE = Scene(
    name="cylinder-isolated",
    title="Cylindrical part with one point of its rim on a plane",
    source="3.3.1",
    validity=VALIDITY,
    variants={
        "thesis": (
            *CYLINDER_BODY,
            *CORNER,
            Equation(
                "gap_tangential_acceleration",
                cylinder_printed_gap_tangential_acceleration,
                "(3.33b)",
                "thesis",
            ),
        ),
        "derived": (*CYLINDER_BODY, *DERIVED),
    },
    default_variant="derived",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS},
    defaults=CORNER_DEFAULTS,
    rounding_bound=8,
)
