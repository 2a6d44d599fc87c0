"""The printed formulas of part and plane: constant friction towards -y (theory 12.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from core.mechanics.arrays import Array, ratio
from core.optimise.codes import ACTIVE
from core.optimise.families.family import Family
from core.optimise.families.optimum import (
    Optimum,
    ParetoSet,
    bounds_active,
    broadcast,
    optimum,
    statuses,
    tight,
    valid_inputs,
)
from core.optimise.kernels.columns import PlaneThesis
from core.study.optimise_study import Limited, Maximise, Pareto, Weighted
from core.study.spacing import evenly


def plane_thesis_limited(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    limit: ArrayLike,
    floor_contact: bool,
) -> Optimum:
    """Return the angles of the largest a_x with |a_y| <= limit, printed friction (theory 12.1).

    P is the drive's acceleration amplitude, G gravity onto the floor, n0 the floor's normal force
    per mass. Without a limit alpha = 0 and beta = atan(mu), or with `floor_contact` (n0 >= 0) the
    smaller of that and the lift-off angle asin(G/P), which is the smaller from P = G sqrt(1 +
    mu^2)/mu on. With asin(G/P) <= atan(mu) (case A): alpha = 0; beta is the lift-off angle, where
    a_y = 0, or without `floor_contact` sin(beta) = min((G + limit/mu)/P, sin(atan mu)). Else (case
    B): alpha = 0, beta = atan(mu) while a_y >= -limit there, then the point of a_y = -limit on the
    curve tan(beta) = mu (cos(alpha) + sin(alpha)), which has a closed form (`_on_curve`). It lies
    within 90 deg while P sqrt(1 + mu^2) >= mu G - limit; below that the status is `infeasible`.
    """
    P, c, G, mu, E = broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, limit
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0) & (E >= 0)
    valid, driven, (P, c, G, mu) = valid_inputs(within, P, c, G, mu)
    E = np.where(valid, E, 0.0)
    scale = np.where(driven, P, 1.0)
    g, e, A = G / scale, E / scale, np.hypot(1.0, mu)
    lifts = mu >= g * A
    leaving = np.minimum(g + ratio(e, mu, np.inf), mu / A)
    sine = g if floor_contact else leaving
    on_curve = ~lifts & (mu * mu / A < mu * g - e)
    infeasible = driven & on_curve & (mu * g - e > A)
    held = on_curve & ~infeasible & driven
    alpha, beta = _on_curve(np.where(held, mu * g - np.where(held, e, 0.0), 0.0), mu)
    alpha = np.where(held, alpha, 0.0)
    beta = np.where(held, beta, np.where(lifts, np.arcsin(np.minimum(sine, 1.0)), np.arctan(mu)))
    # Without drive a_y is -mu G at every angle.
    infeasible |= valid & ~driven & (mu * G > E)
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = statuses(valid, infeasible, driven, along)
    active = bounds_active(alpha, beta) | tight(ACTIVE["across_lower"], E + across, P + G)
    active |= tight(ACTIVE["across_upper"], E - across, P + G)
    if floor_contact:
        active |= tight(ACTIVE["floor"], G - P * np.sin(beta), P + G)
    return optimum(alpha, beta, along, across, active, status)


def plane_thesis_weighted(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    weight: ArrayLike,
    floor_contact: bool,
) -> Optimum:
    """Return the angles of the largest a_x - weight |a_y|, printed friction (theory 12.1).

    With the drive direction d and the weight w the sum is linear in d where a_y < 0, with the
    gradient (1, w, mu (1 + w)), so that its top has tan(alpha) = w and tan(beta) = mu (cos(alpha) +
    sin(alpha)): a point of the Pareto set. Case B (asin(G/P) > atan(mu), with the drive
    acceleration P and gravity G onto the floor): alpha = min(atan(w), alpha_max); every w >=
    tan(alpha_max) ends in the kink a_y = 0. Case A: alpha = 0 and beta = max(asin(G/P), atan(mu (1
    - w))); the kink is the lift-off angle, reached from w = 1 - tan(asin(G/P))/mu on, and with
    `floor_contact` for every w.
    """
    P, c, G, mu, w = broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, weight
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0) & (w >= 0)
    valid, driven, (P, c, G, mu, w) = valid_inputs(within, P, c, G, mu, w)
    g, A = G / np.where(driven, P, 1.0), np.hypot(1.0, mu)
    lifts = mu >= g * A
    lift_off = np.arcsin(np.minimum(g, 1.0))
    leaving = lift_off if floor_contact else np.maximum(lift_off, np.arctan(mu * (1 - w)))
    alpha = np.where(lifts, 0.0, np.minimum(np.arctan(w), _alpha_max(g, mu)))
    beta = np.where(lifts, leaving, _curve_beta(alpha, mu))
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = statuses(valid, np.zeros_like(valid), driven, along)
    kink = ACTIVE["across_lower"] | ACTIVE["across_upper"]
    active = bounds_active(alpha, beta) | tight(kink, across, P + G)
    if floor_contact:
        active |= tight(ACTIVE["floor"], G - P * np.sin(beta), P + G)
    return optimum(alpha, beta, along, across, active, status)


def plane_thesis_pareto(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    floor_contact: bool,
    points: int,
) -> ParetoSet:
    """Return points of the trade-off between a_x and |a_y|, printed friction (theory 12.1).

    They go from the largest a_x to the least |a_y|. Case A, asin(G/P) <= atan(mu) with the drive
    acceleration P and gravity G onto the floor: with `floor_contact` one point, repeated; without,
    alpha = 0 and beta from atan(mu) down to asin(G/P), evenly spaced. Case B: the curve tan(beta) =
    mu (cos(alpha) + sin(alpha)), alpha evenly spaced from 0 to where a_y = 0, or to 90 deg where P
    sqrt(1 + mu^2) < mu G and a_y stays negative. `points` is their number.
    """
    P, c, G, mu = (
        part[..., np.newaxis]
        for part in broadcast(
            vibration_acceleration, gravity_along, gravity_normal, friction_kinetic
        )
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0)
    valid, driven, (P, c, G, mu) = valid_inputs(within, P, c, G, mu)
    g, A = G / np.where(driven, P, 1.0), np.hypot(1.0, mu)
    lifts = mu >= g * A
    lift_off = np.arcsin(np.minimum(g, 1.0))
    share = evenly(0.0, 1.0, points)
    first = lift_off if floor_contact else np.arctan(mu)
    alpha = np.where(lifts, 0.0, share * _alpha_max(g, mu))
    beta = np.where(lifts, first + share * (lift_off - first), _curve_beta(alpha, mu))
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = statuses(valid, np.zeros_like(valid), driven, along[..., :1])[..., 0]
    bad = ~valid
    return ParetoSet(
        np.where(bad, np.nan, alpha),
        np.where(bad, np.nan, beta),
        np.where(bad, np.nan, along),
        np.where(bad, np.nan, across),
        status,
    )


def _printed_accelerations(
    P: Array, c: Array, G: Array, mu: Array, alpha: Array, beta: Array
) -> tuple[Array, Array]:
    """Return a_x and a_y of (3.11), with friction mu (G - P sin(beta)) against both.

    P is the drive's acceleration amplitude, c and G are gravity along -x and onto the floor [m
    s-2].
    """
    friction = mu * (G - P * np.sin(beta))
    push = P * np.cos(beta)
    return push * np.cos(alpha) - c - friction, push * np.sin(alpha) - friction


def _curve_beta(alpha: Array, mu: Array) -> Array:
    """Return the elevation on the curve tan(beta) = mu (cos(alpha) + sin(alpha))."""
    return np.asarray(np.arctan(mu * (np.cos(alpha) + np.sin(alpha))))


def _on_curve(level: Array, mu: Array) -> tuple[Array, Array]:
    """Return alpha and beta of the point of tan(beta) = mu (cos(alpha) + sin(alpha)) at a level.

    The level is that of d_y + mu d_z, with the drive direction d. The point is the highest over d_x
    + mu d_z of the circle that the plane of the level cuts from the unit sphere: the foot of the
    plane plus a step along the projected gradient.
    """
    A2 = 1.0 + mu * mu
    A = np.hypot(1.0, mu)
    s = np.minimum(level / A, 1.0)
    x = np.sqrt((1 - s) * (1 + s)) * np.sqrt(A2 / (1 + 2 * mu * mu))
    y = s / A - x * (mu * mu / A2)
    alpha = np.clip(np.arctan2(y, x), 0.0, np.pi / 2)
    return alpha, _curve_beta(alpha, mu)


def _alpha_max(g: Array, mu: Array) -> Array:
    """Return the alpha with a_y = 0 on the curve of case B; 90 deg where a_y stays negative.

    `g` is gravity onto the floor over the drive acceleration.
    """
    return _on_curve(np.minimum(mu * g, np.hypot(1.0, mu)), mu)[0]


FAMILY = Family(
    name="plane_thesis",
    systems=tuple(
        (scene, variant, "acceleration_x")
        for scene in ("rectangle-on-plane", "cylinder-on-plane")
        for variant in ("thesis", "derived")
    ),
    closed={
        Maximise: plane_thesis_limited,
        Limited: plane_thesis_limited,
        Weighted: plane_thesis_weighted,
        Pareto: plane_thesis_pareto,
    },
    batch=(Maximise, Limited),
    kernel=PlaneThesis,
)
