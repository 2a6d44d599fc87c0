"""Contacts at an event: impacts, and the mode that comes after it."""

import math

from vibrafeed.core.compiled import borrowing, compiled
from vibrafeed.core.motion.kernels.constants import SETTLED_EXACTLY, SETTLED_TIME
from vibrafeed.core.motion.kernels.inputs import Cell, Flags, Floats
from vibrafeed.core.motion.kernels.track import push
from vibrafeed.core.motion.kernels.track.modes import Begin, StepSettings
from vibrafeed.core.motion.kernels.track.push import (
    BOTH,
    EVENT,
    FLOOR,
    FREE,
    HOLD,
    ROW,
    STATE,
    WALL,
    Work,
)

MAX_SWEEPS = 500
"""Of two impacts at once: a sweep shrinks what is left by mu_k mu_w, at 0.93 to 1e-16 after
these."""
STEADY = 1e-16  # change of the impulses over the speeds of impact, below which sweeps end
MAX_NEWTON = 60
"""Newton's steps from the left on a concave function: even if each did no more than halve the
error, 47 would end it."""
GONE = 2.0
"""In tolerances: a slip no larger than this is none; it is looked for at one tolerance."""
NEAR_STOP = 3.0
"""In tolerances: the square of what is left of a slip over its least rate of closing, below which
it ends on a straight line."""


@compiled
def friction_impulse(
    slip_1: float, slip_2: float, static_limit: float, kinetic_impulse: float, response: float
) -> tuple[float, float, bool]:
    """Return the friction impulse (two components) at one contact, and True if it sticks.

    Per mass, in g/w; a unit impulse changes the slip by 1 and by r = `response`. It sticks if an
    impulse of at most `static_limit` can stop it; else the impulse is -q e, with q =
    `kinetic_impulse` and e = (s_1/(z + q), s_2/(z + r q)) along the slip that is left, where |e| =
    1 gives z: the secular equation of theory 7.3.
    """
    stop_2 = slip_2 / response
    if slip_1 * slip_1 + stop_2 * stop_2 <= static_limit * static_limit:
        return -slip_1, -stop_2, True
    slip_size = math.hypot(slip_1, slip_2)
    if response == 1.0:
        return -kinetic_impulse * slip_1 / slip_size, -kinetic_impulse * slip_2 / slip_size, False
    # Newton on 1/|e(z)| = 1, concave: from below the root it rises and cannot overshoot.
    z = max(
        0.0,
        abs(slip_1) - kinetic_impulse,
        abs(slip_2) - response * kinetic_impulse,
        slip_size - response * kinetic_impulse,
    )
    e_1, e_2 = 0.0, 0.0
    for _ in range(MAX_NEWTON):
        e_1 = slip_1 / (z + kinetic_impulse)
        e_2 = slip_2 / (z + response * kinetic_impulse)
        square = e_1 * e_1 + e_2 * e_2
        slope = e_1 * e_1 / (z + kinetic_impulse) + e_2 * e_2 / (z + response * kinetic_impulse)
        step = square * (math.sqrt(square) - 1.0) / slope
        z += step
        if not step > 1e-14 * slip_size:
            break
    size = math.hypot(e_1, e_2)
    return -kinetic_impulse * e_1 / size, -kinetic_impulse * e_2 / size, False


@borrowing
def rebound(speed: float, load: float, restitution: float, to_next_event: float) -> float:
    """Return the restitution of an impact: `restitution`, or 0 if its hops are to be left out.

    The hops last T = 2 w/(L (1 - eps)), w = eps v, and are left out if w T < 1e-13 and T <
    `to_next_event`/1000, the phase to the next event. Their impulses add up to what the contact
    carries in their time, less w (theory 13.5).
    """
    if restitution >= 1.0 or not load > 0.0:
        return restitution
    rebound_speed = restitution * speed
    hop_time = 2.0 * rebound_speed / (load * (1.0 - restitution))
    return (
        0.0
        if rebound_speed * hop_time < SETTLED_EXACTLY and hop_time < SETTLED_TIME * to_next_event
        else restitution
    )


@borrowing
def solve_impacts(
    step: StepSettings,
    cell: Cell,
    state: Floats,
    floor_speed: float,
    wall_speed: float,
    floor_restitution: float,
    wall_restitution: float,
) -> None:
    """Change the velocities in `state` by an impact on the floor, on the wall, or on both at once.

    The speeds are those of approach, 0 without an impact. Newton's law holds normal to each, u_n+ =
    -eps u_n-, and Coulomb's along it: an impulse of |i_t| <= mu i_n stops the slip if it can
    (theory 13.1). Two impacts at once are solved in turn until their impulses no longer change.
    """
    ux, uy, uz = STATE.ux, STATE.uy, STATE.uz
    floor_impulse, wall_impulse, floor_x, floor_y, wall_x, wall_z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    tolerance = STEADY * (floor_speed + wall_speed + abs(state[ux]))
    for _ in range(MAX_SWEEPS):
        change = 0.0
        if floor_speed > 0.0:
            new_impulse = max(0.0, floor_impulse + floor_restitution * floor_speed - state[uz])
            state[uz] += new_impulse - floor_impulse
            change, floor_impulse = change + abs(new_impulse - floor_impulse), new_impulse
        if wall_speed > 0.0:
            new_impulse = max(0.0, wall_impulse + wall_restitution * wall_speed - state[uy])
            state[uy] += new_impulse - wall_impulse
            change, wall_impulse = change + abs(new_impulse - wall_impulse), new_impulse
        if floor_speed > 0.0:
            limit = cell.friction_kinetic * floor_impulse
            new_1, new_2 = update_floor_friction(step.rolling, state, floor_x, floor_y, limit)
            change += abs(new_1 - floor_x) + abs(new_2 - floor_y)
            floor_x, floor_y = new_1, new_2
        if wall_speed > 0.0:
            limit = cell.wall_friction * wall_impulse
            new_1, new_2, sticks = stopping_impulse(
                state[ux] - wall_x, state[uz] - wall_z, limit, 1.0
            )
            change += abs(new_1 - wall_x) + abs(new_2 - wall_z)
            state[ux] = 0.0 if sticks else state[ux] + new_1 - wall_x
            state[uz] = 0.0 if sticks else state[uz] + new_2 - wall_z
            wall_x, wall_z = new_1, new_2
        if change <= tolerance or not (floor_speed > 0.0 and wall_speed > 0.0):
            break
    if floor_speed > 0.0 and (floor_restitution == 0.0 or state[uz] < 0.0):
        state[uz] = 0.0
    if wall_speed > 0.0 and (wall_restitution == 0.0 or state[uy] < 0.0):
        state[uy] = 0.0


@borrowing
def update_floor_friction(
    rolling: float, state: Floats, floor_x: float, floor_y: float, limit: float
) -> tuple[float, float]:
    """Replace the friction impulse of the floor in `state` by the present one; return it."""
    ux, uy, spin, response = STATE.ux, STATE.uy, STATE.spin, 1.0 + rolling
    slip_1, slip_2 = state[ux] - floor_x, state[uy] + state[spin] - response * floor_y
    new_1, new_2, sticks = stopping_impulse(slip_1, slip_2, limit, response)
    state[ux] = 0.0 if sticks else state[ux] + new_1 - floor_x
    state[uy] += new_2 - floor_y
    if rolling > 0.0:
        state[spin] = -state[uy] if sticks else state[spin] + rolling * (new_2 - floor_y)
    elif sticks:
        state[uy] = 0.0
    return new_1, new_2


@borrowing
def stopping_impulse(
    slip_1: float, slip_2: float, limit: float, response: float
) -> tuple[float, float, bool]:
    """Return the friction impulse on a slip (two components), and True if it stops the slip."""
    if slip_1 == 0.0 and slip_2 == 0.0:
        return 0.0, 0.0, limit > 0.0
    return friction_impulse(slip_1, slip_2, limit, limit, response)


@borrowing
def acceleration_across(cell: Cell, state: Floats, work: Work) -> float:
    """Return the acceleration across of a part without contacts, D_y - kappa V^2, in g.

    V = u_x + v_track is the speed in space along a curve of curvature number kappa (theory 13.1).
    """
    speed = state[STATE.ux] + work[ROW.track, 0]
    return work[ROW.free + 1, 0] - cell.curvature_number * speed * speed


@borrowing
def apply_impact(
    step: StepSettings, cell: Cell, state: Floats, push_across: float, work: Work
) -> None:
    """Change the velocities in `state` by the impact of a part on the floor, the wall or both."""
    y, z, uy, uz = STATE.y, STATE.z, STATE.uy, STATE.uz
    floor_speed = -state[uz] if state[z] == 0.0 and state[uz] < 0.0 else 0.0
    wall_speed = -state[uy] if step.wall and state[y] == 0.0 and state[uy] < 0.0 else 0.0
    floor_restitution, wall_restitution = cell.restitution, cell.wall_restitution
    if floor_speed > 0.0:
        to_next_event = min(step.to_lift_off, step.to_jump, 1.0)
        floor_restitution = rebound(
            floor_speed, -work[ROW.free + 2, 0], floor_restitution, to_next_event
        )
    if wall_speed > 0.0:
        wall_restitution = rebound(
            wall_speed, -push_across, wall_restitution, min(step.to_jump, 1.0)
        )
    solve_impacts(step, cell, state, floor_speed, wall_speed, floor_restitution, wall_restitution)


@borrowing
def change_contacts(step: StepSettings, cell: Cell, state: Floats, hold: Flags, work: Work) -> None:
    """Change the velocities and contacts of a part as the last event, in `hold`, demands."""
    event, row_across, row_normal = hold[HOLD.event], ROW.free + 1, ROW.free + 2
    y, z, uy, uz = STATE.y, STATE.z, STATE.uy, STATE.uz
    push_across = acceleration_across(cell, state, work)
    if event in (EVENT.land, EVENT.bump):
        apply_impact(step, cell, state, push_across, work)
    elif event == EVENT.lift:
        work[row_normal, 0] = 0.0
    elif event == EVENT.leave:
        work[row_across, 0] -= push_across  # no force across is left
    push_across = 0.0 if event == EVENT.leave else acceleration_across(cell, state, work)
    on_floor = state[z] == 0.0 and state[uz] == 0.0 and event != EVENT.lift
    on_floor = on_floor and (work[row_normal, 0] < 0.0 or event == EVENT.seat)
    at_wall = step.wall and state[y] == 0.0 and state[uy] == 0.0
    at_wall = at_wall and event not in (EVENT.leave, EVENT.release)
    at_wall = at_wall and (push_across < 0.0 or event == EVENT.press)
    hold[HOLD.contacts] = (FLOOR if on_floor else FREE) | (WALL if at_wall else FREE)


@borrowing
def begin_slip(step: StepSettings, cell: Cell, state: Floats, hold: Flags, work: Work) -> Begin:
    """Return the slip of a part at the start of a step, after deciding if its contacts stick.

    They stick if |(D_1, D_2/r)| <= mu_s L, with the acceleration D without friction, the load L and
    the response r; a slip in direction e changes at the rate D.e - mu_k L (e_1^2 + r e_2^2). A slip
    of at most two tolerances counts as 0 (theory 13.13).
    """
    contacts, event = hold[HOLD.contacts], hold[HOLD.event]
    ux, uy, uz, spin = STATE.ux, STATE.uy, STATE.uz, STATE.spin
    across = 0.0 if event == EVENT.leave else acceleration_across(cell, state, work)
    normal = work[ROW.free + 2, 0]
    static, kinetic, wall = cell.friction_static, cell.friction_kinetic, cell.wall_friction
    response, push_1, push_2 = 1.0, work[ROW.free, 0], 0.0
    slip_1, slip_2 = state[ux], 0.0
    if contacts == BOTH:
        static_limit, friction = -static * normal - wall * across, -kinetic * normal - wall * across
    elif contacts == FLOOR:
        response, push_2 = 1.0 + step.rolling, across
        slip_2 = state[uy] + state[spin]
        static_limit, friction = -static * normal, -kinetic * normal
    else:
        slip_2, push_2 = state[uz], normal
        static_limit = friction = -wall * across
    size = math.hypot(slip_1, slip_2)
    needed = math.hypot(push_1, push_2 / response)
    if event == EVENT.stop or size <= GONE * step.tolerance:
        stop_slip(step, state, contacts, slip_2)
        size = 0.0
    hold[HOLD.slips] = 1
    free_of_friction = friction == 0.0 and static_limit == 0.0
    if free_of_friction or (contacts == BOTH and size > 0.0):
        return Begin(size, math.copysign(1.0, slip_1), 0.0, 0.0, False, False, 0.0)
    if size > 0.0:
        cosine, sine = slip_1 / size, slip_2 / size
        rate = (
            friction * (cosine * cosine + response * sine * sine) - push_1 * cosine - push_2 * sine
        )
        closes, least = can_stop_straight(
            step.tolerance, size, rate, friction, needed, push.drive_speed(work)
        )
        return Begin(size, cosine, sine, rate, False, closes, least)
    takes_over = event in (EVENT.press, EVENT.release, EVENT.seat, EVENT.lift)
    if takes_over or (event != EVENT.slip and needed <= static_limit):
        hold[HOLD.slips] = 0
        return Begin(0.0, 0.0, 0.0, 0.0, False, False, 0.0)
    if contacts == BOTH:
        cosine, sine = math.copysign(1.0, push_1), 0.0
        rate = max(0.0, needed - friction)
    else:
        cosine, sine = slip_direction(push_1, push_2, friction, response)
        rate = push_1 * cosine + push_2 * sine
        rate -= friction * (cosine * cosine + response * sine * sine)
    if event == EVENT.slip and (contacts == WALL or static == kinetic):
        rate = 0.0  # no force is left over
    return Begin(0.0, cosine, sine, max(0.0, rate), True, False, 0.0)


@borrowing
def can_stop_straight(
    tolerance: float, size: float, rate: float, friction: float, needed: float, drive_speed: float
) -> tuple[bool, float]:
    """Return True if a slip may be followed straight to its stop, and the size to look at it again.

    True if r^2 <= 3 tol s, with its speed r and the rest of friction s = rub - need, and r (1 +
    rub) speed <= s^2; else it may turn along the push first (theory 13.13).
    """
    if not (rate > 0.0 and needed <= friction):
        return False, tolerance
    slack = friction - needed
    largest_size = math.sqrt(NEAR_STOP * tolerance * slack)
    if size > largest_size:
        return False, max(tolerance, 0.9 * largest_size)
    return size * (1.0 + friction) * drive_speed <= slack * slack, tolerance


@borrowing
def stop_slip(step: StepSettings, state: Floats, contacts: int, slip_2: float) -> None:
    """Set the slip in `state` to exactly 0, where it has come to 0 within rounding."""
    state[STATE.ux] = 0.0
    if contacts == WALL:
        state[STATE.uz] = 0.0
    elif step.rolling > 0.0:
        state[STATE.uy] -= slip_2 / (1.0 + step.rolling)
        state[STATE.spin] = -state[STATE.uy]
    else:
        state[STATE.uy] = 0.0


@borrowing
def slip_direction(
    push_1: float, push_2: float, kinetic_impulse: float, response: float
) -> tuple[float, float]:
    """Return the direction (cosine, sine) in which a contact begins to slip; (1, 0) without push.

    e = (D_1/(z + q), D_2/(z + r q)), with the z that makes e a unit vector.
    """
    if kinetic_impulse > 0.0 and response != 1.0:
        friction_1, friction_2, _ = friction_impulse(push_1, push_2, 0.0, kinetic_impulse, response)
        push_1, push_2 = -friction_1, -friction_2
    size = math.hypot(push_1, push_2)
    return (push_1 / size, push_2 / size) if size > 0.0 else (1.0, 0.0)
