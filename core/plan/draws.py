"""Points that fill the unit box evenly, and the values of uncertain parameters that they stand for.

Scrambled Sobol points: each set is evenly spread and random, so that several sets tell how far off
their mean may be. Equal seeds give equal bits.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.study.distributions import Distribution, quantiles

BITS = 30
"""Binary digits of a coordinate; points lie in the middle of cells of that size, so that none lies
on an edge."""


def points(dimensions: int, count: int, seed: int, replicates: int = 1) -> Array:
    """Return Sobol points, which fill the unit box evenly, in several independent sets.

    Parameters
    ----------
    dimensions : int
        Of the box.
    count : int
        Points of each set, a power of two.
    seed : int
        Seed of the scrambling: equal seeds give equal points.
    replicates : int
        Number of sets, each scrambled by itself: their scatter shows the error of a mean.

    Returns
    -------
    ndarray, shape (dimensions, replicates, count)
        Coordinates above 0 and below 1.
    """
    random = np.random.default_rng(seed)
    sets = [
        scipy.stats.qmc.Sobol(dimensions, scramble=True, bits=BITS, rng=random).random(count)
        for _ in range(replicates)
    ]
    return np.ascontiguousarray(np.moveaxis(np.stack(sets), 2, 0)) + 0.5 ** (BITS + 1)


def values_at(distributions: Mapping[str, Distribution], shares: Array) -> dict[str, Array]:
    """Return the parameters at points of the unit box, in SI units and radians.

    Parameters
    ----------
    distributions : mapping of str to Distribution
        The distribution of each parameter, in the order of the coordinates.
    shares : ndarray, shape (parameters, ...)
        The points: for each parameter, the share of its distribution below the value.

    Returns
    -------
    dict of str to ndarray
        Values of each parameter, of the shape of a coordinate.
    """
    return {
        name: parameter_to_si(name, quantiles(name, one, share))
        for (name, one), share in zip(distributions.items(), shares, strict=True)
    }
