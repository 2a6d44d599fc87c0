"""From event to event: which comes first, and what it changes (theory 17.3)."""

from __future__ import annotations

import math
from collections import namedtuple

from core.compiled import compiled
from core.motion.kernels.planar.flow import TURN, flow, phase_to
from core.motion.kernels.rows.contact import (
    chain_end,
    collide,
    land,
    least_friction,
    set_flows,
    slide,
    start,
)
from core.motion.kernels.rows.roots import first_beyond, first_contact, first_stop, flight_time
from core.motion.kernels.rows.tables import Drive, Row

Event = namedtuple("Event", "span kind part")
"""The phase until it happens, what it is, and the part, or the contact, that it begins with."""

NOTHING, LIFT, LANDING, STOP, START, HIT = range(6)

Air = namedtuple("Air", "landing impulse")
"""The phase until all parts land, inf on the floor, and the impulse per mass with which they do."""

ON_FLOOR = Air(math.inf, 0.0)

LONGEST_FLIGHT = 1000
"""Turns of the drive: at throw numbers beyond some 3,000 no feeder works."""


@compiled
def refreshed(row: Row, drive: Drive, level: float, tau: float, flying: bool, forced: int) -> None:
    """Let parts start that are pushed, open idle contacts, and set all flows, after an event."""
    pull = drive.gs - level
    if not flying:
        push = drive.c * math.sin(tau) - pull
        load = max(0.0, drive.gn - drive.s * math.sin(tau))
        start(row, push, load, forced)
        slide(row)
    set_flows(row, drive, pull, flying)


@compiled
def next_event(
    row: Row, drive: Drive, level: float, tau: float, span: float, landing: float
) -> Event:
    """Return the earliest event within a span; `landing` is the phase until then, inf on the floor.

    Of several at once lift-off comes first, then landings, stops, starts and collisions.
    """
    event = Event(span, NOTHING, 0)
    flying = landing < math.inf
    if flying:
        if landing < span:
            event = Event(landing, LANDING, 0)
    else:
        if drive.s > drive.gn:
            up = phase_to(math.asin(drive.gn / drive.s), tau)
            if up < span:
                event = Event(up, LIFT, 0)
        event = _on_floor(row, drive, drive.gs - level, tau, event)
    for i in range(row.closed.size):
        if row.closed[i] == 0:
            gain, drag = row.gain[i + 1] - row.gain[i], row.drag[i + 1] - row.drag[i]
            apart = row.speed[i + 1] - row.speed[i]
            until = first_contact(row.gap[i], apart, gain, drag, tau, event.span)
            if until < event.span:
                event = Event(until, HIT, i)
    return event


@compiled
def _on_floor(row: Row, drive: Drive, pull: float, tau: float, event: Event) -> Event:
    """Return the earlier of an event and the first stop or start.

    A chain at rest starts where c sin(tau) - pull = +-mu (gn - s sin(tau)), mu as `least_friction`.
    """
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        mode = row.mode[first]
        if mode != 0:
            until = first_stop(
                row.speed[first], mode, row.gain[first], row.drag[first], tau, event.span
            )
            if until < event.span:
                event = Event(until, STOP, first)
        else:
            for way in (1, -1):
                mu = least_friction(row, first, end, way)
                until = first_beyond(way * drive.c + mu * drive.s, way * pull + mu * drive.gn, tau)
                if until < event.span:
                    event = Event(until, START, first)
        first = end
    return event


@compiled
def move(row: Row, tau: float, span: float) -> None:
    """Carry all parts over a phase by their flows; gaps change by what their parts do.

    Parts that touch have one velocity, one C and one k: they move by the same, to the bit.
    """
    sine, cosine = math.sin(tau), math.cos(tau)
    behind = 0.0
    for i in range(row.mass.size):
        row.speed[i], way = flow(row.speed[i], row.gain[i], row.drag[i], sine, cosine, span)
        row.place[i] += way
        if i > 0 and row.closed[i - 1] == 0:
            row.gap[i - 1] += way - behind
        behind = way


@compiled
def lifted(drive: Drive, tau: float) -> Air:
    """Return the flight that begins at a phase: z'' = s sin(tau) - gn from z = z' = 0."""
    span = flight_time(drive.s, drive.gn, tau, LONGEST_FLIGHT)
    if span == math.inf:
        return Air(TURN * LONGEST_FLIGHT, 0.0)
    rate, _ = flow(0.0, drive.s, drive.gn, math.sin(tau), math.cos(tau), span)
    return Air(span, -rate)


@compiled
def happened(
    row: Row, drive: Drive, event: Event, tau: float, air: Air, restitution: float
) -> tuple[Air, float]:
    """Change a row by an event at a phase; return the flight after it, and the energy it takes."""
    lost = 0.0
    if event.kind == LIFT:
        air = lifted(drive, tau)
    elif event.kind == LANDING:
        land(row, air.impulse)
        again = drive.s * math.sin(tau) > drive.gn
        air = lifted(drive, tau) if again else ON_FLOOR
    elif event.kind == STOP:
        for i in range(event.part, chain_end(row, event.part)):
            row.speed[i], row.mode[i] = 0.0, 0
    elif event.kind == HIT:
        lost = collide(row, event.part, restitution)
    return air, lost
