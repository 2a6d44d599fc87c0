"""Values, margins and slopes at an answer, and what the conditions of an optimum leave there."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.optimise.kernels.columns import (
    ACROSS,
    ACROSS_LOWER,
    ACROSS_UPPER,
    ALONG,
    ALPHA_HI,
    ALPHA_LO,
    ALPHA_LOWER,
    ALPHA_UPPER,
    BETA_HI,
    BETA_LO,
    BETA_LOWER,
    BETA_UPPER,
    FLOOR,
    LIMIT,
    MU_K,
    MU_S,
    NORMAL,
    OBJECTIVE,
    P_,
    PLANE_PHYSICAL,
    PLANE_THESIS,
    START,
    TRACK_PHYSICAL,
    TRACK_THESIS,
    WALL,
    Numbers,
)  # fmt: skip


@compiled
def gradients(
    problem: int, p: Numbers, alpha: float, beta: float, F: Numbers, slopes: Numbers,
    margins: Numbers,
) -> None:  # fmt: skip
    """Fill value, a_y, their gradients and the margins of all constraints with theirs.

    F: a_x or K, a_y, n0, wall margin. `slopes` rows: 0 objective, then the constraints in the
    order of their bits; `margins` alike. In units of P.
    """
    k, y, g = p[ALONG] / p[P_], p[ACROSS] / p[P_], p[NORMAL] / p[P_]
    mu, mu_s, e = p[MU_K], p[MU_S], p[LIMIT] / p[P_]
    ca, sa, q, dz = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    dx, dy = q * ca, q * sa
    slopes[:] = 0.0
    margins[ALPHA_LOWER], slopes[ALPHA_LOWER, 0] = alpha - p[ALPHA_LO], 1.0
    margins[ALPHA_UPPER], slopes[ALPHA_UPPER, 0] = p[ALPHA_HI] - alpha, -1.0
    margins[BETA_LOWER], slopes[BETA_LOWER, 1] = beta - p[BETA_LO], 1.0
    margins[BETA_UPPER], slopes[BETA_UPPER, 1] = p[BETA_HI] - beta, -1.0
    n = g - dz
    margins[FLOOR], slopes[FLOOR, 1] = n, -q
    room = -y if problem == TRACK_THESIS else y
    margins[WALL], slopes[WALL, 0], slopes[WALL, 1] = room - dy, -dx, dz * sa
    margins[START] = math.inf
    F[2], F[3] = n, room - dy
    if problem == PLANE_PHYSICAL:
        X, Y, m = dx - k, dy, mu * n
        R = math.hypot(X, Y)
        Ra, Rb = k * Y / R, -dz * (q - k * ca) / R
        rest, rest_a = 1.0 - m / R, m * Ra / (R * R)
        rest_b = mu * q / R + m * Rb / (R * R)
        F[0], F[1] = X * rest, Y * rest
        slopes[OBJECTIVE, 0], slopes[OBJECTIVE, 1] = (
            -dy * rest + X * rest_a,
            -dz * ca * rest + X * rest_b,
        )
        ay_a, ay_b = dx * rest + Y * rest_a, -dz * sa * rest + Y * rest_b
        if mu_s > mu:
            margins[START], slopes[START, 0], slopes[START, 1] = R - mu_s * n, Ra, Rb + mu_s * q
    elif problem == PLANE_THESIS:
        F[0], F[1] = dx - k - mu * n, dy - mu * n
        slopes[OBJECTIVE, 0], slopes[OBJECTIVE, 1] = -dy, -dz * ca + mu * q
        ay_a, ay_b = dx, -dz * sa + mu * q
    else:
        F[0], F[1] = dx - k - mu * (room - dy), 0.0
        slopes[OBJECTIVE, 0], slopes[OBJECTIVE, 1] = -dy + mu * dx, -dz * (ca + mu * sa)
        ay_a = ay_b = 0.0
        if problem == TRACK_PHYSICAL:
            F[0] -= mu * n
            slopes[OBJECTIVE, 1] += mu * q
            if mu_s > mu:
                margins[START] = dx - k - mu_s * (n + room - dy)
                slopes[START, 0], slopes[START, 1] = (
                    -dy + mu_s * dx,
                    -dz * (ca + mu_s * sa) + mu_s * q,
                )
    margins[ACROSS_LOWER], slopes[ACROSS_LOWER, 0], slopes[ACROSS_LOWER, 1] = F[1] + e, ay_a, ay_b
    margins[ACROSS_UPPER], slopes[ACROSS_UPPER, 0], slopes[ACROSS_UPPER, 1] = e - F[1], -ay_a, -ay_b


@compiled
def least_prices(slopes: Numbers, active: NDArray[np.int64], count: int, prices: Numbers) -> float:
    """Return the residual of the conditions of an optimum, and fill the multipliers.

    The objective's gradient must be a combination, with no negative weight, of at most two of the
    active constraints' gradients, negated; the combination with the least remainder is taken.
    """
    fx, fy = slopes[OBJECTIVE, 0], slopes[OBJECTIVE, 1]
    least = math.hypot(fx, fy)
    prices[:] = 0.0
    one, two, w1, w2 = -1, -1, 0.0, 0.0
    for i in range(count):
        ax, ay = -slopes[active[i], 0], -slopes[active[i], 1]
        square = ax * ax + ay * ay
        if square <= 0:
            continue
        weight = (fx * ax + fy * ay) / square
        if weight >= 0:
            rest = math.hypot(fx - weight * ax, fy - weight * ay)
            # A second multiplier has to earn its place; so has the first.
            if rest < least - 1e-15:
                least, one, two, w1, w2 = rest, active[i], -1, weight, 0.0
    for i in range(count):
        ax, ay = -slopes[active[i], 0], -slopes[active[i], 1]
        for j in range(i):
            bx, by = -slopes[active[j], 0], -slopes[active[j], 1]
            area = ax * by - ay * bx
            if abs(area) <= 1e-12:
                continue
            v1, v2 = (fx * by - fy * bx) / area, (ax * fy - ay * fx) / area
            if v1 >= 0 and v2 >= 0:
                rest = math.hypot(fx - v1 * ax - v2 * bx, fy - v1 * ay - v2 * by)
                if rest < least - 1e-12:
                    least, one, two, w1, w2 = rest, active[i], active[j], v1, v2
    if one >= 0:
        prices[one] = w1
    if two >= 0:
        prices[two] = w2
    return least
