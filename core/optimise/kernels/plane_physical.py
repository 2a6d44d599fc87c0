"""Compiled answers of the block with the friction disc (theory 12.2).

D = (P cb ca - c, P cb sa) is the drive in the plane less gravity, R its length. Sliding from rest,
a = D (1 - mu n0/R) with n0 = G - P sb. In units of P, k = c/P and g = G/P. The search is in `disc`.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.kernels.columns import (
    ALONG,
    INFEASIBLE,
    MU_K,
    MU_S,
    NO_MOTION,
    NORMAL,
    OBJECTIVE,
    P_,
    START,
    Best,
    Numbers,
    PlanePhysical,
    Work,
)
from vibrafeed.core.optimise.kernels.conditions import across, bounds
from vibrafeed.core.optimise.kernels.disc import best_along


@compiled
def idle(kept: PlanePhysical, p: Numbers) -> tuple[float, float, float]:
    """Return a_x = -c + sign(c) mu G without drive, or 0 where static friction holds, and a_y = 0.

    c and G are gravity along -x and onto the floor [m s-2]; the third result, the wall margin, is
    NaN.
    """
    c, G = p[ALONG], p[NORMAL]
    slides = abs(c) > p[MU_S] * G
    return -c + math.copysign(p[MU_K] * G, c) if slides else 0.0, 0.0, math.nan


@compiled
def best(kept: PlanePhysical, p: Numbers, work: Work) -> Best:
    """Return status, alpha and beta of the drive with the largest a_x of a part on a plane.

    a_x = D_x (1 - mu n/R), where D is the drive in the plane less gravity, R its length, and n the
    normal force per mass; the part has to stay on the floor. `kept` chooses these formulas by its
    type; `p` are the inputs of one design, in the columns `P_` to `BETA_HI`, SI units and radians;
    the arrays of `work` are overwritten. The result says, too, if there are such angles [rad].
    """
    status = best_along(p, work.betas, work.heights, work.rises, work.direction)
    if status in (INFEASIBLE, NO_MOTION):
        return Best(status, False, math.nan, math.nan)
    return Best(status, True, work.direction[0], work.direction[1])


@compiled
def gradients(kept: PlanePhysical, p: Numbers, alpha: float, beta: float, work: Work) -> None:
    """Fill `work` with a_x, a_y, their gradients over the drive angles, and margins.

    It is for a part on a plane with the friction disc: a = (X, Y) (1 - m/R) with m = mu n, n the
    normal force per mass; X = q ca - k, Y = q sa, q = cb, R = |(X, Y)|; ca, sa, cb, sb are cosines
    and sines of azimuth and elevation, k gravity along -x, all in units of the drive acceleration
    P. dR/dalpha = k Y/R, dR/dbeta = -sb (q - k ca)/R. Static friction just holds where R = mu_s n.
    A margin is the distance to a limit, negative beyond.

    `kept` chooses these formulas by its type; `p` are the inputs of one design, in the columns `P_`
    to `BETA_HI`; `alpha` and `beta` are the angles [rad].
    """
    F, slopes, margins = work.values, work.slopes, work.margins
    k, mu, mu_s = p[ALONG] / p[P_], p[MU_K], p[MU_S]
    bounds(p, alpha, beta, math.nan, F, slopes, margins)
    ca, sa, q, dz = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    dx, dy = q * ca, q * sa
    n = F[2]
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
    across(p, F, dx * rest + Y * rest_a, -dz * sa * rest + Y * rest_b, slopes, margins)
    if mu_s > mu:
        margins[START], slopes[START, 0], slopes[START, 1] = R - mu_s * n, Ra, Rb + mu_s * q
