"""A cylindrical part with one point of its rim on a fixed plane; section 3.3.1 of the source.

The motion is in the plane that holds the axis, so that the part shows as a rectangle d by h.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics import corner
from vibrafeed.core.mechanics.arrays import Array, hypot
from vibrafeed.core.mechanics.corner import Direction
from vibrafeed.core.scenes.corner import CONDITIONS, CORNER, CORNER_DEFAULTS, DERIVED, VALIDITY
from vibrafeed.core.scenes.scene import Equation, Scene


def corner_angle(*, diameter: Array, length: Array) -> Array:
    """Return the angle of the diagonal in the part, zeta = atan2(d, h) [rad]."""
    return np.arctan2(diameter, length)


def corner_direction(*, diameter: Array, length: Array) -> Direction:
    """Return sine and cosine of zeta."""
    return corner.direction_of(diameter, length)


def half_diagonal(*, diameter: Array, length: Array) -> Array:
    """Return the distance from the centre to the rim, rho = sqrt(d^2 + h^2)/2 [m]."""
    return hypot(diameter, length) / 2


def inertia_ratio(*, corner_direction: Direction) -> Array:
    """Return the inertia ratio, kappa = m rho^2/I = 12/(3 + cos^2 zeta) [1].

    From 3 (needle) to 4 (disc).
    """
    _, cosine = corner_direction
    return 12.0 / (3.0 + cosine * cosine)


def printed_gap_tangential_acceleration(
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

    It is that of the touching corner. The source prints +mu and cos^2 where -mu and sin^2 are
    right, and knows slip to the right only; to the left its mirror image is taken. It is 0 if the
    corner sticks.

    Parameters
    ----------
    contact_case : ndarray
        Number of what the contact does: separates, sticks, slides.
    slip_direction : ndarray
        1 to the right, -1 to the left.
    floor_acceleration, free_tangential_acceleration : ndarray
        Normal force per mass, and the acceleration of the corner without contact force [m/s2].
    inertia_ratio, friction_kinetic : ndarray
        m rho^2/I with the distance rho from corner to centre, and the friction coefficient.
    diagonal_direction : tuple of ndarray
        Sine and cosine of the angle of that line to the plane.
    """
    s, c = diagonal_direction
    sigma_mu = slip_direction * friction_kinetic
    pushed = (sigma_mu + inertia_ratio * c * (s - sigma_mu * c)) * floor_acceleration
    sliding = pushed + free_tangential_acceleration
    return corner.by_case(
        contact_case, slip_direction, free_tangential_acceleration, np.zeros(()), sliding
    )


BODY = (
    Equation("corner_angle", corner_angle, "(3.28)"),
    Equation("corner_direction", corner_direction, "(3.28)"),
    Equation("half_diagonal", half_diagonal, "(3.28)"),
    Equation("inertia_ratio", inertia_ratio, "theory 6"),
)
PRINTED = Equation(
    "gap_tangential_acceleration", printed_gap_tangential_acceleration, "(3.33b)", "thesis"
)

SCENE = Scene(
    name="cylinder-isolated",
    title="Cylindrical part with one point of its rim on a plane",
    source="3.3.1",
    validity=VALIDITY,
    variants={"thesis": (*BODY, *CORNER, PRINTED), "derived": (*BODY, *DERIVED)},
    default_variant="derived",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS},
    defaults=CORNER_DEFAULTS,
    rounding_bound=8,
)
