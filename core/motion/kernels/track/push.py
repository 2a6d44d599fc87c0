"""The table of a step in space, and the drive: the series of its push, lift-offs, jumps."""

import math
from collections import namedtuple
from typing import TypeAlias

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled
from vibrafeed.core.motion.kernels.inputs import GROUPS, Cell, Flags, Floats
from vibrafeed.core.motion.kernels.sine_sums import SineSum, passages, value_and_slope, wave_columns

TURN = 2.0 * math.pi
MAX_ORDER = 24
"""Of the series: those of order 16 are judged by those of order 24."""
INVERSE = np.array([math.inf, *(1.0 / k for k in range(1, MAX_ORDER + 2))])
"""1/k, by which a term is integrated: a division takes four times as long as a product."""


State = namedtuple("State", "x y z ux uy uz spin")
"""Columns of a state: place, velocity relative to the track, and spin.

The spin of a cylinder is the velocity across that it gives the lowest point.
"""

Hold = namedtuple("Hold", "contacts slips event")
"""Columns of what holds a part: its contacts, whether they slip, the event before."""


FREE, FLOOR, WALL, BOTH = 0, 1, 2, 3
"""Contacts that carry the part: the floor is bit 0, the wall bit 1."""

Event = namedtuple("Event", "nothing start lift land leave bump stop slip press release seat")
"""Ends of a stretch of motion.

`nothing` where the series had to be made anew; `seat` where the floor, or `press` where the wall,
comes to carry a part that touches it at rest; `release` where the wall ceases to carry one that the
floor holds; `leave` where a part that slips loses the wall.
"""


STATE = State(*range(len(State._fields)))
HOLD = Hold(*range(len(Hold._fields)))
EVENT = Event(*range(len(Event._fields)))

Row = namedtuple(
    "Row",
    "free track velocity place slip square load extra event scratch lifts wave sines cosines "
    "levels speeds rows",
)
"""First rows of the table of a step: series in powers of the phase since its start.

Accelerations without contacts (`free`), velocities and places have rows along, across and normal;
`track` is its velocity along itself; `slip` of the contact that slips has two rows, `square` is its
size and `load` the contact's; seven rows `extra` serve one function only; `event` turns negative at
an event, and `scratch` is a copy that its search destroys. No series: `lifts`, how many times a
period the floor loses a part, and the phases; `wave`, harmonics, steps and speed of the drive;
`sines`, `cosines` by order; `levels`, with a fourth row of the phases at which steps end; `speeds`
of the track at their starts. One table, since a call hands on each array at a price.
"""

ROW = Row(0, 3, 4, 7, 10, 12, 13, 14, 21, 22, 23, 24, 25, 28, 31, 35, 36)
Work: TypeAlias = Floats
"""The table of a step."""


@compiled
def new_work() -> Work:
    """Return the table for the series of a step, a row for each quantity of `ROW`; zeros."""
    return np.zeros((ROW.rows, MAX_ORDER + 2))


@compiled
def at_rest() -> tuple[Floats, Flags]:
    """Return state and contacts of a part at rest on the floor that touches the wall."""
    hold = np.zeros(len(HOLD), dtype=np.int64)
    hold[HOLD.event] = EVENT.start
    return np.zeros(len(STATE)), hold


LATE = 1e-13
"""Phase in rad: a lift-off so little behind a part that is on the floor is due now."""

ORDERS, STEPS, SIZE = range(3)
"""Columns of `ROW.wave`: harmonics and steps of the wave, and the speed of the track."""


@borrowing
def set_drive(cell: Cell, row: Floats, work: Work) -> None:
    """Fill the rows of the drive in the table `work` of a step, from a cell's row of numbers.

    A sine lifts a part off at sin(tau) = n/p_z; not if |p_z| <= n (theory 13.3).
    """
    work[ROW.wave, ORDERS], work[ROW.wave, STEPS] = 0.0, 0.0
    work[ROW.lifts, 0] = 0.0
    if row.size > GROUPS:
        read_wave(cell, row, work)
        return
    work[ROW.wave, SIZE] = math.sqrt(
        cell.drive_number_along**2 + cell.drive_number_across**2 + cell.drive_number_normal**2
    )
    gravity_normal, push_normal = cell.gravity_number_normal, cell.drive_number_normal
    if abs(push_normal) > gravity_normal:
        phase = math.asin(gravity_normal / abs(push_normal))
        work[ROW.lifts, 0], work[ROW.lifts, 1] = (
            1.0,
            phase if push_normal > 0.0 else phase + math.pi,
        )


@borrowing
def read_wave(cell: Cell, row: Floats, work: Work) -> None:
    """Fill coefficients, size and lift-off phases of a wave into the table `work` of a step."""
    columns = wave_columns(row, GROUPS)
    orders, steps = columns.orders, columns.steps
    work[ROW.wave, ORDERS], work[ROW.wave, STEPS] = row[GROUPS], row[GROUPS + 1]
    square = 0.0
    for axis in range(3):
        speed = 0.0
        for k in range(1, orders + 1):
            column = columns.along + 2 * axis * orders + k - 1
            sine, cosine = row[column], row[column + orders]
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

    v -> v - p D over a step with push p and duration D, less the mean over the period; the largest
    size is returned (theory 13.14).
    """
    level, end, speed = ROW.levels + axis, ROW.levels + 3, ROW.speeds
    begin, velocity, mean, largest = 0.0, 0.0, 0.0, 0.0
    for step in range(steps):
        duration = work[end, step] - begin
        work[speed, step] = velocity
        mean += (velocity - 0.5 * work[level, step] * duration) * duration
        velocity -= work[level, step] * duration
        begin = work[end, step]
    for step in range(steps):
        work[speed, step] -= mean / TURN
        largest = max(largest, abs(work[speed, step]))
    return largest


@borrowing
def fill_lift_offs(gravity_normal: float, orders: int, work: Work) -> None:
    """Fill row `ROW.lifts`: the number of lift-offs, then the phases where S rises through n."""
    push, lifts = SineSum(work, ROW.sines + 2, ROW.cosines + 2, orders), ROW.lifts
    crossing_count = passages(push, gravity_normal, lifts, MAX_ORDER)
    # Of all crossings those stay at which the push rises: written over the row's start, in order.
    lift_off_count = 0
    for number in range(1, crossing_count + 1):
        phase = work[lifts, number]
        if value_and_slope(push, phase)[1] > 0.0:
            lift_off_count += 1
            work[lifts, lift_off_count] = phase
    work[lifts, 0] = float(lift_off_count)


@borrowing
def drive_speed(work: Work) -> float:
    """Return the amplitude of the drive's velocity, |(p_x, p_y, p_z)|, or a bound for a wave."""
    return work[ROW.wave, SIZE]


@borrowing
def sine_slope(work: Work, tau: float) -> float:
    """Return the derivative of the push by phase over its amplitude, cos(tau); NaN for a wave."""
    return math.nan if is_wave(work) else math.cos(tau)


@borrowing
def fill_push(cell: Cell, tau: float, order: int, work: Work) -> None:
    """Fill the power series of the push of the drive on a part, and of the track's velocity."""
    if work[ROW.wave, ORDERS] > 0.0:
        fill_harmonics(tau, order, work)
        return
    if work[ROW.wave, STEPS] > 0.0:
        fill_step(tau, order, work)
        return
    along, across = cell.drive_number_along, cell.drive_number_across
    normal = cell.drive_number_normal
    sine_term, cosine_term = math.sin(tau), math.cos(tau)
    push = ROW.free
    work[ROW.track, 0] = along * cosine_term
    for k in range(order + 1):
        work[push, k], work[push + 1, k] = along * sine_term, across * sine_term
        work[push + 2, k] = normal * sine_term
        sine_term, cosine_term = sine_term * INVERSE[k + 1], cosine_term * INVERSE[k + 1]
        work[ROW.track, k + 1] = -along * sine_term
        sine_term, cosine_term = cosine_term, -sine_term


@borrowing
def fill_harmonics(tau: float, order: int, work: Work) -> None:
    """Fill the power series of push and track velocity, for a drive that is a sum of sines.

    The n-th derivative of s sin(k tau) + c cos(k tau) is k^n times the term, its quarter turn,
    minus the term, and so on; the track has the velocity sum of (s cos(k tau) - c sin(k tau))/k
    (theory 13.14).
    """
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine = sine_1, cosine_1
    for axis in range(3):
        for n in range(order + 1):
            work[ROW.free + axis, n] = 0.0
    speed = 0.0
    for k in range(1, int(work[ROW.wave, ORDERS]) + 1):
        for axis in range(3):
            sine_part, cosine_part = work[ROW.sines + axis, k], work[ROW.cosines + axis, k]
            if sine_part == 0.0 and cosine_part == 0.0:
                continue
            value, change = (
                sine_part * sine + cosine_part * cosine,
                sine_part * cosine - cosine_part * sine,
            )
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
    """Return the index of the drive's step at phase `tau` in rad, the first with tau < its end."""
    last = int(work[ROW.wave, STEPS]) - 1
    for step in range(last):
        if tau < work[ROW.levels + 3, step]:
            return step
    return last


@borrowing
def fill_step(tau: float, order: int, work: Work) -> None:
    """Fill the power series of push and track velocity at phase `tau`, for a drive in steps."""
    step = step_at(tau, work)
    for axis in range(3):
        work[ROW.free + axis, 0] = work[ROW.levels + axis, step]
        for n in range(1, order + 1):
            work[ROW.free + axis, n] = 0.0
    # The row of ends follows the three of levels; the speed is that at the start of the step.
    elapsed = tau - (work[ROW.levels + 3, step - 1] if step > 0 else 0.0)
    for n in range(order + 2):
        work[ROW.track, n] = 0.0
    work[ROW.track, 0] = work[ROW.speeds, step] - work[ROW.levels, step] * elapsed
    work[ROW.track, 1] = -work[ROW.levels, step]


@borrowing
def next_jump(tau: float, work: Work) -> float:
    """Return the phase of the next jump of the push, 2 pi (the end of the period) without any."""
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
    """Return the phase in rad from `tau` until a part on the floor lifts off; infinite if never."""
    least = math.inf
    for number in range(int(work[ROW.lifts, 0])):
        phase_ahead = work[ROW.lifts, number + 1] - tau
        if phase_ahead < 0.0:
            phase_ahead = 0.0 if phase_ahead > -LATE else phase_ahead + TURN
        least = min(least, phase_ahead)
    return least
