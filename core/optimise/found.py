"""What a method found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array


@dataclass(frozen=True)
class Found:
    """The answers to every design; all arrays but `x` have the shape (cells,).

    Attributes
    ----------
    x : ndarray, shape (variables, cells)
        The best values, SI units; NaN where there are none.
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    value : ndarray or None
        The objective as the method has it; None: as the scene's outputs have it.
    residual : ndarray or None
        What the first-order conditions leave of the gradient, each variable over its range, in the
        unit of the objective; None: it is left to differences.
    evaluations : ndarray of int64 or int
        Points at which the outputs were computed.
    says : str
        What the method itself says at the end.
    """

    x: Array
    status: NDArray[np.int8]
    value: Array | None = None
    residual: Array | None = None
    evaluations: NDArray[np.int64] | int = 0
    says: str = ""
