"""Input of kernels: types of arrays, a flag that stops them, a cell as a named tuple."""

from collections import namedtuple

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple
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
    """Copy a 1-d array of floats into another of the same length: `target[:] = source`."""
    for place in range(target.size):
        target[place] = source[place]


Cell = namedtuple(
    "Cell",
    "drive_number_along drive_number_normal gravity_number_along gravity_number_normal "
    "friction_static friction_kinetic restitution drive_number_across gravity_number_across "
    "curvature_number wall_friction wall_restitution impact_damping tolerance max_periods",
)
"""The numbers of `vibrafeed.core.motion.method.Groups`, in its order, and a method's settings."""

GROUPS = len(Cell._fields)  # number of columns of a cell, before those of its wave


@compiled
def cell_of(row: Floats) -> Cell:
    """Return the first columns of a kernel's row, shape (columns,), as a named tuple `Cell`."""
    return Cell(*to_fixed_tuple(row, GROUPS))  # type: ignore[call-arg] # the compiler gives one
