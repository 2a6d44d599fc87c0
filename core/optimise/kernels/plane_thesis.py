"""Compiled answers of the printed formulas of part and plane (theory 12.1).

a_x = P cb ca - c - mu n0 and a_y = P cb sa - mu n0, n0 = G - P sb: linear in the drive direction.
In units of P, k = c/P and g = G/P.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.kernels.columns import (
    ALONG,
    LIMIT,
    MU_K,
    NORMAL,
    OBJECTIVE,
    P_,
    Best,
    Numbers,
    PlaneThesis,
    Work,
)
from vibrafeed.core.optimise.kernels.conditions import across, bounds
from vibrafeed.core.optimise.kernels.sphere import angles_within, highest, plane


@compiled
def idle(kept: PlaneThesis, p: Numbers) -> tuple[float, float, float]:
    """Return a_x = -mu G - c and a_y = -mu G without drive; the wall margin is NaN.

    G and c are gravity onto the floor and along -x [m s-2].
    """
    friction = -p[MU_K] * p[NORMAL]
    return friction - p[ALONG], friction, math.nan


@compiled
def best(kept: PlaneThesis, p: Numbers, work: Work) -> Best:
    """Return status, alpha and beta of the drive with the largest a_x on a plane, printed friction.

    a_x grows with d_x + mu d_z for the drive direction d, and |d_y + mu d_z - mu g| <= e keeps
    |a_y| within its limit: g is gravity onto the floor and e the limit, in units of the drive
    acceleration P.

    `kept` has the contacts to keep; `p` are the inputs of one design, in the columns `P_` to
    `BETA_HI`, SI units and radians; the arrays of `work` are overwritten. The result says, too, if
    there are such angles [rad].
    """
    k, g, mu, e = p[ALONG] / p[P_], p[NORMAL] / p[P_], p[MU_K], p[LIMIT] / p[P_]
    A, b, u = work.planes, work.levels, work.upwards
    rows = angles_within(p, kept.floor, A, b)
    if e < math.inf:
        rows = plane(A, b, rows, 0.0, 1.0, mu, mu * g + e)
        rows = plane(A, b, rows, 0.0, -1.0, -mu, e - mu * g)
    u[0], u[1], u[2] = 1.0, 0.0, mu
    return highest(p[P_], -k - mu * g, rows, work)


@compiled
def gradients(kept: PlaneThesis, p: Numbers, alpha: float, beta: float, work: Work) -> None:
    """Fill `work` with a_x, a_y, their gradients over the drive angles, and margins.

    It is for a part on a plane with the printed friction: a_x = d_x - k - mu n, a_y = d_y - mu n,
    where d is the drive, k gravity along -x and n the normal force; all in units of the drive
    acceleration P. A margin is the distance to a limit, negative beyond.

    `kept` chooses these formulas by its type; `p` are the inputs of one design, in the columns `P_`
    to `BETA_HI`; `alpha` and `beta` are azimuth and elevation [rad].
    """
    F, slopes, k, mu = work.values, work.slopes, p[ALONG] / p[P_], p[MU_K]
    bounds(p, alpha, beta, math.nan, F, slopes, work.margins)
    ca, sa, q, dz = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    dx, dy = q * ca, q * sa
    n = F[2]
    F[0], F[1] = dx - k - mu * n, dy - mu * n
    slopes[OBJECTIVE, 0], slopes[OBJECTIVE, 1] = -dy, -dz * ca + mu * q
    across(p, F, dx, -dz * sa + mu * q, slopes, work.margins)
