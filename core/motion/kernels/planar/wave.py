"""A wave: sums of sines, or steps, as the drive of planar motion, and its flow in closed form.

In every mode the part has an acceleration of the form push(tau) - pull, where the push is a sum of
sines or constant from step to step: off the floor that of the normal direction; along the track
that of the air, and, with friction on the load, those of slips forward and backward, at the kinetic
and at the static coefficient. Each is a `kind`, a few rows of one table.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.flow import TURN, arc
from core.motion.kernels.planar.tables import GROUPS, Cell
from core.motion.kernels.waves import passages, value_and_slope

NORMAL, AIR, FORWARD, BACKWARD, STATIC_FORWARD, STATIC_BACKWARD = range(6)
"""Kinds of acceleration."""

KINDS = 6
WIDTH = 26
"""Columns of the table: orders from 1, steps from 0, or a count and passages from 1."""
PULLS, ENDS, ROOTS = 2 * KINDS, 2 * KINDS + 1, 2 * KINDS + 2
"""Rows behind those of the coefficients: pulls by kind, ends of steps, and from `ROOTS` on, by
kind, the phases at which its acceleration changes sign. A kind's rows are those of its sines and
its cosines, or, of steps, of its pushes."""
RISES = WIDTH - 1
"""Column of a row of passages: whether the acceleration rises at the first of them."""
NEAR = 0.7
"""Of the phase of the highest order: a flow so short is computed from series."""
SLACK = 1e-13
"""Of a phase: what is so little behind counts as now."""


class Wave(NamedTuple):
    """A wave with gravity and friction; the table is as above.

    `forward` and `backward` are the kinds of slip at the static coefficient: those at the kinetic
    one where both are equal.
    """

    table: Floats
    orders: int
    steps: int
    gs: float
    gn: float
    mu_s: float
    mu_k: float
    along: float
    normal: float
    forward: int
    backward: int


@compiled
def new_table() -> Floats:
    """Return room for a wave."""
    return np.zeros((ROOTS + KINDS, WIDTH))


@compiled
def wave_of(cell: Cell, row: Floats, table: Floats) -> Wave:
    """Return the wave of a row, which stands there behind the cell; fill the table."""
    orders, steps = int(row[GROUPS]), int(row[GROUPS + 1])
    gs, gn = cell.gravity_number_along, cell.gravity_number_normal
    mu_s, mu_k = cell.friction_static, cell.friction_kinetic
    alike = mu_s == mu_k
    drive = Wave(
        table, orders, steps, gs, gn, mu_s, mu_k,
        abs(cell.drive_number_along), abs(cell.drive_number_normal),
        FORWARD if alike else STATIC_FORWARD, BACKWARD if alike else STATIC_BACKWARD,
    )  # fmt: skip
    at = GROUPS + 2
    if steps > 0:
        at += 6 * orders
        table[ENDS, :steps] = row[at + 3 * steps : at + 4 * steps]
        fill_kinds(drive, row[at : at + steps], row[at + 2 * steps : at + 3 * steps], 0)
    else:
        for part in range(2):  # sines, cosines
            along, normal = at + part * orders, at + (4 + part) * orders
            fill_kinds(drive, row[along : along + orders], row[normal : normal + orders], part)
    for kind in range(KINDS if not alike else STATIC_FORWARD):
        if kind != AIR:
            fill_passages(drive, kind)
    return drive


@compiled
def fill_kinds(drive: Wave, along: Floats, normal: Floats, part: int) -> None:
    """Fill one row of every kind, and its pull, from the pushes along and normal to the floor."""
    table, first = drive.table, 1 if drive.steps == 0 else 0
    for kind in range(KINDS):
        friction, push, pull = 0.0, 1.0, drive.gs
        if kind == NORMAL:
            friction, push, pull = 1.0, 0.0, drive.gn
        elif kind != AIR:
            friction = drive.mu_k if kind in (FORWARD, BACKWARD) else drive.mu_s
            friction = friction if kind in (FORWARD, STATIC_FORWARD) else -friction
            pull += friction * drive.gn
        table[PULLS, kind] = pull
        for k in range(along.size):
            table[2 * kind + part, first + k] = push * along[k] + friction * normal[k]


@compiled
def fill_passages(drive: Wave, kind: int) -> None:
    """Fill the phases in [0, 2 pi) at which the acceleration of a kind changes sign."""
    table, row = drive.table, ROOTS + kind
    if drive.steps == 0:
        sines, pull = 2 * kind, table[PULLS, kind]
        count = passages(table, sines, sines + 1, drive.orders, pull, row, RISES - 1)
        table[row, 0] = float(count)
        if count > 0:
            slope = value_and_slope(table, sines, sines + 1, drive.orders, table[row, 1])[1]
            table[row, RISES] = 1.0 if slope > 0.0 else 0.0
        return
    count, last = 0, drive.steps - 1
    for step in range(drive.steps):
        # At the start of a step: the first follows on the last.
        before = table[2 * kind, step - 1 if step > 0 else last] > table[PULLS, kind]
        after = table[2 * kind, step] > table[PULLS, kind]
        if before != after:
            count += 1
            table[row, count] = table[ENDS, step - 1] if step > 0 else 0.0
            if count == 1:
                table[row, RISES] = 1.0 if after else 0.0
    table[row, 0] = float(count)


@compiled
def step_at(drive: Wave, tau: float) -> int:
    """Return the number of the step at a phase in [0, 2 pi); a hair before its start is in it."""
    for step in range(drive.steps - 1):
        if tau < drive.table[ENDS, step] - SLACK:
            return step
    return drive.steps - 1


@compiled
def acceleration(drive: Wave, kind: int, tau: float) -> float:
    """Return the acceleration of a kind at a phase."""
    table = drive.table
    if drive.steps > 0:
        return table[2 * kind, step_at(drive, tau % TURN)] - table[PULLS, kind]
    value, _ = value_and_slope(table, 2 * kind, 2 * kind + 1, drive.orders, tau)
    return value - table[PULLS, kind]


@compiled
def next_passage(drive: Wave, kind: int, tau: float) -> tuple[float, bool]:
    """Return the phase from tau on at which an acceleration changes sign; whether it rises there.

    Infinite if it never does. What is a hair behind is told as tau itself.
    """
    row = drive.table[ROOTS + kind]
    count = int(row[0])
    if count == 0:
        return math.inf, False
    within = tau % TURN
    start, rises = tau - within, row[RISES] > 0.0
    for number in range(1, count + 1):
        if row[number] >= within - SLACK:
            return max(tau, start + row[number]), rises
        rises = not rises
    rises = row[RISES] > 0.0
    return max(tau, start + TURN + row[1]), rises


@compiled
def later_passage(drive: Wave, kind: int, tau: float) -> tuple[float, bool]:
    """Return what `next_passage` does, of the passages beyond tau."""
    return next_passage(drive, kind, tau + 2.0 * SLACK * (1.0 + tau))


@compiled
def next_of_way(drive: Wave, kind: int, tau: float, rising: bool) -> float:
    """Return the first phase from tau on at which an acceleration rises, or falls, through 0."""
    at, rises = next_passage(drive, kind, tau)
    if rises != rising and at < math.inf:
        at, rises = later_passage(drive, kind, at)
    return at if rises == rising else math.inf


@compiled
def flow(drive: Wave, kind: int, v: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance a phase d after the velocity was v, in a mode of a kind."""
    if drive.steps > 0:
        return stepped_flow(drive, kind, v, tau, d)
    table, sines, cosines, orders = drive.table, 2 * kind, 2 * kind + 1, drive.orders
    pull = table[PULLS, kind]
    velocity, distance = v - pull * d, v * d - 0.5 * pull * d * d
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine = sine_1, cosine_1
    if orders * d < NEAR:
        for k in range(1, orders + 1):
            a, b, turned = table[sines, k], table[cosines, k], k * d
            value, change = a * sine + b * cosine, a * cosine - b * sine
            cubic, square = arc(turned)
            velocity += (value * (turned - cubic) + change * square) / k
            distance += (value * square + change * cubic) / (k * k)
            sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
        return velocity, distance
    # As differences of the integrals: a long flow loses nothing by them.
    after_1, beyond_1 = math.sin(tau + d), math.cos(tau + d)
    after, beyond = after_1, beyond_1
    for k in range(1, orders + 1):
        a, b, part = table[sines, k], table[cosines, k], 1.0 / k
        value, change = a * sine + b * cosine, a * cosine - b * sine
        last, turn = a * after + b * beyond, a * beyond - b * after
        velocity += (change - turn) * part
        distance += (change * d + (value - last) * part) * part
        sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
        after, beyond = after * beyond_1 + beyond * after_1, beyond * beyond_1 - after * after_1
    return velocity, distance


@compiled
def stepped_flow(drive: Wave, kind: int, v: float, tau: float, d: float) -> tuple[float, float]:
    """Return what `flow` does where the acceleration is constant from step to step.

    Whole periods change nothing but by the pull.
    """
    table, pull = drive.table, drive.table[PULLS, kind]
    at, left, distance = tau % TURN, d, 0.0
    step = step_at(drive, at)
    while True:
        end = table[ENDS, step]
        span = max(0.0, min(end - at, left))
        force = table[2 * kind, step] - pull
        distance += (v + 0.5 * force * span) * span
        v += force * span
        left -= span
        if left <= 0.0:
            return v, distance
        step += 1
        at = end
        if step == drive.steps:
            step, at = 0, 0.0


@compiled
def rounded(drive: Wave) -> Wave:
    """Return the drive: what its passages are made from keeps all bits."""
    return drive
