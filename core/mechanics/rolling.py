"""A cylinder that lies on a plane, axis along x: rolling and sliding from rest (theory 7).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from core.mechanics.arrays import Array, Mask, hypot, ratio

# Newton's steps for the secular equation converge from below, in six at most over all inputs that
# the tests try, and in two more to 50 digits. A loop over arrays stops as soon as no root moves; a
# compiled one takes them all.
MAX_STEPS = 9

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

    D_a pushes along the axis, D_c across it; 0 where the part rolls without slip. The left side
    falls strictly with z. Its inverse root is concave and nearly linear in z, so that Newton's
    method on it, started below the root, climbs to it without safeguard (the secular equation of
    trust-region methods). After lift-off q = 0 and the root is |D|.
    """
    held = 1 + rolling_factor
    Dx, Dy = np.abs(along), np.abs(across)
    rolls: Mask = hypot(along, across / held) <= friction_static * floor_acceleration
    rolls = rolls & (floor_acceleration > 0)
    q = friction_kinetic * floor_acceleration
    magnitude = hypot(Dx, Dy)
    slips = ~rolls & (magnitude > 0)
    # Unit scale, so that neither squares nor cubes leave the range of floats.
    scale = np.where(slips, magnitude, 1.0)
    x, y, s = (np.where(slips, part, 0.0) / scale for part in (Dx, Dy, q))
    z = np.maximum(np.maximum(x - s, y - held * s), np.maximum(1.0 - held * s, 0.0))
    z = np.where(slips, z, 1.0)
    for _ in range(MAX_STEPS):
        ex, ey = ratio(x, z + s, 0.0), ratio(y, z + held * s, 0.0)
        norm = hypot(ex, ey)
        slope = ratio(ex * ex, z + s, 0.0) + ratio(ey * ey, z + held * s, 0.0)
        step = ratio((norm - 1.0) * norm * norm, slope, 0.0)
        ahead = z + step
        if not np.any(slips & (ahead > z)):  # a cell that has its root keeps it
            break
        z = np.where(slips & (ahead > z), ahead, z)
    return np.where(slips, z * scale, 0.0)


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
