"""The series of a step in each mode of contact, and the event that ends it (theory 13.13).

Each function fills `work.velocity`, and the places that an event depends on; it returns the span of
the step, the event at its end, and the order up to which the series are filled.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from core.compiled import compiled
from core.motion.kernels.arrays import Flags, Floats
from core.motion.kernels.track.drive import to_lift_off
from core.motion.kernels.track.polynomials import first_fall
from core.motion.kernels.track.slide import (
    Contact,
    asymptotic_span,
    bend,
    fill_velocities,
    last_of_slip,
    onset_series,
    slide_series,
    squares,
)
from core.motion.kernels.track.tables import BOTH, EVENT, FLOOR, HOLD, STATE, WALL, Cell, Work

LONGEST = 1.5
"""Of a step: a quarter of the drive's period, beyond which its series needs more terms."""


class Step(NamedTuple):
    """What a step is computed with: contacts, order, tolerance of a term, where the period ends."""

    wall: bool
    rolling: float
    order: int
    tolerance: float
    rest: float


class Begin(NamedTuple):
    """How a slip stands at the start of a step: its size and direction, and how it changes.

    `onset` where it begins, at the rate `rate`; `closes` where what is left of it is a straight
    line to its end, at that rate; `least` is the size at which it is to be asked again.
    """

    size: float
    cosine: float
    sine: float
    rate: float
    onset: bool
    closes: bool
    least: float


@compiled
def term_span(a: Floats, b: Floats, order: int, tolerance: float) -> float:
    """Return the span over which the last two terms of two series stay below the tolerance."""
    last = max(abs(a[order]), abs(b[order]), 1e-300)
    before = max(abs(a[order - 1]), abs(b[order - 1]), 1e-300)
    return 0.95 * min(
        (tolerance / last) ** (1.0 / order), (tolerance / before) ** (1.0 / (order - 1))
    )


@compiled
def sooner(
    event: Floats, order: int, span: float, name: int, known: int, scratch: Floats
) -> tuple[float, int]:
    """Return the span to the first fall of a series and its name, or what is known."""
    fall = first_fall(event, order, span, scratch)
    return (fall, name) if fall >= 0.0 else (span, known)


@compiled
def fill_place(place: Floats, start: float, velocity: Floats, order: int) -> None:
    """Fill the series of a place from that of its velocity."""
    place[0] = start
    for k in range(order):
        place[k + 1] = velocity[k] / (k + 1)


@compiled
def flight(step: Step, cell: Cell, state: Floats, work: Work) -> tuple[float, int, int]:
    """Fill the series of a part that nothing carries."""
    order = step.order
    for axis in range(3):
        work.velocity[axis, 0] = state[STATE.ux + axis]
    for k in range(order):
        bend(work, work.velocity[0, k], cell.curvature_number, k)
        for axis in range(3):
            work.velocity[axis, k + 1] = work.free[axis, k] / (k + 1)
    span = min(term_span(work.velocity[0], work.velocity[2], order, step.tolerance), step.rest)
    if step.wall:
        span = min(span, term_span(work.velocity[1], work.velocity[1], order, step.tolerance))
    span, event = min(span, LONGEST), EVENT.nothing
    fill_place(work.place[2], state[STATE.z], work.velocity[2], order)
    span, event = sooner(work.place[2], order, span, EVENT.land, event, work.scratch)
    if step.wall:
        fill_place(work.place[1], state[STATE.y], work.velocity[1], order)
        span, event = sooner(work.place[1], order, span, EVENT.bump, event, work.scratch)
    return span, event, order


@compiled
def stick(
    step: Step, cell: Cell, state: Floats, hold: Flags, tau: float, work: Work
) -> tuple[float, int, int]:
    """Fill those of a part that friction holds at floor, wall or both; a cylinder rolls across."""
    order, contacts, before = step.order, hold[HOLD.contacts], hold[HOLD.event]
    response, event = 1.0 + step.rolling, work.event
    for k in range(order):
        bend(work, 0.0, cell.curvature_number, k)
    free, top = work.free, order - 1
    span = min(step.rest, LONGEST, term_span(free[0], free[2], top, step.tolerance))
    span, name = min(span, term_span(free[1], free[1], top, step.tolerance)), EVENT.nothing
    lift = to_lift_off(work.lifts, tau) if contacts & FLOOR else math.inf
    if lift <= span:
        span, name = lift, EVENT.lift
    if contacts == FLOOR and step.wall and state[STATE.y] == 0.0:
        event[: top + 1] = free[1, : top + 1]
        if before == EVENT.release or event[0] < 0.0:
            event[0] = 0.0
        span, name = sooner(event, top, span, EVENT.press, name, work.scratch)
    elif contacts & WALL:
        event[: top + 1] = -free[1, : top + 1]
        if before == EVENT.press or event[0] < 0.0:
            event[0] = 0.0
        word = EVENT.release if contacts == BOTH else EVENT.leave
        span, name = sooner(event, top, span, word, name, work.scratch)
        if contacts == WALL and state[STATE.z] == 0.0:
            event[: top + 1] = free[2, : top + 1]
            if before == EVENT.lift or event[0] < 0.0:
                event[0] = 0.0
            span, name = sooner(event, top, span, EVENT.seat, name, work.scratch)
    static, wall = cell.friction_static, cell.wall_friction
    if contacts == BOTH:
        for way in (-1.0, 1.0):
            for k in range(top + 1):
                event[k] = -static * free[2, k] - wall * free[1, k] - way * free[0, k]
            event[0] = max(0.0, event[0])
            span, name = sooner(event, top, span, EVENT.slip, name, work.scratch)
    else:
        pressed, second = (2, 1) if contacts == FLOOR else (1, 2)
        friction = static if contacts == FLOOR else wall
        for k in range(top + 1):
            held, need = squares(free[pressed], free[second], k)
            along, _ = squares(free[0], free[0], k)
            event[k] = friction * friction * held - along - need / (response * response)
        event[0] = max(0.0, event[0])
        span, name = sooner(event, top, span, EVENT.slip, name, work.scratch)
    work.velocity[:, : order + 1] = 0.0
    if step.rolling > 0.0:
        work.velocity[1, 0] = state[STATE.uy]
        for k in range(order):
            work.velocity[1, k + 1] = free[1, k] * step.rolling / response / (k + 1)
    return span, name, order


@compiled
def slide_in_corner(
    step: Step, cell: Cell, state: Floats, begin: Begin, tau: float, work: Work
) -> tuple[float, int, int]:
    """Fill those of a slip along floor and wall at once: in one direction only."""
    order, way, free, event = step.order, begin.cosine, work.free, work.event
    along = work.velocity[0]
    work.velocity[1:, : order + 1] = 0.0
    along[0] = 0.0 if begin.onset else state[STATE.ux]
    for k in range(order):
        bend(work, along[k], cell.curvature_number, k)
        # Friction at both: the loads are minus the accelerations normal to them.
        force = free[0, k] + way * (
            cell.friction_kinetic * free[2, k] + cell.wall_friction * free[1, k]
        )
        along[k + 1] = force / (k + 1)
        if k == 0 and begin.onset:
            along[1] = way * begin.rate
    span = min(term_span(along, along, order, step.tolerance), step.rest, LONGEST)
    lift, name = to_lift_off(work.lifts, tau), EVENT.nothing
    if lift <= span:
        span, name = lift, EVENT.lift
    event[:order] = -free[1, :order]
    span, name = sooner(event, order - 1, span, EVENT.leave, name, work.scratch)
    if cell.friction_kinetic > 0.0 or cell.wall_friction > 0.0:
        event[: order + 1] = way * along[: order + 1]
        span, name = sooner(event, order, span, EVENT.stop, name, work.scratch)
    return span, name, order


@compiled
def slide(
    step: Step, cell: Cell, state: Floats, contacts: int, begin: Begin, tau: float, work: Work
) -> tuple[float, int, int]:
    """Fill those of a slip on floor or wall, in two directions."""
    order, on_floor, event = step.order, contacts == FLOOR, work.event
    contact = contact_of(cell, step.rolling, on_floor)
    second = contact.second
    if begin.closes:
        order = 1
        last_of_slip(contact, begin.cosine, begin.sine, begin.size, begin.rate, work)
        span = min(begin.size / begin.rate, step.rest)
        name = EVENT.stop if span < step.rest else EVENT.nothing
    else:
        if begin.onset:
            onset_series(contact, order, begin.cosine, begin.sine, begin.rate, work)
            span = asymptotic_span(order, work)
        else:
            work.slip[0, 0] = state[STATE.ux]
            work.slip[1, 0] = state[STATE.ux + second] + (state[STATE.spin] if on_floor else 0.0)
            slide_series(contact, order, work)
            span = math.inf
        span = min(span, term_span(work.slip[0], work.slip[1], order, step.tolerance))
        span, name = min(span, step.rest, LONGEST), EVENT.nothing
    fill_velocities(contact, order, state[STATE.ux + second], work)
    work.velocity[contact.pressed, : order + 1] = 0.0
    if on_floor:
        lift = to_lift_off(work.lifts, tau)
        if lift <= span:
            span, name = lift, EVENT.lift
    else:
        span, name = sooner(work.load, order - 1, span, EVENT.leave, name, work.scratch)
    if step.wall:
        place = work.place[second]
        fill_place(place, state[STATE.x + second], work.velocity[second], order)
        word = EVENT.bump if on_floor else EVENT.land
        span, name = sooner(place, order, span, word, name, work.scratch)
    if begin.closes or not contact.friction > 0.0:
        return span, name, order
    event[: order + 1] = work.square[: order + 1]
    if begin.onset:
        span, name = sooner(event, order, span, EVENT.stop, name, work.scratch)
    else:
        event[0] -= begin.least * begin.least
        span, name = sooner(event, order, span, EVENT.nothing, name, work.scratch)
    return span, name, order


@compiled
def contact_of(cell: Cell, rolling: float, on_floor: bool) -> Contact:
    """Return the contact that slips."""
    if on_floor:
        return Contact(1, 2, cell.friction_kinetic, 1.0 + rolling, cell.curvature_number)
    return Contact(2, 1, cell.wall_friction, 1.0, cell.curvature_number)
