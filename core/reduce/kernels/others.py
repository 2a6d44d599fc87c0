"""Counts, conditions, histograms and crossings over the cells of a box; rows as in `Rows`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.reduce.kernels.bits import counted, key

SHIFT = 43
"""Low bits of a float that its bin leaves out: 9 bits of the fraction are left, so that a bin is
1/512 of a value wide."""
BINS = 1 << (64 - SHIFT)

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.int8]


@borrowing
def count_along(flags: Flags, wanted: int, slots: Integers, length: int, counts: Integers) -> None:
    """Count the cells with a flag, such as a regime, where all cells of a row have one slot.

    A slot is a point of the reduced result.

    Parameters
    ----------
    flags : ndarray of int8
        The cells, row after row of `length`.
    wanted : int
        The flag to count.
    slots : ndarray of int64, shape (rows,)
        The slot of each row.
    counts : ndarray of int64, shape (slots,)
        The number of cells equal to `wanted` is added.
    """
    for row in range(slots.size):
        mine = flags[row * length : (row + 1) * length]
        count = 0
        for k in range(mine.size):
            count += 1 if mine[k] == wanted else 0
        counts[slots[row]] += count


@borrowing
def count_across(flags: Flags, wanted: int, slots: Integers, length: int, counts: Integers) -> None:
    """Count the cells that have a flag, such as a regime, each cell of a row in its own slot.

    A slot is a point of the reduced result.

    Parameters
    ----------
    flags : ndarray of int8
        The cells, row after row of `length`.
    wanted : int
        The flag to count.
    slots : ndarray of int64, shape (rows,)
        The slot of the first cell of each row; the others follow.
    counts : ndarray of int64, shape (slots,)
        1 is added for each cell equal to `wanted`.
    """
    for row in range(slots.size):
        mine = flags[row * length : (row + 1) * length]
        here = counts[slots[row] : slots[row] + length]
        for k in range(mine.size):
            here[k] += 1 if mine[k] == wanted else 0


@borrowing
def meet(
    values: Array, regimes: Flags, valid: int, comparison: int, level: float, met: Flags
) -> None:
    """Clear the flag `met` of cells that do not count, or whose value fails a comparison.

    It counts the cells that meet the conditions of a share. All arrays have the shape (cells,).

    Parameters
    ----------
    values, regimes : ndarray
        Values of an output, and numbers of the regimes.
    valid : int
        A bit for each regime that counts.
    comparison : int
        A bit each for a value below the level (1), equal to it (2) and above it (4).
    level : float
        The level.
    met : ndarray of int8
        Updated flags.
    """
    below, equal, above = comparison & 1 != 0, comparison & 2 != 0, comparison & 4 != 0
    for k in range(values.size):
        value = values[k]
        holds = (below & (value < level)) | (equal & (value == level)) | (above & (value > level))
        met[k] = met[k] if counted(value, regimes[k], valid) & holds else 0


@borrowing
def masked(values: Array, regimes: Flags, valid: int, result: Array) -> None:
    """Fill `result` with the values of cells that count, and NaN for others.

    `valid` has a bit for each regime that counts.
    """
    for k in range(values.size):
        value = values[k] + 0.0
        result[k] = value if counted(value, regimes[k], valid) else math.nan


@borrowing
def histogram(values: Array, regimes: Flags, valid: int, counts: Integers) -> None:
    """Add the cells of a box that count to a histogram by the leading bits of their values.

    Quantiles are taken from it. `values` and `regimes` are those of the cells, flat; `valid` has a
    bit for each regime that counts; `counts` has `BINS` bins, in the order of values.
    """
    for k in range(values.size):
        value = values[k] + 0.0
        if counted(value, regimes[k], valid):
            counts[np.uint64((key(value) >> SHIFT) + BINS // 2)] += 1


@borrowing
def crossings(
    values: Array,
    regimes: Flags,
    valid: int,
    level: float,
    axis: Array,
    stride: int,
    largest: bool,
    slots: Integers,
    length: int,
    spread: bool,
    extremes: Array,
) -> None:
    """Find where an output crosses a level between neighbours along an axis, and keep the extremes.

    A crossing is a value of the axis, interpolated between two cells that both count.

    Parameters
    ----------
    values, regimes : ndarray, shape (cells,)
        Output and regimes of the cells of a box, flat.
    valid : int
        A bit for each regime that counts.
    level : float
        The level.
    axis : ndarray
        The values of the axis along which neighbours lie.
    stride : int
        Cells from one neighbour to the next.
    largest : bool
        True if the largest of several crossings is wanted; else the smallest.
    slots, length, spread : ndarray of int64 (rows,), int, bool
        A slot, a point of the result, for each row of `length` cells; if `spread`, that of the
        first cell of the row, and the others follow.
    extremes : ndarray, shape (slots,)
        Updated: the crossing so far of each slot; infinite if there is none.
    """
    lines = values.size // (axis.size * stride)
    for line in range(lines):
        for at in range(1, axis.size):
            start = (line * axis.size + at) * stride
            before = values[start - stride : start]
            mine = values[start : start + stride]
            for k in range(mine.size):
                lower, upper = before[k], mine[k]
                if not ((lower <= level <= upper) or (lower >= level >= upper)):
                    continue
                cell = start + k
                if not (
                    counted(lower, regimes[cell - stride], valid)
                    and counted(upper, regimes[cell], valid)
                ):
                    continue
                first, last = axis[at - 1], axis[at]
                crossing = _between(lower, upper, level, first, last, largest)
                row = cell // length
                slot = slots[row] + (cell - row * length if spread else 0)
                if (crossing > extremes[slot]) if largest else (crossing < extremes[slot]):
                    extremes[slot] = crossing


@borrowing
def _between(
    lower: float, upper: float, level: float, first: float, last: float, largest: bool
) -> float:
    """Return the point of an axis at which a straight line between two cells crosses a level.

    `lower` and `upper` are the values of an output in the cells at the points `first` and `last` of
    the axis, on both sides of `level`; either may be infinite. If both are the level, it is the
    larger or the smaller point, by `largest`.
    """
    if lower == level and upper == level:
        return max(first, last) if largest else min(first, last)
    if lower == level or math.isinf(upper):
        return first
    if upper == level or math.isinf(lower):
        return last
    return first + (level - lower) / (upper - lower) * (last - first)
