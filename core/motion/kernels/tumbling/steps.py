"""A run by time stepping."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Flags, Floats, Stop, copy
from vibrafeed.core.motion.kernels.statuses import STATUS
from vibrafeed.core.motion.kernels.tumbling.forces import free_acceleration, response_of
from vibrafeed.core.motion.kernels.tumbling.geometry import (
    corner_at,
    corner_count,
    gap_of,
    gap_rate_of,
    kinetic,
    lowest_gap,
    slip_of,
    speed_scale,
)
from vibrafeed.core.motion.kernels.tumbling.impact import arrest, delassus, push
from vibrafeed.core.motion.kernels.tumbling.run import (
    MAX_STEPS,
    TumblingRun,
    record_rest,
    record_until,
    side_of,
    start_of,
)
from vibrafeed.core.motion.kernels.tumbling.support import rests_for_ever
from vibrafeed.core.motion.kernels.tumbling.tables import FLAT, FREE, SLOW, STATE, Cell

MAX_SWEEPS = 500  # over corners that touch at once; what they still change is rounding


@compiled
def arrest_all(cell: Cell, state: Floats, near: Flags, target: Floats, impulse: Floats) -> None:
    """Apply impulses at all corners of a part in the plane, so that none approaches too fast.

    By projected Gauss-Seidel: one corner at a time, until the impulses stand still. `near` is 1 for
    the corners that take part; `target` (2, 4) holds the least velocities off the plane, and those
    along it that friction aims at, in m/s, at the end; `impulse` (2, 4) is filled with normal and
    friction impulse per mass of each corner in m/s. The velocities in `state` (columns of `STATE`,
    SI) are changed.
    """
    impulse[:] = 0.0
    mu = cell.friction_kinetic
    scale = SLOW * 1e-6 * speed_scale(cell)
    for _ in range(MAX_SWEEPS):
        change = 0.0
        for corner in range(near.size):
            if near[corner] == 0:
                continue
            s, c = corner_at(cell, corner, state[STATE.pitch])
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
def slides_without_solution(cell: Cell, state: Floats, middle: Floats, near: Flags) -> bool:
    """True if the only corner in the plane slides in a way for which contact laws have no solution.

    That is m tau <= 0, its normal acceleration over the normal force: a force would press it in.
    `state` is that at the start of a step, `middle` that in its middle (columns of `STATE`, SI),
    `near` is 1 for the corner.
    """
    corner = int(np.argmax(near))
    s, c = corner_at(cell, corner, middle[STATE.pitch])
    slip = state[STATE.along_rate] - cell.half_diagonal * state[STATE.pitch_rate] * s
    if abs(slip) <= SLOW * speed_scale(cell):
        return False
    return response_of(cell, s, c, 1 if slip > 0.0 else -1) <= 0.0


@compiled
def set_targets(
    cell: Cell, state: Floats, middle: Floats, step: float, upward: float, near: Flags,
    target: Floats,
) -> tuple[int, bool]:  # fmt: skip
    """Find the corners in the plane in mid-step, and the velocities that they are to end it with.

    -eps g_N' off the plane, and after an impact -eps g_T' along it, with the restitution eps and
    the velocities g' before (theory 5.3). Return the number of near corners, and True if one
    strikes.

    Parameters
    ----------
    cell
        Numbers of the part.
    state, middle
        State at the start and in the middle of the step (columns of `STATE`).
    step
        Duration of the step in s.
    upward
        Size of the free acceleration off the plane in m/s^2.
    near
        Filled with 1 for a corner in the plane, else 0.
    target
        Filled with velocities in m/s, a row for each direction (off the plane, along it), a column
        a corner.
    """
    touching, struck = 0, False
    target[:] = 0.0
    for corner in range(near.size):
        near[corner] = 1 if gap_of(cell, middle, corner) <= 0.0 else 0
        touching += near[corner]
        s, c = corner_at(cell, corner, middle[STATE.pitch])
        approach = state[STATE.up_rate] - cell.half_diagonal * state[STATE.pitch_rate] * c
        if near[corner] != 0 and approach < 0.0:
            target[0, corner] = -cell.restitution * approach
            # A corner at rest sinks by some steps of gravity: no impact along the plane.
            if approach < -2.0 * step * upward:
                slip = state[STATE.along_rate] - cell.half_diagonal * state[STATE.pitch_rate] * s
                target[1, corner] = -cell.restitution * slip
                struck = True
    return touching, struck


@compiled
def carrying(impulse: Floats) -> int:
    """Return the corner that carries a tumbling part after a time step: that with a normal impulse.

    `FLAT` if two corners have one (a side lies on the plane), `FREE` if none has. `impulse`, shape
    (2, 4), holds normal and friction impulses per mass of each corner in m/s.
    """
    support = FREE
    for corner in range(impulse.shape[1]):
        if impulse[0, corner] > 0.0:
            support = FLAT if support != FREE else corner
    return support


@compiled
def drift(state: Floats, rates: Floats, time: float) -> None:
    """Move a state's centre and pitch at the rates of another state for a time in s: q + t u."""
    state[STATE.along] += time * rates[STATE.along_rate]
    state[STATE.up] += time * rates[STATE.up_rate]
    state[STATE.pitch] += time * rates[STATE.pitch_rate]


@compiled
def run_steps(cell: Cell, state: Floats, times: Floats, rows: Floats, stop: Stop) -> TumblingRun:
    """Simulate one tumbling part by time stepping with Moreau's law of impact; return its run.

    The midpoint rule of Moreau and Jean, with velocities u, positions q, acceleration a, step h and
    the impulses i of all corners in the plane (theory 13.9):

        u(t + h) = u(t) + h a(t + h/2) + i,    q(t + h) = q(t) + h (u(t) + u(t + h))/2.

    `cell` holds the part's numbers (SI). `state` (columns of `STATE`) is set to that at the end;
    `rows` (columns of `PATH`) are filled at the ascending `times` in s; `stop` is a flag that ends
    the work. The record has status, times, impacts, largest bounce, and the side that lies on the
    plane.
    """
    corners = corner_count(cell)
    near = np.zeros(corners, dtype=np.int64)
    target, impulse = np.zeros((2, corners)), np.zeros((2, corners))
    middle = np.empty_like(state)
    start_of(cell, state)
    slow = SLOW * speed_scale(cell)
    time, bounce, last_motion = 0.0, 0.0, 0.0
    impacts = written = 0
    steps = math.ceil(min(cell.duration / cell.time_step, MAX_STEPS))
    support, status = FREE, STATUS.moving if steps < MAX_STEPS else STATUS.limit_reached
    for _ in range(steps):
        if raised(stop):
            break
        written = record_until(cell, state, time, support, times, written, rows)
        step = min(cell.time_step, cell.duration - time)
        along, upward = free_acceleration(cell, time + step / 2)
        copy(state, middle)
        drift(middle, state, step / 2)
        middle[STATE.along_rate] += step * along
        middle[STATE.up_rate] += step * upward
        touching, struck = set_targets(cell, state, middle, step, abs(upward), near, target)
        if touching == 1 and not struck and slides_without_solution(cell, state, middle, near):
            status = STATUS.no_solution
            break
        before = kinetic(cell, middle)
        if touching > 0:
            arrest_all(cell, middle, near, target, impulse)
            middle[STATE.lost] += before - kinetic(cell, middle)
        support = carrying(impulse) if touching > 0 else FREE
        drift(middle, middle, step / 2)
        copy(middle, state)
        time += step
        impacts += 1 if struck else 0
        if impacts > 0:
            bounce = max(bounce, lowest_gap(cell, state))
        if kinetic(cell, state) > 0.5 * slow * slow:
            last_motion = time
        elif rests_for_ever(cell, support, 0, state):
            status = STATUS.settled
            break
    if status in (STATUS.settled, STATUS.moving) or time >= cell.duration:
        record_rest(cell, state, support, times, written, rows)
    settling = last_motion if status == STATUS.settled else np.nan
    return TumblingRun(
        status, time, settling, impacts, bounce, side_of(cell, support, state[STATE.pitch])
    )
