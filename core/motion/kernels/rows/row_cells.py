"""Rows from event to event (theory 17.3), until they repeat, and the path of one (17.4)."""

import math
from collections import namedtuple
from typing import Any

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.constants import STATUS
from vibrafeed.core.motion.kernels.inputs import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.means import BATCHES
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.contact import (
    Driven,
    at_phase,
    backward_speed,
    carried,
    chain_end,
    closing,
    collide,
    contact_until,
    first_rise,
    flight,
    gap_swept,
    held_from,
    hold,
    is_held,
    is_lifted,
    land,
    least_friction,
    least_pressed,
    lift_off,
    pushes,
    relative_push,
    set_flows,
    slide,
    start,
    stop_pressed,
    stop_until,
    swept,
    swung,
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
from vibrafeed.core.motion.kernels.rows.row_sine import LONGEST_FLIGHT
from vibrafeed.core.motion.kernels.rows.row_state import (
    AT,
    COLUMN,
    IN_SPACE,
    NO_STOP,
    ON_FLOOR,
    ON_TRACK,
    TALLIES,
    Air,
    Row,
    Tally,
    drive_of,
    row_at,
)
from vibrafeed.core.motion.kernels.rows.row_wave import waved_of

Event = namedtuple("Event", "span kind part")
"""The phase until it happens, what it is, and the part, or the contact, that it begins with."""

NOTHING, LIFT, LANDING, STOP, START, RELEASE, HIT = range(7)  # kinds of events

NO_EVENT = Event(0.0, NOTHING, 0)  # the event before a motion starts

SHORTEST_BOUNCES = 1e-6
"""Phase in rad: parts that are pressed together and would bounce for less touch at once. The swing
of their gap, which is left out, is of the order of its square."""


@borrowing
def refreshed(
    row: Row, drive: Driven, level: float, tau: float, flying: bool, event: Event
) -> None:
    """Update a row of parts after an event: start, release or part some, and set accelerations."""
    forced = event.part if event.kind == START else -1
    pull = drive.gs - level
    push, load = pushes(drive, pull, tau)
    if row.stop != NO_STOP:
        hold(row, drive, push, load, flying, event.kind == RELEASE)
    if not flying:
        start(row, push, load, forced)
        slide(row)
    set_flows(row, drive, pull, flying)


@borrowing
def next_event(
    row: Row, drive: Driven, level: float, tau: float, span: float, landing: float
) -> Event:
    """Return the earliest event of a row of parts within `span` rad from phase `tau`.

    `NOTHING` at `span` if there is none. Of several at once lift-off comes first, then landings,
    stops, starts, releases by the stop and collisions.
    """
    event = Event(span, NOTHING, 0)
    now = at_phase(drive, tau)
    flying = landing < math.inf
    if flying:
        if landing < span:
            event = Event(landing, LANDING, 0)
    else:
        up = lift_off(drive, tau)
        if up < span:
            event = Event(up, LIFT, 0)
        event = _on_floor(row, drive, drive.gs - level, tau, now, event)
    if row.stop != NO_STOP:
        event = _released(row, drive, drive.gs - level, tau, flying, event)
    for i in range(row.closed.size):
        if row.closed[i] == 0:
            until = contact_until(row, drive, i, now, event.span)
            if until < event.span:
                event = Event(until, HIT, i)
    return event


@borrowing
def _on_floor(row: Row, drive: Driven, pull: float, tau: float, now: Any, event: Event) -> Event:
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        mode = row.mode[first]
        if mode != 0:
            until = stop_until(row, drive, first, now, event.span)
            if until < event.span:
                event = Event(until, STOP, first)
        else:
            for way in (1, -1):
                if way > 0 and row.stop == ON_TRACK and is_held(row, end):
                    continue
                mu = least_friction(row, first, end, way)
                level = way * pull + mu * drive.gn
                until = first_rise(drive, first, way, float(way), mu, level, tau)
                if until < event.span:
                    event = Event(until, START, first)
        first = end
    return event


@borrowing
def _released(
    row: Row, drive: Driven, pull: float, tau: float, flying: bool, event: Event
) -> Event:
    first = held_from(row)
    if first == row.mass.size:
        return event
    until = math.inf
    if row.stop == ON_TRACK:
        if flying:
            until = first_rise(drive, row.mass.size, 1, -1.0, 0.0, -pull, tau)
    elif not flying and row.mode[first] != 0:
        least = least_pressed(row, first)
        if least != 0.0:
            way = 1.0 if least > 0.0 else -1.0
            level = way * (drive.gn - drive.gs / least)
            until = first_rise(drive, row.mass.size, 1, 0.0, way, level, tau)
    return Event(until, RELEASE, first) if until < event.span else event


@borrowing
def move(row: Row, drive: Driven, tau: float, span: float) -> None:
    """Move all parts of a row over `span` rad from phase `tau`, by their accelerations.

    There must be no event within. Parts that touch have one velocity and one acceleration: they
    move by the same distance, to the bit.
    """
    by, behind = swung(drive, tau, span), 0.0
    for i in range(row.mass.size):
        more, way = carried(row, drive, i, by, span)
        row.speed[i] += more
        row.place[i] += way
        if i > 0 and row.closed[i - 1] == 0:
            row.gap[i - 1] += way - behind
        behind = way
    parts = row.mass.size
    if row.stop == IN_SPACE:
        more, way = carried(row, drive, parts, by, span)
        row.speed[parts] += more
        if row.closed[parts - 1] == 1:
            row.speed[parts] = row.speed[parts - 1]
        else:
            row.gap[parts - 1] += way - behind
    elif row.stop == ON_TRACK and row.closed[parts - 1] == 0:
        row.gap[parts - 1] -= behind


@borrowing
def lifted(drive: Driven, tau: float) -> Air:
    """Return the flight that begins at phase `tau`: phase until landing, landing speed in g/w."""
    span, impulse = flight(drive, tau)
    return Air(min(span, TURN * LONGEST_FLIGHT), impulse)


@borrowing
def happened(
    row: Row, drive: Driven, event: Event, tau: float, air: Air, restitution: float
) -> tuple[Air, float, float]:
    """Change a row by an event; return its flight, energy lost, impulse on the stop."""
    lost, impulse = 0.0, 0.0
    if event.kind == LIFT:
        air = lifted(drive, tau)
    elif event.kind == LANDING:
        impulse = land(row, air.impulse)
        air = lifted(drive, tau) if is_lifted(drive, tau) else ON_FLOOR
    elif event.kind == STOP:
        end = chain_end(row, event.part)
        for i in range(event.part, end):
            row.speed[i], row.mode[i] = 0.0, 0
        if is_held(row, end):
            row.speed[end] = 0.0
    elif event.kind == HIT:
        if _bounces_end(row, drive, event.part, tau, restitution):
            restitution = 0.0
        lost, impulse = collide(row, event.part, restitution)
    return air, lost, impulse


@borrowing
def _bounces_end(row: Row, drive: Driven, contact: int, tau: float, restitution: float) -> bool:
    # Bounces pressed together by -a last 2 e v/(a (1 - e)) in all (theory 13.5).
    drag = row.drag[contact + 1] - row.drag[contact]
    pressed = drag - relative_push(row, drive, contact, tau)
    meets = row.speed[contact] - row.speed[contact + 1]
    return (
        restitution > 0.0
        and 2.0 * restitution * meets < SHORTEST_BOUNCES * (1.0 - restitution) * pressed
    )


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
