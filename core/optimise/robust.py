"""Values under what is not known: the worst case, the mean or a quantile (theory 12.4)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan import statistics
from vibrafeed.core.plan.grid import parameter_to_si
from vibrafeed.core.plan.statistics import values_at
from vibrafeed.core.study.distributions import Distribution, tolerance
from vibrafeed.core.study.values import Between

NODES = 9  # over the interval of an uncertain parameter
SAMPLES = 64  # points drawn from distributions, for all candidates of a search
BEYOND = 3.2  # of these points lie beyond a quantile, at least
LEAST_SHARE = 1e-3  # of a quantile, from either end: a rarer one takes too many points
SEED = 0  # of the points of a search
LEVELS = {1: NODES, 2: 5, 3: 3}
"""Nodes of each of so many parameters, all with all, for the worst case; of more the two ends."""
MAX_UNCERTAIN = 6

How = Literal["worst", "mean", "quantile"]


@dataclass(frozen=True)
class Uncertain:
    """Parameters that are not known exactly, at the nodes at which candidates are judged.

    Attributes
    ----------
    distributions : mapping of str to Distribution
        Of each parameter.
    values : mapping of str to ndarray
        The parameters at the nodes, shape (nodes,), SI units.
    how : {"worst", "mean", "quantile"}
        What counts over the nodes.
    weights : ndarray, optional
        Of a mean that is no plain one.
    quantile : float
        Which quantile counts.
    counted : int, optional
        The number of nodes, the first ones, that a mean or a quantile counts; constraints hold at
        all nodes. All of them if None.
    """

    distributions: Mapping[str, Distribution]
    values: Mapping[str, Array]
    how: How
    weights: Array | None = None
    quantile: float = 0.5
    counted: int | None = None

    @property
    def size(self) -> int:
        """The number of nodes."""
        return next(iter(self.values.values())).size

    def with_nodes(self, values: Mapping[str, Array]) -> Uncertain:
        """Return the same with further nodes after the others; `values` are theirs, SI units."""
        longer = {name: np.append(one, values[name]) for name, one in self.values.items()}
        return replace(self, values=longer)

    def counts(self, values: Array, sign: float) -> Array:
        """Return the statistic of values over uncertain parameters: least, mean or quantile.

        `values` has the points of the uncertain parameters along its first axis, which is taken
        away. `sign` is -1 if the sign of the output was turned, as it is minimised.
        """
        values = values[: self.counted]
        if self.how == "quantile":
            share = self.quantile if sign > 0 else 1 - self.quantile
            return np.asarray(np.quantile(values, share, axis=0))
        if self.how == "worst":
            return np.asarray(values.min(axis=0))
        if self.weights is None:
            return np.asarray(values.mean(axis=0))
        return np.asarray(np.tensordot(self.weights, values, axes=1))


def uncertain_of(
    distributions: Mapping[str, Distribution],
    how: How,
    quantile: float | None,
    *,
    is_limited: bool = False,
) -> Uncertain:
    """Return the points of uncertain parameters at which each candidate of an optimum is judged.

    The worst case has points all over the box of the tolerances, ends included. Mean and quantile
    have points that are sampled once for all candidates, or those of Gauss for the mean over one
    interval; if limits are to be kept, the points of the box come after them.

    Parameters
    ----------
    distributions : mapping of str to Distribution
        Those of the parameters.
    how : {"worst", "mean", "quantile"}
        What counts of the objective.
    quantile : float or None
        The share for the last of these, 0.5 if None.
    is_limited : bool
        True if outputs have limits to keep.
    """
    (name, law), *others = distributions.items()
    share = 0.5 if quantile is None else quantile
    weights = None
    if how == "worst":
        return Uncertain(distributions, _box(distributions), how)
    if how == "mean" and not others and isinstance(law, Between):
        low, high = parameter_to_si(name, np.array([law.lower, law.upper]))
        roots, weights = np.polynomial.legendre.leggauss(NODES)
        values, weights = {name: low + (high - low) * (roots + 1) / 2}, weights / 2
    else:
        count = samples_of(how, share)
        values = values_at(distributions, statistics.points(len(distributions), count, SEED)[:, 0])
    uncertain = Uncertain(distributions, values, how, weights, share)
    if not is_limited:
        return uncertain
    return replace(uncertain.with_nodes(_box(distributions)), counted=uncertain.size)


def samples_of(how: How, quantile: float) -> int:
    """Return the number of sampled points for a mean or a quantile, a power of two."""
    rare = min(quantile, 1 - quantile) if how == "quantile" else 0.5
    return max(SAMPLES, 1 << math.ceil(math.log2(BEYOND / rare)))


def _box(distributions: Mapping[str, Distribution]) -> dict[str, Array]:
    """Return the points at which uncertain parameters are evaluated for a worst case, SI units.

    They are a grid over the box of the tolerances, corners included, and its middle: an array
    (nodes,) for each parameter. The more parameters, the coarser the grid. `distributions` are
    those of the parameters.
    """
    count = len(distributions)
    shares = np.linspace(0.0, 1.0, LEVELS.get(count, 2))
    nodes = np.array(list(product(shares, repeat=count)))
    if shares.size == 2:
        nodes = np.concatenate([nodes, np.full((1, count), 0.5)])
    bounds = {}
    for (name, one), share in zip(distributions.items(), nodes.T, strict=True):
        lower, upper = tolerance(name, one)
        bounds[name] = parameter_to_si(name, lower + (upper - lower) * share)
    return bounds
