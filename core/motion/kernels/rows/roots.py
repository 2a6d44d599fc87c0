"""First zeros of velocities and gaps under u' = C sin(tau) - k, isolated and then refined.

Between the zeros of u' the velocity is monotone; between those and the zeros of the velocity the
distance is: no zero is missed, a grazing one included.
"""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.flow import TURN, flow, phase_to

MAX_STEPS = 100
"""Of a bracketed iteration of Newton: bisection alone needs 60 for a turn."""
SAME = 1e-12
"""Of phase: what is nearer to now is now."""


@compiled
def nodes_of(C: float, k: float, tau: float, span: float, nodes: Floats) -> int:
    """Write the phases from tau on, within a span of a turn at most, that bound the zeros of u'.

    They are 0, where C sin(tau) = k, and the span, in order; their number is returned.
    """
    nodes[0], count = 0.0, 1
    if abs(C) > abs(k):
        angle = math.asin(k / C)
        one, other = phase_to(angle, tau), phase_to(math.pi - angle, tau)
        for d in (min(one, other), max(one, other)):
            if SAME < d < span:
                nodes[count] = d
                count += 1
    nodes[count] = span
    return count + 1


@compiled
def refined(
    order: int, x: float, v: float, C: float, k: float, tau: float, low: float, high: float
) -> float:
    """Return the zero of the velocity (order 0) or of the distance (1) between two phases.

    Newton's iteration, by bisection where it leaves the bracket.
    """
    at_low = _value(order, x, v, C, k, tau, low)
    d = 0.5 * (low + high)
    for _ in range(MAX_STEPS):
        value = _value(order, x, v, C, k, tau, d)
        if value == 0.0:
            return d
        if (value > 0.0) == (at_low > 0.0):
            low = d
        else:
            high = d
        slope = C * math.sin(tau + d) - k
        if order == 1:
            slope = flow(v, C, k, math.sin(tau), math.cos(tau), d)[0]
        step = value / slope if slope != 0.0 else math.inf
        after = d - step
        if not low < after < high:
            after = 0.5 * (low + high)
        if abs(after - d) <= 1e-16 * (1.0 + d) or high - low <= 2e-16 * (1.0 + high):
            return after
        d = after
    return d


@compiled
def _value(order: int, x: float, v: float, C: float, k: float, tau: float, d: float) -> float:
    speed, way = flow(v, C, k, math.sin(tau), math.cos(tau), d)
    return x + way if order == 1 else speed


@compiled
def first_stop(v: float, way: int, C: float, k: float, tau: float, span: float) -> float:
    """Return the phase until a velocity, which has the sign of `way` or is 0, is 0; else inf."""
    nodes = np.empty(4)
    count = nodes_of(C, k, tau, span, nodes)
    for j in range(1, count):
        if way * _value(0, 0.0, v, C, k, tau, nodes[j]) <= 0.0:
            if nodes[j - 1] == 0.0 and v == 0.0:
                return 0.0
            return refined(0, 0.0, v, C, k, tau, nodes[j - 1], nodes[j])
    return math.inf


@compiled
def first_contact(g: float, v: float, C: float, k: float, tau: float, span: float) -> float:
    """Return the phase until a gap g >= 0, which grows by v, becomes negative; else inf."""
    if C == 0.0 and k == 0.0 and v >= 0.0:
        return math.inf
    turns, nodes = np.empty(4), np.empty(8)
    count = nodes_of(C, k, tau, span, turns)
    nodes[0], filled = 0.0, 1
    before = v
    for j in range(1, count):
        after = _value(0, 0.0, v, C, k, tau, turns[j])
        if before * after < 0.0:
            nodes[filled] = refined(0, 0.0, v, C, k, tau, turns[j - 1], turns[j])
            filled += 1
        nodes[filled] = turns[j]
        filled += 1
        before = after
    size = 1e-15 * (abs(C) + abs(k) + abs(v))
    for j in range(1, filled):
        if _value(1, g, v, C, k, tau, nodes[j]) < -size:
            if nodes[j - 1] == 0.0 and g <= 0.0:
                return 0.0
            return refined(1, g, v, C, k, tau, nodes[j - 1], nodes[j])
    return math.inf


@compiled
def first_beyond(A: float, B: float, tau: float) -> float:
    """Return the phase until A sin(tau) rises above B; inf if it never does."""
    if abs(A) <= abs(B):
        return math.inf
    angle = math.asin(B / A)
    return phase_to(angle if A > 0.0 else math.pi - angle, tau)


@compiled
def flight_time(s: float, gn: float, tau: float, most: int) -> float:
    """Return how long parts are in the air that lift off at tau; inf if beyond so many turns.

    Their height begins with 0, as does its rate: z'' = s sin(tau) - gn.
    """
    height, rate, passed = 0.0, 0.0, 0.0
    for _ in range(most):
        span = first_contact(height, rate, s, gn, tau, TURN)
        if span < math.inf and passed + span > 0.0:
            return passed + span
        rate, way = flow(rate, s, gn, math.sin(tau), math.cos(tau), TURN)
        height += way
        passed += TURN
    return math.inf
