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
def past_of(row: Row) -> Past:
    """Return an empty buffer for the states of a row at the starts of the last periods."""
    size, parts, contacts = MULTIPLES + 1, row.mass.size, row.gap.size
    return Past(
        np.zeros((size, parts)), np.zeros((size, parts)), np.zeros((size, contacts)),
        np.zeros(size), np.zeros(contacts, dtype=np.int64),
    )  # fmt: skip


@compiled
def keep(row: Row, air: Air, past: Past, period: int) -> None:
    """Store the state of a row at the start of period number `period` in the buffer `past`."""
    at = period % (MULTIPLES + 1)
    past.speed[at, :] = row.speed[: row.mass.size]
    past.place[at, :] = row.place
    past.gap[at, :] = row.gap
    past.landing[at] = air.landing


@compiled
def repeats(
    row: Row, air: Air, past: Past, period: int, multiple: int, agrees: float, scale: float
) -> bool:
    """True if the state of a row at period `period` equals that `multiple` periods before."""
    at = (period - multiple) % (MULTIPLES + 1)
    here, before = air.landing, past.landing[at]
    if (here < math.inf) != (before < math.inf):
        return False
    if here < math.inf and abs(here - before) > agrees:
        return False
    for i in range(row.mass.size):
        if abs(row.speed[i] - past.speed[at, i]) > agrees * scale:
            return False
    for i in range(row.gap.size):
        grown = row.gap[i] - past.gap[at, i]
        touched = past.touched[i] > period - multiple - 1
        if abs(grown) > agrees * scale and (grown < 0.0 or touched):
            return False
    return True


@compiled
def cycle_of(row: Row, air: Air, past: Past, period: int, since: int, scale: float) -> int:
    """Return the periods, up to 12, after which a row repeats at period `period`; 0 if none."""
    for cycle in range(1, min(MULTIPLES, period - 1 - since) + 1):
        if repeats(row, air, past, period, cycle, AGREES, scale):
            return cycle
    return 0


@compiled
def shortest(
    row: Row, air: Air, past: Past, period: int, cycle: int, nearly: float, scale: float
) -> int:
    """Return the smallest divisor of a row's `cycle` after which it nearly repeats at `period`."""
    for part in range(1, cycle):
        if cycle % part == 0 and repeats(row, air, past, period, part, nearly, scale):
            return part
    return cycle


@compiled
def remaining(row: Row, past: Past, period: int, cycle: int, since: int, scale: float) -> float:
    """Return an estimate of what is left of a row's transient, in g/w.

    The largest d/(1 - q) of all velocities, with the changes d over the last `cycle` periods and q
    the ratio to those of the cycle before.
    """
    size, left = MULTIPLES + 1, 0.0
    known = 2 * cycle <= MULTIPLES and period - 2 * cycle >= since
    at, earlier = (period - cycle) % size, (period - 2 * cycle) % size
    for i in range(row.mass.size):
        last = abs(row.speed[i] - past.speed[at, i])
        before = abs(past.speed[at, i] - past.speed[earlier, i])
        if known and last > NOISE * scale:
            ratio = (last + NOISE * scale) / max(before, last)
            last /= 1.0 - min(ratio, LARGEST_RATIO)
        left = max(left, last)
    return left


@compiled
def platoons(
    row: Row, past: Past, period: int, multiple: int, scale: float, numbers: Floats
) -> int:
    """Return the number of platoons of a row: groups of parts that separate for good."""
    at = (period - multiple) % (MULTIPLES + 1)
    count = 1
    for i in range(row.mass.size):
        numbers[i] = count
        if i < row.mass.size - 1 and row.gap[i] - past.gap[at, i] > AGREES * scale:
            count += past.touched[i] < period - multiple
    return count


# --- slow transients


@compiled
def hasten(row: Row, past: Past, period: int, since: int, scale: float) -> bool:
    """Move a row along its slow transient at the end of a period; True if it was moved.

    Velocities whose changes d fall by a steady ratio q go to their limit, by q/(1 - q) d (Aitken's
    extrapolation). Where gaps alone shrink, half of the gap that closes first is left out.
    """
    for lag in range(1, LAGS + 1):
        if period - 3 * lag < since:
            return False
        if _extrapolate(row, past, period, lag, scale):
            return True
    return False


@compiled
def _extrapolate(row: Row, past: Past, period: int, lag: int, scale: float) -> bool:
    size, moves = MULTIPLES + 1, False
    one, two, three = (period - lag) % size, (period - 2 * lag) % size, (period - 3 * lag) % size
    for i in range(row.mass.size):
        last = row.speed[i] - past.speed[one, i]
        before = past.speed[one, i] - past.speed[two, i]
        first = past.speed[two, i] - past.speed[three, i]
        row.value[i] = 0.0
        if max(abs(last), abs(before)) <= AGREES * scale:
            continue
        if last * before <= 0.0 or before * first <= 0.0:
            return False
        ratio, noise = last / before, NOISE * scale / abs(last)
        rest = max(0.0, 1.0 - ratio)
        if ratio < SLOW or ratio > 1.0 + noise:
            return False
        if abs(ratio - before / first) > ALIKE * rest + noise:
            return False
        most = FARTHEST * scale
        row.value[i] = last * ratio / rest if abs(last) * ratio < most * rest else most * sign(last)
        moves = True
    if not moves:
        return _draw_together(row, past, period, lag, scale)
    for i in range(row.mass.size):
        row.speed[i] += row.value[i]
        if i > 0 and row.closed[i - 1] == 1:
            row.speed[i] = row.speed[i - 1]
        row.mode[i] = sign(row.speed[i])
    return True


@compiled
def _draw_together(row: Row, past: Past, period: int, lag: int, scale: float) -> bool:
    at, cycles = (period - lag) % (MULTIPLES + 1), math.inf
    for i in range(row.gap.size):
        grown = row.gap[i] - past.gap[at, i]
        if abs(grown) > AGREES * scale and past.touched[i] > period - lag - 1:
            return False
        if grown < -AGREES * scale:
            cycles = min(cycles, math.floor(NEARER * row.gap[i] / -grown))
    if not 1.0 <= cycles < math.inf:
        return False
    for i in range(row.gap.size):
        row.gap[i] += cycles * (row.gap[i] - past.gap[at, i])
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
        own = successive_means(half[:, TALLIES + i]) / TURN
        if scatter(own) > error and not is_steady(own, AGREES * scale):
            return True
    back = min(MULTIPLES, period)
    for i in range(row.gap.size):
        closes = row.gap[i] - past.gap[(period - back) % (MULTIPLES + 1), i] < -AGREES * scale
        if closes and past.touched[i] < period - half.shape[0]:
            return True
    return False


@compiled
def finish(
    row: Row, past: Past, means: Floats, period: int, cycle: int, left: float, scale: float,
    result: Floats,
) -> int:  # fmt: skip
    """Write the means of a row, and return its status.

    Over the cycle (`periodic`, `at_rest`), else over the second half of the periods (`aperiodic`;
    `limit_reached` if the row still drifts).
    """
    parts, room = row.mass.size, (result.size - ROW_COLUMNS) // 2
    chosen = means[period - cycle : period] if cycle > 0 else means[period // 2 : period]
    numbers = result[ROW_COLUMNS + room : ROW_COLUMNS + room + parts]
    back = cycle if cycle > 0 else min(MULTIPLES, period)
    result[COLUMN.platoons] = platoons(row, past, period, back, scale, numbers)
    result[COLUMN.multiple] = cycle
    _write(chosen, result, numbers)
    if cycle > 0:
        result[COLUMN.error], result[COLUMN.spread] = max(AGREES * scale, left), 0.0
        return int(STATUS.periodic if chosen[:, TALLY.moving].max() > 0.0 else STATUS.at_rest)
    batches = successive_means(row_means(chosen, parts))
    result[COLUMN.spread] = scatter(batches)
    result[COLUMN.error] = mean_error(batches) + AGREES * scale
    late = drifts(row, past, chosen, period, scale)
    return int(STATUS.limit_reached if late else STATUS.aperiodic)


@compiled
def _write(periods: Floats, result: Floats, numbers: Floats) -> None:
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
    together, swept = 0, 0.0
    for i in range(parts - 1):
        if numbers[i] == numbers[i + 1]:
            together += 1
            swept += periods[:, TALLIES + parts + i].sum() / phase
    result[COLUMN.gap] = swept / together if together > 0 else math.nan
