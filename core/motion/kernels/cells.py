"""A cell as kernels read it: the first columns of a row; the wave, if there is one, comes after."""

from __future__ import annotations

from collections import namedtuple

from numba.np.unsafe.ndarray import to_fixed_tuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats

Cell = namedtuple(
    "Cell",
    "drive_number_along drive_number_normal gravity_number_along gravity_number_normal "
    "friction_static friction_kinetic restitution drive_number_across gravity_number_across "
    "curvature_number wall_friction wall_restitution impact_damping tolerance max_periods",
)
"""The numbers of `vibrafeed.core.motion.groups.Groups`, in its order, and a method's settings."""

GROUPS = len(Cell._fields)  # number of columns of a cell, before those of its wave


@compiled
def cell_of(row: Floats) -> Cell:
    """Return the first columns of a kernel's row, shape (columns,), as a named tuple `Cell`."""
    return Cell(*to_fixed_tuple(row, GROUPS))  # type: ignore[call-arg] # the compiler gives one
