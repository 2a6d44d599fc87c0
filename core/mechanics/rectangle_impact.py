"""Impact of two rectangles: contact, inertia in the contact, impulse (theory 5).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.mechanics import impact
from core.mechanics.arrays import Array, Mask
from core.mechanics.impact import Impulse, only_in_impact
from core.mechanics.rectangle_contact import RectangleContact


class EdgeAction(NamedTuple):
    """Where on a touching edge the impulse acts: share of the way from its first end, 0 to 1.

    `unknown` marks edges for which no single impulse tells the result.
    """

    share: Array
    unknown: Mask


class Arms(NamedTuple):
    """Moments about each centre of unit impulses at the contact, along n and along t."""

    normal_1: Array
    tangential_1: Array
    normal_2: Array
    tangential_2: Array


class Motion(NamedTuple):
    """Velocities of both bodies."""

    velocity_x_1: Array
    velocity_y_1: Array
    spin_1: Array
    velocity_x_2: Array
    velocity_y_2: Array
    spin_2: Array


# --- the place of the contact


def inertia_1(*, mass_1: Array, length_1: Array, width_1: Array) -> Array:
    """Return I = m (a^2 + h^2)/12 of body 1 [kg m2]."""
    return mass_1 * (length_1 * length_1 + width_1 * width_1) / 12


def inertia_2(*, mass_2: Array, length_2: Array, width_2: Array) -> Array:
    """Return I = m (a^2 + h^2)/12 of body 2 [kg m2]."""
    return mass_2 * (length_2 * length_2 + width_2 * width_2) / 12


def _closing(
    x: Array, y: Array, n_x: Array, n_y: Array, *, position_x_1: Array, position_y_1: Array,
    position_x_2: Array, position_y_2: Array, velocity_x_1: Array, velocity_y_1: Array,
    spin_1: Array, velocity_x_2: Array, velocity_y_2: Array, spin_2: Array,
) -> Array:  # fmt: skip
    """Return the velocity of body 1 relative to body 2 at a point, along a direction."""
    slip_x = (velocity_x_1 - spin_1 * (y - position_y_1)) - (
        velocity_x_2 - spin_2 * (y - position_y_2)
    )
    slip_y = (velocity_y_1 + spin_1 * (x - position_x_1)) - (
        velocity_y_2 + spin_2 * (x - position_x_2)
    )
    return n_x * slip_x + n_y * slip_y


def edge_action_without_friction(
    *,
    rectangle_contact: RectangleContact,
    position_x_1: Array,
    position_y_1: Array,
    position_x_2: Array,
    position_y_2: Array,
    velocity_x_1: Array,
    velocity_y_1: Array,
    spin_1: Array,
    velocity_x_2: Array,
    velocity_y_2: Array,
    spin_2: Array,
    mass_1: Array,
    mass_2: Array,
    inertia_1: Array,
    inertia_2: Array,
    restitution: Array,
) -> EdgeAction:
    """Return where the resultant of both ends of a touching edge acts.

    Both ends are contacts without friction, and the impulses solve the complementarity problem of
    theory 1.4. The impact is that of the resultant alone, since the normals are parallel.
    """
    at = rectangle_contact
    u_1, u_2 = (
        _closing(
            x, y, at.normal_x, at.normal_y, position_x_1=position_x_1, position_y_1=position_y_1,
            position_x_2=position_x_2, position_y_2=position_y_2, velocity_x_1=velocity_x_1,
            velocity_y_1=velocity_y_1, spin_1=spin_1, velocity_x_2=velocity_x_2,
            velocity_y_2=velocity_y_2, spin_2=spin_2,
        )
        for x, y in ((at.first_x, at.first_y), (at.second_x, at.second_y))
    )  # fmt: skip
    arms = [
        (x - px) * at.normal_y - (y - py) * at.normal_x
        for px, py in ((position_x_1, position_y_1), (position_x_2, position_y_2))
        for x, y in ((at.first_x, at.first_y), (at.second_x, at.second_y))
    ]
    first_1, second_1, first_2, second_2 = arms
    free = 1 / mass_1 + 1 / mass_2
    both = impact.on_edge(
        G_11=free + first_1 * first_1 / inertia_1 + first_2 * first_2 / inertia_2,
        G_12=free + first_1 * second_1 / inertia_1 + first_2 * second_2 / inertia_2,
        G_22=free + second_1 * second_1 / inertia_1 + second_2 * second_2 / inertia_2,
        u_1=u_1,
        u_2=u_2,
        restitution=restitution,
    )
    total = both.first + both.second
    idle = np.where(u_2 < u_1, 1.0, 0.0)
    share = np.where(total > 0, both.second / np.where(total > 0, total, 1.0), idle)
    return EdgeAction(share, at.edge & both.again)


def edge_action_with_friction(
    *,
    rectangle_contact: RectangleContact,
    position_x_1: Array,
    position_y_1: Array,
    position_x_2: Array,
    position_y_2: Array,
    velocity_x_1: Array,
    velocity_y_1: Array,
    spin_1: Array,
    velocity_x_2: Array,
    velocity_y_2: Array,
    spin_2: Array,
) -> EdgeAction:
    """Return the end of a touching edge that approaches most; friction at two ends is not solved.

    If that end does not approach, the edge does not; else the impact is `simultaneous`.
    """
    at = rectangle_contact
    u_1, u_2 = (
        _closing(
            x, y, at.normal_x, at.normal_y, position_x_1=position_x_1, position_y_1=position_y_1,
            position_x_2=position_x_2, position_y_2=position_y_2, velocity_x_1=velocity_x_1,
            velocity_y_1=velocity_y_1, spin_1=spin_1, velocity_x_2=velocity_x_2,
            velocity_y_2=velocity_y_2, spin_2=spin_2,
        )
        for x, y in ((at.first_x, at.first_y), (at.second_x, at.second_y))
    )  # fmt: skip
    return EdgeAction(np.where(u_2 < u_1, 1.0, 0.0), at.edge & (np.minimum(u_1, u_2) < 0))


def contact_x(*, rectangle_contact: RectangleContact, edge_action: EdgeAction) -> Array:
    """Return the point where the impulse acts, x [m]."""
    at = rectangle_contact
    return at.first_x + edge_action.share * (at.second_x - at.first_x)


def contact_y(*, rectangle_contact: RectangleContact, edge_action: EdgeAction) -> Array:
    """Return the point where the impulse acts, y [m]."""
    at = rectangle_contact
    return at.first_y + edge_action.share * (at.second_y - at.first_y)


def contact_arms(
    *,
    contact_x: Array,
    contact_y: Array,
    normal_x: Array,
    normal_y: Array,
    position_x_1: Array,
    position_y_1: Array,
    position_x_2: Array,
    position_y_2: Array,
) -> Arms:
    """Return rho x n and rho x t of both bodies, t = (-n_y, n_x) [m]."""
    x_1, y_1 = contact_x - position_x_1, contact_y - position_y_1
    x_2, y_2 = contact_x - position_x_2, contact_y - position_y_2
    return Arms(
        x_1 * normal_y - y_1 * normal_x,
        x_1 * normal_x + y_1 * normal_y,
        x_2 * normal_y - y_2 * normal_x,
        x_2 * normal_x + y_2 * normal_y,
    )


# --- what the law sees


def delassus_normal(
    *, contact_arms: Arms, mass_1: Array, mass_2: Array, inertia_1: Array, inertia_2: Array
) -> Array:
    """Return G_NN = 1/m1 + 1/m2 + (rho1 x n)^2/I1 + (rho2 x n)^2/I2 [kg-1]."""
    of_1, of_2 = contact_arms.normal_1, contact_arms.normal_2
    return 1 / mass_1 + 1 / mass_2 + of_1 * of_1 / inertia_1 + of_2 * of_2 / inertia_2


def delassus_coupling(*, contact_arms: Arms, inertia_1: Array, inertia_2: Array) -> Array:
    """Return G_NT = (rho1 x n)(rho1 x t)/I1 + (rho2 x n)(rho2 x t)/I2 [kg-1]."""
    arms = contact_arms
    return (
        arms.normal_1 * arms.tangential_1 / inertia_1
        + arms.normal_2 * arms.tangential_2 / inertia_2
    )


def delassus_tangential(
    *, contact_arms: Arms, mass_1: Array, mass_2: Array, inertia_1: Array, inertia_2: Array
) -> Array:
    """Return G_TT = 1/m1 + 1/m2 + (rho1 x t)^2/I1 + (rho2 x t)^2/I2 [kg-1]."""
    of_1, of_2 = contact_arms.tangential_1, contact_arms.tangential_2
    return 1 / mass_1 + 1 / mass_2 + of_1 * of_1 / inertia_1 + of_2 * of_2 / inertia_2


def approach_normal(
    *,
    contact_arms: Arms,
    normal_x: Array,
    normal_y: Array,
    velocity_x_1: Array,
    velocity_y_1: Array,
    spin_1: Array,
    velocity_x_2: Array,
    velocity_y_2: Array,
    spin_2: Array,
) -> Array:
    """Return u_N = n.(v1 + w1 x rho1 - v2 - w2 x rho2) [m s-1]."""
    centres = normal_x * (velocity_x_1 - velocity_x_2) + normal_y * (velocity_y_1 - velocity_y_2)
    return centres + spin_1 * contact_arms.normal_1 - spin_2 * contact_arms.normal_2


def approach_tangential(
    *,
    contact_arms: Arms,
    normal_x: Array,
    normal_y: Array,
    velocity_x_1: Array,
    velocity_y_1: Array,
    spin_1: Array,
    velocity_x_2: Array,
    velocity_y_2: Array,
    spin_2: Array,
) -> Array:
    """Return u_T = t.(v1 + w1 x rho1 - v2 - w2 x rho2) [m s-1]."""
    centres = normal_x * (velocity_y_1 - velocity_y_2) - normal_y * (velocity_x_1 - velocity_x_2)
    return centres + spin_1 * contact_arms.tangential_1 - spin_2 * contact_arms.tangential_2


# --- where there is an impact


def is_apart(*, rectangle_contact: RectangleContact, contact_tolerance: Array) -> Mask:
    """Return where the gap exceeds the tolerance, or the nearest corner lies beside the face."""
    at = rectangle_contact
    return (at.gap > contact_tolerance * at.size) | (at.beside & (at.gap >= 0))


def overlaps(*, rectangle_contact: RectangleContact, contact_tolerance: Array) -> Mask:
    """Return where the overlap exceeds the tolerance."""
    at = rectangle_contact
    return (at.gap < -contact_tolerance * at.size) | (at.beside & (at.gap < 0))


def is_corner_on_corner(*, rectangle_contact: RectangleContact) -> Mask:
    """Return where a corner meets a corner: the normal is not unique."""
    return rectangle_contact.at_corner


def is_edge_on_edge(*, edge_action: EdgeAction) -> Mask:
    """Return where an edge meets an edge and no single impulse tells the result."""
    return edge_action.unknown


def does_not_approach(*, approach_normal: Array) -> Mask:
    """Return where the bodies separate or slide past each other, u_N >= 0."""
    return approach_normal >= 0


def ends_in_stick(*, planar_impulse: Impulse) -> Mask:
    """Return where the contact does not slide at the end of the impact."""
    return planar_impulse.sticks


def _masked(
    impulse: Impulse,
    at: RectangleContact,
    tolerance: Array,
    edge_action: EdgeAction,
) -> Impulse:
    nothing = is_apart(rectangle_contact=at, contact_tolerance=tolerance)
    unknown = overlaps(rectangle_contact=at, contact_tolerance=tolerance)
    unknown = unknown | ((at.at_corner | edge_action.unknown) & ~nothing)
    return Impulse(
        only_in_impact(impulse.normal, nothing, unknown),
        only_in_impact(impulse.tangential, nothing, unknown),
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
    """Return Newton's impulse without friction; NaN where the bodies overlap or the law is mute."""
    normal = impact.frictionless(G_NN=delassus_normal, u_N=approach_normal, restitution=restitution)
    impulse = Impulse(normal, np.zeros_like(normal), np.zeros(normal.shape, dtype=np.bool_))
    return _masked(impulse, rectangle_contact, contact_tolerance, edge_action)


def pfeiffer_glocker_impulse(
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
    """Return the impulse of compression and expansion with friction, Poisson's restitution."""
    impulse = impact.pfeiffer_glocker(
        G_NN=delassus_normal,
        G_NT=delassus_coupling,
        G_TT=delassus_tangential,
        u_N=approach_normal,
        u_T=approach_tangential,
        friction=friction,
        restitution=restitution,
    )
    return _masked(impulse, rectangle_contact, contact_tolerance, edge_action)


def moreau_impulse(
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
    """Return Moreau's impulse with friction, one restitution for both directions."""
    impulse = impact.moreau(
        G_NN=delassus_normal,
        G_NT=delassus_coupling,
        G_TT=delassus_tangential,
        u_N=approach_normal,
        u_T=approach_tangential,
        friction=friction,
        restitution=restitution,
    )
    return _masked(impulse, rectangle_contact, contact_tolerance, edge_action)
