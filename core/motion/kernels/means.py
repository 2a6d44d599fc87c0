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

    All batches are equally long, and the last ends with the values. NaN where there are fewer
    values than batches.
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
    """Return the standard deviation of numbers, s = sqrt(sum (m - mean)^2/(n - 1))."""
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
    """Return whether batches' means show neither a drift nor a memory longer than a batch.

    Those that scatter by less than what is `resolved` of them are the same. False of NaN. Batches
    of a steady motion fail once in 1,000 times.
    """
    return scatter(means) <= resolved or succession(means) >= LEAST_RATIO


@compiled
def mean_error(means: Floats) -> float:
    """Return the statistical error of the mean of steady batches' means, at 99 %.

    t s/sqrt(n) sqrt((1 + q)/(1 - q)): Student's quantile t times the standard error of the mean of
    n numbers with standard deviation s, of which neighbours have the correlation q = 1 - r/2, if
    above 0, and others its powers.
    """
    likeness = max(0.0, 1.0 - 0.5 * max(LEAST_RATIO, succession(means)))
    memory = math.sqrt((1.0 + likeness) / (1.0 - likeness))
    return STUDENT * scatter(means) / math.sqrt(means.size) * memory


@compiled
def mean_velocity(travel: Floats, first: int, last: int, period: float) -> float:
    """Return the mean velocity over the periods from `first` to before `last`."""
    total = 0.0
    for k in range(first, last):
        total += travel[k]
    return total / ((last - first) * period)


@compiled
def gains(travel: Floats, done: int, period: float) -> tuple[float, float]:
    """Return by how much the mean velocity grew from the third to the last quarter, and before."""
    quarter = done // 4
    first = mean_velocity(travel, quarter, 2 * quarter, period)
    second = mean_velocity(travel, 2 * quarter, 3 * quarter, period)
    third = mean_velocity(travel, 3 * quarter, 4 * quarter, period)
    return third - second, second - first


@compiled
def runs_away(gain: float, before: float, pull: float, friction: float) -> bool:
    """Return whether the mean velocity grows on and on, as gravity is no less than friction.

    At high speed friction is kinetic, on the mean load, whether the part hops or not.
    """
    return gain * before > 0.0 and pull >= friction and abs(gain) > 0.5 * abs(before)
