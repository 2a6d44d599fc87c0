"""The means of a motion that repeats."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats, Stop, copy
from vibrafeed.core.motion.kernels.cells import Cell
from vibrafeed.core.motion.kernels.planar.cycle import phase_uncertainty
from vibrafeed.core.motion.kernels.planar.drive import (
    Drive,
    first_slip,
    hop_height,
    lifts,
    slip_uncertainty,
    to_lift_off,
    track_speed,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.planar.rebound import restitution_of
from vibrafeed.core.motion.kernels.planar.settle import settle
from vibrafeed.core.motion.kernels.planar.slide import contact, follow_cycle
from vibrafeed.core.motion.kernels.planar.stays import left_out_softly
from vibrafeed.core.motion.kernels.planar.tables import DISTANCE, PIECE, SEGMENT, SUMS, TIMES
from vibrafeed.core.motion.kernels.results import COLUMN
from vibrafeed.core.motion.kernels.statuses import MODE, MODES, STATUS

ROUNDING = 4e-14  # error of a mean velocity by rounding, over the drive and friction's impulses
CLOSE = 1e-9
"""Largest error of the slip at which a cycle repeats, whatever the tolerance.

That error is read off the slope of the map there, which may change on the way to where it repeats:
where a hundredth was asked for, a mean was off by up to 29 times what was said. The last steps of
Newton's iteration cost next to nothing.
"""
MAX_RUBBING = 8.0
"""Friction adds up over no more than so many times the share of the period in which a part slides,
times its largest: what is huge acts for as short a time."""


@compiled
def velocity_at_start(drive: Drive, phase: float, rows: Floats, first: int, count: int) -> float:
    """Return the slip velocity in g/w at the start of the cycle of a part at rest at `phase`.

    Here w = 2 pi f. The part is followed from `phase` in rad up to the cycle. `rows` hold the
    `count` segments of the motion normal to the floor (columns of `SEGMENT`), the cycle from index
    `first` on. If the part never lifts off the cycle may start anywhere: its first phase in `rows`
    is moved to where slip begins. Without friction on the level, slip velocity plus track velocity
    stays the same.
    """
    if drive.mu_s == 0 and drive.gs == 0:  # nothing acts along the track but the drive
        return track_speed(drive, phase) - track_speed(drive, rows[first, SEGMENT.phase])
    if lifts(drive):
        sums, no_log = np.zeros(SUMS), np.empty((0, len(PIECE)))
        # A part that lifts off starts on the floor, at least at the drive's own zero.
        span = to_lift_off(drive, phase)
        u = contact(phase, span, 0.0, drive, sums, no_log, 0)[0]
        if rows[count - 1, SEGMENT.take_off] >= 0:
            # A cycle without contact: friction brings any velocity to the same motion.
            return 0.0
        return follow_cycle(rows, first, u, drive, sums, no_log)[0] if first > 0 else u
    slip = first_slip(drive, phase)
    if not math.isnan(slip):
        rows[first, SEGMENT.phase] = slip
    return 0.0


@compiled
def keep_speed(
    drive: Drive, phase: float, rows: Floats, count: int, periods: int, sums: Floats
) -> None:
    """Fill the sums over a cycle of a part without friction on the level, which keeps its speed.

    A part that starts at rest on the track, at `phase` in rad, keeps in space the speed that the
    track has there, which is then its mean velocity. `sums` gets the distance in g/(2 pi f)^2 and
    the times in rad in each mode. `rows` hold the `count` segments of the cycle normal to the floor
    (columns of `SEGMENT`; contacts have a take-off below 0), which takes `periods` periods of the
    drive.
    """
    flying = 0.0
    for row in range(count):
        flying += rows[row, SEGMENT.span] if rows[row, SEGMENT.take_off] >= 0 else 0.0
    sums[:] = 0.0
    speed = track_speed(drive, phase)
    sums[DISTANCE] = speed * periods * TURN
    sums[TIMES + (MODE.forward if speed >= 0 else MODE.backward)] = periods * TURN - flying
    sums[TIMES + MODE.flight] = flying


@compiled
def write_impacts(rows: Floats, count: int, drive: Drive, periods: int, result: Floats) -> None:
    """Fill the results that depend on flights: impacts a period, landing speed, hop height.

    `rows` hold the `count` segments of the cycle normal to the floor (columns of `SEGMENT`; flights
    have a take-off of 0 or more), which takes `periods` periods. Landing speed in g/w and hop
    height in g/w^2 (w = 2 pi f) are the largest ones. `result` has the columns of `COLUMN`; `drive`
    gives the height of each flight.
    """
    impacts, fastest, highest = 0, 0.0, 0.0
    for row in range(count):
        if rows[row, SEGMENT.take_off] >= 0:
            impacts += 1
            fastest = max(fastest, rows[row, SEGMENT.landing])
            highest = hop_height(
                drive,
                rows[row, SEGMENT.take_off],
                rows[row, SEGMENT.phase],
                rows[row, SEGMENT.span],
                highest,
            )
    result[COLUMN.impacts] = impacts / periods
    result[COLUMN.landing_speed], result[COLUMN.hop_height] = fastest, highest


@compiled
def repeating(
    rows: Floats, count: int, periods: int, phase: float, u: float, drive: Drive, cell: Cell,
    sums: Floats, log: Floats, result: Floats, stop: Stop,
) -> tuple[int, float]:  # fmt: skip
    """Fill `result` with the mean values of a motion that repeats; return its status and velocity.

    The velocity in g/w (w = 2 pi f) is the slip at the start of the cycle once it repeats
    (`settle`). The means are v = x/T and the shares t_mode/T of the sums over the cycles after
    which it repeats. If no repeating motion along the track is found, `result` is left as it was
    (theory 13.8).

    Parameters
    ----------
    rows, count, periods
        The segments of the cycle normal to the floor (columns of `SEGMENT`), how many, and the
        periods that they take.
    phase
        Phase in rad at which the part starts from rest.
    u
        Slip velocity in g/w with which the cycle is first entered.
    drive, cell
        Drive, gravity and friction in g; numbers of the cell, with the settings.
    sums, log
        Filled with distance and times in modes, and with the motion pieces of the last pass.
    result
        One value a column of `COLUMN`.
    stop
        Flag that ends the work.
    """
    c, s, gs, gn, mu_s, mu_k = drive.c, drive.s, drive.gs, drive.gn, drive.mu_s, drive.mu_k
    error, cycles, status = 0.0, 1, STATUS.neutral
    if mu_s == 0:
        keep_speed(drive, phase, rows, count, periods, sums)
    else:
        u, error, cycles, status = settle(
            rows, count, u, drive, min(cell.tolerance, CLOSE), int(cell.max_periods), sums, log,
            stop,
        )  # fmt: skip
        if cycles == 0:
            return status, 0.0
    if mu_s != mu_k:
        total = np.zeros(SUMS)
        velocity = u
        for _ in range(cycles):
            velocity, _, _ = follow_cycle(rows, count, velocity, drive, sums, log)
            for place in range(SUMS):
                total[place] += sums[place]
        copy(total, sums)
    time = periods * cycles * TURN
    result[COLUMN.velocity], result[COLUMN.spread] = sums[DISTANCE] / time, 0.0
    slides = (sums[TIMES + MODE.forward] + sums[TIMES + MODE.backward]) / time
    e = restitution_of(cell)
    doubt = ROUNDING + (phase_uncertainty(rows, count, drive, e) if lifts(drive) else 0.0)
    rubbing = mu_k * (s + gn) * min(1.0, MAX_RUBBING * slides)
    result[COLUMN.error] = error + doubt * (c + abs(gs) + rubbing)
    result[COLUMN.error] += mu_k * left_out_softly(rows, count, drive, e)[0] / (periods * TURN)
    if mu_s > mu_k and sums[TIMES + MODE.stick] > 0.0:
        result[COLUMN.error] += slip_uncertainty(drive) * slides
    for mode in range(MODES):
        result[COLUMN.stick + mode] = sums[TIMES + mode] / time
    write_impacts(rows, count, drive, periods, result)
    result[COLUMN.multiple] = float(periods * cycles)
    return status, u
