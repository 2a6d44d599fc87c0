"""Devices on a track that let parts pass by the way they lie, one after another (theory 16.3).

A device is a matrix D of one row an aspect: the share of parts that arrive in it and go on in each.
What a row lacks of 1 falls back into the bowl and comes again, in any orientation. Matrices are
tuples of rows of arrays that broadcast, 0.0 and 1.0 where nothing else can stand there.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, hypot, ratio

Matrix = Sequence[Sequence[Array]]

CERTAIN = 0.01
"""Share of the parts that need more laps than `laps_99`."""


class Aspect(NamedTuple):
    """The size of a part as it lies: its height, and its sizes across and along the track [m].

    Its centre of mass may be off the middle, across and along.
    """

    height: Array
    across: Array
    along: Array
    off_across: Array | float = 0.0
    off_along: Array | float = 0.0


class PassedShares(NamedTuple):
    """The shares of parts that pass a line of devices.

    Attributes
    ----------
    matrix : tuple of tuple of ndarray
        Row i holds the shares of the parts arriving in aspect i that leave in each aspect [1].
    leaving : tuple of ndarray
        For each aspect, the share of all arriving parts that leave the line in it [1].
    pure : tuple of ndarray
        For each aspect, the share of the leaving parts that leave in it [1]; NaN if none leaves.
    passing : tuple of ndarray
        For each aspect, the share of the parts arriving in it that leave, in any aspect [1].
    total : ndarray
        Share of all arriving parts that leave [1].
    lost : ndarray
        Share of all arriving parts that fall back [1]; exactly 0 where each aspect passes whole.
    """

    matrix: Matrix
    leaving: tuple[Array, ...]
    pure: tuple[Array, ...]
    passing: tuple[Array, ...]
    total: Array
    lost: Array


# --- sizes of parts as they lie, the longer side along the wall


def box_aspects(*, length: Array, width: Array, height: Array) -> tuple[Aspect, ...]:
    """Return the sizes of a box in each aspect: flat, on its side, on its end [m]."""
    sides = ((height, length, width), (width, length, height), (length, width, height))
    return tuple(
        Aspect(up, np.minimum(side, other_side), np.maximum(side, other_side))
        for up, side, other_side in sides
    )


def weighted_box_aspects(
    *, length: Array, width: Array, height: Array, centre_of_mass: Array
) -> tuple[Aspect, ...]:
    """Return the sizes of a box with its mass off the middle of its height, in each aspect [m].

    Flat, on its side, on its end, and inverted.
    """
    flat, *others = box_aspects(length=length, width=width, height=height)
    offset = np.abs(centre_of_mass - height / 2)
    tilted = [
        aspect._replace(
            off_across=np.where(height <= base_side, offset, 0.0),
            off_along=np.where(height <= base_side, 0.0, offset),
        )
        for aspect, base_side in zip(others, (length, width), strict=True)
    ]
    return flat, *tilted, flat


def cylinder_aspects(*, length: Array, diameter: Array) -> tuple[Aspect, ...]:
    """Return the sizes of a cylinder in each aspect: on its side, on an end [m]."""
    return Aspect(diameter, diameter, length), Aspect(length, diameter, diameter)


def prism_aspects(*, sides: Array, length: Array, diameter: Array) -> tuple[Aspect, ...]:
    """Return the sizes of a prism as it may lie: on a side, or on an end [m].

    Above the side that it lies on is another one, or a corner where their number is odd.
    """
    inner_radius = diameter / 2 * cosine(np.pi / sides)
    has_opposite_side = np.rint(sides / 2) * 2 == sides
    lying = Aspect(
        inner_radius + np.where(has_opposite_side, inner_radius, diameter / 2), diameter, length
    )
    return lying, Aspect(length, diameter, diameter)


def turned_aspects(*, diameter: Array, small_diameter: Array, height: Array) -> tuple[Aspect, ...]:
    """Return the sizes of a turned part as it may lie: upright, on its side, inverted [m].

    On its side the rim of the large end is d cos(th) high, th half the angle of the cone, and the
    other rim reaches out by d_2 sin(th) over the side.
    """
    radius_difference = np.abs(diameter - small_diameter) / 2
    side = hypot(radius_difference, height)
    large, small = np.maximum(diameter, small_diameter), np.minimum(diameter, small_diameter)
    lying = Aspect(large * (height / side), large, side + small * (radius_difference / side))
    return Aspect(height, large, large), lying, Aspect(height, large, large)


# --- matrices


def unchanged(aspects: int) -> Matrix:
    """Return the identity matrix: a device that neither turns nor rejects parts."""
    return [[np.asarray(float(i == j)) for j in range(aspects)] for i in range(aspects)]


def test_of(kept: Sequence[Mask]) -> Matrix:
    """Return the diagonal matrix of a device that lets parts of an aspect pass or not."""
    diagonal, zero = [np.where(entry, 1.0, 0.0) for entry in kept], np.zeros(())
    return [
        [entry if i == j else zero for j in range(len(kept))] for i, entry in enumerate(diagonal)
    ]


def turning(matrix: Matrix, turned_share: Array, turn: Array, *, failed: bool) -> Matrix:
    """Return the matrix of a device that turns a share of the parts of one aspect into another.

    `turn` names the aspects as two digits, 21 from aspect 2 to 1. If `failed` is True the share is
    of the parts that the device rejects, and the others of these fall into the bowl; else of those
    that pass, and the others stay.
    """
    places = range(len(matrix))
    rows = [[*row] for row in matrix]
    for i in places:
        for j in places:
            if i == j:
                continue
            share = np.where(turn == 10 * (i + 1) + (j + 1), turned_share, 0.0)
            rows[i][j] = rows[i][j] + share * ((1 - matrix[i][i]) if failed else matrix[i][i])
            if not failed:
                rows[i][i] = rows[i][i] - share * matrix[i][i]
    return rows


def product(first: Matrix, second: Matrix) -> Matrix:
    """Return the matrix of two devices in sequence: entry (i, j) is the sum of first_ik second_kj.

    Parts meet the device `first` before the device `second`.
    """
    places = range(len(first))
    return [[_sum([row[k] * second[k][j] for k in places]) for j in places] for row in first]


def mean(matrices: Sequence[Matrix]) -> Matrix:
    """Return the mean of the matrices of parts that lie either way round."""
    if len(matrices) == 1:
        return matrices[0]
    places, weight = range(len(matrices[0])), 1.0 / len(matrices)
    return [[weight * _sum([matrix[i][j] for matrix in matrices]) for j in places] for i in places]


def _sum(terms: Sequence[Array]) -> Array:
    return sum(terms[1:], terms[0])


def passed(shares: Sequence[Array], matrix: Matrix) -> PassedShares:
    """Return the shares of parts that leave a line, by aspect and in all.

    `shares` are those of the arriving parts in each aspect, `matrix` that of all the line's
    devices.
    """
    aspects = range(len(shares))
    leaving = tuple(_sum([shares[i] * matrix[i][j] for i in aspects]) for j in aspects)
    passing = tuple(_sum(row) for row in matrix)
    total = np.minimum(_sum(leaving), 1.0)
    return PassedShares(
        matrix=tuple(tuple(row) for row in matrix),
        leaving=leaving,
        pure=tuple(np.minimum(ratio(share, total, np.nan), 1.0) for share in leaving),
        passing=passing,
        total=total,
        lost=_sum([shares[i] * np.maximum(1 - passing[i], 0.0) for i in aspects]),
    )


def outlet_share(
    shares: Sequence[Array], matrix: Matrix, arrival_rate: Array, capacity: Array
) -> Array:
    """Return the share of a flow that an outlet of some capacity takes, min(1, c/q) [1].

    c is the most parts a minute that pass, q what arrives at it after the devices before
    (`matrix`).
    """
    return np.minimum(1.0, ratio(capacity, arrival_rate * passed(shares, matrix).total, np.inf))


# --- orders


def devices_in_order(order: Array, count: int) -> list[Array]:
    """Return the index of the device at each position, for one of the count! possible orders.

    Orders count from 1 as words in a dictionary do: 1 is 1, 2, 3, ...; the last one goes backwards.
    A number between two, where a search may look, means the nearer one. The digits of order - 1 in
    the base of factorials say how many of the devices that are left come before.
    """
    digits, remainder = [], np.rint(order) - 1
    for position in range(count - 1):
        orders_per_digit = float(np.prod(range(1, count - position)))
        digit = np.rint((remainder + 0.5) / orders_per_digit - 0.5)  # rounded down
        digits.append(digit)
        remainder = remainder - digit * orders_per_digit
    digits.append(0 * remainder)
    for position in reversed(range(count - 1)):
        for later in range(position + 1, count):
            digits[later] = digits[later] + np.where(digits[position] <= digits[later], 1.0, 0.0)
    return digits


# --- what comes of it


def laps(*, line: PassedShares) -> Array:
    """Return the mean number of laps of a part until it passes, 1/eta, with the yield eta [1]."""
    return ratio(np.ones(()), line.total, np.inf)


def laps_variance(*, line: PassedShares) -> Array:
    """Return the variance of the laps that a part needs, (1 - eta)/eta^2 [1].

    eta is the yield of the line.
    """
    return ratio(line.lost, line.total * line.total, np.inf)


def laps_99(*, line: PassedShares) -> Array:
    """Return the number of laps within which 99 of 100 parts pass, ln 0.01/ln(1 - eta) [1].

    eta is the yield: the share of parts that pass in a lap. At least 1; infinite where no part
    passes.
    """
    some_fall_and_pass = (line.lost > 0) & (line.total > 0)
    is_low_yield = some_fall_and_pass & (line.total < 0.5)  # where 1 - eta would lose what eta is
    log_lost = np.where(
        is_low_yield,
        np.log1p(-np.where(is_low_yield, line.total, 0.5)),
        np.log(np.where(some_fall_and_pass, line.lost, 0.5)),
    )
    laps = np.log(CERTAIN) / np.where(some_fall_and_pass & (log_lost < 0), log_lost, -1.0)
    return np.where(some_fall_and_pass, np.maximum(laps, 1.0), np.where(line.lost > 0, np.inf, 1.0))


def time_per_part(*, lap_time: Array, laps: Array) -> Array:
    """Return the mean time of a part in the bowl until it passes, T/eta [s]."""
    return lap_time * laps


def rate_by_pitch(*, arrival_speed: Array, part_pitch: Array) -> Array:
    """Return the number of parts that arrive in one row per minute, 60 v/pitch [min-1]."""
    return 60 * arrival_speed / part_pitch


def line_ends(
    *, line: PassedShares, thrown_line: PassedShares
) -> tuple[PassedShares, PassedShares]:
    """Return the shares that pass at both ends of the bracket: parts let down, and thrown."""
    return line, thrown_line


def line_yield(*, line: PassedShares) -> Array:
    """Return the share of the arriving parts that leave the line, in any aspect [1]."""
    return line.total


def line_feed_rate(*, arrival_rate: Array, line: PassedShares) -> Array:
    """Return the number of parts that leave the line per minute, in any aspect, q eta [min-1]."""
    return arrival_rate * line.total


def return_rate(*, arrival_rate: Array, line: PassedShares) -> Array:
    """Return the number of parts that fall back into the bowl per minute, q (1 - eta) [min-1].

    0 where all parts pass.
    """
    return arrival_rate * line.lost


def purity(*, line: PassedShares, wanted_aspect: Array) -> Array:
    """Return the share of the leaving parts that lie in the wanted aspect [1].

    NaN where no part leaves.
    """
    return _wanted(line.pure, wanted_aspect)


def leaving_wanted(*, line: PassedShares, wanted_aspect: Array) -> Array:
    """Return the share of the arriving parts that leave a line of devices as they are wanted [1].

    `wanted_aspect` is the number of their aspect, from 1.
    """
    return _wanted(line.leaving, wanted_aspect)


def oriented_feed_rate(*, arrival_rate: Array, line: PassedShares, wanted_aspect: Array) -> Array:
    """Return the number of parts that leave in the wanted aspect per minute [min-1]."""
    return arrival_rate * _wanted(line.leaving, wanted_aspect)


def _wanted(shares: Sequence[Array], wanted_aspect: Array) -> Array:
    value = shares[0]
    for aspect, share in enumerate(shares[1:], 2):
        value = np.where(wanted_aspect == aspect, share, value)
    return value


# --- Shares by a drop test, and how well they are known: Dirichlet's distribution (theory 16.4).

PRIOR = 0.5
"""Count that each aspect has before the test, as by Jeffreys' prior."""

DEVIATIONS = 1.959963984540054
"""Standard deviations from the mean within which 95 % of a normal distribution lie."""


def posterior_shares(**counts: Array) -> tuple[Array, ...]:
    """Return the share of parts that come to rest in each aspect, estimated from a drop test [1].

    The mean of Dirichlet's distribution, (n_o + 1/2)/(N + K/2): n_o parts were seen in each of K
    aspects, N in all.
    """
    total = posterior_count(**counts)
    return tuple((count + PRIOR) / total for count in counts.values())


def posterior_count(**counts: Array) -> Array:
    """Return the sum of the counts of a drop test's aspects with their prior, N + K/2 [1].

    The weight of the test: N parts came to rest in K aspects, each of which counts 1/2 before it.
    """
    return _sum([count + PRIOR for count in counts.values()])


def yield_deviation(
    *, counted_shares: tuple[Array, ...], counted_line: PassedShares, drop_count: Array
) -> Array:
    """Return the standard deviation of the yield that a drop test leaves [1].

    sqrt(sum p_o (v_o - eta)^2/(A + 1)): p_o are the counted shares of the aspects, v_o the shares
    of them that pass, eta the yield, A = N + K/2.
    """
    total = counted_line.total
    return _standard_deviation(
        counted_shares, [v - total for v in counted_line.passing], drop_count
    )


def tested_line_ends(
    *, counted_shares: tuple[Array, ...], counted_line: PassedShares, drop_count: Array
) -> tuple[PassedShares, PassedShares]:
    """Return the lower and the upper ends of all shares of a line after a drop test [1].

    Each share has its own interval of 95 %, the quantiles of the beta distribution with its mean
    and standard deviation, which is exactly the yield's where each aspect passes as a whole or not
    at all. That of a purity, the quotient of two such shares, is taken to first order.
    """
    line, aspects = counted_line, range(len(counted_shares))

    def deviation(excess: Sequence[Array]) -> Array:
        return _standard_deviation(counted_shares, excess, drop_count)

    columns = [[row[j] for row in line.matrix] for j in aspects]
    total_deviation = deviation([v - line.total for v in line.passing])
    leaving_deviations = [deviation([v - line.leaving[j] for v in columns[j]]) for j in aspects]
    pure_excesses = [
        [v - line.pure[j] * passing for v, passing in zip(columns[j], line.passing, strict=True)]
        for j in aspects
    ]
    pure_deviations = [ratio(deviation(excess), line.total, 0.0) for excess in pure_excesses]

    def end(side: int) -> PassedShares:
        total = quantile(line.total, total_deviation, side)
        return line._replace(
            leaving=tuple(quantile(line.leaving[j], leaving_deviations[j], side) for j in aspects),
            pure=tuple(quantile(line.pure[j], pure_deviations[j], side) for j in aspects),
            total=total,
            lost=quantile(line.lost, total_deviation, -side),
        )

    return end(-1), end(1)


def _standard_deviation(
    shares: Sequence[Array], excess: Sequence[Array], drop_count: Array
) -> Array:
    squares = sum(
        share * np.square(difference) for share, difference in zip(shares, excess, strict=True)
    )
    return np.sqrt(squares / (drop_count + 1))


def quantile(mean: Array, deviation: Array, side: int) -> Array:
    """Return an end of the 95 % interval of a beta distribution by its mean and deviation [1].

    `side` is -1 for the lower end, 1 for the upper. With the distribution's parameters a and b, its
    variable x and F = b x/(a (1 - x)), the quotient of F^(1/3) (1 - 1/(9 b)) - (1 - 1/(9 a)) and
    sqrt(F^(2/3)/(9 b) + 1/(9 a)) is nearly standard normal (Paulson 1942): the ends are right to
    0.02 standard deviations for a, b >= 1, and to 0.07 where nothing was counted.
    """
    has_interval = (deviation > 0) & (mean > 0) & (mean < 1)
    safe_mean, safe_deviation = (
        np.where(has_interval, mean, 0.5),
        np.where(has_interval, deviation, 0.1),
    )
    count = safe_mean * (1 - safe_mean) / np.square(safe_deviation) - 1
    a, b = safe_mean * count, (1 - safe_mean) * count
    ninth_a, ninth_b = 1 / (9 * a), 1 / (9 * b)
    z_squared = DEVIATIONS * DEVIATIONS
    lead = np.square(1 - ninth_b) - z_squared * ninth_b
    middle = (1 - ninth_b) * (1 - ninth_a)
    rest = np.square(1 - ninth_a) - z_squared * ninth_a
    # The ends are roots of lead t^2 - 2 middle t + rest, t = F^(1/3), or an end of the range.
    root = middle + np.sqrt(np.square(middle) - lead * rest)
    cube_root = np.maximum(
        (lead if side > 0 else rest) / root, 0.0
    )  # 1/t of the upper, t of the lower
    numerator_factor, denominator_term = (b, a) if side > 0 else (a, b)
    weighted_cube = numerator_factor * (cube_root * cube_root * cube_root)
    lower_end = weighted_cube / (weighted_cube + denominator_term)
    return np.where(has_interval, 1 - lower_end if side > 0 else lower_end, mean)
