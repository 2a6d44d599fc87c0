"""The kernels of `core.motion.tumbling`: one part that strikes and leaves a plane, compiled.

A corner i of the part lies at the angle a below the direction of transport, seen from the centre,
at the distance rho; the pitch counts clockwise and adds to a (theory 2.1). The functions take the
numbers of one cell and its state, an array that holds place, motion and the energy lost so far.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.motion.kernels.statuses import LIMIT_REACHED, MOVING, NO_SOLUTION, SETTLED

Array = NDArray[np.float64]

PFEIFFER_GLOCKER, MOREAU = 0, 1

ALONG, UP, PITCH, ALONG_RATE, UP_RATE, PITCH_RATE, LOST = range(7)
"""Places in the state: centre, pitch, their rates, energy per mass lost so far."""

STATE = 7
PATH_COLUMNS = 1 + STATE + 1 + 4
"""Time, state, lowest gap, and whether each corner carries the part."""

FREE, FLAT, PARADOX = -1, -2, -3
"""What carries the part, if it is not the corner of that number."""

OVERLAP = 4e-15
"""Overlap that counts as an impact, of the half diagonal: some roundings of a height."""
TOUCH = 1e-13
"""Gap that counts as touching, of the half diagonal."""
DEEP = 1e-12
"""Overlap that is more than a rounding, of the half diagonal."""
SLOW = 1e-6
"""Velocity that counts as none, of sqrt(acceleration times half diagonal).

A fall through `OVERLAP` ends at 0.09e-6 of it: with not much less, the rounding of a height would
keep a part bouncing for ever.
"""
EVENTS, EVENTS_A_STEP = 20_000, 20  # at most: so many, and so many more a step
MOST_STEPS, STEPS_MORE = 20_000_000, 50  # STEPS_MORE times as many where the part turns fast
MOST_SWEEPS = 500
HALVINGS = 60
TOP_HALVINGS = 40  # of the time of a hop's top: its height is then off by a rounding
LARGEST_TURN = 0.1  # rad a step: a corner that swings down and up again is not stepped over


class Cell(NamedTuple):
    """The numbers of one cell, SI; a row of the kernels' table in this order.

    `turning` is 1 for a part with corners, 0 for a ball, whose one contact stays below the centre.
    The pulls are gravity's components against the transport and towards the plane, the drives
    those of the drive's acceleration.
    """

    half_diagonal: float
    inertia_ratio: float
    corner_angle: float
    turning: float
    pull_along: float
    pull_normal: float
    drive_along: float
    drive_normal: float
    circular_frequency: float
    start_phase: float
    friction_kinetic: float
    friction_static: float
    restitution: float
    gap_normal: float
    pitch: float
    velocity_along: float
    velocity_upward: float
    pitch_rate: float
    duration: float
    time_step: float
    law: float


@compiled
def cell_of(row: Array) -> Cell:
    """Return the cell of a row."""
    return Cell(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10],
        row[11], row[12], row[13], row[14], row[15], row[16], row[17], row[18], row[19], row[20],
    )  # fmt: skip


# --- geometry


@compiled
def corner_count(cell: Cell) -> int:
    """Return the number of corners: 4, or 1 for a ball."""
    return 4 if cell.turning != 0.0 else 1


@compiled
def corner_at(cell: Cell, corner: int, pitch: float) -> tuple[float, float]:
    """Return sine and cosine of the angle of a corner below the direction of transport."""
    if cell.turning == 0.0:
        return 1.0, 0.0
    angle = pitch + cell.corner_angle
    if corner == 1:
        angle = pitch + math.pi - cell.corner_angle
    elif corner == 2:
        angle = pitch + math.pi + cell.corner_angle
    elif corner == 3:
        angle = pitch - cell.corner_angle
    return math.sin(angle), math.cos(angle)


@compiled
def gap_of(cell: Cell, state: Array, corner: int) -> float:
    """Return the height of a corner above the plane."""
    s, _ = corner_at(cell, corner, state[PITCH])
    return state[UP] - cell.half_diagonal * s


@compiled
def gap_rate_of(cell: Cell, state: Array, corner: int) -> float:
    """Return the velocity of a corner off the plane."""
    _, c = corner_at(cell, corner, state[PITCH])
    return state[UP_RATE] - cell.half_diagonal * state[PITCH_RATE] * c


@compiled
def slip_of(cell: Cell, state: Array, corner: int) -> float:
    """Return the velocity of a corner along the plane."""
    s, _ = corner_at(cell, corner, state[PITCH])
    return state[ALONG_RATE] - cell.half_diagonal * state[PITCH_RATE] * s


@compiled
def lowest_gap(cell: Cell, state: Array) -> float:
    """Return the gap of the lowest corner."""
    least = gap_of(cell, state, 0)
    for corner in range(1, corner_count(cell)):
        least = min(least, gap_of(cell, state, corner))
    return least


@compiled
def lowest_rate(cell: Cell, state: Array) -> float:
    """Return the velocity off the plane of the lowest corner."""
    lowest = 0
    for corner in range(1, corner_count(cell)):
        if gap_of(cell, state, corner) < gap_of(cell, state, lowest):
            lowest = corner
    return gap_rate_of(cell, state, lowest)


@compiled
def side_below(pitch: float) -> int:
    """Return the number of quarter turns to the pitch at which the lowest side lies flat."""
    return round(pitch / (math.pi / 2))


@compiled
def side_shape(cell: Cell, quarter_turns: int) -> tuple[float, float]:
    """Return half the length of a side and the height of the centre above it."""
    run = cell.half_diagonal * math.cos(cell.corner_angle)
    rise = cell.half_diagonal * math.sin(cell.corner_angle)
    if quarter_turns % 2 == 0:
        return run, rise
    return rise, run


@compiled
def speed_scale(cell: Cell) -> float:
    """Return the speed gained over a half diagonal."""
    most = math.hypot(cell.pull_along, cell.pull_normal)
    most += math.hypot(cell.drive_along, cell.drive_normal)
    return math.sqrt(most * cell.half_diagonal)


@compiled
def kinetic(cell: Cell, state: Array) -> float:
    """Return the kinetic energy per mass relative to the plane."""
    turning = cell.half_diagonal * state[PITCH_RATE]
    square = turning * turning / cell.inertia_ratio
    return 0.5 * (state[ALONG_RATE] ** 2 + state[UP_RATE] ** 2 + square)


# --- smooth motion


@compiled
def free_acceleration(cell: Cell, time: float) -> tuple[float, float]:
    """Return the acceleration of a free part relative to the plane, along it and off it."""
    swing = math.sin(cell.circular_frequency * time + cell.start_phase)
    along = cell.drive_along * swing - cell.pull_along
    return along, cell.drive_normal * swing - cell.pull_normal


@compiled
def free_corner(
    cell: Cell, time: float, s: float, c: float, pitch_rate: float
) -> tuple[float, float]:
    """Return the acceleration of a corner without force, off the plane (chi) and along it."""
    along, upward = free_acceleration(cell, time)
    turning = cell.turning * cell.half_diagonal * pitch_rate * pitch_rate
    return upward + turning * s, along - turning * c


@compiled
def holding_force(cell: Cell, s: float, c: float, chi: float, along: float) -> tuple[float, float]:
    """Return normal and friction force per mass that keep a corner at rest (theory 2.4)."""
    kappa = cell.inertia_ratio
    normal = -((1.0 + kappa * s * s) * chi - kappa * s * c * along) / (1.0 + kappa)
    friction = -((1.0 + kappa * c * c) * along - kappa * s * c * chi) / (1.0 + kappa)
    return normal, friction


@compiled
def response_of(cell: Cell, s: float, c: float, sigma: int) -> float:
    """Return m tau, the normal acceleration of a sliding corner per normal force and mass."""
    return 1.0 + cell.inertia_ratio * c * (c - sigma * cell.friction_kinetic * s)


@compiled
def corner_force(
    cell: Cell, corner: int, sigma: int, time: float, pitch: float, pitch_rate: float
) -> tuple[float, float]:
    """Return normal and friction force per mass on a corner that is held or slides."""
    s, c = corner_at(cell, corner, pitch)
    chi, along = free_corner(cell, time, s, c, pitch_rate)
    if sigma == 0:
        return holding_force(cell, s, c, chi, along)
    response = response_of(cell, s, c, sigma)
    if response <= 0.0:  # the state is refused after the step
        return 0.0, 0.0
    return -chi / response, sigma * cell.friction_kinetic * chi / response


@compiled
def flat_force(cell: Cell, sigma: int, time: float) -> tuple[float, float]:
    """Return normal and friction force per mass on a side that lies flat."""
    along, upward = free_acceleration(cell, time)
    if sigma == 0:
        return -upward, -along
    return -upward, sigma * cell.friction_kinetic * upward


@compiled
def rates(
    cell: Cell, support: int, sigma: int, time: float, pitch: float, pitch_rate: float, slip: float
) -> tuple[float, float, float]:
    """Return accelerations along and in pitch, and the power that friction takes."""
    along, _ = free_acceleration(cell, time)
    if support == FLAT:
        normal, friction = flat_force(cell, sigma, time)
        return along + friction, 0.0, abs(friction * slip) if sigma != 0 else 0.0
    normal, friction = corner_force(cell, support, sigma, time, pitch, pitch_rate)
    s, c = corner_at(cell, support, pitch)
    turn = -cell.inertia_ratio * (normal * c + friction * s) / cell.half_diagonal
    return along + friction, turn, abs(friction * slip) if sigma != 0 else 0.0


@compiled
def fly(cell: Cell, state: Array, time: float, step: float, after: Array) -> None:
    """Set `after` to the state after a free flight, in closed form (theory 13.2)."""
    gained = moved = 0.0  # integrals of the swing of the drive
    w = cell.circular_frequency
    if w > 0.0:
        turn, start = w * step, w * time + cell.start_phase
        half = math.sin(turn / 2)
        gained = 2.0 * math.sin(start + turn / 2) * half / w
        moved = math.cos(start) * (turn - math.sin(turn)) + 2.0 * math.sin(start) * half * half
        moved /= w * w
    after[:] = state
    after[ALONG] += step * state[ALONG_RATE] - cell.pull_along * step * step / 2
    after[UP] += step * state[UP_RATE] - cell.pull_normal * step * step / 2
    after[ALONG] += cell.drive_along * moved
    after[UP] += cell.drive_normal * moved
    after[PITCH] += step * state[PITCH_RATE]
    after[ALONG_RATE] += cell.drive_along * gained - cell.pull_along * step
    after[UP_RATE] += cell.drive_normal * gained - cell.pull_normal * step


@compiled
def settle_on(cell: Cell, state: Array, support: int, sigma: int) -> None:
    """Put the state on its support: gap and its rate 0, and slip 0 where friction holds."""
    if support == FLAT:
        quarter_turns = side_below(state[PITCH])
        state[PITCH] = quarter_turns * (math.pi / 2)
        _, state[UP] = side_shape(cell, quarter_turns)
        state[UP_RATE] = state[PITCH_RATE] = 0.0
        if sigma == 0:
            state[ALONG_RATE] = 0.0
    elif support >= 0:
        s, c = corner_at(cell, support, state[PITCH])
        turning = cell.half_diagonal * state[PITCH_RATE]
        state[UP], state[UP_RATE] = cell.half_diagonal * s, turning * c
        if sigma == 0:
            state[ALONG_RATE] = turning * s


@compiled
def carry(
    cell: Cell, support: int, sigma: int, state: Array, time: float, step: float, after: Array
) -> None:
    """Set `after` to the state after a step with one support: Runge-Kutta of order 4.

    Only pitch and slide are integrated; the rest follows from the support, so that nothing sinks.
    """
    if support == FREE:
        fly(cell, state, time, step, after)
        return
    after[:] = state
    if support == FLAT and sigma == 0:
        return
    place = max(support, 0)
    x, v, p, q, lost = (
        state[ALONG], state[ALONG_RATE], state[PITCH], state[PITCH_RATE], state[LOST],
    )  # fmt: skip
    _, c_0 = corner_at(cell, place, p)
    rho = cell.half_diagonal
    x_sum = v_sum = p_sum = q_sum = lost_sum = 0.0
    v_here, p_here, q_here = v, p, q
    for stage in range(4):
        s, _ = corner_at(cell, place, p_here)
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
    after[ALONG], after[ALONG_RATE] = x + x_sum, v + v_sum
    after[PITCH], after[PITCH_RATE] = p + p_sum, q + q_sum
    after[LOST] = lost + lost_sum
    settle_on(cell, after, support, sigma)
    if support >= 0 and sigma == 0 and cell.turning != 0.0:
        _, c = corner_at(cell, place, after[PITCH])
        after[ALONG] = x + rho * (c_0 - c)


@compiled
def side_forces(
    cell: Cell, quarter_turns: int, normal: float, friction: float
) -> tuple[float, float]:
    """Return the normal forces at the right and the left end of a side that lies flat."""
    half, height = side_shape(cell, quarter_turns)
    tilt = friction * height / half
    return (normal - tilt) / 2, (normal + tilt) / 2


@compiled
def holds(cell: Cell, support: int, sigma: int, state: Array, time: float) -> bool:
    """Return whether the state still fits the support and the direction of slip."""
    overlap, deep = OVERLAP * cell.half_diagonal, DEEP * cell.half_diagonal
    if support == FLAT:
        normal, friction = flat_force(cell, sigma, time)
        right, left = side_forces(cell, side_below(state[PITCH]), normal, friction)
        if normal < 0.0 or right < 0.0 or left < 0.0:
            return False
        slip = state[ALONG_RATE]
    else:
        for corner in range(corner_count(cell)):
            gap = gap_of(cell, state, corner)
            # A corner that has just been struck may rise from a rounding below the plane.
            falls = gap < -deep or gap_rate_of(cell, state, corner) < 0.0
            if corner != support and gap < -overlap and falls:
                return False
        if support == FREE:
            return True
        s, c = corner_at(cell, support, state[PITCH])
        if sigma != 0 and response_of(cell, s, c, sigma) <= 0.0:
            return False
        normal, friction = corner_force(cell, support, sigma, time, state[PITCH], state[PITCH_RATE])
        if normal < 0.0:
            return False
        slip = slip_of(cell, state, support)
    if sigma == 0:
        return abs(friction) <= cell.friction_static * normal
    if cell.friction_static == 0.0:
        return True
    return sigma * slip >= -1e-5 * SLOW * speed_scale(cell)


@compiled
def delassus(cell: Cell, s: float, c: float) -> tuple[float, float, float]:
    """Return the Delassus numbers of a corner, per mass."""
    kappa = cell.inertia_ratio
    return 1.0 + kappa * c * c, kappa * s * c, 1.0 + kappa * s * s


@compiled
def push(cell: Cell, state: Array, s: float, c: float, normal: float, tangential: float) -> None:
    """Add an impulse per mass at a corner to the state."""
    state[ALONG_RATE] += tangential
    state[UP_RATE] += normal
    state[PITCH_RATE] -= cell.inertia_ratio * (normal * c + tangential * s) / cell.half_diagonal


# --- transitions


@compiled
def stop_corner(cell: Cell, state: Array, corner: int, slip_too: bool) -> None:
    """Take a small rest of velocity from a corner by an impulse, which cannot add energy."""
    s, c = corner_at(cell, corner, state[PITCH])
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
def choose_corner(cell: Cell, state: Array, time: float, corner: int) -> tuple[int, int]:
    """Return support and direction of slip where one corner touches and does not approach."""
    slow = SLOW * speed_scale(cell)
    stop_corner(cell, state, corner, False)
    slip = slip_of(cell, state, corner)
    stops = abs(slip) <= slow and cell.friction_static > 0.0
    if stops:
        stop_corner(cell, state, corner, True)
    settle_on(cell, state, corner, 1)
    s, c = corner_at(cell, corner, state[PITCH])
    chi, along = free_corner(cell, time, s, c, state[PITCH_RATE])
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
def choose(cell: Cell, state: Array, time: float) -> tuple[int, int]:
    """Return support and direction of slip, and put the state on the support.

    From the touching corners that do not move off or on; the contact laws of accelerations decide
    (theory 2.3 and 2.4).
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
        if abs(state[ALONG_RATE]) > slow:
            sigma = 1 if state[ALONG_RATE] > 0.0 else -1
        else:
            state[ALONG_RATE] = 0.0
        normal, friction = flat_force(cell, sigma, time)
        if sigma == 0 and abs(friction) > cell.friction_static * normal:
            sigma = -1 if friction > 0.0 else 1
            normal, friction = flat_force(cell, sigma, time)
        quarter_turns = side_below(state[PITCH])
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
    state[LOST] += before - kinetic(cell, state)
    return support, sigma


@compiled
def rests_for_ever(cell: Cell, support: int, sigma: int, state: Array) -> bool:
    """Return whether the part is at rest and no phase of the drive can move it."""
    if sigma != 0:
        return False
    g, drive = cell.pull_normal, cell.drive_normal
    if support >= 0 and cell.turning == 0.0:
        turning = cell.half_diagonal * abs(state[PITCH_RATE])
        at_rest = turning <= SLOW * speed_scale(cell)
        return at_rest and cell.pull_along == 0.0 and cell.drive_along == 0.0 and g >= abs(drive)
    if support != FLAT or g < abs(drive):
        return False
    half, height = side_shape(cell, side_below(state[PITCH]))
    # Neither slip nor tipping to either side: share * normal +- friction >= 0 at every phase.
    share = min(cell.friction_static, half / height)
    along, swing = cell.pull_along, cell.drive_along
    uphill = share * g - along >= abs(share * drive - swing)
    return uphill and share * g + along >= abs(share * drive + swing)


# --- impacts


@compiled
def arrest(
    nn: float, nt: float, tt: float, u_n: float, u_t: float, friction: float
) -> tuple[float, float]:
    """Return the impulse that brings u_n <= 0 to 0, as `core.mechanics.impact` (theory 5.3)."""
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
    cell: Cell, state: Array, right: int, left: int, after: Array
) -> tuple[float, float, float]:
    """Set `after` to the state where no corner approaches; return normal impulses and friction.

    `right` is the corner, or the right one of two that touch together; `left` is -1 for one corner.
    On a side both corners slide alike, so that friction is one force (theory 1.4, 5.3).
    """
    rho, kappa, mu = cell.half_diagonal, cell.inertia_ratio, cell.friction_kinetic
    after[:] = state
    u_right = gap_rate_of(cell, state, right)
    s_r, c_r = corner_at(cell, right, state[PITCH])
    slack = 1e-12 * (abs(u_right) + rho * abs(state[PITCH_RATE]))
    if left >= 0:
        s_l, c_l = corner_at(cell, left, state[PITCH])
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
            after[:] = state
    if u_right >= 0.0:
        return 0.0, 0.0, 0.0
    nn, nt, tt = delassus(cell, s_r, c_r)
    normal, friction = arrest(nn, nt, tt, u_right, slip_of(cell, state, right), mu)
    push(cell, after, s_r, c_r, normal, friction)
    return normal, 0.0, friction


@compiled
def strike(cell: Cell, state: Array, after: Array) -> bool:
    """Put an impact into the state; return whether there was one.

    Moreau's law scales the compression by 1 + eps; that of Pfeiffer and Glocker adds an expansion
    with eps times the normal impulses (theory 5.3). Where a corner still approaches, which one
    impact of two corners may leave, compressions follow.
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
        _, c_r = corner_at(cell, right, state[PITCH])
        _, c_l = corner_at(cell, left, state[PITCH])
        if c_r < c_l:
            right, left = left, right
    before = kinetic(cell, state)
    eps = cell.restitution
    first, second, _ = compress(cell, state, right, left, after)
    if cell.law == MOREAU:
        for place in (ALONG_RATE, UP_RATE, PITCH_RATE):
            state[place] += (1.0 + eps) * (after[place] - state[place])
    else:
        state[:] = after
        s, c = corner_at(cell, right, state[PITCH])
        push(cell, state, s, c, eps * first, 0.0)
        place = right
        if left >= 0:
            s_l, c_l = corner_at(cell, left, state[PITCH])
            push(cell, state, s_l, c_l, eps * second, 0.0)
            if first == 0.0:
                place, s, c = left, s_l, c_l
        limit = cell.friction_kinetic * eps * (first + second)
        _, _, tt = delassus(cell, s, c)
        wanted = -slip_of(cell, state, place) / tt
        push(cell, state, s, c, 0.0, min(max(wanted, -limit), limit))
    for _ in range(20):
        least = gap_rate_of(cell, state, right)
        if left >= 0:
            least = min(least, gap_rate_of(cell, state, left))
        if least >= -slow:
            break
        compress(cell, state, right, left, after)
        state[:] = after
    state[LOST] += before - kinetic(cell, state)
    return True


# --- a run from impact to impact


class Run(NamedTuple):
    """What a run leaves besides its state; the table's columns follow `Tumble`."""

    status: int
    time: float
    settling_time: float
    impacts: int
    largest_bounce: float
    side: int


@compiled
def start_of(cell: Cell, state: Array) -> None:
    """Set the state to the start."""
    state[:] = 0.0
    state[PITCH], state[PITCH_RATE] = cell.pitch, cell.pitch_rate
    state[ALONG_RATE], state[UP_RATE] = cell.velocity_along, cell.velocity_upward
    lowest = 0.0
    for corner in range(corner_count(cell)):
        s, _ = corner_at(cell, corner, cell.pitch)
        lowest = max(lowest, s)
    state[UP] = cell.half_diagonal * lowest + cell.gap_normal


@compiled
def record(cell: Cell, state: Array, time: float, support: int, row: Array) -> None:
    """Write time, centre, pitch, their rates, energy lost, lowest gap and touching corners."""
    row[:] = 0.0
    row[0] = time
    row[1:8] = state
    row[8] = lowest_gap(cell, state)
    if support >= 0:
        row[9 + support] = 1.0
    elif support == FLAT:
        quarter_turns = side_below(state[PITCH])
        row[9 + (-quarter_turns) % 4] = row[9 + (1 - quarter_turns) % 4] = 1.0


@compiled
def side_of(cell: Cell, support: int, pitch: float) -> int:
    """Return the number of the side that lies flat, 1 to 4; 0 if none does, 1 for a ball."""
    if support == FLAT:
        return side_below(pitch) % 4 + 1
    return 1 if support >= 0 and cell.turning == 0.0 else 0


@compiled
def top_of(
    cell: Cell, support: int, state: Array, after: Array, time: float, step: float, trial: Array
) -> float:  # fmt: skip
    """Return the largest height of the lowest corner in a step, found where it ceases to rise."""
    top = max(lowest_gap(cell, state), lowest_gap(cell, after))
    if support != FREE or lowest_rate(cell, state) <= 0.0 or lowest_rate(cell, after) >= 0.0:
        return top
    low, high = 0.0, step
    for _ in range(TOP_HALVINGS):
        middle = (low + high) / 2
        carry(cell, support, 0, state, time, middle, trial)
        if lowest_rate(cell, trial) > 0.0:
            low = middle
        else:
            high = middle
    return max(top, lowest_gap(cell, trial))


@compiled
def dips(
    cell: Cell, support: int, sigma: int, state: Array, time: float, step: float, after: Array,
    trial: Array,
) -> float:  # fmt: skip
    """Return the time in a step after which a corner is in the plane; `step` if none is.

    For corners that sink at the start of the step and rise at its end.
    """
    if support == FLAT:
        return step
    for corner in range(corner_count(cell)):
        sinking, rising = gap_rate_of(cell, state, corner), gap_rate_of(cell, after, corner)
        if corner != support and sinking < 0.0 < rising:
            part = step * sinking / (sinking - rising)
            carry(cell, support, sigma, state, time, part, trial)
            if gap_of(cell, trial, corner) < -OVERLAP * cell.half_diagonal:
                return part
    return step


@compiled
def first_misfit(
    cell: Cell, support: int, sigma: int, state: Array, time: float, step: float, after: Array,
    trial: Array,
) -> float:  # fmt: skip
    """Return the time in a step at which the state ceases to fit, and set `after` to it.

    `after` holds the state at the end of the step, which does not fit. A corner that falls on the
    plane is followed back by Newton's method, which approaches from below a path that bends down;
    everything else, and what Newton's method leaves, is halved.
    """
    overlap = OVERLAP * cell.half_diagonal
    low, part, halve = 0.0, step, False
    for _ in range(HALVINGS):
        guess = (low + part) / 2
        deepest, falling = -overlap, -1
        for corner in range(corner_count(cell)):
            gap = gap_of(cell, after, corner)
            if corner != support and gap < deepest:
                deepest, falling = gap, corner
        at_plane = falling >= 0 and deepest >= -1.5 * overlap
        if part - low <= (1e-9 if at_plane else 1e-12 if falling < 0 else 0.0) * step:
            break
        if at_plane:  # was the corner the first? just before, everything has to fit
            guess = max(guess, part - 1e-9 * step)
        elif falling >= 0:
            rate = gap_rate_of(cell, after, falling)
            if rate < 0.0 and not halve:
                back = part - (deepest + overlap) / rate
                if low < back < part:
                    guess = back
        if guess in (low, part):
            break
        carry(cell, support, sigma, state, time, guess, trial)
        halve = holds(cell, support, sigma, trial, time + guess)
        if halve:
            low = guess
        else:
            part = guess
            after[:] = trial
    return part


@compiled
def run_events(cell: Cell, state: Array, times: Array, rows: NDArray[np.float64]) -> Run:
    """Run one cell from event to event, and write its state at the times into the rows."""
    after, trial = np.empty_like(state), np.empty_like(state)
    start_of(cell, state)
    time, settling, bounce = 0.0, np.nan, 0.0
    impacts = events = written = 0
    status = LIMIT_REACHED
    if strike(cell, state, after):
        impacts = 1
    support, sigma = choose(cell, state, time)
    steps = math.ceil(min(cell.duration / cell.time_step, MOST_STEPS))
    most_events = EVENTS + EVENTS_A_STEP * steps
    steps_left = min(1000 + STEPS_MORE * steps, MOST_STEPS) + times.size
    while True:
        while written < times.size and times[written] <= time:
            record(cell, state, times[written], support, rows[written])
            written += 1
        if support == PARADOX:
            status = NO_SOLUTION
            break
        if rests_for_ever(cell, support, sigma, state):
            status, settling = SETTLED, time
            break
        if time >= cell.duration:
            status = MOVING
            break
        if steps_left <= 0 or events >= most_events:
            break
        steps_left -= 1
        end = min(time + cell.time_step, cell.duration)
        if written < times.size:
            end = min(end, times[written])
        if abs(state[PITCH_RATE]) * (end - time) > LARGEST_TURN:
            end = time + LARGEST_TURN / abs(state[PITCH_RATE])
        step = end - time
        carry(cell, support, sigma, state, time, step, after)
        part = dips(cell, support, sigma, state, time, step, after, trial)
        if part == step and holds(cell, support, sigma, after, end):
            if impacts > 0:
                bounce = max(bounce, top_of(cell, support, state, after, time, step, trial))
            state[:] = after
            time = end
            continue
        if part != step:
            carry(cell, support, sigma, state, time, part, after)
        part = first_misfit(cell, support, sigma, state, time, part, after, trial)
        if impacts > 0:
            bounce = max(bounce, top_of(cell, support, state, after, time, part, trial))
        state[:] = after
        time = end if part == step else time + part
        events += 1
        if strike(cell, state, after):
            impacts += 1
        support, sigma = choose(cell, state, time)
    if status in (SETTLED, MOVING) or time >= cell.duration:
        for row in range(written, times.size):
            record(cell, state, times[row], support, rows[row])
    return Run(status, time, settling, impacts, bounce, side_of(cell, support, state[PITCH]))


# --- a run by time stepping


@compiled
def arrest_all(
    cell: Cell, state: Array, near: NDArray[np.int64], target: Array, impulse: Array
) -> None:
    """Add the impulses of several corners: projected Gauss-Seidel, a corner at a time.

    `target` (2, 4) holds the velocities off and along the plane that the corners are to end at, at
    least; `impulse` (2, 4) is overwritten.
    """
    impulse[:] = 0.0
    mu = cell.friction_kinetic
    scale = SLOW * 1e-6 * speed_scale(cell)
    for _ in range(MOST_SWEEPS):
        change = 0.0
        for corner in range(near.size):
            if near[corner] == 0:
                continue
            s, c = corner_at(cell, corner, state[PITCH])
            nn, nt, tt = delassus(cell, s, c)
            old_n, old_t = impulse[0, corner], impulse[1, corner]
            u_n = gap_rate_of(cell, state, corner) - target[0, corner]
            u_t = slip_of(cell, state, corner) - target[1, corner]
            u_n -= nn * old_n + nt * old_t
            u_t -= nt * old_n + tt * old_t
            new_n = new_t = 0.0
            if u_n < 0.0:
                new_n, new_t = arrest(nn, nt, tt, u_n, u_t, mu)
            push(cell, state, s, c, new_n - old_n, new_t - old_t)
            impulse[0, corner], impulse[1, corner] = new_n, new_t
            change = max(change, abs(new_n - old_n), abs(new_t - old_t))
        if change <= scale:
            break


@compiled
def slides_without_solution(
    cell: Cell, state: Array, middle: Array, near: NDArray[np.int64]
) -> bool:
    """Return whether the one corner that is near slides where tau <= 0 (theory 2.3)."""
    corner = int(np.argmax(near))
    s, c = corner_at(cell, corner, middle[PITCH])
    slip = state[ALONG_RATE] - cell.half_diagonal * state[PITCH_RATE] * s
    if abs(slip) <= SLOW * speed_scale(cell):
        return False
    return response_of(cell, s, c, 1 if slip > 0.0 else -1) <= 0.0


@compiled
def run_steps(cell: Cell, state: Array, times: Array, rows: NDArray[np.float64]) -> Run:
    """Run one cell by the midpoint rule of Moreau and Jean (theory 13.9), with Moreau's law."""
    corners = corner_count(cell)
    near = np.zeros(corners, dtype=np.int64)
    target, impulse = np.zeros((2, corners)), np.zeros((2, corners))
    middle = np.empty_like(state)
    start_of(cell, state)
    slow = SLOW * speed_scale(cell)
    time, bounce, last_motion = 0.0, 0.0, 0.0
    impacts = written = 0
    steps = math.ceil(min(cell.duration / cell.time_step, MOST_STEPS))
    support, status = FREE, MOVING if steps < MOST_STEPS else LIMIT_REACHED
    for _ in range(steps):
        while written < times.size and times[written] <= time:
            record(cell, state, times[written], support, rows[written])
            written += 1
        step = min(cell.time_step, cell.duration - time)
        along, upward = free_acceleration(cell, time + step / 2)
        middle[:] = state
        for place, rate in ((ALONG, ALONG_RATE), (UP, UP_RATE), (PITCH, PITCH_RATE)):
            middle[place] += step / 2 * state[rate]
        middle[ALONG_RATE] += step * along
        middle[UP_RATE] += step * upward
        touching = 0
        struck = False
        target[:] = 0.0
        for corner in range(corners):
            near[corner] = 1 if gap_of(cell, middle, corner) <= 0.0 else 0
            touching += near[corner]
            _, c = corner_at(cell, corner, middle[PITCH])
            approach = state[UP_RATE] - cell.half_diagonal * state[PITCH_RATE] * c
            if near[corner] != 0 and approach < 0.0:
                target[0, corner] = -cell.restitution * approach
                # A corner at rest sinks by some steps of gravity: no impact along the plane.
                if approach < -2.0 * step * abs(upward):
                    s, _ = corner_at(cell, corner, middle[PITCH])
                    slip = state[ALONG_RATE] - cell.half_diagonal * state[PITCH_RATE] * s
                    target[1, corner] = -cell.restitution * slip
                    struck = True
        if touching == 1 and not struck and slides_without_solution(cell, state, middle, near):
            status = NO_SOLUTION
            break
        before = kinetic(cell, middle)
        if touching > 0:
            arrest_all(cell, middle, near, target, impulse)
            middle[LOST] += before - kinetic(cell, middle)
        support = FREE
        for corner in range(corners):
            if near[corner] != 0 and impulse[0, corner] > 0.0 and touching > 0:
                support = FLAT if support != FREE else corner
        for place, rate in ((ALONG, ALONG_RATE), (UP, UP_RATE), (PITCH, PITCH_RATE)):
            middle[place] += step / 2 * middle[rate]
        state[:] = middle
        time += step
        impacts += 1 if struck else 0
        if impacts > 0:
            bounce = max(bounce, lowest_gap(cell, state))
        if kinetic(cell, state) > 0.5 * slow * slow:
            last_motion = time
        elif rests_for_ever(cell, support, 0, state):
            status = SETTLED
            break
    if status in (SETTLED, MOVING) or time >= cell.duration:
        for row in range(written, times.size):
            record(cell, state, times[row], support, rows[row])
    settling = last_motion if status == SETTLED else np.nan
    return Run(status, time, settling, impacts, bounce, side_of(cell, support, state[PITCH]))


# --- many cells, and one path


@compiled
def fill(cell: Cell, run: Run, state: Array, row: Array) -> None:
    """Write the results of a run, the fields of `Tumble` without the status."""
    row[0] = state[PITCH]
    row[1] = run.side
    row[2] = run.settling_time
    row[3] = run.impacts
    row[4] = run.largest_bounce
    elapsed = cell.duration if run.status == SETTLED else run.time
    row[5] = state[ALONG] / elapsed if elapsed > 0.0 else 0.0
    row[6] = state[LOST]


@compiled
def tumble_events(
    cells: NDArray[np.float64], table: NDArray[np.float64], status: NDArray[np.int8]
) -> None:
    """Fill the table of cells, from event to event."""
    state, times, rows = np.empty(STATE), np.empty(0), np.empty((0, PATH_COLUMNS))
    for number in range(cells.shape[0]):
        cell = cell_of(cells[number])
        run = run_events(cell, state, times, rows)
        fill(cell, run, state, table[number])
        status[number] = run.status


@compiled
def tumble_steps(
    cells: NDArray[np.float64], table: NDArray[np.float64], status: NDArray[np.int8]
) -> None:
    """Fill the table of cells, by time stepping."""
    state, times, rows = np.empty(STATE), np.empty(0), np.empty((0, PATH_COLUMNS))
    for number in range(cells.shape[0]):
        cell = cell_of(cells[number])
        run = run_steps(cell, state, times, rows)
        fill(cell, run, state, table[number])
        status[number] = run.status


@compiled
def path_events(row: Array, times: Array, rows: NDArray[np.float64]) -> None:
    """Write the path of one cell at the times into the rows, from event to event."""
    run_events(cell_of(row), np.empty(STATE), times, rows)


@compiled
def path_steps(row: Array, times: Array, rows: NDArray[np.float64]) -> None:
    """Write the path of one cell at the times into the rows, by time stepping."""
    run_steps(cell_of(row), np.empty(STATE), times, rows)
