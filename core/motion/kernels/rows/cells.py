"""Rows of many cells, period by period until they repeat, and the path of one (theory 17.4)."""

from __future__ import annotations

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from core.compiled import borrowing, compiled, raised
from core.motion.kernels.arrays import Floats, Statuses, Stop
from core.motion.kernels.planar.flow import TURN
from core.motion.kernels.rows.advance import (
    HIT,
    NO_EVENT,
    ON_FLOOR,
    Air,
    happened,
    lifted,
    move,
    next_event,
    refreshed,
)
from core.motion.kernels.rows.contact import held_from
from core.motion.kernels.rows.drive import Driven, backward_speed, gap_swept, is_lifted, swept
from core.motion.kernels.rows.stop import stop_pressed
from core.motion.kernels.rows.tables import (
    AT,
    COLUMN,
    NO_STOP,
    ROW_COLUMNS,
    Row,
    Whole,
    drive_of,
    row_at,
)
from core.motion.kernels.rows.wave import waved_of
from core.motion.kernels.statuses import STATUS

MULTIPLES = 12
"""Periods of the longest cycle that is looked for: 2 and 4 are common, longer ones rare."""
AGREES = 1e-12
"""Difference of two states over the drive, below which they are the same; rounding leaves some
1e-15."""
BATCHES = 16
"""Batches of the second half of a motion that does not repeat; their means give its error."""
MAX_EVENTS = 100_000
"""Most events of a period: a row of 64 parts has some hundreds, so that more come from rounding."""


class Past(NamedTuple):
    """States at the starts of the last periods: the row of period p is p % (MULTIPLES + 1).

    `touched` counts of each contact the last period in which its parts touched.
    """

    speed: Floats
    place: Floats
    gap: Floats
    landing: Floats
    touched: Whole


Tally = namedtuple("Tally", "closed air hits lost pressed struck peak held moving")
"""Of a period: phase times closed contacts, phase in the air, collisions, the energy they took; of
the stop the integral of the force, the impulse of strokes, the largest force, the phase in touch;
the phase in which parts slide on the track or are in the air.
"""

TALLIES = len(Tally._fields)
FAILED = Tally(0.0, 0.0, math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""What a period with too many events reports."""


@compiled
def past_of(row: Row) -> Past:
    """Return an empty buffer for the states of a row at the starts of the last periods.

    `Past` with arrays of zeros, for MULTIPLES + 1 periods and the parts and contacts of the row;
    states are compared in it to see if the motion repeats.
    """
    size, parts, contacts = MULTIPLES + 1, row.mass.size, row.gap.size
    return Past(
        np.zeros((size, parts)), np.zeros((size, parts)), np.zeros((size, contacts)),
        np.zeros(size), np.zeros(contacts, dtype=np.int64),
    )  # fmt: skip


@compiled
def keep(row: Row, air: Air, past: Past, period: int) -> None:
    """Store the state of a row at the start of period number `period` in the buffer `past`.

    Velocities, positions, gaps, and the phase until landing of `air`, the flight of all parts.
    Later states are compared with it, to see if the motion repeats.
    """
    at = period % (MULTIPLES + 1)
    past.speed[at, :] = row.speed[: row.mass.size]
    past.place[at, :] = row.place
    past.gap[at, :] = row.gap
    past.landing[at] = air.landing


@borrowing
def one_period(
    row: Row, drive: Driven, restitution: float, air: Air, past: Past, period: int,
    swept_gaps: Floats,
) -> tuple[Air, Tally]:  # fmt: skip
    """Follow a row of parts over one period of the drive; return the flight at its end, and sums.

    `air` is the flight at the start, `restitution` that between parts, `period` the number of the
    period. `past` notes which contacts touched, and `swept_gaps` gets the integrals of the gaps.
    The sums are those of `Tally`: collisions, times in contact and in the air, energy lost, forces
    on the stop. The number of collisions is NaN if there were too many events.
    """
    tau, step, events, event = 0.0, 0, 0, NO_EVENT
    closed, flying, hits, lost = 0.0, 0.0, 0.0, 0.0
    pressed, struck, peak, held, moving = 0.0, 0.0, 0.0, 0.0, 0.0
    while True:
        flies = air.landing < math.inf
        refreshed(row, drive, drive.levels[step], tau, flies, event)
        end = drive.ends[step]
        event = next_event(row, drive, drive.levels[step], tau, end - tau, air.landing)
        if row.stop != NO_STOP:
            force = stop_pressed(row, drive, drive.gs - drive.levels[step], tau, event.span, flies)
            pressed, peak = pressed + force.impulse, max(peak, force.peak)
            held += event.span if held_from(row) < row.mass.size else 0.0
        moving += event.span if flies or row.mode.any() else 0.0
        sweep(row, drive, tau, event.span, swept_gaps)
        move(row, drive, tau, event.span)
        for i in range(row.closed.size):
            if row.closed[i] == 1:
                closed += event.span if i < row.mass.size - 1 else 0.0
                past.touched[i] = period
        if flies:
            flying += event.span
        air = Air(air.landing - event.span, air.impulse)
        tau += event.span
        if event.kind == 0:
            tau, step = end, step + 1
            if step == drive.ends.size:
                return air, Tally(
                    closed, flying, hits, lost, pressed, struck, peak, held, moving
                )  # fmt: skip
        if event.kind == HIT:
            hits += 1.0
            past.touched[event.part] = period
        air, taken, impulse = happened(row, drive, event, tau, air, restitution)
        lost, struck = lost + taken, struck + impulse
        events += 1
        if events > MAX_EVENTS:
            return air, FAILED


@borrowing
def sweep(row: Row, drive: Driven, tau: float, span: float, result: Floats) -> None:
    """Add the integrals of the gaps of a row over a phase without events to `result`.

    g d + v d^2/2 - k d^3/6 with the gap g, its rate v and its constant pull k over d = `span` rad
    from phase `tau`, and the effect of the push: under a sine C (cos(tau + d) - cos(tau) + sin(tau)
    d + cos(tau) d^2/2). In g/w^2 times rad (w = 2 pi f); `result` has one entry a gap between
    parts.
    """
    by = swept(drive, tau, span)
    for i in range(row.mass.size - 1):
        if row.closed[i] == 0:
            drag = row.drag[i + 1] - row.drag[i]
            apart = row.speed[i + 1] - row.speed[i]
            result[i] += span * (row.gap[i] + span * (apart / 2.0 - drag * span / 6.0)) + gap_swept(
                row, drive, i, by
            )


@compiled
def repeats(row: Row, air: Air, past: Past, period: int, multiple: int, scale: float) -> bool:
    """True if the state of a row at period number `period` equals that `multiple` periods before.

    Velocities and gaps must agree within 1e-12 relative to `scale`, the size of the drive in g, and
    the phase until landing within 1e-12 rad. A gap may have grown if its parts did not touch in
    between: each side of it then moves as it did, and the gap grows for ever. `air` is the flight
    of the parts now, `past` holds the earlier states.
    """
    at = (period - multiple) % (MULTIPLES + 1)
    here, before = air.landing, past.landing[at]
    if (here < math.inf) != (before < math.inf):
        return False
    if here < math.inf and abs(here - before) > AGREES:
        return False
    for i in range(row.mass.size):
        if abs(row.speed[i] - past.speed[at, i]) > AGREES * scale:
            return False
    for i in range(row.gap.size):
        grown = row.gap[i] - past.gap[at, i]
        touched = past.touched[i] > period - multiple - 1
        if abs(grown) > AGREES * scale and (grown < 0.0 or touched):
            return False
    return True


@compiled
def platoons(
    row: Row, past: Past, period: int, multiple: int, scale: float, numbers: Floats
) -> int:
    """Return the number of platoons of a row: groups of parts that separate for good.

    Two neighbours separate if their gap has grown, beyond rounding, over the last `multiple`
    periods up to number `period`, without a touch. `past` holds states at the starts of the last
    periods and when parts touched last; `scale` is the size of the drive in g. `numbers`, shape
    (parts,), gets the number of each part's platoon, 1 at the rear.
    """
    at = (period - multiple) % (MULTIPLES + 1)
    count = 1
    for i in range(row.mass.size):
        numbers[i] = count
        if i < row.mass.size - 1 and row.gap[i] - past.gap[at, i] > AGREES * scale:
            count += past.touched[i] < period - multiple
    return count


@compiled
def follow(drive: Driven, row: Row, cell: Floats, result: Floats, stop: Stop) -> int:
    """Follow a row of parts from event to event until it repeats; fill its results, return status.

    `drive` is a sine with steps, or a wave; `row` holds the parts at rest at the start. `cell` has
    the columns of `Head`, then the parts and the wave; `result` has the columns of `COLUMN`, then
    velocity and platoon of each part; `stop` is a flag that ends the work.
    """
    restitution, most = cell[AT.part_restitution], int(cell[AT.max_periods])
    parts = row.mass.size
    scale = max(1e-300, abs(drive.c) + np.abs(drive.levels).max())
    past = past_of(row)
    if drive.s > 0.0 and drive.gn <= 0.0:
        return int(STATUS.limit_reached)
    air = at_start(drive)
    means = np.zeros((most, TALLIES + 2 * parts - 1))
    for period in range(most):
        if raised(stop):
            return int(STATUS.not_computed)
        keep(row, air, past, period)
        here = means[period]
        air, tally = one_period(row, drive, restitution, air, past, period, here[TALLIES + parts :])
        if math.isnan(tally.hits):
            return int(STATUS.limit_reached)
        here[:TALLIES] = (
            tally.closed, tally.air, tally.hits, tally.lost,
            tally.pressed, tally.struck, tally.peak, tally.held, tally.moving,
        )  # fmt: skip
        here[TALLIES : TALLIES + parts] = row.place - past.place[period % (MULTIPLES + 1)]
        for multiple in range(1, min(MULTIPLES, period) + 1):
            if repeats(row, air, past, period + 1, multiple, scale):
                return finish(row, past, means, period + 1, multiple, scale, result)
    return finish(row, past, means, most, 0, scale, result)


@compiled
def finish(
    row: Row, past: Past, means: Floats, periods: int, multiple: int, scale: float, result: Floats
) -> int:
    """Write the means over a cycle, and return the status (`periodic`, `at_rest`, `aperiodic`).

    A motion that does not repeat has the means over the second half of its periods, and spread and
    error by batches of them.

    Parameters
    ----------
    row, past
        The row at the end, and the states at the starts of the last periods.
    means
        A row a period: columns of `Tally`, distances of the parts, integrals of the gaps.
    periods, multiple
        Periods that were followed, and those of the cycle (0 if it does not repeat).
    scale
        Size of the drive in g.
    result
        Columns of `COLUMN`, then velocity and platoon of each part.
    """
    parts, room = row.mass.size, (result.size - ROW_COLUMNS) // 2
    numbers = result[ROW_COLUMNS + room : ROW_COLUMNS + room + parts]
    back = multiple if multiple > 0 else min(MULTIPLES, periods)
    result[COLUMN.platoons] = platoons(row, past, periods, back, scale, numbers)
    result[COLUMN.multiple] = multiple
    if multiple > 0:
        cycle = means[periods - multiple : periods]
        _write(cycle, result, numbers)
        result[COLUMN.error], result[COLUMN.spread] = AGREES * scale, 0.0
        return int(STATUS.periodic if cycle[:, 8].max() > 0.0 else STATUS.at_rest)
    half = means[periods // 2 :]
    _write(half, result, numbers)
    batch = max(1, half.shape[0] // BATCHES)
    batches = np.empty(half.shape[0] // batch)
    for b in range(batches.size):
        some = half[b * batch : (b + 1) * batch, TALLIES : TALLIES + parts]
        batches[b] = some.mean() / TURN
    result[COLUMN.spread] = batches.std()
    result[COLUMN.error] = 2.0 * batches.std() / math.sqrt(batches.size)
    return int(STATUS.aperiodic)


@compiled
def _write(periods: Floats, result: Floats, numbers: Floats) -> None:
    """Write the means of the motion of a row over some periods of the drive into `result`.

    `periods` has a row a period: columns of `Tally`, distances of the parts, integrals of the gaps;
    `numbers` is the platoon of each part, of which only neighbours in one have a gap that counts.
    `result` has the columns of `COLUMN`, then velocity and platoon of each part.
    """
    count, parts = periods.shape[0], numbers.size
    phase = count * TURN
    slowest, fastest, total = math.inf, -math.inf, 0.0
    for i in range(parts):
        speed = periods[:, TALLIES + i].sum() / phase
        slowest, fastest = min(slowest, speed), max(fastest, speed)
        total += speed
        result[ROW_COLUMNS + i] = speed
    result[COLUMN.velocity] = total / parts
    result[COLUMN.slowest], result[COLUMN.fastest] = slowest, fastest
    result[COLUMN.contact] = periods[:, 0].sum() / (phase * max(1, parts - 1))
    result[COLUMN.flight] = periods[:, 1].sum() / phase
    result[COLUMN.collisions] = periods[:, 2].sum() / count
    result[COLUMN.impact] = periods[:, 3].sum() / count
    struck = periods[:, 5].sum()
    result[COLUMN.stop_force] = (periods[:, 4].sum() + struck) / phase
    result[COLUMN.stop_impulse] = struck / count
    result[COLUMN.stop_peak] = periods[:, 6].max()
    result[COLUMN.stop_contact] = periods[:, 7].sum() / phase
    together, swept = 0, 0.0
    for i in range(parts - 1):
        if numbers[i] == numbers[i + 1]:
            together += 1
            swept += periods[:, TALLIES + parts + i].sum() / phase
    result[COLUMN.gap] = swept / together if together > 0 else math.nan


@compiled
def at_start(drive: Driven) -> Air:
    """Return the flight at the start of a motion: parts may lift off at once."""
    return lifted(drive, 0.0) if drive.gn > 0.0 and is_lifted(drive, 0.0) else ON_FLOOR


@compiled
def row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the table of results of many rows of parts, under a sine or steps along the track.

    Each row is followed from rest, from event to event. `cells` has a row of numbers for each
    (columns of `Head`, then those of the parts and of the wave); a row of `table` has the columns
    of `COLUMN`, then velocity and platoon of each part; `status` gets one value a row. `stop` is a
    flag that ends the work, with the rest left as it is.
    """
    for number in range(cells.shape[0]):
        cell = cells[number]
        drive = drive_of(cell)
        found = follow(drive, row_at(cell, backward_speed(drive)), cell, table[number], stop)
        if raised(stop):
            return
        status[number] = found


@compiled
def waved_row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the result table of rows of parts under any wave, by following each from event to event.

    Parameters
    ----------
    cells
        A row for each cell: columns of `Head`, then the parts and the wave.
    table
        A row for each cell: columns of `COLUMN`, then velocity and platoon of each part.
    status
        A value of `STATUS` for each cell.
    stop
        Flag that ends the work; cells not reached are left as they are.
    """
    for number in range(cells.shape[0]):
        cell = cells[number]
        drive = waved_of(cell)
        found = follow(drive, row_at(cell, backward_speed(drive)), cell, table[number], stop)
        if raised(stop):
            return
        status[number] = found


@compiled
def path_of_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of a row's parts at ascending phases, under a sine or steps.

    `phases` are in rad; `places` and `gaps`, a row a phase, get g/w^2 (w = 2 pi f). The gap to a
    stop, if there is one, is the last. NaN after a period with more than `MAX_EVENTS` events.
    """
    path_under(drive_of(cell), cell, phases, places, gaps)


@compiled
def path_of_waved_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of a row's parts at ascending phases, under any wave."""
    path_under(waved_of(cell), cell, phases, places, gaps)


@compiled
def path_under(drive: Driven, cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of the parts of a row at ascending phases, for its trajectory.

    The row starts at rest and is moved from event to event. `drive` is a sine with steps, or a
    wave. `cell` has the columns of `Head`, then those of the parts and of the wave. `phases` are in
    rad; `places` (a row a phase, a column a part) and `gaps` (a column a contact) are filled in
    g/w^2 (w = 2 pi f), with NaN after a period with more than `MAX_EVENTS` events.
    """
    row, restitution = row_at(cell, backward_speed(drive)), cell[AT.part_restitution]
    air, event = at_start(drive), NO_EVENT
    tau, step, turn, at, events = 0.0, 0, 0, 0, 0
    places[:], gaps[:] = math.nan, math.nan
    while at < phases.size and events <= MAX_EVENTS:
        refreshed(row, drive, drive.levels[step], tau, air.landing < math.inf, event)
        until = min(drive.ends[step], max(tau, phases[at] - turn * TURN))
        event = next_event(row, drive, drive.levels[step], tau, until - tau, air.landing)
        move(row, drive, tau, event.span)
        air = Air(air.landing - event.span, air.impulse)
        tau += event.span
        if event.kind != 0:
            events += 1
        else:
            tau = until
            if phases[at] - turn * TURN <= tau:
                places[at, :], gaps[at, :] = row.place, row.gap
                at += 1
            if tau == drive.ends[step]:
                step += 1
                if step == drive.ends.size:
                    tau, step, turn, events = 0.0, 0, turn + 1, 0
        air, _, _ = happened(row, drive, event, tau, air, restitution)
