"""Sums of sines: their values, and where they pass through a level (theory 13.14)."""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.inputs import Floats

TURN = 2.0 * math.pi
FINEST = 1e-11
"""Phase in rad: two passages nearer to each other than this may be missed."""
LAST_STEP = 3e-5
"""Step over the piece that ends Halley's iteration: the next is of the order of its cube."""
POINTS = 128
"""Phases of a period at which sums are evaluated first: four to each change of the highest
order."""
SINES = np.sin(TURN * np.arange(POINTS + POINTS // 4) / POINTS)
"""Sines at these phases, and a quarter turn more for the cosines."""
MAX_ITERATIONS = 80
"""Most steps of Halley's iteration in a bracket: halving alone ends after 53."""


WaveColumns = namedtuple("WaveColumns", "orders steps along normal levels normal_levels ends")
"""Columns of a wave's numbers in a row: `vibrafeed.core.motion.waves.Wave.columns` writes them.

`along` and `normal` are the first columns of the sines of each order, of which the cosines
follow; `levels` and `normal_levels` those of the steps, and `ends` that of the phases at which
they end. What is across the track stands between. Both counts are 0 of a row without a wave.
"""


@borrowing
def wave_columns(row: Floats, start: int) -> WaveColumns:
    """Return the columns of the coefficients of a wave in a kernel's row of numbers."""
    orders, steps = 0, 0
    if row.size > start:
        orders, steps = int(row[start]), int(row[start + 1])
    along, levels = start + 2, start + 2 + 6 * orders
    return WaveColumns(
        orders, steps, along, along + 4 * orders, levels, levels + 2 * steps, levels + 3 * steps
    )


class SineSum(NamedTuple):
    """A sum of sines S(tau) = sum of a_k sin(k tau) + b_k cos(k tau), k = 1 to `orders`.

    a_k stand in row `sines` of `table`, b_k in row `cosines`, column k.
    """

    table: Floats
    sines: int
    cosines: int
    orders: int


@borrowing
def value_and_slope(wave: SineSum, tau: float) -> tuple[float, float]:
    """Return the value S and the derivative dS/dtau of a sum of sines at the phase `tau` in rad."""
    table, sines, cosines = wave.table, wave.sines, wave.cosines
    sine_1, cosine_1 = math.sin(tau), math.cos(tau)
    sine, cosine, value, slope = sine_1, cosine_1, 0.0, 0.0
    for k in range(1, wave.orders + 1):
        a, b = table[sines, k], table[cosines, k]
        value += a * sine + b * cosine
        slope += k * (a * cosine - b * sine)
        sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
    return value, slope


@borrowing
def bend_bound(wave: SineSum) -> float:
    """Return an upper bound of |S''| of a sum S of sines, for a search that misses no zero.

    The sum of k^2 sqrt(a_k^2 + b_k^2).
    """
    table, sines, cosines = wave.table, wave.sines, wave.cosines
    total = 0.0
    for k in range(1, wave.orders + 1):
        total += k * k * math.sqrt(table[sines, k] ** 2 + table[cosines, k] ** 2)
    return total


@borrowing
def value_at_sample(wave: SineSum, point: int) -> tuple[float, float]:
    """Return value and derivative of a sum of sines at one of 128 phases, 2 pi `point`/128."""
    table, sines, cosines = wave.table, wave.sines, wave.cosines
    value, slope = 0.0, 0.0
    for k in range(1, wave.orders + 1):
        index = (k * point) & (POINTS - 1)
        sine, cosine = SINES[index], SINES[index + POINTS // 4]
        a, b = table[sines, k], table[cosines, k]
        value += a * sine + b * cosine
        slope += k * (a * cosine - b * sine)
    return value, slope


@borrowing
def passages(wave: SineSum, level: float, row: int, capacity: int) -> int:
    """Write the phases at which a sum S of sines passes `level` into a row; return their number.

    On each of some equal pieces, with half width h and the bound M of |S''|: if |S - level| > |S'|
    h + M h^2/2 at the middle, there is none; if |S'| > M h, S is monotonic and the signs at both
    ends decide; otherwise the piece is halved. Only a pair nearer together than `FINEST` can be
    missed (theory 13.14).
    """
    table, orders = wave.table, wave.orders
    if orders == 1:
        return two_passages(table[wave.sines, 1], table[wave.cosines, 1], level, table, row)
    bend = bend_bound(wave)
    stride = 4 if orders <= 2 else 2 if orders <= 5 else 1
    step = TURN * (2 * stride) / POINTS
    half, count = 0.5 * step, 0
    value_at_low = value_at_sample(wave, 0)[0] - level
    for point in range(stride, POINTS, 2 * stride):
        value, slope = value_at_sample(wave, point)
        value -= level
        if abs(value) > (abs(slope) + 0.5 * bend * half) * half:
            value_at_low = value
            continue
        low = TURN * (point - stride) / POINTS
        if abs(slope) > bend * half:
            value_at_high = value_at_sample(wave, point + stride)[0] - level
            if passes(value_at_low, value_at_high) and count < capacity:
                count += 1
                table[row, count] = passage(
                    wave, level, low, low + step, value_at_low, value_at_high
                )
            value_at_low = value_at_high
        else:
            count, value_at_low = passages_in_piece(
                wave, level, low, low + step, bend, value_at_low, row, count, capacity
            )
    return count


@borrowing
def two_passages(sine: float, cosine: float, level: float, table: Floats, row: int) -> int:
    """Write the two phases at which a single sine passes `level`; return 2, or 0 without any."""
    size = math.sqrt(sine * sine + cosine * cosine)
    if not abs(level) < size:
        return 0
    phase_lead, rise_phase = math.atan2(cosine, sine), math.asin(level / size)
    rising, falling = (rise_phase - phase_lead) % TURN, (math.pi - rise_phase - phase_lead) % TURN
    table[row, 1], table[row, 2] = min(rising, falling), max(rising, falling)
    return 2


@borrowing
def passes(value: float, next_value: float) -> bool:
    """True if a sign changes between two values, a <= 0 < b or a >= 0 > b."""
    return value <= 0.0 < next_value or value >= 0.0 > next_value


@borrowing
def passages_in_piece(
    wave: SineSum, level: float, low: float, high: float, bend: float, value_at_low: float,
    row: int, count: int, capacity: int,
) -> tuple[int, float]:  # fmt: skip
    """Write the phases in [low, high] at which a sum of sines S passes a level, by halving."""
    # By the rules of `passages`; pieces are halved where needed, and doubled after each. Return the
    # number of phases written so far, and S - level at `high`.
    tau, step = low, 0.5 * (high - low)
    while tau < high:
        step = min(step, high - tau)
        half = 0.5 * step
        value, slope = value_and_slope(wave, tau + half)
        value -= level
        if abs(value) > (abs(slope) + 0.5 * bend * half) * half:
            value_at_low = value
        elif abs(slope) <= bend * half and step > FINEST:
            step = half
            continue
        else:
            value_at_high = value_and_slope(wave, tau + step)[0] - level
            if passes(value_at_low, value_at_high) and count < capacity:
                count += 1
                wave.table[row, count] = passage(
                    wave, level, tau, tau + step, value_at_low, value_at_high
                )
            value_at_low = value_at_high
        tau, step = tau + step, 2.0 * step
    return count, value_at_low


@borrowing
def passage(
    wave: SineSum, level: float, low: float, high: float, value_at_low: float, value_at_high: float
) -> float:
    """Return the phase in [low, high] at which a sum of sines, monotonic there, passes `level`."""
    table, sines, cosines = wave.table, wave.sines, wave.cosines
    width, tau = high - low, low + (high - low) * value_at_low / (value_at_low - value_at_high)
    for _ in range(MAX_ITERATIONS):
        sine_1, cosine_1 = math.sin(tau), math.cos(tau)
        sine, cosine, value, slope, bend = sine_1, cosine_1, -level, 0.0, 0.0
        for k in range(1, wave.orders + 1):
            a, b = table[sines, k], table[cosines, k]
            term = a * sine + b * cosine
            value += term
            slope += k * (a * cosine - b * sine)
            bend -= (k * k) * term
            sine, cosine = sine * cosine_1 + cosine * sine_1, cosine * cosine_1 - sine * sine_1
        if (value > 0.0) == (value_at_high > 0.0):
            high = tau
        else:
            low = tau
        next_tau = tau - halley(value, slope, bend)
        if not low <= next_tau <= high:
            next_tau = 0.5 * (low + high)
            if next_tau in (low, high):
                return next_tau
        elif abs(next_tau - tau) <= LAST_STEP * width and is_near_root(
            value, slope, bend, LAST_STEP
        ):
            return next_tau
        tau = next_tau
    return tau


@borrowing
def halley(value: float, slope: float, bend: float) -> float:
    """Return Halley's step to a root, f f'/(f'^2 - f f''/2), to subtract from the argument."""
    denominator = slope * slope - 0.5 * value * bend
    return value * slope / denominator if denominator > 0.0 else math.inf


@borrowing
def is_near_root(value: float, slope: float, bend: float, nearness: float) -> bool:
    """True if Halley's step from here ends at a root of f: |f f''| <= nearness f'^2.

    A short step is not enough: where f' vanishes, it is some 2 f'/f'', short however far the root
    is.
    """
    return abs(value * bend) <= nearness * slope * slope
