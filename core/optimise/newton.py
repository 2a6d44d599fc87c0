"""The best angles of the drive for whole batches of designs and any bounds, compiled (theory 12).

Maximises a_x (on the track K) over alpha and beta subject to |a_y| <= limit, floor and wall forces
that push, and bounds of both angles. `vibrafeed.core.optimise.families` holds closed forms for the
default bounds; both agree to rounding.
"""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.codes import Flags, Statuses
from vibrafeed.core.optimise.families import FAMILIES
from vibrafeed.core.optimise.kernels.columns import COLUMNS
from vibrafeed.core.threads import share_out

PIECE = 1024  # designs of one call of the kernel

BATCHED = tuple(name for name, family in FAMILIES.items() if family.kernel is not None)
"""The families that the batch solver answers."""


class BatchOptimum(NamedTuple):
    """The best angles of every design; all arrays have the broadcast shape, NaN without an answer.

    Attributes
    ----------
    alpha, beta : ndarray
        Azimuth and elevation of the drive [rad].
    objective : ndarray
        a_x on the plane, K on the track [m s-2].
    acceleration_y : ndarray
        a_y there; 0 on the track [m s-2].
    across_margin, floor_margin, wall_margin : ndarray
        limit - |a_y|, n0 and the room at the wall, whether asked for or not [m s-2].
    across_price, floor_price, wall_price : ndarray
        Multipliers: gain of the objective per gain of the limit, of the floor's and of the wall's
        load [1].
    residual : ndarray
        What the first-order conditions of an optimum leave, in units of the drive acceleration per
        radian [1]; rounding at a true optimum.
    active : ndarray of int16
        Sum of the `ACTIVE` bits of the constraints that hold with equality.
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    """

    alpha: Array
    beta: Array
    objective: Array
    acceleration_y: Array
    across_margin: Array
    floor_margin: Array
    wall_margin: Array
    across_price: Array
    floor_price: Array
    wall_price: Array
    residual: Array
    active: Flags
    status: Statuses


def fastest(
    family: str,
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike | None = None,
    gravity_across: ArrayLike = 0.0,
    limit: ArrayLike = np.inf,
    alpha_lower: ArrayLike = 0.0,
    alpha_upper: ArrayLike = np.pi / 2,
    beta_lower: ArrayLike = 0.0,
    beta_upper: ArrayLike = np.pi / 2,
    floor_contact: bool = True,
    wall_contact: bool = True,
    threads: int | None = None,
) -> BatchOptimum:
    """Return the drive angles of the largest a_x or K for every design, by compiled methods.

    The printed formulas and the track are linear in the drive direction, with plane limits and
    bounds: their active set is looked for among closed forms, and the optimum is global. The block
    with the friction disc is maximised by Newton's method in D_x, the driving force per mass along
    the track, at fixed beta, where it is concave, and over beta by the sign of the slope between
    samples. With the default bounds of the angles the samples include every maximum; with others,
    and a limit on a_y, a window of beta narrower than a 64th of its range may be missed: look at
    `residual` (above 1e-7 in one of 20,000 random designs, a drive that friction all but holds).
    a_x is the acceleration along a plane, K that along the track at rest (theory 12).

    Parameters
    ----------
    family : str
        One of `BATCHED`. The physical ones keep floor (and wall) contact.
    vibration_acceleration : array_like
        P, the drive's acceleration amplitude [m s-2].
    gravity_along, gravity_across, gravity_normal : array_like
        Gravity along -x, towards the wall, and onto the floor [m s-2].
    friction_kinetic, friction_static : array_like
        Coefficients; the static one, at least the kinetic one and equal to it by default, matters
        to the physical problems.
    limit : array_like
        Largest |a_y| on the plane; infinite for none. On the track a_y is 0 [m s-2].
    alpha_lower, alpha_upper, beta_lower, beta_upper : array_like
        Bounds of azimuth and elevation of the drive [rad]; alpha's at most 180 deg apart, beta's
        within -90 and 90 deg.
    floor_contact, wall_contact : bool
        True to keep the floor's normal force and, on the track, the wall's force >= 0.
    threads : int, optional
        Largest number of threads; the number of cores by default. Results do not depend on it.

    Returns
    -------
    BatchOptimum
        Angles [rad], a_x and a_y, margins of the limits [m s-2], multipliers, residual of the
        optimality conditions, bits of binding constraints and status, arrays of the broadcast
        shape.
    """
    from vibrafeed.core.optimise.kernels.newton import solve

    parts = np.broadcast_arrays(
        vibration_acceleration,
        gravity_along,
        gravity_across,
        gravity_normal,
        friction_kinetic,
        friction_kinetic if friction_static is None else friction_static,
        limit,
        alpha_lower,
        alpha_upper,
        beta_lower,
        beta_upper,
    )
    shape = parts[0].shape
    groups = np.column_stack([np.ravel(part).astype(np.float64) for part in parts])
    designs = groups.shape[0]
    table = np.empty((designs, COLUMNS))
    active = np.zeros(designs, dtype=np.int16)
    status = np.zeros(designs, dtype=np.int8)
    make, contacts = FAMILIES[family].kernel, FAMILIES[family].contacts
    assert make is not None
    kept = make(
        floor=floor_contact or "floor_contact" in contacts,
        wall=wall_contact or "wall_contact" in contacts,
    )

    def run(start: int) -> None:
        """Solve the designs of one piece; `start` is the number of its first design."""
        piece = slice(start, start + PIECE)
        solve(kept, groups[piece], table[piece], active[piece], status[piece])

    share_out(run, range(0, designs, PIECE), threads or os.cpu_count() or 1)
    fields: dict[str, Any] = {
        name: table[:, number].reshape(shape)
        for number, name in enumerate(BatchOptimum._fields[:COLUMNS])
    }
    return BatchOptimum(**fields, active=active.reshape(shape), status=status.reshape(shape))
