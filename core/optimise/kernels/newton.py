"""Compiled batch solver of the drive angles; see `core.optimise.newton`.

Everything is divided by the drive acceleration P. Two kinds of problems: those linear in the drive
direction (`sphere`), and the block with the friction disc (`disc`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.optimise.codes import TIGHT
from core.optimise.kernels.columns import (
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
    BETA_UPPER,
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
    NO_MOTION,
    NORMAL,
    P_,
    PLANE_PHYSICAL,
    PLANE_THESIS,
    PRICE_ACROSS,
    PRICE_FLOOR,
    PRICE_WALL,
    RESIDUAL,
    START,
    TINY,
    TRACK_PHYSICAL,
    TRACK_THESIS,
    VALUE,
    WALL,
    Numbers,
)  # fmt: skip
from core.optimise.kernels.conditions import gradients, least_prices
from core.optimise.kernels.disc import RIGHT, SAMPLES, best_along
from core.optimise.kernels.sphere import ROWS, linear


@compiled
def _is_valid(p: Numbers) -> bool:
    """Return whether all groups are numbers within their range; only the limit may be infinite."""
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
def _idle(problem: int, floor: bool, wall: bool, p: Numbers, row: Numbers) -> int:
    """Return the status without drive, where every angle is as good; fill the row."""
    c, y, G, mu = p[ALONG], p[ACROSS], p[NORMAL], p[MU_K]
    room = -y if problem == TRACK_THESIS else y
    across = -mu * G if problem == PLANE_THESIS else 0.0
    physical = problem in (PLANE_PHYSICAL, TRACK_PHYSICAL)
    if problem == PLANE_THESIS:
        value = across - c
    elif problem == PLANE_PHYSICAL:
        value = -c + math.copysign(mu * G, c) if abs(c) > p[MU_S] * G else 0.0
    else:
        value = -c - mu * (room + (G if physical else 0.0))
    if (floor or physical) and G < 0:
        return INFEASIBLE
    if problem >= TRACK_THESIS and (wall or physical) and room < 0:
        return INFEASIBLE
    if problem <= PLANE_PHYSICAL and abs(across) > p[LIMIT]:
        return INFEASIBLE
    row[ALPHA], row[BETA], row[VALUE], row[CROSS] = p[ALPHA_LO], p[BETA_LO], value, across
    row[MARGIN_ACROSS], row[MARGIN_FLOOR] = p[LIMIT] - abs(across), G
    row[MARGIN_WALL] = room if problem >= TRACK_THESIS else math.nan
    row[PRICE_ACROSS] = row[PRICE_FLOOR] = row[PRICE_WALL] = row[RESIDUAL] = 0.0
    return FLAT


@compiled
def solve(
    problem: int, floor: bool, wall: bool, groups: Numbers, table: Numbers,
    active: NDArray[np.int16], status: NDArray[np.int8],
) -> None:  # fmt: skip
    """Fill table, bits and statuses for groups (n, GROUPS)."""
    A, b, u, best = np.empty((ROWS, 3)), np.empty(ROWS), np.empty(3), np.empty(3)
    betas, values, rises = np.empty(SAMPLES), np.empty(SAMPLES), np.empty(SAMPLES)
    F, slopes = np.empty(4), np.empty((CONSTRAINTS, 2))
    margins, prices = np.empty(CONSTRAINTS), np.empty(CONSTRAINTS)
    tight = np.empty(CONSTRAINTS, dtype=np.int64)
    physical = problem in (PLANE_PHYSICAL, TRACK_PHYSICAL)
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
            status[cell] = _idle(problem, floor, wall, p, table[cell])
            continue
        if problem == PLANE_PHYSICAL:
            found = best_along(p, betas, values, rises, best)
            alpha, beta = best[0], best[1]
        else:
            found = linear(problem, floor, wall, p, u, A, b, best)
            alpha = math.atan2(best[1], best[0])
            beta = math.atan2(best[2], math.hypot(best[0], best[1]))
        status[cell] = found
        if found == INFEASIBLE or (physical and found == NO_MOTION):
            continue
        # Rounding, or a drive along the normal, where every alpha is the same direction.
        alpha = min(max(alpha, p[ALPHA_LO]), p[ALPHA_HI])
        beta = min(max(beta, p[BETA_LO]), p[BETA_HI])
        gradients(problem, p, alpha, beta, F, slopes, margins)
        bits, count = 0, 0
        for i in range(1, CONSTRAINTS):
            asked = (
                i <= BETA_UPPER
                or (i <= ACROSS_UPPER and problem <= PLANE_PHYSICAL)
                or (i == FLOOR and (floor or physical))
                or (i == WALL and problem >= TRACK_THESIS and (wall or physical))
                or i == START
            )
            if asked and margins[i] <= TIGHT * (1 + p[NORMAL] / p[P_]):
                bits |= 1 << (i - 1)
                tight[count] = i
                count += 1
        active[cell] = bits
        row = table[cell]
        row[RESIDUAL] = least_prices(slopes, tight, count, prices)
        P = p[P_]
        row[ALPHA], row[BETA] = alpha, beta
        row[VALUE], row[CROSS] = P * F[0], P * F[1]
        row[MARGIN_ACROSS] = p[LIMIT] - abs(P * F[1])
        row[MARGIN_FLOOR] = P * F[2]
        row[MARGIN_WALL] = P * F[3] if problem >= TRACK_THESIS else math.nan
        row[PRICE_ACROSS] = prices[ACROSS_LOWER] + prices[ACROSS_UPPER]
        row[PRICE_FLOOR], row[PRICE_WALL] = prices[FLOOR], prices[WALL]
