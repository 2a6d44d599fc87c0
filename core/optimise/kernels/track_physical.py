"""Compiled answers of the block on the track, on floor and wall (theory 4.4, 12).

K_0 = P cb ca - c - mu (g_z - P sb + g_y - P cb sa), and the same with mu_s for mu positive: linear
in the drive direction d. In units of P, k = c/P, y = g_y/P and g = g_z/P.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.codes import TIGHT
from vibrafeed.core.optimise.kernels.columns import (
    ACROSS,
    ALONG,
    INFEASIBLE,
    MU_K,
    MU_S,
    NO_MOTION,
    NORMAL,
    NOT_ATTAINED,
    OBJECTIVE,
    OPTIMAL,
    P_,
    START,
    Best,
    Numbers,
    TrackPhysical,
    Work,
)
from vibrafeed.core.optimise.kernels.conditions import bounds
from vibrafeed.core.optimise.kernels.sphere import angles_of, angles_within, plane, top_of_pieces


@compiled
def idle(kept: TrackPhysical, p: Numbers) -> tuple[float, float, float]:
    """Return K_0 = -c - mu (g_y + g_z) without drive, a_y = 0, and the room at the wall.

    c, g_y and g_z are gravity along -x, towards the wall and onto the floor [m s-2].
    """
    wall_margin = p[ACROSS]
    return -p[ALONG] - p[MU_K] * (wall_margin + p[NORMAL]), 0.0, wall_margin


@compiled
def best(kept: TrackPhysical, p: Numbers, work: Work) -> Best:
    """Return status, alpha and beta of the drive with the largest a_x at rest on the track.

    a_x grows with d_x + mu (d_y + d_z) for the drive direction d; floor and wall are kept if d_y <=
    y and d_z <= g, where y and g are gravity towards the wall and onto the floor, k that along -x,
    in units of the drive acceleration P. The part starts if d_x + mu_s (d_y + d_z) > k + mu_s (y +
    g) somewhere; to keep it moving is one more plane that limits d.

    `kept` chooses these formulas by its type; `p` are the inputs of one design, in the columns `P_`
    to `BETA_HI`, SI units and radians; the arrays of `work` are overwritten. The result says, too,
    if there are such angles [rad].
    """
    k, y, g = p[ALONG] / p[P_], p[ACROSS] / p[P_], p[NORMAL] / p[P_]
    mu, mu_s = p[MU_K], p[MU_S]
    A, b, u, d = work.planes, work.levels, work.upwards, work.direction
    rows = angles_within(p, True, A, b)
    rows = plane(A, b, rows, 0.0, 1.0, 0.0, y)
    u[0], u[1], u[2] = 1.0, mu_s, mu_s
    if not top_of_pieces(u, A, b, rows, d):
        return Best(INFEASIBLE, False, math.nan, math.nan)
    needed = k + mu_s * (y + g)
    if d[0] + mu_s * (d[1] + d[2]) <= needed:
        return Best(NO_MOTION, False, math.nan, math.nan)
    u[1] = u[2] = mu
    if mu_s > mu:
        rows = plane(A, b, rows, -1.0, -mu_s, -mu_s, -needed)
    top_of_pieces(u, A, b, rows, d)
    held = needed - d[0] - mu_s * (d[1] + d[2])
    alpha, beta = angles_of(d)
    status = NOT_ATTAINED if mu_s > mu and held > -TIGHT else OPTIMAL
    return Best(status, True, alpha, beta)


@compiled
def gradients(kept: TrackPhysical, p: Numbers, alpha: float, beta: float, work: Work) -> None:
    """Fill `work` with K_0, its gradient over the drive angles, and margins, for the track.

    K_0 = d_x - k - mu (n + w) is the acceleration along the track at rest, in units of the drive
    acceleration P: d is the drive direction, k gravity along -x; n = g - d_z and w = y - d_y are
    the loads of floor and wall, with gravity g onto the floor and y towards the wall. Static
    friction just holds where d_x - k = mu_s (n + w). A margin is the distance to a limit, negative
    beyond.

    `kept` chooses these formulas by its type; `p` are the inputs of one design, in the columns `P_`
    to `BETA_HI`; `alpha` and `beta` are azimuth and elevation [rad].
    """
    F, slopes, margins = work.values, work.slopes, work.margins
    k, mu, mu_s = p[ALONG] / p[P_], p[MU_K], p[MU_S]
    wall_margin = p[ACROSS] / p[P_]
    bounds(p, alpha, beta, wall_margin, F, slopes, margins)
    ca, sa, q, dz = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    dx, dy = q * ca, q * sa
    n = F[2]
    F[0], F[1] = dx - k - mu * (wall_margin - dy) - mu * n, 0.0
    slopes[OBJECTIVE, 0] = -dy + mu * dx
    slopes[OBJECTIVE, 1] = -dz * (ca + mu * sa) + mu * q
    if mu_s > mu:
        margins[START] = dx - k - mu_s * (n + wall_margin - dy)
        slopes[START, 0], slopes[START, 1] = (
            -dy + mu_s * dx,
            -dz * (ca + mu_s * sa) + mu_s * q,
        )
