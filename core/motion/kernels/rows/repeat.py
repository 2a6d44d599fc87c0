"""How the motion of a row ends: it repeats, separates, wanders, or still drifts (theory 17.4)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.means import is_steady, mean_error, scatter, successive_means
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.advance import Air
from vibrafeed.core.motion.kernels.rows.contact import sign
from vibrafeed.core.motion.kernels.rows.tables import (
    COLUMN,
    ROW_COLUMNS,
    TALLIES,
    TALLY,
    Row,
    Whole,
)
from vibrafeed.core.motion.kernels.statuses import STATUS

MULTIPLES = 12
"""Periods of the longest cycle that is looked for: 2 and 4 are common, longer ones rare."""
AGREES = 1e-12
"""Difference of two states over the drive, below which they are the same; rounding leaves some
1e-15."""
AGREES_NEARLY = 1e-9
"""The same difference for the divisors of a cycle that was found.

What alternates and dies by a factor q per period differs by 1/(1 - q) times as much after one
period as after two: both are told apart where q is below 0.999.
"""
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
    """Return an empty buffer for the states of a row at the starts of the last periods.

    `Past` with arrays of zeros, for MULTIPLES + 1 periods and the parts and contacts of the row;
    states are compared in it to see if the motion repeats.
    """
    size, parts, contacts = MULTIPLES + 1, row.mass.size, row.gap.size
    return Past(
        np.zeros((size, parts)), np.zeros((size, parts)), np.zeros((size, contacts)),
        np.zeros(size), np.zeros(contacts, dtype=np.int64),
    )  # fmt: skip


@compiled
def keep(row: Row, air: Air, past: Past, period: int) -> None:
    """Store the state of a row at the start of period number `period` in the buffer `past`.

    Velocities, positions, gaps, and the phase until landing of `air`, the flight of all parts.
    Later states are compared with it, to see if the motion repeats.
    """
    at = period % (MULTIPLES + 1)
    past.speed[at, :] = row.speed[: row.mass.size]
    past.place[at, :] = row.place
    past.gap[at, :] = row.gap
    past.landing[at] = air.landing


@compiled
def repeats(
    row: Row, air: Air, past: Past, period: int, multiple: int, agrees: float, scale: float
) -> bool:
    """True if the state of a row at period number `period` equals that `multiple` periods before.

    Velocities and gaps must agree within `agrees` relative to `scale`, the size of the drive in g,
    and the phase until landing within as many rad. A gap may have grown if its parts did not touch
    in between: each side of it then moves as it did, and the gap grows for ever. `air` is the
    flight of the parts now, `past` holds the earlier states.
    """
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
    """Return the periods, up to 12, after which a row repeats now, at period `period`; 0 if none.

    Only states from period `since` on count. `air` is the flight of the parts, `past` holds the
    states before, `scale` is the size of the drive in g.
    """
    for cycle in range(1, min(MULTIPLES, period - 1 - since) + 1):
        if repeats(row, air, past, period, cycle, AGREES, scale):
            return cycle
    return 0


@compiled
def shortest(
    row: Row, air: Air, past: Past, period: int, cycle: int, nearly: float, scale: float
) -> int:
    """Return the smallest divisor of a row's `cycle` after which its state at `period` is the same.

    Within `nearly` of the drive. What alternates while it dies out differs least over an even
    number of periods, so that the test of two periods is passed before that of one.
    """
    for part in range(1, cycle):
        if cycle % part == 0 and repeats(row, air, past, period, part, nearly, scale):
            return part
    return cycle


@compiled
def remaining(row: Row, past: Past, period: int, cycle: int, since: int, scale: float) -> float:
    """Return an estimate of what is left of a row's transient, in g/w (w = 2 pi f).

    The largest d/(1 - q) of all velocities, with the changes d over the last `cycle` periods and d'
    over the cycle before, and q = (d + r)/d' at most 0.9999, r the rounding of a change. The
    largest d alone if the cycle before began before period `since`. `scale` is the size of the
    drive in g.
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
    """Return the number of platoons of a row: groups of parts that separate for good.

    Two neighbours separate if their gap has grown, beyond rounding, over the last `multiple`
    periods up to number `period`, without a touch. `past` holds states at the starts of the last
    periods and when parts touched last; `scale` is the size of the drive in g. `numbers`, shape
    (parts,), gets the number of each part's platoon, 1 at the rear.
    """
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

    Velocities whose changes d over a cycle of one to four periods fall by a steady ratio q go to
    their limit, by q/(1 - q) d (Aitken's extrapolation), at most a quarter of `scale`, the size of
    the drive in g. Where velocities repeat and gaps alone shrink, half of the gap that closes
    first is left out. `period` is the number of periods done, `since` that of the last move,
    `past` holds the states before.
    """
    for lag in range(1, LAGS + 1):
        if period - 3 * lag < since:
            return False
        if _extrapolate(row, past, period, lag, scale):
            return True
    return False


@compiled
def _extrapolate(row: Row, past: Past, period: int, lag: int, scale: float) -> bool:
    """Move a row to the limit of its changes over `lag` periods; False, unmoved, if there is none.

    The other arguments are those of `hasten`.
    """
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
    """Leave out cycles of `lag` periods in which gaps change and nothing else; True if any is left.

    As many as take half of the gap that closes first, of those that shrink without a touch. The
    other arguments are those of `hasten`.
    """
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
    """Return the mean velocity of all `parts` of a row in each period, in g/w (w = 2 pi f)."""
    velocity = np.empty(periods.shape[0])
    for k in range(periods.shape[0]):
        velocity[k] = periods[k, TALLIES : TALLIES + parts].mean() / TURN
    return velocity


@compiled
def drifts(row: Row, past: Past, half: Floats, period: int, scale: float) -> bool:
    """True if a row that does not repeat is still on its way, so that it has no mean yet.

    The means of 16 batches of the second half of its periods show a drift, by von Neumann's ratio
    (`is_steady`): those of the row, or of a part that they scatter by more than the error of the
    row's mean. Or a gap shrinks that has been open all the time: its parts are still to meet.

    `half` has a row a period of that half: columns of `Tally`, distances of the parts, integrals of
    the gaps. `period` is the number of all periods, `scale` the size of the drive in g.
    """
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

    Those over the cycle of a motion that repeats (`periodic`, `at_rest`); else over the second half
    of the periods, with spread and error by batches of them (`aperiodic`). Where the row still
    drifts they are no means of its motion (`limit_reached`).

    Parameters
    ----------
    row, past
        The row at the end, and the states at the starts of the last periods.
    means
        A row a period: columns of `Tally`, distances of the parts, integrals of the gaps.
    period, cycle
        Periods that were followed, and those of the cycle (0 if it does not repeat).
    left
        What may be left of the transient, in g/w (w = 2 pi f).
    scale
        Size of the drive in g.
    result
        Columns of `COLUMN`, then velocity and platoon of each part.
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
    """Write the means of the motion of a row over some periods of the drive into `result`.

    `periods` has a row a period: columns of `Tally`, distances of the parts, integrals of the gaps;
    `numbers` is the platoon of each part, of which only neighbours in one have a gap that counts.
    `result` has the columns of `COLUMN`, then velocity and platoon of each part.
    """
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
