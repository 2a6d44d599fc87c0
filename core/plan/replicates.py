"""Estimates from several scramblings of the same points, and how far off they may be.

Within a scrambling points depend on each other, between scramblings they do not. An estimate takes
all points together; the scatter of the estimates from single scramblings tells its error: half the
width of the interval that holds the truth in 95 % of all cases.
"""

from __future__ import annotations

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


def error_of_mean(each: Array, axis: int = -1) -> Array:
    """Return half the 95 % interval of the mean of estimates from single sets, along an axis."""
    count = each.shape[axis]
    return np.asarray(student_factor(count) * each.std(axis=axis, ddof=1) / np.sqrt(count))
