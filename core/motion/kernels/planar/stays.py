"""The rule by which a landed part stays on the floor: its hops shrink to nothing, or nearly."""

from __future__ import annotations

import math

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.drive import Drive, load, rise, to_lift_off
from core.motion.kernels.planar.rebound import Restitution
from core.motion.kernels.planar.tables import SEGMENT
from core.motion.kernels.rebounds import (
    LEFT_SOFTLY,
    SETTLED_EXACTLY,
    SETTLED_SOFTLY,
    SETTLED_TIME,
)


@compiled
def rests(drive: Drive, tau: float, w: float, e: Restitution, settled: float) -> bool:
    """True if the part stays on the floor after a landing with rebound w (theory 13.5).

    It does where it does not rebound, and where the hops still to come shrink to nothing within the
    time T = 2 w/(n (1 - eps)), with w T < `settled`, and long before lift-off. Their impulses then
    add up to what the floor gives in that time, less w: the last impact is taken as one without
    rebound, and the hops as a stay on the floor. The position is wrong by less than friction times
    `settled`.

    Without rebound it stays too where it lands just as the floor lets go, n(tau) = 0, as at throw
    number sqrt(1 + n^2 pi^2): it rests for no time. A landing up to a hair late counts as one (the
    margin of `to_lift_off`, hundreds of roundings), since from there to fly on or to take off a
    hair earlier is the same motion but for the square of the hair: dD/dtau = n0/w is 0 there.

    Where restitution falls with the speed of impact: `settles_softly`.
    """
    n = load(drive, tau)
    if w == 0:
        return n > 0 or to_lift_off(drive, tau) == 0.0
    if n <= 0:
        return False
    if e.damping > 0:
        return settles_softly(drive, tau, w, e.damping, settled)
    if e.constant >= 1:
        return False
    left = 2 * w / (n * (1 - e.constant))
    return w * left < settled and left < SETTLED_TIME * to_lift_off(drive, tau)


@compiled
def soft_time(drive: Drive, tau: float, damping: float) -> float:
    """Return the phase in which hops lose 1 - 1/e of their speed, T = 3/(b n) (theory 18.3).

    A hop of rebound w lasts 2 w/n, and the next impact leaves w (1 - 2 b w/3), while b w is little.
    """
    return 3 / (damping * load(drive, tau))


@compiled
def left_at_lift_off(drive: Drive, tau: float, w: float, damping: float) -> float:
    """Return an upper bound of the rebound that hops of rebound w still have at the next lift-off.

    w exp(-b J/3), with J the impulse of the floor up to there (theory 18.3).
    """
    pressed = -rise(drive, 0.0, tau, to_lift_off(drive, tau))[0]
    return w * math.exp(-damping * pressed / 3)


@compiled
def settles_softly(drive: Drive, tau: float, w: float, damping: float, settled: float) -> bool:
    """True if hops with speed-dependent restitution are small enough to count as contact.

    They do where w T is below `SETTLED_SOFTLY`, T of `soft_time` (ten times that where little is
    asked), and the rebound of `left_at_lift_off` times the damping below `LEFT_SOFTLY`.
    """
    bound = SETTLED_SOFTLY if settled <= SETTLED_EXACTLY else 10 * SETTLED_SOFTLY
    if not w * soft_time(drive, tau, damping) < bound:
        return False
    return damping * left_at_lift_off(drive, tau, w, damping) < LEFT_SOFTLY


@compiled
def left_out_softly(rows: Floats, count: int, drive: Drive, e: Restitution) -> tuple[float, float]:
    """Return the effect of small hops taken as contact: position over mu_k, and largest rebound.

    The position over mu_k, the sum of w T: in hops of speed w a part that friction would hold goes
    on by less than mu_k w in a unit of phase. And the largest rebound of `left_at_lift_off`. Both
    are 0 for a constant restitution.
    """
    position, speed = 0.0, 0.0
    for row in range(count if e.damping > 0 else 0):
        tau, w = rows[row, SEGMENT.phase], rows[row, SEGMENT.impulse]
        if rows[row, SEGMENT.take_off] < 0 and w > 0:
            position += w * soft_time(drive, tau, e.damping)
            speed = max(speed, left_at_lift_off(drive, tau, w, e.damping))
    return position, speed
