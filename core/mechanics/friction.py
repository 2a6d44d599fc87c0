"""Coulomb friction: per axis as the source prints it, and as one disc (theory 1.5).

All functions take and return broadcastable float64 arrays, SI units.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, ratio


def friction_static(*, friction: Array) -> Array:
    """Return the static coefficient where one coefficient serves for both [1]."""
    return friction


def friction_kinetic(*, friction: Array) -> Array:
    """Return the kinetic coefficient where one coefficient serves for both [1]."""
    return friction


def per_axis_acceleration_x(
    *, in_plane_drive_x: Array, friction_kinetic: Array, normal_acceleration: Array
) -> Array:
    """Return the acceleration along x as printed, D_x - mu n0, (3.9), (3.11), (3.36) [m s-2].

    D_x is drive and gravity along x, n0 the normal force, both per mass. The source lets friction
    act along -x whatever the sliding direction, and does not check n0: after lift-off (n0 < 0) this
    friction drives the part.
    """
    return in_plane_drive_x - friction_kinetic * normal_acceleration


def per_axis_acceleration_y(
    *, in_plane_drive_y: Array, friction_kinetic: Array, normal_acceleration: Array
) -> Array:
    """Return the acceleration along y as printed, D_y - mu n0, (3.9), (3.11), (3.36) [m s-2].

    D_y is the drive along y, n0 the normal force, both per mass. Friction acts along -y even where
    nothing pushes sideways; see `per_axis_acceleration_x`.
    """
    return in_plane_drive_y - friction_kinetic * normal_acceleration


def is_stuck(*, in_plane_drive: Array, friction_static: Array, floor_acceleration: Array) -> Mask:
    """True where static friction holds a part at rest: |D| <= mu_s n, n > 0.

    |D| (`in_plane_drive`) is the size of drive and gravity in the floor, n the floor's force, both
    per mass [m s-2].
    """
    return (in_plane_drive <= friction_static * floor_acceleration) & (floor_acceleration > 0)


def sliding_fraction(
    *,
    in_plane_drive: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the share of the drive that accelerates: stick 0, slip 1 - mu_k n/|D|, flight 1 [1].

    From rest. |D| (`in_plane_drive`) is the size of drive and gravity in the floor, n the floor's
    force, both per mass [m s-2]. Friction opposes the impending sliding velocity, which is along D.
    """
    stuck = is_stuck(
        in_plane_drive=in_plane_drive,
        friction_static=friction_static,
        floor_acceleration=floor_acceleration,
    )
    resisting = np.where(stuck, 0.0, friction_kinetic * floor_acceleration)
    return np.where(stuck, 0.0, 1.0 - ratio(resisting, in_plane_drive, 0.0))


def disc_acceleration_x(*, in_plane_drive_x: Array, sliding_fraction: Array) -> Array:
    """Return the acceleration along x from rest, both axes sharing one friction disc [m s-2]."""
    return in_plane_drive_x * sliding_fraction


def disc_acceleration_y(*, in_plane_drive_y: Array, sliding_fraction: Array) -> Array:
    """Return the acceleration along y from rest, both axes sharing one friction disc [m s-2]."""
    return in_plane_drive_y * sliding_fraction


def _friction_share(
    drive: Array,
    in_plane_drive: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return one component of the friction force over the normal force; NaN in flight [1].

    `drive` is that component of drive and gravity in the floor, `in_plane_drive` their size and
    `floor_acceleration` the normal force, all per mass [m s-2].
    """
    stuck = is_stuck(
        in_plane_drive=in_plane_drive,
        friction_static=friction_static,
        floor_acceleration=floor_acceleration,
    )
    held = ratio(np.where(stuck, drive, 0.0), np.where(stuck, floor_acceleration, 1.0), 0.0)
    sliding = friction_kinetic * ratio(drive, in_plane_drive, 0.0)
    return np.where(floor_acceleration > 0, np.where(stuck, held, sliding), np.nan)


def pressure_offset_x(
    *,
    height: Array,
    in_plane_drive_x: Array,
    in_plane_drive: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the offset along x of the floor's resultant that balances friction's moment [m].

    A part of the given `height` b [m] tips where it exceeds half the length. Friction acts b/2
    below the centre, so that the offset is b/2 times friction along x over the normal force; NaN in
    flight. `in_plane_drive` is the size of drive and gravity in the plane, `in_plane_drive_x` their
    component along x, `floor_acceleration` the floor's force, all per mass [m s-2].
    """
    share = _friction_share(
        in_plane_drive_x, in_plane_drive, friction_static, friction_kinetic, floor_acceleration
    )
    return height / 2 * share


def pressure_offset_y(
    *,
    height: Array,
    in_plane_drive_y: Array,
    in_plane_drive: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the offset along y of the floor's resultant that balances friction's moment [m].

    A part of the given `height` b [m] tips where it exceeds half the width. Friction acts b/2 below
    the centre, so that the offset is b/2 times friction along y over the normal force; NaN in
    flight. `in_plane_drive` is the size of drive and gravity in the plane, `in_plane_drive_y` their
    component along y, `floor_acceleration` the floor's force, all per mass [m s-2].
    """
    share = _friction_share(
        in_plane_drive_y, in_plane_drive, friction_static, friction_kinetic, floor_acceleration
    )
    return height / 2 * share


def tips_x(*, pressure_offset_x: Array, length: Array) -> Mask:
    """True where the floor resultant leaves the base along x: the part tips."""
    return np.abs(pressure_offset_x) > length / 2


def tips_y(*, pressure_offset_y: Array, width: Array) -> Mask:
    """True where the floor resultant leaves the base along y: the part tips."""
    return np.abs(pressure_offset_y) > width / 2
