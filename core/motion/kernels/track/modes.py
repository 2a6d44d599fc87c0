"""The series of a step in each mode of contact, and the event that ends it (theory 13.13).

Each returns the span of the step, the event at its end, and the order of the series.
"""

import math
from typing import NamedTuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.inputs import Cell, Flags, Floats
from vibrafeed.core.motion.kernels.track.push import (
    BOTH,
    EVENT,
    FLOOR,
    HOLD,
    INVERSE,
    ROW,
    STATE,
    WALL,
    Work,
    is_wave,
)
from vibrafeed.core.motion.kernels.track.series import (
    Contact,
    asymptotic_span,
    fill_velocities,
    first_fall,
    line_series,
    onset_series,
    slide_series,
    square_of,
    stays_in_line,
    straight_series,
    subtract_curvature,
)

LONGEST = 1.5
"""Longest step in rad, a quarter of the drive's period: beyond it a series needs more terms."""

REACH = 0.02
"""Share of a slip to which its component along its first direction may fall within a step."""


class StepSettings(NamedTuple):
    """The settings of a step: contacts, order of the series, tolerance, and phases that end it.

    `rolling` is m r^2/I of a cylinder, 0 for a block; the last terms of a series stay below
    `tolerance` in g/w. Phases in rad: `to_end` of the period or to a jump of the drive,
    `to_lift_off`, `to_jump`, infinite without jumps.
    """

    wall: bool
    rolling: float
    order: int
    tolerance: float
    to_end: float
    to_lift_off: float
    to_jump: float


class Begin(NamedTuple):
    """A slip at the start of a step: its size in g/w and direction, and how it changes.

    Its size grows (at its `onset` here) or falls at `rate` in g; if it `closes`, on a straight
    line. At the size `least` the step must end, to look at the slip again.
    """

    size: float
    cosine: float
    sine: float
    rate: float
    onset: bool
    closes: bool
    least: float


@borrowing
def term_span(work: Work, a: int, b: int, order: int, tolerance: float) -> float:
    """Return the span in rad over which two power series of a step are accurate enough.

    0.95 min((tol/|a_n|)^(1/n), (tol/|a_(n-1)|)^(1/(n-1))), with the larger coefficients of rows `a`
    and `b`: their last two terms stay below `tolerance`.
    """
    last_term = max(abs(work[a, order]), abs(work[b, order]), 1e-300)
    term_before = max(abs(work[a, order - 1]), abs(work[b, order - 1]), 1e-300)
    log_span = min(
        math.log(tolerance / last_term) / order, math.log(tolerance / term_before) / (order - 1)
    )
    return 0.95 * math.exp(log_span)


@borrowing
def first_event(
    work: Work, row: int, order: int, span: float, event: int, known_event: int
) -> tuple[float, int]:
    """Return the first fall of a series through 0 and event `event`, or span and event so far."""
    fall = first_fall(work, row, order, span, ROW.scratch)
    return (fall, event) if fall >= 0.0 else (span, known_event)


@borrowing
def until_force_ends(
    work: Work,
    sign: float,
    row: int,
    order: int,
    starts_at_zero: bool,
    span: float,
    event: int,
    known_event: int,
) -> tuple[float, int]:
    """Return the span in rad until a force falls to 0, and `event`; or `span` and `known_event`."""
    fill_multiple(work, ROW.event, sign, row, order)
    if starts_at_zero or work[ROW.event, 0] < 0.0:
        work[ROW.event, 0] = 0.0
    return first_event(work, ROW.event, order, span, event, known_event)


@borrowing
def fill_position(work: Work, axis: int, start: float, order: int) -> None:
    """Fill the power series of a position from that of its velocity, q_(k+1) = u_k/(k + 1)."""
    place, velocity = ROW.place + axis, ROW.velocity + axis
    work[place, 0] = start
    for k in range(order):
        work[place, k + 1] = work[velocity, k] * INVERSE[k + 1]


@borrowing
def fill_multiple(work: Work, row: int, factor: float, other: int, order: int) -> None:
    """Fill row `row` of `work` with a multiple of the series in row `other`, a_k = `factor` b_k."""
    for k in range(order + 1):
        work[row, k] = factor * work[other, k]


@borrowing
def fill_zero_velocity(work: Work, axis: int, order: int) -> None:
    """Fill the velocity along an axis (0, 1, 2: along, across, normal) with 0, u_k = 0."""
    for k in range(order + 1):
        work[ROW.velocity + axis, k] = 0.0


@borrowing
def flight(step: StepSettings, cell: Cell, state: Floats, work: Work) -> tuple[float, int, int]:
    """Fill the power series of a part in free flight; return span in rad, event at its end, order.

    u_(k+1) = D_k/(k + 1), with the acceleration D without contacts and `subtract_curvature` of a
    curve. The step ends where the last terms reach the tolerance, at the latest where z falls
    through 0 (`land`), or y at a wall (`bump`) (theory 13.13).
    """
    order = step.order
    for axis in range(3):
        work[ROW.velocity + axis, 0] = state[STATE.ux + axis]
    for k in range(order):
        if cell.curvature_number != 0.0:
            subtract_curvature(work, work[ROW.velocity, k], cell.curvature_number, k)
        for axis in range(3):
            work[ROW.velocity + axis, k + 1] = work[ROW.free + axis, k] * INVERSE[k + 1]
    span = min(term_span(work, ROW.velocity, ROW.velocity + 2, order, step.tolerance), step.to_end)
    if step.wall:
        span = min(span, term_span(work, ROW.velocity + 1, ROW.velocity + 1, order, step.tolerance))
    span, event = min(span, LONGEST), EVENT.nothing
    fill_position(work, 2, state[STATE.z], order)
    span, event = first_event(work, ROW.place + 2, order, span, EVENT.land, event)
    if step.wall:
        fill_position(work, 1, state[STATE.y], order)
        span, event = first_event(work, ROW.place + 1, order, span, EVENT.bump, event)
    return span, event, order


@borrowing
def stick(
    step: StepSettings, cell: Cell, state: Floats, hold: Flags, work: Work
) -> tuple[float, int, int]:
    """Fill the series of a part that sticks to floor or wall; return span in rad, event, and order.

    u = 0; a cylinder rolls across, u_y' = D_y (r - 1)/r with r = 1 + m R^2/I (theory 7.3). The step
    ends at lift-off, where the force across falls through 0, or where friction gives way
    (`to_slip`) (theory 13.13).
    """
    order, contacts, event_before = step.order, hold[HOLD.contacts], hold[HOLD.event]
    response = 1.0 + step.rolling
    for k in range(order):
        if cell.curvature_number != 0.0:
            subtract_curvature(work, 0.0, cell.curvature_number, k)
    along, across, normal, force_order = ROW.free, ROW.free + 1, ROW.free + 2, order - 1
    span = min(step.to_end, LONGEST, term_span(work, along, normal, force_order, step.tolerance))
    span = min(span, term_span(work, across, across, force_order, step.tolerance))
    event = EVENT.nothing
    lift = step.to_lift_off if contacts & FLOOR else math.inf
    if lift <= span:
        span, event = lift, EVENT.lift
    # A force that an event has just brought to 0 starts at 0, whatever rounding leaves of it.
    if contacts == FLOOR and step.wall and state[STATE.y] == 0.0:  # the wall touches, unpressed
        starts_at_zero = event_before == EVENT.release
        span, event = until_force_ends(
            work, 1.0, across, force_order, starts_at_zero, span, EVENT.press, event
        )
    elif contacts & WALL:  # the wall carries the part until the force across turns away from it
        wall_event = EVENT.release if contacts == BOTH else EVENT.leave
        span, event = until_force_ends(
            work, -1.0, across, force_order, event_before == EVENT.press, span, wall_event, event
        )
        if contacts == WALL and state[STATE.z] == 0.0:  # the floor touches, unpressed
            starts_at_zero = event_before == EVENT.lift
            span, event = until_force_ends(
                work, 1.0, normal, force_order, starts_at_zero, span, EVENT.seat, event
            )
    span, event = to_slip(step, cell, contacts, span, event, work)
    fill_zero_velocity(work, 0, order)
    fill_zero_velocity(work, 1, order)
    fill_zero_velocity(work, 2, order)
    if step.rolling > 0.0:
        work[ROW.velocity + 1, 0] = state[STATE.uy]
        for k in range(order):
            acceleration = work[ROW.free + 1, k] * step.rolling / response
            work[ROW.velocity + 1, k + 1] = acceleration * INVERSE[k + 1]
    return span, event, order


@borrowing
def to_slip(
    step: StepSettings, cell: Cell, contacts: int, span: float, event_found: int, work: Work
) -> tuple[float, int]:
    """Return the span in rad until static friction gives way, and the event there.

    The contacts hold until (mu_s L)^2 = D_1^2 + (D_2/r)^2 with the load L; in the corner until mu_s
    N + mu_w S = |D_x| (theory 4.4).
    """
    along, across, normal, event = ROW.free, ROW.free + 1, ROW.free + 2, ROW.event
    force_order, response = step.order - 1, 1.0 + step.rolling
    static, wall = cell.friction_static, cell.wall_friction
    if contacts == BOTH:
        for direction in (-1.0, 1.0):
            for k in range(force_order + 1):
                limit = -static * work[normal, k] - wall * work[across, k]
                work[event, k] = limit - direction * work[along, k]
            work[event, 0] = max(0.0, work[event, 0])
            span, event_found = first_event(work, event, force_order, span, EVENT.slip, event_found)
    else:
        row_normal, row_second = (normal, across) if contacts == FLOOR else (across, normal)
        friction = static if contacts == FLOOR else wall
        for k in range(force_order + 1):
            limit, needed_along = square_of(work, row_normal, k), square_of(work, along, k)
            needed_across = square_of(work, row_second, k)
            work[event, k] = (
                friction * friction * limit - needed_along - needed_across / (response * response)
            )
        work[event, 0] = max(0.0, work[event, 0])
        span, event_found = first_event(work, event, force_order, span, EVENT.slip, event_found)
    return span, event_found


@borrowing
def slide_in_corner(
    step: StepSettings, cell: Cell, state: Floats, begin: Begin, work: Work
) -> tuple[float, int, int]:
    """Fill the power series of a slip along floor and wall at once; return span, event and order.

    u_x' = D_x -+ (mu_k N + mu_w S), with the loads N = -D_z and S = -D_y. The step ends at
    lift-off, where the wall carries no more, or where the slip stops (theory 4.4, 13.13).
    """
    order, direction, event = step.order, begin.cosine, ROW.event
    along, across = ROW.velocity, ROW.free + 1
    fill_zero_velocity(work, 1, order)
    fill_zero_velocity(work, 2, order)
    work[along, 0] = 0.0 if begin.onset else state[STATE.ux]
    for k in range(order):
        if cell.curvature_number != 0.0:
            subtract_curvature(work, work[along, k], cell.curvature_number, k)
        # Friction at both: the loads are minus the accelerations normal to them.
        force = work[ROW.free, k] + direction * (
            cell.friction_kinetic * work[ROW.free + 2, k]
            + cell.wall_friction * work[ROW.free + 1, k]
        )
        work[along, k + 1] = force * INVERSE[k + 1]
        if k == 0 and begin.onset:
            work[along, 1] = direction * begin.rate
    span = min(term_span(work, along, along, order, step.tolerance), step.to_end, LONGEST)
    lift, event_found = step.to_lift_off, EVENT.nothing
    if lift <= span:
        span, event_found = lift, EVENT.lift
    fill_multiple(work, event, -1.0, across, order - 1)
    span, event_found = first_event(work, event, order - 1, span, EVENT.leave, event_found)
    if cell.friction_kinetic > 0.0 or cell.wall_friction > 0.0:
        fill_multiple(work, event, direction, along, order)
        span, event_found = first_event(work, event, order, span, EVENT.stop, event_found)
    return span, event_found, order


@borrowing
def slide(
    step: StepSettings, cell: Cell, state: Floats, contacts: int, begin: Begin, work: Work
) -> tuple[float, int, int]:
    """Fill the series of a slip on floor or wall; return span in rad, event at its end, order."""
    order, on_floor, event = step.order, contacts == FLOOR, ROW.event
    contact = contact_of(cell, step.rolling, on_floor)
    second, span, in_line = contact.second, math.inf, False
    if not begin.onset:
        work[ROW.slip, 0] = state[STATE.ux]
        work[ROW.slip + 1, 0] = state[STATE.ux + second] + (state[STATE.spin] if on_floor else 0.0)
        # Under a sine a slip aslant is in its line but for rounding, and would leave it and return.
        on_axis = work[ROW.slip, 0] * work[ROW.slip + 1, 0] == 0.0
        in_line = (on_axis or is_wave(work)) and stays_in_line(contact, order, work)
    stops_straight = begin.closes and not in_line
    if stops_straight:
        order = 1
        straight_series(contact, begin.cosine, begin.sine, begin.size, begin.rate, work)
        span = min(begin.size / begin.rate, step.to_end)
        event_found = EVENT.stop if span < step.to_end else EVENT.nothing
    else:
        if in_line:
            line_series(contact, order, work)
        elif begin.onset:
            onset_series(contact, order, begin.cosine, begin.sine, begin.rate, work)
            span = asymptotic_span(order, work)
        else:
            slide_series(contact, order, work)
        span = min(span, term_span(work, ROW.slip, ROW.slip + 1, order, step.tolerance))
        span, event_found = min(span, step.to_end, LONGEST), EVENT.nothing
    fill_velocities(contact, order, state[STATE.ux + second], work)
    fill_zero_velocity(work, contact.pressed, order)
    if on_floor:
        lift = step.to_lift_off
        if lift <= span:
            span, event_found = lift, EVENT.lift
    else:
        span, event_found = first_event(work, ROW.load, order - 1, span, EVENT.leave, event_found)
    if step.wall:
        place = ROW.place + second
        fill_position(work, second, state[STATE.x + second], order)
        gap_event = EVENT.bump if on_floor else EVENT.land
        span, event_found = first_event(work, place, order, span, gap_event, event_found)
    if stops_straight or not contact.friction > 0.0:
        return span, event_found, order
    if begin.onset or in_line:
        fill_multiple(work, event, 1.0, ROW.square, order)
        span, event_found = first_event(work, event, order, span, EVENT.stop, event_found)
        return span, event_found, order
    # The slip is asked again before it passes zero: its series do not feel a turn at a place that
    # is too near to it.
    for k in range(order + 1):
        work[event, k] = begin.cosine * work[ROW.slip, k] + begin.sine * work[ROW.slip + 1, k]
    work[event, 0] -= max(begin.least, REACH * begin.size)
    span, event_found = first_event(work, event, order, span, EVENT.nothing, event_found)
    return span, event_found, order


@borrowing
def contact_of(cell: Cell, rolling: float, on_floor: bool) -> Contact:
    """Return the record of the contact that slips: axes, friction, response, curvature."""
    if on_floor:
        return Contact(1, 2, cell.friction_kinetic, 1.0 + rolling, cell.curvature_number)
    return Contact(2, 1, cell.wall_friction, 1.0, cell.curvature_number)
