"""Cells whose motion does not repeat: those that `solve` leaves `UNREPEATED`.

They are compiled apart, as most studies have none.
"""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.cells import Cell, cell_of
from vibrafeed.core.motion.kernels.planar.again import spend_over_cycle
from vibrafeed.core.motion.kernels.planar.chaos import from_phases
from vibrafeed.core.motion.kernels.planar.cycle import Chain, cycle_in, no_chain, normal_cycle
from vibrafeed.core.motion.kernels.planar.drive import Drive, Waves, drive_of
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.planar.growth import LAST_DIGIT
from vibrafeed.core.motion.kernels.planar.landings import no_landings
from vibrafeed.core.motion.kernels.planar.rebound import restitution_of
from vibrafeed.core.motion.kernels.planar.repeating import repeating, velocity_at_start
from vibrafeed.core.motion.kernels.planar.slide import follow_cycle
from vibrafeed.core.motion.kernels.planar.solve import UNREPEATED, turn_round
from vibrafeed.core.motion.kernels.planar.tables import MAX_SEGMENTS, PIECE, SEGMENT, SUMS
from vibrafeed.core.motion.kernels.planar.within import LEAST_TOLERANCE, means_within
from vibrafeed.core.motion.kernels.results import COLUMN, RESULTS
from vibrafeed.core.motion.kernels.statuses import STATUS

FELT_PERIODS = 256
"""Periods of the drive over which energies of a motion that does not repeat are averaged; they
scatter by some 3 %."""
LED_IN = 8
"""One segment in so many at the start of a motion is not counted, while the motion settles."""


@compiled
def reach_way(
    drive: Drive, phase: float, cell: Cell, chain: Chain, sums: Floats, result: Floats, stop: Stop
) -> None:
    """Enlarge the error of an aperiodic mean so that it covers the first way from rest to rest.

    error >= |v_way - v| + error(v_way). An undisturbed part would repeat that way for ever; it is
    the motion of these very numbers as long as rounding leaves a digit of it, though neighbouring
    numbers go other ways. `phase` is the start in rad, `chain` has such ways of the cell before,
    `sums` is a work array, `result` has the columns of `COLUMN` (theory 13.7).
    """
    own, no_log = np.full(RESULTS, math.nan), np.empty((0, len(PIECE)))
    rows, e, max_periods = chain.rows, restitution_of(cell), int(cell.max_periods)
    first, count, periods = cycle_in(chain, drive, phase, e, max_periods, LAST_DIGIT)
    if periods < 1:
        return
    u = velocity_at_start(drive, phase, rows, first, count)
    status, _ = repeating(
        rows[first:], count - first, periods, phase, u, drive, cell, sums, no_log, own, stop
    )
    if status == STATUS.periodic:
        apart = abs(own[COLUMN.velocity] - result[COLUMN.velocity])
        result[COLUMN.error] = max(result[COLUMN.error], apart + own[COLUMN.error])


@compiled
def average_cells(
    groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill table and statuses of cells whose motion does not repeat, with means over long runs.

    `groups` has a row of numbers for each cell, `waves` is the work array for the wave of a drive,
    `table` has the columns of `COLUMN`, `status` one value a cell; `stop` is a flag that ends the
    work. Cells with a tolerance of 0.001 or more end as soon as their error is within it (theory
    13.8).
    """
    rows, sums = np.empty((MAX_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    ways, landings = no_chain(), no_landings()
    for number in range(groups.shape[0]):
        row, result = groups[number], table[number]
        cell = cell_of(row)
        drive, phase, way = drive_of(cell, row, waves)
        result[:] = math.nan
        outcome = UNREPEATED
        if cell.tolerance >= LEAST_TOLERANCE:
            outcome, landings = means_within(cell, phase, drive, landings, result, stop)
        if outcome == UNREPEATED:
            outcome = from_phases(cell, phase, drive, rows, sums, result, stop)
        if outcome == STATUS.aperiodic:
            reach_way(drive, phase, cell, ways, sums, result, stop)
        if not math.isnan(result[COLUMN.velocity]):
            result[COLUMN.across] = 0.0
        turn_round(result, way)
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = outcome


@compiled
def average_spent(
    groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill the energy table of cells whose motion does not repeat, from long runs.

    Cells that hop too few times stay NaN, the others get the status `aperiodic`.

    Parameters
    ----------
    groups
        A row a cell: the fields of `Cell`, then its wave.
    waves
        Room for the drive of a cell, used again for each.
    table
        A row a cell, with the columns of `SPENT`: mean powers per mass in g^2/w (w = 2 pi f) over
        256 periods.
    status
        A value of `STATUS` for each cell.
    stop
        Flag that ends the work.
    """
    rows, sums = np.empty((MAX_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    log = np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        cell = cell_of(row)
        drive, phase, _ = drive_of(cell, row, waves)
        spent[:] = math.nan
        if raised(stop):
            return
        e = restitution_of(cell)
        _, count, _ = normal_cycle(drive, phase, e, FELT_PERIODS, math.inf, rows)
        first = count // LED_IN
        if count - first < LED_IN:
            continue
        u = velocity_at_start(drive, phase, rows, 0, count)
        u = follow_cycle(rows, first, u, drive, sums, log[:0])[0]
        periods = rows[first:count, SEGMENT.span].sum() / TURN
        spend_over_cycle(drive, rows[first:], count - first, u, periods, sums, log, spent)
        status[number] = STATUS.aperiodic
