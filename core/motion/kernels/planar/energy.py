"""What friction, impacts and the drive do over a cycle, per mass (theory 13.15)."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled, raised
from core.motion.kernels.arrays import Floats, Statuses, Stop
from core.motion.kernels.cells import cell_of
from core.motion.kernels.planar.drive import Drive, Waves, drive_of, push, smooth_span
from core.motion.kernels.planar.flow import TURN
from core.motion.kernels.planar.path import at_piece
from core.motion.kernels.planar.slide import follow_cycle
from core.motion.kernels.planar.solve import solve_cell
from core.motion.kernels.planar.tables import MOST_SEGMENTS, PIECE, SEGMENT, SUMS
from core.motion.kernels.quadrature import PLACES, WEIGHTS
from core.motion.kernels.results import COLUMN, RESULTS, SPENT
from core.motion.kernels.statuses import MODE, STATUS


@compiled
def spend_over_piece(drive: Drive, piece: Floats, spent: Floats) -> None:
    """Add what the drive and friction do over a piece of the log (theory 13.15).

    The integrals of b.u and, while it slips, of mu_k N |u|, with N = n - b_z, by Gauss's rule.
    """
    tau, span, flies = piece[PIECE.phase], piece[PIECE.span], piece[PIECE.mode] == MODE.flight
    if piece[PIECE.mode] == MODE.stick:
        return
    at = 0.0
    while at < span:
        half = 0.5 * min(smooth_span(drive, tau + at), span - at)
        for place, weight in zip(PLACES, WEIGHTS):  # noqa: B905 # numba knows no strict
            for side in (-place, place):
                since = at + half * (1.0 + side)
                _, _, u, w = at_piece(piece, since, drive)
                along, normal = push(drive, tau + since)
                spent[SPENT.drive] += half * weight * (along * u + normal * w)
                if not flies:
                    load = drive.gn - normal
                    spent[SPENT.friction] += half * weight * drive.mu_k * load * abs(u)
        at += 2.0 * half


@compiled
def spend_over_cycle(
    drive: Drive, rows: Floats, count: int, u: float, periods: float, sums: Floats, log: Floats,
    spent: Floats,
) -> None:  # fmt: skip
    """Fill `spent` with means over so many periods of a chain of segments, entered with velocity u.

    An impact takes the kinetic energy by which the piece after it starts with less, (u-^2 - u+^2 +
    w-^2 - w+^2)/2.
    """
    spent[:] = 0.0
    after_last = max(0.0, rows[0, SEGMENT.take_off])
    for _ in range(max(1, round(periods * TURN / rows[:count, SEGMENT.span].sum()))):
        u, _, used = follow_cycle(rows, count, u, drive, sums, log)
        if not 0 < used < log.shape[0]:  # a full log may lack pieces
            spent[:] = math.nan
            return
        for number in range(used):
            piece = log[number]
            spend_over_piece(drive, piece, spent)
            if piece[PIECE.mode] == MODE.flight:
                _, _, fast, down = at_piece(piece, piece[PIECE.span], drive)
                slow, up = u, after_last
                if number + 1 < used:
                    slow, up = log[number + 1, PIECE.along], log[number + 1, PIECE.normal]
                lost = (fast - slow) * (fast + slow) + (down - up) * (down + up)
                spent[SPENT.impact] += 0.5 * lost
    spent /= periods * TURN


@compiled
def spend_cells(groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table, columns as in `SPENT`, and status of cells; NaN where a motion has no cycle."""
    rows, sums, result = np.empty((MOST_SEGMENTS, len(SEGMENT))), np.empty(SUMS), np.empty(RESULTS)
    log = np.empty((4 * MOST_SEGMENTS, len(PIECE)))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        cell = cell_of(row)
        spent[:] = math.nan
        found, first, count, u = solve_cell(
            cell, row, waves, False, rows, sums, log[:0], result, stop
        )
        if raised(stop):
            return
        status[number] = found
        if found == STATUS.at_rest:
            spent[:] = 0.0
        elif count > 0:
            rest, periods = rows[first:], result[COLUMN.multiple]
            drive, _, _ = drive_of(cell, row, waves)
            spend_over_cycle(drive, rest, count - first, u, periods, sums, log, spent)
