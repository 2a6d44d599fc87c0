"""Means of a motion that rounding decides, as exact as a study asks for and no more.

The runs of `chaos` are followed side by side until the error is within the tolerance. Their
landings, which cells of one drive and rebound have in common, take nine times as long to find as
the slip between them: those of the last motion are kept.
"""

import math
from collections import namedtuple

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.constants import (
    COLUMN,
    DISTANCE,
    MAX_SEGMENTS,
    MODE,
    MODES,
    PIECE,
    SEGMENT,
    STATUS,
    SUMS,
    TIMES,
    UNREPEATED,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats, Stop
from vibrafeed.core.motion.kernels.planar.along import slip_after_hops
from vibrafeed.core.motion.kernels.planar.chaos import (
    HOPS_PER_PERIOD,
    MAX_STARTS,
    PHASES,
    QUARTERS,
    SEARCHES,
    SETTLED_ROUGHLY,
    batch_error,
    contact_to_lift_off,
    distribute_distance,
    first_flight,
    jolt_speed,
    slip_after_landing,
)
from vibrafeed.core.motion.kernels.planar.cycle import (
    FIRST_LOOK,
    LONGEST_CYCLE,
    find_cycle,
    matches_and_stores,
    write_segment,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN, rounded_to_32_bits
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    Restitution,
    air_integrals,
    along_from_integrals,
    hop_height,
    impulse,
    landing,
    lift_off,
    rebound,
    rests,
    rise,
    rounded,
    to_lift_off,
)

APART = 1e6
"""Times the jolt of a lift-off from rest, by which runs start: at once they go different ways.
Those of `chaos` take tens of periods to lose eight digits."""
HOP_CAPACITY = MAX_SEGMENTS // PHASES  # rows for a run's hops since the part was at rest
FIRST_ROOM = 256  # landings of a run for which there is room at first; it doubles when full
ON_ITS_WAY, ENDED = 0.0, 1.0
"""Whether more landings of a run can be found."""

Landing = namedtuple(
    "Landing", "phase span speed rebound stays fastest highest air_velocity air_distance"
)
"""Columns of the landings of a run, of the flight that ends there, in rad, g/w and g/w^2.

`stays` is 1 if the part then stays on the floor; `fastest` and `highest` are the largest of the run
so far; the last two are the flight's `air_integrals`.
"""

Normal = namedtuple("Normal", "phase rebound time landings hops look jolt ended")
"""Columns of the state of a run normal to the floor: what it goes on from.

`landings` so far, `hops` since the last rest, of which `look` is when a cycle is looked for next.
"""

Landings = namedtuple("Landings", "owner states segments tables")
"""The motion that the landings are of (`owner`, shape (5,)), and the eight runs: `states` (8, 8),
`segments` of those that look for cycles (3, capacity, 5), `tables` of landings (8, room, 9)."""

LANDING, NORMAL = Landing(*range(len(Landing._fields))), Normal(*range(len(Normal._fields)))


@compiled
def empty_landings() -> Landings:
    """Return room for the landings of eight runs, which belong to no motion yet."""
    return Landings(
        np.full(5, math.nan),
        np.zeros((PHASES, len(NORMAL))),
        np.empty((SEARCHES, HOP_CAPACITY, len(SEGMENT))),
        np.zeros((PHASES, FIRST_ROOM, len(LANDING))),
    )


@compiled
def reset_unless_of(
    landings: Landings, drive: Drive, restitution: Restitution, phase: float
) -> None:
    """Make `landings` those of a motion: kept if they are, else begun with its first lift-offs."""
    if matches_and_stores(landings.owner, drive, restitution, phase):
        return
    sums, no_log = np.zeros(SUMS), np.empty((0, len(PIECE)))
    landings.states[:] = 0.0
    landings.tables[:, 0] = 0.0
    for index in range(PHASES):
        state = landings.states[index]
        _, take_off, tau, time, _ = first_flight(index, phase, drive, sums, no_log)
        state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time] = tau, take_off * APART, time
        state[NORMAL.look], state[NORMAL.jolt] = FIRST_LOOK, index


@compiled
def with_double_room(landings: Landings) -> Landings:
    """Return the same landings with room for twice as many."""
    capacity = landings.tables.shape[1]
    tables = np.empty((PHASES, 2 * capacity, len(LANDING)))
    tables[:, :capacity] = landings.tables
    return Landings(landings.owner, landings.states, landings.segments, tables)


@compiled
def write_landing(
    row: Floats,
    largest_so_far: Floats,
    drive: Drive,
    restitution: Restitution,
    tau: float,
    take_off: float,
    span: float,
) -> None:
    """Write into `row` (columns of `LANDING`) the landing after a flight of `span` rad."""
    landing_speed = max(0.0, -rise(drive, take_off, tau, span)[0])
    rebound_speed = rebound(restitution, landing_speed)[0]
    row[LANDING.fastest] = max(largest_so_far[0], landing_speed)
    row[LANDING.highest] = hop_height(drive, take_off, tau, span, largest_so_far[1])
    row[LANDING.phase], row[LANDING.span] = tau, span
    row[LANDING.speed], row[LANDING.rebound] = landing_speed, rebound_speed
    stays = rests(drive, (tau + span) % TURN, rebound_speed, restitution, SETTLED_ROUGHLY)
    row[LANDING.stays] = 1.0 if stays else 0.0
    row[LANDING.air_velocity], row[LANDING.air_distance] = air_integrals(drive, tau, span)


@compiled
def find_landings_until(
    landings: Landings,
    run_index: int,
    until: float,
    drive: Drive,
    restitution: Restitution,
    stop: Stop,
) -> bool:
    """Find the landings of run `run_index` up to the time `until`; False if there is no more room.

    A run `ended` if it nears a cycle, hops too often, or a landing is not found; after the same
    landing, however far it is followed at a time. True if `stop` interrupts.
    """
    state, table = landings.states[run_index], landings.tables[run_index]
    is_searched = run_index < SEARCHES
    segments = landings.segments[min(run_index, SEARCHES - 1)]
    tau, take_off, time = state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time]
    landing_count, hop_count = int(state[NORMAL.landings]), int(state[NORMAL.hops])
    next_search, jolt_number = int(state[NORMAL.look]), int(state[NORMAL.jolt])
    has_room = True
    while time < until and state[NORMAL.ended] == ON_ITS_WAY:
        has_room = landing_count < table.shape[0]
        if not has_room or raised(stop):
            break
        span = landing(drive, take_off, tau)
        if span < 0 or landing_count > HOPS_PER_PERIOD * time / TURN + FIRST_LOOK:
            state[NORMAL.ended] = ENDED
            break
        row = table[landing_count]
        write_landing(
            row,
            table[max(0, landing_count - 1), LANDING.fastest :],
            drive,
            restitution,
            tau,
            take_off,
            span,
        )
        landing_speed, rebound_speed, stays = (
            row[LANDING.speed],
            row[LANDING.rebound],
            row[LANDING.stays] > 0.0,
        )
        landing_phase = (tau + span) % TURN
        landing_count += 1
        if is_searched:
            write_segment(
                segments,
                hop_count,
                tau,
                span,
                take_off,
                landing_speed,
                impulse(restitution, landing_speed, rebound_speed),
            )
        hop_count += 1
        tau, take_off, time = landing_phase, rebound_speed, time + span
        if stays:
            jolt_number += MAX_STARTS
            tau, take_off = (
                lift_off(drive, landing_phase),
                jolt_speed(jolt_number, drive.gravity_normal),
            )
            time += to_lift_off(drive, landing_phase)
            hop_count, next_search = 0, FIRST_LOOK
        elif is_searched and hop_count >= next_search:
            next_search = hop_count + hop_count // 2
            if find_cycle(drive, restitution, segments, hop_count, tau, take_off)[0]:
                landing_count -= 1
                state[NORMAL.ended] = ENDED
        if hop_count >= HOP_CAPACITY - LONGEST_CYCLE - 2:
            hop_count, next_search = 0, FIRST_LOOK
    state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time] = tau, take_off, time
    state[NORMAL.landings], state[NORMAL.hops], state[NORMAL.look] = (
        landing_count,
        hop_count,
        next_search,
    )
    state[NORMAL.jolt] = jolt_number
    return has_room


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
"""The eight runs of a cell: `states` (8, 6); `sums` (8, 5); `travel`, the distance of each period
in g/w^2, (8, periods); `marks`, the sums at the last marks with time, impacts and slip, (8, 5,
8)."""

RUN = Run(*range(len(Run._fields)))
TIME, IMPACTS, SLIP, MARK = SUMS, SUMS + 1, SUMS + 2, SUMS + 3
"""Columns of a mark, behind those of the sums: time, impacts and slip of a run so far."""


@borrowing
def start_runs(runs: Runs, phase: float, drive: Drive, no_log: Floats) -> None:
    """Fill states and sums of new `runs` with their first lift-offs from rest."""
    for run_index in range(PHASES):
        run = runs.states[run_index]
        slip, _, _, time, _ = first_flight(run_index, phase, drive, runs.sums[run_index], no_log)
        run[RUN.slip], run[RUN.time] = slip, time


@borrowing
def follow_run_until(
    runs: Runs, run_index: int, until: float, landings: Landings, drive: Drive, no_log: Floats
) -> bool:
    """Follow a run along the track up to the time `until`; False if its landings end before."""
    run, sums, travel = runs.states[run_index], runs.sums[run_index], runs.travel[run_index]
    table, landing_count = (
        landings.tables[run_index],
        int(landings.states[run_index, NORMAL.landings]),
    )
    slip, time, hop = run[RUN.slip], run[RUN.time], int(run[RUN.impacts])
    period = int(time // TURN)
    while time < until:
        if hop >= landing_count:
            return False
        row = table[hop]
        span, rebound_speed, stays = (
            row[LANDING.span],
            row[LANDING.rebound],
            row[LANDING.stays] > 0.0,
        )
        slip, distance = along_from_integrals(
            drive, slip, span, row[LANDING.air_velocity], row[LANDING.air_distance]
        )
        slip = slip_after_landing(
            slip, drive.mu_k, row[LANDING.speed], 0.0 if stays else rebound_speed
        )
        hop += 1
        time_before, distance_before = time, sums[DISTANCE]
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        time += span
        if stays:
            tau = (row[LANDING.phase] + span) % TURN
            slip, _, span = contact_to_lift_off(
                drive, tau, slip_after_hops(drive, tau, slip, rebound_speed), sums, no_log
            )
            time += span
        period = distribute_distance(
            travel, period, time_before, time, sums[DISTANCE] - distance_before
        )
        if slip * drive.gravity_along >= 0:
            run[RUN.upheld] = time
    run[RUN.slip], run[RUN.time], run[RUN.impacts] = slip, time, hop
    if hop > 0:
        run[RUN.fastest] = table[hop - 1, LANDING.fastest]
        run[RUN.highest] = table[hop - 1, LANDING.highest]
    return True


@borrowing
def set_mark(runs: Runs, run_index: int, mark: int) -> None:
    """Keep what a run has so far as its mark k = `mark`, of which few stay."""
    run, slot = runs.states[run_index], runs.marks[run_index, mark % (DROPPED + 1)]
    for column in range(SUMS):
        slot[column] = runs.sums[run_index, column]
    slot[TIME], slot[IMPACTS], slot[SLIP] = run[RUN.time], run[RUN.impacts], run[RUN.slip]


@borrowing
def fill_quarters(travel: Floats, periods: int, size: int, quarters: Floats) -> None:
    """Fill in the mean velocities of the four quarters, of `size` periods each, of several runs."""
    for run_index in range(travel.shape[0]):
        for quarter in range(QUARTERS):
            distance, first = 0.0, periods - (QUARTERS - quarter) * size
            for period in range(first, first + size):
                distance += travel[run_index, period]
            quarters[run_index, quarter] = distance / (size * TURN)


@borrowing
def run_slides_away(run: Floats, mark: Floats, sums: Floats, drive: Drive) -> bool:
    """True if a run has slipped downhill at all landings since a mark and is faster now."""
    gravity_along = drive.gravity_along
    gains_speed = abs(run[RUN.slip]) > abs(mark[SLIP]) and run[RUN.upheld] <= mark[TIME]
    uphill_columns = (
        TIMES + (MODE.forward if gravity_along > 0 else MODE.backward),
        TIMES + MODE.stick,
    )
    uphill = (
        sums[uphill_columns[0]]
        - mark[uphill_columns[0]]
        + sums[uphill_columns[1]]
        - mark[uphill_columns[1]]
    )
    return drive.mu_k * drive.gravity_normal < abs(gravity_along) and gains_speed and uphill == 0


@compiled
def periods_to_mark(mark: int, max_periods: int) -> int:
    """Return the periods up to mark k = `mark` of a run, 2 x 2^(k/2), at most `max_periods`."""
    return min(max_periods, round(FIRST_STAGE * 2.0 ** (0.5 * mark)))


@borrowing
def cut_error(travel: Floats, begin: int, end: int, velocity: float) -> float:
    """Return the error of mean velocities because runs end anywhere within a near repetition."""
    total = 0.0
    for run_index in range(travel.shape[0]):
        largest = 0.0
        for period in range(begin, end):
            largest = max(largest, abs(travel[run_index, period] - velocity * TURN))
        total += largest
    return total / (travel.shape[0] * (end - begin) * TURN)


@compiled
def means_within(
    cell: Cell, phase: float, drive: Drive, landings: Landings, result: Floats, stop: Stop
) -> tuple[int, Landings]:
    """Fill `result` with means of a motion that rounding decides, to a tolerance of its velocity.

    Eight runs end if error <= tolerance |v|, or after `max_periods`/8 each; the error is 0.8 of the
    `batch_error` of their quarters plus their `cut_error`. `UNREPEATED`, with nothing filled, if a
    run nears a cycle, runs away or is too short.
    """
    drive = rounded(drive)
    restitution = Restitution(
        rounded_to_32_bits(cell.restitution), rounded_to_32_bits(cell.impact_damping)
    )
    max_periods = int(cell.max_periods) // PHASES
    if max_periods < periods_to_mark(FIRST_ASKED, max_periods + 1):
        return UNREPEATED, landings
    reset_unless_of(landings, drive, restitution, phase)
    runs, no_log = (
        Runs(
            np.zeros((PHASES, len(RUN))),
            np.zeros((PHASES, SUMS)),
            np.zeros((PHASES, max_periods)),
            np.zeros((PHASES, DROPPED + 1, MARK)),
        ),
        np.empty((0, len(PIECE))),
    )
    quarters = np.empty((PHASES, QUARTERS))
    start_runs(runs, phase, drive, no_log)
    settled_periods = drive.push_along / max(1e-300, drive.mu_k * drive.gravity_normal * TURN)
    mark, periods, error = 0, 0, math.inf
    while periods < max_periods:
        periods, first_period = (
            periods_to_mark(mark, max_periods),
            periods_to_mark(mark - DROPPED, max_periods),
        )
        until = periods * TURN
        for run_index in range(PHASES):
            while landings.states[run_index, NORMAL.time] < until and not find_landings_until(
                landings, run_index, until, drive, restitution, stop
            ):
                landings = with_double_room(landings)
            if not follow_run_until(runs, run_index, until, landings, drive, no_log):
                return UNREPEATED, landings
            set_mark(runs, run_index, mark)
        mark += 1
        if mark <= FIRST_ASKED:
            continue
        fill_quarters(runs.travel, periods, (periods - first_period) // QUARTERS, quarters)
        velocity = quarters.mean()
        error = SHARE * batch_error(quarters) + cut_error(
            runs.travel, first_period, periods, velocity
        )
        if first_period >= settled_periods and error <= cell.tolerance * abs(velocity):
            break
    return fill_from_runs(runs, mark, quarters, error, drive, result), landings


@compiled
def fill_from_runs(
    runs: Runs, next_mark: int, quarters: Floats, error: float, drive: Drive, result: Floats
) -> int:
    """Fill `result` with means of eight runs; return the status, `UNREPEATED` if one runs away."""
    marks = runs.marks[:, next_mark % (DROPPED + 1)]
    for run_index in range(PHASES):
        if run_slides_away(runs.states[run_index], marks[run_index], runs.sums[run_index], drive):
            return UNREPEATED
    result[:] = 0.0
    velocities = np.empty(PHASES)
    for run_index in range(PHASES):
        run, mark = runs.states[run_index], marks[run_index]
        time = run[RUN.time] - mark[TIME]
        for mode in range(MODES):
            phase_in_mode = runs.sums[run_index, TIMES + mode] - mark[TIMES + mode]
            result[COLUMN.stick + mode] += phase_in_mode / (time * PHASES)
        result[COLUMN.impacts] += (run[RUN.impacts] - mark[IMPACTS]) * TURN / (time * PHASES)
        result[COLUMN.landing_speed] = max(result[COLUMN.landing_speed], run[RUN.fastest])
        result[COLUMN.hop_height] = max(result[COLUMN.hop_height], run[RUN.highest])
        velocities[run_index] = quarters[run_index].mean()
    result[COLUMN.velocity] = quarters.mean()
    result[COLUMN.error] = error
    result[COLUMN.spread] = velocities.std() * math.sqrt(PHASES / (PHASES - 1.0))
    return STATUS.aperiodic
