"""Array types and the few elementary functions that numpy lacks in a stable form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""float64 values; every function here broadcasts its arguments."""

Mask = NDArray[np.bool_]
"""Truth values."""


def compensated_sum(*terms: Array) -> Array:
    """Return the sum of the `terms`, arrays, with the rounding errors of the additions put back.

    As if with twice the working precision before the last rounding (Ogita, Rump and Oishi 2005,
    algorithm Sum2). Used where a sum is compared with zero.
    """
    total: Array = terms[0]
    error: Array | float = 0.0
    for term in terms[1:]:
        added = total + term
        virtual = added - total
        error = error + ((total - (added - virtual)) + (term - virtual))
        total = added
    return total + error


def ratio(numerator: Array, denominator: Array, limit: Array | float) -> Array:
    """Return ``numerator / denominator``, and `limit` where the denominator is 0."""
    zero = denominator == 0.0
    quotient = numerator / np.where(zero, 1.0, denominator)
    return np.where(zero, limit, quotient)


def hypot(x: Array, y: Array) -> Array:
    """Return sqrt(x^2 + y^2) without overflow, within 2 units in the last place.

    It is made of numpy's elementwise functions because `np.hypot` is slower: a call for each value.
    """
    x, y = np.abs(x), np.abs(y)
    y_is_less = x > y
    large, small = np.where(y_is_less, x, y), np.where(y_is_less, y, x)
    share = small / np.where(large > 0, large, 1.0)
    return large * np.sqrt(1.0 + share * share)
