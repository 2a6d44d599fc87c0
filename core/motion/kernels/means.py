"""Means over periods of the drive of a motion that does not repeat.

The scatter of the means of successive batches tells the error; von Neumann's ratio of successive
differences shows what is left of a drift or of correlation.
"""

import math

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.constants import COLUMN, MODES, STATUS, TALLY
from vibrafeed.core.motion.kernels.inputs import Cell, Floats

BATCHES = 16  # successive batches of periods whose means give the error of a mean
SETTLING = 0.25
"""Share of the periods that is left out before the batches, while the motion settles."""
STUDENT = 2.947
"""Student's quantile for 99 % and 16 batches (15 degrees of freedom), in standard errors of the
mean."""
LEAST_RATIO = 0.684
"""Von Neumann's ratio of 16 independent normal numbers is below this one time in 1,000.

Random numbers that do not depend on each other give 2 on the mean; a straight line gives 0.04.
"""


@compiled
def batch_means(values: Floats) -> Floats:
    """Return the means of 16 successive batches of the values after their first quarter."""
    return successive_means(values[int(SETTLING * values.size) :])


@compiled
def successive_means(values: Floats) -> Floats:
    """Return the means of 16 successive batches of n values, shape (16,).

    All batches hold s = floor(n/16) values, and the last ends with the values. NaN if s = 0.
    """
    means = np.full(BATCHES, math.nan)
    size = values.size // BATCHES
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
    """Return the standard deviation of n mean values m, s = sqrt(sum (m - mean)^2/(n - 1))."""
    mean_of_means, sum_of_squares = np.mean(means), 0.0
    for mean in means:
        sum_of_squares += (mean - mean_of_means) ** 2
    return math.sqrt(sum_of_squares / (means.size - 1))


@compiled
def neumann_ratio(means: Floats) -> float:
    """Return von Neumann's ratio of successive differences of batch means m, which shows a drift.

    r = sum (m[k + 1] - m[k])^2/sum (m[k] - mean)^2 is 2 on the mean for independent numbers, and r
    = 2 (1 - q) with the correlation q of neighbours (von Neumann, Annals of Mathematical Statistics
    12, 1941, 367-395). 2 if all means are equal.
    """
    sum_of_squares, sum_of_steps = scatter(means) ** 2 * (means.size - 1), 0.0
    for k in range(means.size - 1):
        sum_of_steps += (means[k + 1] - means[k]) ** 2
    return 2.0 if sum_of_squares <= 0.0 else sum_of_steps / sum_of_squares


@compiled
def is_steady(means: Floats, resolved: float) -> bool:
    """True if batch means show no drift and no correlation between neighbouring batches.

    They scatter by no more than `resolved`, or von Neumann's ratio is at least 0.684. False if one
    is NaN (theory 13.13).
    """
    return scatter(means) <= resolved or neumann_ratio(means) >= LEAST_RATIO


@compiled
def mean_error(means: Floats) -> float:
    """Return the 99 % statistical error of the mean of n batch means, in their unit.

    t s/sqrt(n) sqrt((1 + q)/(1 - q)), with Student's quantile t = 2.947 for n = 16, the standard
    deviation s, and the correlation q = max(0, 1 - r/2) of neighbouring batches, from von Neumann's
    ratio r; batches k apart are taken to have the correlation q^k.
    """
    correlation = max(0.0, 1.0 - 0.5 * max(LEAST_RATIO, neumann_ratio(means)))
    correlation_factor = math.sqrt((1.0 + correlation) / (1.0 - correlation))
    return STUDENT * scatter(means) / math.sqrt(means.size) * correlation_factor


@compiled
def mean_velocity(travel: Floats, first: int, last: int, period: float) -> float:
    """Return the mean velocity in g/w over the periods from index `first` to before `last`."""
    total = 0.0
    for k in range(first, last):
        total += travel[k]
    return total / ((last - first) * period)


@compiled
def velocity_gains(travel: Floats, periods: int, period: float) -> tuple[float, float]:
    """Return two growths of a mean velocity in g/w: last less third quarter, third less second."""
    quarter = periods // 4
    second_quarter = mean_velocity(travel, quarter, 2 * quarter, period)
    third_quarter = mean_velocity(travel, 2 * quarter, 3 * quarter, period)
    last_quarter = mean_velocity(travel, 3 * quarter, 4 * quarter, period)
    return last_quarter - third_quarter, third_quarter - second_quarter


@compiled
def runs_away(last_gain: float, earlier_gain: float, pull: float, friction: float) -> bool:
    """True if the mean velocity grows steadily because gravity exceeds friction.

    Two successive growths d and d' (`velocity_gains`) have one sign, |d| > |d'|/2, and `pull`,
    gravity along the track, is at least `friction`, mu_k times the mean load, both in g: at high
    speed friction is kinetic.
    """
    return (
        last_gain * earlier_gain > 0.0
        and pull >= friction
        and abs(last_gain) > 0.5 * abs(earlier_gain)
    )


@compiled
def fill_means(tallies: Floats, first: int, last: int, period: float, result: Floats) -> None:
    """Fill `result` with the mean values over the periods from index `first` to before `last`."""
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
def status_without_cycle(
    cell: Cell, wall: bool, pull: float, travel: Floats, period: float, resolved: float
) -> tuple[int, Floats]:
    """Return the status of a motion that did not repeat, and the batch means of its velocity.

    `runaway` if gravity along, `pull` in g, beats the friction mu_k n + mu_w max(0, n_y) of the
    loads n, n_y on floor and wall; else `aperiodic`, or `limit_reached` if the batches drift by
    more than `resolved` (theory 13.8).
    """
    last_gain, earlier_gain = velocity_gains(travel, travel.size, period)
    friction = cell.friction_kinetic * cell.gravity_number_normal
    if wall:
        friction += cell.wall_friction * max(0.0, cell.gravity_number_across)
    batches = batch_means(travel) / period
    if runs_away(last_gain, earlier_gain, pull, friction):
        return STATUS.runaway, batches
    return STATUS.aperiodic if is_steady(batches, resolved) else STATUS.limit_reached, batches


@compiled
def wall_gap(tallies: Floats, first: int, last: int, drift: float) -> float:
    """Return the change of the distance from the wall that keeps a motion from repeating.

    |`drift`| over a cycle, outwards positive in g/w^2, if the part touched the wall in the periods
    from `first` to before `last`; else max(0, -drift): it may move away.
    """
    for k in range(first, last):
        if tallies[k, TALLY.at_wall] > 0.0:
            return abs(drift)
    return max(0.0, -drift)
