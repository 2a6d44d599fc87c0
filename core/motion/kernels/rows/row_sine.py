"""A sine, or steps along the track, as the drive of a row, and its first zeros (theory 17.3).

Between the zeros of u' = C sin(tau) - k the velocity is monotone; between those and the zeros of
the velocity the distance is: no zero is missed, a grazing one included.
"""

import math
from collections import namedtuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import TURN, flow, phase_to, swings
from vibrafeed.core.motion.kernels.rows.row_state import Drive, Row

MAX_STEPS = 100
"""Most steps of Newton's iteration in a bracket: bisection alone needs 60 for a turn."""
SAME = 1e-12
"""Phase in rad: what is nearer to now is now."""
LAST_BIT = 1e-16
"""Share of the terms of a sum, below which the sum is 0 up to rounding."""
ROUNDING = 1e-13
"""Share of the terms of a bound, below which the bound says nothing."""
RESOLVED = 1e-13
"""In g: a push that is so little beyond the limit of static friction is at it."""


Pull = namedtuple("Pull", "C k sine cosine")
"""The acceleration that drives a velocity, u' = C sin(tau) - k, from a phase on."""


@borrowing
def turns_of(C: float, k: float, tau: float, span: float) -> tuple[float, float]:
    """Return the first two zeros of u' = C sin(tau) - k within `span` after `tau`, or `span`."""
    one, other = span, span
    if abs(C) > abs(k):
        angle = math.asin(k / C)
        one, other = phase_to(angle, tau), phase_to(math.pi - angle, tau)
        one = one if SAME < one < span else span
        other = other if SAME < other < span else span
    return min(one, other), max(one, other)


@borrowing
def refined(order: int, x: float, v: float, pull: Pull, low: float, high: float) -> float:
    """Return the zero of a velocity (`order` 0) or distance (1) between two phases, in rad."""
    C, k, sine, cosine = pull
    speed, way = flow(v, C, k, sine, cosine, low)
    value, slope = x + way, speed
    if order == 0:
        value, slope = speed, C * (sine * math.cos(low) + cosine * math.sin(low)) - k
    rises = value < 0.0
    d = low - value / slope if slope != 0.0 else high
    if not low < d < high:
        d = 0.5 * (low + high)
    for _ in range(MAX_STEPS):
        speed, way = flow(v, C, k, sine, cosine, d)
        value, slope = x + way, speed
        if order == 0:
            value, slope = speed, C * (sine * math.cos(d) + cosine * math.sin(d)) - k
        terms = abs(x) + d * (abs(v) + d * (abs(C) + abs(k)))
        if order == 0:
            terms = abs(v) + d * (abs(C) + abs(k))
        if abs(value) <= LAST_BIT * terms:
            return d
        if (value < 0.0) == rises:
            low = d
        else:
            high = d
        step = value / slope if slope != 0.0 else math.inf
        after = d - step
        if not low < after < high:
            after = 0.5 * (low + high)
        if abs(after - d) <= 1e-16 * (1.0 + d) or high - low <= 2e-16 * (1.0 + high):
            return after
        d = after
    return d


@borrowing
def first_stop(
    v: float, way: int, C: float, k: float, tau: float, sine: float, cosine: float, span: float
) -> float:
    """Return the phase until a velocity in direction `way` is 0; inf if not within `span`."""
    # It falls by no more than |C| + way k a phase.
    most = (abs(C) + way * k) * span
    if way * v - most > ROUNDING * (abs(v) + abs(most)):
        return math.inf
    one, other = turns_of(C, k, tau, span)
    low, high = 0.0, one
    rests = way * v <= 0.0
    starts = rests and way * (C * sine - k) >= -RESOLVED
    for j in range(3):
        speed, _ = flow(v, C, k, sine, cosine, high)
        if way * speed <= 0.0 and (low > 0.0 or not starts):
            if low == 0.0 and rests:
                return 0.0
            return refined(0, 0.0, v, Pull(C, k, sine, cosine), low, high)
        if high == span:
            break
        low, high = high, other if j == 0 else span
    return math.inf


@borrowing
def first_contact(
    g: float, v: float, C: float, k: float, tau: float, sine: float, cosine: float, span: float
) -> float:
    """Return the phase in rad until a gap between two parts closes; inf if not within `span`.

    The gap `g` changes with the rate `v`, v' = C sin(tau) - k; monotonic pieces of both tell that
    no contact is missed, a grazing one included (theory 17.3).
    """
    if C == 0.0 and k == 0.0 and v >= 0.0:
        return math.inf
    # Its velocity falls by no more than |C| + k a phase.
    met, pull = min(v, 0.0) * span, max(abs(C) + k, 0.0) * span * span / 2.0
    if g + met - pull > ROUNDING * (g - met + pull):
        return math.inf
    one, other = turns_of(C, k, tau, span)
    size = 1e-15 * (abs(C) + abs(k) + abs(v))
    low, high, before, left = 0.0, one, v, g
    for j in range(3):
        after, way = flow(v, C, k, sine, cosine, high)
        if before < 0.0 < after and left + before * (high - low) <= ROUNDING * (left + abs(way)):
            turn = refined(0, 0.0, v, Pull(C, k, sine, cosine), low, high)
            if g + flow(v, C, k, sine, cosine, turn)[1] < -size:
                return _closed(g, v, C, k, sine, cosine, low, turn)
        if g + way < -size:
            if after < 0.0 < before:  # it opens before it closes
                low = refined(0, 0.0, v, Pull(C, k, sine, cosine), low, high)
            return _closed(g, v, C, k, sine, cosine, low, high)
        if high == span:
            break
        low, high, before, left = high, other if j == 0 else span, after, g + way
    return math.inf


@borrowing
def _closed(
    g: float, v: float, C: float, k: float, sine: float, cosine: float, low: float, high: float
) -> float:
    if low == 0.0 and g <= 0.0:
        return 0.0
    return refined(1, g, v, Pull(C, k, sine, cosine), low, high)


@borrowing
def flight_time(s: float, gn: float, tau: float, most: int) -> float:
    """Return the duration in rad of a flight from rest at phase `tau`; inf beyond `most` turns."""
    sine, cosine = math.sin(tau), math.cos(tau)
    height, rate, passed = 0.0, 0.0, 0.0
    for _ in range(most):
        span = first_contact(height, rate, s, gn, tau, sine, cosine, TURN)
        if span < math.inf and passed + span > 0.0:
            return passed + span
        rate, way = flow(rate, s, gn, sine, cosine, TURN)
        height += way
        passed += TURN
    return math.inf


LONGEST_FLIGHT = 1000
"""Longest flight in turns of the drive: at throw numbers beyond some 3,000 no feeder works."""

Now = namedtuple("Now", "tau sine cosine")
"""A phase, its sine and its cosine."""


@borrowing
def pushes(drive: Drive, pull: float, tau: float) -> tuple[float, float]:
    """Return the push along, c sin(tau) - `pull`, and the load on the floor, at least 0, in g."""
    return drive.c * math.sin(tau) - pull, max(0.0, drive.gn - drive.s * math.sin(tau))


@borrowing
def lift_off(drive: Drive, tau: float) -> float:
    """Return the phase in rad until parts lift off, where s sin(tau) rises through n."""
    return phase_to(math.asin(drive.gn / drive.s), tau) if drive.s > drive.gn else math.inf


@borrowing
def is_lifted(drive: Drive, tau: float) -> bool:
    """True if parts on the floor lift off at a phase."""
    return drive.s * math.sin(tau) > drive.gn


@borrowing
def flight(drive: Drive, tau: float) -> tuple[float, float]:
    """Return duration in rad and landing speed in g/w of a flight that begins at phase `tau`."""
    span = flight_time(drive.s, drive.gn, tau, LONGEST_FLIGHT)
    if span == math.inf:
        return math.inf, 0.0
    return span, -flow(0.0, drive.s, drive.gn, math.sin(tau), math.cos(tau), span)[0]


@borrowing
def first_rise(
    drive: Drive, body: int, way: int, along: float, normal: float, level: float, tau: float
) -> float:
    """Return the phase until (`along` c + `normal` s) sin rises above `level`; inf if never."""
    size = along * drive.c + normal * drive.s
    if abs(size) <= abs(level):
        return math.inf
    angle = math.asin(level / size)
    return phase_to(angle if size > 0.0 else math.pi - angle, tau)


@borrowing
def set_flow(row: Row, drive: Drive, body: int, moves: bool, friction: float, drag: float) -> None:
    """Set C and k of a body's acceleration C sin(tau) - k; C = 0 unless it `moves`."""
    row.gain[body], row.drag[body] = drive.c + friction * drive.s if moves else 0.0, drag


@borrowing
def at_phase(drive: Drive, tau: float) -> Now:
    """Return sine and cosine of the phase, which the searches below share."""
    return Now(tau, math.sin(tau), math.cos(tau))


@borrowing
def stop_until(row: Row, drive: Drive, part: int, now: Now, span: float) -> float:
    """Return the phase in rad until a sliding part's velocity is 0; inf if not within `span`."""
    return first_stop(
        row.speed[part], row.mode[part], row.gain[part], row.drag[part], now.tau, now.sine,
        now.cosine, span,
    )  # fmt: skip


@borrowing
def contact_until(row: Row, drive: Drive, contact: int, now: Now, span: float) -> float:
    """Return the phase in rad until a gap in a row closes; inf if not within `span`."""
    gain = row.gain[contact + 1] - row.gain[contact]
    drag = row.drag[contact + 1] - row.drag[contact]
    apart = row.speed[contact + 1] - row.speed[contact]
    return first_contact(row.gap[contact], apart, gain, drag, now.tau, now.sine, now.cosine, span)


@borrowing
def relative_push(row: Row, drive: Drive, contact: int, tau: float) -> float:
    """Return the share of the drive in the relative acceleration of two neighbours, in g."""
    return (row.gain[contact + 1] - row.gain[contact]) * math.sin(tau)


@borrowing
def swung(drive: Drive, tau: float, span: float) -> tuple[float, float]:
    """Return the velocity and distance that sin adds over `span` rad from phase `tau` on."""
    return swings(math.sin(tau), math.cos(tau), span)


@borrowing
def carried(
    row: Row, drive: Drive, body: int, by: tuple[float, float], span: float
) -> tuple[float, float]:
    """Return the change of velocity and of position of a body over `span`, in g/w and g/w^2."""
    return (
        row.gain[body] * by[0] - row.drag[body] * span,
        row.speed[body] * span + row.gain[body] * by[1] - row.drag[body] * (span * span / 2.0),
    )


@borrowing
def swept(drive: Drive, tau: float, span: float) -> float:
    """Return the integral over `span` of the distance that sin adds from phase `tau` on.

    cos(tau + d) - cos(tau) + sin(tau) d + cos(tau) d^2/2, d = `span`.
    """
    sine, cosine = math.sin(tau), math.cos(tau)
    return math.cos(tau + span) - cosine + sine * span + cosine * span * span / 2.0


@borrowing
def gap_swept(row: Row, drive: Drive, contact: int, by: float) -> float:
    """Return the share of the drive in the integral of a gap over a phase."""
    return (row.gain[contact + 1] - row.gain[contact]) * by


@borrowing
def sizes(drive: Drive) -> tuple[float, float]:
    """Return the amplitudes of both pushes in g, of which `above` and `highest` take multiples."""
    return drive.c, drive.s


@borrowing
def above(
    drive: Drive, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the integral of the positive part of a force, max(0, C sin(x) - k), over a phase."""
    gain = along + normal
    if gain == 0.0:
        return max(0.0, -drag) * span
    if abs(gain) <= abs(drag):
        return _whole(gain, drag, tau, span) if drag < 0.0 else 0.0
    angle = math.asin(drag / gain)
    one, other = phase_to(angle, tau), phase_to(math.pi - angle, tau)
    total, at = 0.0, 0.0
    for until in (min(one, other, span), min(max(one, other), span), span):
        middle = tau + 0.5 * (at + until)
        if until > at and gain * math.sin(middle) > drag:
            total += _whole(gain, drag, tau + at, until - at)
        at = until
    return total


@borrowing
def _whole(gain: float, drag: float, tau: float, span: float) -> float:
    return gain * (math.cos(tau) - math.cos(tau + span)) - drag * span


@borrowing
def highest(
    drive: Drive, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the largest value of C sin(x) - `drag` over a phase, C = `along` + `normal`."""
    gain = along + normal
    top = phase_to(0.5 * math.pi if gain >= 0.0 else 1.5 * math.pi, tau)
    if top <= span:
        return abs(gain) - drag
    return max(gain * math.sin(tau), gain * math.sin(tau + span)) - drag
