"""A rectangular part between the floor and the outer wall of a narrow track (theory 4).

The part is a chord of the wall's circle and touches it with its rear and front corner. The source's
contact forces follow from the wall force at the part's top edge and the floor resultant through its
centre; the balance normal to the floor is then left over (`z_residual`), and the forces lie outside
the friction cone. The other forms let the points of action be unknowns instead.

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, compensated_sum, ratio


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
    """Return acceleration K = P cb (ca + mu sa) - g (sin gamma + mu cos gamma sin delta) [m s-2].

    It is that of a part at rest between floor and wall; cb, ca and sa are cos(beta), cos(alpha) and
    sin(alpha). Its sign decides about motion, so that the sum is compensated for rounding.
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
    """Return the acceleration of a part at rest as printed in (3.17) [m s-2].

    There lean lets gravity help: P cos(beta) (cos(alpha) + mu sin(alpha)) - g (sin(gamma) - mu
    cos(gamma) sin(delta)).
    """
    mu = friction_kinetic
    return compensated_sum(drive_along, mu * drive_across, -gravity_along, mu * gravity_across)


def curved_acceleration_x(
    *, starting_acceleration: Array, friction_kinetic: Array, centripetal_acceleration: Array
) -> Array:
    """Return the acceleration along a curved track, K - mu_k v^2/R, (3.17) [m s-2].

    K is that at zero speed, v^2/R the centripetal acceleration.
    """
    return starting_acceleration - friction_kinetic * centripetal_acceleration


def derived_wall_balance(
    *, centripetal_acceleration: Array, gravity_across: Array, drive_across: Array
) -> Array:
    """Return the load on the wall per mass, B = v^2/R + g_y - W [m s-2].

    v^2/R is the centripetal acceleration, g_y gravity towards the wall and W the drive off it.
    """
    return compensated_sum(centripetal_acceleration, gravity_across, -drive_across)


def printed_wall_balance(
    *, centripetal_acceleration: Array, gravity_across: Array, drive_across: Array
) -> Array:
    """Return the load on the wall per mass as printed in (3.16), v^2/R - g_y - W [m s-2].

    v^2/R is the centripetal acceleration, g_y gravity towards the wall and W the drive off it; the
    sign of g_y is wrong.
    """
    return compensated_sum(centripetal_acceleration, -gravity_across, -drive_across)


def top_edge_wall_acceleration(
    *, wall_balance: Array, width: Array, height: Array, friction_static: Array
) -> Array:
    """Return the wall's force per mass at the part's top edge, b B/(2b - mu_s a), (3.16) [m s-2].

    B is the load on the wall per mass, a and b width and height of the part. Negative where the
    wall would have to pull, NaN at the pole 2b = mu_s a.
    """
    return ratio(wall_balance * height, 2 * height - friction_static * width, np.nan)


def top_edge_floor_acceleration(
    *, wall_acceleration: Array, width: Array, height: Array, friction_static: Array
) -> Array:
    """Return the floor's force per mass, S/m (1 - mu_s a/b), (3.15b) [m s-2].

    S/m is the wall's force per mass, a and b are width and height of the part. The source gets it
    from the balance of moments; it does not carry the weight (`z_residual`).
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
    """Return the residual of (3.14) in the balance normal to the floor, per mass [m s-2].

    -g_z + P sin(beta) + n - mu_s s, with gravity g_z, floor force n and wall force s per mass: 0 if
    the forces were in balance.
    """
    return compensated_sum(
        -gravity_normal, drive_normal, floor_acceleration, -friction_static * wall_acceleration
    )


def pushing_wall_acceleration(*, wall_balance: Array) -> Array:
    """Return the wall force per mass of a wall that cannot pull, max(0, B) [m s-2]."""
    return np.maximum(0.0, wall_balance)


def chord_cosine(*, length: Array, radius: Array) -> Array:
    """Return the cosine of half the angle that a part spans as a chord of the bowl's wall [1].

    Of sigma, with sin(sigma) = h/(2R), the part's length h and the wall's radius R [m], since a
    straight part touches a curved wall with its ends; NaN where it is longer than 2R.
    """
    fits = length <= 2 * radius
    half_length = np.where(fits, length / 2, radius)
    cosine = np.sqrt((radius - half_length) * (radius + half_length)) / radius
    return np.where(fits, cosine, np.nan)


def wall_force(*, mass: Array, wall_acceleration: Array) -> Array:
    """Return the sum of the wall normal forces across the track, S [N]."""
    return mass * wall_acceleration


def wall_force_front(
    *, wall_force: Array, chord_cosine: Array, width: Array, length: Array, friction_kinetic: Array
) -> Array:
    """Return the wall's force on the front corner, S (h + mu_k a)/(2 h c), (3.16) [N].

    S is the sum of the wall's forces, h and a length and width of the part, c `chord_cosine`. NaN
    where the corners do not fit.
    """
    lever_ratio = (length + friction_kinetic * width) / length
    return ratio(wall_force, 2 * chord_cosine, np.nan) * lever_ratio


def wall_force_rear(
    *, wall_force: Array, chord_cosine: Array, width: Array, length: Array, friction_kinetic: Array
) -> Array:
    """Return the wall's force on the rear corner, S (h - mu_k a)/(2 h c), (3.16) [N].

    S is the sum of the wall's forces, h and a length and width of the part, c `chord_cosine`. NaN
    where the corners do not fit.
    """
    lever_ratio = (length - friction_kinetic * width) / length
    return ratio(wall_force, 2 * chord_cosine, np.nan) * lever_ratio


def derived_wall_speed(*, drive_across: Array, gravity_across: Array, radius: Array) -> Array:
    """Return the least speed with wall contact, sqrt(R max(0, W - g_y)) [m s-1].

    W is the drive off the wall, g_y gravity towards it, R the wall's radius.
    """
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
    """Return the acceleration between floor and wall, D_x -+ mu_k (n + s), 0 in stick [m s-2].

    It is that along x, with drive and gravity D_x, floor force n and wall force s per mass.
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
    """Return the acceleration off the wall: v^2/R, or W - g_y where the part leaves it [m s-2].

    v^2/R is the centripetal acceleration; the load on the wall, B = v^2/R + g_y - W, is negative
    where the part leaves.
    """
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
    """Return the offset of the floor's resultant along x that balances friction's moment [m].

    The part at the wall tips where it exceeds half the length. The wall's force acts at mid-height.
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
    in_slip = np.where(forward, friction_kinetic, -friction_kinetic)
    in_stick = ratio(np.where(stuck, in_plane_drive_x, 0.0), np.where(stuck, load, 1.0), 0.0)
    friction_over_load = np.where(stuck, in_stick, in_slip)
    return np.where(floor_acceleration > 0, height / 2 * friction_over_load, np.nan)


def is_held(
    *,
    in_plane_drive_x: Array,
    floor_acceleration: Array,
    wall_acceleration: Array,
    friction_static: Array,
    speed: Array,
) -> Mask:
    """True where friction of floor and wall holds a part at rest: |D_x| <= mu_s (n + s).

    It holds for speed 0 only.
    """
    load = floor_acceleration + wall_acceleration
    return (speed == 0) & (np.abs(in_plane_drive_x) <= friction_static * load) & (load > 0)


def is_too_long(*, length: Array, radius: Array) -> Mask:
    """True where the part is longer than the bowl is wide: h > 2R."""
    return length > 2 * radius
