"""The practical range: the parts and drives that an atlas is made for, and random ones of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.atlas.numbers import Numbers, out_of_range

PRACTICAL: Mapping[str, tuple[float, float]] = {
    "friction_kinetic": (0.1, 1.0),
    "beta": (5.0, 75.0),  # degrees
    "gamma": (-10.0, 10.0),  # degrees
    "friction_ratio": (1.0, 1.6),
    "throw_number": (0.1, 3.7),
}
"""Least and largest value that are found in practice."""

LEVEL = 0.25
"""Share of the cells whose track is level: most are."""

ONE_FRICTION = 0.5
"""Share of the cells with one coefficient of friction: who knows no two gives one."""


def practical_numbers(shares: NDArray[np.float64]) -> Numbers:
    """Return the four numbers of the atlas for parts and drives as they occur in practice.

    With a set of evenly spread `shares`, the atlas is refined and tested where it is used most.
    Members with a number outside the axes of the atlas are left out, so that the arrays of the
    result may have fewer than n.

    Parameters
    ----------
    shares : ndarray, shape (n, 7)
        Numbers from 0 to 1. The first five are the position of friction coefficient, angle of
        vibration, slope, ratio of the friction coefficients and throw number within their ranges in
        `PRACTICAL`. The track is level where the sixth is below `LEVEL`, and both friction
        coefficients are equal where the seventh is below `ONE_FRICTION`.
    """
    ends = np.array(list(PRACTICAL.values()))
    friction, beta, gamma, ratio, throw = (ends[:, 0] + shares[:, :5] * np.ptp(ends, axis=1)).T
    gamma = np.where(shares[:, 5] < LEVEL, 0.0, gamma)
    ratio = np.where(shares[:, 6] < ONE_FRICTION, 1.0, ratio)
    numbers = Numbers(
        throw,
        friction * np.tan(np.deg2rad(beta)),
        np.tan(np.deg2rad(gamma)) / friction,
        ratio,
    )
    inside = ~np.logical_or.reduce(list(out_of_range(numbers).values()))
    return Numbers(*(values[inside] for values in numbers))


def spread_points(count: int) -> NDArray[np.float64]:
    """Return `count` evenly spread points of the seven-dimensional unit cube, shape (count, 7).

    They are the additive recurrence x_n = n a mod 1, a_k = r^-k, with r the root of r^8 = r + 1;
    the same at every call. They sample the practical range of parts and drives.
    """
    dims = 7
    root = 1.0
    for _ in range(60):  # x^(dims + 1) = x + 1
        root = (1.0 + root) ** (1.0 / (dims + 1))
    steps = root ** -np.arange(1.0, dims + 1)
    return np.asarray((np.arange(1, count + 1)[:, None] * steps) % 1.0)
