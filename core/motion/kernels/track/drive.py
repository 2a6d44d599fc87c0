"""The drive: all that exact motion in space knows of what shakes the track.

It gives the series of the push on a part, the velocity of the track, the phases at which the floor
loses a part that rests on it, and those at which the push jumps. It is a sine along a straight
line, a sum of sines on each axis, or constant from step to step.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.cells import GROUPS, Cell
from vibrafeed.core.motion.kernels.track.tables import INVERSE, MAX_ORDER, ROW, TURN, Work
from vibrafeed.core.motion.kernels.waves import SineSum, passages, value_and_slope, wave_columns

LATE = 1e-13
"""Phase in rad: a lift-off so little behind a part that is on the floor is due now."""

ORDERS, STEPS, SIZE = range(3)
"""Columns of `ROW.wave`: harmonics and steps of the wave, and the speed of the track."""


@borrowing
def set_drive(cell: Cell, row: Floats, work: Work) -> None:
    """Fill the rows of the drive in the table `work` of a step, from a cell's row of numbers.

    For a sine: its size |(p_x, p_y, p_z)| in g, and the phase in rad at which a part on the floor
    lifts off, sin(tau) = n/p_z, with drive numbers p and the gravity n onto the floor; none if
    |p_z| <= n (theory 13.3). For a wave, whose coefficients follow in `row` behind those of `cell`,
    its coefficients and all its lift-offs (`read_wave`).
    """
    work[ROW.wave, ORDERS], work[ROW.wave, STEPS] = 0.0, 0.0
    work[ROW.lifts, 0] = 0.0
    if row.size > GROUPS:
        read_wave(cell, row, work)
        return
    work[ROW.wave, SIZE] = math.sqrt(
        cell.drive_number_along**2 + cell.drive_number_across**2 + cell.drive_number_normal**2
    )
    weight, push = cell.gravity_number_normal, cell.drive_number_normal
    if abs(push) > weight:
        phase = math.asin(weight / abs(push))
        work[ROW.lifts, 0], work[ROW.lifts, 1] = 1.0, phase if push > 0.0 else phase + math.pi


@borrowing
def read_wave(cell: Cell, row: Floats, work: Work) -> None:
    """Fill coefficients, size and lift-off phases of a wave into the table `work` of a step.

    `row` holds the fields of `Cell` (also in `cell`), then the numbers of harmonics and of steps;
    the harmonics by axis (along, across, normal), sine or cosine, and order; and the levels by axis
    with the ends of the steps. The size bounds the track's velocity in g/w (w = 2 pi f).
    """
    columns = wave_columns(row, GROUPS)
    orders, steps = columns.orders, columns.steps
    work[ROW.wave, ORDERS], work[ROW.wave, STEPS] = row[GROUPS], row[GROUPS + 1]
    square = 0.0
    for axis in range(3):
        speed = 0.0
        for k in range(1, orders + 1):
            place = columns.along + 2 * axis * orders + k - 1
            sine, cosine = row[place], row[place + orders]
            work[ROW.sines + axis, k], work[ROW.cosines + axis, k] = sine, cosine
            speed += math.hypot(sine, cosine) / k
        square += speed * speed
    for axis in range(4):
        for step in range(steps):
            work[ROW.levels + axis, step] = row[columns.levels + axis * steps + step]
    for axis in (2, 1, 0):  # those along the track stay
        speed = fill_step_speeds(axis, steps, work)
        square += speed * speed
    work[ROW.wave, SIZE] = math.sqrt(square)
    fill_lift_offs(cell.gravity_number_normal, orders, work)


@borrowing
def fill_step_speeds(axis: int, steps: int, work: Work) -> float:
    """Fill the track's velocity along an axis at the start of each step of a drive.

    In g/w (w = 2 pi f): v -> v - p D over a step with push p in g and duration D in rad, less the
    mean over the period. The largest size is returned. `axis` is 0, 1, 2 for along, across, normal;
    `steps` is the number of steps. The table `work` has pushes and ends of the steps in rows
    `levels`, and gets the velocities in row `speeds` (theory 13.14).
    """
    level, end, speed = ROW.levels + axis, ROW.levels + 3, ROW.speeds
    at, now, mean, most = 0.0, 0.0, 0.0, 0.0
    for step in range(steps):
        last = work[end, step] - at
        work[speed, step] = now
        mean += (now - 0.5 * work[level, step] * last) * last
        now -= work[level, step] * last
        at = work[end, step]
    for step in range(steps):
        work[speed, step] -= mean / TURN
        most = max(most, abs(work[speed, step]))
    return most


@borrowing
def fill_lift_offs(weight: float, orders: int, work: Work) -> None:
    """Fill the phases at which a part on the floor lifts off, for a drive that is a sum of sines.

    These are the phases in [0, 2 pi) at which the upward push rises through `weight`, gravity onto
    the floor in g. The push is in the table `work`, up to the order `orders`; row `lifts` gets the
    number of phases, then the phases, ascending.
    """
    push, lifts = SineSum(work, ROW.sines + 2, ROW.cosines + 2, orders), ROW.lifts
    found = passages(push, weight, lifts, MAX_ORDER)
    rising = 0
    for number in range(1, found + 1):
        phase = work[lifts, number]
        if value_and_slope(push, phase)[1] > 0.0:
            rising += 1
            work[lifts, rising] = phase
    work[lifts, 0] = float(rising)


@borrowing
def size(work: Work) -> float:
    """Return the amplitude of the drive's velocity, |(p_x, p_y, p_z)|, or a bound for a wave.

    In g/w (w = 2 pi f); tolerances are relative to it.
    """
    return work[ROW.wave, SIZE]


@borrowing
def sine_slope(work: Work, tau: float) -> float:
    """Return the derivative of the push by phase over its amplitude, cos(tau); NaN for a wave."""
    is_wave = work[ROW.wave, ORDERS] > 0.0 or work[ROW.wave, STEPS] > 0.0
    return math.nan if is_wave else math.cos(tau)


@borrowing
def fill_push(cell: Cell, tau: float, order: int, work: Work) -> None:
    """Fill the power series of the push of the drive on a part, and of the track's velocity.

    Coefficients of powers 0 to `order` of the phase since `tau` [rad], in g and g/w (w = 2 pi f),
    into rows `free` (along, across, normal) and `track` of the table `work`. The push is minus the
    acceleration of the track: (p_x, p_y, p_z) sin(tau) for a sine, with the drive numbers p of
    `cell`; for a wave its coefficients are in `work`.
    """
    if work[ROW.wave, ORDERS] > 0.0:
        fill_harmonics(tau, order, work)
        return
    if work[ROW.wave, STEPS] > 0.0:
        fill_step(tau, order, work)
        return
    along, across = cell.drive_number_along, cell.drive_number_across
    normal = cell.drive_number_normal
    value, change = math.sin(tau), math.cos(tau)
    push = ROW.free
    work[ROW.track, 0] = along * change
    for k in range(order + 1):
        work[push, k], work[push + 1, k] = along * value, across * value
        work[push + 2, k] = normal * value
        value, change = value * INVERSE[k + 1], change * INVERSE[k + 1]
        work[ROW.track, k + 1] = -along * value
        value, change = change, -value


@borrowing
def fill_harmonics(tau: float, order: int, work: Work) -> None:
    """Fill the power series of push and track velocity, for a drive that is a sum of sines.

    Coefficients of the powers 0 to `order` of the phase since `tau` [rad], into rows `free` (push
    along, across and normal in g) and `track` of the table `work`, whose rows `sines` and `cosines`
    hold the drive's coefficients by order k. The n-th derivative of s sin(k tau) + c cos(k tau) is
    k^n times the term, its quarter turn, minus the term, and so on; the track has the velocity sum
    of (s cos(k tau) - c sin(k tau))/k in g/(2 pi f) (theory 13.14).
    """
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine = sine_1, cosine_1
    for axis in range(3):
        for n in range(order + 1):
            work[ROW.free + axis, n] = 0.0
    speed = 0.0
    for k in range(1, int(work[ROW.wave, ORDERS]) + 1):
        for axis in range(3):
            a, b = work[ROW.sines + axis, k], work[ROW.cosines + axis, k]
            if a == 0.0 and b == 0.0:
                continue
            value, change = a * sine + b * cosine, a * cosine - b * sine
            if axis == 0:
                speed += change / k
            for n in range(order + 1):
                work[ROW.free + axis, n] += value
                factor = k * INVERSE[n + 1]
                value, change = change * factor, -value * factor
        sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
    work[ROW.track, 0] = speed
    for n in range(order + 1):
        work[ROW.track, n + 1] = -work[ROW.free, n] * INVERSE[n + 1]


@borrowing
def step_at(tau: float, work: Work) -> int:
    """Return the index of the drive's step at phase `tau` in rad, the first with tau < its end.

    Of a drive in steps of constant acceleration, which `work` holds in rows of `ROW`.
    """
    last = int(work[ROW.wave, STEPS]) - 1
    for step in range(last):
        if tau < work[ROW.levels + 3, step]:
            return step
    return last


@borrowing
def fill_step(tau: float, order: int, work: Work) -> None:
    """Fill the power series of push and track velocity at phase `tau`, for a drive in steps.

    The push p is constant up to the next jump, and the track has the velocity v - p D along itself,
    D the phase since `tau`. Coefficients of powers 0 to `order`, in g and g/w (w = 2 pi f), go into
    rows `free` (along, across, normal) and `track` of the table `work`, which holds the levels of
    the steps.
    """
    step = step_at(tau, work)
    for axis in range(3):
        work[ROW.free + axis, 0] = work[ROW.levels + axis, step]
        for n in range(1, order + 1):
            work[ROW.free + axis, n] = 0.0
    since = tau - (work[ROW.levels + 3, step - 1] if step > 0 else 0.0)
    for n in range(order + 2):
        work[ROW.track, n] = 0.0
    work[ROW.track, 0] = work[ROW.speeds, step] - work[ROW.levels, step] * since
    work[ROW.track, 1] = -work[ROW.levels, step]


@borrowing
def next_jump(tau: float, work: Work) -> float:
    """Return the phase of the next jump of the push, 2 pi (the end of the period) without any.

    `tau` is the phase now.
    """
    if work[ROW.wave, STEPS] == 0.0:
        return TURN
    return work[ROW.levels + 3, step_at(tau, work)]


@borrowing
def is_wave(work: Work) -> bool:
    """True if the drive is not a plain sine: it has harmonics or steps."""
    return work[ROW.wave, ORDERS] + work[ROW.wave, STEPS] > 0.0


@borrowing
def jumps(work: Work) -> bool:
    """True if the push has steps, so that it jumps."""
    return work[ROW.wave, STEPS] > 0.0


@borrowing
def to_lift_off(work: Work, tau: float) -> float:
    """Return the phase in rad from `tau` until a part on the floor lifts off; infinite if never.

    The least (tau_k - tau) mod 2 pi of the phases tau_k in row `lifts` of `work`. Lift-offs at
    jumps of the push are not among them: the forces after a jump decide.
    """
    least = math.inf
    for number in range(int(work[ROW.lifts, 0])):
        ahead = work[ROW.lifts, number + 1] - tau
        if ahead < 0.0:
            ahead = 0.0 if ahead > -LATE else ahead + TURN
        least = min(least, ahead)
    return least
