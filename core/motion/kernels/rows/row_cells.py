"""Rows of many cells, period by period until they repeat, and the path of one (theory 17.4)."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.constants import STATUS
from vibrafeed.core.motion.kernels.given import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.means import BATCHES
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.contact import (
    Driven,
    backward_speed,
    closing,
    gap_swept,
    held_from,
    is_held,
    is_lifted,
    swept,
)
from vibrafeed.core.motion.kernels.rows.repeat import (
    AGREES,
    AGREES_NEARLY,
    MULTIPLES,
    Past,
    cycle_of,
    finish,
    hasten,
    keep,
    past_of,
    remaining,
    shortest,
)
from vibrafeed.core.motion.kernels.rows.row_events import (
    HIT,
    NO_EVENT,
    ON_FLOOR,
    Air,
    happened,
    lifted,
    move,
    next_event,
    refreshed,
    stop_pressed,
)
from vibrafeed.core.motion.kernels.rows.row_state import (
    AT,
    COLUMN,
    NO_STOP,
    TALLIES,
    Row,
    Tally,
    drive_of,
    row_at,
)
from vibrafeed.core.motion.kernels.rows.row_wave import waved_of

MAX_EVENTS = 100_000
"""Most events of a period: a row of 64 parts has some hundreds, so that more come from rounding."""
FAILED = Tally(0.0, 0.0, math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""What a period with too many events reports."""


@borrowing
def one_period(
    row: Row, drive: Driven, restitution: float, air: Air, past: Past, period: int,
    swept_gaps: Floats,
) -> tuple[Air, Tally]:  # fmt: skip
    """Follow a row over one period of the drive; return the flight at its end, and sums."""
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
            least = AGREES * (abs(drive.c) + abs(drive.levels[step]))
            hits += closing(row, event.part, least)
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
    from phase `tau`, and `gap_swept` of the push, in g/w^2 times rad.
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
def follow(drive: Driven, row: Row, cell: Floats, result: Floats, stop: Stop) -> int:
    """Follow a row of parts until it repeats; fill its results, return its status."""
    scale = max(1e-300, abs(drive.c) + np.abs(drive.levels).max())
    if drive.s > 0.0 and drive.gn <= 0.0:
        return int(STATUS.limit_reached)
    air, status = at_start(drive), int(STATUS.limit_reached)
    means = np.zeros((int(cell[AT.max_periods]), TALLIES + 2 * row.mass.size - 1))
    for hastened in (False, True):
        past = past_of(row)
        if hastened:
            means[:] = 0.0
        air, done, cycle, since = approach(
            row, drive, cell, air, past, means, hastened, scale, stop
        )
        if raised(stop):
            return int(STATUS.not_computed)
        if done < 0:
            return int(STATUS.limit_reached)
        left = remaining(row, past, done, cycle, since, scale) if cycle > 0 else 0.0
        status = finish(row, past, means, done, cycle, left, scale, result)
        if cycle > 0:
            result[COLUMN.multiple] = shortest(row, air, past, done, cycle, AGREES_NEARLY, scale)
        if status != STATUS.limit_reached or done < 2 * BATCHES:
            break
    return status


@compiled
def approach(
    row: Row, drive: Driven, cell: Floats, air: Air, past: Past, means: Floats, hastened: bool,
    scale: float, stop: Stop,
) -> tuple[Air, int, int, int]:  # fmt: skip
    """Follow a row until it repeats, or for all its periods; return how it came to."""
    restitution, parts, since = cell[AT.part_restitution], row.mass.size, 0
    for period in range(means.shape[0]):
        if raised(stop):
            return air, period, 0, since
        keep(row, air, past, period)
        here, done = means[period], period + 1
        air, tally = one_period(row, drive, restitution, air, past, period, here[TALLIES + parts :])
        if math.isnan(tally.hits):
            return air, -1, 0, since
        here[:TALLIES] = (
            tally.closed, tally.air, tally.hits, tally.lost,
            tally.pressed, tally.struck, tally.peak, tally.held, tally.moving,
        )  # fmt: skip
        here[TALLIES : TALLIES + parts] = row.place - past.place[period % (MULTIPLES + 1)]
        cycle = cycle_of(row, air, past, done, since, scale)
        if cycle > 0 and (not hastened or done - 2 * cycle >= since):
            return air, done, cycle, since
        early = hastened and 2 * done < means.shape[0]
        if early and not is_held(row, parts) and hasten(row, past, done, since, scale):
            since = done
    return air, means.shape[0], 0, since


@compiled
def at_start(drive: Driven) -> Air:
    """Return the flight at the start of a motion: parts may lift off at once."""
    return lifted(drive, 0.0) if drive.gn > 0.0 and is_lifted(drive, 0.0) else ON_FLOOR


@compiled
def row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the table of results of many rows of parts, under a sine or steps along the track."""
    for number in range(cells.shape[0]):
        cell = cells[number]
        drive = drive_of(cell)
        found = follow(drive, row_at(cell, backward_speed(drive)), cell, table[number], stop)
        if raised(stop):
            return
        status[number] = found


@compiled
def waved_row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and statuses of rows of parts under any wave, as `row_cells`."""
    for number in range(cells.shape[0]):
        cell = cells[number]
        drive = waved_of(cell)
        found = follow(drive, row_at(cell, backward_speed(drive)), cell, table[number], stop)
        if raised(stop):
            return
        status[number] = found


@compiled
def path_of_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of a row's parts at ascending phases, under a sine or steps."""
    path_under(drive_of(cell), cell, phases, places, gaps)


@compiled
def path_of_waved_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of a row's parts at ascending phases, under any wave."""
    path_under(waved_of(cell), cell, phases, places, gaps)


@compiled
def path_under(drive: Driven, cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of the parts of a row at ascending phases, for its trajectory."""
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
