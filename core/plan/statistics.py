"""Statistics of an output over sampled points: mean, deviation, quantiles, probabilities."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan.replicates import error_of_mean

LEVELS = 129
"""Number of quantiles that describe a whole distribution, from the least to the largest value."""


class Estimate(NamedTuple):
    """An estimate and its error: half the width of its 95 % interval."""

    value: Array
    error: Array


def mean_and_deviation(values: Array) -> tuple[Estimate, Estimate]:
    """Return mean and standard deviation of random points with their errors, ignoring NaN.

    `values` are an output at independent sets of points, shape (..., sets, points of a set); the
    results have the shape (...). The errors come from the scatter of independent sets, half the
    width of a 95 % interval. Where all values are NaN, so is the mean. Both results have a value
    and its error.
    """
    known = np.isfinite(values)
    number = known.sum(axis=(-2, -1), keepdims=True)
    values = np.where(known, values, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = values.sum(axis=(-2, -1), keepdims=True) / number
        # Sums about the mean of all: those about 0 would lose digits.
        away = np.where(known, values - centre, 0.0)
        sums = np.stack([known.sum(axis=-1, dtype=np.float64), away.sum(-1), (away**2).sum(-1)])
        sums = np.moveaxis(sums, -1, 1)

        def moments(sums: Array) -> Array:
            count, first, second = sums
            mean = first / count
            left = np.maximum(second / count - mean**2, 0.0)
            return np.stack([mean, np.sqrt(left * count / (count - 1))])

        estimate, error = moments(sums.sum(axis=1)), error_of_mean(moments(sums), axis=1)
    mean = estimate[0] + centre[..., 0, 0]
    return Estimate(mean, error[0]), Estimate(estimate[1], error[1])


def quantiles(values: Array, shares: Array) -> Estimate:
    """Return quantiles of random points with errors, ignoring NaN.

    The error, half a 95 % interval, comes from the scatter of the quantiles of independent sets.

    Parameters
    ----------
    values : ndarray, shape (..., sets, points of a set)
        The values of an output.
    shares : ndarray
        The shares of the values below, 0 to 1.

    Returns
    -------
    Estimate
        Arrays of shape (shares, ...).
    """
    flat = values.reshape(*values.shape[:-2], -1)
    found = quantile(flat, shares)
    each = quantile(values, shares)
    # Where one scrambling has no value at all, there is no telling how far they lie apart.
    return Estimate(found, error_of_mean(each))


def quantile(values: Array, shares: Array) -> Array:
    """Return quantiles of the values along the last axis, ignoring NaN, shape (shares, ...).

    `shares` are those of the values below the quantile, 0 to 1. Between two neighbouring values it
    is linear, as numpy does by default; NaN where there are no values.
    """
    values = np.sort(values, axis=-1)  # NaN come last
    number = np.isfinite(values).sum(axis=-1)
    rank = np.multiply.outer(shares, np.maximum(number - 1, 0))
    below = np.floor(rank).astype(np.intp)
    above = np.minimum(below + 1, np.maximum(number - 1, 0))
    low = np.take_along_axis(values[None], below[..., None], axis=-1)[..., 0]
    high = np.take_along_axis(values[None], above[..., None], axis=-1)[..., 0]
    part = rank - below
    return np.where(part == 0, low, low + (high - low) * part)


def probability(met: Mask) -> Estimate:
    """Return the probability of an event with its error, shape (...), from random points.

    `met` is True at the points where it occurred, shape (..., sets, points of a set); the scatter
    of independent sets gives the error, half a 95 % interval. Where all points agree, chance may
    have left out one: the error then is at least one point's share.
    """
    replicates, count = met.shape[-2:]
    each = met.mean(axis=-1)
    return Estimate(each.mean(axis=-1), np.maximum(error_of_mean(each), 1 / (replicates * count)))


def share(lost: NDArray[np.bool_]) -> Any:
    """Return the share of points that have no value, (..., replicates, count)."""
    return lost.mean(axis=(-2, -1))
