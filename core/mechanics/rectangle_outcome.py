"""Results of an impact of two rectangles: motion, energy, balances (theory 5).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

from core.mechanics.arrays import Array
from core.mechanics.impact import Impulse
from core.mechanics.rectangle_contact import Rectangle
from core.mechanics.rectangle_impact import (
    Arms,
    BodyVelocities,
    RectangleMasses,
    approach_normal,
    approach_tangential,
)

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
    """Return the velocities and spins of both bodies after the impulse [m s-1, rad s-1].

    v + L/m and w + (rho x L)/I for body 1, with a minus for body 2: L is the impulse, rho leads
    from the body's centre to the contact.
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


def separation_normal(
    *, planar_motion_after: BodyVelocities, contact_arms: Arms, normal_x: Array, normal_y: Array
) -> Array:
    """Return the normal velocity of the contact after the impact, positive if it opens [m s-1]."""
    return approach_normal(
        contact_arms=contact_arms,
        normal_x=normal_x,
        normal_y=normal_y,
        planar_motion=planar_motion_after,
    )


def separation_tangential(
    *, planar_motion_after: BodyVelocities, contact_arms: Arms, normal_x: Array, normal_y: Array
) -> Array:
    """Return the tangential velocity of the contact after the impact, 0 if it sticks [m s-1]."""
    return approach_tangential(
        contact_arms=contact_arms,
        normal_x=normal_x,
        normal_y=normal_y,
        planar_motion=planar_motion_after,
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

    L is the impulse on body 1, u (`approach`) and u' (`separation`) the velocity of the contact
    before and after.
    """
    return (
        -(
            impulse_normal * (approach_normal + separation_normal)
            + impulse_tangential * (approach_tangential + separation_tangential)
        )
        / 2
    )


def momentum_residual_x(
    *,
    planar_motion: BodyVelocities,
    planar_motion_after: BodyVelocities,
    rectangle_masses: RectangleMasses,
) -> Array:
    """Return the change of the total linear momentum by the impact, x: 0 but for rounding [N s]."""
    before, after, masses = planar_motion, planar_motion_after, rectangle_masses
    change_1 = after.velocity_x_1 - before.velocity_x_1
    change_2 = after.velocity_x_2 - before.velocity_x_2
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def momentum_residual_y(
    *,
    planar_motion: BodyVelocities,
    planar_motion_after: BodyVelocities,
    rectangle_masses: RectangleMasses,
) -> Array:
    """Return the change of the total linear momentum by the impact, y: 0 but for rounding [N s]."""
    before, after, masses = planar_motion, planar_motion_after, rectangle_masses
    change_1 = after.velocity_y_1 - before.velocity_y_1
    change_2 = after.velocity_y_2 - before.velocity_y_2
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
        *(u - v for u, v in zip(planar_motion_after, planar_motion, strict=True))
    )
    return (
        masses.mass_1 * (body_1.x * change.velocity_y_1 - body_1.y * change.velocity_x_1)
        + masses.inertia_1 * change.spin_1
        + masses.mass_2 * (body_2.x * change.velocity_y_2 - body_2.y * change.velocity_x_2)
        + masses.inertia_2 * change.spin_2
    )
