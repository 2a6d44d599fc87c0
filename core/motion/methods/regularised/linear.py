"""The linear systems of scipy's implicit integrators, without what each call of scipy's checks.

A step solves some ten systems of four or six unknowns; what `lu_solve` looks at before it calls
LAPACK takes ten times as long as LAPACK, and a third of the whole integration. The routines called
are the same, and so is every bit of what they give.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import BDF, LSODA, Radau
from scipy.linalg import lapack, lu_factor, lu_solve

from core.mechanics.arrays import Array

FACTOR = {"f": lapack.dgetrf, "c": lapack.zgetrf}
SOLVE = {"f": lapack.dgetrs, "c": lapack.zgetrs}
Factors = tuple[Array, Array]


def factors_of(matrix: Array) -> Factors:
    """Return the LU factors and pivots; scipy's own function has the word where there are none."""
    if np.isfinite(matrix).all():
        factors, pivots, failed = FACTOR[matrix.dtype.kind](matrix)
        if not failed:
            return factors, pivots
    return lu_factor(matrix)


def solution_of(factors: Factors, right: Array) -> Array:
    """Return the solution of a system whose factors are known."""
    if np.isfinite(right).all() and factors[0].dtype == right.dtype:
        found, _ = SOLVE[right.dtype.kind](*factors, right)
        return found
    return lu_solve(factors, right)


class QuickRadau(Radau):  # type: ignore[misc]
    """Radau's method of scipy."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        _take(self)


class QuickBDF(BDF):  # type: ignore[misc]
    """The backward differentiation formulas of scipy."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        _take(self)


INTEGRATORS = {"Radau": QuickRadau, "BDF": QuickBDF, "LSODA": LSODA}
"""By their names; LSODA is compiled and solves its systems itself."""


def _take(integrator: Any) -> None:
    """Put these functions in the place of the integrator's own two."""

    def lu(matrix: Array) -> Factors:
        integrator.nlu += 1
        return factors_of(matrix)

    integrator.lu, integrator.solve_lu = lu, solution_of
