"""The rectangle on the track, friction on floor and wall, both contacts kept (theory 4.4, 12)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.codes import ACTIVE, STATUS
from vibrafeed.core.optimise.families.family import Family
from vibrafeed.core.optimise.families.optimum import (
    Optimum,
    bounds_active,
    broadcast,
    optimum,
    statuses,
    tight,
    valid_inputs,
)
from vibrafeed.core.optimise.kernels.columns import TrackPhysical
from vibrafeed.core.study.optimise_study import Maximise


def track_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> Optimum:
    """Return the drive angles of the largest a_x at rest on the track, with floor and wall kept.

    a_x = P cb ca - c - mu (g_z - P sb + g_y - P cb sa), where ca, sa, cb, sb are cosines and sines
    of azimuth alpha and elevation beta (theory 4.4, 12). Without bounds tan(alpha) = mu and
    tan(beta) = mu/sqrt(1 + mu^2); where that lifts the part off the wall, P cb sa = g_y and
    sin(beta) = mu sqrt((1 - g_y^2/P^2)/(1 + mu^2)); sin(beta) at most g_z/P in both.

    `vibration_acceleration` is P; `gravity_along`, `gravity_across` and `gravity_normal` are
    gravity along -x, c, towards the wall, g_y, and onto the floor, g_z [m/s2]; `friction_kinetic`
    is mu and `friction_static` mu_s >= mu; all broadcast. The status is `no_motion` if the same
    maximum with mu_s is not positive, `not_attained` if the best angles let the part stick: then
    angles are NaN. The result has the angles [rad], a_x [m/s2], binding constraints and a status.
    """
    P, c, gy, gz, mu, mu_s = broadcast(
        vibration_acceleration,
        gravity_along,
        gravity_across,
        gravity_normal,
        friction_kinetic,
        friction_static,
    )
    within = (P >= 0) & (mu >= 0) & (mu_s >= mu)
    valid, driven, (P, c, gy, gz, mu, mu_s) = valid_inputs(within, P, c, gy, gz, mu, mu_s)
    infeasible = valid & ((gy < 0) | (gz < 0))
    scale = np.where(driven, P, 1.0)
    y, z = np.maximum(gy, 0.0) / scale, np.maximum(gz, 0.0) / scale
    alpha, beta = _both_contacts(y, z, mu)
    easiest = _both_contacts(y, z, mu_s)
    start = _both_value(P, c, gy, gz, mu_s, *easiest)
    K = _both_value(P, c, gy, gz, mu, alpha, beta)
    stuck = _both_value(P, c, gy, gz, mu_s, alpha, beta) <= 0
    moves = start > 0
    active = bounds_active(alpha, beta)
    active |= tight(ACTIVE["wall"], gy - P * np.cos(beta) * np.sin(alpha), P + np.abs(gy))
    active |= tight(ACTIVE["floor"], gz - P * np.sin(beta), P + np.abs(gz))
    status = statuses(valid, infeasible, driven, np.where(moves, 1.0, 0.0))
    at_edge = stuck & moves & (status == STATUS["optimal"])
    status = np.where(at_edge, STATUS["not_attained"], status).astype(np.int8)
    hidden = at_edge | (status == STATUS["no_motion"])
    alpha, beta, K = (np.where(hidden, np.nan, part) for part in (alpha, beta, K))
    across = np.where(hidden, np.nan, np.zeros_like(K))
    active = np.where(hidden, 0, active).astype(np.int16)
    return optimum(alpha, beta, K, across, active, status)


def _both_contacts(y: Array, z: Array, mu: Array) -> tuple[Array, Array]:
    """Return the drive angles of the largest d_x + mu (d_y + d_z) with d_y <= y and d_z <= z.

    It is largest where a part on floor and wall accelerates most. d is the unit direction of the
    drive; y and z are gravity towards the wall and onto the floor over the drive's acceleration, mu
    is friction. All are arrays of one shape, as are azimuth and elevation [rad].
    """
    kept = np.minimum(y, 1.0)
    wall = np.minimum(mu * np.sqrt((1 - kept) * (1 + kept)) / np.hypot(1.0, mu), z)
    across = np.sqrt(np.maximum((1 - wall) * (1 + wall) - kept * kept, 0.0))
    at_wall = (y < 1) & (kept <= mu * across)
    free = np.minimum(mu / np.sqrt(1 + 2 * mu * mu), z)
    alpha = np.where(at_wall, np.arctan2(kept, across), np.arctan(mu))
    return alpha, np.arcsin(np.where(at_wall, wall, free))


def _both_value(
    P: Array, c: Array, gy: Array, gz: Array, mu: Array, alpha: Array, beta: Array
) -> Array:
    """Return the starting acceleration K_0 (theory 4.4) at given angles [m s-2].

    It is the drive along x less gravity c and less friction mu on floor and wall, whose loads are
    gz - P sin(beta) and gy - P cos(beta) sin(alpha).
    """
    push = P * np.cos(beta)
    floor, wall = gz - P * np.sin(beta), gy - push * np.sin(alpha)
    return np.asarray(push * np.cos(alpha) - c - mu * (floor + wall))


FAMILY = Family(
    name="track_physical",
    systems=(("rectangle-on-track", "physical", "acceleration_x"),),
    closed={Maximise: track_physical_fastest},
    batch=(Maximise,),
    kernel=TrackPhysical,
    against=None,
    contacts=frozenset({"floor_contact", "wall_contact"}),
)
