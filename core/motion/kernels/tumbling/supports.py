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
def accelerations(
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
    sine, cosine = corner_at(cell, support, pitch)
    pitch_acceleration = (
        -cell.inertia_ratio * (normal * cosine + friction * sine) / cell.half_diagonal
    )
    return along + friction, pitch_acceleration, abs(friction * slip) if sigma != 0 else 0.0


@compiled
def fly(cell: Cell, state: Floats, time: float, step: float, after: Floats) -> None:
    """Set `after` to the state after free flight for `step` seconds from `time`, in closed form."""
    drive_velocity = drive_distance = 0.0  # integrals of the swing of the drive
    frequency = cell.circular_frequency
    if frequency > 0.0:
        swept_phase, start_phase = frequency * step, frequency * time + cell.start_phase
        sine_of_half = math.sin(swept_phase / 2)
        drive_velocity = 2.0 * math.sin(start_phase + swept_phase / 2) * sine_of_half / frequency
        drive_distance = (
            math.cos(start_phase) * (swept_phase - math.sin(swept_phase))
            + 2.0 * math.sin(start_phase) * sine_of_half * sine_of_half
        )
        drive_distance /= frequency * frequency
    after[:] = state
    after[STATE.along] += step * state[STATE.along_rate] - cell.pull_along * step * step / 2
    after[STATE.up] += step * state[STATE.up_rate] - cell.pull_normal * step * step / 2
    after[STATE.along] += cell.drive_along * drive_distance
    after[STATE.up] += cell.drive_normal * drive_distance
    after[STATE.pitch] += step * state[STATE.pitch_rate]
    after[STATE.along_rate] += cell.drive_along * drive_velocity - cell.pull_along * step
    after[STATE.up_rate] += cell.drive_normal * drive_velocity - cell.pull_normal * step


@compiled
def place_on_support(cell: Cell, state: Floats, support: int, sigma: int) -> None:
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
        sine, cosine = corner_at(cell, support, state[STATE.pitch])
        turning_speed = cell.half_diagonal * state[STATE.pitch_rate]
        state[STATE.up], state[STATE.up_rate] = cell.half_diagonal * sine, turning_speed * cosine
        if sigma == 0:
            state[STATE.along_rate] = turning_speed * sine


@compiled
def step_on_support(
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
    along, along_rate, lost = state[STATE.along], state[STATE.along_rate], state[STATE.lost]
    pitch, pitch_rate = state[STATE.pitch], state[STATE.pitch_rate]
    _, cosine_before = corner_at(cell, corner, pitch)
    rho = cell.half_diagonal
    along_sum = rate_sum = pitch_sum = pitch_rate_sum = lost_sum = 0.0
    stage_rate, stage_pitch, stage_pitch_rate = along_rate, pitch, pitch_rate
    for stage in range(4):
        sine, _ = corner_at(cell, corner, stage_pitch)
        slip = stage_rate - rho * stage_pitch_rate * sine
        time_fraction = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
        weight = step / 6 if stage in (0, 3) else step / 3
        acceleration, pitch_acceleration, power = accelerations(
            cell, support, sigma, time + time_fraction * step, stage_pitch, stage_pitch_rate, slip
        )
        along_sum += weight * stage_rate
        rate_sum += weight * acceleration
        pitch_sum += weight * stage_pitch_rate
        pitch_rate_sum += weight * pitch_acceleration
        lost_sum += weight * power
        next_span = step if stage == 2 else step / 2
        stage_rate, stage_pitch, stage_pitch_rate = (
            along_rate + next_span * acceleration,
            pitch + next_span * stage_pitch_rate,
            pitch_rate + next_span * pitch_acceleration,
        )
    after[STATE.along], after[STATE.along_rate] = along + along_sum, along_rate + rate_sum
    after[STATE.pitch], after[STATE.pitch_rate] = pitch + pitch_sum, pitch_rate + pitch_rate_sum
    after[STATE.lost] = lost + lost_sum
    place_on_support(cell, after, support, sigma)
    if support >= 0 and sigma == 0 and cell.turning != 0.0:
        _, cosine = corner_at(cell, corner, after[STATE.pitch])
        after[STATE.along] = along + rho * (cosine_before - cosine)


@compiled
def delassus(cell: Cell, s: float, c: float) -> tuple[float, float, float]:
    """Return the Delassus numbers G_nn, G_nt, G_tt of a corner: its velocity per impulse and mass.

    1 + kappa cos^2 s, kappa sin s cos s and 1 + kappa sin^2 s (theory 1.3).
    """
    kappa = cell.inertia_ratio
    return 1.0 + kappa * c * c, kappa * s * c, 1.0 + kappa * s * s


@compiled
def apply_impulse(
    cell: Cell, state: Floats, sine: float, cosine: float, normal: float, tangential: float
) -> None:
    """Change the velocities in `state` of a tumbling part by an impulse per mass at one corner.

    x' + i_t, y' + i_n and xi' - kappa (i_n cos s + i_t sin s)/rho, in m/s (theory 2.2).
    """
    state[STATE.along_rate] += tangential
    state[STATE.up_rate] += normal
    state[STATE.pitch_rate] -= (
        cell.inertia_ratio * (normal * cosine + tangential * sine) / cell.half_diagonal
    )


@compiled
def stopping_impulse(
    G_nn: float, G_nt: float, G_tt: float, u_n: float, u_t: float, friction: float
) -> tuple[float, float]:
    """Return the impulse per mass that stops the approach of a corner, with Coulomb friction.

    i_n = (-u_n - G_nt i_t)/G_nn, with the i_t that stops the slip, u_t + G_nt i_n + G_tt i_t = 0,
    if |i_t| <= mu i_n; else with i_t at that limit (theory 5.3).
    """
    stopping_normal = -u_n / G_nn
    coupling = G_nt / G_nn
    tangential = -(u_t + G_nt * stopping_normal) / (G_tt - G_nt * coupling)
    cone_forward, cone_backward = 1.0 - friction * coupling, 1.0 + friction * coupling
    lowest = -friction * stopping_normal / cone_forward if cone_forward > 0.0 else -np.inf
    highest = friction * stopping_normal / cone_backward if cone_backward > 0.0 else np.inf
    if lowest <= tangential <= highest:
        return max(stopping_normal - coupling * tangential, 0.0), tangential
    tangential = lowest if tangential < lowest else highest
    # In sliding the cone gives the normal impulse; the line would lose digits.
    normal = abs(tangential) / friction if friction > 0.0 else stopping_normal
    return normal, tangential


@compiled
def compress(
    cell: Cell, state: Floats, right: int, left: int, after: Floats
) -> tuple[float, float, float]:
    """Set `after` to the state in which no touching corner approaches; return the impulses for it.

    Normal impulses per mass at the right and left corner (-1 for none), and that of friction, in
    m/s (theory 5.3). On a side both corners slide alike, so that friction is one force.
    """
    rho, kappa, friction_kinetic = cell.half_diagonal, cell.inertia_ratio, cell.friction_kinetic
    copy(state, after)
    rate_right = gap_rate_of(cell, state, right)
    sine_right, cosine_right = corner_at(cell, right, state[STATE.pitch])
    slack = 1e-12 * (abs(rate_right) + rho * abs(state[STATE.pitch_rate]))
    if left >= 0:
        sine_left, cosine_left = corner_at(cell, left, state[STATE.pitch])
        rate_left = gap_rate_of(cell, state, left)
        slack += 1e-12 * abs(rate_left)
        half_length, height = rho * (cosine_right - cosine_left) / 2, rho * sine_right
        turning_to_stop = (rate_left - rate_right) / (2.0 * half_length)
        normal_sum = -(rate_left + rate_right) / 2
        if normal_sum > 0.0:
            # Both at rest: no pitch rate and no rise remain.
            sticking = -(slip_of(cell, state, right) + height * turning_to_stop)
            friction = min(
                max(sticking, -friction_kinetic * normal_sum), friction_kinetic * normal_sum
            )
            tilt = (turning_to_stop * rho * rho / kappa - height * friction) / half_length
            if abs(tilt) <= normal_sum:
                apply_impulse(
                    cell, after, sine_right, cosine_right, (normal_sum + tilt) / 2, friction
                )
                apply_impulse(cell, after, sine_left, cosine_left, (normal_sum - tilt) / 2, 0.0)
                return (normal_sum + tilt) / 2, (normal_sum - tilt) / 2, friction
        # One of them alone, if the other does not approach then.
        if rate_left < 0.0:
            G_nn, G_nt, G_tt = delassus(cell, sine_left, cosine_left)
            normal, friction = stopping_impulse(
                G_nn, G_nt, G_tt, rate_left, slip_of(cell, state, left), friction_kinetic
            )
            apply_impulse(cell, after, sine_left, cosine_left, normal, friction)
            if gap_rate_of(cell, after, right) >= -slack or rate_right >= 0.0:
                return 0.0, normal, friction
            copy(state, after)
    if rate_right >= 0.0:
        return 0.0, 0.0, 0.0
    G_nn, G_nt, G_tt = delassus(cell, sine_right, cosine_right)
    normal, friction = stopping_impulse(
        G_nn, G_nt, G_tt, rate_right, slip_of(cell, state, right), friction_kinetic
    )
    apply_impulse(cell, after, sine_right, cosine_right, normal, friction)
    return normal, 0.0, friction


@compiled
def apply_impact(cell: Cell, state: Floats, after: Floats) -> bool:
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
        _, cosine_right = corner_at(cell, right, state[STATE.pitch])
        _, cosine_left = corner_at(cell, left, state[STATE.pitch])
        if cosine_right < cosine_left:
            right, left = left, right
    energy_before = kinetic(cell, state)
    restitution = cell.restitution
    impulse_right, impulse_left, _ = compress(cell, state, right, left, after)
    copy(after, state)
    sine, cosine = corner_at(cell, right, state[STATE.pitch])
    apply_impulse(cell, state, sine, cosine, restitution * impulse_right, 0.0)
    sliding_corner = right
    if left >= 0:
        sine_left, cosine_left = corner_at(cell, left, state[STATE.pitch])
        apply_impulse(cell, state, sine_left, cosine_left, restitution * impulse_left, 0.0)
        if impulse_right == 0.0:
            sliding_corner, sine, cosine = left, sine_left, cosine_left
    limit = cell.friction_kinetic * restitution * (impulse_right + impulse_left)
    _, _, G_tt = delassus(cell, sine, cosine)
    sticking = -slip_of(cell, state, sliding_corner) / G_tt
    apply_impulse(cell, state, sine, cosine, 0.0, min(max(sticking, -limit), limit))
    for _ in range(20):
        slowest = gap_rate_of(cell, state, right)
        if left >= 0:
            slowest = min(slowest, gap_rate_of(cell, state, left))
        if slowest >= -slow:
            break
        compress(cell, state, right, left, after)
        copy(after, state)
    state[STATE.lost] += energy_before - kinetic(cell, state)
    return True


@compiled
def support_fits(cell: Cell, support: int, sigma: int, state: Floats, time: float) -> bool:
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
        sine, cosine = corner_at(cell, support, state[STATE.pitch])
        if sigma != 0 and response_of(cell, sine, cosine, sigma) <= 0.0:
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
    sine, cosine = corner_at(cell, corner, state[STATE.pitch])
    G_nn, G_nt, G_tt = delassus(cell, sine, cosine)
    u_n = gap_rate_of(cell, state, corner)
    if slip_too:
        u_t = slip_of(cell, state, corner)
        determinant = 1.0 + cell.inertia_ratio
        normal, tangential = (G_nt * u_t - G_tt * u_n), (G_nt * u_n - G_nn * u_t)
        apply_impulse(cell, state, sine, cosine, normal / determinant, tangential / determinant)
    else:
        apply_impulse(cell, state, sine, cosine, -u_n / G_nn, 0.0)


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
    comes_to_rest = abs(slip) <= slow and cell.friction_static > 0.0
    if comes_to_rest:
        stop_corner(cell, state, corner, True)
    place_on_support(cell, state, corner, 1)
    sine, cosine = corner_at(cell, corner, state[STATE.pitch])
    chi, along = free_corner(cell, time, sine, cosine, state[STATE.pitch_rate])
    if comes_to_rest:
        normal, friction = holding_force(cell, sine, cosine, chi, along)
        if normal >= 0.0 and abs(friction) <= cell.friction_static * normal:
            return corner, 0
        if chi > 0.0:
            return FREE, 0
        sigma = -1 if friction > 0.0 else 1
    else:
        sigma = 1 if slip > 0.0 else -1
    if response_of(cell, sine, cosine, sigma) <= 0.0:
        return PARADOX, 0
    if chi > 0.0:
        return FREE, 0
    return corner, sigma


@compiled
def choose_support(cell: Cell, state: Floats, time: float) -> tuple[int, int]:
    """Return the support of a tumbling part and its slip direction after an event.

    Corners that touch and neither approach nor leave take part, and the laws of contact decide by
    the accelerations: for two corners a side that may tip over one of them (theory 2.3, 2.4).
    """
    touch, slow = TOUCH * cell.half_diagonal, SLOW * speed_scale(cell)
    first = second = -1
    for corner in range(corner_count(cell)):
        touches = gap_of(cell, state, corner) <= touch
        if touches and abs(gap_rate_of(cell, state, corner)) <= slow:
            if first < 0:
                first = corner
            elif second < 0:
                second = corner
    if first < 0:
        return FREE, 0
    energy_before = kinetic(cell, state)
    sigma = 0
    if second >= 0:
        place_on_support(cell, state, FLAT, 1)
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
    place_on_support(cell, state, support, sigma)
    state[STATE.lost] += energy_before - kinetic(cell, state)
    return support, sigma


@compiled
def rests_for_ever(cell: Cell, support: int, sigma: int, state: Floats) -> bool:
    """True if the part is at rest and no phase of the drive can move it.

    g_y >= |P_y| and, with m = min(mu_s, half/height), m (g_y - P_y sin) >= |g_x - P_x sin| at both
    ends of the swing: neither slip nor tipping to either side.
    """
    if sigma != 0:
        return False
    pull_normal, drive_normal = cell.pull_normal, cell.drive_normal
    if support >= 0 and cell.turning == 0.0:
        turning_speed = cell.half_diagonal * abs(state[STATE.pitch_rate])
        at_rest = turning_speed <= SLOW * speed_scale(cell)
        return (
            at_rest
            and cell.pull_along == 0.0
            and cell.drive_along == 0.0
            and pull_normal >= abs(drive_normal)
        )
    if support != FLAT or pull_normal < abs(drive_normal):
        return False
    half_length, height = side_shape(cell, side_below(state[STATE.pitch]))
    # Neither slip nor tipping to either side: share * normal +- friction >= 0 at every phase.
    least_ratio = min(cell.friction_static, half_length / height)
    pull_along, drive_along = cell.pull_along, cell.drive_along
    uphill = least_ratio * pull_normal - pull_along >= abs(least_ratio * drive_normal - drive_along)
    return uphill and least_ratio * pull_normal + pull_along >= abs(
        least_ratio * drive_normal + drive_along
    )
