"""Which of the best points of a search stand: means of motions that rounding decides are chance.

Of ten thousand such means the largest is one that chance favoured. The best points are followed
again, over a longer time, and that is kept which can be relied on most: the largest mean less its
error. A point whose motion repeats, and whose mean is therefore known, competes with them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.optimise.problem import UNKNOWN, Problem

NICHES = 128  # along each variable: of the points in one cell of such a grid the best competes
LOOKED_AT = 256  # niches, the best first
FOLLOWED = 32  # of those, followed again: so many of largest mean less each share of its error
SHARES = (0.0, 1 / 3, 1.0)  # a longer run leaves about a third


def standing(
    problem: Problem,
    unit: Array,
    value: Array,
    beyond: Array,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> tuple[int, float]:
    """Return the place of the best point, and its objective, -inf without a value.

    That of the largest objective if its motion repeats; else that of the largest objective less
    error, once the motions that chance favours are followed for longer. Points that keep the
    constraints come first.

    Parameters
    ----------
    problem : Problem
    unit : ndarray, shape (variables, n)
        Points that were evaluated, as shares of the bounds.
    value, beyond : ndarray, shape (n,)
        Their objective and violation.
    design, scales : mapping of str to ndarray
        Of one design, arrays of shape (1,).
    """
    order = np.lexsort((-value, beyond))
    best = int(order[0])
    span = (problem.upper - problem.lower)[:, None]

    def place(points: NDArray[np.intp]) -> Array:
        shares = unit[:, points]
        lower, upper = problem.lower[:, None], problem.upper[:, None]
        return np.where(shares == 1, upper, lower + shares * span)

    if not np.isfinite(value[best]) or not problem.doubt(place(order[:1]), design)[0] > 0:
        return best, float(value[best])
    order = order[beyond[order] <= beyond[best]]
    cells = np.minimum((unit[:, order] * NICHES).astype(np.int64), NICHES - 1)
    _, first = np.unique(cells, axis=1, return_index=True)
    order = order[np.sort(first)][:LOOKED_AT]
    order = order[np.isfinite(value[order])]
    unsure = problem.doubt(place(order), design)
    ranks = [np.argsort(share * unsure - value[order], kind="stable") for share in SHARES]
    chosen = order[np.unique(np.concatenate([rank[:FOLLOWED] for rank in ranks]))]
    longer = problem.longer()
    again, violation = longer.judged(place(chosen), design, scales)
    doubt = longer.doubt(place(chosen), design)
    # Where nobody knows the error the longer run has the word.
    sure = again - np.where(doubt < UNKNOWN, doubt, 0.0)
    kept = np.lexsort((-sure, violation))[0]
    return int(chosen[kept]), float(again[kept])
