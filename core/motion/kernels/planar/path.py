"""The path of one part."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.cycle import normal_cycle
from core.motion.kernels.planar.flow import TURN, Drive, distance_after, velocity_after
from core.motion.kernels.planar.repeating import velocity_at_start
from core.motion.kernels.planar.slide import follow_cycle, write_piece
from core.motion.kernels.planar.solve import solve, upright
from core.motion.kernels.planar.tables import MOST_SEGMENTS, PIECE, SEGMENT, SUMS, cell_of
from core.motion.kernels.results import RESULTS
from core.motion.kernels.statuses import MODE, STATUS

SHOWN_PERIODS = 4  # of an aperiodic motion, in its path
UNKNOWN = (STATUS.aperiodic, STATUS.sensitive, STATUS.limit_reached)
"""Statuses of parts that are shown over the last stretch that was followed."""


class Sample(NamedTuple):
    """Columns of a path."""

    position: int
    height: int
    velocity_along: int
    velocity_normal: int
    mode: int


SAMPLE = Sample(*range(len(Sample._fields)))


@compiled
def follow(group: Floats) -> tuple[Floats, float, float, bool]:
    """Return the pieces of the cycle of one cell, the phase shift and the way of `upright`.

    The last value tells whether the motion repeats after them. A piece is a row of the log.
    """
    cell = cell_of(group)
    drive, phase, way = upright(cell)
    rows = np.empty((MOST_SEGMENTS, len(SEGMENT)))
    sums = np.empty(SUMS)
    log = np.empty((4 * MOST_SEGMENTS, len(PIECE)))
    result = np.empty(RESULTS)
    log[:, PIECE.span] = -1.0
    status, count, u = solve(cell, rows, sums, log, result)
    used = 0
    if status == STATUS.at_rest:
        used = write_piece(log, used, 0.0, TURN, MODE.stick, 0.0, 0.0, 0.0)
        status, count = STATUS.periodic, 1
    elif count > 0:
        _, _, used = follow_cycle(rows, count, u, drive, sums, log)
    elif status in UNKNOWN and drive.s > drive.gn:
        e, most_periods = cell.restitution, int(cell.most_periods)
        count, _ = normal_cycle(drive.s, drive.gn, e, most_periods, math.inf, rows)
        shown, span = 0, 0.0
        while shown < count and span < SHOWN_PERIODS * TURN:
            shown += 1
            span += rows[count - shown, SEGMENT.span]
        start = velocity_at_start(drive, phase, rows, count)
        u, _, _ = follow_cycle(rows, count - shown, start, drive, sums, log[:0])
        _, _, used = follow_cycle(rows[count - shown :], shown, u, drive, sums, log)
    return log[: max(0, used)].copy(), phase, way, count > 0 and status == STATUS.periodic


@compiled
def sample(pieces: Floats, group: Floats, shift: float, phases: Floats, repeats: bool) -> Floats:
    """Return position, height, velocities and mode at phases since the start of the cycle.

    The columns of the result, shape (n, 5), are those of `SAMPLE`. NaN and mode `unknown` where
    there is no cycle, and beyond the end of pieces after which the motion does not repeat.
    """
    samples = np.full((phases.size, len(SAMPLE)), math.nan)
    samples[:, SAMPLE.mode] = MODE.unknown
    if pieces.shape[0] == 0:
        return samples
    drive, _, _ = upright(cell_of(group))
    ends = np.cumsum(pieces[:, PIECE.span])
    length = ends[-1]
    last = pieces.shape[0] - 1
    covered = at_piece(pieces[last], pieces[last, PIECE.span], drive)[0]
    # The cycle is laid out from where the study's own period starts.
    offset = (shift - pieces[0, PIECE.phase]) % TURN
    before = 0.0
    for number in range(phases.size):
        phase = phases[number]
        if not repeats and phase + offset > length:
            break
        turns, within = divmod(phase + offset, length)
        piece = min(np.searchsorted(ends, within, side="right"), last)
        since = within - (ends[piece] - pieces[piece, PIECE.span])
        position, height, along, normal = at_piece(pieces[piece], since, drive)
        position += turns * covered
        if number == 0:
            before = position
        samples[number, SAMPLE.position], samples[number, SAMPLE.height] = position - before, height
        samples[number, SAMPLE.velocity_along] = along
        samples[number, SAMPLE.velocity_normal] = normal
        samples[number, SAMPLE.mode] = pieces[piece, PIECE.mode]
    return samples


@compiled
def at_piece(piece: Floats, since: float, drive: Drive) -> tuple[float, float, float, float]:
    """Return position, height and velocities along and normal some phase after a piece began."""
    tau, mode, x = piece[PIECE.phase], piece[PIECE.mode], piece[PIECE.position]
    u, w = piece[PIECE.along], piece[PIECE.normal]
    if mode == MODE.stick:
        return x, 0.0, 0.0, 0.0
    c, s, gs, gn, mu_k = drive.c, drive.s, drive.gs, drive.gn, drive.mu_k
    if mode == MODE.flight:
        height = max(0.0, distance_after(w, s, gn, tau, since))
        along, normal = velocity_after(u, c, gs, tau, since), velocity_after(w, s, gn, tau, since)
        return x + distance_after(u, c, gs, tau, since), height, along, normal
    sign = 1.0 if mode == MODE.forward else -1.0
    C, k = c + sign * mu_k * s, gs + sign * mu_k * gn
    return x + distance_after(u, C, k, tau, since), 0.0, velocity_after(u, C, k, tau, since), 0.0
