"""From event to event through a period of the drive, and the work done on the way."""

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.constants import MODE, NODES, SPENT, TALLY, WEIGHTS
from vibrafeed.core.motion.kernels.inputs import Cell, Flags, Floats
from vibrafeed.core.motion.kernels.track import modes
from vibrafeed.core.motion.kernels.track.contacts import begin_slip, change_contacts
from vibrafeed.core.motion.kernels.track.modes import (
    Begin,
    StepSettings,
    fill_multiple,
    fill_position,
)
from vibrafeed.core.motion.kernels.track.push import (
    BOTH,
    EVENT,
    FLOOR,
    FREE,
    HOLD,
    ROW,
    STATE,
    TURN,
    WALL,
    Work,
    fill_push,
    jumps,
    next_jump,
    sine_slope,
    to_lift_off,
)
from vibrafeed.core.motion.kernels.track.series import first_fall, value


@borrowing
def kinetic(state: Floats, rolling: float) -> float:
    """Return the kinetic energy per mass relative to the track, in (g/w)^2, with a cylinder's spin.

    (u.u + spin^2/(m r^2/I))/2, `rolling` = m r^2/I or 0 (theory 13.15).
    """
    square = state[STATE.ux] ** 2 + state[STATE.uy] ** 2 + state[STATE.uz] ** 2
    if rolling > 0.0:
        square += state[STATE.spin] ** 2 / rolling
    return 0.5 * square


@borrowing
def spend(
    cell: Cell,
    tau: float,
    span: float,
    order: int,
    contacts: int,
    slips: bool,
    work: Work,
    spent: Floats,
) -> None:
    """Add the work of drive and friction over a step to `spent` (columns of `SPENT`), in (g/w)^2.

    Per mass: the integrals of b.u (drive), of b'.u (swing, NaN of a wave) and of friction, with the
    push b and the velocity u, by Gauss's rule (theory 13.15). Nothing is done if `spent` has no
    columns.
    """
    if spent.size == 0:
        return
    gravity = (cell.gravity_number_along, cell.gravity_number_across, cell.gravity_number_normal)
    pushes = (cell.drive_number_along, cell.drive_number_across, cell.drive_number_normal)
    half = 0.5 * span
    for number in range(NODES.size):
        for side in (-NODES[number], NODES[number]):
            at = half * (1.0 + side)
            power, swing, weight = 0.0, 0.0, half * WEIGHTS[number]
            slope = sine_slope(work, tau + at)
            for axis in range(3):
                push = value(work, ROW.free + axis, order - 1, at) + gravity[axis]
                velocity = value(work, ROW.velocity + axis, order, at)
                power += push * velocity
                swing += slope * pushes[axis] * velocity
            spent[SPENT.drive] += weight * power
            spent[SPENT.swing] += weight * swing
            if slips and contacts != FREE:
                spent[SPENT.friction] += weight * rubbing(cell, contacts, order, at, work)


@borrowing
def rubbing(cell: Cell, contacts: int, order: int, at: float, work: Work) -> float:
    """Return the power that friction takes at slipping contacts, per mass in g^2/w.

    mu_k N |slip| of the floor, mu_w S |slip| of the wall, with the loads N = -D_z and S = -D_y from
    the accelerations D without contacts (theory 13.15).
    """
    floor = -cell.friction_kinetic * value(work, ROW.free + 2, order - 1, at)
    wall = -cell.wall_friction * value(work, ROW.free + 1, order - 1, at)
    if contacts == BOTH:
        return (floor + wall) * abs(value(work, ROW.velocity, order, at))
    slip_1, slip_2 = value(work, ROW.slip, order, at), value(work, ROW.slip + 1, order, at)
    return (floor if contacts == FLOOR else wall) * math.hypot(slip_1, slip_2)


MAX_STEPS = 10_000
"""Most steps of a period, which smooth motion passes in five: more come from events that pile
up."""
MAX_AT_ONCE = 12
"""Most events at one phase, more than there are kinds: then a slip is taken to stop, or a short
step is taken."""
SHORT = 1e-9  # phase in rad of that short step
STEP_OVER = 1e-14
"""Phase in rad: a shorter step does not count as going on."""


@borrowing
def advance(
    cell: Cell, wall: bool, rolling: float, order: int, tolerance: float,
    state: Floats, hold: Flags, tally: Floats, work: Work, phases: Floats, samples: Floats,
    spent: Floats,
) -> bool:  # fmt: skip
    """Advance state and contacts by one period and tally it; False if it takes too many events.

    `rolling` is m r^2/I of a cylinder or 0; the energies are added to `spent`, if it has columns.
    """
    tally[:] = 0.0
    tau, at_once, sampled = 0.0, 0, 0
    start, across = state[STATE.x], state[STATE.y]
    for _ in range(MAX_STEPS):
        if tau >= TURN:
            tally[TALLY.travel] = state[STATE.x] - start
            tally[TALLY.across] = 0.0 if rolling > 0.0 else state[STATE.y] - across
            return True
        jump = next_jump(tau, work)
        rest = jump - tau
        even = rest if jumps(work) else math.inf
        step = StepSettings(wall, rolling, order, tolerance, rest, to_lift_off(work, tau), even)
        fill_push(cell, tau, order, work)
        work[ROW.free, 0] -= cell.gravity_number_along
        work[ROW.free + 1, 0] -= cell.gravity_number_across
        work[ROW.free + 2, 0] -= cell.gravity_number_normal
        if hold[HOLD.event] != EVENT.nothing:
            meet(step, cell, state, hold, work, spent)
        contacts = hold[HOLD.contacts]
        begin = Begin(0.0, 0.0, 0.0, 0.0, False, False, 0.0)
        if contacts == FREE:
            hold[HOLD.slips] = 1
        elif hold[HOLD.slips] or hold[HOLD.event] != EVENT.nothing:
            begin = begin_slip(step, cell, state, hold, work)
        slips = hold[HOLD.slips] == 1
        if contacts == FREE:
            span, event, used = modes.flight(step, cell, state, work)
        elif not slips:
            span, event, used = modes.stick(step, cell, state, hold, work)
        elif contacts == BOTH:
            span, event, used = modes.slide_in_corner(step, cell, state, begin, work)
        else:
            span, event, used = modes.slide(step, cell, state, contacts, begin, work)
        at_once = at_once + 1 if span <= STEP_OVER else 0
        if at_once > MAX_AT_ONCE:
            span, event = go_on(contacts, slips, span, rest)
            at_once = 0
        for axis in range(3):
            fill_position(work, axis, state[STATE.x + axis], used)
        spend(cell, tau, span, used, contacts, slips, work, spent)
        while sampled < phases.size and phases[sampled] < tau + span:
            sample(phases[sampled] - tau, used, contacts, slips, work, samples[sampled])
            sampled += 1
        count(span, used, contacts, slips, work, tally)
        move(step, state, contacts, slips, event, span, used, work)
        count_event(event, contacts, state, tally)
        hold[HOLD.event] = after_jump(event) if span >= even else event
        tau = jump if span >= rest else tau + span
    return False


@borrowing
def count_event(event: int, contacts: int, state: Floats, tally: Floats) -> None:
    """Count the event that ends a step of motion, in the sums of its period."""
    if event == EVENT.land:
        tally[TALLY.landing] = max(tally[TALLY.landing], -state[STATE.uz])
        tally[TALLY.impacts] += 1.0
    if contacts & WALL or event == EVENT.bump:
        tally[TALLY.at_wall] += 1.0
    if event != EVENT.nothing:
        mark = 31.0 * tally[TALLY.signature] + 7.0 * event + contacts
        tally[TALLY.signature] = mark % 1000003.0


@borrowing
def meet(
    step: StepSettings, cell: Cell, state: Floats, hold: Flags, work: Work, spent: Floats
) -> None:
    """Change velocities and contacts of a part at an event; add the energy lost to `spent`."""
    before = kinetic(state, step.rolling)
    change_contacts(step, cell, state, hold, work)
    if spent.size > 0:
        spent[SPENT.impact] += before - kinetic(state, step.rolling)


@borrowing
def after_jump(event: int) -> int:
    """Return `start` after a jump of the drive, or the landing, bump or stop at the same phase."""
    return event if event in (EVENT.land, EVENT.bump, EVENT.stop) else EVENT.start


@borrowing
def go_on(contacts: int, slips: bool, span: float, rest: float) -> tuple[float, int]:
    """Return span in rad and event of a step after too many events at one phase."""
    if slips and contacts != FREE:
        return span, EVENT.stop
    return min(SHORT, rest), EVENT.nothing


@borrowing
def move(
    step: StepSettings, state: Floats, contacts: int, slips: bool, event: int, span: float,
    order: int, work: Work,
) -> None:  # fmt: skip
    """Move `state` to the end of a step by evaluating the power series of the step at t = `span`.

    Position and velocity normal to a contact that carries the part, and the position at a landing
    or bump, are set to 0, so that rounding leaves no gap; the spin of a cylinder on the floor is
    its slip less u_y (theory 7.3).
    """
    slip = 0.0
    if step.rolling > 0.0 and contacts == FLOOR and slips:
        slip = value(work, ROW.slip + 1, order, span)
    for axis in range(3):
        if (axis == 1 and contacts & WALL) or (axis == 2 and contacts & FLOOR):
            state[STATE.x + axis], state[STATE.ux + axis] = 0.0, 0.0
        else:
            state[STATE.x + axis] = value(work, ROW.place + axis, order, span)
            state[STATE.ux + axis] = value(work, ROW.velocity + axis, order, span)
    if contacts & FLOOR and step.rolling > 0.0:
        state[STATE.spin] = slip - state[STATE.uy]
    if event == EVENT.land:
        state[STATE.z] = 0.0
        state[STATE.uz] = min(0.0, state[STATE.uz])
    elif event == EVENT.bump:
        state[STATE.y] = 0.0
        state[STATE.uy] = min(0.0, state[STATE.uy])


@borrowing
def count(span: float, order: int, contacts: int, slips: bool, work: Work, tally: Floats) -> None:
    """Add the phase of a step to the time in its mode in `tally`, and update the largest height."""
    if not contacts & FLOOR:
        tally[TALLY.flight] += span
        place, speed = ROW.place + 2, ROW.velocity + 2
        fastest = max(work[speed, 0], value(work, speed, order, span))
        if work[place, 0] + span * fastest > tally[TALLY.height]:
            fall = first_fall(work, speed, order, span, ROW.scratch)
            top = value(work, place, order, fall if fall > 0.0 else span)
            tally[TALLY.height] = max(tally[TALLY.height], top)
    elif not slips:
        tally[TALLY.stick] += span
    else:
        count_slip(span, order, work, tally)


@borrowing
def count_slip(span: float, order: int, work: Work, tally: Floats) -> None:
    """Add the phase of a slip to the times forward and backward in `tally`, also where it turns."""
    speed, at = ROW.event, 0.0
    for _ in range(order + 1):
        lead = 0
        fill_multiple(work, speed, 1.0, ROW.velocity, order)
        if at > 0.0:
            for i in range(order):
                for k in range(order - 1, i - 1, -1):
                    work[speed, k] += at * work[speed, k + 1]
            work[speed, 0] = 0.0  # a turn, by the root before
        while lead < order and work[speed, lead] == 0.0:
            lead += 1
        way = work[speed, lead]
        if way < 0.0:
            for k in range(lead, order + 1):
                work[speed, k] = -work[speed, k]
        turn = first_fall(work, speed, order, span - at, ROW.scratch)
        end = at + turn if turn > 0.0 else span
        if way > 0.0:
            tally[TALLY.forward] += end - at
        elif way < 0.0:
            tally[TALLY.backward] += end - at
        else:
            tally[TALLY.stick] += end - at
        at = end
        if at >= span:
            return


@borrowing
def sample(since: float, order: int, contacts: int, slips: bool, work: Work, row: Floats) -> None:
    """Fill `row` with position (3), velocity (3) and mode of a part at a phase within a step."""
    for axis in range(3):
        row[axis] = value(work, ROW.place + axis, order, since)
        row[3 + axis] = value(work, ROW.velocity + axis, order, since)
    if not contacts & FLOOR:
        row[6] = MODE.flight
    elif not slips or row[3] == 0.0:
        row[6] = MODE.stick
    else:
        row[6] = MODE.forward if row[3] > 0.0 else MODE.backward
    if contacts & WALL:
        row[1] = 0.0
    if contacts & FLOOR:
        row[2] = 0.0
    row[1] = max(0.0, row[1]) if math.isfinite(row[1]) else row[1]
    row[2] = max(0.0, row[2])
