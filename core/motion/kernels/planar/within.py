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
from vibrafeed.core.motion.kernels.planar.along import after_hops
from vibrafeed.core.motion.kernels.planar.chaos import (
    HOPS_PER_PERIOD,
    MAX_STARTS,
    PHASES,
    QUARTERS,
    SEARCHES,
    SETTLED_ROUGHLY,
    batch_error,
    first_flight,
    jolted,
    share_out,
    slowed,
    stay,
)
from vibrafeed.core.motion.kernels.planar.cycle import (
    FIRST_LOOK,
    LONGEST_CYCLE,
    find_cycle,
    is_owned,
    write_segment,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN, kept
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    Restitution,
    air_swings,
    hop_height,
    impulse,
    landing,
    lift_off,
    rebound,
    rests,
    rise,
    rounded,
    swung_along,
    to_lift_off,
)

APART = 1e6
"""Times the jolt of a lift-off from rest, by which runs start: at once they go different ways.
Those of `chaos` take tens of periods to lose eight digits."""
HOP_CAPACITY = MAX_SEGMENTS // PHASES  # rows for a run's hops since the part was at rest
FIRST_ROOM = 256  # landings of a run for which there is room at first; it doubles when full
ON_ITS_WAY, ENDED = 0.0, 1.0
"""Whether more landings of a run can be found."""

Landing = namedtuple("Landing", "phase span speed rebound stays fastest highest swing sway")
"""Columns of the landings of a run, of the flight that ends there, in rad, g/w and g/w^2.

`stays` is 1 if the part then stays on the floor; `fastest` and `highest` are the largest of the run
so far; `swing` and `sway` are the flight's `air_swings`.
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
def no_landings() -> Landings:
    """Return room for the landings of eight runs, which belong to no motion yet."""
    return Landings(
        np.full(5, math.nan),
        np.zeros((PHASES, len(NORMAL))),
        np.empty((SEARCHES, HOP_CAPACITY, len(SEGMENT))),
        np.zeros((PHASES, FIRST_ROOM, len(LANDING))),
    )


@compiled
def belong_to(landings: Landings, drive: Drive, e: Restitution, phase: float) -> None:
    """Make `landings` those of a motion: kept if they are, else begun with its first lift-offs."""
    if is_owned(landings.owner, drive, e, phase):
        return
    sums, no_log = np.zeros(SUMS), np.empty((0, len(PIECE)))
    landings.states[:] = 0.0
    landings.tables[:, 0] = 0.0
    for number in range(PHASES):
        state = landings.states[number]
        _, w, tau, time, _ = first_flight(number, phase, drive, sums, no_log)
        state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time] = tau, w * APART, time
        state[NORMAL.look], state[NORMAL.jolt] = FIRST_LOOK, number


@compiled
def with_room(landings: Landings) -> Landings:
    """Return the same landings with room for twice as many."""
    room = landings.tables.shape[1]
    tables = np.empty((PHASES, 2 * room, len(LANDING)))
    tables[:, :room] = landings.tables
    return Landings(landings.owner, landings.states, landings.segments, tables)


@compiled
def write_landing(
    row: Floats, largest: Floats, drive: Drive, e: Restitution, tau: float, w: float, span: float
) -> None:
    """Write into `row` (columns of `LANDING`) the landing after a flight of `span` rad."""
    speed = max(0.0, -rise(drive, w, tau, span)[0])
    up = rebound(e, speed)[0]
    row[LANDING.fastest] = max(largest[0], speed)
    row[LANDING.highest] = hop_height(drive, w, tau, span, largest[1])
    row[LANDING.phase], row[LANDING.span] = tau, span
    row[LANDING.speed], row[LANDING.rebound] = speed, up
    stays = rests(drive, (tau + span) % TURN, up, e, SETTLED_ROUGHLY)
    row[LANDING.stays] = 1.0 if stays else 0.0
    row[LANDING.swing], row[LANDING.sway] = air_swings(drive, tau, span)


@compiled
def land_until(
    landings: Landings, number: int, until: float, drive: Drive, e: Restitution, stop: Stop
) -> bool:
    """Find the landings of run `number` up to the time `until`; False if there is no more room.

    A run `ended` if it nears a cycle, hops too often, or a landing is not found; after the same
    landing, however far it is followed at a time. True if `stop` interrupts.
    """
    state, table = landings.states[number], landings.tables[number]
    is_searched = number < SEARCHES
    rows = landings.segments[min(number, SEARCHES - 1)]
    tau, w, time = state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time]
    landed, count = int(state[NORMAL.landings]), int(state[NORMAL.hops])
    look_at, jolt = int(state[NORMAL.look]), int(state[NORMAL.jolt])
    has_room = True
    while time < until and state[NORMAL.ended] == ON_ITS_WAY:
        has_room = landed < table.shape[0]
        if not has_room or raised(stop):
            break
        span = landing(drive, w, tau)
        if span < 0 or landed > HOPS_PER_PERIOD * time / TURN + FIRST_LOOK:
            state[NORMAL.ended] = ENDED
            break
        row = table[landed]
        write_landing(row, table[max(0, landed - 1), LANDING.fastest :], drive, e, tau, w, span)
        speed, up, stays = row[LANDING.speed], row[LANDING.rebound], row[LANDING.stays] > 0.0
        at = (tau + span) % TURN
        landed += 1
        if is_searched:
            write_segment(rows, count, tau, span, w, speed, impulse(e, speed, up))
        count += 1
        tau, w, time = at, up, time + span
        if stays:
            jolt += MAX_STARTS
            tau, w = lift_off(drive, at), jolted(jolt, drive.gn)
            time += to_lift_off(drive, at)
            count, look_at = 0, FIRST_LOOK
        elif is_searched and count >= look_at:
            look_at = count + count // 2
            if find_cycle(drive, e, rows, count, tau, w)[0]:
                landed -= 1
                state[NORMAL.ended] = ENDED
        if count >= HOP_CAPACITY - LONGEST_CYCLE - 2:
            count, look_at = 0, FIRST_LOOK
    state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time] = tau, w, time
    state[NORMAL.landings], state[NORMAL.hops], state[NORMAL.look] = landed, count, look_at
    state[NORMAL.jolt] = jolt
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
def start(runs: Runs, phase: float, drive: Drive, no_log: Floats) -> None:
    """Fill states and sums of new `runs` with their first lift-offs from rest."""
    for number in range(PHASES):
        run = runs.states[number]
        u, _, _, time, _ = first_flight(number, phase, drive, runs.sums[number], no_log)
        run[RUN.slip], run[RUN.time] = u, time


@borrowing
def follow_on(
    runs: Runs, number: int, until: float, landings: Landings, drive: Drive, no_log: Floats
) -> bool:
    """Follow a run along the track up to the time `until`; False if its landings end before."""
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
    """Fill in the mean velocities of the four quarters, of `size` periods each, of several runs."""
    for number in range(travel.shape[0]):
        for quarter in range(QUARTERS):
            covered, first = 0.0, periods - (QUARTERS - quarter) * size
            for period in range(first, first + size):
                covered += travel[number, period]
            quarters[number, quarter] = covered / (size * TURN)


@borrowing
def runs_off(run: Floats, mark: Floats, sums: Floats, drive: Drive) -> bool:
    """True if a run has slipped downhill at all landings since a mark and is faster now."""
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
    """Return the error of mean velocities because runs end anywhere within a near repetition."""
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

    Eight runs end if error <= tolerance |v|, or after `max_periods`/8 each; the error is 0.8 of the
    `batch_error` of their quarters plus their `cut_error`. `UNREPEATED`, with nothing filled, if a
    run nears a cycle, runs away or is too short.
    """
    drive = rounded(drive)
    e = Restitution(kept(cell.restitution), kept(cell.impact_damping))
    most = int(cell.max_periods) // PHASES
    if most < end_of(FIRST_ASKED, most + 1):
        return UNREPEATED, landings
    belong_to(landings, drive, e, phase)
    runs, no_log = (
        Runs(
            np.zeros((PHASES, len(RUN))),
            np.zeros((PHASES, SUMS)),
            np.zeros((PHASES, most)),
            np.zeros((PHASES, DROPPED + 1, MARK)),
        ),
        np.empty((0, len(PIECE))),
    )
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
    """Fill `result` with means of eight runs; return the status, `UNREPEATED` if one runs away."""
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
