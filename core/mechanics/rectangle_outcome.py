"""What an impact of two rectangles leaves: motion, energy, balances (theory 5).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

from core.mechanics.arrays import Array
from core.mechanics.impact import Impulse
from core.mechanics.rectangle_impact import (
    Arms,
    Motion,
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
) -> Motion:
    """Return all velocities after the impulse, qdot + M^-1 (W_N L_N + W_T L_T)."""
    L_N, L_T, arms = planar_impulse.normal, planar_impulse.tangential, contact_arms
    L_x, L_y = normal_x * L_N - normal_y * L_T, normal_y * L_N + normal_x * L_T
    return Motion(
        velocity_x_1 + L_x / mass_1,
        velocity_y_1 + L_y / mass_1,
        spin_1 + (arms.normal_1 * L_N + arms.tangential_1 * L_T) / inertia_1,
        velocity_x_2 - L_x / mass_2,
        velocity_y_2 - L_y / mass_2,
        spin_2 - (arms.normal_2 * L_N + arms.tangential_2 * L_T) / inertia_2,
    )


def separation_normal(
    *, planar_motion_after: Motion, contact_arms: Arms, normal_x: Array, normal_y: Array
) -> Array:
    """Return u_N of the velocities after the impact [m s-1]."""
    return approach_normal(
        contact_arms=contact_arms,
        normal_x=normal_x,
        normal_y=normal_y,
        **planar_motion_after._asdict(),
    )


def separation_tangential(
    *, planar_motion_after: Motion, contact_arms: Arms, normal_x: Array, normal_y: Array
) -> Array:
    """Return u_T of the velocities after the impact [m s-1]."""
    return approach_tangential(
        contact_arms=contact_arms,
        normal_x=normal_x,
        normal_y=normal_y,
        **planar_motion_after._asdict(),
    )


def energy_before(
    *,
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
) -> Array:
    """Return the kinetic energy of both bodies before the impact [J]."""
    return (
        mass_1 * (velocity_x_1 * velocity_x_1 + velocity_y_1 * velocity_y_1)
        + inertia_1 * spin_1 * spin_1
        + mass_2 * (velocity_x_2 * velocity_x_2 + velocity_y_2 * velocity_y_2)
        + inertia_2 * spin_2 * spin_2
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
    """Return T_A - T_E as the work -L.(u + u')/2 of the impulse, free of cancellation [J]."""
    return (
        -(
            impulse_normal * (approach_normal + separation_normal)
            + impulse_tangential * (approach_tangential + separation_tangential)
        )
        / 2
    )


def momentum_residual_x(
    *, planar_motion_after: Motion, velocity_x_1: Array, velocity_x_2: Array, mass_1: Array,
    mass_2: Array,
) -> Array:  # fmt: skip
    """Return what the velocities after the impact add to the linear momentum, x [N s]."""
    after = planar_motion_after
    change_1, change_2 = after.velocity_x_1 - velocity_x_1, after.velocity_x_2 - velocity_x_2
    return mass_1 * change_1 + mass_2 * change_2


def momentum_residual_y(
    *, planar_motion_after: Motion, velocity_y_1: Array, velocity_y_2: Array, mass_1: Array,
    mass_2: Array,
) -> Array:  # fmt: skip
    """Return what the velocities after the impact add to the linear momentum, y [N s]."""
    after = planar_motion_after
    change_1, change_2 = after.velocity_y_1 - velocity_y_1, after.velocity_y_2 - velocity_y_2
    return mass_1 * change_1 + mass_2 * change_2


def angular_momentum_residual(
    *,
    planar_motion_after: Motion,
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
) -> Array:
    """Return what the velocities after add to the angular momentum about the origin [kg m2 s-1]."""
    after = planar_motion_after
    change_x_1, change_y_1 = after.velocity_x_1 - velocity_x_1, after.velocity_y_1 - velocity_y_1
    change_x_2, change_y_2 = after.velocity_x_2 - velocity_x_2, after.velocity_y_2 - velocity_y_2
    return (
        mass_1 * (position_x_1 * change_y_1 - position_y_1 * change_x_1)
        + inertia_1 * (after.spin_1 - spin_1)
        + mass_2 * (position_x_2 * change_y_2 - position_y_2 * change_x_2)
        + inertia_2 * (after.spin_2 - spin_2)
    )
