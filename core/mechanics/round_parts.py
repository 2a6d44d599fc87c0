"""Balls, tubes, discs and cones that roll on a plane, from rest (theory 18.1).

With kap = m r^2/I, I about the axis that a part turns about, the point of contact is pushed off by
a force of friction F with (1 + kap) F/m: it slips as a block does under (1 + kap) times the
friction. All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

import numpy as np

from vibrafeed.core.mechanics import rolling
from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, hypot, ratio, sine
from vibrafeed.core.mechanics.floor import over_load
from vibrafeed.core.mechanics.screws import Wrench, vector

# --- how much of a part turns


def tube_factor(*, diameter: Array, inner_diameter: Array) -> Array:
    """Return the rolling factor m r^2/I of a tube about its axis, 2/(1 + q^2), q = d_i/d [1].

    2 for a solid cylinder or disc, 1 for a hoop.
    """
    q = inner_diameter / diameter
    return 2 / (1 + q * q)


def ball_factor(*, diameter: Array, inner_diameter: Array) -> Array:
    """Return the rolling factor m r^2/I of a hollow ball, (5/2) (1 - q^3)/(1 - q^5), q = d_i/d [1].

    5/2 for a solid ball, 3/2 for a thin shell.
    """
    q = inner_diameter / diameter
    # 1 - q is a factor of both: without it a thin shell loses no digit.
    return 2.5 * (1 + q * (1 + q)) / (1 + q * (1 + q * (1 + q * (1 + q))))


def rolling_share(*, rolling_factor: Array) -> Array:
    """Return the share of a push that accelerates a rolling part, kap/(1 + kap) [1].

    kap = m r^2/I is the rolling factor.
    """
    return rolling_factor / (1 + rolling_factor)


# --- a ball: isotropic


def least_friction(push: Array, rolling_factor: Array, floor_acceleration: Array) -> Array:
    """Return the least static friction with which a part rolls, |D|/((1 + kap) n) [1].

    D is the push in the floor, n the floor's force, both per mass, kap = m r^2/I; infinite in
    flight.
    """
    in_contact = floor_acceleration > 0
    needed = np.abs(push) / ((1 + rolling_factor) * np.where(in_contact, floor_acceleration, 1.0))
    return np.where(in_contact, needed, np.inf)


def rolls(*, required_friction: Array, friction_static: Array) -> Mask:
    """True where static friction is enough to roll."""
    return required_friction <= friction_static


def ball_fraction(
    *, in_plane_drive: Array, required_friction: Array, friction_static: Array,
    friction_kinetic: Array, rolling_share: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration of a ball's centre over the push D in the floor, |a|/|D| [1].

    kap/(1 + kap) where it rolls, 1 - mu_k n/|D| where it slips, 1 in flight.
    """
    slipping = 1.0 - friction_kinetic * ratio(floor_acceleration, in_plane_drive, 0.0)
    return np.where(required_friction <= friction_static, rolling_share, slipping)


def ball_spin(
    *, in_plane_drive: Array, required_friction: Array, friction_static: Array,
    friction_kinetic: Array, rolling_factor: Array, rolling_share: Array,
    floor_acceleration: Array, diameter: Array,
) -> Array:  # fmt: skip
    """Return the angular acceleration of a ball, |a|/r where it rolls [rad s-2].

    |a| = D kap/(1 + kap) is the acceleration of its centre; kap mu_k n/r where it slips, 0 in
    flight (theory 18.1).
    """
    slipping = rolling_factor * friction_kinetic * floor_acceleration
    rolling_rim = rolling_share * in_plane_drive
    rim_acceleration = np.where(required_friction <= friction_static, rolling_rim, slipping)
    return rim_acceleration / (diameter / 2)


# --- a roller, tube or ring: rolls across its axis, slides along it


def push_across_axis(*, in_plane_drive_x: Array, in_plane_drive_y: Array, axis_yaw: Array) -> Array:
    """Return drive and gravity in rolling direction, D_x sin(theta) + D_y cos(theta) [m s-2]."""
    return in_plane_drive_x * sine(axis_yaw) + in_plane_drive_y * cosine(axis_yaw)


def push_along_axis(*, in_plane_drive_x: Array, in_plane_drive_y: Array, axis_yaw: Array) -> Array:
    """Return drive and gravity along the axis, D_x cos(theta) - D_y sin(theta) [m s-2]."""
    return in_plane_drive_x * cosine(axis_yaw) - in_plane_drive_y * sine(axis_yaw)


def roller_friction(
    *, push_across_axis: Array, push_along_axis: Array, rolling_factor: Array,
    floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the least static friction with which a roller rolls, hypot(D_s, D_e/(1+kap))/n [1].

    D_s and D_e are the push along and across the axis, n the floor's force, all per mass; infinite
    in flight.
    """
    needed = hypot(push_along_axis, push_across_axis / (1 + rolling_factor))
    return over_load(needed, floor_acceleration, np.inf)


def roller_root(
    *, push_across_axis: Array, push_along_axis: Array, rolling_factor: Array,
    friction_static: Array, friction_kinetic: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the root z of D_s^2/(z+q)^2 + D_e^2/(z+(1+kap)q)^2 = 1, q = mu_k n [m s-2].

    D_s and D_e are the push along and across the axis, n the floor's force, all per mass, kap = m
    r^2/I (theory 18.1).
    """
    return rolling.slip_root(
        push_along_axis, push_across_axis, rolling_factor, friction_static, friction_kinetic,
        floor_acceleration,
    )  # fmt: skip


def axial_acceleration(
    *, push_along_axis: Array, roll_root: Array, friction_kinetic: Array, floor_acceleration: Array
) -> Array:
    """Return the acceleration of a roller along its axis, D_s z/(z + q) [m s-2].

    D_s is the push along the axis, q = mu_k n; 0 where it rolls.
    """
    q = friction_kinetic * floor_acceleration
    return push_along_axis * ratio(roll_root, roll_root + q, 0.0)


def rolling_acceleration(
    *, push_across_axis: Array, roll_root: Array, rolling_factor: Array, rolling_share: Array,
    friction_kinetic: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration across a roller's axis, D_e (z + kap q)/(z + (1 + kap) q) [m s-2].

    D_e is the push across the axis, q = mu_k n. Where it rolls (z = 0) it is D_e kap/(1 + kap).
    """
    return rolling.across_axis(
        push_across_axis, roll_root, rolling_factor, rolling_share, friction_kinetic,
        floor_acceleration,
    )  # fmt: skip


def roller_x(*, rolling_acceleration: Array, axial_acceleration: Array, axis_yaw: Array) -> Array:
    """Return the acceleration along x, a_e sin(theta) + a_s cos(theta) [m s-2].

    a_e and a_s are those across and along the part's axis.
    """
    return rolling_acceleration * sine(axis_yaw) + axial_acceleration * cosine(axis_yaw)


def roller_y(*, rolling_acceleration: Array, axial_acceleration: Array, axis_yaw: Array) -> Array:
    """Return the acceleration along y, a_e cos(theta) - a_s sin(theta) [m s-2].

    a_e and a_s are those across and along the part's axis.
    """
    return rolling_acceleration * cosine(axis_yaw) - axial_acceleration * sine(axis_yaw)


def roller_spin(
    *, push_across_axis: Array, roll_root: Array, rolling_factor: Array, rolling_share: Array,
    friction_kinetic: Array, floor_acceleration: Array, diameter: Array,
) -> Array:  # fmt: skip
    """Return the angular acceleration of a roller about its axis, a_e/r where it rolls [rad s-2].

    kap q D_e/((z + (1 + kap) q) r) where it slips, q = mu_k n, z `roll_root`; 0 in flight (theory
    18.1).
    """
    q = friction_kinetic * floor_acceleration
    slipping = (
        rolling_factor * q * ratio(push_across_axis, roll_root + (1 + rolling_factor) * q, 0.0)
    )
    rim_acceleration = np.where(roll_root == 0, rolling_share * push_across_axis, slipping)
    return rim_acceleration / (diameter / 2)


# --- a truncated cone on its side: rolls about the vertical through its apex


def cone_half_angle(*, diameter: Array, small_diameter: Array, height: Array) -> Array:
    """Return the half angle of a cone with radii R1, R2 and height H, atan((R1 - R2)/H) [rad]."""
    return np.arctan2((diameter - small_diameter) / 2, height)


def centre_radius(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array
) -> Array:
    """Return the radius of a truncated cone at its centre of mass, R1 - z_c (R1 - R2)/H [m].

    R1 and R2 are the radii of its ends, z_c the height of the centre above the end of R1.
    """
    return (diameter - (diameter - small_diameter) * (mass_height / height)) / 2


def axial_gyration(*, diameter: Array, small_diameter: Array) -> Array:
    """Return the radius of gyration of a truncated cone about its axis [m].

    k^2 = 3 R1^2 (1 + r + r^2 + r^3 + r^4)/(10 (1 + r + r^2)), r = R2/R1 of the radii of its ends.
    """
    r = small_diameter / diameter
    radius_factor = 3 * (1 + r * (1 + r * (1 + r * (1 + r)))) / (10 * (1 + r * (1 + r)))
    return diameter / 2 * np.sqrt(radius_factor)


def cone_factor(
    *, centre_radius: Array, axial_gyration: Array, gyration: Array, cone_half_angle: Array
) -> Array:
    """Return the share of a push that accelerates a rolling cone, F = (l sin a)^2/I_g [1].

    l is the distance of the centre of mass from the apex, a the half angle, I_g the moment of
    inertia per mass about the line on which the cone touches. With rho = l tan(a) it is
    rho^2/(rho^2 + I_ax + I_t tan(a)^2), I_ax along the axis, I_t across it. 2/3 for a solid
    cylinder.
    """
    contact_gyration = hypot(axial_gyration, gyration * np.tan(cone_half_angle))
    contact_radius = hypot(centre_radius, contact_gyration)
    return np.square(centre_radius / contact_radius)


def cone_acceleration(*, push_across_axis: Array, cone_factor: Array) -> Array:
    """Return the acceleration of a rolling cone's centre, F D_t [m s-2]."""
    return cone_factor * push_across_axis


def cone_turning(
    *, rolling_acceleration: Array, centre_radius: Array, cone_half_angle: Array
) -> Array:
    """Return the turning about the vertical through a cone's apex, a_t/(l cos a) [rad s-2].

    l is the distance of the centre from the apex, a the half angle; 0 for a cylinder, whose apex is
    far.
    """
    scaled_radius = centre_radius * cosine(cone_half_angle)  # l cos(a) = rho cos(a)/tan(a)
    return rolling_acceleration * np.tan(cone_half_angle) / scaled_radius


def cone_friction(
    *, push_across_axis: Array, push_along_axis: Array, cone_factor: Array,
    floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the least static friction with which a cone rolls, hypot(D_g, (1 - F) D_t)/n [1].

    D_g and D_t are the push along and across the line on which it touches, F `cone_factor`. It is
    that of the floor's resultant; infinite in flight.
    """
    needed = hypot(push_along_axis, push_across_axis * (1 - cone_factor))
    return over_load(needed, floor_acceleration, np.inf)


# --- A disc, coin or ring on its edge, its face against the wall of a track (theory 18.1).
#
# It rolls along x, kap = m r^2/I, and its face slides on the wall: the wall's force s presses
# through the centre, and its friction mu_w s acts there. Axes of the wrenches: n upwards, eta along
# x, sigma across, off the wall. All functions take and return broadcastable float64 arrays, SI
# units.


def net_push(*, in_plane_drive_x: Array, wall_friction: Array, wall_acceleration: Array) -> Array:
    """Return the drive along x less the wall's friction, sgn(D) max(0, |D| - mu_w s) [m s-2].

    D is drive and gravity along x, s the wall's force, both per mass, mu_w the wall's friction. 0
    where that holds the disc.
    """
    excess = np.maximum(np.abs(in_plane_drive_x) - wall_friction * wall_acceleration, 0.0)
    return np.where(in_plane_drive_x < 0, -excess, excess)


def is_held(*, net_push: Array) -> Mask:
    """True where the friction of the wall holds the disc."""
    return net_push == 0


def disc_acceleration(
    *, net_push: Array, required_friction: Array, friction_static: Array, friction_kinetic: Array,
    rolling_share: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration along x, kap/(1 + kap) of the net push if the disc rolls [m s-2].

    Where the edge slips on the floor, it is the net push less mu_k n in size.
    """
    slipping = np.maximum(np.abs(net_push) - friction_kinetic * floor_acceleration, 0.0)
    slipping = np.where(net_push < 0, -slipping, slipping)
    return np.where(required_friction <= friction_static, rolling_share * net_push, slipping)


def disc_floor_friction(
    *, mass: Array, net_push: Array, required_friction: Array, friction_static: Array,
    friction_kinetic: Array, rolling_factor: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the friction force of the floor that turns a disc on its edge, positive along -x [N].

    m (D - w)/(1 + kap) where it rolls, else mu_k m n, at most the push itself.
    """
    slipping = np.minimum(np.abs(net_push), friction_kinetic * floor_acceleration)
    slipping = np.where(net_push < 0, -slipping, slipping)
    rolling = net_push / (1 + rolling_factor)
    return mass * np.where(required_friction <= friction_static, rolling, slipping)


def disc_spin(
    *, rolling_friction: Array, mass: Array, rolling_factor: Array, diameter: Array
) -> Array:
    """Return the angular acceleration of the disc about its axis, kap F/(m r) [rad s-2]."""
    return rolling_factor * rolling_friction / (mass * diameter / 2)


def wall_drag(
    *, mass: Array, in_plane_drive_x: Array, wall_friction: Array, wall_acceleration: Array
) -> Array:
    """Return the wall's friction force on the disc, positive along -x [N].

    m mu_w s against the drive D, or m D where friction holds the disc.
    """
    held = np.minimum(np.abs(in_plane_drive_x), wall_friction * wall_acceleration)
    return mass * np.where(in_plane_drive_x < 0, -held, held)


def disc_floor_wrench(*, floor_force: Array, rolling_friction: Array, diameter: Array) -> Wrench:
    """Return the wrench of the floor about the disc's centre [N, N m].

    In the axes n (up), eta (along x), sigma (off the wall): the force (N, -F, 0) of floor force and
    friction, and the moment r F about sigma.
    """
    zero = np.zeros(())
    force = vector(floor_force, -rolling_friction, zero)
    return Wrench(force, vector(zero, zero, diameter / 2 * rolling_friction))


def disc_force_wrench(
    *, mass: Array, acceleration_x: Array, rolling_friction: Array, diameter: Array
) -> Wrench:
    """Return the wrench of drive, gravity, floor and wall about the disc's centre [N, N m].

    In the axes of `disc_floor_wrench`: the force m a along eta and the moment r F about sigma.
    """
    zero = np.zeros(())
    force = vector(zero, mass * acceleration_x, zero)
    return Wrench(force, vector(zero, zero, diameter / 2 * rolling_friction))
