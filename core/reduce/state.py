"""The state of a block of slots after some of its cells: arrays that can be joined and kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.reduce.sums import add_sums

STOPPED = "it was stopped before all cells were evaluated, so there is no result"
"""Message of a stopped reduction: statistics of some of the cells are no result."""

State = dict[str, NDArray[Any]]
"""By name: what it is of, a full stop, and one of

- ``ends``, shape (5, slots): key and number of the largest, the same of the least, and how many;
- ``low`` and ``digits``: a sum by level, as in `vibrafeed.core.reduce.sums`, and ``beyond``, shape
  (slots,): the sum of what is not finite;
- ``bins`` and ``filled``: a histogram, where it is not empty;
- ``quantiles``, shape (quantiles, slots): final, where all cells were seen at once;
- ``count``, shape (slots,);
- ``smallest`` or ``largest``, shape (slots,): a crossing; infinite if there is none.
"""


def merge_states(first: State, second: State) -> State:
    """Return the state of the statistics after two sets of cells, from the states after each.

    A state has counts, extremes, sums and histograms by name, arrays over points of the result; the
    order of the two does not matter.

    Raises
    ------
    ValueError
        For quantiles, which need all cells of a point at once.
    """
    result: State = {}
    for name in first:
        of, _, kind = name.rpartition(".")
        mine, yours = first[name], second[name]
        if kind == "ends":
            result[name] = _ends(mine, yours)
        elif kind == "low":
            low, digits = add_sums(
                (int(mine[0]), first[f"{of}.digits"]), (int(yours[0]), second[f"{of}.digits"])
            )
            result |= {name: np.array([low]), f"{of}.digits": digits}
        elif kind == "beyond":
            with np.errstate(invalid="ignore"):
                result[name] = mine + yours
        elif kind == "bins":
            bins, positions = np.unique(np.concatenate([mine, yours]), return_inverse=True)
            filled = np.zeros(bins.size, np.int64)
            np.add.at(
                filled, positions, np.concatenate([first[f"{of}.filled"], second[f"{of}.filled"]])
            )
            result |= {name: bins, f"{of}.filled": filled}
        elif kind == "count":
            result[name] = mine + yours
        elif kind in ("smallest", "largest"):
            result[name] = (np.minimum if kind == "smallest" else np.maximum)(mine, yours)
        elif kind == "quantiles":
            raise ValueError(
                "quantiles of parts of the cells cannot be joined: compute the quantiles "
                "of all cells at once"
            )
    return result


def size(state: Mapping[str, NDArray[Any]]) -> int:
    """Return the bytes of a state."""
    return sum(array.nbytes for array in state.values())


def _ends(mine: NDArray[np.int64], yours: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the combined extremes and counts of two states, int64 of shape (5, slots).

    Rows are key and cell of the largest value, the same of the least, and the number of cells, for
    each point of the result; a key is an integer that sorts like the float. Of equal values the
    cell that is first in the grid is taken.
    """
    higher = (yours[0] > mine[0]) | ((yours[0] == mine[0]) & (yours[1] < mine[1]))
    lower = (yours[2] < mine[2]) | ((yours[2] == mine[2]) & (yours[3] < mine[3]))
    result = mine.copy()
    result[:2, higher] = yours[:2, higher]
    result[2:4, lower] = yours[2:4, lower]
    result[4] += yours[4]
    return result
