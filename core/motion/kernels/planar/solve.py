"""One cell from its groups to its results, and many cells."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.cells import Cell, cell_of
from vibrafeed.core.motion.kernels.planar.cycle import Chain, cycle_in, no_chain
from vibrafeed.core.motion.kernels.planar.drive import (
    Drive,
    Waves,
    always_holds,
    drive_of,
    two_sided,
)
from vibrafeed.core.motion.kernels.planar.growth import MAX_GROWTH
from vibrafeed.core.motion.kernels.planar.rebound import restitution_of
from vibrafeed.core.motion.kernels.planar.repeating import (
    ROUNDING,
    repeating,
    velocity_at_start,
)
from vibrafeed.core.motion.kernels.planar.tables import PIECE, SUMS
from vibrafeed.core.motion.kernels.results import COLUMN
from vibrafeed.core.motion.kernels.statuses import STATUS

UNDECIDED = -1  # no status of results: the cell needs its cycle
UNREPEATED = -2  # no status of results: no cycle was found, and long runs give the means
LEAST_GRAVITY = 1e-12  # onto the floor, in g: less is the rounding of an upright track


@compiled
def turn_round(result: Floats, way: float) -> None:
    """Turn the results of a motion along the mirrored track back into the direction of the study.

    If `way` is -1: v -> -v, and the shares forward and backward change places in `result` (columns
    of `COLUMN`). Nothing if it is 1. A sine is solved with a positive amplitude along only.
    """
    if way < 0:
        result[COLUMN.velocity] = -result[COLUMN.velocity]
        forward, backward = result[COLUMN.forward], result[COLUMN.backward]
        result[COLUMN.forward], result[COLUMN.backward] = backward, forward


@compiled
def solve_at_once(drive: Drive, e: float, result: Floats) -> int:
    """Fill the result of a cell that needs no cycle and return its status; else `UNDECIDED`.

    `runaway` if |sin(gamma)| > mu_s n, `at_rest` if static friction always holds, `limit_reached`
    if a number is not finite, nothing presses the part onto the floor, or |sin(gamma)| = mu_k n:
    the mean is then that of the start, for ever (theory 13.8). gamma is the slope of the track, n
    the load onto it in g: cos(gamma), and any hold-down force. `e` is the restitution or damping,
    `result` has the columns of `COLUMN`.
    """
    gs, gn, mu_s, mu_k = drive.gs, drive.gn, drive.mu_s, drive.mu_k
    if not math.isfinite(drive.c + drive.s + gs + gn + mu_s + mu_k + e):
        return STATUS.limit_reached
    if abs(gs) > mu_s * gn:
        # Friction gives no more than mu_s times the mean normal force, which is gravity's.
        return STATUS.runaway
    if gn <= LEAST_GRAVITY:
        return STATUS.limit_reached
    if always_holds(drive):
        result[:] = 0.0
        result[COLUMN.stick], result[COLUMN.multiple] = 1.0, 1.0
        return STATUS.at_rest
    if gs != 0 and abs(abs(gs) - mu_k * gn) <= 4e-16 * abs(gs):
        # Kinetic friction just balances gravity: the mean is that of the start, for ever.
        return STATUS.limit_reached
    return UNDECIDED


@compiled
def slides_on(drive: Drive, result: Floats) -> bool:
    """Fill the result of a part that slides to and fro and never sticks; return True if it does.

    Its mean velocity has a closed form (theory 13.8), so that no cycle need be followed. `drive`
    holds drive, gravity and friction in g; `result` (columns of `COLUMN`) gets velocity and error
    in g/(2 pi f), and the shares of time forward and backward. It is left as it is if the motion is
    another.
    """
    velocity, forward = two_sided(drive)
    if not forward > 0:
        return False
    result[:] = 0.0
    result[COLUMN.velocity] = velocity
    rubbing = drive.mu_k * (drive.s + drive.gn)
    result[COLUMN.error] = ROUNDING * (drive.c + abs(drive.gs) + rubbing)
    result[COLUMN.forward], result[COLUMN.backward] = forward, 1 - forward
    result[COLUMN.multiple] = 1.0
    return True


@compiled
def solve(
    drive: Drive, phase: float, cell: Cell, chain: Chain, sums: Floats, log: Floats, result: Floats,
    stop: Stop,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Solve the motion of one cell: fill `result`, and return the status and the cycle's place.

    The part starts at rest at `phase` in rad. The rows of `chain`, which knows the cell before,
    then hold the cycle from the first of these segments to before the end, with this slip in g/w
    (w = 2 pi f); `sums` and `log` hold distance, times and motion pieces of its last pass. If no
    cycle is found, `result` (columns of `COLUMN`) is left as it was, and the status is
    `UNREPEATED`.
    """
    rows, e = chain.rows, restitution_of(cell)
    max_periods = int(cell.max_periods)
    first, count, periods = cycle_in(chain, drive, phase, e, max_periods, MAX_GROWTH)
    if periods < 1:
        status = UNREPEATED if periods == 0 else STATUS.limit_reached
        first, count, u = 0, 0, 0.0
    else:
        u = velocity_at_start(drive, phase, rows, first, count)
        status, u = repeating(
            rows[first:], count - first, periods, phase, u, drive, cell, sums, log, result,
            stop,
        )  # fmt: skip
    if math.isnan(result[COLUMN.velocity]):
        return status, 0, 0, 0.0
    result[COLUMN.across] = 0.0
    return status, first, count, u


@compiled
def solve_cell(
    cell: Cell, row: Floats, waves: Waves, closed: bool, chain: Chain, sums: Floats, log: Floats,
    result: Floats, stop: Stop,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Fill the result of a cell of planar motion; return its status and where its cycle stands.

    Results are in the row's own direction, segments and velocity, in g/(2 pi f), as mirrored by
    `upright`. `waves` is the room for the drive; `closed` allows the closed form of a motion
    without stick, which leaves no segments; `chain`, `sums` and `log` are filled as in `solve`;
    `result` has the columns of `COLUMN`.
    """
    drive, phase, way = drive_of(cell, row, waves)
    result[:] = math.nan
    e = cell.restitution + cell.impact_damping
    status, first, count, u = solve_at_once(drive, e, result), 0, 0, 0.0
    if status == UNDECIDED and closed and slides_on(drive, result):
        status = STATUS.periodic
    if status == UNDECIDED:
        status, first, count, u = solve(drive, phase, cell, chain, sums, log, result, stop)
    turn_round(result, way)
    return status, first, count, u


@compiled
def solve_cells(groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and statuses of cells with the means of their motion.

    Parameters
    ----------
    groups
        A row a cell: the fields of `Cell`, then its wave.
    waves
        Room for the drive of a cell, used again for each.
    table
        A row a cell, with the columns of `COLUMN`.
    status
        A value of `STATUS` for each cell, or `UNREPEATED` if no cycle was found.
    stop
        Flag that ends the work; cells not reached are left as they are.
    """
    chain, sums, log = no_chain(), np.empty(SUMS), np.empty((0, len(PIECE)))
    for number in range(groups.shape[0]):
        row, result = groups[number], table[number]
        found = solve_cell(cell_of(row), row, waves, True, chain, sums, log, result, stop)
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = found[0]
