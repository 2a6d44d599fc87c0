"""Compiled batch solver of the drive angles; see `vibrafeed.core.optimise.newton`.

Everything is divided by the drive acceleration P. A family has three functions, in a file of its
own: what holds without drive, the best angles, and the gradients there. Which one is meant the
compiler sees from the type of `kept`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiled import by_type, compiled
from vibrafeed.core.optimise.codes import TIGHT
from vibrafeed.core.optimise.kernels import (
    plane_physical,
    plane_thesis,
    track_physical,
    track_printed,
)
from vibrafeed.core.optimise.kernels.columns import (
    ACROSS,
    ACROSS_LOWER,
    ACROSS_UPPER,
    ALONG,
    ALPHA,
    ALPHA_HI,
    ALPHA_LO,
    BETA,
    BETA_HI,
    BETA_LO,
    CONSTRAINTS,
    CROSS,
    FLAT,
    FLOOR,
    GROUPS,
    INFEASIBLE,
    INVALID,
    KEPT,
    LIMIT,
    MARGIN_ACROSS,
    MARGIN_FLOOR,
    MARGIN_WALL,
    MU_K,
    MU_S,
    NORMAL,
    P_,
    PRICE_ACROSS,
    PRICE_FLOOR,
    PRICE_WALL,
    RESIDUAL,
    TINY,
    VALUE,
    WALL,
    Best,
    Kept,
    Numbers,
    PlanePhysical,
    PlaneThesis,
    TrackPhysical,
    TrackPrinted,
    Work,
)
from vibrafeed.core.optimise.kernels.conditions import least_prices
from vibrafeed.core.optimise.kernels.disc import RIGHT, SAMPLES
from vibrafeed.core.optimise.kernels.sphere import ROWS


@by_type(
    "kept",
    {
        PlaneThesis: plane_thesis.idle,
        PlanePhysical: plane_physical.idle,
        TrackPrinted: track_printed.idle,
        TrackPhysical: track_physical.idle,
    },
)
def idle(kept: Kept, p: Numbers) -> tuple[float, float, float]:
    """Return objective, a_y and wall margin without drive; NaN for what does not exist.

    `kept` is the family with the contacts to keep; `p` are the inputs of a design: drive, gravity,
    friction, limit and bounds, in the columns `P_` to `BETA_HI`.
    """
    raise NotImplementedError


@by_type(
    "kept",
    {
        PlaneThesis: plane_thesis.best,
        PlanePhysical: plane_physical.best,
        TrackPrinted: track_printed.best,
        TrackPhysical: track_physical.best,
    },
)
def best(kept: Kept, p: Numbers, work: Work) -> Best:
    """Return status and best angles of a design.

    `kept` is the family with the contacts to keep; `p` are the inputs of the design: drive,
    gravity, friction, limit and bounds, in the columns `P_` to `BETA_HI`. `work` holds working
    arrays.
    """
    raise NotImplementedError


@by_type(
    "kept",
    {
        PlaneThesis: plane_thesis.gradients,
        PlanePhysical: plane_physical.gradients,
        TrackPrinted: track_printed.gradients,
        TrackPhysical: track_physical.gradients,
    },
)
def gradients(kept: Kept, p: Numbers, alpha: float, beta: float, work: Work) -> None:
    """Fill values, gradients and margins in `work` at given angles alpha and beta [rad]."""
    raise NotImplementedError


@compiled
def _is_valid(p: Numbers) -> bool:
    """True if all inputs of a design are finite and in range; only the limit may be infinite.

    `p` has them in the columns `P_` to `BETA_HI`, SI units and radians.
    """
    for i in range(GROUPS):
        if not math.isfinite(p[i]) and not (i == LIMIT and p[i] == math.inf):
            return False
    return (
        p[P_] >= 0
        and p[MU_K] >= 0
        and p[MU_S] >= p[MU_K]
        and p[LIMIT] >= 0
        and p[ALPHA_HI] - p[ALPHA_LO] <= 2 * RIGHT + KEPT
        and p[BETA_LO] >= -RIGHT
        and p[BETA_HI] <= RIGHT
    )


@compiled
def _without_drive(kept: Kept, p: Numbers, row: Numbers) -> int:
    """Return the status of a design without drive, where all angles are equal; fill its results.

    `kept` has the contacts to keep, `p` are the inputs of the design in the columns `P_` to
    `BETA_HI`, and `row` is its row in the table of results. The status is `FLAT`, or `INFEASIBLE`
    if gravity alone breaks a limit.
    """
    value, across, wall_margin = idle(kept, p)
    lost = (kept.floor and p[NORMAL] < 0) or (kept.wall and wall_margin < 0)
    if lost or abs(across) > p[LIMIT]:
        return INFEASIBLE
    row[ALPHA], row[BETA], row[VALUE], row[CROSS] = p[ALPHA_LO], p[BETA_LO], value, across
    row[MARGIN_ACROSS], row[MARGIN_FLOOR] = p[LIMIT] - abs(across), p[NORMAL]
    row[MARGIN_WALL] = wall_margin
    row[PRICE_ACROSS] = row[PRICE_FLOOR] = row[PRICE_WALL] = row[RESIDUAL] = 0.0
    return FLAT


@compiled
def _at_best(kept: Kept, p: Numbers, alpha: float, beta: float, work: Work, row: Numbers) -> int:
    """Return the bits of the constraints that bind at a design's best angles; fill its results.

    `kept` has the contacts to keep, `p` are the inputs of the design in the columns `P_` to
    `BETA_HI`; `alpha` and `beta` are the best angles [rad]. `row` is the design's row in the table
    of results, filled with angles, a_x, a_y, margins, multipliers and the residual of optimality;
    `work` has arrays that are overwritten.
    """
    gradients(kept, p, alpha, beta, work)
    bits, count, prices = 0, 0, work.prices
    for i in range(1, CONSTRAINTS):
        asked = (i != FLOOR or kept.floor) and (i != WALL or kept.wall)
        if asked and work.margins[i] <= TIGHT * (1 + p[NORMAL] / p[P_]):
            bits |= 1 << (i - 1)
            work.tight[count] = i
            count += 1
    row[RESIDUAL] = least_prices(work.slopes, work.tight, count, prices)
    P, F = p[P_], work.values
    row[ALPHA], row[BETA] = alpha, beta
    row[VALUE], row[CROSS] = P * F[0], P * F[1]
    row[MARGIN_ACROSS] = p[LIMIT] - abs(P * F[1])
    row[MARGIN_FLOOR], row[MARGIN_WALL] = P * F[2], P * F[3]
    row[PRICE_ACROSS] = prices[ACROSS_LOWER] + prices[ACROSS_UPPER]
    row[PRICE_FLOOR], row[PRICE_WALL] = prices[FLOOR], prices[WALL]
    return bits


@compiled
def solve(
    kept: Kept, groups: Numbers, table: Numbers, active: NDArray[np.int16], status: NDArray[np.int8]
) -> None:
    """Solve every design: fill the table of results, the bits of binding constraints, the status.

    Parameters
    ----------
    kept : Kept
        Which formulas of which scene, by its type, and the contacts to keep.
    groups : ndarray, shape (n, GROUPS)
        The inputs of each design, SI units and radians: columns `P_` to `BETA_HI`.
    table : ndarray, shape (n, COLUMNS)
        Filled with the results: columns `ALPHA` to `RESIDUAL`; NaN where there are none.
    active, status : ndarray, shape (n,)
        Filled with bits of `ACTIVE` and values of `STATUS`.
    """
    work = Work(
        np.empty((ROWS, 3)), np.empty(ROWS), np.empty(3), np.empty(3),
        np.empty(SAMPLES), np.empty(SAMPLES), np.empty(SAMPLES),
        np.empty(4), np.empty((CONSTRAINTS, 2)), np.empty(CONSTRAINTS), np.empty(CONSTRAINTS),
        np.empty(CONSTRAINTS, dtype=np.int64),
    )  # fmt: skip
    for cell in range(groups.shape[0]):
        p = groups[cell]
        table[cell, :] = math.nan
        active[cell] = 0
        if not _is_valid(p):
            status[cell] = INVALID
            continue
        if p[ALPHA_LO] > p[ALPHA_HI] or p[BETA_LO] > p[BETA_HI]:
            status[cell] = INFEASIBLE
            continue
        if p[P_] <= TINY * (abs(p[ALONG]) + abs(p[ACROSS]) + abs(p[NORMAL])):
            status[cell] = _without_drive(kept, p, table[cell])
            continue
        optimum = best(kept, p, work)
        status[cell] = optimum.status
        if not optimum.exists:
            continue
        # Rounding, or a drive along the normal, where every alpha is the same direction.
        alpha = min(max(optimum.alpha, p[ALPHA_LO]), p[ALPHA_HI])
        beta = min(max(optimum.beta, p[BETA_LO]), p[BETA_HI])
        active[cell] = _at_best(kept, p, alpha, beta, work, table[cell])
