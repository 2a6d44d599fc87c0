"""Means of a motion that rounding decides, as exact as a study asks for and no more.

The runs of `chaos` are followed side by side, and the longer, the less is known of the mean: they
stop as soon as its error is within the tolerance.
"""

from __future__ import annotations

import math
from collections import namedtuple

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled
from vibrafeed.core.motion.kernels.arrays import Floats, Stop
from vibrafeed.core.motion.kernels.cells import Cell
from vibrafeed.core.motion.kernels.planar.chaos import (
    PHASES,
    QUARTERS,
    batch_error,
    first_flight,
    share_out,
    slowed,
    stay,
)
from vibrafeed.core.motion.kernels.planar.drive import Drive, rounded, swung_along
from vibrafeed.core.motion.kernels.planar.flow import TURN, kept
from vibrafeed.core.motion.kernels.planar.landings import (
    LANDING,
    NORMAL,
    Landings,
    belong_to,
    land_until,
    with_room,
)
from vibrafeed.core.motion.kernels.planar.rebound import Restitution
from vibrafeed.core.motion.kernels.planar.slide import after_hops
from vibrafeed.core.motion.kernels.planar.solve import UNREPEATED
from vibrafeed.core.motion.kernels.planar.tables import DISTANCE, PIECE, SUMS, TIMES
from vibrafeed.core.motion.kernels.results import COLUMN
from vibrafeed.core.motion.kernels.statuses import MODE, MODES, STATUS

LEAST_TOLERANCE = 1e-3  # from this tolerance on motions that do not repeat end early
FIRST_STAGE = 2.0  # periods of a run up to the first mark; two marks later they are twice as many
DROPPED = 4  # marks before the last, up to which nothing is counted: a quarter of a run
FIRST_ASKED = 7  # mark of the first estimate: 23 periods, of which 17 count; fewer give no error
SHARE = 0.8
"""Factor from the error at 99 % to that at 95 %, with a margin for repeated looks."""

Run = namedtuple("Run", "slip time impacts upheld fastest highest")
"""Columns of the state of a run on its way along the track: what it goes on from, and has seen.

`upheld` is the last time at which it did not slip downhill.
"""

Runs = namedtuple("Runs", "states sums travel marks")
"""The eight runs of a cell, a row a run, as they are now.

`states` with the columns of `Run`, shape (8, 6); `sums`, distance and times in modes, (8, 5);
`travel`, the distance of each period in g/w^2, (8, periods); `marks`, the sums at the last marks
with time, impacts and slip there, (8, 5, 8).
"""

RUN = Run(*range(len(Run._fields)))
TIME, IMPACTS, SLIP, MARK = SUMS, SUMS + 1, SUMS + 2, SUMS + 3
"""Columns of a mark, behind those of the sums: time, impacts and slip of a run so far."""


@compiled
def no_runs(most: int) -> Runs:
    """Return room for eight runs of `most` periods."""
    return Runs(
        np.zeros((PHASES, len(RUN))),
        np.zeros((PHASES, SUMS)),
        np.zeros((PHASES, most)),
        np.zeros((PHASES, DROPPED + 1, MARK)),
    )


@borrowing
def start(runs: Runs, phase: float, drive: Drive, no_log: Floats) -> None:
    """Fill states and sums of new `runs` with their first lift-offs from rest.

    Several such runs, whose means are those of a motion that rounding decides, start at phases of
    their own, each with a jolt of its own. `phase` is the study's own start in rad; `no_log` is an
    empty log.
    """
    for number in range(PHASES):
        run = runs.states[number]
        u, _, _, time, _ = first_flight(number, phase, drive, runs.sums[number], no_log)
        run[RUN.slip], run[RUN.time] = u, time


@borrowing
def follow_on(
    runs: Runs, number: int, until: float, landings: Landings, drive: Drive, no_log: Floats
) -> bool:
    """Follow a run along the track up to the time `until`; False if its landings end before.

    Parameters
    ----------
    runs, number
        The runs, and which of them; its state and sums are changed to those at the end.
    until
        Phase in rad since the start of the run.
    landings
        Those of all runs.
    no_log
        An empty log.
    """
    run, sums, travel = runs.states[number], runs.sums[number], runs.travel[number]
    table, landed = landings.tables[number], int(landings.states[number, NORMAL.landings])
    u, time, hop = run[RUN.slip], run[RUN.time], int(run[RUN.impacts])
    period = int(time // TURN)
    while time < until:
        if hop >= landed:
            return False
        row = table[hop]
        span, up, stays = row[LANDING.span], row[LANDING.rebound], row[LANDING.stays] > 0.0
        u, distance = swung_along(drive, u, span, row[LANDING.swing], row[LANDING.sway])
        u = slowed(u, drive.mu_k, row[LANDING.speed], 0.0 if stays else up)
        hop += 1
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
    run[RUN.slip], run[RUN.time], run[RUN.impacts] = u, time, hop
    if hop > 0:
        run[RUN.fastest] = table[hop - 1, LANDING.fastest]
        run[RUN.highest] = table[hop - 1, LANDING.highest]
    return True


@borrowing
def set_mark(runs: Runs, number: int, mark: int) -> None:
    """Keep what run `number` of the `runs` has so far as its mark k = `mark`, of which few stay."""
    run, own = runs.states[number], runs.marks[number, mark % (DROPPED + 1)]
    for column in range(SUMS):
        own[column] = runs.sums[number, column]
    own[TIME], own[IMPACTS], own[SLIP] = run[RUN.time], run[RUN.impacts], run[RUN.slip]


@borrowing
def fill_quarters(travel: Floats, periods: int, size: int, quarters: Floats) -> None:
    """Fill in the mean velocities of the four quarters, of `size` periods each, of several runs.

    `travel` has the distance of each period in g/w^2 (w = 2 pi f), a row a run, of which the first
    `periods` are done; `quarters` gets the velocities in g/w, shape (runs, 4).
    """
    for number in range(travel.shape[0]):
        for quarter in range(QUARTERS):
            covered, first = 0.0, periods - (QUARTERS - quarter) * size
            for period in range(first, first + size):
                covered += travel[number, period]
            quarters[number, quarter] = covered / (size * TURN)


@borrowing
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


@borrowing
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
    runs, no_log = no_runs(most), np.empty((0, len(PIECE)))
    quarters = np.empty((PHASES, QUARTERS))
    start(runs, phase, drive, no_log)
    settled = drive.c / max(1e-300, drive.mu_k * drive.gn * TURN)
    mark, periods, error = 0, 0, math.inf
    while periods < most:
        periods, begin = end_of(mark, most), end_of(mark - DROPPED, most)
        until = periods * TURN
        for number in range(PHASES):
            while landings.states[number, NORMAL.time] < until and not land_until(
                landings, number, until, drive, e, stop
            ):
                landings = with_room(landings)
            if not follow_on(runs, number, until, landings, drive, no_log):
                return UNREPEATED, landings
            set_mark(runs, number, mark)
        mark += 1
        if mark <= FIRST_ASKED:
            continue
        fill_quarters(runs.travel, periods, (periods - begin) // QUARTERS, quarters)
        velocity = quarters.mean()
        error = SHARE * batch_error(quarters) + cut_error(runs.travel, begin, periods, velocity)
        if begin >= settled and error <= cell.tolerance * abs(velocity):
            break
    return fill(runs, mark, quarters, error, drive, result), landings


@compiled
def fill(runs: Runs, end: int, quarters: Floats, error: float, drive: Drive, result: Floats) -> int:
    """Fill `result` with means of eight runs of a motion that rounding decides; return its status.

    Each run counts from its mark, the end of the periods that are left out. The status is
    `aperiodic`; or `UNREPEATED`, with nothing filled, if a run slides downhill ever faster.

    Parameters
    ----------
    runs
        All of them, now.
    end
        The mark at which they would stand next; the oldest that is kept is theirs.
    quarters
        Mean velocities of the four quarters of each run in g/w (w = 2 pi f), shape (8, 4).
    error
        Error of the mean velocity in g/w.
    drive
        Drive, gravity and friction in g.
    result
        Row with the columns of `COLUMN`.
    """
    marks = runs.marks[:, end % (DROPPED + 1)]
    for number in range(PHASES):
        if runs_off(runs.states[number], marks[number], runs.sums[number], drive):
            return UNREPEATED
    result[:] = 0.0
    velocities = np.empty(PHASES)
    for number in range(PHASES):
        run, mark = runs.states[number], marks[number]
        time = run[RUN.time] - mark[TIME]
        for mode in range(MODES):
            spent = runs.sums[number, TIMES + mode] - mark[TIMES + mode]
            result[COLUMN.stick + mode] += spent / (time * PHASES)
        result[COLUMN.impacts] += (run[RUN.impacts] - mark[IMPACTS]) * TURN / (time * PHASES)
        result[COLUMN.landing_speed] = max(result[COLUMN.landing_speed], run[RUN.fastest])
        result[COLUMN.hop_height] = max(result[COLUMN.hop_height], run[RUN.highest])
        velocities[number] = quarters[number].mean()
    result[COLUMN.velocity] = quarters.mean()
    result[COLUMN.error] = error
    result[COLUMN.spread] = velocities.std() * math.sqrt(PHASES / (PHASES - 1.0))
    return STATUS.aperiodic
