"""One cell from its groups to its results, and many cells."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats, Statuses
from core.motion.kernels.planar.chaos import from_phases
from core.motion.kernels.planar.cycle import normal_cycle
from core.motion.kernels.planar.flow import Drive
from core.motion.kernels.planar.growth import MOST_GROWTH
from core.motion.kernels.planar.repeating import ROUNDING, repeating, velocity_at_start
from core.motion.kernels.planar.slide import stick_range, two_sided
from core.motion.kernels.planar.tables import MOST_SEGMENTS, PIECE, SEGMENT, SUMS, Cell, cell_of
from core.motion.kernels.results import COLUMN
from core.motion.kernels.statuses import STATUS

UNDECIDED = -1  # no status: the cell needs its cycle
LEAST_GRAVITY = 1e-12  # onto the floor, of all: less is the rounding of an upright track


@compiled
def upright(cell: Cell) -> tuple[Drive, float, float]:
    """Return the drive with c and s positive, phase and way.

    A drive that points down pushes up half a turn later; one that points back is the mirror image.
    `phase` is where the study's own phase 0 lies, `way` is -1 in the mirror.
    """
    c, s, gs = cell.drive_number_along, cell.drive_number_normal, cell.gravity_number_along
    phase, way = 0.0, 1.0
    if s < 0:
        c, s, phase = -c, -s, math.pi
    if c < 0:
        c, gs, way = -c, -gs, -1.0
    return (
        Drive(c, s, gs, cell.gravity_number_normal, cell.friction_static, cell.friction_kinetic),
        phase,
        way,
    )


@compiled
def turn_round(result: Floats, way: float) -> None:
    """Undo the mirror image of `upright`."""
    if way < 0:
        result[COLUMN.velocity] = -result[COLUMN.velocity]
        forward, backward = result[COLUMN.forward], result[COLUMN.backward]
        result[COLUMN.forward], result[COLUMN.backward] = backward, forward


@compiled
def solve_at_once(drive: Drive, e: float, way: float, closed: bool, result: Floats) -> int:
    """Return the status of a cell that needs no cycle and fill its result; else `UNDECIDED`.

    `closed` allows the closed form of a motion without stick.
    """
    c, s, gs, gn, mu_s, mu_k = drive
    if not math.isfinite(c + s + gs + gn + mu_s + mu_k + e):
        return STATUS.limit_reached
    if abs(gs) > mu_s * gn:
        # Friction gives no more than mu_s times the mean normal force, which is gravity's.
        return STATUS.runaway
    if gn <= LEAST_GRAVITY:
        return STATUS.limit_reached
    least, largest, _ = stick_range(c, s, gs, gn, mu_s)
    if s <= gn and least <= -1 and largest >= 1:
        result[:] = 0.0
        result[COLUMN.stick], result[COLUMN.multiple] = 1.0, 1.0
        return STATUS.at_rest
    if gs != 0 and abs(abs(gs) - mu_k * gn) <= 4e-16 * abs(gs):
        # Kinetic friction just balances gravity: the mean is that of the start, for ever.
        return STATUS.limit_reached
    velocity, forward = two_sided(drive)
    if forward > 0 and closed:
        result[:] = 0.0
        result[COLUMN.velocity] = velocity
        result[COLUMN.error] = ROUNDING * (abs(c) + abs(gs) + mu_k * (s + gn))
        result[COLUMN.forward], result[COLUMN.backward] = forward, 1 - forward
        result[COLUMN.multiple] = 1.0
        turn_round(result, way)
        return STATUS.periodic
    return UNDECIDED


@compiled
def solve(
    cell: Cell, rows: Floats, sums: Floats, log: Floats, result: Floats
) -> tuple[int, int, float]:
    """Fill `result`, one value a field of `Motion`; return status, segments and velocity.

    `rows` then holds the cycle, so many segments, which starts at that velocity; the log holds its
    last pass. All in the axes of the drive as mirrored by `upright`.
    """
    drive, phase, way = upright(cell)
    e, most_periods = cell.restitution, int(cell.most_periods)
    result[:] = math.nan
    status = solve_at_once(drive, e, way, log.shape[0] == 0, result)
    if status != UNDECIDED:
        return status, 0, 0.0
    count, periods = normal_cycle(drive.s, drive.gn, e, most_periods, MOST_GROWTH, rows)
    if periods < 1:
        status = STATUS.limit_reached
        if periods == 0:
            status = from_phases(cell, phase, drive, rows, sums, result)
        count, u = 0, 0.0
    else:
        u = velocity_at_start(drive, phase, rows, count)
        status, u = repeating(rows, count, periods, phase, u, drive, cell, sums, log, result)
    if math.isnan(result[COLUMN.velocity]):
        return status, 0, 0.0
    turn_round(result, way)
    return status, count, u


@compiled
def solve_cells(groups: Floats, table: Floats, status: Statuses) -> None:
    """Fill table and status of cells; a row of `groups` holds the fields of `Cell`."""
    rows = np.empty((MOST_SEGMENTS, len(SEGMENT)))
    sums = np.empty(SUMS)
    log = np.empty((0, len(PIECE)))
    for number in range(groups.shape[0]):
        cell = cell_of(groups[number])
        status[number] = solve(cell, rows, sums, log, table[number])[0]
