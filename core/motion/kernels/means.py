"""Means over periods of the drive of a motion that does not repeat."""

from __future__ import annotations

import math

from core.compiled import compiled
from core.motion.kernels.arrays import Floats

BATCHES = 8
"""Of the last three quarters of the periods; their means tell the spread."""
SURE = 5.41
"""Standard deviations of the mean of eight numbers that hold 99.9 % (Student, 7 degrees)."""


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
def is_trend(gain: float, before: float) -> bool:
    """Return whether the mean velocity goes one way, and not ever more slowly."""
    return gain * before > 0.0 and abs(gain) > 0.2 * abs(before)


@compiled
def batch_spread(travel: Floats, done: int, period: float) -> float:
    """Return the standard deviation of the batches' means."""
    batch = max(1, (done - done // 4) // BATCHES)
    square, centre = 0.0, mean_velocity(travel, done - BATCHES * batch, done, period)
    for k in range(BATCHES):
        start = done - (k + 1) * batch
        square += (mean_velocity(travel, start, start + batch, period) - centre) ** 2
    return math.sqrt(square / (BATCHES - 1))


@compiled
def is_monotone(travel: Floats, done: int, period: float) -> bool:
    """Return whether the batches' means go one way only, as by chance they do once in 20,000."""
    batch = max(1, (done - done // 4) // BATCHES)
    rises, falls, before = 0, 0, 0.0
    for k in range(BATCHES):
        start = done - (BATCHES - k) * batch
        mean = mean_velocity(travel, start, start + batch, period)
        if k > 0:
            rises, falls = rises + (mean > before), falls + (mean < before)
        before = mean
    return rises == BATCHES - 1 or falls == BATCHES - 1


@compiled
def runs_away(gain: float, before: float, pull: float, friction: float) -> bool:
    """Return whether the mean velocity grows on and on, as gravity is no less than friction.

    At high speed friction is kinetic, on the mean load, whether the part hops or not.
    """
    return is_trend(gain, before) and pull >= friction and abs(gain) > 0.5 * abs(before)


@compiled
def is_transient(gain: float, before: float, spread: float) -> bool:
    """Return whether a trend is far above the scatter of the batches' differences."""
    return is_trend(gain, before) and abs(gain) > 2.0 * spread / math.sqrt(BATCHES / 3.0)
