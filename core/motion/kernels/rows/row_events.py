"""From event to event of a row, and the force on a stop between them (theory 17.3, 17.6)."""

from __future__ import annotations

import math
from collections import namedtuple
from typing import Any

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.contact import (
    Driven,
    above,
    at_phase,
    carried,
    chain_end,
    collide,
    contact_until,
    first_rise,
    flight,
    held_from,
    highest,
    hold,
    is_held,
    is_lifted,
    land,
    least_friction,
    least_pressed,
    lift_off,
    pooled,
    pushes,
    relative_push,
    set_flows,
    sizes,
    slide,
    start,
    stop_until,
    swung,
)
from vibrafeed.core.motion.kernels.rows.row_sine import LONGEST_FLIGHT
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE, NO_STOP, ON_TRACK, Row

Pressed = namedtuple("Pressed", "impulse peak")
"""The integral of a force over a phase, and its largest value."""

NOT_PRESSED = Pressed(0.0, 0.0)


@borrowing
def stop_pressed(
    row: Row, drive: Driven, pull: float, tau: float, span: float, flying: bool
) -> Pressed:
    """Return impulse and largest force of a row on the stop in front, over a time without events.

    For a stop at rest in space sum m (-gs - mode mu n), for one of the track in flight sum m times
    the push D; for parts at rest on the floor the least force, sum m max(0, D - mu_s n) over the
    blocks (theory 17.6).
    """
    first, parts = held_from(row), row.mass.size
    if first == parts:
        return NOT_PRESSED
    if row.stop == ON_TRACK and not flying:
        return _least(row, drive, pull, tau, span, first)
    (push, lift), along, normal, drag = sizes(drive), 0.0, 0.0, 0.0
    for i in range(first, parts):
        if row.stop == ON_TRACK:
            along += row.mass[i] * push
            drag += row.mass[i] * pull
        else:
            friction = 0.0 if flying else row.mode[i] * row.kinetic[i]
            normal += row.mass[i] * friction * lift
            drag += row.mass[i] * (drive.gs + friction * drive.gn)
    impulse = above(drive, first, along, normal, drag, tau, span)
    return Pressed(impulse, max(0.0, highest(drive, parts, along, normal, drag, tau, span)))


@borrowing
def _least(row: Row, drive: Driven, pull: float, tau: float, span: float, first: int) -> Pressed:
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.static[i]
    blocks = pooled(row, first, parts)
    impulse, (push, lift) = 0.0, sizes(drive)
    for b in range(blocks):
        begin, mu, mass = _block(row, first, b)
        impulse += mass * above(drive, begin, push, mu * lift, pull + mu * drive.gn, tau, span)
    peak, along, normal, drag = 0.0, 0.0, 0.0, 0.0
    for b in range(blocks - 1, -1, -1):
        _, mu, mass = _block(row, first, b)
        along, normal = along + mass * push, normal + mass * mu * lift
        drag += mass * (pull + mu * drive.gn)
        peak = max(peak, highest(drive, parts, along, normal, drag, tau, span))
    return Pressed(impulse, peak)


@borrowing
def _block(row: Row, first: int, number: int) -> tuple[int, float, float]:
    begin, mass = row.last[number - 1] + 1 if number > 0 else first, 0.0
    for i in range(begin, row.last[number] + 1):
        mass += row.mass[i]
    return begin, -row.value[begin], mass


Event = namedtuple("Event", "span kind part")
"""The phase until it happens, what it is, and the part, or the contact, that it begins with."""

NOTHING, LIFT, LANDING, STOP, START, RELEASE, HIT = range(7)  # kinds of events

NO_EVENT = Event(0.0, NOTHING, 0)  # the event before a motion starts

Air = namedtuple("Air", "landing impulse")
"""The phase until all parts land, inf on the floor, and the impulse per mass with which they do."""

ON_FLOOR = Air(math.inf, 0.0)  # the flight of parts that are on the floor

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
    drag = row.drag[contact + 1] - row.drag[contact]
    pressed = drag - relative_push(row, drive, contact, tau)
    meets = row.speed[contact] - row.speed[contact + 1]
    return (
        restitution > 0.0
        and 2.0 * restitution * meets < SHORTEST_BOUNCES * (1.0 - restitution) * pressed
    )
