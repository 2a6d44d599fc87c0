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


def values_at(uncertain: Mapping[str, Distribution], shares: Array) -> dict[str, Array]:
    """Return the parameters at points of the unit box, in SI units and radians.

    `shares`, shape (parameters, ...), are the points: for each parameter, in the order of
    `uncertain`, the share of its distribution below the value.
    """
    return {
        name: parameter_to_si(name, distributions.quantiles(name, one, share))
        for (name, one), share in zip(uncertain.items(), shares, strict=True)
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
    """Return quantiles of random points with errors, shape (shares, ...), ignoring NaN.

    `values` have the shape (..., sets, points of a set), `shares` are those of the values below.
    """
    flat = values.reshape(*values.shape[:-2], -1)
    # Where one scrambling has no value at all, there is no telling how far they lie apart.
    return Estimate(quantile(flat, shares), error_of_mean(quantile(values, shares)))


def quantile(values: Array, shares: Array) -> Array:
    """Return quantiles of the values along the last axis, ignoring NaN, shape (shares, ...).

    Between two neighbouring values it is linear, as numpy does by default; NaN without any.
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

    `met` is of shape (..., sets, points). Where all agree the error is at least one point's share.
    """
    replicates, count = met.shape[-2:]
    each = met.mean(axis=-1)
    return Estimate(each.mean(axis=-1), np.maximum(error_of_mean(each), 1 / (replicates * count)))


def share(lost: NDArray[np.bool_]) -> Any:
    """Return the share of points that have no value, (..., replicates, count)."""
    return lost.mean(axis=(-2, -1))
