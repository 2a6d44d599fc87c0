"""Exact sums of floats, as whole multiples of powers of 2^40: equal however they are split."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

DIGIT = 40
"""Bits of a digit of an exact sum: the units of two levels differ by 2^40."""
LOWEST = -1074
"""The unit of level 0 is 2^-1074, the least float above 0."""
LEVELS = 2098 // DIGIT + 4
"""Number of levels that any float fits in, with those for what is carried."""

Integers = NDArray[np.int64]


def propagate_carries(sums: Integers) -> Integers:
    """Return exact sums of floats with carries propagated from each digit to the next.

    An exact sum is an integer in digits of 40 bits with sign, an array of shape (levels, slots),
    least digit first. Adding leaves digits too large; each is brought back into its range.
    """
    sums = sums.copy()
    half = 1 << (DIGIT - 1)
    for level in range(len(sums) - 1):
        over = (sums[level] + half) >> DIGIT
        sums[level] -= over << DIGIT
        sums[level + 1] += over
    return sums


def add_sums(first: tuple[int, Integers], second: tuple[int, Integers]) -> tuple[int, Integers]:
    """Return the sum of two exact sums of floats, each with its lowest level.

    An exact sum is an integer in digits of 40 bits, an array of shape (levels, slots), so that its
    result does not depend on the order of adding. The lowest level says which power of 2^40 its
    first digit counts.
    """
    low = min(first[0], second[0])
    high = max(level + len(sums) for level, sums in (first, second))
    total = np.zeros((high - low, first[1].shape[1]), np.int64)
    for level, sums in (first, second):
        total[level - low : level - low + len(sums)] += sums
    return low, propagate_carries(total)


def means(low: int, sums: Integers, counts: Integers) -> NDArray[np.float64]:
    """Return means from exact sums and counts, rounded once, shape (slots,); NaN for a count of 0.

    An exact sum is an integer in digits of 40 bits; `sums` has them, shape (levels, slots), and
    `low` says which power of 2^40 the first digit counts. `counts` has the shape (slots,).
    """
    result = np.full(counts.shape, np.nan)
    unit = LOWEST + DIGIT * low
    for slot in np.flatnonzero(counts).tolist():
        total = sum(int(digit) << (DIGIT * k) for k, digit in enumerate(sums[:, slot].tolist()))
        count = int(counts[slot])
        # The quotient of two integers is rounded once, and right.
        result[slot] = (total << unit) / count if unit >= 0 else total / (count << -unit)
    return result
