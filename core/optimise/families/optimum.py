"""The record of a closed optimum, and the checks that all closed forms share."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.optimise.codes import ACTIVE, STATUS, TIGHT, Flags, Statuses


class Optimum(NamedTuple):
    """The best angles; all arrays have the broadcast shape.

    Attributes
    ----------
    alpha, beta : ndarray
        Azimuth and elevation of the drive [rad]; NaN where there are none.
    acceleration_x, acceleration_y : ndarray
        The accelerations there; on the track K = a_x at rest, and 0 [m s-2].
    active : ndarray of int16
        Sum of the `ACTIVE` bits of the constraints that hold with equality.
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    """

    alpha: Array
    beta: Array
    acceleration_x: Array
    acceleration_y: Array
    active: Flags
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


def tight(bit: int, margin: Array, scale: Array) -> Flags:
    """Return the bit of a constraint where its margin is 0 up to rounding of `scale`, else 0."""
    return np.where(np.abs(margin) <= TIGHT * scale, bit, 0).astype(np.int16)


def bounds_active(alpha: Array, beta: Array) -> Flags:
    """Return the bounds that the best angles of a drive reach, as a sum of bits of `ACTIVE`.

    `alpha` and `beta` are azimuth and elevation [rad], whose bounds are 0 and 90 degrees. The
    result is an integer array of their shape; a bound counts as reached within rounding.
    """
    unit, right = np.ones_like(alpha), np.pi / 2
    return np.asarray(
        tight(ACTIVE["alpha_lower"], alpha, unit)
        | tight(ACTIVE["alpha_upper"], right - alpha, unit)
        | tight(ACTIVE["beta_lower"], beta, unit)
        | tight(ACTIVE["beta_upper"], right - beta, unit)
    )


def optimum(
    alpha: Array, beta: Array, along: Array, across: Array, active: Flags, status: Statuses
) -> Optimum:
    """Return the record of an optimum; NaN where the status says that there is none.

    `along` and `across` are a_x and a_y there [m s-2]; `active` holds the bits of the constraints
    that bind.
    """
    bad = (status == STATUS["infeasible"]) | (status == STATUS["invalid"])
    alpha, beta, along, across = (np.where(bad, np.nan, p) for p in (alpha, beta, along, across))
    return Optimum(alpha, beta, along, across, np.where(bad, 0, active).astype(np.int16), status)
