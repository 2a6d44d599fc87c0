"""Means of a motion that rounding decides, as exact as a study asks for and no more.

The runs of `chaos` are followed side by side, and the longer, the less is known of the mean: they
stop as soon as its error is within the tolerance.
"""

from __future__ import annotations

import math
from collections import namedtuple

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats, Stop
from core.motion.kernels.cells import Cell
from core.motion.kernels.planar.chaos import (
    PHASES,
    QUARTERS,
    batch_error,
    first_flight,
    share_out,
    slowed,
    stay,
)
from core.motion.kernels.planar.drive import Drive, rounded, swung_along
from core.motion.kernels.planar.flow import TURN, kept
from core.motion.kernels.planar.landings import (
    LANDING,
    NORMAL,
    Landings,
    belong_to,
    land_until,
    with_room,
)
from core.motion.kernels.planar.rebound import Restitution
from core.motion.kernels.planar.slide import after_hops
from core.motion.kernels.planar.solve import UNREPEATED
from core.motion.kernels.planar.tables import DISTANCE, PIECE, SUMS, TIMES
from core.motion.kernels.results import COLUMN
from core.motion.kernels.statuses import MODE, MODES, STATUS

LEAST_TOLERANCE = 1e-3  # from this tolerance on motions that do not repeat end early
FIRST_STAGE = 2.0  # periods of a run up to the first mark; two marks later they are twice as many
DROPPED = 4  # marks before the last, up to which nothing is counted: a quarter of a run
FIRST_ASKED = 7  # mark of the first estimate: 23 periods, of which 17 count; fewer give no error
SHARE = 0.8
"""Factor from the error at 99 % to that at 95 %, with a margin for repeated looks."""

Run = namedtuple("Run", "slip time impacts upheld fastest highest")
"""Columns of a run on its way along the track: what it goes on from, and what it has seen.

`upheld` is the last time at which it did not slip downhill.
"""

RUN = Run(*range(len(Run._fields)))
TIME, IMPACTS, SLIP, MARK = SUMS, SUMS + 1, SUMS + 2, SUMS + 3
"""Columns of a mark, behind those of the sums: time, impacts and slip of a run so far."""


@compiled
def start(number: int, phase: float, drive: Drive, sums: Floats, run: Floats) -> None:
    """Fill state and sums of a long run with its first lift-off from rest.

    Several such runs, whose means are those of a motion that rounding decides, start at phases of
    their own, each with a jolt of its own. `number` is that of the run, `phase` the study's own
    start in rad; `run` has the columns of `RUN`, `sums` holds distance and times in modes.
    """
    sums[:], run[:] = 0.0, 0.0
    no_log = np.empty((0, len(PIECE)))
    u, _, _, time, _ = first_flight(number, phase, drive, sums, no_log)
    run[RUN.slip], run[RUN.time] = u, time


@compiled
def follow_on(
    run: Floats, until: float, table: Floats, landed: int, drive: Drive, travel: Floats,
    sums: Floats,
) -> bool:  # fmt: skip
    """Follow a run along the track up to the time `until`; False if its landings end before.

    Parameters
    ----------
    run
        State of the run, columns of `RUN`; changed to that at the end.
    until
        Phase in rad since the start of the run.
    table, landed
        Its landings, columns of `LANDING`, and how many there are.
    travel
        Filled with the distance of each period in g/w^2 (w = 2 pi f).
    sums
        Distance and times in modes, as in `contact`.
    """
    no_log = np.empty((0, len(PIECE)))
    u, time, number = run[RUN.slip], run[RUN.time], int(run[RUN.impacts])
    period = int(time // TURN)
    while time < until:
        if number >= landed:
            return False
        row = table[number]
        span, up, stays = row[LANDING.span], row[LANDING.rebound], row[LANDING.stays] > 0.0
        u, distance = swung_along(drive, u, span, row[LANDING.swing], row[LANDING.sway])
        u = slowed(u, drive.mu_k, row[LANDING.speed], 0.0 if stays else up)
        number += 1
        began, covered = time, sums[DISTANCE]
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        time += span
        if stays:
            tau = (row[LANDING.phase] + span) % TURN
            u, _, span = stay(drive, tau, after_hops(drive, tau, u, up), sums, no_log)
            time += span
        period = share_out(travel, period, began, time, sums[DISTANCE] - covered)
        if u * drive.gs >= 0:
            run[RUN.upheld] = time
    run[RUN.slip], run[RUN.time], run[RUN.impacts] = u, time, number
    if number > 0:
        run[RUN.fastest] = table[number - 1, LANDING.fastest]
        run[RUN.highest] = table[number - 1, LANDING.highest]
    return True


@compiled
def runs_off(run: Floats, mark: Floats, sums: Floats, drive: Drive) -> bool:
    """True if a run has slipped downhill at all landings since a mark and is faster now.

    Such a part runs away. `run` is its state now (columns of `RUN`), `sums` its distance and times;
    `mark` holds the same sums at the mark, with its time, impacts and slip. Kinetic friction must
    be less than gravity along the track.
    """
    gs = drive.gs
    faster = abs(run[RUN.slip]) > abs(mark[SLIP]) and run[RUN.upheld] <= mark[TIME]
    held = TIMES + (MODE.forward if gs > 0 else MODE.backward), TIMES + MODE.stick
    uphill = sums[held[0]] - mark[held[0]] + sums[held[1]] - mark[held[1]]
    return drive.mu_k * drive.gn < abs(gs) and faster and uphill == 0


@compiled
def end_of(mark: int, most: int) -> int:
    """Return the number of periods up to mark k = `mark` of a run, 2 x 2^(k/2), at most `most`."""
    return min(most, round(FIRST_STAGE * 2.0 ** (0.5 * mark)))


@compiled
def cut_error(travel: Floats, begin: int, end: int, velocity: float) -> float:
    """Return the error of mean velocities because runs end anywhere within a near repetition.

    The mean over the runs of max |x_p - v T|/((end - begin) T), in g/w (w = 2 pi f), with the
    distance x_p = `travel[run, p]` in g/w^2 of period p from `begin` to before `end`, v =
    `velocity` in g/w and T = 2 pi.
    """
    total = 0.0
    for number in range(travel.shape[0]):
        most = 0.0
        for period in range(begin, end):
            most = max(most, abs(travel[number, period] - velocity * TURN))
        total += most
    return total / (travel.shape[0] * (end - begin) * TURN)


@compiled
def means_within(
    cell: Cell, phase: float, drive: Drive, landings: Landings, result: Floats, stop: Stop
) -> tuple[int, Landings]:
    """Fill `result` with means of a motion that rounding decides, to a tolerance of its velocity.

    Eight runs from as many phases end if error <= tolerance |v|, or after `max_periods`/8 each; the
    error is 0.8 of the `batch_error` of their quarters plus their `cut_error`. Between two looks a
    run grows by a factor of sqrt(2); its first quarter is not counted, at least the c/(2 pi mu n)
    periods in which friction stops a part as fast as the drive. Return the status; `UNREPEATED`,
    with nothing filled, if a run nears a cycle, runs away or is too short. `phase` is the study's
    own start in rad. `landings` are those that were found for the cell before; they are returned
    too, with those of this cell.
    """
    drive = rounded(drive)
    e = Restitution(kept(cell.restitution), kept(cell.impact_damping))
    most = int(cell.max_periods) // PHASES
    if most < end_of(FIRST_ASKED, most + 1):
        return UNREPEATED, landings
    belong_to(landings, drive, e, phase)
    runs, all_sums = np.empty((PHASES, len(RUN))), np.empty((PHASES, SUMS))
    travel, marks = np.zeros((PHASES, most)), np.zeros((PHASES, DROPPED + 1, MARK))
    quarters = np.empty((PHASES, QUARTERS))
    for number in range(PHASES):
        start(number, phase, drive, all_sums[number], runs[number])
    settled = drive.c / max(1e-300, drive.mu_k * drive.gn * TURN)
    mark, periods, error = 0, 0, math.inf
    while periods < most:
        periods, begin = end_of(mark, most), end_of(mark - DROPPED, most)
        for number in range(PHASES):
            run, own, until = runs[number], marks[number, mark % (DROPPED + 1)], periods * TURN
            while not land_until(landings, number, until, drive, e, stop):
                landings = with_room(landings)
            landed = int(landings.states[number, NORMAL.landings])
            table, covered = landings.tables[number], all_sums[number]
            if not follow_on(run, until, table, landed, drive, travel[number], covered):
                return UNREPEATED, landings
            for column in range(SUMS):
                own[column] = all_sums[number, column]
            own[TIME], own[IMPACTS], own[SLIP] = run[RUN.time], run[RUN.impacts], run[RUN.slip]
        mark += 1
        if mark <= FIRST_ASKED:
            continue
        size = (periods - begin) // QUARTERS
        for number in range(PHASES):
            for quarter in range(QUARTERS):
                first = periods - (QUARTERS - quarter) * size
                covered = travel[number, first : first + size].sum()
                quarters[number, quarter] = covered / (size * TURN)
        velocity = quarters.mean()
        error = SHARE * batch_error(quarters) + cut_error(travel, begin, periods, velocity)
        if begin >= settled and error <= cell.tolerance * abs(velocity):
            break
    first = mark % (DROPPED + 1)
    status = fill(runs, marks[:, first], all_sums, quarters, error, drive, result)
    return status, landings


@compiled
def fill(
    runs: Floats, marks: Floats, all_sums: Floats, quarters: Floats, error: float, drive: Drive,
    result: Floats,
) -> int:  # fmt: skip
    """Fill `result` with means of eight runs of a motion that rounding decides; return its status.

    Each run counts from its mark, the end of the periods that are left out. The status is
    `aperiodic`; or `UNREPEATED`, with nothing filled, if a run slides downhill ever faster.

    Parameters
    ----------
    runs, all_sums
        State now (columns of `RUN`), and distance and times in modes, a row a run.
    marks
        A row a run: the sums at its mark, then time, impacts and slip.
    quarters
        Mean velocities of the four quarters of each run in g/w (w = 2 pi f), shape (8, 4).
    error
        Error of the mean velocity in g/w.
    drive
        Drive, gravity and friction in g.
    result
        Row with the columns of `COLUMN`.
    """
    for number in range(PHASES):
        if runs_off(runs[number], marks[number], all_sums[number], drive):
            return UNREPEATED
    result[:] = 0.0
    velocities = np.empty(PHASES)
    for number in range(PHASES):
        run, mark = runs[number], marks[number]
        time = run[RUN.time] - mark[TIME]
        for mode in range(MODES):
            spent = all_sums[number, TIMES + mode] - mark[TIMES + mode]
            result[COLUMN.stick + mode] += spent / (time * PHASES)
        result[COLUMN.impacts] += (run[RUN.impacts] - mark[IMPACTS]) * TURN / (time * PHASES)
        result[COLUMN.landing_speed] = max(result[COLUMN.landing_speed], run[RUN.fastest])
        result[COLUMN.hop_height] = max(result[COLUMN.hop_height], run[RUN.highest])
        velocities[number] = quarters[number].mean()
    result[COLUMN.velocity] = quarters.mean()
    result[COLUMN.error] = error
    result[COLUMN.spread] = velocities.std() * math.sqrt(PHASES / (PHASES - 1.0))
    return STATUS.aperiodic
