"""A disc, coin or ring on its edge, its face against the wall of a track (theory 18.1).

It rolls along x, kap = m r^2/I, and its face slides on the wall: the wall's force s presses through
the centre, and its friction mu_w s acts there. Axes of the wrenches: n upwards, eta along x, sigma
across, off the wall. All functions take and return broadcastable float64 arrays, SI units.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.round_parts import least_friction
from vibrafeed.core.mechanics.screws import Wrench, vector


def leaves_wall(*, wall_balance: Array) -> Mask:
    """True where nothing presses the disc onto the wall: its load is below 0."""
    return wall_balance < 0


def wall_as_floor(*, friction_kinetic: Array) -> Array:
    """Return the floor's kinetic friction, for a wall of the same material [1]."""
    return friction_kinetic


def net_push(*, in_plane_drive_x: Array, wall_friction: Array, wall_acceleration: Array) -> Array:
    """Return the drive along x less the wall's friction, sgn(D) max(0, |D| - mu_w s) [m s-2].

    D is drive and gravity along x per mass, mu_w the wall's friction, s the wall's force per mass
    (`wall_acceleration`). 0 where the wall's friction holds the disc.
    """
    left = np.maximum(np.abs(in_plane_drive_x) - wall_friction * wall_acceleration, 0.0)
    return np.where(in_plane_drive_x < 0, -left, left)


def is_held(*, net_push: Array) -> Mask:
    """True where the friction of the wall holds the disc."""
    return net_push == 0


def disc_friction(*, net_push: Array, rolling_factor: Array, floor_acceleration: Array) -> Array:
    """Return the least static friction with which the disc rolls, |D - w|/((1 + kap) n) [1].

    D - w is the net push along x (drive less wall friction, per mass), kap = m r^2/I the rolling
    factor and n the floor's force per mass; infinite in flight.
    """
    return least_friction(net_push, rolling_factor, floor_acceleration)


def disc_acceleration(
    *, net_push: Array, required_friction: Array, friction_static: Array, friction_kinetic: Array,
    rolling_share: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration along x, kap/(1 + kap) of the net push if the disc rolls [m s-2].

    The net push D - w is drive less wall friction per mass, kap/(1 + kap) is `rolling_share`. Where
    the edge slips on the floor, it is the net push less mu_k n in size, n being the floor's force
    per mass.
    """
    slipping = np.maximum(np.abs(net_push) - friction_kinetic * floor_acceleration, 0.0)
    slipping = np.where(net_push < 0, -slipping, slipping)
    return np.where(required_friction <= friction_static, rolling_share * net_push, slipping)


def disc_floor_friction(
    *, mass: Array, net_push: Array, required_friction: Array, friction_static: Array,
    friction_kinetic: Array, rolling_factor: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the friction force of the floor that turns a disc on its edge, positive along -x [N].

    m (D - w)/(1 + kap) where it rolls, else mu_k m n, at most the push itself: `net_push` D - w is
    the push along less the wall's friction [m s-2], kap = m r^2/I the `rolling_factor`, n the
    floor's force per mass [m s-2], m the mass [kg]. It rolls if `required_friction` is within
    static friction.
    """
    slipping = np.minimum(np.abs(net_push), friction_kinetic * floor_acceleration)
    slipping = np.where(net_push < 0, -slipping, slipping)
    rolling = net_push / (1 + rolling_factor)
    return mass * np.where(required_friction <= friction_static, rolling, slipping)


def disc_spin(
    *, rolling_friction: Array, mass: Array, rolling_factor: Array, diameter: Array
) -> Array:
    """Return the angular acceleration of the disc about its axis, kap F/(m r) [rad s-2].

    F is the floor's friction force [N], kap = m r^2/I the rolling factor and r the radius.
    """
    return rolling_factor * rolling_friction / (mass * diameter / 2)


def wall_drag(
    *, mass: Array, in_plane_drive_x: Array, wall_friction: Array, wall_acceleration: Array
) -> Array:
    """Return the wall's friction force on the disc, positive along -x [N].

    m mu_w s against the drive D (per mass), or m D where friction holds the disc; s is the wall's
    force per mass (`wall_acceleration`).
    """
    held = np.minimum(np.abs(in_plane_drive_x), wall_friction * wall_acceleration)
    return mass * np.where(in_plane_drive_x < 0, -held, held)


def disc_floor_wrench(*, floor_force: Array, rolling_friction: Array, diameter: Array) -> Wrench:
    """Return the wrench of the floor about the disc's centre [N, N m].

    Axes n (up), eta (along x), sigma (off the wall): the force (N, -F, 0) of floor force and
    friction, and the moment r F about sigma.
    """
    zero = np.zeros(())
    force = vector(floor_force, -rolling_friction, zero)
    return Wrench(force, vector(zero, zero, diameter / 2 * rolling_friction))


def disc_force_wrench(
    *, mass: Array, acceleration_x: Array, rolling_friction: Array, diameter: Array
) -> Wrench:
    """Return the wrench of drive, gravity, floor and wall about the disc's centre [N, N m].

    Axes n (up), eta (along x), sigma (off the wall): the force m a along eta and the moment r F
    about sigma, F being the floor's friction.
    """
    zero = np.zeros(())
    force = vector(zero, mass * acceleration_x, zero)
    return Wrench(force, vector(zero, zero, diameter / 2 * rolling_friction))
