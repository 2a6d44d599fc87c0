"""Sobol indices: which uncertain input the variance of a function comes from.

The first index of an input is the share of the variance that would go if that input alone were
known, the total index the share that would stay if all others were known:

    first_i = V(E(y | x_i)) / V(y),    total_i = E(V(y | all but x_i)) / V(y)

Points a and b are drawn, and for each input those of a with that input from b. Then the means of
f(b) (f(ab_i) - f(a)) and (f(a) - f(ab_i))^2 / 2 are V(y) times the two: A. Saltelli et al.,
Computer Physics Communications 181 (2010) 259, table 2 (b) and (f), the latter by M. Jansen.
`scipy.stats.sobol_indices` has the same formulas for one function; here there are many designs at
once, points without a value, and intervals from scramblings.
"""

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.statistics import REPLICATES, error_of_mean, points

MAX_INPUTS = 40  # uncertain parameters: evaluations grow with their number
FLAT = 1e-14
"""Standard deviation, as a share of the size of the values, that is rounding: the function is
constant."""


class Indices(NamedTuple):
    """Sobol indices of a function, or of many; arrays of shape (..., inputs).

    Attributes
    ----------
    first, total : ndarray
        The shares of the variance; NaN where the function is constant or has too few values.
    first_error, total_error : ndarray
        Half the widths of their 95 % intervals.
    """

    first: Array
    first_error: Array
    total: Array
    total_error: Array


def design(inputs: int, count: int, seed: int, replicates: int = REPLICATES) -> Array:
    """Return the points in the unit box at which outputs are evaluated for Sobol indices."""
    base_points = points(2 * inputs, count, seed, replicates)
    a, b = base_points[:inputs], base_points[inputs:]
    sample = np.repeat(a[:, None], inputs + 2, axis=1)
    sample[:, 1] = b
    # Rows: a, b, then for each input a with that input from b.
    for number in range(inputs):
        sample[number, 2 + number] = b[number]
    return sample


def indices_of(values: Array) -> Indices:
    """Return the Sobol indices of outputs from their values at the points of `design`, with errors.

    The first index of an input is the share of the variance due to it alone, the total one its
    share with all interactions. Errors come from the scatter of independent sets of points.
    """
    is_known = np.asarray(np.isfinite(values).all(axis=-3, keepdims=True))
    values = np.where(is_known, values, 0.0)
    point_count = 2 * is_known.sum(axis=(-2, -1), keepdims=True)
    # Centred values: their products vary least, and means of squares lose fewest digits.
    total_sum = values[..., :2, :, :].sum(axis=(-3, -2, -1), keepdims=True)
    centre = total_sum / np.maximum(point_count, 1)
    values = np.where(is_known, values - centre, 0.0)
    a, b, ab = values[..., 0, :, :], values[..., 1, :, :], values[..., 2:, :, :]
    count = is_known[..., 0, :, :].sum(axis=-1, dtype=np.float64)
    common_sums = np.stack([count, (a + b).sum(axis=-1), (a * a + b * b).sum(axis=-1)])
    # First: sum of b (ab - a) over the variance; total: sum of (a - ab)^2/2 over the variance.
    first = (b[..., None, :, :] * (ab - a[..., None, :, :])).sum(axis=-1)
    total = ((a[..., None, :, :] - ab) ** 2).sum(axis=-1) / 2
    centre_size = np.asarray(np.abs(centre[..., 0, 0, 0]))

    def estimate(sums: Array) -> Array:
        count, total_sum, squares, *means = sums
        mean = total_sum / (2 * count)
        variance = squares / (2 * count) - mean**2
        is_valid = np.logical_and(count > 1, variance > (FLAT * centre_size[..., None]) ** 2)
        return np.where(is_valid, np.stack(means) / count / variance, np.nan)

    # Sums of shape (kind of sum, replicates, ..., inputs).
    common_sums = np.moveaxis(common_sums, -1, 1)[..., None]
    input_sums = np.moveaxis(np.stack([first, total]), -1, 1)
    sums = np.concatenate([np.broadcast_to(common_sums, (3, *input_sums.shape[1:])), input_sums])
    with np.errstate(invalid="ignore", divide="ignore"):
        first, total = estimate(sums.sum(axis=1))
        first_error, total_error = error_of_mean(estimate(sums), axis=1)
    return Indices(first, first_error, total, total_error)
