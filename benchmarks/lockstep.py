"""Lockstep Moreau-Jean time stepping of planar cells: the rival of the method of events."""

from __future__ import annotations

import numpy as np
from numba import njit, prange
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

BLOCK = 64  # cells in step: enough for the processor's lanes, few enough for its first cache
AVERAGED = 10  # last periods, over which the mean is taken
UNROLLED = 4  # steps between two visits of memory


@njit(error_model="numpy", fastmath={"contract", "nsz", "nnan"}, inline="always")
def _step(along, normal, height, sine, push, lift, slope, weight, friction, restitution, half):
    """Return the state after a time step (theory 13.9); accelerations are per step."""
    middle = height + half * normal
    falling = min(normal, 0.0)
    along = along + (push * sine - slope)
    free = normal + (lift * sine - weight)
    blow = max(-(free + restitution * falling), 0.0)
    blow = blow if middle <= 0.0 else 0.0
    most = friction * blow
    along = along - min(max(along, -most), most)
    normal = free + blow
    return along, normal, middle + half * normal


@njit(error_model="numpy", fastmath={"contract", "nsz", "nnan", "reassoc"}, parallel=True)
def _run(groups, velocities, sines, periods, averaged):
    """Fill the mean velocities of cells in blocks of shape (blocks, 6, BLOCK)."""
    steps = sines.size
    step = 2 * np.pi / steps
    half = step / 2
    for block in prange(groups.shape[0]):
        push = groups[block, 0] * step
        lift = groups[block, 1] * step
        slope = groups[block, 2] * step
        weight = groups[block, 3] * step
        friction = groups[block, 4].copy()
        restitution = groups[block, 5].copy()
        along = np.zeros(BLOCK)
        normal = np.zeros(BLOCK)
        height = np.zeros(BLOCK)
        total = np.zeros(BLOCK)
        for period in range(periods):
            if period == periods - averaged:
                total[:] = 0.0
            for k in range(0, steps, UNROLLED):
                s0, s1, s2, s3 = sines[k], sines[k + 1], sines[k + 2], sines[k + 3]
                for i in range(BLOCK):
                    a, n, z = along[i], normal[i], height[i]
                    p, q, g, w = push[i], lift[i], slope[i], weight[i]
                    m, e = friction[i], restitution[i]
                    a, n, z = _step(a, n, z, s0, p, q, g, w, m, e, half)
                    sum_ = a
                    a, n, z = _step(a, n, z, s1, p, q, g, w, m, e, half)
                    sum_ += a
                    a, n, z = _step(a, n, z, s2, p, q, g, w, m, e, half)
                    sum_ += a
                    a, n, z = _step(a, n, z, s3, p, q, g, w, m, e, half)
                    sum_ += a
                    along[i], normal[i], height[i] = a, n, z
                    total[i] += sum_
        velocities[block] = total / (averaged * steps)


def lockstep_velocities(
    drive_along: ArrayLike,
    drive_normal: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction: ArrayLike,
    restitution: ArrayLike,
    steps: int = 1600,
    periods: int = 50,
) -> Array:
    """Return the mean velocities of planar cells over their last periods, in g/w.

    All arguments broadcast; `steps` is a multiple of 4. Each cell runs all periods: none is looked
    at until the end, so that blocks of cells stay in step and fill the processor's lanes.
    """
    if steps % UNROLLED:
        raise ValueError(f"steps is {steps}; it must be a multiple of {UNROLLED}")
    given = np.broadcast_arrays(
        *(
            np.asarray(argument, dtype=float)
            for argument in (
                drive_along, drive_normal, gravity_along, gravity_normal, friction, restitution,
            )
        )
    )  # fmt: skip
    shape = given[0].shape
    cells = np.stack([argument.ravel() for argument in given])
    count = cells.shape[1]
    blocks = -(-count // BLOCK)
    groups = np.zeros((6, blocks * BLOCK))
    groups[:, :count] = cells
    groups = np.ascontiguousarray(groups.reshape(6, blocks, BLOCK).transpose(1, 0, 2))
    sines = np.sin(2 * np.pi * (np.arange(steps) + 0.5) / steps)
    velocities = np.empty((blocks, BLOCK))
    _run(groups, velocities, sines, periods, min(AVERAGED, periods))
    return velocities.ravel()[:count].reshape(shape)
