"""The best point of a search that does not owe its value to chance, as rounded means may.

Of ten thousand such means the largest is one that chance favoured. The best points are followed
again, over a longer time, and that is kept which can be relied on most: the largest mean less its
error. A point whose motion repeats, and whose mean is therefore known, competes with them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.problem import LONGEST, UNKNOWN, OptimisationProblem

NICHES = 128  # cells of a grid along each variable; the best point of each cell competes
FOLLOWED = 32  # points that are followed again, for each of the shares below
SHARES = (0.0, 1 / 3, 1.0)  # of its error, less which a mean is ranked; longer runs leave 1/3
ROUNDS = ((8.0, 4), (LONGEST, 1))
"""Rounds of longer runs: the factor of their length, and the number of points kept then."""


def most_reliable(
    problem: OptimisationProblem,
    unit: Array,
    judged: tuple[Array, Array, Array],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> tuple[int, float]:
    """Return index and objective of the best evaluated point, chosen after longer runs if need be.

    If the motion of the best point repeats, its mean is exact, and it is taken. Else the points of
    the largest objective less its statistical error are followed for longer, and the best of these
    is taken. Points that keep the constraints come first. The objective is -inf if no point has a
    value.

    Parameters
    ----------
    problem : OptimisationProblem
        The problem.
    unit : ndarray, shape (variables, n)
        Points that were evaluated, as shares of the bounds.
    judged : tuple of ndarray, each of shape (n,)
        Their objective, violation of constraints, and statistical error of the objective.
    design, scales : mapping of str to ndarray
        Fixed parameters and sizes of the outputs of one design, arrays of shape (1,).
    """
    value, beyond, chance_error = judged
    best = int(np.lexsort((-value, beyond))[0])
    if not np.isfinite(value[best]) or chance_error[best] == 0:
        return best, float(value[best])
    open_ = np.flatnonzero((beyond <= beyond[best]) & np.isfinite(value))
    cells = np.minimum((unit[:, open_] * NICHES).astype(np.int64), NICHES - 1)
    unsure = _known(chance_error[open_])
    ranked = [_best_of_cells(cells, value[open_] - share * unsure) for share in SHARES]
    chosen = open_[np.unique(np.concatenate(ranked))]
    lower, upper = problem.lower[:, None], problem.upper[:, None]
    for times, most in ROUNDS:
        shares = unit[:, chosen]
        x = np.where(shares == 1, upper, lower + shares * (upper - lower))
        again, violation, unsure = problem.longer(times).judged_with_error(x, design, scales)
        kept = np.lexsort((_known(unsure) - again, violation))[:most]
        chosen = chosen[kept]
    return int(chosen[0]), float(again[kept[0]])


def _known(chance_error: Array) -> Array:
    """Return the error by chance, 0 where it is unknown."""
    return np.where(chance_error < UNKNOWN, chance_error, 0.0)


def _best_of_cells(cells: NDArray[np.int64], value: Array) -> NDArray[np.intp]:
    """Return the indices of the best points, at most one in each cell of a coarse grid.

    `cells` are the cell of each point, shape (variables, n), and `value` ranks the points; at most
    32 are returned.
    """
    order = np.argsort(-value, kind="stable")
    _, first = np.unique(cells[:, order], axis=1, return_index=True)
    return order[np.sort(first)][:FOLLOWED]
