"""A cycle followed once more: the path of one part, and what friction, impacts and the drive do.

Energies are means over the cycle, per mass (theory 13.15).
"""

from __future__ import annotations

import math
from collections import namedtuple

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.cells import Cell, cell_of
from vibrafeed.core.motion.kernels.planar.cycle import no_chain, normal_cycle
from vibrafeed.core.motion.kernels.planar.drive import (
    Drive,
    Waves,
    drive_of,
    fly,
    lifts,
    push,
    push_slope,
    rise,
    slide,
    smooth_span,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.planar.rebound import restitution_of
from vibrafeed.core.motion.kernels.planar.repeating import velocity_at_start
from vibrafeed.core.motion.kernels.planar.slide import follow_cycle, write_piece
from vibrafeed.core.motion.kernels.planar.solve import UNREPEATED, solve_cell
from vibrafeed.core.motion.kernels.planar.tables import MAX_SEGMENTS, PIECE, SEGMENT, SUMS
from vibrafeed.core.motion.kernels.quadrature import NODES, WEIGHTS
from vibrafeed.core.motion.kernels.results import COLUMN, RESULTS, SPENT
from vibrafeed.core.motion.kernels.statuses import MODE, STATUS

SHOWN_PERIODS = 4  # periods of an aperiodic motion that its path shows
UNKNOWN = (STATUS.aperiodic, STATUS.sensitive, STATUS.limit_reached)
"""Statuses of motions that do not repeat, of which the last stretch is shown."""

Sample = namedtuple("Sample", "position height velocity_along velocity_normal mode")
"""Columns of a path."""

SAMPLE = Sample(*range(len(Sample._fields)))


@compiled
def follow(row: Floats, waves: Waves, known: int, stop: Stop) -> tuple[Floats, float, float, bool]:
    """Return the motion of one cell in pieces, for drawing the path of its part.

    `row` holds the cell's numbers, `waves` the work array for its drive, `known` the status that
    the cell has if its motion does not repeat, `stop` a flag that ends the work.

    Returns
    -------
    Pieces, each a stretch in one mode, shape (pieces, 6) with the columns of `PIECE`; the phase
    shift in rad and the sign -1 or 1 with which they are turned back from the mirrored drive to
    that of the study; and True if the motion repeats after them.
    """
    cell = cell_of(row)
    chain, result = no_chain(), np.empty(RESULTS)
    sums, log = np.empty(SUMS), np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    log[:, PIECE.span] = -1.0
    status, first, count, u = solve_cell(cell, row, waves, False, chain, sums, log, result, stop)
    status = known if status == UNREPEATED else status
    drive, phase, way = drive_of(cell, row, waves)
    pieces, repeats = pieces_of(
        drive, phase, cell, status, chain.rows[first:], count - first, u, sums, log
    )
    return pieces, phase, way, repeats


@compiled
def pieces_of(
    drive: Drive, phase: float, cell: Cell, status: int, rows: Floats, count: int, u: float,
    sums: Floats, log: Floats,
) -> tuple[Floats, bool]:  # fmt: skip
    """Return the pieces of a solved motion, each in one mode, and True if it repeats after them.

    Pieces have the columns of `PIECE`, shape (pieces, 6), for drawing the trajectory. A motion that
    does not repeat is followed from rest, and its last `SHOWN_PERIODS` periods are returned.

    Parameters
    ----------
    drive, phase
        The drive, and the phase in rad at which the study's own period starts.
    cell, status
        The cell's numbers, and the status of its motion.
    rows, count
        Segments of the cycle normal to the floor (columns of `SEGMENT`), and their number.
    u
        Slip velocity at the start of the cycle in g/w (w = 2 pi f).
    sums, log
        Work arrays, overwritten, for the sums over the cycle and for the pieces.
    """
    used = 0
    if status == STATUS.at_rest:
        used = write_piece(log, used, 0.0, TURN, MODE.stick, 0.0, 0.0, 0.0)
        status, count = STATUS.periodic, 1
    elif count > 0:
        _, _, used = follow_cycle(rows, count, u, drive, sums, log)
    elif status in UNKNOWN and lifts(drive):
        e, max_periods = restitution_of(cell), int(cell.max_periods)
        _, count, _ = normal_cycle(drive, phase, e, max_periods, math.inf, rows)
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
    """Return position, height, velocities and mode of a part at given phases of the drive.

    Phases count from the start of the study's own period. Lengths in g/w^2 (w = 2 pi f), velocities
    in g/w. The columns of the result, shape (n, 5), are those of `SAMPLE`; the first position is 0.
    NaN and mode `unknown` without a cycle, and beyond the last piece if the motion does not repeat.

    Parameters
    ----------
    pieces, repeats
        Motion pieces of one cycle (columns of `PIECE`), and True if it repeats after them.
    row, waves
        The cell's numbers, and the work array for the wave of its drive.
    shift
        Phase shift of the drive in rad, from `follow`.
    phases
        The n phases in rad.
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
    """Return position, height, velocity along and velocity normal at a phase within a motion piece.

    `piece` is a row with the columns of `PIECE`: its start, mode and state there; `since` is the
    phase after its start in rad, `drive` the drive with gravity and friction. Lengths in g/w^2 (w =
    2 pi f), velocities in g/w. The flows are closed: in flight, sliding on the floor, or at rest.
    """
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


# --- energies


@compiled
def spend_over_piece(drive: Drive, piece: Floats, spent: Floats) -> None:
    """Add the work of drive and friction over one motion piece to `spent`, per mass, in (g/w)^2.

    The integrals over the phase of b.u (drive), of b'.u (swing: it gives the mass that the drive
    feels) and, while the part slips, of mu_k N |u| (friction), with the push b and its derivative
    b' by the phase, the velocity u and the load N = n - b_z; by Gauss's rule (theory 13.15). Here w
    = 2 pi f. `piece` is a row with the columns of `PIECE`, `spent` has the columns of `SPENT`,
    `drive` gives push and friction.
    """
    tau, span, flies = piece[PIECE.phase], piece[PIECE.span], piece[PIECE.mode] == MODE.flight
    if piece[PIECE.mode] == MODE.stick:
        return
    at = 0.0
    while at < span:
        half = 0.5 * min(smooth_span(drive, tau + at), span - at)
        for place, weight in zip(NODES, WEIGHTS):  # noqa: B905 # numba knows no strict
            for side in (-place, place):
                since = at + half * (1.0 + side)
                _, _, u, w = at_piece(piece, since, drive)
                along, normal = push(drive, tau + since)
                spent[SPENT.drive] += half * weight * (along * u + normal * w)
                slope, rising = push_slope(drive, tau + since)
                spent[SPENT.swing] += half * weight * (slope * u + rising * w)
                if not flies:
                    load = drive.gn - normal
                    spent[SPENT.friction] += half * weight * drive.mu_k * load * abs(u)
        at += 2.0 * half


@compiled
def spend_over_cycle(
    drive: Drive, rows: Floats, count: int, u: float, periods: float, sums: Floats, log: Floats,
    spent: Floats,
) -> None:  # fmt: skip
    """Fill `spent` (columns of `SPENT`) with mean powers per mass over a cycle of planar motion.

    In g^2/(2 pi f). The cycle is followed as often as fits into `periods` periods of the drive. An
    impact takes the kinetic energy by which the next piece starts with less, (u-^2 - u+^2 + w-^2 -
    w+^2)/2 of the velocities along and normal before and after it. NaN if the log is too short
    (theory 13.15).

    Parameters
    ----------
    drive
        Drive, gravity and friction in g.
    rows, count
        Segments of the motion normal to the floor (columns of `SEGMENT`), and how many.
    u
        Slip velocity at their start in g/(2 pi f).
    sums, log
        Work arrays for the sums over the cycle and the motion pieces.
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
    """Fill the table of mean powers of cells in the plane: what drive, friction and impacts take.

    The cycle of each motion is found, and followed once more. `groups` has a row of numbers for
    each cell, `waves` is the work array for the wave of a drive, `table` has the columns of
    `SPENT`, powers per mass in g^2/w (w = 2 pi f); `status` gets the status of the motion; `stop`
    is a flag that ends the work. NaN for cells without a cycle, 0 for parts at rest (theory 13.15).
    """
    chain, sums, result = no_chain(), np.empty(SUMS), np.empty(RESULTS)
    log = np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        cell = cell_of(row)
        spent[:] = math.nan
        outcome, first, count, u = solve_cell(
            cell, row, waves, False, chain, sums, log[:0], result, stop
        )
        if raised(stop):
            return
        status[number] = outcome
        if outcome == STATUS.at_rest:
            spent[:] = 0.0
        elif count > 0:
            rest, periods = chain.rows[first:], result[COLUMN.multiple]
            drive, _, _ = drive_of(cell, row, waves)
            spend_over_cycle(drive, rest, count - first, u, periods, sums, log, spent)
