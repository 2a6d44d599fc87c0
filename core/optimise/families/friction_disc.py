"""Candidates for the best drive of block and cylinder under the friction disc.

All in units of the drive acceleration P: k = c/P, g = G/P.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.optimise.codes import ACTIVE, STATUS
from vibrafeed.core.optimise.families.optimum import (
    Optimum,
    bounds_active,
    broadcast,
    optimum,
    statuses,
    tight,
    valid_inputs,
)

Candidate = tuple[Array, Array, Array, Mask]
"""alpha, beta, 1 where static friction still holds there, and whether it is a candidate."""

Accelerate = Callable[[tuple[Array, Array], Array, Array], tuple[Array, Array]]
"""Takes the drive in the plane less gravity, the floor's n0 and mu; returns a_x and a_y."""

Turned = Callable[[Array, Array, Array, Array], Candidate]
"""Takes k, g, mu and the static mu; returns the best drive from the side."""


def _straight(k: Array, g: Array, mu: Array, mu_s: Array) -> tuple[Candidate, Candidate]:
    """Return two drives along the track: the best one that slips, and the edge of stick.

    Each is azimuth alpha, 0, and elevation beta [rad], a mark that is 1 where static friction still
    holds, and True where it is a candidate.

    Parameters
    ----------
    k, g : ndarray
        Gravity along the track (backwards) and onto the floor, in units of the drive acceleration
        P.
    mu, mu_s : ndarray
        Kinetic and static friction coefficients.
    """
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
    [rad], a_x and a_y [m/s2], binding constraints and a status. All candidates are closed forms or
    iterations of few steps; the best in each cell is taken.

    Parameters
    ----------
    vibration_acceleration, gravity_along, gravity_normal : array_like
        P, and gravity along -x and onto the floor [m s-2].
    friction_kinetic, friction_static : array_like
        Friction coefficients.
    turned, held : callable
        Return the best drive from the side for a sliding part, and at the edge of stick, from k, g,
        mu and mu_s: gravity in units of P, and friction.
    accelerate : callable
        Returns a_x and a_y of a sliding part.
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
    active = bounds_active(alpha, beta) | tight(ACTIVE["floor"], G - P * np.sin(beta), P + G)
    active |= np.where(at_edge > 0, ACTIVE["start"], 0).astype(np.int16)
    still = status == STATUS["no_motion"]
    flat = status == STATUS["flat"]
    along, across = np.where(flat, idle, along), np.where(flat, 0.0, across)
    alpha, beta, along, across = (
        np.where(still, np.nan, part) for part in (alpha, beta, along, across)
    )
    return optimum(alpha, beta, along, across, np.where(still, 0, active).astype(np.int16), status)
