"""Rectangle on the track: printed forces, and friction on floor and wall (theory 4.2, 4.4, 12)."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.families.family import (
    Family,
    Optimum,
    broadcast,
    optimum,
    statuses,
    valid_inputs,
)
from vibrafeed.core.optimise.optima import STATUS
from vibrafeed.core.study.optimise_study import Maximise


def track_fastest(
    *,
    variant: Literal["thesis", "derived"],
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    friction_kinetic: ArrayLike,
    wall_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest K on the track, with the source's printed forces.

    K is the acceleration along the track at rest. tan(alpha) = mu, beta = 0: K = P sqrt(1 + mu^2) -
    c -+ mu g_y. There the wall has to pull unless g_y is large (theory 4.2, 12). With
    `wall_contact` it may not, W = P cos(beta) sin(alpha) <= g_y at rest, and alpha = min(atan(mu),
    asin(g_y/P)). The `thesis` variant prints the balance with the other sign, W <= -g_y, which no
    lean onto the wall allows: `infeasible`.

    `vibration_acceleration` is P, `gravity_along` is c, along -x, `gravity_across` g_y, towards the
    wall [m/s2], `friction_kinetic` is mu; they broadcast. The result has the angles [rad], K
    [m/s2] and a status.
    """
    P, c, gy, mu = broadcast(
        vibration_acceleration, gravity_along, gravity_across, friction_kinetic
    )
    within = (P >= 0) & (mu >= 0)
    valid, driven, (P, c, gy, mu) = valid_inputs(within, P, c, gy, mu)
    sign = 1.0 if variant == "derived" else -1.0
    wall_margin = sign * gy
    alpha = np.arctan(mu)
    infeasible = np.zeros_like(valid)
    if wall_contact:
        infeasible = valid & (wall_margin < 0)
        sine = np.clip(wall_margin / np.where(driven, P, 1.0), 0.0, 1.0)
        alpha = np.minimum(alpha, np.arcsin(sine))
    beta = np.zeros_like(alpha)
    K = P * (np.cos(alpha) + mu * np.sin(alpha)) - c - mu * wall_margin
    status = statuses(valid, infeasible, driven, K)
    return optimum(alpha, beta, K, np.zeros_like(K), status)


THESIS = Family(
    systems=(
        ("rectangle-on-track", "thesis", "acceleration_x"),
        ("rectangle-on-track", "thesis", "starting_acceleration"),
    ),
    closed={Maximise: partial(track_fastest, variant="thesis")},
    against=None,
)

DERIVED = Family(
    systems=(
        ("rectangle-on-track", "derived", "acceleration_x"),
        ("rectangle-on-track", "derived", "starting_acceleration"),
        ("rectangle-on-track", "physical", "starting_acceleration"),
    ),
    closed={Maximise: partial(track_fastest, variant="derived")},
    against=None,
)


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
    angles are NaN. The result has the angles [rad], a_x [m/s2] and a status.
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
    status = statuses(valid, infeasible, driven, np.where(moves, 1.0, 0.0))
    at_edge = stuck & moves & (status == STATUS["optimal"])
    status = np.where(at_edge, STATUS["not_attained"], status).astype(np.int8)
    hidden = at_edge | (status == STATUS["no_motion"])
    alpha, beta, K = (np.where(hidden, np.nan, part) for part in (alpha, beta, K))
    across = np.where(hidden, np.nan, np.zeros_like(K))
    return optimum(alpha, beta, K, across, status)


def _both_contacts(y: Array, z: Array, mu: Array) -> tuple[Array, Array]:
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
    push = P * np.cos(beta)
    floor, wall = gz - P * np.sin(beta), gy - push * np.sin(alpha)
    return np.asarray(push * np.cos(alpha) - c - mu * (floor + wall))


PHYSICAL = Family(
    systems=(("rectangle-on-track", "physical", "acceleration_x"),),
    closed={Maximise: track_physical_fastest},
    against=None,
    contacts=frozenset({"floor_contact", "wall_contact"}),
)
