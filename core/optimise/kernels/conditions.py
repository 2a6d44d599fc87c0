"""Margins that all families share, and what the conditions of an optimum leave at an answer."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.kernels.columns import (
    ACROSS_LOWER,
    ACROSS_UPPER,
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
    NORMAL,
    OBJECTIVE,
    P_,
    START,
    WALL,
    Numbers,
)  # fmt: skip


@compiled
def bounds(
    p: Numbers,
    alpha: float,
    beta: float,
    wall_margin: float,
    F: Numbers,
    slopes: Numbers,
    margins: Numbers,
) -> None:
    """Fill margins and gradients of the bounds of drive angles, and of floor and wall contact.

    All are in units of the drive acceleration P. n0 = g - sin(beta) on the floor, with g gravity
    onto it; wall_margin - cos(beta) sin(alpha) at the wall. Margins of the other constraints are
    set to infinity.

    Parameters
    ----------
    p : ndarray, shape (GROUPS,)
        The inputs of a design: drive, gravity, friction, limit, bounds (`P_` to `BETA_HI`).
    alpha, beta : float
        Angles of the drive [rad].
    wall_margin : float
        Load of the wall without drive; NaN without a wall.
    F : ndarray, shape (4,)
        a_x or K, a_y, n0 and margin of the wall; the last two are filled.
    slopes, margins : ndarray, shape (CONSTRAINTS, 2) and (CONSTRAINTS,)
        Filled: a row for the objective, then for the constraints in the order of their bits.
    """
    q, dz = math.cos(beta), math.sin(beta)
    sine = math.sin(alpha)
    slopes[:] = 0.0
    margins[ALPHA_LOWER], slopes[ALPHA_LOWER, 0] = alpha - p[ALPHA_LO], 1.0
    margins[ALPHA_UPPER], slopes[ALPHA_UPPER, 0] = p[ALPHA_HI] - alpha, -1.0
    margins[BETA_LOWER], slopes[BETA_LOWER, 1] = beta - p[BETA_LO], 1.0
    margins[BETA_UPPER], slopes[BETA_UPPER, 1] = p[BETA_HI] - beta, -1.0
    F[2], F[3] = p[NORMAL] / p[P_] - dz, wall_margin - q * sine
    margins[FLOOR], slopes[FLOOR, 1] = F[2], -q
    margins[WALL], slopes[WALL, 0], slopes[WALL, 1] = F[3], -(q * math.cos(alpha)), dz * sine
    margins[ACROSS_LOWER] = margins[ACROSS_UPPER] = margins[START] = math.inf


@compiled
def across(
    p: Numbers, F: Numbers, by_alpha: float, by_beta: float, slopes: Numbers, margins: Numbers
) -> None:
    """Fill the margins of |a_y| <= limit and their gradients over the drive angles.

    All are in units of the drive acceleration P.

    Parameters
    ----------
    p : ndarray
        Inputs of a design in the columns `P_` to `BETA_HI`.
    F : ndarray, shape (4,)
        a_y is `F[1]`.
    by_alpha, by_beta : float
        Derivatives of a_y.
    slopes, margins : ndarray, shape (CONSTRAINTS, 2) and (CONSTRAINTS,)
        Filled in the two rows of this limit.
    """
    e = p[LIMIT] / p[P_]
    margins[ACROSS_LOWER], margins[ACROSS_UPPER] = F[1] + e, e - F[1]
    slopes[ACROSS_LOWER, 0], slopes[ACROSS_LOWER, 1] = by_alpha, by_beta
    slopes[ACROSS_UPPER, 0], slopes[ACROSS_UPPER, 1] = -by_alpha, -by_beta


@compiled
def least_prices(slopes: Numbers, active: NDArray[np.int64], count: int, prices: Numbers) -> float:
    """Fill in the Lagrange multipliers at a point; return the residual, 0 at an optimum.

    At an optimum the gradient of the objective is balanced by those of the constraints that bind: a
    combination of at most two of them, as there are two variables, without negative weights. The
    one with the least remainder is taken; a second constraint is used only if it reduces the
    remainder.

    Parameters
    ----------
    slopes : ndarray, shape (rows, 2)
        Gradients of the objective (row `OBJECTIVE`) and of the constraints over the two variables.
    active : ndarray of int
        The rows of the constraints that bind; the first `count` entries count.
    prices : ndarray
        The multipliers, by row; all are overwritten.
    """
    fx, fy = slopes[OBJECTIVE, 0], slopes[OBJECTIVE, 1]
    least = math.hypot(fx, fy)
    prices[:] = 0.0
    first, second, w1, w2 = -1, -1, 0.0, 0.0
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
                least, first, second, w1, w2 = rest, active[i], -1, weight, 0.0
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
                    least, first, second, w1, w2 = rest, active[i], active[j], v1, v2
    if first >= 0:
        prices[first] = w1
    if second >= 0:
        prices[second] = w2
    return least
