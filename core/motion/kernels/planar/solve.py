"""One cell from its groups to its results, and many cells."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats, Statuses
from core.motion.kernels.planar.chaos import from_phases
from core.motion.kernels.planar.cycle import normal_cycle, phase_doubt
from core.motion.kernels.planar.flight import hop_height
from core.motion.kernels.planar.flow import TURN, Drive, arc_sine, phase_to
from core.motion.kernels.planar.settle import settle
from core.motion.kernels.planar.slide import contact, follow_cycle, stick_range, two_sided
from core.motion.kernels.planar.tables import (
    DISTANCE,
    MOST_SEGMENTS,
    PIECE,
    SEGMENT,
    SUMS,
    TIMES,
    Cell,
    cell_of,
)
from core.motion.kernels.results import COLUMN
from core.motion.kernels.statuses import MODE, MODES, STATUS

UNDECIDED = -1  # no status: the cell needs its cycle
LEAST_GRAVITY = 1e-12  # onto the floor, of all: less is the rounding of an upright track
ROUNDING = 4e-14  # of a mean velocity, per unit of the drive and of friction's impulses
MOST_RUBBING = 8.0
"""Friction adds up over no more than so many times the share of the period in which a part slides,
times its largest: what is huge acts for as short a time."""
THRESHOLD = 4e-16  # rounding of the sine at which friction is overcome


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
def velocity_at_start(drive: Drive, phase: float, rows: Floats, count: int) -> float:
    """Return the velocity at the start of a cycle of a part at rest on the floor at `phase`.

    Where it never lifts off the cycle may start anywhere: it is moved to where slip begins.
    """
    c, s, gs, gn, mu_s = drive.c, drive.s, drive.gs, drive.gn, drive.mu_s
    if mu_s == 0 and gs == 0:  # nothing acts along the track but the drive
        return c * (math.cos(phase) - math.cos(rows[0, SEGMENT.phase]))
    if s > gn:
        sums = np.zeros(SUMS)
        # A part that lifts off starts on the floor, at least at the drive's own zero.
        span = phase_to(math.asin(gn / s), phase)
        u = contact(phase, span, 0.0, drive, sums, np.empty((0, len(PIECE))), 0)[0]
        if rows[count - 1, SEGMENT.take_off] >= 0:
            # A cycle without contact: friction brings any velocity to the same motion.
            return 0.0
        return u
    least, largest, _ = stick_range(c, s, gs, gn, mu_s)
    rises, falls = largest < 1, least > -1
    if rises and (math.cos(phase) > 0 or not falls):
        rows[0, SEGMENT.phase] = arc_sine(largest)
    elif falls:
        rows[0, SEGMENT.phase] = math.pi - arc_sine(least)
    return 0.0


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
def keep_speed(
    drive: Drive, phase: float, rows: Floats, count: int, periods: int, sums: Floats
) -> None:
    """Fill `sums` over a cycle without friction.

    As the part does not run away on the level, it keeps the speed that the track had at the start:
    the fastest forward, or backward half a turn later.
    """
    flying = 0.0
    for row in range(count):
        flying += rows[row, SEGMENT.span] if rows[row, SEGMENT.take_off] >= 0 else 0.0
    sums[:] = 0.0
    sums[DISTANCE] = drive.c * math.cos(phase) * periods * TURN
    sums[TIMES + (MODE.forward if math.cos(phase) > 0 else MODE.backward)] = periods * TURN - flying
    sums[TIMES + MODE.flight] = flying


@compiled
def write_impacts(rows: Floats, count: int, drive: Drive, periods: int, result: Floats) -> None:
    """Fill what the flights of a cycle give: impacts per period, their speed, the height."""
    impacts, fastest, highest = 0, 0.0, 0.0
    for row in range(count):
        if rows[row, SEGMENT.take_off] >= 0:
            impacts += 1
            fastest = max(fastest, rows[row, SEGMENT.landing])
            highest = hop_height(
                rows[row, SEGMENT.take_off],
                drive.s,
                drive.gn,
                rows[row, SEGMENT.phase],
                rows[row, SEGMENT.span],
                highest,
            )
    result[COLUMN.impacts] = impacts / periods
    result[COLUMN.landing_speed], result[COLUMN.hop_height] = fastest, highest


@compiled
def slip_doubt(drive: Drive) -> float:
    """Return how much velocity hangs on the rounding of the phases where a slip starts.

    Friction falls there from the static to the kinetic one, so that a slip starts with a jerk. Its
    phase, asin of the threshold, is known the less, the nearer the threshold is to 1.
    """
    least, largest, _ = stick_range(drive.c, drive.s, drive.gs, drive.gn, drive.mu_s)
    jump = (drive.mu_s - drive.mu_k) * (drive.s + drive.gn)
    doubt = 0.0
    for threshold in (least, largest):
        if abs(threshold) < 1.0:
            doubt += jump * THRESHOLD / math.sqrt((1.0 - threshold) * (1.0 + threshold))
    return doubt


@compiled
def solve(
    cell: Cell, rows: Floats, sums: Floats, log: Floats, result: Floats
) -> tuple[int, int, float]:
    """Fill `result`, one value a field of `Motion`; return status, segments and velocity.

    `rows` then holds the cycle, so many segments, which starts at that velocity; the log holds its
    last pass. All in the axes of the drive as mirrored by `upright`.
    """
    drive, phase, way = upright(cell)
    c, s, gs, gn, mu_s, mu_k = drive
    e, most_periods = cell.restitution, int(cell.most_periods)
    result[:] = math.nan
    status = solve_at_once(drive, e, way, log.shape[0] == 0, result)
    if status != UNDECIDED:
        return status, 0, 0.0
    count, periods = normal_cycle(s, gn, e, most_periods, rows)
    if periods < 1:
        status = STATUS.limit_reached
        if periods == 0:
            status = from_phases(phase, drive, e, most_periods, result)
        if status == STATUS.aperiodic:
            turn_round(result, way)
        else:
            result[:] = math.nan
        return status, 0, 0.0
    u = velocity_at_start(drive, phase, rows, count)
    error, cycles, status = 0.0, 1, STATUS.neutral
    if mu_s == 0:
        keep_speed(drive, phase, rows, count, periods, sums)
    else:
        u, error, cycles, status = settle(
            rows, count, u, drive, cell.tolerance, most_periods, sums, log
        )
        if cycles == 0:
            return status, 0, 0.0
    if mu_s != mu_k:
        total = np.zeros(SUMS)
        velocity = u
        for _ in range(cycles):
            velocity, _, _ = follow_cycle(rows, count, velocity, drive, sums, log)
            total += sums
        sums[:] = total
    time = periods * cycles * TURN
    result[COLUMN.velocity], result[COLUMN.spread] = sums[DISTANCE] / time, 0.0
    slides = (sums[TIMES + MODE.forward] + sums[TIMES + MODE.backward]) / time
    doubt = ROUNDING + (phase_doubt(rows, count, s, gn, e) if s > gn else 0.0)
    rubbing = mu_k * (s + gn) * min(1.0, MOST_RUBBING * slides)
    result[COLUMN.error] = error + doubt * (abs(c) + abs(gs) + rubbing)
    if mu_s > mu_k and sums[TIMES + MODE.stick] > 0.0:
        result[COLUMN.error] += slip_doubt(drive) * slides
    for mode in range(MODES):
        result[COLUMN.stick + mode] = sums[TIMES + mode] / time
    write_impacts(rows, count, drive, periods, result)
    result[COLUMN.multiple] = float(periods * cycles)
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
