"""Types of the arrays that kernels take, and how one is copied into another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiled import compiled

Floats = NDArray[np.float64]
Statuses = NDArray[np.int8]
Flags = NDArray[np.int64]
Stop = NDArray[np.int8]
"""One flag, which another thread raises where a cell is not to be gone on with."""
NEVER: Stop = np.zeros(1, dtype=np.int8)
"""A stop flag that nobody raises, for callers from Python."""


@compiled
def copy(source: Floats, target: Floats) -> None:
    """Copy a 1-d array of floats into another of the same length: `target[:] = source`.

    A loop, because numba takes a second to compile the slice assignment.
    """
    for place in range(target.size):
        target[place] = source[place]
