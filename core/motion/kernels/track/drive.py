"""The drive: all that exact motion in space knows of what shakes the track.

It gives the series of the push on a part, the velocity of the track, and the phases at which the
floor loses a part that rests on it. Here it is a sine along a straight line.
"""

from __future__ import annotations

import math

from core.compiled import borrowing
from core.motion.kernels.track.tables import INVERSE, ROW, TURN, Cell, Work

LATE = 1e-13
"""Of a phase: a lift-off so little behind a part that is on the floor is due now."""


@borrowing
def fill_push(cell: Cell, tau: float, order: int, work: Work) -> None:
    """Fill the series at tau of the push per mass, and of the velocity of the track along itself.

    The push is minus the acceleration of the track: (p_x, p_y, p_z) sin(tau).
    """
    along, across = cell.drive_number_along, cell.drive_number_across
    normal = cell.drive_number_normal
    value, change = math.sin(tau), math.cos(tau)
    push = ROW.free
    work[ROW.track, 0] = along * change
    for k in range(order + 1):
        work[push, k], work[push + 1, k] = along * value, across * value
        work[push + 2, k] = normal * value
        value, change = value * INVERSE[k + 1], change * INVERSE[k + 1]
        work[ROW.track, k + 1] = -along * value
        value, change = change, -value


@borrowing
def size(cell: Cell) -> float:
    """Return the size of the drive's velocity."""
    return math.sqrt(
        cell.drive_number_along**2 + cell.drive_number_across**2 + cell.drive_number_normal**2
    )


@borrowing
def fill_lift_offs(cell: Cell, work: Work) -> None:
    """Fill the phases in [0, 2 pi) at which the push off the floor rises through the weight.

    Their number comes first.
    """
    weight, push = cell.gravity_number_normal, cell.drive_number_normal
    work[ROW.lifts, 0] = 0.0
    if abs(push) > weight:
        phase = math.asin(weight / abs(push))
        work[ROW.lifts, 0], work[ROW.lifts, 1] = 1.0, phase if push > 0.0 else phase + math.pi


@borrowing
def to_lift_off(work: Work, tau: float) -> float:
    """Return the phase from tau to where a part on the floor lifts off; infinite if nowhere."""
    least = math.inf
    for number in range(int(work[ROW.lifts, 0])):
        ahead = work[ROW.lifts, number + 1] - tau
        if ahead < 0.0:
            ahead = 0.0 if ahead > -LATE else ahead + TURN
        least = min(least, ahead)
    return least
