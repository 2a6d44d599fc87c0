"""Shares by a drop test, and how well they are known: Dirichlet's distribution (theory 16.4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.mechanics.orienting import PassedShares

PRIOR = 0.5
"""Count that each aspect has before the test, as by Jeffreys' prior."""

DEVIATIONS = 1.959963984540054
"""Standard deviations from the mean within which 95 % of a normal distribution lie."""


def posterior_shares(counts: Sequence[Array]) -> tuple[Array, ...]:
    """Return the share of parts that come to rest in each aspect, estimated from a drop test [1].

    `counts` are the parts seen in each of K aspects, n_o, N in all: the mean of Dirichlet's
    distribution, (n_o + 1/2)/(N + K/2).
    """
    total = posterior_count(counts)
    return tuple((one + PRIOR) / total for one in counts)


def posterior_count(counts: Sequence[Array]) -> Array:
    """Return the sum of the counts of a drop test's aspects with their prior, N + K/2 [1].

    It is the weight of the test. `counts` has an array for each of the K aspects, with the parts
    that came to rest in it, N in total; each aspect counts 1/2 before the test.
    """
    total = counts[0] + PRIOR
    for one in counts[1:]:
        total = total + (one + PRIOR)
    return total


def yield_deviation(
    *, counted_shares: tuple[Array, ...], counted_line: PassedShares, drop_count: Array
) -> Array:
    """Return the standard deviation of the yield that a drop test leaves [1].

    sqrt(sum p_o (v_o - eta)^2/(A + 1)): p_o are the counted shares of the aspects, v_o the shares
    of them that pass the line, eta the yield (both in `counted_line`), and A (`drop_count`) is N +
    K/2.
    """
    total = counted_line.total
    return _deviation(counted_shares, [v - total for v in counted_line.passing], drop_count)


def line_ends(
    *, counted_shares: tuple[Array, ...], counted_line: PassedShares, drop_count: Array
) -> tuple[PassedShares, PassedShares]:
    """Return the lower and the upper ends of all shares of a line after a drop test [1].

    Each share has its own interval of 95 %: the quantiles of the beta distribution with its mean
    and standard deviation, which is exactly the yield's where each aspect passes as a whole or not
    at all. That of a purity, the quotient of two such shares, is taken to first order.
    """
    line, aspects = counted_line, range(len(counted_shares))

    def deviation(off: Sequence[Array]) -> Array:
        return _deviation(counted_shares, off, drop_count)

    columns = [[row[j] for row in line.matrix] for j in aspects]
    whole = deviation([v - line.total for v in line.passing])
    leaving = [deviation([v - line.leaving[j] for v in columns[j]]) for j in aspects]
    impure = [
        [v - line.pure[j] * every for v, every in zip(columns[j], line.passing, strict=True)]
        for j in aspects
    ]
    pure = [ratio(deviation(off), line.total, 0.0) for off in impure]

    def end(side: int) -> PassedShares:
        total = quantile(line.total, whole, side)
        return line._replace(
            leaving=tuple(quantile(line.leaving[j], leaving[j], side) for j in aspects),
            pure=tuple(quantile(line.pure[j], pure[j], side) for j in aspects),
            total=total,
            lost=quantile(line.lost, whole, -side),
        )

    return end(-1), end(1)


def _deviation(shares: Sequence[Array], off: Sequence[Array], drop_count: Array) -> Array:
    """Return the standard deviation of a sum of Dirichlet's shares with weights [1].

    `off` are the weights less their mean, for each of the `shares`; `drop_count` is N + K/2.
    """
    squares = sum(p * np.square(v) for p, v in zip(shares, off, strict=True))
    return np.sqrt(squares / (drop_count + 1))


def quantile(mean: Array, deviation: Array, side: int) -> Array:
    """Return an end of the 95 % interval of a beta distribution by its mean and deviation [1].

    For a share known from a drop test. `deviation` is the standard deviation, `side` is -1 for the
    lower end, 1 for the upper. With the distribution's parameters a and b, its variable x and F = b
    x/(a (1 - x)), the quotient of F^(1/3) (1 - 1/(9 b)) - (1 - 1/(9 a)) and sqrt(F^(2/3)/(9 b) +
    1/(9 a)) is nearly standard normal (Paulson 1942): the ends are right to 0.02 standard
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
