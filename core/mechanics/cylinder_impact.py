"""Impact of two cylinders: contact, impulse, motion after it, energy, balances (theory 8).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics import impact
from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, sine
from vibrafeed.core.mechanics.cylinder_contact import (
    Cylinder,
    CylinderContact,
    Vector,
    any_across,
    cross,
    dot,
    minus,
    plus,
    scaled,
)
from vibrafeed.core.mechanics.impact import SpatialDelassus, SpatialImpulse, only_in_impact


class CylinderMasses(NamedTuple):
    """Mass [kg] and moments of inertia [kg m2] along and across the own axis, of both bodies."""

    mass_1: Array
    axial_1: Array
    across_1: Array
    mass_2: Array
    axial_2: Array
    across_2: Array


class SpatialMotion(NamedTuple):
    """Velocities of the centres [m s-1] and angular velocities [rad s-1] of both bodies."""

    velocity_1: Vector
    spin_1: Vector
    velocity_2: Vector
    spin_2: Vector


class ImpactFrame(NamedTuple):
    """Contact point, normal and two tangents; `unknown` marks lines that the law does not solve."""

    point: Vector
    normal: Vector
    tangent_1: Vector
    tangent_2: Vector
    unknown: Mask


class Approach(NamedTuple):
    """Velocity of body 1 relative to body 2 at the contact, along normal and tangents [m s-1]."""

    normal: Array
    tangential: tuple[Array, Array]


# --- the bodies


def cylinder(
    *, position_x: Array, position_y: Array, position_z: Array, azimuth: Array,
    elevation: Array, diameter: Array, length: Array,
) -> Cylinder:  # fmt: skip
    """Return centre, unit axis, radius and half length of a body from its parameters.

    The axis is (ce ca, ce sa, se), c and s being cosine and sine of elevation e and azimuth a.
    """
    flat = cosine(elevation)
    axis = flat * cosine(azimuth), flat * sine(azimuth), sine(elevation)
    return Cylinder((position_x, position_y, position_z), axis, diameter / 2, length / 2)


def cylinder_masses(
    *, mass_1: Array, diameter_1: Array, length_1: Array, mass_2: Array, diameter_2: Array,
    length_2: Array,
) -> CylinderMasses:  # fmt: skip
    """Return mass and both moments of inertia of the two bodies [kg, kg m2].

    With diameter d and length h: I_a = m d^2/8 about the axis, I_t = m (3/4 d^2 + h^2)/12 across
    it.
    """
    square_1, square_2 = diameter_1 * diameter_1, diameter_2 * diameter_2
    return CylinderMasses(
        mass_1,
        mass_1 * square_1 / 8,
        mass_1 * (0.75 * square_1 + length_1 * length_1) / 12,
        mass_2,
        mass_2 * square_2 / 8,
        mass_2 * (0.75 * square_2 + length_2 * length_2) / 12,
    )


def spatial_motion(
    *, velocity_x_1: Array, velocity_y_1: Array, velocity_z_1: Array, spin_x_1: Array, spin_y_1:
    Array, spin_z_1: Array, velocity_x_2: Array, velocity_y_2: Array, velocity_z_2: Array,
    spin_x_2: Array, spin_y_2: Array, spin_z_2: Array,
) -> SpatialMotion:  # fmt: skip
    """Return velocities and spins of both bodies before the impact, as vectors [m s-1, rad s-1]."""
    return SpatialMotion(
        (velocity_x_1, velocity_y_1, velocity_z_1),
        (spin_x_1, spin_y_1, spin_z_1),
        (velocity_x_2, velocity_y_2, velocity_z_2),
        (spin_x_2, spin_y_2, spin_z_2),
    )


def _relative_velocity_at(
    point: Vector, body_1: Cylinder, body_2: Cylinder, motion: SpatialMotion
) -> Vector:
    velocity_1 = plus(motion.velocity_1, cross(motion.spin_1, minus(point, body_1.centre)))
    velocity_2 = plus(motion.velocity_2, cross(motion.spin_2, minus(point, body_2.centre)))
    return minus(velocity_1, velocity_2)


def _inverse_inertia_times(
    moment: Vector, body: Cylinder, axial: Array, transverse: Array
) -> Vector:
    along = dot(moment, body.axis) * (1 / axial - 1 / transverse)
    return plus(scaled(moment, 1 / transverse), body.axis, along)


def _delassus(
    point: Vector, direction: Vector, other_point: Vector, other_direction: Vector,
    body_1: Cylinder, body_2: Cylinder, masses: CylinderMasses,
) -> Array:  # fmt: skip
    # The velocity along `direction` at `point` by a unit impulse along `other_direction` at
    # `other_point`: e.e' (1/m1 + 1/m2) + sum (rho x e).J^-1 (rho' x e').
    total = (1 / masses.mass_1 + 1 / masses.mass_2) * dot(direction, other_direction)
    for body, axial, transverse in (
        (body_1, masses.axial_1, masses.across_1),
        (body_2, masses.axial_2, masses.across_2),
    ):
        arm = cross(minus(point, body.centre), direction)
        other_arm = cross(minus(other_point, body.centre), other_direction)
        total = total + dot(arm, _inverse_inertia_times(other_arm, body, axial, transverse))
    return total


def _frame(contact: CylinderContact, line_fraction: Array, unknown: Mask) -> ImpactFrame:
    n = contact.normal
    tangent = any_across(n)
    point = plus(contact.first, minus(contact.second, contact.first), line_fraction)
    return ImpactFrame(point, n, tangent, cross(n, tangent), contact.line & unknown)


def frame_without_friction(
    *, cylinder_contact: CylinderContact, cylinder_1: Cylinder, cylinder_2: Cylinder,
    cylinder_masses: CylinderMasses, spatial_motion: SpatialMotion, restitution: Array,
) -> ImpactFrame:  # fmt: skip
    """Return point, normal and tangents of the contact of two cylinders without friction.

    Where the bodies touch along a line, the impulses at both its ends are solved together, and the
    point is where their resultant acts.
    """
    contact, body_1, body_2, masses = cylinder_contact, cylinder_1, cylinder_2, cylinder_masses
    n, first, second = contact.normal, contact.first, contact.second
    u_1 = dot(n, _relative_velocity_at(first, body_1, body_2, spatial_motion))
    u_2 = dot(n, _relative_velocity_at(second, body_1, body_2, spatial_motion))
    action = impact.on_edge(
        G_11=_delassus(first, n, first, n, body_1, body_2, masses),
        G_12=_delassus(first, n, second, n, body_1, body_2, masses),
        G_22=_delassus(second, n, second, n, body_1, body_2, masses),
        u_1=u_1,
        u_2=u_2,
        restitution=restitution,
    )
    return _frame(contact, *action)


def frame_with_friction(
    *, cylinder_contact: CylinderContact, cylinder_1: Cylinder, cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
) -> ImpactFrame:  # fmt: skip
    """Return point, normal and tangents of the contact of two cylinders with friction.

    Where a line touches, the point is the end that approaches faster. If this end does not
    approach, no point of the line does; else the frame is `unknown`, since an impact with friction
    along a line is not solved (regime `simultaneous`).
    """
    contact, body_1, body_2 = cylinder_contact, cylinder_1, cylinder_2
    u_1 = dot(contact.normal, _relative_velocity_at(contact.first, body_1, body_2, spatial_motion))
    u_2 = dot(contact.normal, _relative_velocity_at(contact.second, body_1, body_2, spatial_motion))
    return _frame(contact, np.where(u_2 < u_1, 1.0, 0.0), np.minimum(u_1, u_2) < 0)


def spatial_delassus(
    *, contact_frame: ImpactFrame, cylinder_1: Cylinder, cylinder_2: Cylinder, cylinder_masses:
    CylinderMasses,
) -> SpatialDelassus:  # fmt: skip
    """Return the six Delassus numbers of the contact of two cylinders: velocity per impulse [kg-1].

    Of the normal n and the tangents t and s of `contact_frame`, at its point: the change of the
    relative velocity along one by a unit impulse along the other.
    """
    p, n, t, s = contact_frame[:4]
    bodies = (cylinder_1, cylinder_2, cylinder_masses)
    return SpatialDelassus(
        _delassus(p, n, p, n, *bodies),
        _delassus(p, n, p, t, *bodies),
        _delassus(p, n, p, s, *bodies),
        _delassus(p, t, p, t, *bodies),
        _delassus(p, t, p, s, *bodies),
        _delassus(p, s, p, s, *bodies),
    )


def spatial_approach(
    contact_frame: ImpactFrame, cylinder_1: Cylinder, cylinder_2: Cylinder, spatial_motion:
    SpatialMotion,
) -> Approach:  # fmt: skip
    """Return the velocity of body 1 against body 2 in the contact before the impact [m s-1].

    Its normal component is negative where the bodies approach.
    """
    frame, u = (
        contact_frame,
        _relative_velocity_at(contact_frame.point, cylinder_1, cylinder_2, spatial_motion),
    )
    return Approach(dot(frame.normal, u), (dot(frame.tangent_1, u), dot(frame.tangent_2, u)))


# --- where there is an impact


def is_apart(*, cylinder_contact: CylinderContact, contact_tolerance: Array) -> Mask:
    """True where the gap exceeds the tolerance."""
    return cylinder_contact.gap > contact_tolerance * cylinder_contact.size


def overlaps(*, cylinder_contact: CylinderContact, contact_tolerance: Array) -> Mask:
    """True where a form of contact is proven and overlaps by more than the tolerance."""
    contact = cylinder_contact
    return (contact.form > 0) & (contact.gap < -contact_tolerance * contact.size)


def lacks_single_point(*, cylinder_contact: CylinderContact) -> Mask:
    """True where faces or rims meet, or none of the five forms is proven."""
    return cylinder_contact.several


def lacks_single_impulse(*, contact_frame: ImpactFrame, spatial_impulse: SpatialImpulse) -> Mask:
    """True where a line meets and no single impulse tells the result, or the law has none."""
    return contact_frame.unknown | np.isnan(spatial_impulse.normal)


def does_not_approach(*, spatial_approach: Approach) -> Mask:
    """True where the bodies separate or slide past each other, u_N >= 0."""
    return spatial_approach.normal >= 0


def ends_in_stick(*, spatial_impulse: SpatialImpulse) -> Mask:
    """True where the contact does not slide at the end of the impact."""
    return spatial_impulse.sticks


def _only_at_one_contact(
    impulse: SpatialImpulse, contact: CylinderContact, tolerance: Array, frame: ImpactFrame
) -> SpatialImpulse:
    # 0 where the bodies are apart, NaN where the contact is no single point or has no single
    # impulse.
    are_apart = is_apart(cylinder_contact=contact, contact_tolerance=tolerance)
    unknown = overlaps(cylinder_contact=contact, contact_tolerance=tolerance)
    unknown = unknown | ((contact.several | frame.unknown) & ~are_apart)
    return SpatialImpulse(
        only_in_impact(impulse.normal, are_apart, unknown),
        (
            only_in_impact(impulse.tangential[0], are_apart, unknown),
            only_in_impact(impulse.tangential[1], are_apart, unknown),
        ),
        impulse.sticks,
    )


def frictionless_impulse(
    *, cylinder_contact: CylinderContact, contact_tolerance: Array, contact_frame: ImpactFrame,
    delassus_normal: Array, approach_normal: Array, restitution: Array,
) -> SpatialImpulse:  # fmt: skip
    """Return Newton's impulse without friction, L_N = -(1 + eps) u_N/G_NN, on body 1 [N s].

    0 where the bodies are apart by more than the tolerance, NaN where they overlap or the impact
    has no single impulse.
    """
    normal = impact.frictionless(G_NN=delassus_normal, u_N=approach_normal, restitution=restitution)
    none = np.zeros_like(normal)
    impulse = SpatialImpulse(normal, (none, none), np.zeros(normal.shape, dtype=np.bool_))
    return _only_at_one_contact(impulse, cylinder_contact, contact_tolerance, contact_frame)


def impulse_with_friction(
    law: Callable[..., SpatialImpulse], *, cylinder_contact: CylinderContact,
    contact_tolerance: Array, contact_frame: ImpactFrame, spatial_delassus: SpatialDelassus,
    spatial_approach: Approach, friction: Array, restitution: Array,
) -> SpatialImpulse:  # fmt: skip
    """Return the impulse on body 1 by a `law` of impact with friction [N s].

    0 where the bodies are apart by more than the tolerance, NaN where they overlap, touch at
    several places, or the law has no solution.
    """
    impulse = law(
        G=spatial_delassus,
        u_N=spatial_approach.normal,
        u=spatial_approach.tangential,
        friction=friction,
        restitution=restitution,
    )
    return _only_at_one_contact(impulse, cylinder_contact, contact_tolerance, contact_frame)


# --- after the impact


def in_space(impulse: SpatialImpulse, frame: ImpactFrame) -> Vector:
    """Return the impulse on body 1 as a vector along the axes of space [N s]."""
    L_1, L_2 = impulse.tangential
    normal = scaled(frame.normal, impulse.normal)
    return plus(plus(normal, frame.tangent_1, L_1), frame.tangent_2, L_2)


def spatial_motion_after(
    *, spatial_impulse: SpatialImpulse, contact_frame: ImpactFrame, cylinder_1: Cylinder,
    cylinder_2: Cylinder, cylinder_masses: CylinderMasses, spatial_motion: SpatialMotion,
) -> SpatialMotion:  # fmt: skip
    """Return velocities and spins of both cylinders after an impact [m s-1, rad s-1].

    v + L/m and w + J^-1 (rho x L) for body 1, with a minus for body 2; L is the impulse on body 1.
    """
    before, masses, contact_point = spatial_motion, cylinder_masses, contact_frame.point
    L = in_space(spatial_impulse, contact_frame)
    moment_1 = cross(minus(contact_point, cylinder_1.centre), L)
    moment_2 = cross(minus(contact_point, cylinder_2.centre), L)
    return SpatialMotion(
        plus(before.velocity_1, L, 1 / masses.mass_1),
        plus(
            before.spin_1,
            _inverse_inertia_times(moment_1, cylinder_1, masses.axial_1, masses.across_1),
        ),
        plus(before.velocity_2, L, -1 / masses.mass_2),
        plus(
            before.spin_2,
            _inverse_inertia_times(moment_2, cylinder_2, masses.axial_2, masses.across_2),
            -1.0,
        ),
    )


def inertial(spin: Vector, body: Cylinder, axial: Array, transverse: Array) -> Vector:
    """Return the angular momentum J w of a cylinder that turns with w [kg m2 s-1]."""
    return plus(scaled(spin, transverse), body.axis, dot(spin, body.axis) * (axial - transverse))


def impulse_friction(*, spatial_impulse: SpatialImpulse) -> Array:
    """Return the magnitude of the tangential impulse [N s]."""
    return np.hypot(*spatial_impulse.tangential)


def sliding_before(*, spatial_approach: Approach) -> Array:
    """Return the speed of sliding before the impact [m s-1]."""
    return np.hypot(*spatial_approach.tangential)


def separation_normal(
    *,
    contact_frame: ImpactFrame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return the normal velocity of the contact after the impact, positive if it opens [m s-1]."""
    return spatial_approach(contact_frame, cylinder_1, cylinder_2, spatial_motion_after).normal


def sliding_after(
    *,
    contact_frame: ImpactFrame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return the speed of sliding after the impact [m s-1]."""
    after = spatial_approach(contact_frame, cylinder_1, cylinder_2, spatial_motion_after)
    return np.hypot(*after.tangential)


def energy_before(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    cylinder_masses: CylinderMasses,
    spatial_motion: SpatialMotion,
) -> Array:
    """Return the kinetic energy of both cylinders before the impact [J]."""
    motion, masses = spatial_motion, cylinder_masses
    angular_momentum_1 = inertial(motion.spin_1, cylinder_1, masses.axial_1, masses.across_1)
    angular_momentum_2 = inertial(motion.spin_2, cylinder_2, masses.axial_2, masses.across_2)
    return (
        masses.mass_1 * dot(motion.velocity_1, motion.velocity_1)
        + dot(motion.spin_1, angular_momentum_1)
        + masses.mass_2 * dot(motion.velocity_2, motion.velocity_2)
        + dot(motion.spin_2, angular_momentum_2)
    ) / 2


def energy_lost(
    *,
    spatial_impulse: SpatialImpulse,
    contact_frame: ImpactFrame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return the kinetic energy that the impact loses, -L.(u + u')/2 [J].

    L is the impulse on body 1, u and u' the velocity of body 1 relative to body 2 at the contact
    before and after.
    """
    frame, L = contact_frame, spatial_impulse
    before = spatial_approach(frame, cylinder_1, cylinder_2, spatial_motion)
    after = spatial_approach(frame, cylinder_1, cylinder_2, spatial_motion_after)
    work = L.normal * (before.normal + after.normal)
    for impulse, u, u_after in zip(L.tangential, before.tangential, after.tangential, strict=True):
        work = work + impulse * (u + u_after)
    return -work / 2


def impulse_component(
    axis: int, *, spatial_impulse: SpatialImpulse, contact_frame: ImpactFrame
) -> Array:
    """Return the impulse on body 1 along an axis of space, `axis` 0 to 2 for x to z [N s]."""
    return in_space(spatial_impulse, contact_frame)[axis]


def momentum_residual(
    axis: int,
    *,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the total momentum by an impact, `axis` 0 to 2 for x to z [N s]."""
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1 = after.velocity_1[axis] - before.velocity_1[axis]
    change_2 = after.velocity_2[axis] - before.velocity_2[axis]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def angular_momentum_residual(
    axis: int,
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of angular momentum about the origin, `axis` 0 to 2: x to z [kg m2 s-1].

    Without an outer impulse it is 0: the rest is a check of the solution.
    """
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1, change_2 = minus(after.spin_1, before.spin_1), minus(after.spin_2, before.spin_2)
    own_1 = inertial(change_1, cylinder_1, masses.axial_1, masses.across_1)
    own_2 = inertial(change_2, cylinder_2, masses.axial_2, masses.across_2)
    orbit_1 = cross(cylinder_1.centre, minus(after.velocity_1, before.velocity_1))
    orbit_2 = cross(cylinder_2.centre, minus(after.velocity_2, before.velocity_2))
    total_1, total_2 = plus(own_1, orbit_1, masses.mass_1), plus(own_2, orbit_2, masses.mass_2)
    return plus(total_1, total_2)[axis]
