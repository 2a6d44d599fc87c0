"""From event to event: which comes first, and what it changes (theory 17.3)."""

from __future__ import annotations

import math
from collections import namedtuple
from typing import Any

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.contact import (
    chain_end,
    collide,
    held_from,
    hold,
    is_held,
    land,
    least_friction,
    least_pressed,
    set_flows,
    slide,
    start,
)
from vibrafeed.core.motion.kernels.rows.drive import (
    Driven,
    at_phase,
    carried,
    contact_until,
    first_rise,
    flight,
    is_lifted,
    lift_off,
    pushes,
    relative_push,
    stop_until,
    swung,
)
from vibrafeed.core.motion.kernels.rows.sine import LONGEST_FLIGHT
from vibrafeed.core.motion.kernels.rows.tables import IN_SPACE, NO_STOP, ON_TRACK, Row

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
    """Update a row of parts after an event: start, release or part some, and set accelerations.

    Parts that the push can move start, contacts without force open, and parts no longer pressed
    onto a stop are released. `level` is what the step of the drive adds to the push in g, `tau` the
    phase now in rad, `flying` is True if the parts are in the air; `event` is the one that has just
    happened, whose limit counts as reached.
    """
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

    A record of the phase until then, its kind, and the part or contact that it begins with;
    `NOTHING` at `span` if there is none. Of several at once lift-off comes first, then landings,
    stops, starts, releases by the stop and collisions. `landing` is the phase until the parts land,
    inf on the floor; `level` is what the step of the drive adds to the push in g.
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
    """Return the first stop or start of parts of a row on the floor, or `event` if it is earlier.

    A sliding chain stops where its velocity is 0. A chain at rest starts where the push along
    exceeds the least static friction of a block at its end: under a sine c sin(tau) - pull = +-mu
    (gn - s sin(tau)), with the friction mu of that block.

    `pull` is gravity along less the level of the drive's step in g, `tau` the phase now in rad,
    `now` its sine and cosine (`at_phase`), `event` the earliest event of other kinds.
    """
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
    """Return the event at which the stop in front lets go a block of a row, if it is earliest.

    A block is released where nothing presses it onto the stop any more: from a stop of the track in
    flight where the push turns back; from one at rest in space, sliding, where -mode mu n falls to
    gs, gravity along the track, with the direction of slip `mode`, friction mu and load n (theory
    17.6). Otherwise `event`, the earliest of the others, is returned.

    `pull` is gravity along less the level of the drive's step in g, `tau` the phase now in rad,
    `flying` True if the parts are in the air.
    """
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

    Velocities, positions and gaps in `row` are changed, in g/w and g/w^2 (w = 2 pi f), and those of
    a stop in front. There must be no event within. Parts that touch have one velocity and one
    acceleration: they move by the same distance, to the bit.
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
    """Return the flight that begins at phase `tau`: phase until landing, landing speed in g/w.

    Here w = 2 pi f, f being the frequency of the drive.
    """
    span, impulse = flight(drive, tau)
    return Air(min(span, TURN * LONGEST_FLIGHT), impulse)


@borrowing
def happened(
    row: Row, drive: Driven, event: Event, tau: float, air: Air, restitution: float
) -> tuple[Air, float, float]:
    """Change the state of a row by an event at phase `tau`; return the flight after it, and losses.

    The flight is the phase until all parts land, inf on the floor, and the impulse of landing. The
    losses are the energy that a collision takes, in mass times (g/w)^2 with w = 2 pi f, and the
    impulse on the stop in front, in mass times g/w. `event` is what happens, `air` the flight
    before, `restitution` that between parts.
    """
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
    """True if two colliding parts of a row would bounce for nearly no time, and so touch at once.

    Bounces under the relative acceleration -a that presses them together, from the relative speed
    v, last 2 e v/(a (1 - e)) in all, with the `restitution` e; below 1e-6 rad they are left out
    (theory 13.5). `contact` is the index of the rear part, `tau` the phase in rad.
    """
    drag = row.drag[contact + 1] - row.drag[contact]
    pressed = drag - relative_push(row, drive, contact, tau)
    meets = row.speed[contact] - row.speed[contact + 1]
    return (
        restitution > 0.0
        and 2.0 * restitution * meets < SHORTEST_BOUNCES * (1.0 - restitution) * pressed
    )
