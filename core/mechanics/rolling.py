"""A cylinder that lies on a plane, axis along x: rolling and sliding from rest (theory 7).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from core.mechanics.arrays import Array, Mask, hypot, ratio
from core.mechanics.elementwise import Elementwise

# Newton's steps: a solid cylinder has its root to the last bit after five, over all inputs that the
# tests try; what turns more easily needs more. A loop over arrays stops as soon as no root moves; a
# compiled one takes them all.
SOLID_STEPS, MAX_STEPS = 5, 12

SOLID = 2.0
"""m r^2/I of a solid cylinder about its axis, kap."""


def printed_angular_acceleration(*, drive_across: Array, diameter: Array) -> Array:
    """Return the angular acceleration 4 P cos(beta) sin(alpha)/d as printed in (3.36) [rad s-2].

    The source divides the drive's moment about the contact line by the inertia about the centre:
    three times the right value.
    """
    return 4 * drive_across / diameter


def rolling_angular_acceleration(*, drive_across: Array, diameter: Array) -> Array:
    """Return the angular acceleration 4 P cos(beta) sin(alpha)/(3 d), as in (4.19) [rad s-2].

    The same moment as printed, with the inertia about the contact line.
    """
    return 4 * drive_across / (3 * diameter)


def is_rolling(
    *,
    in_plane_drive_x: Array,
    in_plane_drive_y: Array,
    friction_static: Array,
    floor_acceleration: Array,
) -> Mask:
    """True where the contact line does not slip: hypot(D_x, D_y/3) <= mu_s n, n > 0."""
    held = hypot(in_plane_drive_x, in_plane_drive_y / 3) <= friction_static * floor_acceleration
    return held & (floor_acceleration > 0)


def is_at_rest(
    *,
    in_plane_drive_x: Array,
    in_plane_drive_y: Array,
    friction_static: Array,
    floor_acceleration: Array,
) -> Mask:
    """True where the cylinder stays at rest: no slip, and nothing that makes it roll."""
    held = np.abs(in_plane_drive_x) <= friction_static * floor_acceleration
    return held & (in_plane_drive_y == 0) & (floor_acceleration > 0)


def roll_root(
    *,
    in_plane_drive_x: Array,
    in_plane_drive_y: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the positive root z of D_x^2/(z+q)^2 + D_y^2/(z+3q)^2 = 1, q = mu_k n [m s-2].

    0 where the cylinder rolls without slip.
    """
    return slip_root(
        in_plane_drive_x, in_plane_drive_y, SOLID, friction_static, friction_kinetic,
        floor_acceleration,
    )  # fmt: skip


def slip_root(
    along: Array, across: Array, rolling_factor: Array | float, friction_static: Array,
    friction_kinetic: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the positive root z of D_a^2/(z+q)^2 + D_c^2/(z+(1+kap)q)^2 = 1, q = mu_k n [m s-2].

    D_a pushes along the axis, D_c across it; 0 where the part rolls without slip. After lift-off
    q = 0 and the root is |D|.
    """
    held = 1 + rolling_factor
    Dx, Dy = np.abs(along), np.abs(across)
    rolls: Mask = hypot(along, across / held) <= friction_static * floor_acceleration
    rolls = rolls & (floor_acceleration > 0)
    q = friction_kinetic * floor_acceleration
    magnitude = hypot(Dx, Dy)
    slips = ~rolls & (magnitude > 0)
    # Unit scale, so that no power leaves the range of floats.
    scale = np.where(slips, magnitude, 1.0)
    x = np.where(slips, Dx, 1.0) / scale
    y, s = np.where(slips, Dy, 0.0) / scale, np.where(slips, q, 0.0) / scale
    return np.where(slips, slip_share(x, y, s, held) * scale, 0.0)


@Elementwise
def slip_share(x: Array, y: Array, s: Array, held: Array | float) -> Array:
    """Return the positive root z of h(z) = x^2/(z+s)^2 + y^2/(z+held s)^2 = 1, x^2 + y^2 = 1.

    1/sqrt(h) is concave and nearly linear in z: its chords to infinity, and those of each term
    alone, lie below the root, and Newton's method climbs from there without safeguard (the secular
    equation of trust-region methods). sqrt(h) - 1 is written as 2 (h - 1)/(h + 3), which is less,
    and the same up to the third order: a step has one quotient and no root.
    """
    xx, yy = x * x, y * y
    z = np.maximum(np.maximum(x - s, y - held * s), np.maximum(1.0 - s * (xx + held * yy), 0.0))
    steps = SOLID_STEPS if type(held) is float and held <= 1 + SOLID else MAX_STEPS
    for _ in range(steps):
        a, b = z + s, z + held * s
        aa, bb = a * a, b * b
        xb, ya, ab = xx * bb, yy * aa, aa * bb
        h = xb + ya
        ahead = z + 2.0 * (a * b) * (h - ab) * h / ((3.0 * ab + h) * (xb * b + ya * a))
        if not np.any(ahead > z):  # a cell that has its root keeps it
            break
        z = np.where(ahead > z, ahead, z)
    return z


def across_axis(
    push: Array, roll_root: Array, rolling_factor: Array | float, rolling_share: Array | float,
    friction_kinetic: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration across the axis, D_c (z + kap q)/(z + (1 + kap) q) [m s-2].

    At z = 0 this is the rolling value, D_c kap/(1 + kap).
    """
    q = friction_kinetic * floor_acceleration
    more = roll_root + (1 + rolling_factor) * q
    share = ratio(roll_root + rolling_factor * q, more, rolling_share)
    return push * np.where(roll_root == 0, rolling_share, share)


def slipping_acceleration_x(
    *,
    in_plane_drive_x: Array,
    roll_root: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the acceleration along the axis, D_x - q e_x, as D_x z/(z+q) [m s-2]."""
    q = friction_kinetic * floor_acceleration
    return in_plane_drive_x * ratio(roll_root, roll_root + q, 0.0)


def slipping_acceleration_y(
    *,
    in_plane_drive_y: Array,
    roll_root: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the acceleration in rolling direction, D_y - q e_y, as D_y (z+2q)/(z+3q) [m s-2].

    At z = 0 this is the rolling value 2 D_y/3.
    """
    return across_axis(
        in_plane_drive_y, roll_root, SOLID, 2.0 / 3.0, friction_kinetic, floor_acceleration
    )


def slipping_angular_acceleration(
    *,
    in_plane_drive_y: Array,
    roll_root: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
    diameter: Array,
) -> Array:
    """Return the angular acceleration, 2 q e_y/r as 4 q D_y/((z+3q) d) [rad s-2].

    At z = 0 this is the rolling value 4 D_y/(3 d); 0 in flight.
    """
    q = friction_kinetic * floor_acceleration
    e_y = ratio(in_plane_drive_y, roll_root + 3 * q, 0.0)
    return 4 * np.where(roll_root == 0, in_plane_drive_y / 3, q * e_y) / diameter
