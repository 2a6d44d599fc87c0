"""A rectangular part between the floor and the outer wall of a narrow track (theory 4).

The part is a chord of the wall's circle and touches it with its rear and front corner. The source's
contact forces follow from the wall force at the part's top edge and the floor resultant through its
centre; the balance normal to the floor is then left over (`z_residual`), and the forces lie outside
the friction cone. The other forms let the points of action be unknowns instead.

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from core.mechanics.arrays import Array, Mask, compensated_sum, ratio


def centripetal_acceleration(*, speed: Array, radius: Array) -> Array:
    """Return the acceleration v^2/R of a part that follows the wall [m s-2]."""
    return speed * (speed / radius)


def derived_starting_acceleration(
    *,
    drive_along: Array,
    drive_across: Array,
    gravity_along: Array,
    gravity_across: Array,
    friction_kinetic: Array,
) -> Array:
    """Return acceleration P cb (ca + mu sa) - g (sin gamma + mu cos gamma sin delta) [m s-2].

    Its sign decides about motion: the sum is compensated.
    """
    mu = friction_kinetic
    return compensated_sum(drive_along, mu * drive_across, -gravity_along, -mu * gravity_across)


def printed_starting_acceleration(
    *,
    drive_along: Array,
    drive_across: Array,
    gravity_along: Array,
    gravity_across: Array,
    friction_kinetic: Array,
) -> Array:
    """Return the starting acceleration as printed in (3.17), where lean lets gravity help."""
    mu = friction_kinetic
    return compensated_sum(drive_along, mu * drive_across, -gravity_along, mu * gravity_across)


def curved_acceleration_x(
    *, starting_acceleration: Array, friction_kinetic: Array, centripetal_acceleration: Array
) -> Array:
    """Return the acceleration K - mu_k v^2/R, (3.17) [m s-2]."""
    return starting_acceleration - friction_kinetic * centripetal_acceleration


def curved_acceleration_y(*, centripetal_acceleration: Array) -> Array:
    """Return the acceleration v^2/R of a part that follows the wall [m s-2]."""
    return centripetal_acceleration


def derived_wall_balance(
    *, centripetal_acceleration: Array, gravity_across: Array, drive_across: Array
) -> Array:
    """Return the load on the wall per mass, B = v^2/R + g_y - W [m s-2]."""
    return compensated_sum(centripetal_acceleration, gravity_across, -drive_across)


def printed_wall_balance(
    *, centripetal_acceleration: Array, gravity_across: Array, drive_across: Array
) -> Array:
    """Return the load on the wall per mass, v^2/R - g_y - W, as printed in (3.16) [m s-2]."""
    return compensated_sum(centripetal_acceleration, -gravity_across, -drive_across)


def top_edge_wall_acceleration(
    *, wall_balance: Array, width: Array, height: Array, friction_static: Array
) -> Array:
    """Return the force per mass b B/(2b - mu_s a), (3.16); NaN at the pole 2b = mu_s a [m s-2].

    Negative where the wall would have to pull.
    """
    return ratio(wall_balance * height, 2 * height - friction_static * width, np.nan)


def top_edge_floor_acceleration(
    *, wall_acceleration: Array, width: Array, height: Array, friction_static: Array
) -> Array:
    """Return the floor force per mass, S/m (1 - mu_s a/b), (3.15b) [m s-2].

    The source defines it by the moment balance; it does not carry the weight (`z_residual`).
    """
    return wall_acceleration * (1 - friction_static * (width / height))


def z_residual(
    *,
    gravity_normal: Array,
    drive_normal: Array,
    floor_acceleration: Array,
    wall_acceleration: Array,
    friction_static: Array,
) -> Array:
    """Return the residual of (3.14) in the balance normal to the floor, per mass [m s-2]."""
    return compensated_sum(
        -gravity_normal, drive_normal, floor_acceleration, -friction_static * wall_acceleration
    )


def pushing_wall_acceleration(*, wall_balance: Array) -> Array:
    """Return the wall force per mass of a wall that cannot pull, max(0, B) [m s-2]."""
    return np.maximum(0.0, wall_balance)


def chord_cosine(*, length: Array, radius: Array) -> Array:
    """Return the cosine of sigma, sin(sigma) = h/(2R); NaN where the part is longer than 2R [1]."""
    fits = length <= 2 * radius
    half = np.where(fits, length / 2, radius)
    cosine = np.sqrt((radius - half) * (radius + half)) / radius
    return np.where(fits, cosine, np.nan)


def wall_force(*, mass: Array, wall_acceleration: Array) -> Array:
    """Return the sum of the wall normal forces across the track, S [N]."""
    return mass * wall_acceleration


def wall_force_front(
    *, wall_force: Array, chord_cosine: Array, width: Array, length: Array, friction_kinetic: Array
) -> Array:
    """Return the force S (h + mu_k a)/(2 h c), (3.16) [N]; NaN where the corners do not fit."""
    share = (length + friction_kinetic * width) / length
    return ratio(wall_force, 2 * chord_cosine, np.nan) * share


def wall_force_rear(
    *, wall_force: Array, chord_cosine: Array, width: Array, length: Array, friction_kinetic: Array
) -> Array:
    """Return the force S (h - mu_k a)/(2 h c), (3.16) [N]; NaN where the corners do not fit."""
    share = (length - friction_kinetic * width) / length
    return ratio(wall_force, 2 * chord_cosine, np.nan) * share


def derived_wall_speed(*, drive_across: Array, gravity_across: Array, radius: Array) -> Array:
    """Return the least speed with wall contact, sqrt(R max(0, W - g_y)) [m s-1]."""
    return np.sqrt(radius) * np.sqrt(np.maximum(0.0, drive_across - gravity_across))


def printed_wall_speed(*, drive_across: Array, gravity_across: Array, radius: Array) -> Array:
    """Return the least speed with wall contact, with the sign of g_y that (3.16) prints [m s-1]."""
    return np.sqrt(radius) * np.sqrt(np.maximum(0.0, drive_across + gravity_across))


def supported_acceleration_x(
    *,
    in_plane_drive_x: Array,
    floor_acceleration: Array,
    wall_acceleration: Array,
    friction_static: Array,
    friction_kinetic: Array,
    speed: Array,
) -> Array:
    """Return the acceleration of a part that slides, D_x -+ mu_k (n + s), 0 in stick [m s-2].

    Friction opposes the speed; from rest, the drive.
    """
    load = floor_acceleration + wall_acceleration
    forward = (speed > 0) | (in_plane_drive_x > 0)
    friction = np.where(forward, friction_kinetic, -friction_kinetic) * load
    stuck = is_held(
        in_plane_drive_x=in_plane_drive_x,
        floor_acceleration=floor_acceleration,
        wall_acceleration=wall_acceleration,
        friction_static=friction_static,
        speed=speed,
    )
    return np.where(stuck, 0.0, in_plane_drive_x - friction)


def off_wall_acceleration_y(*, centripetal_acceleration: Array, wall_balance: Array) -> Array:
    """Return the acceleration v^2/R along the wall, W - g_y where the part leaves it [m s-2]."""
    return centripetal_acceleration + np.maximum(0.0, -wall_balance)


def held_pressure_offset_x(
    *,
    height: Array,
    in_plane_drive_x: Array,
    floor_acceleration: Array,
    wall_acceleration: Array,
    friction_static: Array,
    friction_kinetic: Array,
    speed: Array,
) -> Array:
    """Return the offset of the floor resultant along x, wall force at mid-height [m].

    mu_k b/2 towards the motion in sliding. In stick, floor and wall are taken to share the drive in
    proportion to their normal forces, which the balance leaves open. NaN in flight.
    """
    load = floor_acceleration + wall_acceleration
    stuck = is_held(
        in_plane_drive_x=in_plane_drive_x,
        floor_acceleration=floor_acceleration,
        wall_acceleration=wall_acceleration,
        friction_static=friction_static,
        speed=speed,
    )
    forward = (speed > 0) | (in_plane_drive_x > 0)
    sliding = np.where(forward, friction_kinetic, -friction_kinetic)
    held = ratio(np.where(stuck, in_plane_drive_x, 0.0), np.where(stuck, load, 1.0), 0.0)
    share = np.where(stuck, held, sliding)
    return np.where(floor_acceleration > 0, height / 2 * share, np.nan)


def is_held(
    *,
    in_plane_drive_x: Array,
    floor_acceleration: Array,
    wall_acceleration: Array,
    friction_static: Array,
    speed: Array,
) -> Mask:
    """True where friction of floor and wall holds a part at rest: |D_x| <= mu_s (n + s)."""
    load = floor_acceleration + wall_acceleration
    return (speed == 0) & (np.abs(in_plane_drive_x) <= friction_static * load) & (load > 0)


def has_left_wall(*, wall_balance: Array) -> Mask:
    """True where the part has left the wall: B < 0."""
    return wall_balance < 0


def has_left_floor_and_wall(*, normal_acceleration: Array, wall_balance: Array) -> Mask:
    """True where the part has left floor and wall."""
    return (normal_acceleration <= 0) & (wall_balance < 0)


def presses_wall(*, wall_balance: Array) -> Mask:
    """True where the part presses on the wall, so that the forces of (3.15) leave the cone."""
    return wall_balance > 0


def topples_on_wall(*, width: Array, height: Array, friction_static: Array) -> Mask:
    """True where (3.16) does not hold: 2b <= mu_s a."""
    return 2 * height <= friction_static * width


def rear_corner_lifts(
    *, width: Array, length: Array, radius: Array, friction_kinetic: Array
) -> Mask:
    """True where not both corners touch the wall: h <= mu_k a, or h >= 2R."""
    return (length <= friction_kinetic * width) | (length >= 2 * radius)


def is_too_long(*, length: Array, radius: Array) -> Mask:
    """True where the part is longer than the bowl is wide: h > 2R."""
    return length > 2 * radius
