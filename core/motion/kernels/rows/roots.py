"""First zeros of velocities and gaps under u' = C sin(tau) - k, isolated and then refined.

Between the zeros of u' the velocity is monotone; between those and the zeros of the velocity the
distance is: no zero is missed, a grazing one included.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import TURN, flow, phase_to

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


class Pull(NamedTuple):
    """The acceleration that drives a velocity, u' = C sin(tau) - k, from a phase on.

    `sine` and `cosine` are those of the phase at the start.
    """

    C: float
    k: float
    sine: float
    cosine: float


@borrowing
def turns_of(C: float, k: float, tau: float, span: float) -> tuple[float, float]:
    """Return the first two zeros of u' = C sin(tau) - k after `tau`, at which the velocity u turns.

    As phases from `tau` in rad, in order, within `span` (a turn at most); `span` stands for a zero
    that is not within it. `C` and `k` are in g.
    """
    one, other = span, span
    if abs(C) > abs(k):
        angle = math.asin(k / C)
        one, other = phase_to(angle, tau), phase_to(math.pi - angle, tau)
        one = one if SAME < one < span else span
        other = other if SAME < other < span else span
    return min(one, other), max(one, other)


@borrowing
def refined(order: int, x: float, v: float, pull: Pull, low: float, high: float) -> float:
    """Return the zero of a velocity (`order` 0) or distance (`order` 1) between two phases, in rad.

    The distance starts at `x` and the velocity at `v`, and the velocity changes by C sin(tau) - k;
    `pull` holds C, k, and sine and cosine of the phase at the start. `low` and `high` are the
    phases since then, with values of opposite signs. By Newton's iteration, and by bisection where
    it leaves the bracket. In units of g and w = 2 pi f.
    """
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
    """Return the phase in rad until a velocity in direction `way` is 0; inf if not within `span`.

    The velocity changes from `v` in g/w (w = 2 pi f) at phase `tau` by u' = `C` sin(tau) - `k`, C
    and k in g; `sine` and `cosine` are those of `tau`, `way` is 1 or -1, `span` is in rad. A part
    without velocity, or with a hair against its way, stops at once if C sin(tau) - k is against its
    way; else it starts, whatever rounding says.
    """
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

    The gap `g` >= 0 changes with the rate `v`, v' = C sin(tau) - k, in g/w^2 and g/w (w = 2 pi f),
    from phase `tau` on, whose `sine` and `cosine` are passed to save time; `span` is in rad.
    Between the phases at which v' changes sign, v is monotonic, and between those and the zeros of
    v the gap is: no contact is missed, a grazing one included (theory 17.3).
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
    """Return the phase at which a gap closes between the phases `low` and `high`.

    It is `g` with rate `v` at the start, v' = C sin - k, and monotonic from `low` to `high`; `sine`
    and `cosine` are those of the start.
    """
    if low == 0.0 and g <= 0.0:
        return 0.0
    return refined(1, g, v, Pull(C, k, sine, cosine), low, high)


@borrowing
def first_beyond(A: float, B: float, tau: float) -> float:
    """Return the phase in rad from `tau` until A sin(tau) rises above B; inf if it never does.

    Also inf if it is always above, |A| <= |B|. It finds where a drive of amplitude A exceeds a
    limit B.
    """
    if abs(A) <= abs(B):
        return math.inf
    angle = math.asin(B / A)
    return phase_to(angle if A > 0.0 else math.pi - angle, tau)


@borrowing
def flight_time(s: float, gn: float, tau: float, most: int) -> float:
    """Return the duration in rad of a flight from rest at phase `tau`; inf beyond `most` turns.

    Height and velocity off the floor begin with 0, and z'' = s sin(tau) - gn, with the amplitude
    `s` of the drive and gravity `gn` normal to the floor in g. Period by period the first contact
    is sought.
    """
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
