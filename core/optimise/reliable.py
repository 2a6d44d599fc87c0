"""The best point of a search that does not owe its value to chance, as rounded means may.

Of ten thousand such means the largest is one that chance favoured. The best points are followed
again, over a longer time, and that is kept which can be relied on most: the largest mean less its
error. A point whose motion repeats, and whose mean is therefore known, competes with them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.optimise.problem import LONGEST, UNKNOWN, OptimisationProblem

NICHES = 128  # along each variable: of the points in one cell of such a grid the best competes
FOLLOWED = 32  # followed again: so many of largest mean less each share of its error
SHARES = (0.0, 1 / 3, 1.0)  # a longer run leaves about a third
ROUNDS = ((8.0, 4), (LONGEST, 1))
"""How many times as long they are followed, and how many are kept then."""


def most_reliable(
    problem: OptimisationProblem,
    unit: Array,
    judged: tuple[Array, Array, Array],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> tuple[int, float]:
    """Return index and objective of the best point after longer runs; -inf without a value.

    That of the largest objective if its motion repeats; else that of the largest objective less
    error, once the motions that chance favours are followed for longer. Points that keep the
    constraints come first.

    Parameters
    ----------
    problem : OptimisationProblem
    unit : ndarray, shape (variables, n)
        Points that were evaluated, as shares of the bounds.
    judged : tuple of ndarray, each of shape (n,)
        Their objective, violation, and how far chance may have moved the objective.
    design, scales : mapping of str to ndarray
        Of one design, arrays of shape (1,).
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
    """Return the indices of the best points, at most one in each cell of a coarse grid."""
    order = np.argsort(-value, kind="stable")
    _, first = np.unique(cells[:, order], axis=1, return_index=True)
    return order[np.sort(first)][:FOLLOWED]
