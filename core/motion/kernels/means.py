"""Means over periods of the drive of a motion that does not repeat.

The error of such a mean is statistical. The periods that are kept are cut into batches, one after
another, and the scatter of the batches' means tells the error: neighbouring periods depend on each
other, batches of many hardly do. What is left of that, and a drift, shows in von Neumann's ratio of
successive differences: a mean over a drift is none.
"""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.cells import Cell
from core.motion.kernels.results import COLUMN, TALLY
from core.motion.kernels.statuses import MODES, STATUS

BATCHES = 16
SETTLING = 0.25
"""Share of the periods that comes before the batches."""
STUDENT = 2.947
"""Standard errors that hold the mean of 16 normal numbers at 99 % (Student, 15 degrees)."""
LEAST_RATIO = 0.684
"""Von Neumann's ratio of 16 independent normal numbers is below this one time in 1,000.

Random numbers that do not depend on each other give 2 on the mean; a straight line gives 0.04.
"""


@compiled
def batch_means(values: Floats) -> Floats:
    """Return the means of successive batches of the values but the first quarter; shape (16,).

    m_b = (sum of the s values of batch b)/s, with s = floor((n - floor(n/4))/16) of n values: all
    batches are equally long, and the last ends with the values. NaN where there are fewer values
    than batches.
    """
    means = np.full(BATCHES, math.nan)
    size = (values.size - int(SETTLING * values.size)) // BATCHES
    if size == 0:
        return means
    for batch in range(BATCHES):
        total, start = 0.0, values.size - (BATCHES - batch) * size
        for k in range(start, start + size):
            total += values[k]
        means[batch] = total / size
    return means


@compiled
def scatter(means: Floats) -> float:
    """Return the sample standard deviation, s = sqrt(sum (m - mean)^2/(n - 1))."""
    centre, square = np.mean(means), 0.0
    for mean in means:
        square += (mean - centre) ** 2
    return math.sqrt(square / (means.size - 1))


@compiled
def succession(means: Floats) -> float:
    """Return von Neumann's ratio of successive differences.

    r = sum (m[k + 1] - m[k])^2/sum (m[k] - mean)^2 is 2 on the mean of independent numbers, less
    where each is like the one before: r = 2 (1 - q) with the correlation q of neighbours
    (von Neumann, Annals of Mathematical Statistics 12, 1941, 367-395).
    """
    square, steps = scatter(means) ** 2 * (means.size - 1), 0.0
    for k in range(means.size - 1):
        steps += (means[k + 1] - means[k]) ** 2
    return 2.0 if square <= 0.0 else steps / square


@compiled
def is_steady(means: Floats, resolved: float) -> bool:
    """True if batch means show no drift and no correlation between neighbouring batches.

    s(m) <= `resolved`: those that scatter by less than what is known of them are the same; or r >=
    0.684, with `scatter` and `succession`. False of NaN. Batches of a steady motion fail once in
    1,000 times (theory 13.13).
    """
    return scatter(means) <= resolved or succession(means) >= LEAST_RATIO


@compiled
def mean_error(means: Floats) -> float:
    """Return the 99 % statistical error of the mean of independent batch means.

    t s/sqrt(n) sqrt((1 + q)/(1 - q)): Student's quantile t times the standard error of the mean of
    n numbers with standard deviation s, of which neighbours have the correlation q = 1 - r/2, if
    above 0, and others its powers.
    """
    likeness = max(0.0, 1.0 - 0.5 * max(LEAST_RATIO, succession(means)))
    memory = math.sqrt((1.0 + likeness) / (1.0 - likeness))
    return STUDENT * scatter(means) / math.sqrt(means.size) * memory


@compiled
def mean_velocity(travel: Floats, first: int, last: int, period: float) -> float:
    """Return the mean velocity over the periods from `first` to before `last`.

    v = (sum of x_k)/(n T). x_k is the way of a period k, T how long a period is, n = last - first.
    """
    total = 0.0
    for k in range(first, last):
        total += travel[k]
    return total / ((last - first) * period)


@compiled
def gains(travel: Floats, done: int, period: float) -> tuple[float, float]:
    """Return the growth of the mean velocity from the third to the last quarter, and before that.

    v_4 - v_3 and v_3 - v_2, with v_q the `mean_velocity` of quarter q.
    """
    quarter = done // 4
    first = mean_velocity(travel, quarter, 2 * quarter, period)
    second = mean_velocity(travel, 2 * quarter, 3 * quarter, period)
    third = mean_velocity(travel, 3 * quarter, 4 * quarter, period)
    return third - second, second - first


@compiled
def runs_away(gain: float, before: float, pull: float, friction: float) -> bool:
    """True if the mean velocity grows steadily because gravity exceeds friction.

    For its growth d after d', d d' > 0, |d| > |d'|/2 and `pull` >= `friction`, g sin(gamma) against
    mu_k times the mean load: at high speed friction is kinetic, whether the part hops or not.
    """
    return gain * before > 0.0 and pull >= friction and abs(gain) > 0.5 * abs(before)


@compiled
def fill_means(tallies: Floats, first: int, last: int, period: float, result: Floats) -> None:
    """Fill a result with the mean values of the periods from `first` to before `last`.

    A part that touched the wall meanwhile has no mean velocity across: it comes back.
    """
    result[:] = 0.0
    travel, across, at_wall = 0.0, 0.0, 0.0
    for k in range(first, last):
        tally = tallies[k]
        travel += tally[TALLY.travel]
        across += tally[TALLY.across]
        at_wall += tally[TALLY.at_wall]
        for mode in range(MODES):
            result[COLUMN.stick + mode] += tally[TALLY.stick + mode]
        result[COLUMN.impacts] += tally[TALLY.impacts]
        result[COLUMN.landing_speed] = max(result[COLUMN.landing_speed], tally[TALLY.landing])
        result[COLUMN.hop_height] = max(result[COLUMN.hop_height], tally[TALLY.height])
    time, counted = (last - first) * period, 0.0
    for mode in range(MODES):
        counted += result[COLUMN.stick + mode]
    result[COLUMN.stick : COLUMN.flight + 1] /= counted
    result[COLUMN.velocity] = travel / time
    result[COLUMN.across] = across / time if at_wall == 0.0 else 0.0
    result[COLUMN.impacts] /= last - first


@compiled
def ended(
    cell: Cell, wall: bool, pull: float, travel: Floats, period: float, resolved: float
) -> tuple[int, Floats]:
    """Return the status of a motion that did not repeat, and its batch means.

    `pull` is gravity's, sin(gamma), against the friction mu_k n + mu_w max(0, n_y) that may not
    hold it (theory 13.8); `resolved` as in `is_steady`.
    """
    gain, before = gains(travel, travel.size, period)
    friction = cell.friction_kinetic * cell.gravity_number_normal
    if wall:
        friction += cell.wall_friction * max(0.0, cell.gravity_number_across)
    batches = batch_means(travel) / period
    if runs_away(gain, before, pull, friction):
        return STATUS.runaway, batches
    return STATUS.aperiodic if is_steady(batches, resolved) else STATUS.limit_reached, batches


@compiled
def wall_gap(tallies: Floats, first: int, last: int, drift: float) -> float:
    """Return the difference of two distances from the wall, 0 where it does not matter.

    |dy| for a part that touched the wall over the periods from `first` to before `last`; max(0,
    -dy) for one that did not, with `drift` = dy: to one that does not come nearer it does not
    matter.
    """
    for k in range(first, last):
        if tallies[k, TALLY.at_wall] > 0.0:
            return abs(drift)
    return max(0.0, -drift)
