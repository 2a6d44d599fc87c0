"""The support of a tumbling part: a step on it, impacts, and the support after them."""

import math

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.inputs import Floats, copy
from vibrafeed.core.motion.kernels.tumbling.corners import (
    DEEP,
    FLAT,
    FREE,
    OVERLAP,
    PARADOX,
    SLOW,
    STATE,
    TOUCH,
    Cell,
    corner_at,
    corner_count,
    corner_force,
    flat_force,
    free_acceleration,
    free_corner,
    gap_of,
    gap_rate_of,
    holding_force,
    kinetic,
    response_of,
    side_below,
    side_forces,
    side_shape,
    slip_of,
    speed_scale,
)


@compiled
def rates(
    cell: Cell, support: int, sigma: int, time: float, pitch: float, pitch_rate: float, slip: float
) -> tuple[float, float, float]:
    """Return accelerations of a tumbling part along the plane (m/s^2) and in pitch, and lost power.

    x'' = a_x + t and xi'' = -kappa (n cos s + t sin s)/rho in rad/s^2 under the normal and friction
    forces n and t per mass of its support; friction takes |t slip| per mass (theory 2.2). `support`
    is a corner's number or `FLAT`, `sigma` the direction of slip, 0 if held.
    """
    along, _ = free_acceleration(cell, time)
    if support == FLAT:
        normal, friction = flat_force(cell, sigma, time)
        return along + friction, 0.0, abs(friction * slip) if sigma != 0 else 0.0
    normal, friction = corner_force(cell, support, sigma, time, pitch, pitch_rate)
    s, c = corner_at(cell, support, pitch)
    turn = -cell.inertia_ratio * (normal * c + friction * s) / cell.half_diagonal
    return along + friction, turn, abs(friction * slip) if sigma != 0 else 0.0


@compiled
def fly(cell: Cell, state: Floats, time: float, step: float, after: Floats) -> None:
    """Set `after` to the state after free flight for `step` seconds from `time`, in closed form."""
    gained = moved = 0.0  # integrals of the swing of the drive
    w = cell.circular_frequency
    if w > 0.0:
        turn, start = w * step, w * time + cell.start_phase
        half = math.sin(turn / 2)
        gained = 2.0 * math.sin(start + turn / 2) * half / w
        moved = math.cos(start) * (turn - math.sin(turn)) + 2.0 * math.sin(start) * half * half
        moved /= w * w
    after[:] = state
    after[STATE.along] += step * state[STATE.along_rate] - cell.pull_along * step * step / 2
    after[STATE.up] += step * state[STATE.up_rate] - cell.pull_normal * step * step / 2
    after[STATE.along] += cell.drive_along * moved
    after[STATE.up] += cell.drive_normal * moved
    after[STATE.pitch] += step * state[STATE.pitch_rate]
    after[STATE.along_rate] += cell.drive_along * gained - cell.pull_along * step
    after[STATE.up_rate] += cell.drive_normal * gained - cell.pull_normal * step


@compiled
def settle_on(cell: Cell, state: Floats, support: int, sigma: int) -> None:
    """Put a tumbling part exactly onto its support: gap and its rate 0, slip 0 if friction holds.

    y = rho sin s, y' = rho xi' cos s and x' = rho xi' sin s over a corner (theory 2.1).
    """
    if support == FLAT:
        quarter_turns = side_below(state[STATE.pitch])
        state[STATE.pitch] = quarter_turns * (math.pi / 2)
        _, state[STATE.up] = side_shape(cell, quarter_turns)
        state[STATE.up_rate] = state[STATE.pitch_rate] = 0.0
        if sigma == 0:
            state[STATE.along_rate] = 0.0
    elif support >= 0:
        s, c = corner_at(cell, support, state[STATE.pitch])
        turning = cell.half_diagonal * state[STATE.pitch_rate]
        state[STATE.up], state[STATE.up_rate] = cell.half_diagonal * s, turning * c
        if sigma == 0:
            state[STATE.along_rate] = turning * s


@compiled
def carry(
    cell: Cell, support: int, sigma: int, state: Floats, time: float, step: float, after: Floats
) -> None:
    """Set `after` to the state of a tumbling part after a step on one support, from `state`.

    By Runge-Kutta of order 4, in flight in closed form.
    """
    if support == FREE:
        fly(cell, state, time, step, after)
        return
    after[:] = state
    if support == FLAT and sigma == 0:
        return
    corner = max(support, 0)
    x, v, lost = state[STATE.along], state[STATE.along_rate], state[STATE.lost]
    p, q = state[STATE.pitch], state[STATE.pitch_rate]
    _, c_0 = corner_at(cell, corner, p)
    rho = cell.half_diagonal
    x_sum = v_sum = p_sum = q_sum = lost_sum = 0.0
    v_here, p_here, q_here = v, p, q
    for stage in range(4):
        s, _ = corner_at(cell, corner, p_here)
        slip = v_here - rho * q_here * s
        share = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
        weight = step / 6 if stage in (0, 3) else step / 3
        a, turn, power = rates(cell, support, sigma, time + share * step, p_here, q_here, slip)
        x_sum += weight * v_here
        v_sum += weight * a
        p_sum += weight * q_here
        q_sum += weight * turn
        lost_sum += weight * power
        reach = step if stage == 2 else step / 2
        v_here, p_here, q_here = v + reach * a, p + reach * q_here, q + reach * turn
    after[STATE.along], after[STATE.along_rate] = x + x_sum, v + v_sum
    after[STATE.pitch], after[STATE.pitch_rate] = p + p_sum, q + q_sum
    after[STATE.lost] = lost + lost_sum
    settle_on(cell, after, support, sigma)
    if support >= 0 and sigma == 0 and cell.turning != 0.0:
        _, c = corner_at(cell, corner, after[STATE.pitch])
        after[STATE.along] = x + rho * (c_0 - c)


@compiled
def delassus(cell: Cell, s: float, c: float) -> tuple[float, float, float]:
    """Return the Delassus numbers G_nn, G_nt, G_tt of a corner: its velocity per impulse and mass.

    1 + kappa cos^2 s, kappa sin s cos s and 1 + kappa sin^2 s (theory 1.3).
    """
    kappa = cell.inertia_ratio
    return 1.0 + kappa * c * c, kappa * s * c, 1.0 + kappa * s * s


@compiled
def push(cell: Cell, state: Floats, s: float, c: float, normal: float, tangential: float) -> None:
    """Change the velocities in `state` of a tumbling part by an impulse per mass at one corner.

    x' + i_t, y' + i_n and xi' - kappa (i_n cos s + i_t sin s)/rho, in m/s (theory 2.2).
    """
    state[STATE.along_rate] += tangential
    state[STATE.up_rate] += normal
    state[STATE.pitch_rate] -= (
        cell.inertia_ratio * (normal * c + tangential * s) / cell.half_diagonal
    )


@compiled
def arrest(
    nn: float, nt: float, tt: float, u_n: float, u_t: float, friction: float
) -> tuple[float, float]:
    """Return the impulse per mass that stops the approach of a corner, with Coulomb friction.

    i_n = (-u_n - G_nt i_t)/G_nn, with the i_t that stops the slip, u_t + G_nt i_n + G_tt i_t = 0,
    if |i_t| <= mu i_n; else with i_t at that limit (theory 5.3).
    """
    stop = -u_n / nn
    coupling = nt / nn
    tangential = -(u_t + nt * stop) / (tt - nt * coupling)
    forward, backward = 1.0 - friction * coupling, 1.0 + friction * coupling
    lowest = -friction * stop / forward if forward > 0.0 else -np.inf
    highest = friction * stop / backward if backward > 0.0 else np.inf
    if lowest <= tangential <= highest:
        return max(stop - coupling * tangential, 0.0), tangential
    tangential = lowest if tangential < lowest else highest
    # In sliding the cone gives the normal impulse; the line would lose digits.
    normal = abs(tangential) / friction if friction > 0.0 else stop
    return normal, tangential


@compiled
def compress(
    cell: Cell, state: Floats, right: int, left: int, after: Floats
) -> tuple[float, float, float]:
    """Set `after` to the state in which no touching corner approaches; return the impulses for it.

    Normal impulses per mass at the right and left corner (-1 for none), and that of friction, in
    m/s (theory 5.3). On a side both corners slide alike, so that friction is one force.
    """
    rho, kappa, mu = cell.half_diagonal, cell.inertia_ratio, cell.friction_kinetic
    copy(state, after)
    u_right = gap_rate_of(cell, state, right)
    s_r, c_r = corner_at(cell, right, state[STATE.pitch])
    slack = 1e-12 * (abs(u_right) + rho * abs(state[STATE.pitch_rate]))
    if left >= 0:
        s_l, c_l = corner_at(cell, left, state[STATE.pitch])
        u_left = gap_rate_of(cell, state, left)
        slack += 1e-12 * abs(u_left)
        half, height = rho * (c_r - c_l) / 2, rho * s_r
        spin = (u_left - u_right) / (2.0 * half)
        total = -(u_left + u_right) / 2
        if total > 0.0:
            # Both at rest: no pitch rate and no rise remain.
            wanted = -(slip_of(cell, state, right) + height * spin)
            friction = min(max(wanted, -mu * total), mu * total)
            tilt = (spin * rho * rho / kappa - height * friction) / half
            if abs(tilt) <= total:
                push(cell, after, s_r, c_r, (total + tilt) / 2, friction)
                push(cell, after, s_l, c_l, (total - tilt) / 2, 0.0)
                return (total + tilt) / 2, (total - tilt) / 2, friction
        # One of them alone, if the other does not approach then.
        if u_left < 0.0:
            nn, nt, tt = delassus(cell, s_l, c_l)
            normal, friction = arrest(nn, nt, tt, u_left, slip_of(cell, state, left), mu)
            push(cell, after, s_l, c_l, normal, friction)
            if gap_rate_of(cell, after, right) >= -slack or u_right >= 0.0:
                return 0.0, normal, friction
            copy(state, after)
    if u_right >= 0.0:
        return 0.0, 0.0, 0.0
    nn, nt, tt = delassus(cell, s_r, c_r)
    normal, friction = arrest(nn, nt, tt, u_right, slip_of(cell, state, right), mu)
    push(cell, after, s_r, c_r, normal, friction)
    return normal, 0.0, friction


@compiled
def strike(cell: Cell, state: Floats, after: Floats) -> bool:
    """Apply an impact of the touching corners of a part to its state; True if there was one.

    By the law of Pfeiffer and Glocker a compression first stops the approach, and an expansion
    follows with eps times the normal impulses, and friction that may stop the slip (theory 5.3).
    """
    touch, slow = TOUCH * cell.half_diagonal, SLOW * speed_scale(cell)
    right = left = -1
    approach = 0.0
    for corner in range(corner_count(cell)):
        gap = gap_of(cell, state, corner)
        if gap <= touch:
            approach = min(approach, gap_rate_of(cell, state, corner))
            if right < 0:
                right = corner
            elif left < 0:
                left = corner
    if approach >= -slow:
        return False
    if left >= 0:
        _, c_r = corner_at(cell, right, state[STATE.pitch])
        _, c_l = corner_at(cell, left, state[STATE.pitch])
        if c_r < c_l:
            right, left = left, right
    before = kinetic(cell, state)
    eps = cell.restitution
    first, second, _ = compress(cell, state, right, left, after)
    copy(after, state)
    s, c = corner_at(cell, right, state[STATE.pitch])
    push(cell, state, s, c, eps * first, 0.0)
    rate = right
    if left >= 0:
        s_l, c_l = corner_at(cell, left, state[STATE.pitch])
        push(cell, state, s_l, c_l, eps * second, 0.0)
        if first == 0.0:
            rate, s, c = left, s_l, c_l
    limit = cell.friction_kinetic * eps * (first + second)
    _, _, tt = delassus(cell, s, c)
    wanted = -slip_of(cell, state, rate) / tt
    push(cell, state, s, c, 0.0, min(max(wanted, -limit), limit))
    for _ in range(20):
        least = gap_rate_of(cell, state, right)
        if left >= 0:
            least = min(least, gap_rate_of(cell, state, left))
        if least >= -slow:
            break
        compress(cell, state, right, left, after)
        copy(after, state)
    state[STATE.lost] += before - kinetic(cell, state)
    return True


@compiled
def holds(cell: Cell, support: int, sigma: int, state: Floats, time: float) -> bool:
    """True if the state of a tumbling part still fits its support and direction of slip.

    No other corner is in the plane, the normal force n is >= 0, |t| <= mu_s n if the support is
    held (`sigma` 0), and sigma g_T' >= 0 and m tau > 0 if it slips (theory 2.3, 2.4).
    """
    overlap, deep = OVERLAP * cell.half_diagonal, DEEP * cell.half_diagonal
    if support == FLAT:
        normal, friction = flat_force(cell, sigma, time)
        right, left = side_forces(cell, side_below(state[STATE.pitch]), normal, friction)
        if normal < 0.0 or right < 0.0 or left < 0.0:
            return False
        slip = state[STATE.along_rate]
    else:
        for corner in range(corner_count(cell)):
            gap = gap_of(cell, state, corner)
            # A corner that has just been struck may rise from a rounding below the plane.
            falls = gap < -deep or gap_rate_of(cell, state, corner) < 0.0
            if corner != support and gap < -overlap and falls:
                return False
        if support == FREE:
            return True
        s, c = corner_at(cell, support, state[STATE.pitch])
        if sigma != 0 and response_of(cell, s, c, sigma) <= 0.0:
            return False
        normal, friction = corner_force(
            cell, support, sigma, time, state[STATE.pitch], state[STATE.pitch_rate]
        )
        if normal < 0.0:
            return False
        slip = slip_of(cell, state, support)
    if sigma == 0:
        return abs(friction) <= cell.friction_static * normal
    if cell.friction_static == 0.0:
        return True
    return sigma * slip >= -1e-5 * SLOW * speed_scale(cell)


@compiled
def stop_corner(cell: Cell, state: Floats, corner: int, slip_too: bool) -> None:
    """Remove a small remaining velocity of a corner by an impulse, which cannot add energy."""
    s, c = corner_at(cell, corner, state[STATE.pitch])
    nn, nt, tt = delassus(cell, s, c)
    u_n = gap_rate_of(cell, state, corner)
    if slip_too:
        u_t = slip_of(cell, state, corner)
        determinant = 1.0 + cell.inertia_ratio
        normal, tangential = (nt * u_t - tt * u_n), (nt * u_n - nn * u_t)
        push(cell, state, s, c, normal / determinant, tangential / determinant)
    else:
        push(cell, state, s, c, -u_n / nn, 0.0)


@compiled
def choose_corner(cell: Cell, state: Floats, time: float, corner: int) -> tuple[int, int]:
    """Return support and slip direction of a part of which only the corner `corner` touches.

    (corner, 0) if the force that keeps it at rest fits friction, (`FREE`, 0) if it leaves by
    itself, (corner, 1 or -1) for a slip; `PARADOX` if m tau <= 0, where contact laws have no single
    solution (theory 2.3, 2.4).
    """
    slow = SLOW * speed_scale(cell)
    stop_corner(cell, state, corner, False)
    slip = slip_of(cell, state, corner)
    stops = abs(slip) <= slow and cell.friction_static > 0.0
    if stops:
        stop_corner(cell, state, corner, True)
    settle_on(cell, state, corner, 1)
    s, c = corner_at(cell, corner, state[STATE.pitch])
    chi, along = free_corner(cell, time, s, c, state[STATE.pitch_rate])
    if stops:
        normal, friction = holding_force(cell, s, c, chi, along)
        if normal >= 0.0 and abs(friction) <= cell.friction_static * normal:
            return corner, 0
        if chi > 0.0:
            return FREE, 0
        sigma = -1 if friction > 0.0 else 1
    else:
        sigma = 1 if slip > 0.0 else -1
    if response_of(cell, s, c, sigma) <= 0.0:
        return PARADOX, 0
    if chi > 0.0:
        return FREE, 0
    return corner, sigma


@compiled
def choose(cell: Cell, state: Floats, time: float) -> tuple[int, int]:
    """Return the support of a tumbling part and its slip direction after an event.

    Corners that touch and neither approach nor leave take part, and the laws of contact decide by
    the accelerations: for two corners a side that may tip over one of them (theory 2.3, 2.4).
    """
    touch, slow = TOUCH * cell.half_diagonal, SLOW * speed_scale(cell)
    first = second = -1
    for corner in range(corner_count(cell)):
        near = gap_of(cell, state, corner) <= touch
        if near and abs(gap_rate_of(cell, state, corner)) <= slow:
            if first < 0:
                first = corner
            elif second < 0:
                second = corner
    if first < 0:
        return FREE, 0
    before = kinetic(cell, state)
    sigma = 0
    if second >= 0:
        settle_on(cell, state, FLAT, 1)
        if abs(state[STATE.along_rate]) > slow:
            sigma = 1 if state[STATE.along_rate] > 0.0 else -1
        else:
            state[STATE.along_rate] = 0.0
        normal, friction = flat_force(cell, sigma, time)
        if sigma == 0 and abs(friction) > cell.friction_static * normal:
            sigma = -1 if friction > 0.0 else 1
            normal, friction = flat_force(cell, sigma, time)
        quarter_turns = side_below(state[STATE.pitch])
        right, left = side_forces(cell, quarter_turns, normal, friction)
        if normal < 0.0:
            support = FREE
        elif right >= 0.0 and left >= 0.0:
            support = FLAT
        else:  # it tips over the end that is pressed
            corner = (1 - quarter_turns) % 4 if right < 0.0 else -quarter_turns % 4
            support, sigma = choose_corner(cell, state, time, corner)
    else:
        support, sigma = choose_corner(cell, state, time, first)
    settle_on(cell, state, support, sigma)
    state[STATE.lost] += before - kinetic(cell, state)
    return support, sigma


@compiled
def rests_for_ever(cell: Cell, support: int, sigma: int, state: Floats) -> bool:
    """True if the part is at rest and no phase of the drive can move it.

    g_y >= |P_y| and, with m = min(mu_s, half/height), m (g_y - P_y sin) >= |g_x - P_x sin| at both
    ends of the swing: neither slip nor tipping to either side.
    """
    if sigma != 0:
        return False
    g, drive = cell.pull_normal, cell.drive_normal
    if support >= 0 and cell.turning == 0.0:
        turning = cell.half_diagonal * abs(state[STATE.pitch_rate])
        at_rest = turning <= SLOW * speed_scale(cell)
        return at_rest and cell.pull_along == 0.0 and cell.drive_along == 0.0 and g >= abs(drive)
    if support != FLAT or g < abs(drive):
        return False
    half, height = side_shape(cell, side_below(state[STATE.pitch]))
    # Neither slip nor tipping to either side: share * normal +- friction >= 0 at every phase.
    share = min(cell.friction_static, half / height)
    along, swing = cell.pull_along, cell.drive_along
    uphill = share * g - along >= abs(share * drive - swing)
    return uphill and share * g + along >= abs(share * drive + swing)
