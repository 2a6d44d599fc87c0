"""The path of one part."""

from __future__ import annotations

import math
from collections import namedtuple

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats, Stop
from core.motion.kernels.cells import Cell, cell_of
from core.motion.kernels.planar.cycle import normal_cycle
from core.motion.kernels.planar.drive import Drive, Waves, drive_of, fly, lifts, rise, slide
from core.motion.kernels.planar.flow import TURN
from core.motion.kernels.planar.repeating import velocity_at_start
from core.motion.kernels.planar.slide import follow_cycle, write_piece
from core.motion.kernels.planar.solve import UNREPEATED, solve_cell
from core.motion.kernels.planar.tables import MOST_SEGMENTS, PIECE, SEGMENT, SUMS
from core.motion.kernels.results import RESULTS
from core.motion.kernels.statuses import MODE, STATUS

SHOWN_PERIODS = 4  # of an aperiodic motion, in its path
UNKNOWN = (STATUS.aperiodic, STATUS.sensitive, STATUS.limit_reached)
"""Statuses of parts that are shown over the last stretch that was followed."""

Sample = namedtuple("Sample", "position height velocity_along velocity_normal mode")
"""Columns of a path."""

SAMPLE = Sample(*range(len(Sample._fields)))


@compiled
def follow(row: Floats, waves: Waves, known: int, stop: Stop) -> tuple[Floats, float, float, bool]:
    """Return the pieces of the cycle of one cell, the phase shift and the way of `upright`.

    The last value tells whether the motion repeats after them. A piece is a row of the log. `known`
    is the status of the cell, for a motion that does not repeat.
    """
    cell = cell_of(row)
    rows, result = np.empty((MOST_SEGMENTS, len(SEGMENT))), np.empty(RESULTS)
    sums, log = np.empty(SUMS), np.empty((4 * MOST_SEGMENTS, len(PIECE)))
    log[:, PIECE.span] = -1.0
    status, first, count, u = solve_cell(cell, row, waves, False, rows, sums, log, result, stop)
    status = known if status == UNREPEATED else status
    drive, phase, way = drive_of(cell, row, waves)
    pieces, repeats = pieces_of(
        drive, phase, cell, status, rows[first:], count - first, u, sums, log
    )
    return pieces, phase, way, repeats


@compiled
def pieces_of(
    drive: Drive, phase: float, cell: Cell, status: int, rows: Floats, count: int, u: float,
    sums: Floats, log: Floats,
) -> tuple[Floats, bool]:  # fmt: skip
    """Return the pieces of a cycle that was solved, and whether the motion repeats after them."""
    used = 0
    if status == STATUS.at_rest:
        used = write_piece(log, used, 0.0, TURN, MODE.stick, 0.0, 0.0, 0.0)
        status, count = STATUS.periodic, 1
    elif count > 0:
        _, _, used = follow_cycle(rows, count, u, drive, sums, log)
    elif status in UNKNOWN and lifts(drive):
        e, most_periods = cell.restitution, int(cell.most_periods)
        _, count, _ = normal_cycle(drive, phase, e, most_periods, math.inf, rows)
        shown, span = 0, 0.0
        while shown < count and span < SHOWN_PERIODS * TURN:
            shown += 1
            span += rows[count - shown, SEGMENT.span]
        start = velocity_at_start(drive, phase, rows, 0, count)
        u, _, _ = follow_cycle(rows, count - shown, start, drive, sums, log[:0])
        _, _, used = follow_cycle(rows[count - shown :], shown, u, drive, sums, log)
    return log[: max(0, used)].copy(), count > 0 and status == STATUS.periodic


@compiled
def sample(
    pieces: Floats, row: Floats, waves: Waves, shift: float, phases: Floats, repeats: bool
) -> Floats:
    """Return position, height, velocities and mode at phases since the start of the cycle.

    The columns of the result, shape (n, 5), are those of `SAMPLE`. NaN and mode `unknown` where
    there is no cycle, and beyond the end of pieces after which the motion does not repeat.
    """
    drive, _, _ = drive_of(cell_of(row), row, waves)
    samples = np.full((phases.size, len(SAMPLE)), math.nan)
    samples[:, SAMPLE.mode] = MODE.unknown
    if pieces.shape[0] == 0:
        return samples
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
    if mode == MODE.flight:
        along, covered = fly(drive, u, tau, since)
        normal, height = rise(drive, w, tau, since)
        return x + covered, max(0.0, height), along, normal
    along, covered = slide(drive, 1.0 if mode == MODE.forward else -1.0, u, tau, since)
    return x + covered, 0.0, along, 0.0
