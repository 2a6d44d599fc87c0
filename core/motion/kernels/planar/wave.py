"""A wave: sums of sines, or steps, as the drive of planar motion, and its flow in closed form.

Each mode has an acceleration push(tau) - pull of a `kind`, a few rows of one table.
"""

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled
from vibrafeed.core.motion.kernels.inputs import GROUPS, Cell, Floats, copy
from vibrafeed.core.motion.kernels.planar.flow import (
    AIR,
    BACKWARD,
    FORWARD,
    MAX_ITERATIONS,
    NORMAL,
    STATIC_FORWARD,
    TURN,
    arc_terms,
)
from vibrafeed.core.motion.kernels.sine_sums import (
    SineSum,
    halley,
    is_near_root,
    passages,
    value_and_slope,
    wave_columns,
)

KINDS = 6  # number of kinds of acceleration
WIDTH = 26
"""Columns of the table: orders from 1, steps from 0, or a count and passages from 1."""
PULLS, ENDS, ROOTS = 2 * KINDS, 2 * KINDS + 1, 2 * KINDS + 2
"""Rows behind those of the coefficients: pulls by kind, ends of steps, and from `ROOTS` on, by
kind, the phases at which its acceleration changes sign."""
RISES = WIDTH - 1
"""Column of a row of passages: 1 if the acceleration rises at the first of them."""
INVERSE = np.array([math.inf, *(1.0 / k for k in range(1, WIDTH))])
"""1/k, by which a term of order k is integrated."""
NEAR = 0.7
"""Phase in rad times the highest order, below which a flow is computed from series."""
LAST_STEP = 1e-5
"""Relative step that ends Halley's iteration: the next is of the order of its cube."""
SLACK = 1e-13
"""Phase in rad: an event so little behind counts as now."""


class WaveDrive(NamedTuple):
    """A wave with gravity and friction, as a drive of planar motion.

    `table` holds the rows of its accelerations, the pushes are upper bounds in g.
    """

    table: Floats
    orders: int
    steps: int
    gravity_along: float
    gravity_normal: float
    mu_s: float
    mu_k: float
    push_along: float
    push_normal: float


class WaveTable(NamedTuple):
    """Room for the wave of a cell, a table of `TABLE`."""

    table: Floats


TABLE = (ROOTS + KINDS, WIDTH)  # shape of the table of a wave


@compiled
def wave_of(cell: Cell, row: Floats, waves: WaveTable) -> tuple[WaveDrive, float, float]:
    """Return the drive of a cell whose wave follows its numbers in `row`, and 0 and 1."""
    table = waves.table
    columns = wave_columns(row, GROUPS)
    orders, steps = columns.orders, columns.steps
    gravity_along, gravity_normal = cell.gravity_number_along, cell.gravity_number_normal
    mu_s, mu_k = cell.friction_static, cell.friction_kinetic
    push_along, push_normal = abs(cell.drive_number_along), abs(cell.drive_number_normal)
    drive = WaveDrive(
        table, orders, steps, gravity_along, gravity_normal, mu_s, mu_k, push_along, push_normal
    )
    for step in range(steps):
        table[ENDS, step] = row[columns.ends + step]
        along, normal = row[columns.levels + step], row[columns.normal_levels + step]
        fill_kinds(drive, 0, step, along, normal)
    for index in range(2 * orders if steps == 0 else 0):  # sines, then cosines
        along, normal = row[columns.along + index], row[columns.normal + index]
        fill_kinds(drive, index // orders, index % orders + 1, along, normal)
    for kind in range(KINDS):
        if mu_s == mu_k and kind >= STATIC_FORWARD:
            copy(table[ROOTS + FORWARD + kind - STATIC_FORWARD], table[ROOTS + kind])
        elif kind != AIR:
            fill_passages(drive, kind)
    return drive, 0.0, 1.0


@borrowing
def fill_kinds(drive: WaveDrive, part: int, column: int, along: float, normal: float) -> None:
    """Fill one column of the accelerations of a part under a wave, for each kind of motion.

    p_z - n off the floor, p_x - sin(gamma) in the air, and p_x +- mu p_z - (sin(gamma) +- mu n) for
    slips, with mu_k and with mu_s; `along` and `normal` are the coefficients of p_x and p_z in g,
    `part` is 0 for sines and steps, 1 for cosines (theory 13.14).
    """
    table, gravity_along, gravity_normal = drive.table, drive.gravity_along, drive.gravity_normal
    table[NORMAL + part, column], table[PULLS, NORMAL] = normal, gravity_normal
    table[2 * AIR + part, column], table[PULLS, AIR] = along, gravity_along
    for kind in range(FORWARD, KINDS):
        friction = drive.mu_k if kind < STATIC_FORWARD else drive.mu_s
        if kind % 2 == BACKWARD % 2:
            friction = -friction
        table[2 * kind + part, column] = along + friction * normal
        table[PULLS, kind] = gravity_along + friction * gravity_normal


@borrowing
def push_of(drive: WaveDrive, kind: int) -> SineSum:
    """Return the sum of sines that drives the acceleration of a kind."""
    return SineSum(drive.table, 2 * kind, 2 * kind + 1, drive.orders)


@borrowing
def fill_passages(drive: WaveDrive, kind: int) -> None:
    """Fill the phases in [0, 2 pi) at which the part's acceleration changes sign, p(tau) = pull."""
    # The row gets their number, then the phases, and in its last column 1 if the first one rises.
    table, row = drive.table, ROOTS + kind
    if drive.steps == 0:
        push = push_of(drive, kind)
        count = passages(push, table[PULLS, kind], row, RISES - 1)
        table[row, 0] = float(count)
        if count > 0:
            slope = value_and_slope(push, table[row, 1])[1]
            table[row, RISES] = 1.0 if slope > 0.0 else 0.0
        return
    count, last = 0, drive.steps - 1
    for step in range(drive.steps):
        # At the start of a step: the first follows on the last.
        was_above = table[2 * kind, step - 1 if step > 0 else last] > table[PULLS, kind]
        is_above = table[2 * kind, step] > table[PULLS, kind]
        if was_above != is_above:
            count += 1
            table[row, count] = table[ENDS, step - 1] if step > 0 else 0.0
            if count == 1:
                table[row, RISES] = 1.0 if is_above else 0.0
    table[row, 0] = float(count)


@borrowing
def within_turn(tau: float) -> float:
    """Return a phase modulo 2 pi, tau - 2 pi floor(tau/2 pi), up to rounding."""
    return tau - TURN * math.floor(tau / TURN) if not 0.0 <= tau < TURN else tau


@borrowing
def step_at(drive: WaveDrive, tau: float) -> int:
    """Return the index of a drive's step at phase `tau` in [0, 2 pi)."""
    for step in range(drive.steps - 1):
        if tau < drive.table[ENDS, step] - SLACK:
            return step
    return drive.steps - 1


@borrowing
def acceleration(drive: WaveDrive, kind: int, tau: float) -> float:
    """Return the acceleration p(tau) - k of a part in one mode of motion under a wave, in g."""
    table = drive.table
    if drive.steps > 0:
        return table[2 * kind, step_at(drive, within_turn(tau))] - table[PULLS, kind]
    value, _ = value_and_slope(push_of(drive, kind), tau)
    return value - table[PULLS, kind]


@borrowing
def next_passage(drive: WaveDrive, kind: int, tau: float) -> tuple[float, bool]:
    """Return the phase from `tau` on where an acceleration changes sign; True if it rises."""
    table, row = drive.table, ROOTS + kind
    count = int(table[row, 0])
    if count == 0:
        return math.inf, False
    phase = within_turn(tau)
    turn_start, rises = tau - phase, table[row, RISES] > 0.0
    for index in range(1, count + 1):
        if table[row, index] >= phase - SLACK:
            return max(tau, turn_start + table[row, index]), rises
        rises = not rises
    rises = table[row, RISES] > 0.0
    return max(tau, turn_start + TURN + table[row, 1]), rises


@borrowing
def later_passage(drive: WaveDrive, kind: int, tau: float) -> tuple[float, bool]:
    """Return the next phase beyond tau where an acceleration changes sign, True if it rises."""
    return next_passage(drive, kind, tau + 2.0 * SLACK * (1.0 + tau))


@borrowing
def next_crossing(drive: WaveDrive, kind: int, tau: float, rising: bool) -> float:
    """Return the first phase from `tau` on at which an acceleration rises, or falls, through 0."""
    crossing, rises = next_passage(drive, kind, tau)
    if rises != rising and crossing < math.inf:
        crossing, rises = later_passage(drive, kind, crossing)
    return crossing if rises == rising else math.inf


@borrowing
def integrals(drive: WaveDrive, kind: int, tau: float) -> tuple[float, float, float, float]:
    """Return slope and value of a wave's push at phase `tau`, and its first and second integral.

    Of a sum of a sin(k tau) + b cos(k tau): the slope sums k (a cos(k tau) - b sin(k tau)), the
    integrals -(a cos(k tau) - b sin(k tau))/k and -(a sin(k tau) + b cos(k tau))/k^2 (theory
    13.14). Not for steps.
    """
    table, sines, cosines = drive.table, 2 * kind, 2 * kind + 1
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine, slope, push, first, second = sine_1, cosine_1, 0.0, 0.0, 0.0, 0.0
    for k in range(1, drive.orders + 1):
        sine_part, cosine_part, inverse = table[sines, k], table[cosines, k], INVERSE[k]
        value, change = (
            sine_part * sine + cosine_part * cosine,
            sine_part * cosine - cosine_part * sine,
        )
        slope += k * change
        push += value
        first -= change * inverse
        second -= value * (inverse * inverse)
        sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
    return slope, push, first, second


@borrowing
def velocity_from(
    drive: WaveDrive, kind: int, start_velocity: float, tau: float, push_integral: float, d: float
) -> tuple[float, float, float]:
    """Return velocity, acceleration and its derivative of a part after a phase `d`, under a wave.

    v - k D + P1(tau + D) - P1(tau), p(tau + D) - k and p'(tau + D), with the push p, its integral
    P1 and the pull k; `push_integral` is P1(tau).
    """
    if drive.steps > 0:
        net_push = acceleration(drive, kind, tau + d)
        return stepped_flow(drive, kind, start_velocity, tau, d)[0], net_push, 0.0
    pull = drive.table[PULLS, kind]
    slope, push, integral, _ = integrals(drive, kind, tau + d)
    return start_velocity - pull * d + (integral - push_integral), push - pull, slope


@borrowing
def push_integral_at(drive: WaveDrive, kind: int, tau: float) -> float:
    """Return the integral P1(tau) of a kind's push that `velocity_from` takes as `start`."""
    return 0.0 if drive.steps > 0 else integrals(drive, kind, tau)[2]


@borrowing
def flow(drive: WaveDrive, kind: int, v: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance of a part after a phase `d` in one mode of motion, under a wave.

    u = v - k D + P1(tau + D) - P1(tau), x = v D - k D^2/2 + P2(tau + D) - P2(tau) - P1(tau) D, with
    the first and second integral P1, P2 of the push. Short flows come from series, against
    cancellation (theory 13.14).
    """
    if drive.steps > 0:
        return stepped_flow(drive, kind, v, tau, d)
    pull = drive.table[PULLS, kind]
    velocity, distance = v - pull * d, v * d - 0.5 * pull * d * d
    if drive.orders * d < NEAR:
        velocity_gain, distance_gain = short_flow(drive, kind, tau, d)
        return velocity + velocity_gain, distance + distance_gain
    # As differences of the integrals: a long flow loses nothing by them.
    _, _, first, second = integrals(drive, kind, tau)
    _, _, first_after, second_after = integrals(drive, kind, tau + d)
    return velocity + (first_after - first), distance + (second_after - second - first * d)


@borrowing
def short_flow(drive: WaveDrive, kind: int, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance that the push of a wave gives over a short phase `d`.

    A term of order k, value p and derivative over k p', turns by K = k D and gives (p sin K + p' (1
    - cos K))/k and (p (1 - cos K) + p' (K - sin K))/k^2.
    """
    table, sines, cosines = drive.table, 2 * kind, 2 * kind + 1
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine, velocity, distance = sine_1, cosine_1, 0.0, 0.0
    for k in range(1, drive.orders + 1):
        sine_part, cosine_part, angle = table[sines, k], table[cosines, k], k * d
        value, change = (
            sine_part * sine + cosine_part * cosine,
            sine_part * cosine - cosine_part * sine,
        )
        cubic, square = arc_terms(angle)
        velocity += (value * (angle - cubic) + change * square) * INVERSE[k]
        distance += (value * square + change * cubic) * (INVERSE[k] * INVERSE[k])
        sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
    return velocity, distance


@borrowing
def stepped_flow(
    drive: WaveDrive, kind: int, v: float, tau: float, d: float
) -> tuple[float, float]:
    """Return velocity and distance of a part after a phase `d` in one mode, under a drive in steps.

    In each step x -> x + (v + a D/2) D and v -> v + a D (theory 13.14).
    """
    table, pull = drive.table, drive.table[PULLS, kind]
    phase, remaining, distance = within_turn(tau), d, 0.0
    step = step_at(drive, phase)
    while True:
        end = table[ENDS, step]
        span = max(0.0, min(end - phase, remaining))
        net_push = table[2 * kind, step] - pull
        distance += (v + 0.5 * net_push * span) * span
        v += net_push * span
        remaining -= span
        if remaining <= 0.0:
            return v, distance
        step += 1
        phase = end
        if step == drive.steps:
            step, phase = 0, 0.0


@borrowing
def zero_of_velocity(
    drive: WaveDrive, kind: int, start_velocity: float, tau: float, push_integral: float,
    low: float, high: float, velocity_at_low: float, velocity_at_high: float,
) -> float:  # fmt: skip
    """Return the phase between `low` and `high` at which a monotonic velocity under a wave is 0."""
    # Halley's steps within the bracket, else halving; `push_integral` is that of `velocity_from`.
    rises = velocity_at_high > velocity_at_low
    d = (
        low + (high - low) * velocity_at_low / (velocity_at_low - velocity_at_high)
        if velocity_at_low * velocity_at_high < 0.0
        else 0.5 * (low + high)
    )
    for _ in range(MAX_ITERATIONS):
        velocity, net_push, slope = velocity_from(
            drive, kind, start_velocity, tau, push_integral, d
        )
        if (velocity > 0.0) == rises:
            high = d
        else:
            low = d
        next_d = d - halley(velocity, net_push, slope)
        is_small_step = low <= next_d <= high and abs(next_d - d) <= LAST_STEP * d
        if is_small_step and is_near_root(velocity, net_push, slope, LAST_STEP):
            return next_d
        if not low < next_d < high:
            next_d = 0.5 * (low + high)
            if next_d in (low, high):
                return next_d
        d = next_d
    return d


@compiled
def rounded(drive: WaveDrive) -> WaveDrive:
    """Return the drive unchanged: waves are not rounded."""
    return drive
