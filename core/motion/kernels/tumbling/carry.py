"""Smooth motion: a step with one support."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.tumbling.forces import (
    corner_force,
    flat_force,
    free_acceleration,
)
from vibrafeed.core.motion.kernels.tumbling.geometry import corner_at, side_below, side_shape
from vibrafeed.core.motion.kernels.tumbling.tables import FLAT, FREE, STATE, Cell


@compiled
def rates(
    cell: Cell, support: int, sigma: int, time: float, pitch: float, pitch_rate: float, slip: float
) -> tuple[float, float, float]:
    """Return accelerations of a tumbling part along the plane (m/s^2) and in pitch, and lost power.

    x'' = a_x + t and xi'' = -kappa (n cos s + t sin s)/rho in rad/s^2 under the normal and friction
    forces n and t per mass of its support, with the free acceleration a, corner angle s, half
    diagonal rho and inertia ratio kappa (theory 2.2). Friction takes |t slip| per mass. `support`
    is a corner's number or `FLAT`, `sigma` the direction of slip (1, -1), 0 if held; `slip` is the
    slip velocity in m/s, `pitch` and `pitch_rate` are in rad and rad/s, `time` in s gives the phase
    of the drive.
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
    """Set `after` to the state after free flight for `step` seconds from `time`, in closed form.

    The place becomes x + u t - g t^2/2 and the velocity u - g t, and the drive P sin(w t + phi)
    adds its second and first integral. `state` and `after` have the columns of `STATE`; `time` is
    in s.
    """
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

    Rounding would otherwise let it sink in. y = rho sin s, y' = rho xi' cos s and x' = rho xi' sin
    s for the centre (x, y) over a corner at angle s, half diagonal rho and pitch rate xi' (theory
    2.1); on a side its height, without rise and pitch rate. `support` is a corner's number, `FLAT`
    or `FREE`; `sigma` the direction of slip (1, -1), 0 if held. `state` (columns of `STATE`, SI) is
    changed.
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

    By Runge-Kutta of order 4, in flight in closed form. Only pitch and slide are integrated; the
    rest follows from the support, so that nothing sinks. `support` is a corner's number, `FLAT` or
    `FREE`; `sigma` the direction of slip (1, -1), 0 if held; `time` is the start of the step and
    `step` its length in s. States have the columns of `STATE` (SI).
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
