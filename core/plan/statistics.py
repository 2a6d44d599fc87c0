"""Points that fill the unit box evenly, and statistics of an output over them, with their errors.

Within a scrambling of Sobol points these depend on each other, between scramblings they do not. An
estimate takes all points together; the scatter of the estimates from single scramblings tells its
error: half the width of the interval that holds the truth in 95 % of all cases. Equal seeds give
equal bits.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.study import distributions
from vibrafeed.core.study.distributions import Distribution

BITS = 30
"""Binary digits of a coordinate; points lie in the middle of cells of that size, so that none lies
on an edge."""
REPLICATES = 16
"""Scramblings of a study: enough to estimate an error within a fifth, and few enough that each is
long."""
INTERVAL = "Half the width of the interval that holds the true value in 95 % of all cases."
"""What an error is, for the attributes of a variable."""
LEVELS = 129
"""Number of quantiles that describe a whole distribution, from the least to the largest value."""


def points(dimensions: int, count: int, seed: int, replicates: int = 1) -> Array:
    """Return Sobol points in independent sets, shape (dimensions, replicates, count), 0 < x < 1.

    `count` is a power of two: the points of each set.
    """
    random = np.random.default_rng(seed)
    sets = [
        scipy.stats.qmc.Sobol(dimensions, scramble=True, bits=BITS, rng=random).random(count)
        for _ in range(replicates)
    ]
    return np.ascontiguousarray(np.moveaxis(np.stack(sets), 2, 0)) + 0.5 ** (BITS + 1)


def values_at(uncertain: Mapping[str, Distribution], fractions: Array) -> dict[str, Array]:
    """Return the parameters at points of the unit box, in SI units and radians.

    `fractions`, shape (parameters, ...), are the points: for each parameter, in the order of
    `uncertain`, the fraction of its distribution below the value.
    """
    return {
        name: parameter_to_si(name, distributions.quantiles(name, distribution, fraction))
        for (name, distribution), fraction in zip(uncertain.items(), fractions, strict=True)
    }


@cache
def _student_factor(replicates: int) -> float:
    return float(scipy.stats.t.ppf((1 + 0.95) / 2, replicates - 1))


def error_of_mean(each: Array, axis: int = -1) -> Array:
    """Return half the 95 % interval of the mean of estimates from single sets, along an axis."""
    count = each.shape[axis]
    return np.asarray(_student_factor(count) * each.std(axis=axis, ddof=1) / np.sqrt(count))


class Estimate(NamedTuple):
    """An estimate and its error: half the width of its 95 % interval."""

    value: Array
    error: Array


def mean_and_deviation(values: Array) -> tuple[Estimate, Estimate]:
    """Return mean and standard deviation of random points with their errors, ignoring NaN.

    `values` have the shape (..., sets, points of a set); the results have the shape (...).
    """
    is_known = np.isfinite(values)
    count = is_known.sum(axis=(-2, -1), keepdims=True)
    values = np.where(is_known, values, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = values.sum(axis=(-2, -1), keepdims=True) / count
        # Moments about the mean of all points: those about 0 would lose digits.
        deviations = np.where(is_known, values - centre, 0.0)
        sums = np.stack(
            [is_known.sum(axis=-1, dtype=np.float64), deviations.sum(-1), (deviations**2).sum(-1)]
        )
        sums = np.moveaxis(sums, -1, 1)

        def moments(sums: Array) -> Array:
            count, first, second = sums
            mean = first / count
            variance = np.maximum(second / count - mean**2, 0.0)
            return np.stack([mean, np.sqrt(variance * count / (count - 1))])

        estimate, error = moments(sums.sum(axis=1)), error_of_mean(moments(sums), axis=1)
    mean = estimate[0] + centre[..., 0, 0]
    return Estimate(mean, error[0]), Estimate(estimate[1], error[1])


def quantiles(values: Array, fractions: Array) -> Estimate:
    """Return quantiles of random points with errors, shape (fractions, ...), ignoring NaN.

    `values` have the shape (..., sets, points of a set), `fractions` are of the values below.
    """
    flat = values.reshape(*values.shape[:-2], -1)
    # The error is NaN where one scrambling has no value at all.
    return Estimate(quantile(flat, fractions), error_of_mean(quantile(values, fractions)))


def quantile(values: Array, fractions: Array) -> Array:
    """Return quantiles of the values along the last axis, ignoring NaN, shape (fractions, ...).

    Between two neighbouring values it is linear, as numpy does by default; NaN without any.
    """
    values = np.sort(values, axis=-1)  # NaN come last
    count = np.isfinite(values).sum(axis=-1)
    rank = np.multiply.outer(fractions, np.maximum(count - 1, 0))
    lower_index = np.floor(rank).astype(np.intp)
    upper_index = np.minimum(lower_index + 1, np.maximum(count - 1, 0))
    low = np.take_along_axis(values[None], lower_index[..., None], axis=-1)[..., 0]
    high = np.take_along_axis(values[None], upper_index[..., None], axis=-1)[..., 0]
    remainder = rank - lower_index
    return np.where(remainder == 0, low, low + (high - low) * remainder)


def probability(has_happened: Mask) -> Estimate:
    """Return the probability of an event with its error, shape (...), from random points.

    `has_happened` is of shape (..., sets, points). Where all agree the error is at least 1/points.
    """
    replicates, count = has_happened.shape[-2:]
    by_set = has_happened.mean(axis=-1)
    return Estimate(
        by_set.mean(axis=-1), np.maximum(error_of_mean(by_set), 1 / (replicates * count))
    )


def fraction_of(without_value: NDArray[np.bool_]) -> Any:
    """Return the fraction of points without a value; the mask is (..., replicates, count)."""
    return without_value.mean(axis=(-2, -1))
