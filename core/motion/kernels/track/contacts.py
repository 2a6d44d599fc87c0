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
    slip_1: float, slip_2: float, hold: float, slide: float, response: float
) -> tuple[float, float, bool]:
    """Return the friction impulse (two components) at one contact, and True if it sticks.

    Per mass, in g/w; a unit impulse changes the slip by 1 and by r = `response`. It sticks if an
    impulse of at most `hold` can stop it; else the impulse is -q e, with q = `slide` and e =
    (s_1/(z + q), s_2/(z + r q)) along the slip that is left, where |e| = 1 gives z: the secular
    equation of theory 7.3.
    """
    stop_2 = slip_2 / response
    if slip_1 * slip_1 + stop_2 * stop_2 <= hold * hold:
        return -slip_1, -stop_2, True
    left = math.hypot(slip_1, slip_2)
    if response == 1.0:
        return -slide * slip_1 / left, -slide * slip_2 / left, False
    # Newton on 1/|e(z)| = 1, concave: from below the root it rises and cannot overshoot.
    z = max(0.0, abs(slip_1) - slide, abs(slip_2) - response * slide, left - response * slide)
    e_1, e_2 = 0.0, 0.0
    for _ in range(MAX_NEWTON):
        e_1 = slip_1 / (z + slide)
        e_2 = slip_2 / (z + response * slide)
        square = e_1 * e_1 + e_2 * e_2
        slope = e_1 * e_1 / (z + slide) + e_2 * e_2 / (z + response * slide)
        step = square * (math.sqrt(square) - 1.0) / slope
        z += step
        if not step > 1e-14 * left:
            break
    size = math.hypot(e_1, e_2)
    return -slide * e_1 / size, -slide * e_2 / size, False


@borrowing
def rebound(speed: float, load: float, restitution: float, ahead: float) -> float:
    """Return the restitution of an impact: `restitution`, or 0 if its hops are to be left out.

    The hops last T = 2 w/(L (1 - eps)), w = eps v, and are left out if w T < 1e-13 and T <
    `ahead`/1000, the phase to the next event. Their impulses add up to what the contact carries in
    their time, less w (theory 13.5).
    """
    if restitution >= 1.0 or not load > 0.0:
        return restitution
    after = restitution * speed
    left = 2.0 * after / (load * (1.0 - restitution))
    return 0.0 if after * left < SETTLED_EXACTLY and left < SETTLED_TIME * ahead else restitution


@borrowing
def strike(
    step: StepSettings,
    cell: Cell,
    state: Floats,
    floor: float,
    wall: float,
    bounce: float,
    rear: float,
) -> None:
    """Change the velocities in `state` by an impact on the floor, on the wall, or on both at once.

    `floor` and `wall` are the speeds of approach, 0 without an impact, `bounce` and `rear` their
    restitutions. Newton's law holds normal to each, u_n+ = -eps u_n-, and Coulomb's along it: an
    impulse of |i_t| <= mu i_n stops the slip if it can (theory 13.1). Two impacts at once are
    solved in turn until their impulses no longer change.
    """
    ux, uy, uz = STATE.ux, STATE.uy, STATE.uz
    normal, side, fx, fy, wx, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    small = STEADY * (floor + wall + abs(state[ux]))
    for _ in range(MAX_SWEEPS):
        change = 0.0
        if floor > 0.0:
            new = max(0.0, normal + bounce * floor - state[uz])
            state[uz] += new - normal
            change, normal = change + abs(new - normal), new
        if wall > 0.0:
            new = max(0.0, side + rear * wall - state[uy])
            state[uy] += new - side
            change, side = change + abs(new - side), new
        if floor > 0.0:
            limit = cell.friction_kinetic * normal
            new_1, new_2 = rub_floor(step.rolling, state, fx, fy, limit)
            change += abs(new_1 - fx) + abs(new_2 - fy)
            fx, fy = new_1, new_2
        if wall > 0.0:
            limit = cell.wall_friction * side
            new_1, new_2, held = impulse(state[ux] - wx, state[uz] - wz, limit, 1.0)
            change += abs(new_1 - wx) + abs(new_2 - wz)
            state[ux] = 0.0 if held else state[ux] + new_1 - wx
            state[uz] = 0.0 if held else state[uz] + new_2 - wz
            wx, wz = new_1, new_2
        if change <= small or not (floor > 0.0 and wall > 0.0):
            break
    if floor > 0.0 and (bounce == 0.0 or state[uz] < 0.0):
        state[uz] = 0.0
    if wall > 0.0 and (rear == 0.0 or state[uy] < 0.0):
        state[uy] = 0.0


@borrowing
def rub_floor(
    rolling: float, state: Floats, fx: float, fy: float, limit: float
) -> tuple[float, float]:
    """Replace the friction impulse of the floor in `state` by the present one; return it."""
    ux, uy, spin, response = STATE.ux, STATE.uy, STATE.spin, 1.0 + rolling
    slip_1, slip_2 = state[ux] - fx, state[uy] + state[spin] - response * fy
    new_1, new_2, held = impulse(slip_1, slip_2, limit, response)
    state[ux] = 0.0 if held else state[ux] + new_1 - fx
    state[uy] += new_2 - fy
    if rolling > 0.0:
        state[spin] = -state[uy] if held else state[spin] + rolling * (new_2 - fy)
    elif held:
        state[uy] = 0.0
    return new_1, new_2


@borrowing
def impulse(
    slip_1: float, slip_2: float, limit: float, response: float
) -> tuple[float, float, bool]:
    """Return the friction impulse on a slip (two components), and True if it stops the slip."""
    if slip_1 == 0.0 and slip_2 == 0.0:
        return 0.0, 0.0, limit > 0.0
    return friction_impulse(slip_1, slip_2, limit, limit, response)


@borrowing
def pushed_across(cell: Cell, state: Floats, work: Work) -> float:
    """Return the acceleration across of a part without contacts, D_y - kappa V^2, in g.

    V = u_x + v_track is the speed in space along a curve of curvature number kappa (theory 13.1).
    """
    speed = state[STATE.ux] + work[ROW.track, 0]
    return work[ROW.free + 1, 0] - cell.curvature_number * speed * speed


@borrowing
def hit(step: StepSettings, cell: Cell, state: Floats, bent: float, work: Work) -> None:
    """Change the velocities in `state` by the impact of a part on the floor, the wall or both."""
    y, z, uy, uz = STATE.y, STATE.z, STATE.uy, STATE.uz
    floor = -state[uz] if state[z] == 0.0 and state[uz] < 0.0 else 0.0
    wall = -state[uy] if step.wall and state[y] == 0.0 and state[uy] < 0.0 else 0.0
    bounce, rear = cell.restitution, cell.wall_restitution
    if floor > 0.0:
        ahead = min(step.lift, step.even, 1.0)
        bounce = rebound(floor, -work[ROW.free + 2, 0], bounce, ahead)
    if wall > 0.0:
        rear = rebound(wall, -bent, rear, min(step.even, 1.0))
    strike(step, cell, state, floor, wall, bounce, rear)


@borrowing
def change_contacts(step: StepSettings, cell: Cell, state: Floats, hold: Flags, work: Work) -> None:
    """Change the velocities and contacts of a part as the last event, in `hold`, demands."""
    event, across, normal = hold[HOLD.event], ROW.free + 1, ROW.free + 2
    y, z, uy, uz = STATE.y, STATE.z, STATE.uy, STATE.uz
    bent = pushed_across(cell, state, work)
    if event in (EVENT.land, EVENT.bump):
        hit(step, cell, state, bent, work)
    elif event == EVENT.lift:
        work[normal, 0] = 0.0
    elif event == EVENT.leave:
        work[across, 0] -= bent  # no force across is left
    bent = 0.0 if event == EVENT.leave else pushed_across(cell, state, work)
    on_floor = state[z] == 0.0 and state[uz] == 0.0 and event != EVENT.lift
    on_floor = on_floor and (work[normal, 0] < 0.0 or event == EVENT.seat)
    at_wall = step.wall and state[y] == 0.0 and state[uy] == 0.0
    at_wall = at_wall and event not in (EVENT.leave, EVENT.release)
    at_wall = at_wall and (bent < 0.0 or event == EVENT.press)
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
    across = 0.0 if event == EVENT.leave else pushed_across(cell, state, work)
    normal = work[ROW.free + 2, 0]
    static, kinetic, wall = cell.friction_static, cell.friction_kinetic, cell.wall_friction
    response, push_1, push_2 = 1.0, work[ROW.free, 0], 0.0
    slip_1, slip_2 = state[ux], 0.0
    if contacts == BOTH:
        most, rub = -static * normal - wall * across, -kinetic * normal - wall * across
    elif contacts == FLOOR:
        response, push_2 = 1.0 + step.rolling, across
        slip_2 = state[uy] + state[spin]
        most, rub = -static * normal, -kinetic * normal
    else:
        slip_2, push_2 = state[uz], normal
        most = rub = -wall * across
    size = math.hypot(slip_1, slip_2)
    need = math.hypot(push_1, push_2 / response)
    if event == EVENT.stop or size <= GONE * step.tolerance:
        stop_slip(step, state, contacts, slip_2)
        size = 0.0
    hold[HOLD.slips] = 1
    free_of_friction = rub == 0.0 and most == 0.0
    if free_of_friction or (contacts == BOTH and size > 0.0):
        return Begin(size, math.copysign(1.0, slip_1), 0.0, 0.0, False, False, 0.0)
    if size > 0.0:
        cosine, sine = slip_1 / size, slip_2 / size
        rate = rub * (cosine * cosine + response * sine * sine) - push_1 * cosine - push_2 * sine
        closes, least = closing(step.tolerance, size, rate, rub, need, push.size(work))
        return Begin(size, cosine, sine, rate, False, closes, least)
    held_on = event in (EVENT.press, EVENT.release, EVENT.seat, EVENT.lift)
    if held_on or (event != EVENT.slip and need <= most):
        hold[HOLD.slips] = 0
        return Begin(0.0, 0.0, 0.0, 0.0, False, False, 0.0)
    if contacts == BOTH:
        cosine, sine = math.copysign(1.0, push_1), 0.0
        rate = max(0.0, need - rub)
    else:
        cosine, sine = direction(push_1, push_2, rub, response)
        rate = push_1 * cosine + push_2 * sine
        rate -= rub * (cosine * cosine + response * sine * sine)
    if event == EVENT.slip and (contacts == WALL or static == kinetic):
        rate = 0.0  # no force is left over
    return Begin(0.0, cosine, sine, max(0.0, rate), True, False, 0.0)


@borrowing
def closing(
    tolerance: float, size: float, rate: float, rub: float, need: float, speed: float
) -> tuple[bool, float]:
    """Return True if a slip may be followed straight to its stop, and the size to look at it again.

    True if r^2 <= 3 tol s, with its speed r and the rest of friction s = rub - need, and r (1 +
    rub) speed <= s^2; else it may turn along the push first (theory 13.13).
    """
    if not (rate > 0.0 and need <= rub):
        return False, tolerance
    slack = rub - need
    room = math.sqrt(NEAR_STOP * tolerance * slack)
    if size > room:
        return False, max(tolerance, 0.9 * room)
    return size * (1.0 + rub) * speed <= slack * slack, tolerance


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
def direction(push_1: float, push_2: float, slide: float, response: float) -> tuple[float, float]:
    """Return the direction (cosine, sine) in which a contact begins to slip; (1, 0) without push.

    e = (D_1/(z + q), D_2/(z + r q)), with the z that makes e a unit vector.
    """
    if slide > 0.0 and response != 1.0:
        friction_1, friction_2, _ = friction_impulse(push_1, push_2, 0.0, slide, response)
        push_1, push_2 = -friction_1, -friction_2
    size = math.hypot(push_1, push_2)
    return (push_1 / size, push_2 / size) if size > 0.0 else (1.0, 0.0)
