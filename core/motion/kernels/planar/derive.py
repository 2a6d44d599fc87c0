"""Derivatives of the means of a motion that repeats by its groups (theory 13.16)."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.cells import cell_of
from vibrafeed.core.motion.kernels.planar.cycle import no_chain
from vibrafeed.core.motion.kernels.planar.drive import lifts
from vibrafeed.core.motion.kernels.planar.flow import NO_WAVES, TURN, SineDrive, upright
from vibrafeed.core.motion.kernels.planar.sine_slip import two_sided
from vibrafeed.core.motion.kernels.planar.slope_tables import (
    BY,
    DERIVED,
    DERIVED_BY,
    DIRECTIONS,
    ROW,
    SUMMED,
)
from vibrafeed.core.motion.kernels.planar.slopes import (
    along,
    copy_row,
    in_air,
    lift,
    on_floor,
    release,
    rub,
)
from vibrafeed.core.motion.kernels.planar.solve import solve_cell
from vibrafeed.core.motion.kernels.planar.tables import PIECE, SEGMENT, SUMS
from vibrafeed.core.motion.kernels.results import COLUMN, RESULTS
from vibrafeed.core.motion.kernels.statuses import MODE, STATUS

KINK = 1e-9
"""Relative distance from another outcome of an event below which a motion is at a kink or jump:
some hundred times what rounding leaves of an event that depends on many before it."""

FOLD = 1e-3
"""Weight of the distance of a cycle from a fold or doubling, against `KINK`: its state is known to
some 1e-14 over that distance, and its derivatives are to hold seven digits."""

WIDTH = len(DERIVED) * DERIVED_BY
MARGIN = RESULTS + WIDTH
"""Column of the least distance from a kink; the results come before, then the derivatives."""
DERIVED_COLUMNS = MARGIN + 1


@borrowing
def start_of_cycle(drive: SineDrive, rows: Floats, count: int, d: Floats) -> int:
    """Set the derivatives of the state at the start of a cycle; return how many columns are in use.

    The columns (`BY`) are the seven parameters and, behind them, the free quantities of the
    starting state. Which are free depends on the cycle: only the velocity along where the cycle
    starts at a lift-off after a rest on the floor (`lift`), or, without hops, where static friction
    lets go (`release`); also phase and rebound where hops follow each other without a rest (theory
    13.16).

    `rows` are the `count` segments of the cycle (columns of `SEGMENT`; a take-off below 0 is a
    contact). `d` is overwritten, with a row a quantity (`ROW`).
    """
    d[:, :] = 0.0
    d[ROW.along, BY.start_along] = 1.0
    if rows[0, SEGMENT.take_off] < 0:
        if not lifts(drive):
            at = rows[0, SEGMENT.phase]
            by_least = math.cos(at) < 0
            if abs(drive.least if by_least else drive.largest) < 1:
                release(drive, by_least, drive.way, at, d)
        return BY.start_phase
    rests = False
    for row in range(count):
        rests = rests or rows[row, SEGMENT.take_off] < 0
    if rests:
        lift(drive, ROW.phase, d)
        return BY.start_phase
    d[ROW.phase, BY.start_phase], d[ROW.normal, BY.start_normal] = 1.0, 1.0
    return DIRECTIONS


@borrowing
def carry(
    drive: SineDrive, e: float, rows: Floats, count: int, cycles: int, u: float, energy: bool,
    d: Floats, nearest: Floats,
) -> int:  # fmt: skip
    """Propagate derivatives through `cycles` rounds of a cycle; return the number of directions.

    A direction is a number by which the motion is derived. Segment by segment: `in_air` for a
    flight, `on_floor` for a contact up to its lift-off.

    Parameters
    ----------
    drive, e
        Drive numbers of the cell, and its restitution.
    rows, count
        Segments of the cycle (columns of `SEGMENT`), and how many.
    cycles
        Rounds of the cycle to go through.
    u
        Slip velocity at the start in g/w (w = 2 pi f).
    energy
        If the work of friction is derived, too.
    d
        Derivatives, a row a quantity (`ROW`), a column a direction (`BY`); changed.
    nearest
        Least relative distances of decisions from their other outcomes, shape (5,); changed.
    """
    size = start_of_cycle(drive, rows, count, d)
    flies = lifts(drive)
    for cycle in range(cycles):
        apart, alike = nearest[2], nearest[4]
        for row in range(count):
            if rows[row, SEGMENT.take_off] >= 0:
                rests = rows[(row + 1) % count, SEGMENT.take_off] < 0
                u = in_air(drive, e, rows, row, rests, u, size, d, nearest)
                continue
            if flies:
                lift(drive, ROW.end, d)
            else:
                copy_row(d, ROW.end, ROW.phase)
            tau, span = rows[row, SEGMENT.phase], rows[row, SEGMENT.span]
            u = on_floor(drive, tau, span, u, flies, energy, size, d, nearest)
        if cycle > 0:  # it lands as it did in the first
            nearest[2], nearest[4] = apart, alike
    return size


@borrowing
def add(d: Floats, to: int, factor: float, of: int) -> None:
    """Add a multiple of one column of derivatives to another: d[:, to] += factor d[:, of]."""
    for row in range(d.shape[0]):
        d[row, to] += factor * d[row, of]


@borrowing
def close(size: int, d: Floats, nearest: Floats) -> None:
    """Complete the derivatives of a cycle by those of its start, so that it remains closed.

    The state y at the start (slip velocity; of hops only also phase and rebound) changes by y. = (1
    - M)^-1 Q, with the derivatives M of the end by a change of y, and Q of the end by the
    parameter. For hops, with M = (a, b; c, f) + 1 and det = a f - b c: phase. = (b Q_2 - f Q_1)/det
    and rebound. = (c Q_1 - a Q_2)/det.

    `d` holds the derivatives at the end, a row a quantity (`ROW`), a column a direction (`BY`), of
    which `size` are in use. `nearest[0]` is lowered where the cycle hardly closes, as at a fold or
    a period doubling (theory 13.16).
    """
    free = DIRECTIONS - size
    if not free:
        a, b = d[ROW.phase, BY.start_phase] - 1.0, d[ROW.phase, BY.start_normal]
        c, f = d[ROW.normal, BY.start_phase], d[ROW.normal, BY.start_normal] - 1.0
        determinant = a * f - b * c
        doubling = (a + 2.0) * (f + 2.0) - b * c
        nearest[0] = min(nearest[0], FOLD * abs(determinant), FOLD * abs(doubling))
        for i in range(DERIVED_BY):
            late, fast = d[ROW.phase, i], d[ROW.normal, i]
            phase = (b * fast - f * late) / determinant
            normal = (c * late - a * fast) / determinant
            add(d, i, phase, BY.start_phase)
            add(d, i, normal, BY.start_normal)
    room = 1.0 - d[ROW.along, BY.start_along]
    nearest[0] = min(nearest[0], FOLD * abs(room))
    for i in range(DERIVED_BY):
        add(d, i, d[ROW.along, i] / room, BY.start_along)


@borrowing
def carry_two_sided(drive: SineDrive, energy: bool, d: Floats, nearest: Floats) -> None:
    """Propagate derivatives for a part that slides to and fro without sticking, in closed form.

    The cycle starts where the part turns forward, at a free phase tau: a forward slip, then a
    backward one (`two_sided`); tau. = Q/(1 - M), with what the cycle makes of a change of the
    parameter, Q, and of tau, M. `d` holds the derivatives, `energy` asks for those of friction
    work, `nearest[0]` is the least distance from sticking or from another motion (theory 13.16).
    """
    _, share = two_sided(drive)
    c, s, gs, gn, mu = drive.c, drive.s, drive.gs, drive.gn, drive.mu_k
    span = share * TURN
    k1 = mu * gn
    half = (c * k1 - mu * s * gs) * math.cos((span - math.pi) / 2)
    sine = math.pi * (k1 - gs) * (k1 + gs) / (2 * half)
    first = math.pi - math.asin(sine) - span / 2
    least, largest = drive.least, drive.largest
    d[:, :] = 0.0
    d[ROW.phase, BY.start_phase] = 1.0
    for sign, mode, at, length in (
        (1.0, MODE.forward, first, span),
        (-1.0, MODE.backward, first + span, TURN - span),
    ):
        along(drive, sign, 0.0, 0.0, at, length, True, mode, DIRECTIONS, d)
        if energy:
            rub(drive, sign, 0.0, at, length, DIRECTIONS, d)
        nearest[0] = min(nearest[0], abs(math.sin(at) - (largest if sign > 0 else least)))
    nearest[0] = min(nearest[0], (1.0 - sine) * (1.0 + sine))
    room = 1.0 - d[ROW.phase, BY.start_phase]
    for i in range(DERIVED_BY):
        add(d, i, d[ROW.phase, i] / room, BY.start_phase)


@borrowing
def tell(drive: SineDrive, result: Floats, d: Floats, slopes: Floats) -> None:
    """Fill `slopes` with the derivatives of the mean values of a motion by its parameters.

    `d` holds the derivatives of sums over the cycle, a row a quantity (`ROW`), `result` the mean
    values (columns of `COLUMN`); `slopes` has a row for each mean (`DERIVED`) and a column for each
    parameter (`BY`). Sums are divided by the cycle's duration in rad; the drive's power is friction
    + impacts + sin(gamma) v, with gravity along the track `drive.gs` (theory 13.15).
    """
    time = result[COLUMN.multiple] * TURN
    for told, row in SUMMED:
        for i in range(DERIVED_BY):
            slopes[told, i] = d[row, i] / time
    for i in range(DERIVED_BY):
        slopes[DERIVED.landing_speed, i] = d[ROW.landing, i]
        slopes[DERIVED.hop_height, i] = d[ROW.height, i]
        lifted = drive.gs * slopes[DERIVED.velocity, i]
        if i == BY.gs:
            lifted += result[COLUMN.velocity]
        slopes[DERIVED.drive, i] = slopes[DERIVED.friction, i] + slopes[DERIVED.impact, i] + lifted


@borrowing
def turn_slopes(c: float, s: float, slopes: Floats) -> None:
    """Give derivatives of a mirrored motion the signs that they have for the drive of the study.

    A drive (c, s), its amplitudes along and normal, is solved with both positive: mirrored in time
    if s < 0 and in the direction of the track. `slopes` has a row for each mean (`DERIVED`) and a
    column for each parameter (`BY`), and is changed. If s < 0 the derivatives by c and s change
    sign; in the mirror of the track's direction those by c and sin(gamma) do, and those of the mean
    velocity, and the shares forward and backward change places.
    """
    mirrored = (-c if s < 0 else c) < 0
    for told in range(len(DERIVED)):
        if s < 0:
            slopes[told, BY.c], slopes[told, BY.s] = -slopes[told, BY.c], -slopes[told, BY.s]
        if mirrored:
            slopes[told, BY.c], slopes[told, BY.gs] = -slopes[told, BY.c], -slopes[told, BY.gs]
    if mirrored:
        for i in range(DERIVED_BY):
            slopes[DERIVED.velocity, i] = -slopes[DERIVED.velocity, i]
            forward = slopes[DERIVED.forward, i]
            slopes[DERIVED.forward, i] = slopes[DERIVED.backward, i]
            slopes[DERIVED.backward, i] = forward


@borrowing
def from_edges(drive: SineDrive) -> float:
    """Return the relative distance of a drive from its thresholds: lift-off, slip, running away.

    The least of |s - n|/n, |1 - |S|| for both bounds S of `stick_range`, and |mu_s n -
    |sin(gamma)||/(mu_s n + |sin(gamma)|), with the normal drive number s and load number n. At a
    threshold the motion changes its kind and has no derivative.
    """
    gn, least, largest = drive.gn, drive.least, drive.largest
    edge = min(abs(drive.s - gn) / gn, abs(1.0 - abs(least)), abs(1.0 - abs(largest)))
    pull, grip = abs(drive.gs), drive.mu_s * gn
    return min(edge, abs(grip - pull) / (grip + pull)) if grip + pull > 0 else 0.0


@compiled
def derive_cells(energy: bool, groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and statuses of cells under a sine drive: means, and their derivatives.

    A row of `table` holds the results of `solve_cells`, the derivatives of `DerivedMeans` by the
    first seven parameters of `Direction` (NaN if the motion does not repeat), and the least
    relative distance of a decision from its other outcome: below `KINK` there is no derivative.
    Derivatives by restitution are NaN where the smallest restitution is a jump, those of landing
    speed and hop height where two are the largest. `groups` has a row of numbers for each cell;
    `energy` asks for derivatives of powers; `stop` is a flag that ends the work (theory 13.16).
    `status` gets one value a cell.
    """
    chain = no_chain()
    rows = chain.rows
    sums, nearest = np.empty(SUMS), np.empty(5)
    log, d = np.empty((0, len(PIECE))), np.empty((len(ROW), DIRECTIONS))
    for number in range(groups.shape[0]):
        row, result = groups[number], table[number, :RESULTS]
        cell = cell_of(row)
        outcome, first, count, u = solve_cell(
            cell, row, NO_WAVES, True, chain, sums, log, result, stop
        )
        slopes = table[number, RESULTS:MARGIN].reshape(len(DERIVED), DERIVED_BY)
        slopes[:] = math.nan
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = outcome
        table[number, MARGIN] = 0.0
        if outcome not in (STATUS.periodic, STATUS.at_rest):
            continue
        drive, _, _ = upright(cell, row, NO_WAVES)
        nearest[:] = 0.0
        nearest[0] = from_edges(drive)
        if outcome == STATUS.at_rest:
            slopes[:] = 0.0
            table[number, MARGIN] = nearest[0]
            continue
        d[:, :] = 0.0
        if count == 0:
            carry_two_sided(drive, energy, d, nearest)
        else:
            rest, periods = rows[first:], 0.0
            for row in range(count - first):
                periods += rest[row, SEGMENT.span]
            cycles = max(1, round(result[COLUMN.multiple] * TURN / periods))
            size = carry(
                drive, cell.restitution, rest, count - first, cycles, u, energy, d, nearest
            )
            close(size, d, nearest)
        if lifts(drive):
            if not nearest[2] > KINK:
                d[ROW.landing, :] = math.nan
            if not nearest[4] > KINK:
                d[ROW.height, :] = math.nan
        tell(drive, result, d, slopes)
        turn_slopes(cell.drive_number_along, cell.drive_number_normal, slopes)
        known = True  # by restitution there may be none alone, where it begins with a jump
        for i in range(BY.e):
            known = known and math.isfinite(slopes[DERIVED.velocity, i])
        table[number, MARGIN] = nearest[0] if known else 0.0
