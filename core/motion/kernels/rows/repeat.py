"""How the motion of a row ends: it repeats, separates, wanders, or still drifts (theory 17.4)."""

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.constants import STATUS
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.means import is_steady, mean_error, scatter, successive_means
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.contact import sign
from vibrafeed.core.motion.kernels.rows.row_state import (
    COLUMN,
    ROW_COLUMNS,
    TALLIES,
    TALLY,
    Air,
    Row,
    Whole,
)

MULTIPLES = 12
"""Periods of the longest cycle that is looked for: 2 and 4 are common, longer ones rare."""
AGREES = 1e-12
"""Difference of two states over the drive, below which they are the same; rounding leaves some
1e-15."""
AGREES_NEARLY = 1e-9
"""The same difference for the divisors of a cycle: what alternates and dies by a factor q per
period is told apart where q is below 0.999."""
LAGS = 4  # periods of the longest cycle whose slow transient is extrapolated
SLOW = 0.5  # ratio by which a change falls per cycle, below which it dies by itself
ALIKE = 0.1  # two successive ratios q differ by less than this share of 1 - q
NOISE = 4e-15  # of a change of velocity over the drive, by rounding
FARTHEST = 0.25  # largest jump of a velocity over the drive
NEARER = 0.5  # share of a gap by which parts that meet slowly are moved together
LARGEST_RATIO = 0.9999  # of a transient whose rest is estimated


class Past(NamedTuple):
    """States at the starts of the last periods: the row of period p is p % (MULTIPLES + 1).

    `touched` counts of each contact the last period in which its parts touched.
    """

    speed: Floats
    place: Floats
    gap: Floats
    landing: Floats
    touched: Whole


@compiled
def empty_past(row: Row) -> Past:
    """Return an empty buffer for the states of a row at the starts of the last periods."""
    size, parts, contacts = MULTIPLES + 1, row.mass.size, row.gap.size
    return Past(
        np.zeros((size, parts)), np.zeros((size, parts)), np.zeros((size, contacts)),
        np.zeros(size), np.zeros(contacts, dtype=np.int64),
    )  # fmt: skip


@compiled
def store_state(row: Row, air: Air, past: Past, period: int) -> None:
    """Store the state of a row at the start of period number `period` in the buffer `past`."""
    slot = period % (MULTIPLES + 1)
    past.speed[slot, :] = row.speed[: row.mass.size]
    past.place[slot, :] = row.place
    past.gap[slot, :] = row.gap
    past.landing[slot] = air.landing


@compiled
def repeats(
    row: Row, air: Air, past: Past, period: int, multiple: int, tolerance: float, scale: float
) -> bool:
    """True if the state of a row at period `period` equals that `multiple` periods before."""
    slot = (period - multiple) % (MULTIPLES + 1)
    landing, landing_before = air.landing, past.landing[slot]
    if (landing < math.inf) != (landing_before < math.inf):
        return False
    if landing < math.inf and abs(landing - landing_before) > tolerance:
        return False
    for i in range(row.mass.size):
        if abs(row.speed[i] - past.speed[slot, i]) > tolerance * scale:
            return False
    for i in range(row.gap.size):
        gap_growth = row.gap[i] - past.gap[slot, i]
        touched = past.touched[i] > period - multiple - 1
        # A gap may grow between parts that no longer touch: they separate for good.
        if abs(gap_growth) > tolerance * scale and (gap_growth < 0.0 or touched):
            return False
    return True


@compiled
def cycle_of(row: Row, air: Air, past: Past, period: int, counted_from: int, scale: float) -> int:
    """Return the periods, up to 12, after which a row repeats at period `period`; 0 if none."""
    for cycle in range(1, min(MULTIPLES, period - 1 - counted_from) + 1):
        if repeats(row, air, past, period, cycle, AGREES, scale):
            return cycle
    return 0


@compiled
def shortest_cycle(
    row: Row, air: Air, past: Past, period: int, cycle: int, tolerance: float, scale: float
) -> int:
    """Return the smallest divisor of a row's `cycle` after which it nearly repeats at `period`."""
    for divisor in range(1, cycle):
        if cycle % divisor == 0 and repeats(row, air, past, period, divisor, tolerance, scale):
            return divisor
    return cycle


@compiled
def remaining_transient(
    row: Row, past: Past, period: int, cycle: int, counted_from: int, scale: float
) -> float:
    """Return an estimate of what is left of a row's transient, in g/w.

    The largest d/(1 - q) of all velocities, with the changes d over the last `cycle` periods and q
    the ratio to those of the cycle before.
    """
    size, largest = MULTIPLES + 1, 0.0
    has_ratio = 2 * cycle <= MULTIPLES and period - 2 * cycle >= counted_from
    slot, earlier_slot = (period - cycle) % size, (period - 2 * cycle) % size
    for i in range(row.mass.size):
        change = abs(row.speed[i] - past.speed[slot, i])
        change_before = abs(past.speed[slot, i] - past.speed[earlier_slot, i])
        if has_ratio and change > NOISE * scale:
            ratio = (change + NOISE * scale) / max(change_before, change)
            change /= 1.0 - min(ratio, LARGEST_RATIO)
        largest = max(largest, change)
    return largest


@compiled
def platoons(
    row: Row, past: Past, period: int, multiple: int, scale: float, numbers: Floats
) -> int:
    """Return the count of platoons, groups that separate for good; fill each part's `numbers`."""
    slot = (period - multiple) % (MULTIPLES + 1)
    count = 1
    for i in range(row.mass.size):
        numbers[i] = count
        if i < row.mass.size - 1 and row.gap[i] - past.gap[slot, i] > AGREES * scale:
            count += past.touched[i] < period - multiple  # it opens, and was not closed since
    return count


# --- slow transients


@compiled
def extrapolate_transient(
    row: Row, past: Past, period: int, counted_from: int, scale: float
) -> bool:
    """Move a row along its slow transient at the end of a period; True if it was moved.

    Velocities whose changes d fall by a steady ratio q go to their limit, by q/(1 - q) d (Aitken's
    extrapolation). Where gaps alone shrink, half of the gap that closes first is left out.
    """
    for lag in range(1, LAGS + 1):
        if period - 3 * lag < counted_from:
            return False
        if _extrapolate(row, past, period, lag, scale):
            return True
    return False


@compiled
def _extrapolate(row: Row, past: Past, period: int, lag: int, scale: float) -> bool:
    # Aitken's extrapolation of each part's velocity from its last three changes over `lag` periods.
    # False, with nothing moved, where the changes do not fall by one steady ratio.
    size, moves = MULTIPLES + 1, False
    slot_1, slot_2, slot_3 = (
        (period - lag) % size,
        (period - 2 * lag) % size,
        (period - 3 * lag) % size,
    )
    for i in range(row.mass.size):
        change = row.speed[i] - past.speed[slot_1, i]
        change_before = past.speed[slot_1, i] - past.speed[slot_2, i]
        change_first = past.speed[slot_2, i] - past.speed[slot_3, i]
        row.value[i] = 0.0
        if max(abs(change), abs(change_before)) <= AGREES * scale:
            continue
        if change * change_before <= 0.0 or change_before * change_first <= 0.0:
            return False
        ratio, noise = change / change_before, NOISE * scale / abs(change)
        one_minus_ratio = max(0.0, 1.0 - ratio)
        if ratio < SLOW or ratio > 1.0 + noise:
            return False
        if abs(ratio - change_before / change_first) > ALIKE * one_minus_ratio + noise:
            return False
        largest_jump = FARTHEST * scale
        row.value[i] = (
            change * ratio / one_minus_ratio
            if abs(change) * ratio < largest_jump * one_minus_ratio
            else largest_jump * sign(change)
        )
        moves = True
    if not moves:
        return _shrink_gaps(row, past, period, lag, scale)
    for i in range(row.mass.size):
        row.speed[i] += row.value[i]
        if i > 0 and row.closed[i - 1] == 1:
            row.speed[i] = row.speed[i - 1]
        row.mode[i] = sign(row.speed[i])
    return True


@compiled
def _shrink_gaps(row: Row, past: Past, period: int, lag: int, scale: float) -> bool:
    # Cycles are skipped in which gaps alone shrink: as many as leave half of the gap that closes
    # first.
    slot, cycles = (period - lag) % (MULTIPLES + 1), math.inf
    for i in range(row.gap.size):
        gap_growth = row.gap[i] - past.gap[slot, i]
        if abs(gap_growth) > AGREES * scale and past.touched[i] > period - lag - 1:
            return False
        if gap_growth < -AGREES * scale:
            cycles = min(cycles, math.floor(NEARER * row.gap[i] / -gap_growth))
    if not 1.0 <= cycles < math.inf:
        return False
    for i in range(row.gap.size):
        row.gap[i] += cycles * (row.gap[i] - past.gap[slot, i])
    return True


# --- results


@compiled
def row_means(periods: Floats, parts: int) -> Floats:
    """Return the mean velocity of all `parts` of a row in each period, in g/w."""
    velocity = np.empty(periods.shape[0])
    for k in range(periods.shape[0]):
        velocity[k] = periods[k, TALLIES : TALLIES + parts].mean() / TURN
    return velocity


@compiled
def drifts(row: Row, past: Past, half: Floats, period: int, scale: float) -> bool:
    """True if a row that does not repeat is still on its way, so that it has no mean yet."""
    parts = row.mass.size
    batches = successive_means(row_means(half, parts))
    if not is_steady(batches, AGREES * scale):
        return True
    error = mean_error(batches) + AGREES * scale
    for i in range(parts):
        part_batches = successive_means(half[:, TALLIES + i]) / TURN
        if scatter(part_batches) > error and not is_steady(part_batches, AGREES * scale):
            return True
    periods_back = min(MULTIPLES, period)
    for i in range(row.gap.size):
        is_closing = (
            row.gap[i] - past.gap[(period - periods_back) % (MULTIPLES + 1), i] < -AGREES * scale
        )
        if is_closing and past.touched[i] < period - half.shape[0]:
            return True
    return False


@compiled
def fill_row_results(
    row: Row, past: Past, means: Floats, period: int, cycle: int, transient: float, scale: float,
    result: Floats,
) -> int:  # fmt: skip
    """Write the means of a row, and return its status.

    Over the cycle (`periodic`, `at_rest`), else over the second half of the periods (`aperiodic`;
    `limit_reached` if the row still drifts).
    """
    parts, capacity = row.mass.size, (result.size - ROW_COLUMNS) // 2
    chosen = means[period - cycle : period] if cycle > 0 else means[period // 2 : period]
    numbers = result[ROW_COLUMNS + capacity : ROW_COLUMNS + capacity + parts]
    periods_back = cycle if cycle > 0 else min(MULTIPLES, period)
    result[COLUMN.platoons] = platoons(row, past, period, periods_back, scale, numbers)
    result[COLUMN.multiple] = cycle
    _write_means(chosen, result, numbers)
    if cycle > 0:
        result[COLUMN.error], result[COLUMN.spread] = max(AGREES * scale, transient), 0.0
        return int(STATUS.periodic if chosen[:, TALLY.moving].max() > 0.0 else STATUS.at_rest)
    batches = successive_means(row_means(chosen, parts))
    result[COLUMN.spread] = scatter(batches)
    result[COLUMN.error] = mean_error(batches) + AGREES * scale
    still_drifts = drifts(row, past, chosen, period, scale)
    return int(STATUS.limit_reached if still_drifts else STATUS.aperiodic)


@compiled
def _write_means(periods: Floats, result: Floats, numbers: Floats) -> None:
    # `periods` has a row of sums for each period: `Tally`, the parts' distances, the integrals of
    # the gaps. `numbers` are those of the parts' platoons.
    count, parts = periods.shape[0], numbers.size
    phase = count * TURN
    slowest, fastest, total = math.inf, -math.inf, 0.0
    for i in range(parts):
        speed = periods[:, TALLIES + i].sum() / phase
        slowest, fastest = min(slowest, speed), max(fastest, speed)
        total += speed
        result[ROW_COLUMNS + i] = speed
    result[COLUMN.velocity] = total / parts
    result[COLUMN.slowest], result[COLUMN.fastest] = slowest, fastest
    result[COLUMN.contact] = periods[:, TALLY.closed].sum() / (phase * max(1, parts - 1))
    result[COLUMN.flight] = periods[:, TALLY.air].sum() / phase
    result[COLUMN.collisions] = periods[:, TALLY.hits].sum() / count
    result[COLUMN.impact] = periods[:, TALLY.lost].sum() / count
    struck = periods[:, TALLY.struck].sum()
    result[COLUMN.stop_force] = (periods[:, TALLY.pressed].sum() + struck) / phase
    result[COLUMN.stop_impulse] = struck / count
    result[COLUMN.stop_peak] = periods[:, TALLY.peak].max()
    result[COLUMN.stop_contact] = periods[:, TALLY.held].sum() / phase
    contacts_within, mean_gap_sum = 0, 0.0
    for i in range(parts - 1):
        if numbers[i] == numbers[i + 1]:
            contacts_within += 1
            mean_gap_sum += periods[:, TALLIES + parts + i].sum() / phase
    result[COLUMN.gap] = mean_gap_sum / contacts_within if contacts_within > 0 else math.nan
