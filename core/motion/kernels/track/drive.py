"""The drive: all that exact motion in space knows of what shakes the track.

It gives the series of the push on a part, the velocity of the track, and the phases at which the
floor loses a part that rests on it. Here it is a sine along a straight line.
"""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.track.tables import TURN, Cell

LATE = 1e-13
"""Of a phase: a lift-off so little behind a part that is on the floor is due now."""


@compiled
def fill_push(cell: Cell, tau: float, order: int, push: Floats, track: Floats) -> None:
    """Fill the series at tau of the push per mass, and of the velocity of the track along itself.

    The push is minus the acceleration of the track: (p_x, p_y, p_z) sin(tau).
    """
    along, across = cell.drive_number_along, cell.drive_number_across
    normal = cell.drive_number_normal
    value, change = math.sin(tau), math.cos(tau)
    track[0] = along * change
    for k in range(order + 1):
        push[0, k], push[1, k], push[2, k] = along * value, across * value, normal * value
        track[k + 1] = -along * value / (k + 1)
        value, change = change / (k + 1), -value / (k + 1)


@compiled
def size(cell: Cell) -> float:
    """Return the size of the drive's velocity."""
    return math.sqrt(
        cell.drive_number_along**2 + cell.drive_number_across**2 + cell.drive_number_normal**2
    )


@compiled
def lift_offs(cell: Cell) -> Floats:
    """Return the phases in [0, 2 pi) at which the push off the floor rises through the weight."""
    weight, push = cell.gravity_number_normal, cell.drive_number_normal
    if abs(push) <= weight:
        return np.zeros(0)
    phase = math.asin(weight / abs(push))
    return np.full(1, phase if push > 0.0 else phase + math.pi)


@compiled
def to_lift_off(lifts: Floats, tau: float) -> float:
    """Return the phase from tau to where a part on the floor lifts off; infinite if nowhere."""
    least = math.inf
    for lift in lifts:
        ahead = (lift - tau) % TURN
        least = min(least, 0.0 if TURN - ahead < LATE else ahead)
    return least
