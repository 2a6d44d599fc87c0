"""The optima that a method found, one for each design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.problem import OptimisationProblem
from vibrafeed.core.quantities import OPTIMUM_STATUSES
from vibrafeed.core.watch import Watch

STATUS: Mapping[str, int] = {name: flag.value for name, flag in OPTIMUM_STATUSES.items()}
"""The value of each `OPTIMUM_STATUSES` entry."""


@dataclass(frozen=True)
class Optima:
    """The optima of every design; all arrays but `x` have the shape (cells,).

    Attributes
    ----------
    x : ndarray, shape (variables, cells)
        The best values, SI units; NaN where there are none.
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    value : ndarray or None
        The objective as the method computes it; None if it is to be taken from the scene's outputs.
    evaluations : ndarray of int64 or int
        Number of points at which the outputs were computed.
    says : str
        The method's own message at the end.
    """

    x: Array
    status: NDArray[np.int8]
    value: Array | None = None
    evaluations: NDArray[np.int64] | int = 1
    says: str = ""

    def chosen(self, cells: NDArray[np.intp]) -> Optima:
        """Return the optima at some positions."""
        return Optima(
            self.x[:, cells],
            self.status[cells],
            None if self.value is None else self.value[cells],
            np.broadcast_to(self.evaluations, self.status.shape)[cells],
            self.says,
        )

    def made_infeasible(self, cells: NDArray[np.bool_]) -> Optima:
        """Return the optima with some of them, shape (cells,), taken away as infeasible."""
        status = np.where(cells, np.int8(STATUS["infeasible"]), self.status)
        return replace(self, x=np.where(cells, np.nan, self.x), status=status)


Solver = Callable[[OptimisationProblem, Mapping[str, Array], Mapping[str, Array], Watch], Optima]
"""Takes problem, designs (arrays of shape (cells,)), scales of the outputs, and a watch."""


def statuses_of(value: Array, beyond: Array, tolerance: float = 0.0) -> NDArray[np.int8]:
    """Return the status of best points: optimal, infeasible, or without a value, shape (cells,).

    `value` are their objectives; `beyond` their violations of constraints, which `tolerance`
    allows.
    """
    status = np.where(np.isfinite(beyond), STATUS["infeasible"], STATUS["no_value"])
    kept = (beyond <= tolerance) & np.isfinite(value)
    return np.where(kept, STATUS["optimal"], status).astype(np.int8)
