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
    chain_end,
    change_over_span,
    collide,
    contact_until,
    count_closing,
    drive_double_integrals,
    drive_integrals,
    first_rise,
    first_touching_stop,
    flight,
    gap_integral_of_drive,
    is_lifted,
    land_all,
    least_friction,
    least_pressed_factor,
    lift_off,
    open_unpressed_contacts,
    pushes,
    relative_push,
    release_from_stop,
    set_accelerations,
    start_movable_parts,
    stop_impulse_and_peak,
    stop_until,
    touches_stop,
)
from vibrafeed.core.motion.kernels.rows.repeat import (
    AGREES,
    AGREES_NEARLY,
    MULTIPLES,
    Past,
    cycle_of,
    empty_past,
    extrapolate_transient,
    fill_row_results,
    remaining_transient,
    shortest_cycle,
    store_state,
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
from vibrafeed.core.motion.kernels.rows.row_wave import wave_drive_of

Event = namedtuple("Event", "span kind part")
"""The phase until it happens, what it is, and the part, or the contact, that it begins with."""

NOTHING, LIFT, LANDING, STOP, START, RELEASE, HIT = range(7)  # kinds of events

NO_EVENT = Event(0.0, NOTHING, 0)  # the event before a motion starts

SHORTEST_BOUNCES = 1e-6
"""Phase in rad: parts that are pressed together and would bounce for less touch at once. The swing
of their gap, which is left out, is of the order of its square."""


@borrowing
def update_after_event(
    row: Row, drive: Driven, level: float, tau: float, flying: bool, event: Event
) -> None:
    """Update a row of parts after an event: start, release or part some, and set accelerations."""
    forced = event.part if event.kind == START else -1
    pull = drive.gravity_along - level
    push, load = pushes(drive, pull, tau)
    if row.stop != NO_STOP:
        release_from_stop(row, drive, push, load, flying, event.kind == RELEASE)
    if not flying:
        start_movable_parts(row, push, load, forced)
        open_unpressed_contacts(row)
    set_accelerations(row, drive, pull, flying)


@borrowing
def next_event(
    row: Row, drive: Driven, level: float, tau: float, span: float, landing: float
) -> Event:
    """Return the earliest event of a row of parts within `span` rad from phase `tau`.

    `NOTHING` at `span` if there is none. Of several at once lift-off comes first, then landings,
    stops, starts, releases by the stop and collisions.
    """
    event = Event(span, NOTHING, 0)
    phase_now = at_phase(drive, tau)
    flying = landing < math.inf
    if flying:
        if landing < span:
            event = Event(landing, LANDING, 0)
    else:
        to_lift_off = lift_off(drive, tau)
        if to_lift_off < span:
            event = Event(to_lift_off, LIFT, 0)
        event = _next_on_floor(row, drive, drive.gravity_along - level, tau, phase_now, event)
    if row.stop != NO_STOP:
        event = _next_release(row, drive, drive.gravity_along - level, tau, flying, event)
    for i in range(row.closed.size):
        if row.closed[i] == 0:
            until = contact_until(row, drive, i, phase_now, event.span)
            if until < event.span:
                event = Event(until, HIT, i)
    return event


@borrowing
def _next_on_floor(
    row: Row, drive: Driven, pull: float, tau: float, phase_now: Any, event: Event
) -> Event:
    # The first stop of a sliding block, or start of a resting one, if it comes before `event`.
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        mode = row.mode[first]
        if mode != 0:
            until = stop_until(row, drive, first, phase_now, event.span)
            if until < event.span:
                event = Event(until, STOP, first)
        else:
            for direction in (1, -1):
                if direction > 0 and row.stop == ON_TRACK and touches_stop(row, end):
                    continue
                friction = least_friction(row, first, end, direction)
                threshold = direction * pull + friction * drive.gravity_normal
                until = first_rise(
                    drive, first, direction, float(direction), friction, threshold, tau
                )
                if until < event.span:
                    event = Event(until, START, first)
        first = end
    return event


@borrowing
def _next_release(
    row: Row, drive: Driven, pull: float, tau: float, flying: bool, event: Event
) -> Event:
    # The release of a block by the stop, if it comes before `event`.
    first = first_touching_stop(row)
    if first == row.mass.size:
        return event
    until = math.inf
    if row.stop == ON_TRACK:
        if flying:
            until = first_rise(drive, row.mass.size, 1, -1.0, 0.0, -pull, tau)
    elif not flying and row.mode[first] != 0:
        least_factor = least_pressed_factor(row, first)
        if least_factor != 0.0:
            direction = 1.0 if least_factor > 0.0 else -1.0
            threshold = direction * (drive.gravity_normal - drive.gravity_along / least_factor)
            until = first_rise(drive, row.mass.size, 1, 0.0, direction, threshold, tau)
    return Event(until, RELEASE, first) if until < event.span else event


@borrowing
def move(row: Row, drive: Driven, tau: float, span: float) -> None:
    """Move all parts of a row over `span` rad from phase `tau`, by their accelerations.

    There must be no event within. Parts that touch have one velocity and one acceleration: they
    move by the same distance, to the bit.
    """
    integrals, distance_behind = drive_integrals(drive, tau, span), 0.0
    for i in range(row.mass.size):
        speed_change, distance = change_over_span(row, drive, i, integrals, span)
        row.speed[i] += speed_change
        row.place[i] += distance
        if i > 0 and row.closed[i - 1] == 0:
            row.gap[i - 1] += distance - distance_behind
        distance_behind = distance
    parts = row.mass.size
    if row.stop == IN_SPACE:
        speed_change, distance = change_over_span(row, drive, parts, integrals, span)
        row.speed[parts] += speed_change
        if row.closed[parts - 1] == 1:
            row.speed[parts] = row.speed[parts - 1]
        else:
            row.gap[parts - 1] += distance - distance_behind
    elif row.stop == ON_TRACK and row.closed[parts - 1] == 0:
        row.gap[parts - 1] -= distance_behind


@borrowing
def flight_from(drive: Driven, tau: float) -> Air:
    """Return the flight that begins at phase `tau`: phase until landing, landing speed in g/w."""
    span, impulse = flight(drive, tau)
    return Air(min(span, TURN * LONGEST_FLIGHT), impulse)


@borrowing
def apply_event(
    row: Row, drive: Driven, event: Event, tau: float, air: Air, restitution: float
) -> tuple[Air, float, float]:
    """Change a row by an event; return its flight, energy lost, impulse on the stop."""
    energy_lost, impulse = 0.0, 0.0
    if event.kind == LIFT:
        air = flight_from(drive, tau)
    elif event.kind == LANDING:
        impulse = land_all(row, air.impulse)
        air = flight_from(drive, tau) if is_lifted(drive, tau) else ON_FLOOR
    elif event.kind == STOP:
        end = chain_end(row, event.part)
        for i in range(event.part, end):
            row.speed[i], row.mode[i] = 0.0, 0
        if touches_stop(row, end):
            row.speed[end] = 0.0
    elif event.kind == HIT:
        if _bounces_end_at_once(row, drive, event.part, tau, restitution):
            restitution = 0.0
        energy_lost, impulse = collide(row, event.part, restitution)
    return air, energy_lost, impulse


@borrowing
def _bounces_end_at_once(
    row: Row, drive: Driven, contact: int, tau: float, restitution: float
) -> bool:
    # Bounces pressed together by -a last 2 e v/(a (1 - e)) in all (theory 13.5).
    relative_pull = row.pull[contact + 1] - row.pull[contact]
    pressing_together = relative_pull - relative_push(row, drive, contact, tau)
    closing_speed = row.speed[contact] - row.speed[contact + 1]
    return (
        restitution > 0.0
        and 2.0 * restitution * closing_speed
        < SHORTEST_BOUNCES * (1.0 - restitution) * pressing_together
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
    contact_phase, flight_phase, hits, energy_lost = 0.0, 0.0, 0.0, 0.0
    pressed, struck, peak, stop_phase, moving_phase = 0.0, 0.0, 0.0, 0.0, 0.0
    while True:
        flies = air.landing < math.inf
        update_after_event(row, drive, drive.levels[step], tau, flies, event)
        end = drive.ends[step]
        event = next_event(row, drive, drive.levels[step], tau, end - tau, air.landing)
        if row.stop != NO_STOP:
            force = stop_impulse_and_peak(
                row, drive, drive.gravity_along - drive.levels[step], tau, event.span, flies
            )
            pressed, peak = pressed + force.impulse, max(peak, force.peak)
            stop_phase += event.span if first_touching_stop(row) < row.mass.size else 0.0
        moving_phase += event.span if flies or row.mode.any() else 0.0
        add_gap_integrals(row, drive, tau, event.span, swept_gaps)
        move(row, drive, tau, event.span)
        for i in range(row.closed.size):
            if row.closed[i] == 1:
                contact_phase += event.span if i < row.mass.size - 1 else 0.0
                past.touched[i] = period
        if flies:
            flight_phase += event.span
        air = Air(air.landing - event.span, air.impulse)
        tau += event.span
        if event.kind == NOTHING:  # the step of the drive ends
            tau, step = end, step + 1
            if step == drive.ends.size:
                return air, Tally(
                    contact_phase, flight_phase, hits, energy_lost, pressed, struck, peak,
                    stop_phase, moving_phase,
                )  # fmt: skip
        if event.kind == HIT:
            least_closing = AGREES * (abs(drive.push_along) + abs(drive.levels[step]))
            hits += count_closing(row, event.part, least_closing)
            past.touched[event.part] = period
        air, loss_at_event, impulse = apply_event(row, drive, event, tau, air, restitution)
        energy_lost, struck = energy_lost + loss_at_event, struck + impulse
        events += 1
        if events > MAX_EVENTS:
            return air, FAILED


@borrowing
def add_gap_integrals(row: Row, drive: Driven, tau: float, span: float, result: Floats) -> None:
    """Add the integrals of the gaps of a row over a phase without events to `result`.

    g d + v d^2/2 - k d^3/6 with the gap g, its rate v and its constant pull k over d = `span` rad
    from phase `tau`, and `gap_integral_of_drive` of the push, in g/w^2 times rad.
    """
    integrals = drive_double_integrals(drive, tau, span)
    for i in range(row.mass.size - 1):
        if row.closed[i] == 0:
            relative_pull = row.pull[i + 1] - row.pull[i]
            gap_rate = row.speed[i + 1] - row.speed[i]
            result[i] += span * (
                row.gap[i] + span * (gap_rate / 2.0 - relative_pull * span / 6.0)
            ) + gap_integral_of_drive(row, drive, i, integrals)


@compiled
def follow(drive: Driven, row: Row, cell: Floats, result: Floats, stop: Stop) -> int:
    """Follow a row of parts until it repeats; fill its results, return its status."""
    scale = max(1e-300, abs(drive.push_along) + np.abs(drive.levels).max())
    if drive.push_normal > 0.0 and drive.gravity_normal <= 0.0:
        return int(STATUS.limit_reached)
    air, status = flight_at_start(drive), int(STATUS.limit_reached)
    means = np.zeros((int(cell[AT.max_periods]), TALLIES + 2 * row.mass.size - 1))
    # A row that still drifts is followed again, along its slow transient in jumps.
    for extrapolates in (False, True):
        past = empty_past(row)
        if extrapolates:
            means[:] = 0.0
        air, periods, cycle, counted_from = follow_periods(
            row, drive, cell, air, past, means, extrapolates, scale, stop
        )
        if raised(stop):
            return int(STATUS.not_computed)
        if periods < 0:
            return int(STATUS.limit_reached)
        transient = (
            remaining_transient(row, past, periods, cycle, counted_from, scale)
            if cycle > 0
            else 0.0
        )
        status = fill_row_results(row, past, means, periods, cycle, transient, scale, result)
        if cycle > 0:
            result[COLUMN.multiple] = shortest_cycle(
                row, air, past, periods, cycle, AGREES_NEARLY, scale
            )
        if status != STATUS.limit_reached or periods < 2 * BATCHES:
            break
    return status


@compiled
def follow_periods(
    row: Row, drive: Driven, cell: Floats, air: Air, past: Past, means: Floats, extrapolates: bool,
    scale: float, stop: Stop,
) -> tuple[Air, int, int, int]:  # fmt: skip
    """Follow a row until it repeats, or for all its periods.

    Return flight, periods (-1: too many events), cycle (0: none), and the first period counted.
    """
    # `means` gets a row of sums a period: `Tally`, distances of the parts, integrals of the gaps.
    restitution, parts, counted_from = cell[AT.part_restitution], row.mass.size, 0
    for period in range(means.shape[0]):
        if raised(stop):
            return air, period, 0, counted_from
        store_state(row, air, past, period)
        sums, periods = means[period], period + 1
        air, tally = one_period(row, drive, restitution, air, past, period, sums[TALLIES + parts :])
        if math.isnan(tally.hits):
            return air, -1, 0, counted_from
        sums[:TALLIES] = (
            tally.closed, tally.air, tally.hits, tally.lost,
            tally.pressed, tally.struck, tally.peak, tally.held, tally.moving,
        )  # fmt: skip
        sums[TALLIES : TALLIES + parts] = row.place - past.place[period % (MULTIPLES + 1)]
        cycle = cycle_of(row, air, past, periods, counted_from, scale)
        if cycle > 0 and (not extrapolates or periods - 2 * cycle >= counted_from):
            return air, periods, cycle, counted_from
        may_extrapolate = extrapolates and 2 * periods < means.shape[0]
        if (
            may_extrapolate
            and not touches_stop(row, parts)
            and extrapolate_transient(row, past, periods, counted_from, scale)
        ):
            counted_from = periods
    return air, means.shape[0], 0, counted_from


@compiled
def flight_at_start(drive: Driven) -> Air:
    """Return the flight at the start of a motion: parts may lift off at once."""
    return (
        flight_from(drive, 0.0)
        if drive.gravity_normal > 0.0 and is_lifted(drive, 0.0)
        else ON_FLOOR
    )


@compiled
def row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the table of results of many rows of parts, under a sine or steps along the track."""
    for index in range(cells.shape[0]):
        cell = cells[index]
        drive = drive_of(cell)
        outcome = follow(drive, row_at(cell, backward_speed(drive)), cell, table[index], stop)
        if raised(stop):
            return
        status[index] = outcome


@compiled
def wave_row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and statuses of rows of parts under any wave, as `row_cells`."""
    for index in range(cells.shape[0]):
        cell = cells[index]
        drive = wave_drive_of(cell)
        outcome = follow(drive, row_at(cell, backward_speed(drive)), cell, table[index], stop)
        if raised(stop):
            return
        status[index] = outcome


@compiled
def path_of_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of a row's parts at ascending phases, under a sine or steps."""
    path_under(drive_of(cell), cell, phases, places, gaps)


@compiled
def path_of_wave_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of a row's parts at ascending phases, under any wave."""
    path_under(wave_drive_of(cell), cell, phases, places, gaps)


@compiled
def path_under(drive: Driven, cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write positions and gaps of the parts of a row at ascending phases, for its trajectory."""
    row, restitution = row_at(cell, backward_speed(drive)), cell[AT.part_restitution]
    air, event = flight_at_start(drive), NO_EVENT
    tau, step, turn, sample, events = 0.0, 0, 0, 0, 0
    places[:], gaps[:] = math.nan, math.nan
    while sample < phases.size and events <= MAX_EVENTS:
        update_after_event(row, drive, drive.levels[step], tau, air.landing < math.inf, event)
        until = min(drive.ends[step], max(tau, phases[sample] - turn * TURN))
        event = next_event(row, drive, drive.levels[step], tau, until - tau, air.landing)
        move(row, drive, tau, event.span)
        air = Air(air.landing - event.span, air.impulse)
        tau += event.span
        if event.kind != NOTHING:
            events += 1
        else:
            tau = until
            if phases[sample] - turn * TURN <= tau:
                places[sample, :], gaps[sample, :] = row.place, row.gap
                sample += 1
            if tau == drive.ends[step]:
                step += 1
                if step == drive.ends.size:
                    tau, step, turn, events = 0.0, 0, turn + 1, 0
        air, _, _ = apply_event(row, drive, event, tau, air, restitution)
