"""Estimates from several scramblings of the same points, and how far off they may be.

Within a scrambling points depend on each other, between scramblings they do not. An estimate takes
all points together; leaving out one scrambling after the other tells its error (the jackknife). An
error is half the width of the interval that holds the truth in 95 % of all cases.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array

REPLICATES = 16
"""Scramblings of a study: enough to estimate an error within a fifth, and few enough that each is
long."""
CONFIDENCE = 0.95
INTERVAL = "Half the width of the interval that holds the true value in 95 % of all cases."
"""What an error is, for the attributes of a variable."""


@cache
def student_factor(replicates: int = REPLICATES) -> float:
    """Return Student's factor for a 95 % interval of the mean of so many replicates."""
    return float(scipy.stats.t.ppf((1 + CONFIDENCE) / 2, replicates - 1))


def jackknife(sums: Array, estimate: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Return an estimate from sums over independent sets of points, and half its 95 % interval.

    The error comes from leaving out one set after the other. It fits estimates, such as variances,
    that are no means themselves.

    Parameters
    ----------
    sums : ndarray, shape (m, sets, ...)
        m sums over the points of each set.
    estimate : callable
        Takes sums (m, ...), returns estimates (...); NaN where there is none.
    """
    count, whole = sums.shape[1], sums.sum(axis=1)
    without = np.stack([estimate(whole - sums[:, k]) for k in range(count)])
    spread = (without - without.mean(axis=0)) ** 2
    error = np.sqrt((count - 1) / count * spread.sum(axis=0))
    return estimate(whole), student_factor(count) * error
