"""Impact of two rectangles: contact, impulse, motion after it, energy, balances (theory 5).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics import impact
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.impact import EdgeAction, Impulse, only_in_impact
from vibrafeed.core.mechanics.rectangle_contact import Rectangle, RectangleContact


class Arms(NamedTuple):
    """Lever arms of the contact about both centres, of the normal n and of the tangent t [m]."""

    normal_1: Array
    tangential_1: Array
    normal_2: Array
    tangential_2: Array


class RectangleMasses(NamedTuple):
    """Mass [kg] and moment of inertia [kg m2] of both bodies."""

    mass_1: Array
    inertia_1: Array
    mass_2: Array
    inertia_2: Array


class BodyVelocities(NamedTuple):
    """Velocities [m s-1] and angular velocities [rad s-1] of both bodies."""

    velocity_x_1: Array
    velocity_y_1: Array
    spin_1: Array
    velocity_x_2: Array
    velocity_y_2: Array
    spin_2: Array


# --- the bodies


def rectangle(
    *, position_x: Array, position_y: Array, angle: Array, length: Array, width: Array
) -> Rectangle:
    """Return the place and shape of a body."""
    return Rectangle(position_x, position_y, angle, length, width)


def inertia(*, mass: Array, length: Array, width: Array) -> Array:
    """Return the moment of inertia of a body, m (a^2 + h^2)/12 [kg m2]."""
    return mass * (length * length + width * width) / 12


def rectangle_masses(
    *, mass_1: Array, inertia_1: Array, mass_2: Array, inertia_2: Array
) -> RectangleMasses:
    """Return mass and moment of inertia of both bodies."""
    return RectangleMasses(mass_1, inertia_1, mass_2, inertia_2)


def planar_motion(
    *,
    velocity_x_1: Array,
    velocity_y_1: Array,
    spin_1: Array,
    velocity_x_2: Array,
    velocity_y_2: Array,
    spin_2: Array,
) -> BodyVelocities:
    """Return the velocities before the impact."""
    return BodyVelocities(velocity_x_1, velocity_y_1, spin_1, velocity_x_2, velocity_y_2, spin_2)


# --- the place of the contact


def _closing_velocity(
    x: Array,
    y: Array,
    n_x: Array,
    n_y: Array,
    body_1: Rectangle,
    body_2: Rectangle,
    motion: BodyVelocities,
) -> Array:
    # Normal velocity of body 1 against body 2 at the point (x, y), n.(v1 + w1 x rho1 - v2 - w2 x
    # rho2).
    u = motion
    relative_x = (u.velocity_x_1 - u.spin_1 * (y - body_1.y)) - (
        u.velocity_x_2 - u.spin_2 * (y - body_2.y)
    )
    relative_y = (u.velocity_y_1 + u.spin_1 * (x - body_1.x)) - (
        u.velocity_y_2 + u.spin_2 * (x - body_2.x)
    )
    return n_x * relative_x + n_y * relative_y


def edge_action_without_friction(
    *,
    rectangle_contact: RectangleContact,
    rectangle_1: Rectangle,
    rectangle_2: Rectangle,
    planar_motion: BodyVelocities,
    rectangle_masses: RectangleMasses,
    restitution: Array,
) -> EdgeAction:
    """Return the point of a touching edge at which the resultant of the impulses at its ends acts.

    The impulses L at both ends of the edge are solved together: L >= 0, G L + (1 + eps) u >= 0, at
    each end one of both 0 (theory 1.4). The normals are parallel, so that the resultant alone gives
    the impact.
    """
    contact = rectangle_contact
    u_1, u_2 = (
        _closing_velocity(
            x, y, contact.normal_x, contact.normal_y, rectangle_1, rectangle_2, planar_motion
        )
        for x, y in ((contact.first_x, contact.first_y), (contact.second_x, contact.second_y))
    )
    arms = [
        (x - body.x) * contact.normal_y - (y - body.y) * contact.normal_x
        for body in (rectangle_1, rectangle_2)
        for x, y in ((contact.first_x, contact.first_y), (contact.second_x, contact.second_y))
    ]
    first_1, second_1, first_2, second_2 = arms
    mass_1, inertia_1, mass_2, inertia_2 = rectangle_masses
    inverse_masses = 1 / mass_1 + 1 / mass_2
    action = impact.on_edge(
        G_11=inverse_masses + first_1 * first_1 / inertia_1 + first_2 * first_2 / inertia_2,
        G_12=inverse_masses + first_1 * second_1 / inertia_1 + first_2 * second_2 / inertia_2,
        G_22=inverse_masses + second_1 * second_1 / inertia_1 + second_2 * second_2 / inertia_2,
        u_1=u_1,
        u_2=u_2,
        restitution=restitution,
    )
    return EdgeAction(action.share, contact.edge & action.unknown)


def edge_action_with_friction(
    *,
    rectangle_contact: RectangleContact,
    rectangle_1: Rectangle,
    rectangle_2: Rectangle,
    planar_motion: BodyVelocities,
) -> EdgeAction:
    """Return the end of a touching edge that approaches faster, where the impulse then acts.

    An impact at one end of the edge is solved, one at both ends at once is not: edges that approach
    at all are `unknown`.
    """
    contact = rectangle_contact
    u_1, u_2 = (
        _closing_velocity(
            x, y, contact.normal_x, contact.normal_y, rectangle_1, rectangle_2, planar_motion
        )
        for x, y in ((contact.first_x, contact.first_y), (contact.second_x, contact.second_y))
    )
    return EdgeAction(np.where(u_2 < u_1, 1.0, 0.0), contact.edge & (np.minimum(u_1, u_2) < 0))


def contact_point(
    axis: int, *, rectangle_contact: RectangleContact, edge_action: EdgeAction
) -> Array:
    """Return the point where the impulse acts, x (`axis` 0) or y (1) [m]."""
    contact = rectangle_contact
    first, second = ((contact.first_x, contact.second_x), (contact.first_y, contact.second_y))[axis]
    return first + edge_action.share * (second - first)


def contact_arms(
    *,
    contact_x: Array,
    contact_y: Array,
    normal_x: Array,
    normal_y: Array,
    rectangle_1: Rectangle,
    rectangle_2: Rectangle,
) -> Arms:
    """Return the lever arms of the contact about both centres, rho x n and rho x t [m].

    rho leads from a body's centre to the contact, n is the unit normal and t = (-n_y, n_x) the
    tangent.
    """
    x_1, y_1 = contact_x - rectangle_1.x, contact_y - rectangle_1.y
    x_2, y_2 = contact_x - rectangle_2.x, contact_y - rectangle_2.y
    return Arms(
        x_1 * normal_y - y_1 * normal_x,
        x_1 * normal_x + y_1 * normal_y,
        x_2 * normal_y - y_2 * normal_x,
        x_2 * normal_x + y_2 * normal_y,
    )


# --- what the law sees


def delassus_normal(*, contact_arms: Arms, rectangle_masses: RectangleMasses) -> Array:
    """Return the Delassus number 1/m1 + 1/m2 + (rho1 x n)^2/I1 + (rho2 x n)^2/I2 [kg-1].

    The normal velocity of the contact per normal impulse.
    """
    mass_1, inertia_1, mass_2, inertia_2 = rectangle_masses
    arm_1, arm_2 = contact_arms.normal_1, contact_arms.normal_2
    return 1 / mass_1 + 1 / mass_2 + arm_1 * arm_1 / inertia_1 + arm_2 * arm_2 / inertia_2


def delassus_coupling(*, contact_arms: Arms, rectangle_masses: RectangleMasses) -> Array:
    """Return the Delassus number (rho1 x n)(rho1 x t)/I1 + (rho2 x n)(rho2 x t)/I2 [kg-1].

    The relative tangential velocity per normal impulse, and the reverse.
    """
    arms, masses = contact_arms, rectangle_masses
    return (
        arms.normal_1 * arms.tangential_1 / masses.inertia_1
        + arms.normal_2 * arms.tangential_2 / masses.inertia_2
    )


def delassus_tangential(*, contact_arms: Arms, rectangle_masses: RectangleMasses) -> Array:
    """Return the Delassus number 1/m1 + 1/m2 + (rho1 x t)^2/I1 + (rho2 x t)^2/I2 [kg-1].

    The tangential velocity of the contact per tangential impulse.
    """
    mass_1, inertia_1, mass_2, inertia_2 = rectangle_masses
    arm_1, arm_2 = contact_arms.tangential_1, contact_arms.tangential_2
    return 1 / mass_1 + 1 / mass_2 + arm_1 * arm_1 / inertia_1 + arm_2 * arm_2 / inertia_2


def approach_normal(
    *,
    contact_arms: Arms,
    normal_x: Array,
    normal_y: Array,
    planar_motion: BodyVelocities,
) -> Array:
    """Return the relative normal velocity of two bodies at their contact before an impact [m s-1].

    n.(v1 + w1 x rho1 - v2 - w2 x rho2), negative in approach.
    """
    u = planar_motion
    relative_x, relative_y = u.velocity_x_1 - u.velocity_x_2, u.velocity_y_1 - u.velocity_y_2
    centre_velocity = normal_x * relative_x + normal_y * relative_y
    return centre_velocity + u.spin_1 * contact_arms.normal_1 - u.spin_2 * contact_arms.normal_2


def approach_tangential(
    *,
    contact_arms: Arms,
    normal_x: Array,
    normal_y: Array,
    planar_motion: BodyVelocities,
) -> Array:
    """Return the tangential velocity of the contact points before an impact [m s-1].

    t.(v1 + w1 x rho1 - v2 - w2 x rho2).
    """
    u = planar_motion
    relative_x, relative_y = u.velocity_x_1 - u.velocity_x_2, u.velocity_y_1 - u.velocity_y_2
    centre_velocity = normal_x * relative_y - normal_y * relative_x
    return (
        centre_velocity
        + u.spin_1 * contact_arms.tangential_1
        - u.spin_2 * contact_arms.tangential_2
    )


# --- where there is an impact


def is_apart(*, rectangle_contact: RectangleContact, contact_tolerance: Array) -> Mask:
    """True where the gap exceeds the tolerance, or the nearest corner lies beside the face.

    The tolerance is a share of the bodies' size.
    """
    contact = rectangle_contact
    return (contact.gap > contact_tolerance * contact.size) | (contact.beside & (contact.gap >= 0))


def overlaps(*, rectangle_contact: RectangleContact, contact_tolerance: Array) -> Mask:
    """True where the overlap exceeds the tolerance."""
    contact = rectangle_contact
    return (contact.gap < -contact_tolerance * contact.size) | (contact.beside & (contact.gap < 0))


def lacks_single_point(*, rectangle_contact: RectangleContact) -> Mask:
    """True where a corner meets a corner: the normal is not unique."""
    return rectangle_contact.at_corner


def lacks_single_impulse(*, edge_action: EdgeAction) -> Mask:
    """True where an edge meets an edge and no single impulse tells the result."""
    return edge_action.unknown


def does_not_approach(*, approach_normal: Array) -> Mask:
    """True where the bodies separate or slide past each other, u_N >= 0."""
    return approach_normal >= 0


def ends_in_stick(*, planar_impulse: Impulse) -> Mask:
    """True where the contact does not slide at the end of the impact."""
    return planar_impulse.sticks


def _only_at_one_contact(
    impulse: Impulse,
    contact: RectangleContact,
    tolerance: Array,
    edge_action: EdgeAction,
) -> Impulse:
    # 0 where the bodies are apart, NaN where the contact is no single point or has no single
    # impulse.
    are_apart = is_apart(rectangle_contact=contact, contact_tolerance=tolerance)
    unknown = overlaps(rectangle_contact=contact, contact_tolerance=tolerance)
    unknown = unknown | ((contact.at_corner | edge_action.unknown) & ~are_apart)
    return Impulse(
        only_in_impact(impulse.normal, are_apart, unknown),
        only_in_impact(impulse.tangential, are_apart, unknown),
        impulse.sticks,
    )


def frictionless_impulse(
    *,
    rectangle_contact: RectangleContact,
    contact_tolerance: Array,
    edge_action: EdgeAction,
    delassus_normal: Array,
    approach_normal: Array,
    restitution: Array,
) -> Impulse:
    """Return Newton's impulse without friction, L_N = -(1 + eps) u_N/G_NN, on body 1 [N s].

    0 where the bodies are apart, NaN where they overlap or the impact has no single impulse.
    """
    normal = impact.frictionless(G_NN=delassus_normal, u_N=approach_normal, restitution=restitution)
    impulse = Impulse(normal, np.zeros_like(normal), np.zeros(normal.shape, dtype=np.bool_))
    return _only_at_one_contact(impulse, rectangle_contact, contact_tolerance, edge_action)


def impulse_with_friction(
    law: Callable[..., Impulse],
    *,
    rectangle_contact: RectangleContact,
    contact_tolerance: Array,
    edge_action: EdgeAction,
    delassus_normal: Array,
    delassus_coupling: Array,
    delassus_tangential: Array,
    approach_normal: Array,
    approach_tangential: Array,
    friction: Array,
    restitution: Array,
) -> Impulse:
    """Return the impulse on body 1 by a `law` of impact with friction [N s].

    0 where the bodies are apart, NaN where they overlap or the impact has no single impulse.
    """
    impulse = law(
        G_NN=delassus_normal,
        G_NT=delassus_coupling,
        G_TT=delassus_tangential,
        u_N=approach_normal,
        u_T=approach_tangential,
        friction=friction,
        restitution=restitution,
    )
    return _only_at_one_contact(impulse, rectangle_contact, contact_tolerance, edge_action)


# --- after the impact


def motion_after(
    *,
    planar_impulse: Impulse,
    contact_arms: Arms,
    normal_x: Array,
    normal_y: Array,
    planar_motion: BodyVelocities,
    rectangle_masses: RectangleMasses,
) -> BodyVelocities:
    """Return the velocities and spins of both bodies after an impact [m s-1, rad s-1].

    v + L/m and w + (rho x L)/I for body 1, with a minus for body 2; L is the impulse on body 1.
    """
    L_N, L_T, arms = planar_impulse.normal, planar_impulse.tangential, contact_arms
    L_x, L_y = normal_x * L_N - normal_y * L_T, normal_y * L_N + normal_x * L_T
    u, (mass_1, inertia_1, mass_2, inertia_2) = planar_motion, rectangle_masses
    return BodyVelocities(
        u.velocity_x_1 + L_x / mass_1,
        u.velocity_y_1 + L_y / mass_1,
        u.spin_1 + (arms.normal_1 * L_N + arms.tangential_1 * L_T) / inertia_1,
        u.velocity_x_2 - L_x / mass_2,
        u.velocity_y_2 - L_y / mass_2,
        u.spin_2 - (arms.normal_2 * L_N + arms.tangential_2 * L_T) / inertia_2,
    )


def energy_before(*, planar_motion: BodyVelocities, rectangle_masses: RectangleMasses) -> Array:
    """Return the kinetic energy of both bodies before the impact [J]."""
    u, (mass_1, inertia_1, mass_2, inertia_2) = planar_motion, rectangle_masses
    return (
        mass_1 * (u.velocity_x_1 * u.velocity_x_1 + u.velocity_y_1 * u.velocity_y_1)
        + inertia_1 * u.spin_1 * u.spin_1
        + mass_2 * (u.velocity_x_2 * u.velocity_x_2 + u.velocity_y_2 * u.velocity_y_2)
        + inertia_2 * u.spin_2 * u.spin_2
    ) / 2


def energy_lost(
    *,
    impulse_normal: Array,
    impulse_tangential: Array,
    approach_normal: Array,
    approach_tangential: Array,
    separation_normal: Array,
    separation_tangential: Array,
) -> Array:
    """Return the kinetic energy that the impact loses, -L.(u + u')/2 [J].

    L is the impulse on body 1, u and u' the relative velocity at the contact before and after.
    """
    return (
        -(
            impulse_normal * (approach_normal + separation_normal)
            + impulse_tangential * (approach_tangential + separation_tangential)
        )
        / 2
    )


def momentum_residual(
    axis: int,
    *,
    planar_motion: BodyVelocities,
    planar_motion_after: BodyVelocities,
    rectangle_masses: RectangleMasses,
) -> Array:
    """Return the change of the total linear momentum, x (`axis` 0) or y (1) [N s]."""
    before, after, masses = planar_motion, planar_motion_after, rectangle_masses
    change_1 = after[axis] - before[axis]
    change_2 = after[axis + 3] - before[axis + 3]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def angular_momentum_residual(
    *,
    rectangle_1: Rectangle,
    rectangle_2: Rectangle,
    planar_motion: BodyVelocities,
    planar_motion_after: BodyVelocities,
    rectangle_masses: RectangleMasses,
) -> Array:
    """Return the change of the total angular momentum about the origin by the impact [kg m2 s-1].

    Without an outer impulse it is 0 but for rounding: a check of the solution.
    """
    body_1, body_2, masses = rectangle_1, rectangle_2, rectangle_masses
    change = BodyVelocities(
        *(after - before for after, before in zip(planar_motion_after, planar_motion, strict=True))
    )
    return (
        masses.mass_1 * (body_1.x * change.velocity_y_1 - body_1.y * change.velocity_x_1)
        + masses.inertia_1 * change.spin_1
        + masses.mass_2 * (body_2.x * change.velocity_y_2 - body_2.y * change.velocity_x_2)
        + masses.inertia_2 * change.spin_2
    )
