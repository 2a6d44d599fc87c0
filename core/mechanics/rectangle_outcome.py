"""Results of an impact of two rectangles: motion, energy, balances (theory 5).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.impact import Impulse
from vibrafeed.core.mechanics.rectangle_contact import Rectangle
from vibrafeed.core.mechanics.rectangle_impact import (
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
    """Return the velocities and spins of both bodies after an impact [m s-1, rad s-1].

    v + L/m and w + (rho x L)/I for body 1, with a minus for body 2: v and w are velocity and spin
    before (`planar_motion`), L is the impulse on body 1 with normal and tangential part [N s], rho
    (`contact_arms` [m]) leads from the body's centre to the contact, m and I are mass and moment of
    inertia [kg, kg m2]. (`normal_x`, `normal_y`) is the unit normal.
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
    """Return the normal velocity at the contact after the impact, positive if it opens [m s-1].

    Of body 1 relative to body 2. `planar_motion_after` has velocities and spins of both [m s-1, rad
    s-1], `contact_arms` the levers of the contact about their centres [m], (`normal_x`, `normal_y`)
    is the unit normal from body 2 to body 1.
    """
    return approach_normal(
        contact_arms=contact_arms,
        normal_x=normal_x,
        normal_y=normal_y,
        planar_motion=planar_motion_after,
    )


def separation_tangential(
    *, planar_motion_after: BodyVelocities, contact_arms: Arms, normal_x: Array, normal_y: Array
) -> Array:
    """Return the tangential velocity at the contact after the impact, 0 if it sticks [m s-1].

    Of body 1 relative to body 2. `planar_motion_after` has velocities and spins of both [m s-1, rad
    s-1], `contact_arms` the levers of the contact about their centres [m], (`normal_x`, `normal_y`)
    is the unit normal.
    """
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

    L is the impulse on body 1, normal and tangential [N s], u (`approach_*`) and u'
    (`separation_*`) the relative velocity at the contact before and after [m s-1].
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
    """Return the change of the total linear momentum by an impact, x: 0 but for rounding [N s].

    A check: `planar_motion` is the motion of both bodies before, `planar_motion_after` after it.
    """
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

    Without an outer impulse it is 0 but for rounding: a check of the solution. `rectangle_1` and
    `rectangle_2` have the places of the centres [m], `planar_motion` and `planar_motion_after`
    velocities and spins before and after [m s-1, rad s-1], `rectangle_masses` masses and moments of
    inertia [kg, kg m2].
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
