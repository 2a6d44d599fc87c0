"""Results of an impact of two cylinders: motion, energy, balances (theory 8).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.cylinder_impact import (
    Approach,
    CylinderMasses,
    ImpactFrame,
    SpatialMotion,
    approach,
    in_space,
    inertial,
    turning,
)
from vibrafeed.core.mechanics.cylinders import Cylinder, dot
from vibrafeed.core.mechanics.impact import SpatialImpulse


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
    return approach(contact_frame, cylinder_1, cylinder_2, spatial_motion_after).normal


def sliding_after(
    *,
    contact_frame: ImpactFrame,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion_after: SpatialMotion,
) -> Array:
    """Return the speed of sliding after the impact [m s-1]."""
    after = approach(contact_frame, cylinder_1, cylinder_2, spatial_motion_after)
    return np.hypot(*after.tangential)


def energy_before(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    cylinder_masses: CylinderMasses,
    spatial_motion: SpatialMotion,
) -> Array:
    """Return the kinetic energy of both cylinders before the impact [J].

    `spatial_motion` has velocities and spins before [m s-1, rad s-1], `cylinder_masses` masses and
    moments of inertia along and across the axes [kg, kg m2].
    """
    motion, masses = spatial_motion, cylinder_masses
    turning_1 = inertial(motion.spin_1, cylinder_1, masses.axial_1, masses.across_1)
    turning_2 = inertial(motion.spin_2, cylinder_2, masses.axial_2, masses.across_2)
    return (
        masses.mass_1 * dot(motion.velocity_1, motion.velocity_1)
        + dot(motion.spin_1, turning_1)
        + masses.mass_2 * dot(motion.velocity_2, motion.velocity_2)
        + dot(motion.spin_2, turning_2)
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

    L is the impulse on body 1 [N s], in the axes of `contact_frame`, u and u' the velocity of body
    1 relative to body 2 at the contact before and after [m s-1], from `spatial_motion` and
    `spatial_motion_after`.
    """
    at, L = contact_frame, spatial_impulse
    before = approach(at, cylinder_1, cylinder_2, spatial_motion)
    after = approach(at, cylinder_1, cylinder_2, spatial_motion_after)
    work = L.normal * (before.normal + after.normal)
    for impulse, u, u_after in zip(L.tangential, before.tangential, after.tangential, strict=True):
        work = work + impulse * (u + u_after)
    return -work / 2


def impulse_x(*, spatial_impulse: SpatialImpulse, contact_frame: ImpactFrame) -> Array:
    """Return the impulse on body 1, x [N s]."""
    return in_space(spatial_impulse, contact_frame)[0]


def impulse_y(*, spatial_impulse: SpatialImpulse, contact_frame: ImpactFrame) -> Array:
    """Return the impulse on body 1, y [N s]."""
    return in_space(spatial_impulse, contact_frame)[1]


def impulse_z(*, spatial_impulse: SpatialImpulse, contact_frame: ImpactFrame) -> Array:
    """Return the impulse on body 1, z [N s]."""
    return in_space(spatial_impulse, contact_frame)[2]


def momentum_residual_x(
    *,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the total momentum along x by an impact: 0 but for rounding [N s].

    A check of the solution: `spatial_motion` and `spatial_motion_after` hold the velocities of both
    bodies before and after [m s-1], `cylinder_masses` their masses [kg].
    """
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1 = after.velocity_1[0] - before.velocity_1[0]
    change_2 = after.velocity_2[0] - before.velocity_2[0]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def momentum_residual_y(
    *,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the total momentum along y by an impact: 0 but for rounding [N s].

    A check of the solution: `spatial_motion` and `spatial_motion_after` hold the velocities of both
    bodies before and after [m s-1], `cylinder_masses` their masses [kg].
    """
    before, after, masses = spatial_motion, spatial_motion_after, cylinder_masses
    change_1 = after.velocity_1[1] - before.velocity_1[1]
    change_2 = after.velocity_2[1] - before.velocity_2[1]
    return masses.mass_1 * change_1 + masses.mass_2 * change_2


def momentum_residual_z(
    *,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the total momentum along z by an impact: 0 but for rounding [N s].

    A check of the solution: `spatial_motion` and `spatial_motion_after` hold the velocities of both
    bodies before and after [m s-1], `cylinder_masses` their masses [kg].
    """
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
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the angular momentum about the origin by the impact, x [kg m2 s-1]."""
    return turning(cylinder_1, cylinder_2, spatial_motion, spatial_motion_after, cylinder_masses)[0]


def angular_momentum_residual_y(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the angular momentum about the origin by the impact, y [kg m2 s-1]."""
    return turning(cylinder_1, cylinder_2, spatial_motion, spatial_motion_after, cylinder_masses)[1]


def angular_momentum_residual_z(
    *,
    cylinder_1: Cylinder,
    cylinder_2: Cylinder,
    spatial_motion: SpatialMotion,
    spatial_motion_after: SpatialMotion,
    cylinder_masses: CylinderMasses,
) -> Array:
    """Return the change of the angular momentum about the origin by the impact, z [kg m2 s-1]."""
    return turning(cylinder_1, cylinder_2, spatial_motion, spatial_motion_after, cylinder_masses)[2]
