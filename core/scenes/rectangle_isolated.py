"""A rectangular part with one lower corner on a fixed plane; section 3.2.1 of the source."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics import corner
from vibrafeed.core.mechanics.arrays import Array, hypot
from vibrafeed.core.mechanics.corner import Direction
from vibrafeed.core.scenes.corner import CONDITIONS, CORNER, CORNER_DEFAULTS, DERIVED, VALIDITY
from vibrafeed.core.scenes.scene import Equation, Scene


def corner_angle(*, height: Array, length: Array) -> Array:
    """Return the angle of the diagonal in the part, zeta = atan2(b, h) [rad]."""
    return np.arctan2(height, length)


def corner_direction(*, height: Array, length: Array) -> Direction:
    """Return sine and cosine of zeta."""
    return corner.direction_of(height, length)


def half_diagonal(*, height: Array, length: Array) -> Array:
    """Return the distance from the centre to the corner, rho = sqrt(b^2 + h^2)/2 [m]."""
    return hypot(height, length) / 2


def inertia_ratio() -> Array:
    """Return the inertia ratio, kappa = m rho^2/I = 3, the same for every rectangle [1]."""
    return np.full((), 3.0)


def printed_gap_tangential_acceleration(
    *,
    contact_case: Array,
    slip_direction: Array,
    floor_acceleration: Array,
    free_tangential_acceleration: Array,
    diagonal_direction: Direction,
    friction_kinetic: Array,
) -> Array:
    """Return the acceleration of slip as printed in (3.6b), with +mu: 2 mu n too large [m s-2].

    It is that of the touching corner. The source prints +mu, which makes it 2 mu n too large, and
    knows slip to the right only; to the left its mirror image is taken. It is 0 if the corner
    sticks.

    Parameters
    ----------
    contact_case : ndarray
        Number of what the contact does: separates, sticks, slides.
    slip_direction : ndarray
        1 to the right, -1 to the left.
    floor_acceleration, free_tangential_acceleration : ndarray
        Normal force per mass, n, and the acceleration of the corner without contact force [m/s2].
    diagonal_direction : tuple of ndarray
        Sine and cosine of the angle between the line from corner to centre and the plane.
    friction_kinetic : ndarray
        The friction coefficient.
    """
    s, c = diagonal_direction
    sigma_mu = slip_direction * friction_kinetic
    pushed = (sigma_mu + 3.0 * s * (c - sigma_mu * s)) * floor_acceleration
    sliding = pushed + free_tangential_acceleration
    return corner.by_case(
        contact_case, slip_direction, free_tangential_acceleration, np.zeros(()), sliding
    )


BODY = (
    Equation("corner_angle", corner_angle, "(3.2)"),
    Equation("corner_direction", corner_direction, "(3.2)"),
    Equation("half_diagonal", half_diagonal, "(3.2)"),
    Equation("inertia_ratio", inertia_ratio, "theory 2.1"),
)
PRINTED = Equation(
    "gap_tangential_acceleration", printed_gap_tangential_acceleration, "(3.6b)", "thesis"
)

SCENE = Scene(
    name="rectangle-isolated",
    title="Rectangular part with one corner on a plane",
    source="3.2.1",
    validity=VALIDITY,
    variants={"thesis": (*BODY, *CORNER, PRINTED), "derived": (*BODY, *DERIVED)},
    default_variant="derived",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS},
    defaults=CORNER_DEFAULTS,
    rounding_bound=8,
)
