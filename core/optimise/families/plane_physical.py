"""Block on the floor under the friction disc (theory 12.2); what the cylinder shares with it.

All candidates are in units of the drive acceleration P: k = c/P, g = G/P.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array, Mask, ratio
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

Candidate = tuple[Array, Array, Array, Mask]
"""alpha, beta, 1 where static friction still holds there, and whether it is a candidate."""

Accelerate = Callable[[tuple[Array, Array], Array, Array], tuple[Array, Array]]
"""Takes the drive in the plane less gravity, the floor's n0 and mu; returns a_x and a_y."""

Turned = Callable[[Array, Array, Array, Array], Candidate]
"""Takes k, g, mu and the static mu; returns the best drive from the side."""


def _straight(k: Array, g: Array, mu: Array, mu_s: Array) -> tuple[Candidate, Candidate]:
    zero = np.zeros_like(k)
    lift_off = np.arcsin(np.minimum(g, 1.0))
    beta = np.minimum(np.arctan(mu), lift_off)
    # At lift-off there is nothing to hold the part; g - sin(beta) is rounding there.
    floor = np.where(beta < lift_off, g - np.sin(beta), 0.0)
    slips = np.cos(beta) - k > mu_s * floor
    share = (k + mu_s * g) / np.hypot(1.0, mu_s)
    edge = np.arctan(mu_s) - np.arccos(np.clip(share, -1.0, 1.0))
    starts = ~slips & (share < 1) & (edge >= 0) & (edge < lift_off) & (mu_s > mu)
    return (zero, beta, zero, np.asarray(slips)), (zero, edge, zero + 1, np.asarray(starts))


def fastest_slide(
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
    turned: Turned,
    held: Turned,
    accelerate: Accelerate,
) -> Optimum:
    """Return the drive angles of the largest a_x on a plane: straight along x, or to the side.

    Arguments broadcast; values out of range get the status `invalid`. The result has the angles
    [rad], a_x and a_y [m/s2] and a status. All candidates are closed forms or
    iterations of few steps; the best in each cell is taken.
    """
    P, c, G, mu, mu_s = broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, friction_static
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0) & (mu_s >= mu)
    valid, driven, (P, c, G, mu, mu_s) = valid_inputs(within, P, c, G, mu, mu_s)
    scale = np.where(driven, P, 1.0)
    k, g = c / scale, G / scale
    candidates = (*_straight(k, g, mu, mu_s), turned(k, g, mu, mu_s), held(k, g, mu, mu_s))
    zero = np.zeros_like(P)
    alpha, beta, at_edge, across = zero, zero, zero, zero
    along = np.full_like(P, -np.inf)
    for a, b, holds, exists in candidates:
        floor = np.maximum(G - P * np.sin(b), 0.0)
        push = P * np.cos(b)
        ax, ay = accelerate((push * np.cos(a) - c, push * np.sin(a)), floor, mu)
        better = exists & driven & (ax > along)
        along, across = np.where(better, ax, along), np.where(better, ay, across)
        alpha, beta = np.where(better, a, alpha), np.where(better, b, beta)
        at_edge = np.where(better, holds, at_edge)
    # Without drive the part rests, or slides down the slope.
    slides = np.abs(c) > mu_s * G
    idle = np.where(slides, -c + np.sign(c) * mu * G, 0.0)
    status = statuses(valid, np.zeros_like(valid), driven, along)
    status = np.where((status == STATUS["optimal"]) & (at_edge > 0), STATUS["not_attained"], status)
    status = status.astype(np.int8)
    still = status == STATUS["no_motion"]
    flat = status == STATUS["flat"]
    along, across = np.where(flat, idle, along), np.where(flat, 0.0, across)
    alpha, beta, along, across = (
        np.where(still, np.nan, part) for part in (alpha, beta, along, across)
    )
    return optimum(alpha, beta, along, across, status)


# Newton's steps for the tilted optimum; more are needed only where two roots all but meet.
MAX_STEPS = 60


def plane_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> Optimum:
    """Return the drive angles of the largest a_x of a block on a plane with the friction disc.

    On a horizontal or falling track: alpha = 0, a_y = 0, beta = min(atan(mu_k), asin(G/P)), and
    there is no trade-off. On a climbing track a drive close to the limit of motion does better from
    the side: it turns friction away from x (theory 12.2). For a friction along -(cos psi, sin psi)
    the best a_x is

        V = cos psi [sqrt(1 + mu^2) sqrt(P^2 - c^2 sin^2 psi) - mu G - c cos psi],

    whose derivative by cos(psi) is convex, so that Newton's method from cos(psi) = 0 climbs to the
    one interior maximum; it is compared with alpha = 0.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x, c, and
    onto the floor, G [m/s2], `friction_kinetic` is mu and `friction_static` mu_s >= mu; all
    broadcast. The status is `no_motion` with NaN where no drive moves the part, `not_attained` at
    the edge of stick. The result has the angles [rad], a_x and a_y [m/s2] and a
    status.
    """
    return fastest_slide(
        vibration_acceleration,
        gravity_along,
        gravity_normal,
        friction_kinetic,
        friction_static,
        _turned,
        _held,
        _acceleration,
    )


def _turned(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    A = np.hypot(1.0, mu)
    p2 = (1 - k) * (1 + k)
    exists = (k > 0) & (p2 > 0) & (A * np.sqrt(np.maximum(p2, 0.0)) > mu * g)
    p2, k1 = np.where(exists, p2, 1.0), np.where(exists, k, 0.5)
    x = np.zeros_like(k1)
    for _ in range(MAX_STEPS):
        root = np.sqrt(p2 + (k1 * x) ** 2)
        t = k1 * x / root
        slope = A * (p2 / root + 2 * k1 * x * t) - 2 * k1 * x - mu * g
        bend = k1 * (A * t * (3 - t * t) - 2)
        # A convex slope that no longer falls, or a root beyond 1: no maximum inside.
        exists &= (bend < 0) | (slope <= 0)
        ahead = x - slope / np.where(bend < 0, bend, -1.0)
        exists &= ahead < 1
        moving = exists & (ahead > x)
        if not np.any(moving):
            break
        x = np.where(moving, ahead, x)
    exists &= x > 0
    x = np.where(exists, x, 1.0)
    sine = np.sqrt((1 - x) * (1 + x))
    root = np.sqrt(np.maximum(1 - np.where(exists, k, 0.0) ** 2 * sine**2, 0.0))
    dx, dy = k * sine**2 + root * x / A, -k * sine * x + root * sine / A
    dz = root * mu / A
    exists &= dz < np.minimum(g, 1.0)
    excess = A * root - mu * g - k * x  # |D| - mu n
    exists &= (excess > (mu_s - mu) * (g - dz)) & (excess > 0) & (dy > 0)
    alpha = np.arctan2(np.where(exists, dy, 0.0), np.where(exists, dx, 1.0))
    beta = np.arcsin(np.where(exists, dz, 0.0))
    return alpha, beta, np.zeros_like(k), np.asarray(exists)


def _held(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    dz = g * (mu_s / np.hypot(1.0, mu_s)) ** 2
    q2 = (1 - dz) * (1 + dz)
    exists = (k > 0) & (q2 > 0) & (mu_s > mu)
    q = np.sqrt(np.where(exists, q2, 1.0))
    k1 = np.where(exists, k, 1.0)
    Dx = (q * q - k1 * k1 - (mu_s * (g - dz)) ** 2) / (2 * k1)
    exists &= (Dx > 0) & (Dx < q - k1)
    side = np.sqrt(np.where(exists, (q - Dx - k1) * (q + Dx + k1), 0.0))
    alpha = np.arctan2(side, np.where(exists, Dx + k1, 1.0))
    beta = np.arcsin(np.where(exists, dz, 0.0))
    return alpha, beta, np.ones_like(k), np.asarray(exists)


def _acceleration(D: tuple[Array, Array], floor: Array, mu: Array) -> tuple[Array, Array]:
    left = 1.0 - ratio(mu * floor, np.hypot(*D), 0.0)
    return D[0] * left, D[1] * left


FAMILY = Family(
    systems=(("rectangle-on-plane", "physical", "acceleration_x"),),
    closed={Maximise: plane_physical_fastest},
    contacts=frozenset({"floor_contact"}),
)
