"""Exact sums of floats, as whole multiples of powers of 2^40: equal however they are split."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

DIGIT = 40
"""Bits between the units of two levels."""
LOWEST = -1074
"""The unit of level 0 is the least float above 0."""
FEW = 4
"""Units that are tried first: values over 160 binary digits."""

Integers = NDArray[np.int64]


def exponent_of(largest: float) -> int:
    """Return the least power of 2 that is above the size of a value, at least 2^-1000."""
    return max(math.frexp(largest)[1], -1000)


def units_of(exponent: int, count: int | None = None) -> list[int]:
    """Return the powers of 2 that floats below 2^exponent are split into, from the highest down.

    There are as many as any float needs, or `count` of them.
    """
    units = [*range(exponent - DIGIT, LOWEST, -DIGIT), LOWEST]
    return units[:count]


def anchors(units: list[int]) -> NDArray[np.float64]:
    """Return what rounds a float to whole multiples of each unit when it is added."""
    return np.array([math.ldexp(1.5, 52 + unit) for unit in units])


def carried(sums: Integers) -> Integers:
    """Return sums, by level from level 0 up, whose digits below the last are within one digit."""
    sums = sums.copy()
    half = 1 << (DIGIT - 1)
    for level in range(len(sums) - 1):
        over = (sums[level] + half) >> DIGIT
        sums[level] -= over << DIGIT
        sums[level + 1] += over
    return sums


def by_level(units: list[int], sums: Integers) -> tuple[int, Integers]:
    """Return sums in some units as digits by level: the lowest level, and all upwards from it."""
    low = (units[-1] - LOWEST) // DIGIT
    high = (units[0] - LOWEST) // DIGIT
    digits = np.zeros((high - low + 4, sums.shape[1]), np.int64)
    for unit, own in zip(units, sums, strict=True):
        level, shift = divmod(unit - LOWEST, DIGIT)
        digits[level - low] += (own & ((1 << (DIGIT - shift)) - 1)) << shift
        digits[level - low + 1] += own >> (DIGIT - shift)
    return low, carried(digits)


def added(one: tuple[int, Integers], other: tuple[int, Integers]) -> tuple[int, Integers]:
    """Return the sum of two sums, each with its lowest level."""
    low = min(one[0], other[0])
    high = max(level + len(sums) for level, sums in (one, other))
    total = np.zeros((high - low, one[1].shape[1]), np.int64)
    for level, sums in (one, other):
        total[level - low : level - low + len(sums)] += sums
    return low, carried(total)


def means(low: int, sums: Integers, counts: Integers) -> NDArray[np.float64]:
    """Return the sums over the counts, each rounded once; NaN where nothing was counted."""
    result = np.full(counts.shape, np.nan)
    unit = LOWEST + DIGIT * low
    for slot in np.flatnonzero(counts).tolist():
        total = sum(int(digit) << (DIGIT * k) for k, digit in enumerate(sums[:, slot].tolist()))
        count = int(counts[slot])
        # The quotient of two integers is rounded once, and right.
        result[slot] = (total << unit) / count if unit >= 0 else total / (count << -unit)
    return result
