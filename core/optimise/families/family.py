"""The record of a family, the closed optimum, and the checks of inputs (theory 12)."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.optimise.optima import STATUS
from vibrafeed.core.study.optimise_study import Criterion

Statuses = NDArray[np.int8]
"""Values of `STATUS`."""


class Optimum(NamedTuple):
    """The best angles; all arrays have the broadcast shape.

    Attributes
    ----------
    alpha, beta : ndarray
        Azimuth and elevation of the drive [rad]; NaN where there are none.
    acceleration_x, acceleration_y : ndarray
        The accelerations there; on the track K = a_x at rest, and 0 [m s-2].
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    """

    alpha: Array
    beta: Array
    acceleration_x: Array
    acceleration_y: Array
    status: Statuses


class ParetoSet(NamedTuple):
    """Points that no other angles beat in a_x and in |a_y|; a last axis counts the points.

    `status` has the broadcast shape without that axis.
    """

    alpha: Array
    beta: Array
    acceleration_x: Array
    acceleration_y: Array
    status: Statuses


def broadcast(*parts: ArrayLike) -> tuple[Array, ...]:
    """Return the arguments as float64 arrays broadcast to one shape."""
    return tuple(np.broadcast_arrays(*(np.asarray(part, dtype=np.float64) for part in parts)))


def valid_inputs(within: Mask, drive: Array, *parts: Array) -> tuple[Mask, Mask, tuple[Array, ...]]:
    """Return the valid cells, the driven cells, and the arguments with 0 in invalid cells.

    Valid is what is finite, and `within` its range; driven where the drive is above 0 there, too.
    The zeros spare warnings from NaN.
    """
    valid = np.asarray(within & np.all([np.isfinite(part) for part in (drive, *parts)], axis=0))
    return valid, valid & (drive > 0), tuple(np.where(valid, p, 0.0) for p in (drive, *parts))


def statuses(valid: Mask, infeasible: Mask, driven: Mask, gain: Array) -> Statuses:
    """Return the status of each optimum of the drive's angles, int8, from masks of the designs.

    All arrays have one shape: `valid` is True for inputs in range, `infeasible` where no angles
    keep the limits, `driven` where there is a drive; without one all angles are equal (flat).
    `gain` is positive where the part moves forwards.
    """
    status = np.where(gain > 0, STATUS["optimal"], STATUS["no_motion"])
    status = np.where(driven, status, STATUS["flat"])
    status = np.where(infeasible, STATUS["infeasible"], status)
    return np.asarray(np.where(valid, status, STATUS["invalid"]), dtype=np.int8)


def optimum(alpha: Array, beta: Array, along: Array, across: Array, status: Statuses) -> Optimum:
    """Return the record of an optimum; NaN where the status says that there is none.

    `along` and `across` are a_x and a_y there [m s-2].
    """
    bad = (status == STATUS["infeasible"]) | (status == STATUS["invalid"])
    alpha, beta, along, across = (np.where(bad, np.nan, p) for p in (alpha, beta, along, across))
    return Optimum(alpha, beta, along, across, status)


Closed = Callable[..., Optimum | ParetoSet]
"""A closed form; its arguments are what it needs of a design."""


@dataclass(frozen=True)
class Family:
    """Problems of one kind whose best angles are known.

    Attributes
    ----------
    systems : tuple
        Scene, variant and the output that is to be largest, of each problem.
    closed : mapping
        Closed forms by the criterion that they solve: both angles from 0 to 90 degrees.
    against : str or None
        The output whose absolute value can be kept low.
    contacts : frozenset of str
        Contacts that a study has to keep.
    """

    systems: tuple[tuple[str, str, str], ...]
    closed: Mapping[type[Criterion], Closed] = field(hash=False)
    against: str | None = "acceleration_y"
    contacts: frozenset[str] = frozenset()

    def closed_optimum(
        self, criterion: Criterion, values: Mapping[str, Any]
    ) -> Optimum | ParetoSet:
        """Return the closed-form optimum of drive angles, or trade-off front, for a criterion.

        `values` has all inputs of the designs by name, arrays (cells,) in SI units; the formula
        takes those it needs.
        """
        form = self.closed[type(criterion)]
        parameters = inspect.signature(form).parameters.values()
        needed = [p.name for p in parameters if p.default is inspect.Parameter.empty]
        return form(**{name: values[name] for name in needed})
