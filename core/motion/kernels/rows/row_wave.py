"""A wave as the drive of a row (theory 17.3).

Every acceleration is a P(tau) + b S(tau) - k with the pushes P along and S normal to the floor: a
body in the air has the shares (1, 0), one that slides (1, mode mu), one at rest none.
"""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.planar.flow import (
    AIR,
    BACKWARD,
    FORWARD,
    MAX_PIECES,
    NORMAL,
    STATIC_BACKWARD,
    STATIC_FORWARD,
    TURN,
)
from vibrafeed.core.motion.kernels.planar.wave import (
    ENDS,
    INVERSE,
    KINDS,
    PULLS,
    ROOTS,
    TABLE,
    WaveDrive,
    acceleration,
    fill_passages,
    flow,
    integrals,
    later_passage,
    next_crossing,
    next_passage,
    push_integral_at,
    push_of,
    step_at,
    zero_of_velocity,
)
from vibrafeed.core.motion.kernels.planar.wave_motion import (
    landing,
    landing_root,
    stop_after,
    track_speed,
)
from vibrafeed.core.motion.kernels.rows.row_sine import RESOLVED, ROUNDING, SAME
from vibrafeed.core.motion.kernels.rows.row_state import AT, Row, columns_of
from vibrafeed.core.motion.kernels.sine_sums import value_and_slope

SLOPE = math.inf
"""A pull that stands for none: the derivative of the push is asked for."""


class RowWave(NamedTuple):
    """A wave that drives a row.

    As in `Drive`, with upper bounds of the pushes and `levels` 0. `base` holds the pushes;
    `tables[j]` is room for the kinds of acceleration of body j, each made of the factors and the
    pull in `keys[j]`. `normal_factor[j]` is that of the normal push in its acceleration.
    """

    push_along: float
    push_normal: float
    gravity_along: float
    gravity_normal: float
    ends: Floats
    levels: Floats
    base: WaveDrive
    tables: Floats
    keys: Floats
    normal_factor: Floats


DriveIntegrals = namedtuple(
    "DriveIntegrals", "velocity_along distance_along velocity_normal distance_normal"
)
"""What both pushes add to velocity and distance over a phase."""


@compiled
def wave_drive_of(cell: Floats) -> RowWave:
    """Return the drive of a row as a wave: sums of sines or steps along and normal to the floor."""
    columns, bodies = columns_of(cell), int(cell[AT.parts]) + 1
    orders, steps = columns.orders, columns.steps
    table, largest, ends = np.zeros(TABLE), np.zeros(2), np.array([2.0 * np.pi])
    if steps > 0:
        ends = cell[columns.ends : columns.ends + steps].copy()
        for step in range(steps):
            along, normal = cell[columns.levels + step], cell[columns.normal_levels + step]
            _fill_pushes(table, 0, step, along, normal)
        table[ENDS, :steps] = ends
        largest[0] = np.abs(table[2 * AIR, :steps]).max()
        largest[1] = np.abs(table[2 * NORMAL, :steps]).max()
    for k in range(orders if steps == 0 else 0):
        for is_cosine in range(2):
            index = is_cosine * orders + k
            along, normal = cell[columns.along + index], cell[columns.normal + index]
            _fill_pushes(table, is_cosine, k + 1, along, normal)
        largest[0] += math.hypot(table[2 * AIR, k + 1], table[2 * AIR + 1, k + 1])
        largest[1] += math.hypot(table[2 * NORMAL, k + 1], table[2 * NORMAL + 1, k + 1])
    gravity_along, gravity_normal = cell[AT.gravity_number_along], cell[AT.gravity_number_normal]
    table[PULLS, AIR], table[PULLS, NORMAL] = gravity_along, gravity_normal
    along, normal = largest[0], largest[1]
    base = WaveDrive(table, orders, steps, gravity_along, gravity_normal, 0.0, 0.0, along, normal)
    if steps > 0 or normal > gravity_normal:
        fill_passages(base, NORMAL)
    tables = np.zeros((bodies, TABLE[0], TABLE[1]))
    tables[:, ENDS, :] = table[ENDS, :]
    keys = np.full((bodies, KINDS, 3), np.nan)
    return RowWave(
        along,
        normal,
        gravity_along,
        gravity_normal,
        ends,
        np.zeros(ends.size),
        base,
        tables,
        keys,
        np.zeros(bodies),
    )


@borrowing
def _fill_pushes(table: Floats, part: int, column: int, along: float, normal: float) -> None:
    table[2 * AIR + part, column] = table[2 * FORWARD + part, column] = along
    table[2 * NORMAL + part, column] = table[2 * BACKWARD + part, column] = normal


@borrowing
def combined_wave(
    drive: RowWave, body: int, kind: int, along: float, normal: float, pull: float
) -> WaveDrive:
    """Return the wave with the acceleration a P(tau) + b S(tau) - k, its sign changes filled.

    It goes into row set `kind` of the table of `body`; if that holds the same already, nothing is
    computed. With the pull `SLOPE` it is the derivative of the sums.
    """
    # P and S are the pushes along and normal. In a table, rows 2 kind and 2 kind + 1 hold the sines
    # and cosines by order, or row 2 kind the levels of the steps.
    base = drive.base
    wave = WaveDrive(
        drive.tables[body], base.orders, base.steps, base.gravity_along, base.gravity_normal,
        base.mu_s, base.mu_k, base.push_along, base.push_normal,
    )  # fmt: skip
    stored = drive.keys[body, kind]
    if stored[0] == along and stored[1] == normal and stored[2] == pull:
        return wave
    stored[0], stored[1], stored[2] = along, normal, pull
    table, push_table = wave.table, base.table
    table[PULLS, kind] = 0.0 if pull == SLOPE else pull
    if base.steps > 0:
        for step in range(base.steps):
            table[2 * kind, step] = (
                along * push_table[2 * AIR, step] + normal * push_table[2 * NORMAL, step]
            )
        fill_passages(wave, kind)
        return wave
    size = 0.0
    for k in range(1, base.orders + 1):
        sine_part = along * push_table[2 * AIR, k] + normal * push_table[2 * NORMAL, k]
        cosine_part = along * push_table[2 * AIR + 1, k] + normal * push_table[2 * NORMAL + 1, k]
        if pull == SLOPE:
            sine_part, cosine_part = -k * cosine_part, k * sine_part
        table[2 * kind, k], table[2 * kind + 1, k] = sine_part, cosine_part
        size += math.sqrt(sine_part * sine_part + cosine_part * cosine_part)
    table[ROOTS + kind, 0] = 0.0
    if size > abs(table[PULLS, kind]):
        fill_passages(wave, kind)
    return wave


# --- the drive itself


@borrowing
def pushes(drive: RowWave, pull: float, tau: float) -> tuple[float, float]:
    """Return the push along, P - `pull`, and the load on the floor, n - S, at least 0, in g."""
    push = acceleration(drive.base, FORWARD, tau) - pull
    return push, max(0.0, -acceleration(drive.base, NORMAL, tau))


@borrowing
def lift_off(drive: RowWave, tau: float) -> float:
    """Return the phase in rad from `tau` until parts lift off, where S - n rises through 0."""
    return _until_rise(drive.base, NORMAL, tau)


@borrowing
def _until_rise(wave: WaveDrive, kind: int, tau: float) -> float:
    # A rise a hair before tau is at tau: of two neighbours whose frictions differ by a last bit the
    # second would else start a turn later.
    next_turn = tau + TURN
    return max(0.0, next_crossing(wave, kind, next_turn - SAME, True) - next_turn)


@borrowing
def is_lifted(drive: RowWave, tau: float) -> bool:
    """True if parts on the floor lift off at a phase: S > n."""
    return acceleration(drive.base, NORMAL, tau) > 0.0


@borrowing
def flight(drive: RowWave, tau: float) -> tuple[float, float]:
    """Return duration in rad and landing speed in g/w of a flight from rest at phase `tau`."""
    span = landing(drive.base, 0.0, tau)
    if span < 0.0:
        return math.inf, 0.0
    return span, -flow(drive.base, NORMAL, 0.0, tau, span)[0]


@compiled
def backward_speed(drive: RowWave) -> float:
    """Return the velocity relative to the track, at phase 0, of a body at rest in space."""
    return -track_speed(drive.base, 0.0)


@borrowing
def first_rise(
    drive: RowWave, body: int, direction: int, along: float, normal: float, level: float, tau: float
) -> float:
    """Return the phase in rad until `along` P + `normal` S rises above `level`; inf if never."""
    # P and S are the pushes along and normal; each direction has its own room in the tables.
    kind = STATIC_FORWARD if direction > 0 else STATIC_BACKWARD
    wave = combined_wave(drive, body, kind, along, normal, level)
    return _until_rise(wave, kind, tau)


# --- parts


@borrowing
def set_acceleration(
    row: Row, drive: RowWave, body: int, moves: bool, friction: float, pull: float
) -> None:
    """Set factors and pull of a body's acceleration a P + b S - k: 0 unless it `moves`."""
    row.push_factor[body], row.pull[body] = 1.0 if moves else 0.0, pull
    drive.normal_factor[body] = friction if moves else 0.0


@borrowing
def at_phase(drive: RowWave, tau: float) -> float:
    """Return the phase, which is all that the searches below share."""
    return tau


@borrowing
def stop_until(row: Row, drive: RowWave, part: int, phase_now: float, span: float) -> float:
    """Return the phase in rad until a sliding part's velocity is 0; inf if not within `span`."""
    velocity, direction, k = row.speed[part], row.mode[part], row.pull[part]
    a, b = row.push_factor[part], drive.normal_factor[part]
    largest_change = (abs(a) * drive.push_along + abs(b) * drive.push_normal + direction * k) * span
    if direction * velocity - largest_change > ROUNDING * (abs(velocity) + abs(largest_change)):
        return math.inf
    kind = FORWARD if direction > 0 else BACKWARD
    wave = combined_wave(drive, part, kind, a, b, k)
    to_passage, acceleration_ahead = (
        next_passage(wave, kind, phase_now)[0] - phase_now,
        direction * acceleration(wave, kind, phase_now),
    )
    if to_passage > SAME:
        if acceleration_ahead > 0.0 and to_passage >= span:
            return math.inf
        # It moves no more, or its neighbour's stop has turned it a hair: it is no start, of which
        # the acceleration is 0, or passes through 0 now, but for rounding.
        if direction * velocity <= 0.0 and acceleration_ahead < -RESOLVED:
            return 0.0
    until = stop_after(wave, float(direction), velocity, phase_now, span)
    return until if until >= 0.0 else math.inf


@borrowing
def contact_until(row: Row, drive: RowWave, contact: int, phase_now: float, span: float) -> float:
    """Return the phase in rad until a gap in a row closes; inf if not within `span`.

    As under a sine, between two phases at which a P + b S - k changes sign (theory 17.3).
    """
    rear, front = contact, contact + 1
    a, b = (
        row.push_factor[front] - row.push_factor[rear],
        drive.normal_factor[front] - drive.normal_factor[rear],
    )
    k, gap_rate = row.pull[front] - row.pull[rear], row.speed[front] - row.speed[rear]
    gap, steady = row.gap[contact], a == 0.0 and b == 0.0 and k == 0.0
    if steady and gap_rate >= 0.0:
        return math.inf
    largest_push = abs(a) * drive.push_along + abs(b) * drive.push_normal
    approach, largest_loss = (
        min(gap_rate, 0.0) * span,
        max(largest_push + k, 0.0) * span * span / 2.0,
    )
    if gap + approach - largest_loss > ROUNDING * (gap - approach + largest_loss):
        return math.inf
    wave = combined_wave(drive, contact, NORMAL, a, b, k)
    rounding = 1e-15 * (largest_push + abs(k) + abs(gap_rate))
    low, rate_at_low, gap_at_low, push_integral = (
        0.0,
        gap_rate,
        gap,
        push_integral_at(wave, NORMAL, phase_now),
    )
    for _ in range(MAX_PIECES):
        high = min(span, later_passage(wave, NORMAL, phase_now + low)[0] - phase_now)
        rate_at_high, distance_at_high = flow(wave, NORMAL, gap_rate, phase_now, high)
        if rate_at_low < 0.0 < rate_at_high and gap_at_low + rate_at_low * (
            high - low
        ) <= ROUNDING * (gap_at_low + abs(distance_at_high)):
            least_phase = zero_of_velocity(
                wave,
                NORMAL,
                gap_rate,
                phase_now,
                push_integral,
                low,
                high,
                rate_at_low,
                rate_at_high,
            )
            if gap + flow(wave, NORMAL, gap_rate, phase_now, least_phase)[1] < -rounding:
                return _contact_between(wave, gap, gap_rate, phase_now, low, least_phase)
        if gap + distance_at_high < -rounding:
            if rate_at_high < 0.0 < rate_at_low:  # it opens before it closes
                low = zero_of_velocity(
                    wave,
                    NORMAL,
                    gap_rate,
                    phase_now,
                    push_integral,
                    low,
                    high,
                    rate_at_low,
                    rate_at_high,
                )
            return _contact_between(wave, gap, gap_rate, phase_now, low, high)
        if high == span:
            break
        low, rate_at_low, gap_at_low = high, rate_at_high, gap + distance_at_high
    return math.inf


@borrowing
def _contact_between(
    wave: WaveDrive, gap: float, gap_rate: float, tau: float, low: float, high: float
) -> float:
    if low == 0.0 and gap <= 0.0:
        return 0.0
    return landing_root(wave, gap, gap_rate, tau, low, high)


@borrowing
def relative_push(row: Row, drive: RowWave, contact: int, tau: float) -> float:
    """Return the drive's part in the relative acceleration of two neighbours in a row, in g."""
    a = row.push_factor[contact + 1] - row.push_factor[contact]
    b = drive.normal_factor[contact + 1] - drive.normal_factor[contact]
    push_along, push_normal = (
        acceleration(drive.base, FORWARD, tau),
        acceleration(drive.base, BACKWARD, tau),
    )
    return a * push_along + b * push_normal


@borrowing
def drive_integrals(drive: RowWave, tau: float, span: float) -> DriveIntegrals:
    """Return velocities and distances that both pushes add over `span` rad from phase `tau`."""
    velocity_along, distance_along = flow(drive.base, FORWARD, 0.0, tau, span)
    velocity_normal, distance_normal = flow(drive.base, BACKWARD, 0.0, tau, span)
    return DriveIntegrals(velocity_along, distance_along, velocity_normal, distance_normal)


@borrowing
def change_over_span(
    row: Row, drive: RowWave, body: int, integrals: DriveIntegrals, span: float
) -> tuple[float, float]:
    """Return the change of velocity and of position of a body over a phase, in g/w and g/w^2."""
    a, b, k = row.push_factor[body], drive.normal_factor[body], row.pull[body]
    return (
        a * integrals.velocity_along + b * integrals.velocity_normal - k * span,
        row.speed[body] * span
        + a * integrals.distance_along
        + b * integrals.distance_normal
        - k * (span * span / 2.0),
    )


@borrowing
def drive_double_integrals(drive: RowWave, tau: float, span: float) -> tuple[float, float]:
    """Return the integrals of the distances that both pushes add over `span` from phase `tau`."""
    return _double_integral(drive.base, FORWARD, tau, span), _double_integral(
        drive.base, BACKWARD, tau, span
    )


@borrowing
def _double_integral(base: WaveDrive, kind: int, tau: float, d: float) -> float:
    if base.steps > 0:
        return acceleration(base, kind, tau + 0.5 * d) * d * d * d / 6.0
    _, _, first, second = integrals(base, kind, tau)
    # P3(tau + D) - P3(tau) - P2 D - P1 D^2/2 with the first to third integral of the push.
    third, third_after = _third_integral(base, kind, tau), _third_integral(base, kind, tau + d)
    return third_after - third - d * (second + first * d / 2.0)


@borrowing
def _third_integral(base: WaveDrive, kind: int, tau: float) -> float:
    total = 0.0
    for k in range(1, base.orders + 1):
        a, b = base.table[2 * kind, k], base.table[2 * kind + 1, k]
        total += (a * math.cos(k * tau) - b * math.sin(k * tau)) * INVERSE[k] ** 3
    return total


@borrowing
def gap_integral_of_drive(
    row: Row, drive: RowWave, contact: int, integrals: tuple[float, float]
) -> float:
    """Return the share of the drive in the integral of a gap over a phase."""
    a = row.push_factor[contact + 1] - row.push_factor[contact]
    b = drive.normal_factor[contact + 1] - drive.normal_factor[contact]
    return a * integrals[0] + b * integrals[1]


# --- forces on a stop


@borrowing
def push_sizes(drive: RowWave) -> tuple[float, float]:
    """Return the amplitudes of which `along` and `normal` are multiples below: 1 and 1."""
    return 1.0, 1.0


@borrowing
def positive_impulse(
    drive: RowWave, body: int, along: float, normal: float, pull: float, tau: float, span: float
) -> float:
    """Return the integral of max(0, a P + b S - k) over the phase from `tau` to `tau + span`.

    a, b and k are `along`, `normal` and `pull`, P and S the pushes of the drive.
    """
    wave = combined_wave(drive, body, AIR, along, normal, pull)  # overwrites the set `AIR` of rows
    # From one change of sign to the next; between them the sign is that at the midpoint.
    total, begin = 0.0, 0.0
    while begin < span:
        until = min(span, later_passage(wave, AIR, tau + begin)[0] - tau)
        if acceleration(wave, AIR, tau + 0.5 * (begin + until)) > 0.0:
            total += flow(wave, AIR, 0.0, tau + begin, until - begin)[0]
        begin = until
    return total


@borrowing
def largest_force(
    drive: RowWave, body: int, along: float, normal: float, pull: float, tau: float, span: float
) -> float:
    """Return the largest `along` P + `normal` S - `pull` over a phase, with the pushes P and S."""
    if drive.base.steps > 0:
        step = step_at(drive.base, tau + 0.5 * span)
        levels = drive.base.table
        return along * levels[2 * AIR, step] + normal * levels[2 * NORMAL, step] - pull
    # Its extremes lie where the derivative of the sums changes sign.
    wave = combined_wave(drive, body, NORMAL, along, normal, SLOPE)
    phase, largest = tau, -math.inf
    while True:
        push = value_and_slope(push_of(drive.base, AIR), phase)[0]
        lift = value_and_slope(push_of(drive.base, NORMAL), phase)[0]
        largest = max(largest, along * push + normal * lift - pull)
        if phase >= tau + span:
            return largest
        phase = min(tau + span, later_passage(wave, NORMAL, phase)[0])
