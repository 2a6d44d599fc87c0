"""Shares by a drop test, and how well they are known: Dirichlet's distribution (theory 16.4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.mechanics.arrays import Array
from core.mechanics.orienting import PassedShares

PRIOR = 0.5
"""Counts before the test, of each aspect (Jeffreys)."""

DEVIATIONS = 1.959963984540054
"""Of a normal distribution that 95 % lie within."""


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
    *, tested_shares: tuple[Array, ...], tested_line: PassedShares, drop_count: Array
) -> Array:
    """Return the standard deviation of the yield after a drop test [1].

    sqrt(sum p_o (v_o - eta)^2/(A + 1)), v_o the share that passes of an aspect, A all counts.
    """
    terms = zip(tested_shares, tested_line.passing, strict=True)
    squares = sum(p * np.square(v - tested_line.total) for p, v in terms)
    return np.sqrt(squares / (drop_count + 1))


def yield_lower(*, tested_line: PassedShares, yield_deviation: Array) -> Array:
    """Return the lower end of the yield's interval of 95 % [1].

    That of a beta distribution of the yield's mean and deviation: the yield's own where each aspect
    passes as a whole or not at all.
    """
    return _quantile(tested_line.total, yield_deviation, -1)


def yield_upper(*, tested_line: PassedShares, yield_deviation: Array) -> Array:
    """Return the upper end of the yield's interval of 95 % [1]."""
    return _quantile(tested_line.total, yield_deviation, 1)


def _quantile(mean: Array, deviation: Array, side: int) -> Array:
    """Return the end of the interval of 95 % of a beta distribution by its mean and deviation [1].

    With F = b x/(a (1 - x)), F^(1/3) (1 - 1/(9 b)) - (1 - 1/(9 a)) over its deviation
    sqrt(F^(2/3)/(9 b) + 1/(9 a)) is nearly normal (Paulson 1942): the ends are right to 0.02
    deviations for a, b >= 1, and to 0.07 where nothing was counted.
    """
    spread = (deviation > 0) & (mean > 0) & (mean < 1)
    m, s = np.where(spread, mean, 0.5), np.where(spread, deviation, 0.1)
    count = m * (1 - m) / np.square(s) - 1
    a, b = m * count, (1 - m) * count
    above, below = 1 / (9 * a), 1 / (9 * b)
    z = DEVIATIONS * DEVIATIONS
    lead = np.square(1 - below) - z * below
    middle = (1 - below) * (1 - above)
    rest = np.square(1 - above) - z * above
    # The ends are roots of lead t^2 - 2 middle t + rest, t = F^(1/3), or an end of the range.
    root = middle + np.sqrt(np.square(middle) - lead * rest)
    turned = np.maximum(
        (lead if side > 0 else rest) / root, 0.0
    )  # 1/t of the upper, t of the lower
    first, second = (b, a) if side > 0 else (a, b)
    cube = first * (turned * turned * turned)
    low = cube / (cube + second)
    return np.where(spread, 1 - low if side > 0 else low, mean)


def rate_lower(*, arrival_rate: Array, yield_lower: Array) -> Array:
    """Return the lower end of the oriented feed rate's interval of 95 % [min-1]."""
    return arrival_rate * yield_lower


def rate_upper(*, arrival_rate: Array, yield_upper: Array) -> Array:
    """Return the upper end of the oriented feed rate's interval of 95 % [min-1]."""
    return arrival_rate * yield_upper
