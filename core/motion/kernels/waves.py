"""Sums of sines in compiled code: their values, and where they pass through a level.

A sum stands in two rows of a table, the coefficients of sin(k tau) in `sines` and those of
cos(k tau) in `cosines`, from column 1 on.
"""

from __future__ import annotations

import math

from core.compiled import borrowing
from core.motion.kernels.arrays import Floats

TURN = 2.0 * math.pi
FINEST = 1e-11
"""Of phase: two passages nearer to each other than this may be taken for none."""
LAST_STEP = 1e-9
"""Of Newton's iteration, over the piece: the next would be of the order of its square."""
MOST_ITERATIONS = 80


@borrowing
def value_and_slope(
    table: Floats, sines: int, cosines: int, orders: int, tau: float
) -> tuple[float, float]:
    """Return a sum and its derivative."""
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine, value, slope = sine_1, cosine_1, 0.0, 0.0
    for k in range(1, orders + 1):
        a, b = table[sines, k], table[cosines, k]
        value += a * sine + b * cosine
        slope += k * (a * cosine - b * sine)
        sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
    return value, slope


@borrowing
def bend_bound(table: Floats, sines: int, cosines: int, orders: int) -> float:
    """Return what the second derivative of a sum does not exceed."""
    total = 0.0
    for k in range(1, orders + 1):
        total += k * k * math.hypot(table[sines, k], table[cosines, k])
    return total


@borrowing
def passages(
    table: Floats, sines: int, cosines: int, orders: int, level: float, found: int, room: int
) -> int:
    """Fill the row `found`, from column 1 on, with where a sum passes a level; return how many.

    Ascending in [0, 2 pi). Pieces are halved until the sum is off the level all along, by its
    value, slope and the bound of its second derivative at the middle, or runs one way only: then a
    sign at both ends decides, and none is missed but a pair within `FINEST`. There are 2 `orders`
    at most; what finds no `room` is left out.
    """
    bend = bend_bound(table, sines, cosines, orders)
    count, tau, step = 0, 0.0, 0.8 / max(1, orders)
    while tau < TURN:
        step = min(step, TURN - tau)
        half = 0.5 * step
        value, slope = value_and_slope(table, sines, cosines, orders, tau + half)
        if abs(value - level) > (abs(slope) + 0.5 * bend * half) * half:
            tau, step = tau + step, 2.0 * step
            continue
        if abs(slope) <= bend * half and step > FINEST:
            step = half
            continue
        low, high = tau, tau + step
        first = value_and_slope(table, sines, cosines, orders, low)[0] - level
        last = value_and_slope(table, sines, cosines, orders, high)[0] - level
        if (first <= 0.0 < last or first >= 0.0 > last) and count < room:
            count += 1
            table[found, count] = passage(
                table, sines, cosines, orders, level, low, high, first < last
            )
        tau, step = high, 2.0 * step
    return count


@borrowing
def passage(
    table: Floats, sines: int, cosines: int, orders: int, level: float, low: float, high: float,
    rises: bool,
) -> float:  # fmt: skip
    """Return where a sum that runs one way passes a level, by Newton's iteration in a bracket."""
    piece, at = high - low, 0.5 * (low + high)
    for _ in range(MOST_ITERATIONS):
        value, slope = value_and_slope(table, sines, cosines, orders, at)
        value -= level
        if (value > 0.0) == rises:
            high = at
        else:
            low = at
        new = at - value / slope if slope != 0.0 else low - 1.0
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - at) <= LAST_STEP * piece:
            return new
        at = new
    return at
