"""Values under what is not known: the worst case or the mean over an interval (theory 12.4)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from core.mechanics.arrays import Array

NODES = 9  # over the interval of an uncertain parameter

UncertainEvaluate = Callable[[Array, Array], Array]
"""Takes points (n, d) and a value of the uncertain parameter for each (n,), returns values (n,)."""


def robust_value(
    evaluate: UncertainEvaluate,
    interval: ArrayLike,
    *,
    how: Literal["worst", "mean"] = "worst",
    nodes: int = NODES,
) -> Callable[[Array], Array]:
    """Return an objective that knows a parameter only within an interval, for any optimiser.

    Parameters
    ----------
    evaluate : callable
        The objective for known values: takes points (n, d) and values of the parameter (n,).
    interval : array_like, shape (2,)
        Ends of the interval.
    how : {"worst", "mean"}
        The least value over evenly spaced nodes with both ends, or the mean over the interval by
        Gauss's rule.
    nodes : int
        At least 2 for the worst case: enough where the objective is monotone in the parameter.
        An inner minimum is missed by its curvature times the square of the distance of nodes. The
        mean is exact for polynomials up to degree 2 nodes - 1; across a jump its error is of the
        order of the jump over the nodes.

    Returns
    -------
    callable
        Takes points (n, d), returns values (n,): NaN where a node has none.
    """
    places, weights = nodes_over(interval, how, nodes)

    def robust(points: Array) -> Array:
        count = len(points)
        values = np.asarray(evaluate(np.tile(points, (nodes, 1)), np.repeat(places, count)))
        return over_nodes(values.reshape(nodes, count), weights)

    return robust


def nodes_over(interval: ArrayLike, how: str, nodes: int = NODES) -> tuple[Array, Array | None]:
    """Return nodes over an interval, and weights of a mean; None for the worst case."""
    low, high = (float(end) for end in np.asarray(interval, dtype=np.float64))
    if not low <= high:
        raise ValueError("the interval has to be finite, and in order")
    if nodes < (2 if how == "worst" else 1):
        raise ValueError("too few nodes")
    if how == "worst":
        return np.linspace(low, high, nodes), None
    if how == "mean":
        roots, weights = np.polynomial.legendre.leggauss(nodes)
        return low + (high - low) * (roots + 1) / 2, weights / 2
    raise ValueError(f"how is 'worst' or 'mean', not '{how}'")


def over_nodes(values: Array, weights: Array | None) -> Array:
    """Return the least, or the mean, of values over nodes, which are the first axis."""
    if weights is None:
        return np.asarray(values.min(axis=0))
    return np.asarray(np.tensordot(weights, values, axes=1))
