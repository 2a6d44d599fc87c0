"""Compiled answers of the printed forces of the track (theory 4.2, 12).

K = P (cb ca + mu cb sa) - c - mu g_y: linear in the drive direction d. The source prints g_y with
the other sign. In units of P, k = c/P and y = +-g_y/P, which is the room at the wall.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.kernels.columns import (
    ACROSS,
    ALONG,
    MU_K,
    OBJECTIVE,
    P_,
    Best,
    Numbers,
    TrackPrinted,
    Work,
)
from vibrafeed.core.optimise.kernels.conditions import bounds
from vibrafeed.core.optimise.kernels.sphere import angles_within, highest, plane


@compiled
def idle(kept: TrackPrinted, p: Numbers) -> tuple[float, float, float]:
    """Return K = -c - mu g_y without drive, a_y = 0, and the room at the wall.

    c is gravity along -x, g_y that towards the wall, with the sign of the printed balance [m s-2].
    """
    wall_margin = kept.side * p[ACROSS]
    return -p[ALONG] - p[MU_K] * wall_margin, 0.0, wall_margin


@compiled
def best(kept: TrackPrinted, p: Numbers, work: Work) -> Best:
    """Return status, alpha and beta of the drive with the largest K on the track, printed forces.

    K, the acceleration along the track at rest, grows with d_x + mu d_y for the drive direction d,
    which is the highest point of the unit sphere within planes: the bounds of the angles and the
    contacts to keep. With the wall d_y <= y, where P y is the force per mass with which gravity
    presses the part onto it. The result says, too, if there are such angles [rad].

    Parameters
    ----------
    kept : TrackPrinted
        The contacts to keep.
    p : ndarray
        Inputs of one design in the columns `P_` to `BETA_HI`, SI units and radians.
    work : Work
        Arrays that are overwritten.
    """
    wall_margin, mu, u = kept.side * (p[ACROSS] / p[P_]), p[MU_K], work.upwards
    rows = angles_within(p, kept.floor, work.planes, work.levels)
    if kept.wall:
        rows = plane(work.planes, work.levels, rows, 0.0, 1.0, 0.0, wall_margin)
    u[0], u[1], u[2] = 1.0, mu, 0.0
    return highest(p[P_], -(p[ALONG] / p[P_]) - mu * wall_margin, rows, work)


@compiled
def gradients(kept: TrackPrinted, p: Numbers, alpha: float, beta: float, work: Work) -> None:
    """Fill `work` with K, its gradient over the drive angles, and margins, for printed forces.

    K = d_x - k - mu (y - d_y) is the acceleration along the track at rest, in units of the drive
    acceleration P: d is the drive direction, k gravity along -x, y gravity towards the wall, which
    the wall's margin is made of. A margin is the distance to a limit, negative beyond.

    `kept` has the sign with which the source prints y; `p` are the inputs of one design, in the
    columns `P_` to `BETA_HI`; `alpha` and `beta` are azimuth and elevation [rad].
    """
    F, slopes, mu = work.values, work.slopes, p[MU_K]
    bounds(p, alpha, beta, kept.side * (p[ACROSS] / p[P_]), F, slopes, work.margins)
    q, dz = math.cos(beta), math.sin(beta)
    dx, dy = q * math.cos(alpha), q * math.sin(alpha)
    F[0], F[1] = dx - p[ALONG] / p[P_] - mu * F[3], 0.0
    slopes[OBJECTIVE, 0] = -dy + mu * dx
    slopes[OBJECTIVE, 1] = -dz * (math.cos(alpha) + mu * math.sin(alpha))
