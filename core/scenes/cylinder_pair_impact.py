"""Impact of two cylindrical parts; section 3.3.4 of the source.

The variants are laws of impact, as for rectangles: `frictionless`, the default, needs no friction
coefficient; `pfeiffer_glocker` is the law to take with friction, `moreau` is there to compare. What
the source prints, (3.44), drives the bodies into each other and is not offered (theory 8.3).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.mechanics import impact, vectors
from core.mechanics.arrays import Array, Mask
from core.mechanics.cylinder_contact import Cylinder, CylinderContact, cylinder_contact
from core.mechanics.impact import SpatialDelassus, SpatialImpulse
from core.mechanics.vectors import Vector, cross, dot, minus, plus, scaled
from core.scenes.pair_impact import only_in_impact
from core.scenes.scene import Condition, Equation, Scene


class Masses(NamedTuple):
    """Mass, moment of inertia about the own axis and across it, of both bodies."""

    mass_1: Array
    axial_1: Array
    across_1: Array
    mass_2: Array
    axial_2: Array
    across_2: Array


class SpatialMotion(NamedTuple):
    """Velocities of the centres and angular velocities."""

    velocity_1: Vector
    spin_1: Vector
    velocity_2: Vector
    spin_2: Vector


class Frame(NamedTuple):
    """Contact point, normal and two tangents; `unknown` marks lines that the law does not solve."""

    point: Vector
    normal: Vector
    tangent_1: Vector
    tangent_2: Vector
    unknown: Mask


class Approach(NamedTuple):
    """Velocity of body 1 relative to body 2 at the contact."""

    normal: Array
    tangential: tuple[Array, Array]


# --- the bodies


def cylinder_1(
    *,
    position_x_1: Array,
    position_y_1: Array,
    position_z_1: Array,
    azimuth_1: Array,
    elevation_1: Array,
    diameter_1: Array,
    length_1: Array,
) -> Cylinder:
    """Return the place and shape of body 1; its axis is (ce ca, ce sa, se)."""
    flat = np.cos(elevation_1)
    axis = flat * np.cos(azimuth_1), flat * np.sin(azimuth_1), np.sin(elevation_1)
    centre = position_x_1, position_y_1, position_z_1
    return Cylinder(centre, axis, diameter_1 / 2, length_1 / 2)


def cylinder_2(
    *,
    position_x_2: Array,
    position_y_2: Array,
    position_z_2: Array,
    azimuth_2: Array,
    elevation_2: Array,
    diameter_2: Array,
    length_2: Array,
) -> Cylinder:
    """Return the place and shape of body 2; its axis is (ce ca, ce sa, se)."""
    flat = np.cos(elevation_2)
    axis = flat * np.cos(azimuth_2), flat * np.sin(azimuth_2), np.sin(elevation_2)
    centre = position_x_2, position_y_2, position_z_2
    return Cylinder(centre, axis, diameter_2 / 2, length_2 / 2)


def cylinder_masses(
    *,
    mass_1: Array,
    diameter_1: Array,
    length_1: Array,
    mass_2: Array,
    diameter_2: Array,
    length_2: Array,
) -> Masses:
    """Return m, I_a = m d^2/8 and I_t = m (3/4 d^2 + h^2)/12 of both bodies."""
    square_1, square_2 = diameter_1 * diameter_1, diameter_2 * diameter_2
    return Masses(
        mass_1,
        mass_1 * square_1 / 8,
        mass_1 * (0.75 * square_1 + length_1 * length_1) / 12,
        mass_2,
        mass_2 * square_2 / 8,
        mass_2 * (0.75 * square_2 + length_2 * length_2) / 12,
    )


def spatial_motion(
    *,
    velocity_x_1: Array,
    velocity_y_1: Array,
    velocity_z_1: Array,
    spin_x_1: Array,
    spin_y_1: Array,
    spin_z_1: Array,
    velocity_x_2: Array,
    velocity_y_2: Array,
    velocity_z_2: Array,
    spin_x_2: Array,
    spin_y_2: Array,
    spin_z_2: Array,
) -> SpatialMotion:
    """Return the velocities before the impact."""
    return SpatialMotion(
        (velocity_x_1, velocity_y_1, velocity_z_1),
        (spin_x_1, spin_y_1, spin_z_1),
        (velocity_x_2, velocity_y_2, velocity_z_2),
        (spin_x_2, spin_y_2, spin_z_2),
    )


def _at(point: Vector, one: Cylinder, two: Cylinder, motion: SpatialMotion) -> Vector:
    """Return the velocity of body 1 relative to body 2 at a point."""
    of_1 = plus(motion.velocity_1, cross(motion.spin_1, minus(point, one.centre)))
    of_2 = plus(motion.velocity_2, cross(motion.spin_2, minus(point, two.centre)))
    return minus(of_1, of_2)


def _turned(moment: Vector, body: Cylinder, axial: Array, transverse: Array) -> Vector:
    """Return J^-1 of a moment: M/I_t + u (u.M)(1/I_a - 1/I_t)."""
    along = dot(moment, body.axis) * (1 / axial - 1 / transverse)
    return plus(scaled(moment, 1 / transverse), body.axis, along)


def _delassus(
    at: Vector, e: Vector, other_at: Vector, other_e: Vector, one: Cylinder, two: Cylinder,
    masses: Masses,
) -> Array:  # fmt: skip
    """Return the velocity at one point along e that a unit impulse at another along e' gives."""
    total = (1 / masses.mass_1 + 1 / masses.mass_2) * dot(e, other_e)
    for body, axial, transverse in (
        (one, masses.axial_1, masses.across_1),
        (two, masses.axial_2, masses.across_2),
    ):
        arm = cross(minus(at, body.centre), e)
        other = cross(minus(other_at, body.centre), other_e)
        total = total + dot(arm, _turned(other, body, axial, transverse))
    return total


def _frame(contact: CylinderContact, share: Array, unknown: Mask) -> Frame:
    n = contact.normal
    tangent = vectors.any_across(n)
    point = plus(contact.first, minus(contact.second, contact.first), share)
    return Frame(point, n, tangent, cross(n, tangent), contact.line & unknown)


def frame_without_friction(
    *,
    cylinder_contact: CylinderContact,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    cylinder_masses: Masses,
    spatial_motion: SpatialMotion,
    restitution: Array,
) -> Frame:
    """Return the contact point, on a line where the resultant of both ends acts."""
    at, one, two, masses = cylinder_contact, cylinder_1, cylinder_2, cylinder_masses
    n, first, second = at.normal, at.first, at.second
    u_1 = dot(n, _at(first, one, two, spatial_motion))
    u_2 = dot(n, _at(second, one, two, spatial_motion))
    both = impact.on_edge(
        G_11=_delassus(first, n, first, n, one, two, masses),
        G_12=_delassus(first, n, second, n, one, two, masses),
        G_22=_delassus(second, n, second, n, one, two, masses),
        u_1=u_1,
        u_2=u_2,
        restitution=restitution,
    )
    total = both.first + both.second
    idle = np.where(u_2 < u_1, 1.0, 0.0)
    share = np.where(total > 0, both.second / np.where(total > 0, total, 1.0), idle)
    return _frame(at, share, both.again)


def frame_with_friction(
    *,
    cylinder_contact: CylinderContact,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
) -> Frame:
    """Return the contact point, on a line the end that approaches most; its impact is not solved.

    If that end does not approach, the line does not; else the impact is `simultaneous`.
    """
    at, one, two = cylinder_contact, cylinder_1, cylinder_2
    u_1 = dot(at.normal, _at(at.first, one, two, spatial_motion))
    u_2 = dot(at.normal, _at(at.second, one, two, spatial_motion))
    return _frame(at, np.where(u_2 < u_1, 1.0, 0.0), np.minimum(u_1, u_2) < 0)


def spatial_delassus(
    *, contact_frame: Frame, cylinder_1: Cylinder, cylinder_2: Cylinder, cylinder_masses: Masses
) -> SpatialDelassus:
    """Return the Delassus numbers of the contact point."""
    p, n, t, s = contact_frame[:4]
    given = (cylinder_1, cylinder_2, cylinder_masses)
    return SpatialDelassus(
        _delassus(p, n, p, n, *given),
        _delassus(p, n, p, t, *given),
        _delassus(p, n, p, s, *given),
        _delassus(p, t, p, t, *given),
        _delassus(p, t, p, s, *given),
        _delassus(p, s, p, s, *given),
    )


def _approach(at: Frame, one: Cylinder, two: Cylinder, motion: SpatialMotion) -> Approach:
    u = _at(at.point, one, two, motion)
    return Approach(dot(at.normal, u), (dot(at.tangent_1, u), dot(at.tangent_2, u)))


def spatial_approach(
    *,
    contact_frame: Frame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
) -> Approach:
    """Return the velocity of the contact before the impact."""
    return _approach(contact_frame, cylinder_1, cylinder_2, spatial_motion)


# --- where there is an impact


def is_apart(*, cylinder_contact: CylinderContact, contact_tolerance: Array) -> Mask:
    """Return where the gap exceeds the tolerance, or its lower bound does."""
    return (
        cylinder_contact.gap
        > np.where(cylinder_contact.form == 0, 0.0, contact_tolerance) * cylinder_contact.size
    )


def overlaps(*, cylinder_contact: CylinderContact, contact_tolerance: Array) -> Mask:
    """Return where a form of contact is proven and overlaps by more than the tolerance."""
    at = cylinder_contact
    return (at.form > 0) & (at.gap < -contact_tolerance * at.size)


def is_no_single_point(*, cylinder_contact: CylinderContact) -> Mask:
    """Return where faces or rims meet, or none of the five forms is proven."""
    return cylinder_contact.several


def is_line(*, contact_frame: Frame, spatial_impulse: SpatialImpulse) -> Mask:
    """Return where a line meets and no single impulse tells the result, or the law has none."""
    return contact_frame.unknown | np.isnan(spatial_impulse.normal)


def does_not_approach(*, spatial_approach: Approach) -> Mask:
    """Return where the bodies separate or slide past each other, u_N >= 0."""
    return spatial_approach.normal >= 0


def ends_in_stick(*, spatial_impulse: SpatialImpulse) -> Mask:
    """Return where the contact does not slide at the end of the impact."""
    return spatial_impulse.sticks


def _masked(
    impulse: SpatialImpulse, at: CylinderContact, tolerance: Array, frame: Frame
) -> SpatialImpulse:
    nothing = is_apart(cylinder_contact=at, contact_tolerance=tolerance)
    unknown = overlaps(cylinder_contact=at, contact_tolerance=tolerance)
    unknown = unknown | ((at.several | frame.unknown) & ~nothing)
    return SpatialImpulse(
        only_in_impact(impulse.normal, nothing, unknown),
        (
            only_in_impact(impulse.tangential[0], nothing, unknown),
            only_in_impact(impulse.tangential[1], nothing, unknown),
        ),
        impulse.sticks,
    )


def frictionless_impulse(
    *,
    cylinder_contact: CylinderContact,
    contact_tolerance: Array,
    contact_frame: Frame,
    delassus_normal: Array,
    approach_normal: Array,
    restitution: Array,
) -> SpatialImpulse:
    """Return Newton's impulse without friction; NaN where the bodies overlap or the law is mute."""
    normal = impact.frictionless(G_NN=delassus_normal, u_N=approach_normal, restitution=restitution)
    none = np.zeros_like(normal)
    impulse = SpatialImpulse(normal, (none, none), np.zeros(normal.shape, dtype=np.bool_))
    return _masked(impulse, cylinder_contact, contact_tolerance, contact_frame)


def pfeiffer_glocker_impulse(
    *,
    cylinder_contact: CylinderContact,
    contact_tolerance: Array,
    contact_frame: Frame,
    spatial_delassus: SpatialDelassus,
    spatial_approach: Approach,
    friction: Array,
    restitution: Array,
) -> SpatialImpulse:
    """Return the impulse of compression and expansion with friction, Poisson's restitution."""
    impulse = impact.pfeiffer_glocker_in_space(
        G=spatial_delassus,
        u_N=spatial_approach.normal,
        u=spatial_approach.tangential,
        friction=friction,
        restitution=restitution,
    )
    return _masked(impulse, cylinder_contact, contact_tolerance, contact_frame)


def moreau_impulse(
    *,
    cylinder_contact: CylinderContact,
    contact_tolerance: Array,
    contact_frame: Frame,
    spatial_delassus: SpatialDelassus,
    spatial_approach: Approach,
    friction: Array,
    restitution: Array,
) -> SpatialImpulse:
    """Return Moreau's impulse with friction, one restitution for all directions."""
    impulse = impact.moreau_in_space(
        G=spatial_delassus,
        u_N=spatial_approach.normal,
        u=spatial_approach.tangential,
        friction=friction,
        restitution=restitution,
    )
    return _masked(impulse, cylinder_contact, contact_tolerance, contact_frame)


# --- after the impact


def _in_space(impulse: SpatialImpulse, at: Frame) -> Vector:
    L_1, L_2 = impulse.tangential
    normal = scaled(at.normal, impulse.normal)
    return plus(plus(normal, at.tangent_1, L_1), at.tangent_2, L_2)


def spatial_motion_after(
    *,
    spatial_impulse: SpatialImpulse,
    contact_frame: Frame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    cylinder_masses: Masses,
    spatial_motion: SpatialMotion,
) -> SpatialMotion:
    """Return all velocities after the impulse: v + L/m, w + J^-1 (rho x L), less for body 2."""
    before, masses, p = spatial_motion, cylinder_masses, contact_frame.point
    L = _in_space(spatial_impulse, contact_frame)
    moment_1 = cross(minus(p, cylinder_1.centre), L)
    moment_2 = cross(minus(p, cylinder_2.centre), L)
    return SpatialMotion(
        plus(before.velocity_1, L, 1 / masses.mass_1),
        plus(before.spin_1, _turned(moment_1, cylinder_1, masses.axial_1, masses.across_1)),
        plus(before.velocity_2, L, -1 / masses.mass_2),
        plus(before.spin_2, _turned(moment_2, cylinder_2, masses.axial_2, masses.across_2), -1.0),
    )


def _inertial(vector: Vector, body: Cylinder, axial: Array, transverse: Array) -> Vector:
    """Return J of an angular velocity."""
    return plus(
        scaled(vector, transverse), body.axis, dot(vector, body.axis) * (axial - transverse)
    )


def _turning(
    one: Cylinder, two: Cylinder, before: SpatialMotion, after: SpatialMotion, masses: Masses
) -> Vector:
    change_1, change_2 = minus(after.spin_1, before.spin_1), minus(after.spin_2, before.spin_2)
    own_1 = _inertial(change_1, one, masses.axial_1, masses.across_1)
    own_2 = _inertial(change_2, two, masses.axial_2, masses.across_2)
    orbit_1 = cross(one.centre, minus(after.velocity_1, before.velocity_1))
    orbit_2 = cross(two.centre, minus(after.velocity_2, before.velocity_2))
    of_1, of_2 = plus(own_1, orbit_1, masses.mass_1), plus(own_2, orbit_2, masses.mass_2)
    return plus(of_1, of_2)


def impulse_friction(*, spatial_impulse: SpatialImpulse) -> Array:
    """Return the magnitude of the tangential impulse [N s]."""
    return np.hypot(*spatial_impulse.tangential)


def sliding_before(*, spatial_approach: Approach) -> Array:
    """Return the speed of sliding before the impact [m s-1]."""
    return np.hypot(*spatial_approach.tangential)


def separation_normal(
    *,
    contact_frame: Frame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return u_N of the velocities after the impact [m s-1]."""
    return _approach(contact_frame, cylinder_1, cylinder_2, spatial_motion_after).normal


def sliding_after(
    *,
    contact_frame: Frame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return the speed of sliding after the impact [m s-1]."""
    after = _approach(contact_frame, cylinder_1, cylinder_2, spatial_motion_after)
    return np.hypot(*after.tangential)


def energy_before(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    cylinder_masses: Masses,
    spatial_motion: SpatialMotion,
) -> Array:
    """Return the kinetic energy of both bodies before the impact [J]."""
    motion, masses = spatial_motion, cylinder_masses
    turning_1 = _inertial(motion.spin_1, cylinder_1, masses.axial_1, masses.across_1)
    turning_2 = _inertial(motion.spin_2, cylinder_2, masses.axial_2, masses.across_2)
    return (
        masses.mass_1 * dot(motion.velocity_1, motion.velocity_1)
        + dot(motion.spin_1, turning_1)
        + masses.mass_2 * dot(motion.velocity_2, motion.velocity_2)
        + dot(motion.spin_2, turning_2)
    ) / 2


def energy_lost(
    *,
    spatial_impulse: SpatialImpulse,
    contact_frame: Frame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return T_A - T_E as the work -L.(u + u')/2 of the impulse, free of cancellation [J]."""
    at, L = contact_frame, spatial_impulse
    before = _approach(at, cylinder_1, cylinder_2, spatial_motion)
    after = _approach(at, cylinder_1, cylinder_2, spatial_motion_after)
    work = L.normal * (before.normal + after.normal)
    for impulse, u, u_after in zip(L.tangential, before.tangential, after.tangential, strict=True):
        work = work + impulse * (u + u_after)
    return -work / 2


def gap(*, cylinder_contact: CylinderContact) -> Array:
    """Return the gap, or a lower bound of it where no form of contact is proven [m]."""
    return cylinder_contact.gap


def contact_form(*, cylinder_contact: CylinderContact) -> Array:
    """Return the form of contact, 1 to 5, or 0."""
    return cylinder_contact.form


def face_body(*, cylinder_contact: CylinderContact) -> Array:
    """Return the body whose face or side is met, 1 or 2; 0 if it is both."""
    return cylinder_contact.face_body


def normal_x(*, cylinder_contact: CylinderContact) -> Array:
    """Return n_x, the normal pointing from body 2 to body 1."""
    return cylinder_contact.normal[0]


def normal_y(*, cylinder_contact: CylinderContact) -> Array:
    """Return n_y, the normal pointing from body 2 to body 1."""
    return cylinder_contact.normal[1]


def normal_z(*, cylinder_contact: CylinderContact) -> Array:
    """Return n_z, the normal pointing from body 2 to body 1."""
    return cylinder_contact.normal[2]


def contact_x(*, contact_frame: Frame) -> Array:
    """Return the point where the impulse acts, x [m]."""
    return contact_frame.point[0]


def contact_y(*, contact_frame: Frame) -> Array:
    """Return the point where the impulse acts, y [m]."""
    return contact_frame.point[1]


def contact_z(*, contact_frame: Frame) -> Array:
    """Return the point where the impulse acts, z [m]."""
    return contact_frame.point[2]


def delassus_normal(*, spatial_delassus: SpatialDelassus) -> Array:
    """Return G_NN = 1/m1 + 1/m2 + (rho1 x n).J1^-1 (rho1 x n) + the like of body 2 [kg-1]."""
    return spatial_delassus.NN


def approach_normal(*, spatial_approach: Approach) -> Array:
    """Return u_N = n.(v1 + w1 x rho1 - v2 - w2 x rho2) [m s-1]."""
    return spatial_approach.normal


def impulse_normal(*, spatial_impulse: SpatialImpulse) -> Array:
    """Return the normal impulse on body 1 [N s]."""
    return spatial_impulse.normal


def velocity_x_1_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the velocity of body 1 after the impact, x [m s-1]."""
    return spatial_motion_after.velocity_1[0]


def velocity_y_1_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the velocity of body 1 after the impact, y [m s-1]."""
    return spatial_motion_after.velocity_1[1]


def velocity_z_1_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the velocity of body 1 after the impact, z [m s-1]."""
    return spatial_motion_after.velocity_1[2]


def spin_x_1_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the angular velocity of body 1 after the impact, x [rad s-1]."""
    return spatial_motion_after.spin_1[0]


def spin_y_1_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the angular velocity of body 1 after the impact, y [rad s-1]."""
    return spatial_motion_after.spin_1[1]


def spin_z_1_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the angular velocity of body 1 after the impact, z [rad s-1]."""
    return spatial_motion_after.spin_1[2]


def velocity_x_2_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the velocity of body 2 after the impact, x [m s-1]."""
    return spatial_motion_after.velocity_2[0]


def velocity_y_2_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the velocity of body 2 after the impact, y [m s-1]."""
    return spatial_motion_after.velocity_2[1]


def velocity_z_2_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the velocity of body 2 after the impact, z [m s-1]."""
    return spatial_motion_after.velocity_2[2]


def spin_x_2_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the angular velocity of body 2 after the impact, x [rad s-1]."""
    return spatial_motion_after.spin_2[0]


def spin_y_2_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the angular velocity of body 2 after the impact, y [rad s-1]."""
    return spatial_motion_after.spin_2[1]


def spin_z_2_after(*, spatial_motion_after: SpatialMotion) -> Array:
    """Return the angular velocity of body 2 after the impact, z [rad s-1]."""
    return spatial_motion_after.spin_2[2]


def impulse_x(*, spatial_impulse: SpatialImpulse, contact_frame: Frame) -> Array:
    """Return the impulse on body 1, x [N s]."""
    return _in_space(spatial_impulse, contact_frame)[0]


def impulse_y(*, spatial_impulse: SpatialImpulse, contact_frame: Frame) -> Array:
    """Return the impulse on body 1, y [N s]."""
    return _in_space(spatial_impulse, contact_frame)[1]


def impulse_z(*, spatial_impulse: SpatialImpulse, contact_frame: Frame) -> Array:
    """Return the impulse on body 1, z [N s]."""
    return _in_space(spatial_impulse, contact_frame)[2]


def momentum_residual_x(
    *, spatial_motion: SpatialMotion, spatial_motion_after: SpatialMotion, cylinder_masses: Masses
) -> Array:
    """Return what the velocities after the impact add to the linear momentum, x [N s]."""
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1 = after.velocity_1[0] - before.velocity_1[0]
    change_2 = after.velocity_2[0] - before.velocity_2[0]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def momentum_residual_y(
    *, spatial_motion: SpatialMotion, spatial_motion_after: SpatialMotion, cylinder_masses: Masses
) -> Array:
    """Return what the velocities after the impact add to the linear momentum, y [N s]."""
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1 = after.velocity_1[1] - before.velocity_1[1]
    change_2 = after.velocity_2[1] - before.velocity_2[1]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def momentum_residual_z(
    *, spatial_motion: SpatialMotion, spatial_motion_after: SpatialMotion, cylinder_masses: Masses
) -> Array:
    """Return what the velocities after the impact add to the linear momentum, z [N s]."""
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1 = after.velocity_1[2] - before.velocity_1[2]
    change_2 = after.velocity_2[2] - before.velocity_2[2]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def angular_momentum_residual_x(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: Masses,
) -> Array:
    """Return what the impact adds to the angular momentum about the origin, x [kg m2 s-1]."""
    return _turning(cylinder_1, cylinder_2, spatial_motion, spatial_motion_after, cylinder_masses)[
        0
    ]


def angular_momentum_residual_y(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: Masses,
) -> Array:
    """Return what the impact adds to the angular momentum about the origin, y [kg m2 s-1]."""
    return _turning(cylinder_1, cylinder_2, spatial_motion, spatial_motion_after, cylinder_masses)[
        1
    ]


def angular_momentum_residual_z(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: Masses,
) -> Array:
    """Return what the impact adds to the angular momentum about the origin, z [kg m2 s-1]."""
    return _turning(cylinder_1, cylinder_2, spatial_motion, spatial_motion_after, cylinder_masses)[
        2
    ]


PLACE = (
    Equation("cylinder_1", cylinder_1, "theory 8.1"),
    Equation("cylinder_2", cylinder_2, "theory 8.1"),
    Equation("cylinder_masses", cylinder_masses, "theory 8.1"),
    Equation("spatial_motion", spatial_motion, "theory 8.1"),
    Equation("cylinder_contact", cylinder_contact, "theory 8.2"),
    Equation("gap", gap, "theory 8.2"),
    Equation("contact_form", contact_form, "theory 8.2"),
    Equation("face_body", face_body, "theory 8.2"),
    Equation("normal_x", normal_x, "theory 8.2"),
    Equation("normal_y", normal_y, "theory 8.2"),
    Equation("normal_z", normal_z, "theory 8.2"),
)
REST = (
    Equation("contact_x", contact_x, "theory 8.1"),
    Equation("contact_y", contact_y, "theory 8.1"),
    Equation("contact_z", contact_z, "theory 8.1"),
    Equation("spatial_delassus", spatial_delassus, "theory 8.1"),
    Equation("delassus_normal", delassus_normal, "theory 8.1"),
    Equation("spatial_approach", spatial_approach, "theory 8.1"),
    Equation("approach_normal", approach_normal, "theory 8.1"),
    Equation("sliding_before", sliding_before, "theory 8.1"),
    Equation("impulse_normal", impulse_normal, "theory 8.1"),
    Equation("impulse_friction", impulse_friction, "theory 8.1"),
    Equation("impulse_x", impulse_x, "theory 8.1"),
    Equation("impulse_y", impulse_y, "theory 8.1"),
    Equation("impulse_z", impulse_z, "theory 8.1"),
    Equation("spatial_motion_after", spatial_motion_after, "theory 8.1"),
    Equation("velocity_x_1_after", velocity_x_1_after, "theory 8.1"),
    Equation("velocity_y_1_after", velocity_y_1_after, "theory 8.1"),
    Equation("velocity_z_1_after", velocity_z_1_after, "theory 8.1"),
    Equation("spin_x_1_after", spin_x_1_after, "theory 8.1"),
    Equation("spin_y_1_after", spin_y_1_after, "theory 8.1"),
    Equation("spin_z_1_after", spin_z_1_after, "theory 8.1"),
    Equation("velocity_x_2_after", velocity_x_2_after, "theory 8.1"),
    Equation("velocity_y_2_after", velocity_y_2_after, "theory 8.1"),
    Equation("velocity_z_2_after", velocity_z_2_after, "theory 8.1"),
    Equation("spin_x_2_after", spin_x_2_after, "theory 8.1"),
    Equation("spin_y_2_after", spin_y_2_after, "theory 8.1"),
    Equation("spin_z_2_after", spin_z_2_after, "theory 8.1"),
    Equation("separation_normal", separation_normal, "theory 8.1"),
    Equation("sliding_after", sliding_after, "theory 8.1"),
    Equation("energy_before", energy_before, "theory 8.1"),
    Equation("energy_lost", energy_lost, "theory 8.1"),
    Equation("momentum_residual_x", momentum_residual_x, "theory 8.1"),
    Equation("momentum_residual_y", momentum_residual_y, "theory 8.1"),
    Equation("momentum_residual_z", momentum_residual_z, "theory 8.1"),
    Equation("angular_momentum_residual_x", angular_momentum_residual_x, "theory 8.1"),
    Equation("angular_momentum_residual_y", angular_momentum_residual_y, "theory 8.1"),
    Equation("angular_momentum_residual_z", angular_momentum_residual_z, "theory 8.1"),
)
FRICTIONLESS = (
    *PLACE,
    Equation("contact_frame", frame_without_friction, "theory 1.4, theory 8.2", "frictionless"),
    Equation("spatial_impulse", frictionless_impulse, "theory 8.1", "frictionless"),
    *REST,
)
PFEIFFER_GLOCKER = (
    *PLACE,
    Equation("contact_frame", frame_with_friction, "theory 8.2"),
    Equation("spatial_impulse", pfeiffer_glocker_impulse, "theory 8.1", "pfeiffer_glocker"),
    *REST,
)
MOREAU = (
    *PLACE,
    Equation("contact_frame", frame_with_friction, "theory 8.2"),
    Equation("spatial_impulse", moreau_impulse, "theory 8.1", "moreau"),
    *REST,
)

WHERE = frozenset(("gap", "contact_form", "face_body", "normal_x", "normal_y", "normal_z"))
BEFORE = frozenset(
    (
        "contact_x",
        "contact_y",
        "contact_z",
        "delassus_normal",
        "approach_normal",
        "sliding_before",
    )
)
AFTER = frozenset(
    (
        "impulse_normal",
        "impulse_friction",
        "impulse_x",
        "impulse_y",
        "impulse_z",
        "velocity_x_1_after",
        "velocity_y_1_after",
        "velocity_z_1_after",
        "spin_x_1_after",
        "spin_y_1_after",
        "spin_z_1_after",
        "velocity_x_2_after",
        "velocity_y_2_after",
        "velocity_z_2_after",
        "spin_x_2_after",
        "spin_y_2_after",
        "spin_z_2_after",
        "separation_normal",
        "sliding_after",
        "energy_lost",
        "momentum_residual_x",
        "momentum_residual_y",
        "momentum_residual_z",
        "angular_momentum_residual_x",
        "angular_momentum_residual_y",
        "angular_momentum_residual_z",
        "regime",
    )
)
CONDITIONS = (
    Condition("apart", is_apart, WHERE | BEFORE | AFTER, otherwise="contact"),
    Condition("overlap", overlaps, WHERE | BEFORE | AFTER),
    Condition("simultaneous", is_no_single_point, WHERE | BEFORE | AFTER),
    Condition("simultaneous", is_line, AFTER),
    Condition("no_impact", does_not_approach, BEFORE | AFTER, otherwise="impact"),
)
FRICTION_CONDITIONS = (
    *CONDITIONS,
    Condition("impact_stick", ends_in_stick, AFTER, otherwise="impact_slip"),
)

SCENE = Scene(
    name="cylinder-pair-impact",
    title="Impact of two cylindrical parts",
    source="3.3.4",
    validity="Rigid homogeneous cylinders, one instant, no other impulse than that of the contact. "
    "Lines of contact are solved without friction only; face on face and rim on rim are not. The "
    "bodies have to touch as placed, to within the contact tolerance; nothing moves them there.",
    variants={
        "frictionless": FRICTIONLESS,
        "pfeiffer_glocker": PFEIFFER_GLOCKER,
        "moreau": MOREAU,
    },
    default_variant="frictionless",
    conditions={
        "frictionless": CONDITIONS,
        "pfeiffer_glocker": FRICTION_CONDITIONS,
        "moreau": FRICTION_CONDITIONS,
    },
    defaults={
        "contact_tolerance": 1e-9,
        "position_x_2": 0.0,
        "position_y_2": 0.0,
        "position_z_2": 0.0,
        **{
            f"{name}_{body}": 0.0
            for name in (
                *("azimuth", "elevation"),
                *("velocity_x", "velocity_y", "velocity_z", "spin_x", "spin_y", "spin_z"),
            )
            for body in (1, 2)
        },
    },
    constraints=(),
)
