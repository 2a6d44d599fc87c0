"""From lanes to slots: what the lanes of a tile have gathered is folded, and they are emptied.

A lane holds its cells' sum, their extremes and where these lie, and counts, several in one number.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiled import borrowing, disjoint
from vibrafeed.core.reduce.kernels.bits import bits, key

COUNT_BITS = 8
"""Bits of a count in a lane, which gathers fewer than 2^8 cells."""
COUNTS = 6
"""Counts of 8 bits that are packed into one float, whose whole numbers are exact up to 2^53."""
WIDER = (1 << 2 * COUNT_BITS) - 1  # mask of a count in twice as many bits
EVERY_OTHER = sum(((1 << COUNT_BITS) - 1) << (2 * COUNT_BITS * k) for k in range(COUNTS // 2))
"""Mask of the bits of the first count, the third and so on."""
DIGIT = 40
"""Bits of a digit of an exact sum."""

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@borrowing
def fold_sums(
    sums: Array,
    order: Integers,
    slots: Integers,
    offset: int,
    line: Array,
    digits: Integers,
    beyond: Array,
    levels: Integers,
) -> None:
    """Add the sums in the lanes of each slot, and their total to the exact sum of the slot.

    A slot is a point of the result, a lane a place in which a loop has gathered cells of one slot.
    Lanes are added pairwise, which keeps rounding small.

    Parameters
    ----------
    sums : ndarray, shape (lanes,)
        The sum in each lane; 0 afterwards.
    order : ndarray of int64, shape (lanes,)
        The lanes of the first slot, then of the second: as many of each.
    slots, offset : ndarray of int64, shape (slots,), int
        Slots of the tile among those of the box, but for the offset.
    line : ndarray
        Room for the lanes of a slot.
    digits : ndarray of int64, shape (levels, slots of the box)
        Updated exact sums: digits of 40 bits each, with their sign; level 0 has the unit 2^-1074.
    beyond, levels : ndarray, shape (slots of the box,), ndarray of int64, shape (2,)
        Updated: the sum of what is no finite number; lowest and highest level that is in use.
    """
    each = order.size // slots.size
    mine = line[:each]
    for slot in range(slots.size):
        for k in range(each):
            mine[k] = sums[order[slot * each + k]]
        left = each
        while left > 1:
            half = (left + 1) // 2
            for k in range(left - half):
                mine[k] += mine[half + k]
            left = half
        total = mine[0]
        place = offset + slots[slot]
        if abs(total) < math.inf:
            _add(total, digits[:, place], levels)
        else:
            beyond[place] += total
    sums[:] = 0.0


@borrowing
def _add(value: float, digits: Integers, levels: Integers) -> None:
    """Add a float to the exact sum of one slot, an integer in digits of 40 bits, without rounding.

    The 53 bits of `value` go into at most three of `digits`, int64, shape (levels,), the least
    first. `levels` has the lowest and highest level in use and is updated.
    """
    own = bits(value)
    exponent = (own >> 52) & 0x7FF
    fraction = own & 0xFFFFFFFFFFFFF
    if exponent:
        fraction |= 1 << 52
        exponent -= 1
    if fraction == 0:
        return
    level, shift = exponent // DIGIT, exponent % DIGIT
    mask = (1 << DIGIT) - 1
    rest = fraction >> (DIGIT - shift)
    sign = -1 if own < 0 else 1
    digits[level] += sign * ((fraction << shift) & mask)
    digits[level + 1] += sign * (rest & mask)
    digits[level + 2] += sign * (rest >> DIGIT)
    levels[0] = min(levels[0], level)
    levels[1] = max(levels[1], level + 2)


@borrowing
def fold_extremes(
    values: Array,
    numbers: Array,
    least: bool,
    order: Integers,
    slots: Integers,
    offset: int,
    own_numbers: Integers,
    keys: Integers,
    held_numbers: Integers,
) -> None:
    """Update the extremes of slots from those in lanes; among equal values the lowest cell wins.

    A slot is a point of the result, a lane a place in which a loop has gathered cells of one slot.

    Parameters
    ----------
    values : ndarray, shape (lanes,)
        The extreme in each lane; empty afterwards, which is NaN where a place is wanted, else
        infinite.
    numbers : ndarray, shape (lanes,) or (0,)
        The number of the row that it lies in, infinite where there is none; empty if no place is
        wanted.
    least : bool
        True if the least is wanted; else the largest.
    order, own_numbers : ndarray of int64, shape (lanes,)
        The lanes of the first slot, then of the second, as many of each; what the place of a lane
        in the row adds to the number.
    slots, offset : ndarray of int64, shape (slots,), int
        Slots of the tile among those of the box, but for an offset.
    keys, held_numbers : ndarray of int64, shape (slots of the box,)
        Updated: key (an integer that sorts like the float) and cell of the extreme of each slot.
    """
    empty = math.inf if least else -math.inf
    each = order.size // slots.size
    for slot in range(slots.size):
        best, lowest = empty, math.inf
        for k in range(slot * each, (slot + 1) * each):
            lane = order[k]
            value = values[lane]
            number = numbers[lane] + own_numbers[lane] if numbers.size else 0.0
            is_better = value < best if least else value > best
            if is_better or (value == best and number < lowest):
                best, lowest = value, number
        if lowest == math.inf:
            continue
        own, at = key(best + 0.0), int(lowest)
        here = offset + slots[slot]
        is_better = own < keys[here] if least else own > keys[here]
        if is_better or (own == keys[here] and at < held_numbers[here]):
            keys[here], held_numbers[here] = own, at
    values[:] = math.nan if numbers.size else empty
    numbers[:] = math.inf


@borrowing
def fold_counts(
    packed: Array, order: Integers, slots: Integers, offset: int, counts: Integers
) -> None:
    """Add the counts that cells have left in lanes to those of their slots, points of the result.

    Several counts are packed into one number. Every other count has room for twice as many bits, so
    that 256 lanes are added before counts are taken apart.

    Parameters
    ----------
    packed : ndarray, shape (lanes,)
        The packed counts; 0 afterwards.
    order : ndarray of int64, shape (lanes,)
        The lanes of the first slot, then of the second, as many of each.
    slots, offset : ndarray of int64, shape (slots,), int
        The slots of the tile among those of the box, but for the offset.
    counts : ndarray of int64, shape (counts, slots of the box)
        Updated.
    """
    each = order.size // slots.size
    for slot in range(slots.size):
        here = offset + slots[slot]
        for first in range(slot * each, (slot + 1) * each, 1 << COUNT_BITS):
            even, odd = 0, 0
            for k in range(first, min(first + (1 << COUNT_BITS), (slot + 1) * each)):
                own = int(packed[order[k]])
                even += own & EVERY_OTHER
                odd += (own >> COUNT_BITS) & EVERY_OTHER
            for k in range(counts.shape[0]):
                pair = odd if k % 2 else even
                counts[k, here] += (pair >> (k // 2 * 2 * COUNT_BITS)) & WIDER
    packed[:] = 0.0


@disjoint
def gather(
    cells: Array,
    starts: Integers,
    numbers: Integers,
    piece: int,
    piece_lanes: int,
    piece_number: int,
    counts: Array,
    sums: Array,
    largest: Array,
    largest_at: Array,
    least: Array,
    least_at: Array,
) -> None:
    """Add stored cells to lanes, places for totals, in the same order as a compiled loop does.

    So results do not depend on whether cells were stored.

    Parameters
    ----------
    cells : ndarray, shape (rows, cells of a row)
        NaN where a cell does not count.
    starts, numbers : ndarray of int64, shape (rows,)
        First lane and number of each row.
    piece : int
        Cells of a row that are taken at once.
    piece_lanes, piece_number : int
        Lanes and numbers from one piece to the next.
    counts, sums, largest, largest_at, least, least_at : ndarray, shape (lanes,)
        Updated: the totals in the lanes, and the numbers of the rows in which the extremes lie.
    """
    for turn in range((cells.shape[1] + piece - 1) // piece):
        for row in range(cells.shape[0]):
            mine = cells[row, turn * piece : (turn + 1) * piece]
            start = starts[row] + turn * piece_lanes
            number = float(numbers[row] + turn * piece_number)
            stop = start + mine.size
            own_counts, own_sums = counts[start:stop], sums[start:stop]
            high, high_at = largest[start:stop], largest_at[start:stop]
            low, low_at = least[start:stop], least_at[start:stop]
            for i in range(mine.size):
                value = mine[i]
                counted = value == value
                own_counts[i] += 1.0 if counted else 0.0
                own_sums[i] += value if counted else 0.0
                higher = counted & (
                    (not (value <= high[i])) | ((value == high[i]) & (number < high_at[i]))
                )
                high[i] = (value if higher else high[i]) + 0.0
                high_at[i] = (number if higher else high_at[i]) + 0.0
                lower = counted & (
                    (not (value >= low[i])) | ((value == low[i]) & (number < low_at[i]))
                )
                low[i] = (value if lower else low[i]) + 0.0
                low_at[i] = (number if lower else low_at[i]) + 0.0
