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
    next_of_way,
    next_passage,
    push_of,
    speed_start,
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

    `c` and `s` are bounds of the push, `levels` are 0, as in `Drive`. `base` holds the pushes;
    `tables[j]` is room for the kinds of acceleration of body j, each made of the shares and the
    pull in `keys[j]`. `share[j]` is the factor of the normal push in its acceleration.
    """

    c: float
    s: float
    gs: float
    gn: float
    ends: Floats
    levels: Floats
    base: WaveDrive
    tables: Floats
    keys: Floats
    share: Floats


Swung = namedtuple("Swung", "swing sway normal_swing normal_sway")
"""What both pushes add to velocity and distance over a phase."""


@compiled
def waved_of(cell: Floats) -> RowWave:
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
        for part in range(2):
            place = part * orders + k
            along, normal = cell[columns.along + place], cell[columns.normal + place]
            _fill_pushes(table, part, k + 1, along, normal)
        largest[0] += math.hypot(table[2 * AIR, k + 1], table[2 * AIR + 1, k + 1])
        largest[1] += math.hypot(table[2 * NORMAL, k + 1], table[2 * NORMAL + 1, k + 1])
    gs, gn = cell[AT.gravity_number_along], cell[AT.gravity_number_normal]
    table[PULLS, AIR], table[PULLS, NORMAL] = gs, gn
    along, normal = largest[0], largest[1]
    base = WaveDrive(table, orders, steps, gs, gn, 0.0, 0.0, along, normal)
    if steps > 0 or normal > gn:
        fill_passages(base, NORMAL)
    tables = np.zeros((bodies, TABLE[0], TABLE[1]))
    tables[:, ENDS, :] = table[ENDS, :]
    keys = np.full((bodies, KINDS, 3), np.nan)
    return RowWave(
        along, normal, gs, gn, ends, np.zeros(ends.size), base, tables, keys, np.zeros(bodies)
    )


@borrowing
def _fill_pushes(table: Floats, part: int, column: int, along: float, normal: float) -> None:
    table[2 * AIR + part, column] = table[2 * FORWARD + part, column] = along
    table[2 * NORMAL + part, column] = table[2 * BACKWARD + part, column] = normal


@borrowing
def of_kind(
    drive: RowWave, body: int, kind: int, along: float, normal: float, pull: float
) -> WaveDrive:
    """Return the wave with the acceleration a P(tau) + b S(tau) - k, its sign changes filled.

    It goes into row set `kind` of the table of `body`; if that holds the same already, nothing is
    computed. With the pull `SLOPE` it is the derivative of the sums.
    """
    base = drive.base
    wave = WaveDrive(
        drive.tables[body], base.orders, base.steps, base.gs, base.gn, base.mu_s, base.mu_k,
        base.c, base.s,
    )  # fmt: skip
    keys = drive.keys[body, kind]
    if keys[0] == along and keys[1] == normal and keys[2] == pull:
        return wave
    keys[0], keys[1], keys[2] = along, normal, pull
    table, known = wave.table, base.table
    table[PULLS, kind] = 0.0 if pull == SLOPE else pull
    if base.steps > 0:
        for step in range(base.steps):
            table[2 * kind, step] = along * known[2 * AIR, step] + normal * known[2 * NORMAL, step]
        fill_passages(wave, kind)
        return wave
    size = 0.0
    for k in range(1, base.orders + 1):
        a = along * known[2 * AIR, k] + normal * known[2 * NORMAL, k]
        b = along * known[2 * AIR + 1, k] + normal * known[2 * NORMAL + 1, k]
        if pull == SLOPE:
            a, b = -k * b, k * a
        table[2 * kind, k], table[2 * kind + 1, k] = a, b
        size += math.sqrt(a * a + b * b)
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
    turned = tau + TURN
    return max(0.0, next_of_way(wave, kind, turned - SAME, True) - turned)


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
    drive: RowWave, body: int, way: int, along: float, normal: float, level: float, tau: float
) -> float:
    """Return the phase in rad until `along` P + `normal` S rises above `level`; inf if never."""
    kind = STATIC_FORWARD if way > 0 else STATIC_BACKWARD
    wave = of_kind(drive, body, kind, along, normal, level)
    return _until_rise(wave, kind, tau)


# --- parts


@borrowing
def set_flow(
    row: Row, drive: RowWave, body: int, moves: bool, friction: float, drag: float
) -> None:
    """Set factors and pull of a body's acceleration a P + b S - k: 0 unless it `moves`."""
    row.gain[body], row.drag[body] = 1.0 if moves else 0.0, drag
    drive.share[body] = friction if moves else 0.0


@borrowing
def at_phase(drive: RowWave, tau: float) -> float:
    """Return the phase, which is all that the searches below share."""
    return tau


@borrowing
def stop_until(row: Row, drive: RowWave, part: int, now: float, span: float) -> float:
    """Return the phase in rad until a sliding part's velocity is 0; inf if not within `span`."""
    v, way, k = row.speed[part], row.mode[part], row.drag[part]
    a, b = row.gain[part], drive.share[part]
    most = (abs(a) * drive.c + abs(b) * drive.s + way * k) * span
    if way * v - most > ROUNDING * (abs(v) + abs(most)):
        return math.inf
    kind = FORWARD if way > 0 else BACKWARD
    wave = of_kind(drive, part, kind, a, b, k)
    passes, force = next_passage(wave, kind, now)[0] - now, way * acceleration(wave, kind, now)
    if passes > SAME:
        if force > 0.0 and passes >= span:
            return math.inf
        # It moves no more, or its neighbour's stop has turned it a hair: it is no start, of which
        # the acceleration is 0, or passes through 0 now, but for rounding.
        if way * v <= 0.0 and force < -RESOLVED:
            return 0.0
    until = stop_after(wave, float(way), v, now, span)
    return until if until >= 0.0 else math.inf


@borrowing
def contact_until(row: Row, drive: RowWave, contact: int, now: float, span: float) -> float:
    """Return the phase in rad until a gap in a row closes; inf if not within `span`.

    As under a sine, between two phases at which a P + b S - k changes sign (theory 17.3).
    """
    one, other = contact, contact + 1
    a, b = row.gain[other] - row.gain[one], drive.share[other] - drive.share[one]
    k, v = row.drag[other] - row.drag[one], row.speed[other] - row.speed[one]
    g, steady = row.gap[contact], a == 0.0 and b == 0.0 and k == 0.0
    if steady and v >= 0.0:
        return math.inf
    most = abs(a) * drive.c + abs(b) * drive.s
    met, pull = min(v, 0.0) * span, max(most + k, 0.0) * span * span / 2.0
    if g + met - pull > ROUNDING * (g - met + pull):
        return math.inf
    wave = of_kind(drive, contact, NORMAL, a, b, k)
    size = 1e-15 * (most + abs(k) + abs(v))
    low, before, left, start = 0.0, v, g, speed_start(wave, NORMAL, now)
    for _ in range(MAX_PIECES):
        high = min(span, later_passage(wave, NORMAL, now + low)[0] - now)
        after, way = flow(wave, NORMAL, v, now, high)
        if before < 0.0 < after and left + before * (high - low) <= ROUNDING * (left + abs(way)):
            turn = zero_of_velocity(wave, NORMAL, v, now, start, low, high, before, after)
            if g + flow(wave, NORMAL, v, now, turn)[1] < -size:
                return _closed(wave, g, v, now, low, turn)
        if g + way < -size:
            if after < 0.0 < before:  # it opens before it closes
                low = zero_of_velocity(wave, NORMAL, v, now, start, low, high, before, after)
            return _closed(wave, g, v, now, low, high)
        if high == span:
            break
        low, before, left = high, after, g + way
    return math.inf


@borrowing
def _closed(wave: WaveDrive, g: float, v: float, tau: float, low: float, high: float) -> float:
    if low == 0.0 and g <= 0.0:
        return 0.0
    return landing_root(wave, g, v, tau, low, high)


@borrowing
def relative_push(row: Row, drive: RowWave, contact: int, tau: float) -> float:
    """Return the drive's part in the relative acceleration of two neighbours in a row, in g."""
    a = row.gain[contact + 1] - row.gain[contact]
    b = drive.share[contact + 1] - drive.share[contact]
    along, normal = acceleration(drive.base, FORWARD, tau), acceleration(drive.base, BACKWARD, tau)
    return a * along + b * normal


@borrowing
def swung(drive: RowWave, tau: float, span: float) -> Swung:
    """Return velocities and distances that both pushes add over `span` rad from phase `tau`."""
    swing, sway = flow(drive.base, FORWARD, 0.0, tau, span)
    normal_swing, normal_sway = flow(drive.base, BACKWARD, 0.0, tau, span)
    return Swung(swing, sway, normal_swing, normal_sway)


@borrowing
def carried(row: Row, drive: RowWave, body: int, by: Swung, span: float) -> tuple[float, float]:
    """Return the change of velocity and of position of a body over a phase, in g/w and g/w^2."""
    a, b, k = row.gain[body], drive.share[body], row.drag[body]
    return (
        a * by.swing + b * by.normal_swing - k * span,
        row.speed[body] * span + a * by.sway + b * by.normal_sway - k * (span * span / 2.0),
    )


@borrowing
def swept(drive: RowWave, tau: float, span: float) -> tuple[float, float]:
    """Return the integrals of the distances that both pushes add over `span` from phase `tau`."""
    return _swept(drive.base, FORWARD, tau, span), _swept(drive.base, BACKWARD, tau, span)


@borrowing
def _swept(base: WaveDrive, kind: int, tau: float, d: float) -> float:
    if base.steps > 0:
        return acceleration(base, kind, tau + 0.5 * d) * d * d * d / 6.0
    _, _, first, second = integrals(base, kind, tau)
    # P3(tau + D) - P3(tau) - P2 D - P1 D^2/2 with the first to third integral of the push.
    third, third_after = _third(base, kind, tau), _third(base, kind, tau + d)
    return third_after - third - d * (second + first * d / 2.0)


@borrowing
def _third(base: WaveDrive, kind: int, tau: float) -> float:
    total = 0.0
    for k in range(1, base.orders + 1):
        a, b = base.table[2 * kind, k], base.table[2 * kind + 1, k]
        total += (a * math.cos(k * tau) - b * math.sin(k * tau)) * INVERSE[k] ** 3
    return total


@borrowing
def gap_swept(row: Row, drive: RowWave, contact: int, by: tuple[float, float]) -> float:
    """Return the share of the drive in the integral of a gap over a phase."""
    a = row.gain[contact + 1] - row.gain[contact]
    b = drive.share[contact + 1] - drive.share[contact]
    return a * by[0] + b * by[1]


# --- forces on a stop


@borrowing
def sizes(drive: RowWave) -> tuple[float, float]:
    """Return the amplitudes of which `along` and `normal` are multiples below: 1 and 1."""
    return 1.0, 1.0


@borrowing
def above(
    drive: RowWave, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the integral of the positive part of a force, max(0, a P + b S - k), over a phase."""
    wave = of_kind(drive, body, AIR, along, normal, drag)
    total, at = 0.0, 0.0
    while at < span:
        until = min(span, later_passage(wave, AIR, tau + at)[0] - tau)
        if acceleration(wave, AIR, tau + 0.5 * (at + until)) > 0.0:
            total += flow(wave, AIR, 0.0, tau + at, until - at)[0]
        at = until
    return total


@borrowing
def highest(
    drive: RowWave, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the largest value of `along` P + `normal` S - `drag` over a phase."""
    if drive.base.steps > 0:
        step = step_at(drive.base, tau + 0.5 * span)
        levels = drive.base.table
        return along * levels[2 * AIR, step] + normal * levels[2 * NORMAL, step] - drag
    wave = of_kind(drive, body, NORMAL, along, normal, SLOPE)
    at, best = tau, -math.inf
    while True:
        push = value_and_slope(push_of(drive.base, AIR), at)[0]
        lift = value_and_slope(push_of(drive.base, NORMAL), at)[0]
        best = max(best, along * push + normal * lift - drag)
        if at >= tau + span:
            return best
        at = min(tau + span, later_passage(wave, NORMAL, at)[0])
