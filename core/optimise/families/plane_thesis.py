"""The printed formulas of part and plane: constant friction towards -y (theory 12.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.optimise.families.family import (
    Family,
    Optimum,
    ParetoSet,
    broadcast,
    optimum,
    statuses,
    valid_inputs,
)
from vibrafeed.core.study.optimise_study import Limited, Maximise, Pareto, Weighted
from vibrafeed.core.study.values import evenly


def plane_thesis_limited(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    limit: ArrayLike,
    floor_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest a_x with |a_y| <= limit on a plane, printed friction.

    The source's friction acts along x and y at once (theory 12.1). Without a limit alpha = 0, beta
    = atan(mu), or with `floor_contact` (the part stays on the floor) at most the lift-off angle
    asin(G/P). If asin(G/P) <= atan(mu): alpha = 0; beta is the lift-off angle, where a_y = 0, or
    without `floor_contact` sin(beta) = min((G + limit/mu)/P, sin(atan mu)). Else alpha = 0, beta =
    atan(mu) while a_y >= -limit there, then the point of a_y = -limit on the curve tan(beta) = mu
    (cos(alpha) + sin(alpha)). It lies within 90 deg while P sqrt(1 + mu^2) >= mu G - limit; else
    `infeasible`.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x and
    onto the floor, G, and `limit` is in m/s2, too; `friction_kinetic` is mu; they broadcast. The
    result has the angles [rad], a_x and a_y [m/s2] and a status.
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
    return optimum(alpha, beta, along, across, status)


def plane_thesis_weighted(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    weight: ArrayLike,
    floor_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest a_x - w |a_y| on a plane with the printed friction.

    The source's friction acts along x and y at once (theory 12.1); the best angles are then a
    closed form. The objective is linear in the direction of the drive where a_y < 0, with the
    gradient (1, w, mu (1 + w)). If asin(G/P) > atan(mu), the best is tan(alpha) = w, tan(beta) = mu
    (cos(alpha) + sin(alpha)), up to the alpha at which a_y = 0. Else alpha = 0 and beta =
    max(asin(G/P), atan(mu (1 - w))).

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x and
    onto the floor, G [m/s2], `friction_kinetic` is mu and `weight` w; they broadcast. With
    `floor_contact` the part has to stay on the floor, beta <= asin(G/P). The result has the angles
    [rad], a_x and a_y [m/s2] and a status.
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
    return optimum(alpha, beta, along, across, status)


def plane_thesis_pareto(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    floor_contact: bool,
    points: int,
) -> ParetoSet:
    """Return `points` points of the trade-off between a_x and |a_y| on a plane, printed friction.

    The source's friction acts along x and y at once (theory 12.1). Points go from the largest a_x
    to the least |a_y|. If asin(G/P) <= atan(mu), alpha = 0 and beta goes from atan(mu) down to
    asin(G/P), or with `floor_contact`, where a part must not lift off, is asin(G/P) in all points.
    Else they lie on the curve tan(beta) = mu (cos(alpha) + sin(alpha)), alpha evenly spaced from 0
    to where a_y = 0, or to 90 deg.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x and
    onto the floor, G [m/s2], `friction_kinetic` is mu; they broadcast. The result has the angles
    [rad], a_x and a_y [m/s2], the points along a last axis, and a status.
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
    friction = mu * (G - P * np.sin(beta))
    push = P * np.cos(beta)
    return push * np.cos(alpha) - c - friction, push * np.sin(alpha) - friction


def _curve_beta(alpha: Array, mu: Array) -> Array:
    return np.asarray(np.arctan(mu * (np.cos(alpha) + np.sin(alpha))))


def _on_curve(level: Array, mu: Array) -> tuple[Array, Array]:
    A2 = 1.0 + mu * mu
    A = np.hypot(1.0, mu)
    s = np.minimum(level / A, 1.0)
    x = np.sqrt((1 - s) * (1 + s)) * np.sqrt(A2 / (1 + 2 * mu * mu))
    y = s / A - x * (mu * mu / A2)
    alpha = np.clip(np.arctan2(y, x), 0.0, np.pi / 2)
    return alpha, _curve_beta(alpha, mu)


def _alpha_max(g: Array, mu: Array) -> Array:
    return _on_curve(np.minimum(mu * g, np.hypot(1.0, mu)), mu)[0]


FAMILY = Family(
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
)
