"""Statistics of an output over the rows of a box: largest, least, number of cells, exact sum.

A row is a run of cells one after another. Either all of it goes to one slot of the result, or its
cells go to slots one after another. All accumulators are integers, so that neither the order of
cells nor how they are cut into boxes can change them.

A sum is exact. A float is split into whole multiples of `unit`, of `unit` / 2^40 and so on: adding
1.5 x 2^52 x `unit` rounds it to such a multiple, and the last bits of the result are the multiple.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.compiled import borrowing, disjoint
from core.reduce.kernels.bits import LEAST, MAGNITUDE, MOST, bits, counted, key

HUGE = 2.0**960
"""What is not smaller has no place in a sum: a mean of it is infinite."""

PIECE = 4096
"""Cells that are looked at again if two levels do not take them all."""

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@borrowing
def along_rows(
    values: Array,
    regimes: NDArray[np.int8],
    valid: int,
    slots: Integers,
    length: int,
    anchors: Array,
    ends: Integers,
    sums: Integers,
) -> int:
    """Reduce each row to one slot; return how many cells the sum could not take.

    Parameters
    ----------
    values, regimes : ndarray, shape (cells,)
        The output and the regime of each cell.
    valid : int
        The regimes that count, one bit each.
    slots : ndarray, shape (rows,)
        Where each row goes.
    length : int
        Cells of a row.
    anchors : ndarray, shape (levels,)
        1.5 x 2^52 times the unit of each level, two at least; none if no sum is wanted.
    ends : ndarray, shape (5, slots)
        Key and cell of the largest, key and cell of the least, and the number of cells.
    sums : ndarray, shape (levels, slots)
        Units of each level.
    """
    left = 0
    for row in range(slots.size):
        slot, here = slots[row], slice(row * length, (row + 1) * length)
        mine, states = values[here], regimes[here]
        largest, least, count = _ends(mine, states, valid)
        ends[4, slot] += count
        if largest > ends[0, slot]:
            ends[0, slot] = largest
            ends[1, slot] = row * length + _first(mine, states, valid, largest)
        if least < ends[2, slot]:
            ends[2, slot] = least
            ends[3, slot] = row * length + _first(mine, states, valid, least)
        if anchors.size:
            for start in range(0, length, PIECE):
                left += _summed(
                    mine[start : start + PIECE], states[start : start + PIECE],
                    valid, anchors, slot, sums,
                )  # fmt: skip
    return left


@borrowing
def _summed(
    values: Array, regimes: NDArray[np.int8], valid: int, anchors: Array, slot: int, sums: Integers
) -> int:
    """Add some cells to the sum of a slot; return how many it could not take."""
    high, low, rest = _sum(values, regimes, valid, anchors[0], anchors[1])
    sums[0, slot] += high
    sums[1, slot] += low
    left = 0
    if rest:
        for k in range(values.size):
            if counted(values[k], regimes[k], valid):
                left += _deeper(values[k], anchors, slot, sums)
    return left


@borrowing
def _ends(values: Array, regimes: NDArray[np.int8], valid: int) -> tuple[int, int, int]:
    """Return the keys of the largest and the least value of a row, and how many cells count."""
    largest, least, count = LEAST, MOST, 0
    for k in range(values.size):
        value = values[k] + 0.0
        counts = counted(value, regimes[k], valid)
        own = key(value)
        largest = max(largest, own if counts else LEAST)
        least = min(least, own if counts else MOST)
        count += 1 if counts else 0
    return largest, least, count


@borrowing
def _sum(
    values: Array, regimes: NDArray[np.int8], valid: int, first: float, second: float
) -> tuple[int, int, int]:
    """Return the sum of a row in units of two levels; the last is not 0 if they leave some."""
    first_bits, second_bits = bits(first), bits(second)
    high, low, rest = 0, 0, 0
    for k in range(values.size):
        value = values[k]
        part = value if counted(value, regimes[k], valid) & (abs(value) < HUGE) else 0.0
        one = part + first
        high += bits(one) - first_bits
        part -= one - first
        two = part + second
        low += bits(two) - second_bits
        rest |= bits(part - (two - second)) & MAGNITUDE
    return high, low, rest


@borrowing
def across_rows(
    values: Array,
    regimes: NDArray[np.int8],
    valid: int,
    slots: Integers,
    length: int,
    anchors: Array,
    ends: Integers,
    sums: Integers,
) -> int:
    """Reduce rows whose cells go to slots one after another; as `along_rows` otherwise.

    `slots` says where the first cell of each row goes.
    """
    left = 0
    for row in range(slots.size):
        here = slice(row * length, (row + 1) * length)
        there = slice(slots[row], slots[row] + length)
        mine, states = values[here], regimes[here]
        _spread_ends(
            mine, states, valid, row * length,
            ends[0][there], ends[1][there], ends[2][there], ends[3][there], ends[4][there],
        )  # fmt: skip
        if anchors.size and _spread_sums(
            mine, states, valid, anchors[0], anchors[1], sums[0][there], sums[1][there]
        ):
            for k in range(length):
                if counted(mine[k], states[k], valid):
                    left += _deeper(mine[k], anchors, slots[row] + k, sums)
    return left


@disjoint
def _spread_ends(
    values: Array,
    regimes: NDArray[np.int8],
    valid: int,
    start: int,
    largest: Integers,
    largest_at: Integers,
    least: Integers,
    least_at: Integers,
    count: Integers,
) -> None:
    """Take each cell of a row into the ends of its own slot."""
    for k in range(values.size):
        value = values[k] + 0.0
        counts = counted(value, regimes[k], valid)
        own = key(value)
        high, low = own if counts else LEAST, own if counts else MOST
        higher, lower = high > largest[k], low < least[k]
        largest[k] = high if higher else largest[k]
        largest_at[k] = start + k if higher else largest_at[k]
        least[k] = low if lower else least[k]
        least_at[k] = start + k if lower else least_at[k]
        count[k] += 1 if counts else 0


@disjoint
def _spread_sums(
    values: Array,
    regimes: NDArray[np.int8],
    valid: int,
    first: float,
    second: float,
    high: Integers,
    low: Integers,
) -> int:
    """Add each cell of a row to the sum of its own slot; return 0 if two levels take them all."""
    first_bits, second_bits, rest = bits(first), bits(second), 0
    for k in range(values.size):
        value = values[k]
        part = value if counted(value, regimes[k], valid) & (abs(value) < HUGE) else 0.0
        one = part + first
        high[k] += bits(one) - first_bits
        part -= one - first
        two = part + second
        low[k] += bits(two) - second_bits
        rest |= bits(part - (two - second)) & MAGNITUDE
    return rest


@borrowing
def _deeper(value: float, anchors: Array, slot: int, sums: Integers) -> int:
    """Add what the first two levels leave of a value; return 1 if even the last leaves some."""
    if abs(value) >= HUGE:
        return 0
    for level in range(anchors.size):
        anchor = anchors[level]
        moved = value + anchor
        if level > 1:
            sums[level, slot] += bits(moved) - bits(anchor)
        value -= moved - anchor
    return 1 if value != 0.0 else 0


@borrowing
def _first(values: Array, regimes: NDArray[np.int8], valid: int, wanted: int) -> int:
    """Return the first cell of a row that counts and has the wanted key."""
    k = 0
    while key(values[k] + 0.0) != wanted or not counted(values[k], regimes[k], valid):
        k += 1
    return k
