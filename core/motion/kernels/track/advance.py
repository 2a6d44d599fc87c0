"""From event to event through a period of the drive, and the work done on the way."""

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.constants import MODE, NODES, POWER, TALLY, WEIGHTS
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
    speed_squared = state[STATE.ux] ** 2 + state[STATE.uy] ** 2 + state[STATE.uz] ** 2
    if rolling > 0.0:
        speed_squared += state[STATE.spin] ** 2 / rolling
    return 0.5 * speed_squared


@borrowing
def add_work(
    cell: Cell,
    tau: float,
    span: float,
    order: int,
    contacts: int,
    slips: bool,
    work: Work,
    energies: Floats,
) -> None:
    """Add the work of drive and friction over a step to `energies`, columns `POWER`, in (g/w)^2.

    Per mass: the integrals of b.u (drive), of b'.u (swing, NaN of a wave) and of friction, with the
    push b and the velocity u, by Gauss's rule (theory 13.15). Nothing is done if `energies` has no
    columns.
    """
    if energies.size == 0:
        return
    gravity = (cell.gravity_number_along, cell.gravity_number_across, cell.gravity_number_normal)
    pushes = (cell.drive_number_along, cell.drive_number_across, cell.drive_number_normal)
    half_span = 0.5 * span
    for node in range(NODES.size):
        for signed_node in (-NODES[node], NODES[node]):
            elapsed = half_span * (1.0 + signed_node)
            power, swing, weight = 0.0, 0.0, half_span * WEIGHTS[node]
            slope = sine_slope(work, tau + elapsed)
            for axis in range(3):
                push = value(work, ROW.free + axis, order - 1, elapsed) + gravity[axis]
                velocity = value(work, ROW.velocity + axis, order, elapsed)
                power += push * velocity
                swing += slope * pushes[axis] * velocity
            energies[POWER.drive] += weight * power
            energies[POWER.swing] += weight * swing
            if slips and contacts != FREE:
                energies[POWER.friction] += weight * friction_power(
                    cell, contacts, order, elapsed, work
                )


@borrowing
def friction_power(cell: Cell, contacts: int, order: int, elapsed: float, work: Work) -> float:
    """Return the power that friction takes at slipping contacts, per mass in g^2/w.

    mu_k N |slip| of the floor, mu_w S |slip| of the wall, with the loads N = -D_z and S = -D_y from
    the accelerations D without contacts (theory 13.15).
    """
    floor = -cell.friction_kinetic * value(work, ROW.free + 2, order - 1, elapsed)
    wall = -cell.wall_friction * value(work, ROW.free + 1, order - 1, elapsed)
    if contacts == BOTH:
        return (floor + wall) * abs(value(work, ROW.velocity, order, elapsed))
    slip_1, slip_2 = (
        value(work, ROW.slip, order, elapsed),
        value(work, ROW.slip + 1, order, elapsed),
    )
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
    energies: Floats,
) -> bool:  # fmt: skip
    """Advance state and contacts by one period and tally it; False if it takes too many events.

    `rolling` is m r^2/I of a cylinder or 0; the energies are added to `energies`, if it has
    columns.
    """
    tally[:] = 0.0
    tau, events_at_once, sample_count = 0.0, 0, 0
    start_x, start_y = state[STATE.x], state[STATE.y]
    for _ in range(MAX_STEPS):
        if tau >= TURN:
            tally[TALLY.travel] = state[STATE.x] - start_x
            tally[TALLY.across] = 0.0 if rolling > 0.0 else state[STATE.y] - start_y
            return True
        jump = next_jump(tau, work)
        to_end = jump - tau
        to_jump = to_end if jumps(work) else math.inf
        step = StepSettings(
            wall, rolling, order, tolerance, to_end, to_lift_off(work, tau), to_jump
        )
        fill_push(cell, tau, order, work)
        work[ROW.free, 0] -= cell.gravity_number_along
        work[ROW.free + 1, 0] -= cell.gravity_number_across
        work[ROW.free + 2, 0] -= cell.gravity_number_normal
        if hold[HOLD.event] != EVENT.nothing:
            apply_contact_event(step, cell, state, hold, work, energies)
        contacts = hold[HOLD.contacts]
        begin = Begin(0.0, 0.0, 0.0, 0.0, False, False, 0.0)
        if contacts == FREE:
            hold[HOLD.slips] = 1
        elif hold[HOLD.slips] or hold[HOLD.event] != EVENT.nothing:
            begin = begin_slip(step, cell, state, hold, work)
        slips = hold[HOLD.slips] == 1
        if contacts == FREE:
            span, event, used_order = modes.flight(step, cell, state, work)
        elif not slips:
            span, event, used_order = modes.stick(step, cell, state, hold, work)
        elif contacts == BOTH:
            span, event, used_order = modes.slide_in_corner(step, cell, state, begin, work)
        else:
            span, event, used_order = modes.slide(step, cell, state, contacts, begin, work)
        events_at_once = events_at_once + 1 if span <= STEP_OVER else 0
        if events_at_once > MAX_AT_ONCE:
            span, event = step_over_events(contacts, slips, span, to_end)
            events_at_once = 0
        for axis in range(3):
            fill_position(work, axis, state[STATE.x + axis], used_order)
        add_work(cell, tau, span, used_order, contacts, slips, work, energies)
        while sample_count < phases.size and phases[sample_count] < tau + span:
            write_sample(
                phases[sample_count] - tau, used_order, contacts, slips, work, samples[sample_count]
            )
            sample_count += 1
        tally_step(span, used_order, contacts, slips, work, tally)
        move_to_end(step, state, contacts, slips, event, span, used_order, work)
        tally_event(event, contacts, state, tally)
        hold[HOLD.event] = after_jump(event) if span >= to_jump else event
        tau = jump if span >= to_end else tau + span
    return False


@borrowing
def tally_event(event: int, contacts: int, state: Floats, tally: Floats) -> None:
    """Count the event that ends a step of motion, in the sums of its period."""
    if event == EVENT.land:
        tally[TALLY.landing] = max(tally[TALLY.landing], -state[STATE.uz])
        tally[TALLY.impacts] += 1.0
    if contacts & WALL or event == EVENT.bump:
        tally[TALLY.at_wall] += 1.0
    if event != EVENT.nothing:
        signature = 31.0 * tally[TALLY.signature] + 7.0 * event + contacts
        tally[TALLY.signature] = signature % 1000003.0


@borrowing
def apply_contact_event(
    step: StepSettings, cell: Cell, state: Floats, hold: Flags, work: Work, energies: Floats
) -> None:
    """Change velocities and contacts of a part at an event; add the energy lost to `energies`."""
    energy_before = kinetic(state, step.rolling)
    change_contacts(step, cell, state, hold, work)
    if energies.size > 0:
        energies[POWER.impact] += energy_before - kinetic(state, step.rolling)


@borrowing
def after_jump(event: int) -> int:
    """Return `start` after a jump of the drive, or the landing, bump or stop at the same phase."""
    return event if event in (EVENT.land, EVENT.bump, EVENT.stop) else EVENT.start


@borrowing
def step_over_events(contacts: int, slips: bool, span: float, to_end: float) -> tuple[float, int]:
    """Return span in rad and event of a step after too many events at one phase."""
    if slips and contacts != FREE:
        return span, EVENT.stop
    return min(SHORT, to_end), EVENT.nothing


@borrowing
def move_to_end(
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
def tally_step(
    span: float, order: int, contacts: int, slips: bool, work: Work, tally: Floats
) -> None:
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
        tally_slip(span, order, work, tally)


@borrowing
def tally_slip(span: float, order: int, work: Work, tally: Floats) -> None:
    """Add the phase of a slip to the times forward and backward in `tally`, also where it turns."""
    speed, begin = ROW.event, 0.0
    for _ in range(order + 1):
        leading = 0
        fill_multiple(work, speed, 1.0, ROW.velocity, order)
        if begin > 0.0:
            for i in range(order):
                for k in range(order - 1, i - 1, -1):
                    work[speed, k] += begin * work[speed, k + 1]
            work[speed, 0] = 0.0  # a turn, by the root before
        while leading < order and work[speed, leading] == 0.0:
            leading += 1
        leading_term = work[speed, leading]
        if leading_term < 0.0:
            for k in range(leading, order + 1):
                work[speed, k] = -work[speed, k]
        to_turn = first_fall(work, speed, order, span - begin, ROW.scratch)
        end = begin + to_turn if to_turn > 0.0 else span
        if leading_term > 0.0:
            tally[TALLY.forward] += end - begin
        elif leading_term < 0.0:
            tally[TALLY.backward] += end - begin
        else:
            tally[TALLY.stick] += end - begin
        begin = end
        if begin >= span:
            return


@borrowing
def write_sample(
    elapsed: float, order: int, contacts: int, slips: bool, work: Work, row: Floats
) -> None:
    """Fill `row` with position (3), velocity (3) and mode of a part at a phase within a step."""
    for axis in range(3):
        row[axis] = value(work, ROW.place + axis, order, elapsed)
        row[3 + axis] = value(work, ROW.velocity + axis, order, elapsed)
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
