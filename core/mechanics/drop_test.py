"""Shares by a drop test, and how well they are known: Dirichlet's distribution (theory 16.4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from core.mechanics.arrays import Array
from core.mechanics.orienting import Passed

PRIOR = 0.5
"""Counts before the test, of each aspect (Jeffreys)."""

SURE = 0.95
"""Probability that the yield lies within its interval."""


def posterior_shares(counts: Sequence[Array]) -> tuple[Array, ...]:
    """Return the mean shares after some counts, (n_o + 1/2)/(N + K/2) [1]."""
    total = posterior_count(counts)
    return tuple((one + PRIOR) / total for one in counts)


def posterior_count(counts: Sequence[Array]) -> Array:
    """Return the counts of a drop test with those before it, N + K/2 [1]."""
    total = counts[0] + PRIOR
    for one in counts[1:]:
        total = total + (one + PRIOR)
    return total


def yield_deviation(
    *, tested_shares: tuple[Array, ...], tested_line: Passed, drop_count: Array
) -> Array:
    """Return the standard deviation of the yield after a drop test [1].

    sqrt(sum p_o (v_o - eta)^2/(A + 1)), v_o the share that passes of an aspect, A all counts.
    """
    terms = zip(tested_shares, tested_line.passing, strict=True)
    squares = sum(p * np.square(v - tested_line.total) for p, v in terms)
    return np.sqrt(squares / (drop_count + 1))


def yield_lower(*, tested_line: Passed, yield_deviation: Array) -> Array:
    """Return the lower end of the yield's interval of 95 % [1].

    That of a beta distribution of the yield's mean and deviation: the yield's own where each aspect
    passes as a whole or not at all.
    """
    return _quantile(tested_line.total, yield_deviation, (1 - SURE) / 2)


def yield_upper(*, tested_line: Passed, yield_deviation: Array) -> Array:
    """Return the upper end of the yield's interval of 95 % [1]."""
    return _quantile(tested_line.total, yield_deviation, (1 + SURE) / 2)


def _quantile(mean: Array, deviation: Array, share: float) -> Array:
    open_ = (deviation > 0) & (mean > 0) & (mean < 1)
    m, s = np.where(open_, mean, 0.5), np.where(open_, deviation, 0.1)
    count = m * (1 - m) / np.square(s) - 1
    return np.where(open_, scipy.special.betaincinv(m * count, (1 - m) * count, share), mean)


def rate_lower(*, arrival_rate: Array, yield_lower: Array) -> Array:
    """Return the lower end of the oriented feed rate's interval of 95 % [min-1]."""
    return arrival_rate * yield_lower


def rate_upper(*, arrival_rate: Array, yield_upper: Array) -> Array:
    """Return the upper end of the oriented feed rate's interval of 95 % [min-1]."""
    return arrival_rate * yield_upper
