"""The rule by which a landed part stays on the floor: its hops shrink to nothing, or nearly."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.planar.drive import Drive, load, rise, to_lift_off
from vibrafeed.core.motion.kernels.planar.rebound import Restitution
from vibrafeed.core.motion.kernels.planar.tables import SEGMENT
from vibrafeed.core.motion.kernels.rebounds import (
    LEFT_SOFTLY,
    SETTLED_EXACTLY,
    SETTLED_SOFTLY,
    SETTLED_TIME,
)


@compiled
def rests(drive: Drive, tau: float, w: float, e: Restitution, settled: float) -> bool:
    """True if a part that has just landed stays on the floor, its hops shrinking to nothing.

    It landed at phase `tau` in rad, with rebound speed `w` in g/w (w = 2 pi f). It stays if w = 0
    and the floor presses it, load n > 0, or if it lands within 1e-12 of a lift-off, where n = 0: it
    then lifts off again after no time. With a rebound it stays if the shrinking hops end within T =
    2 w/(n (1 - eps)), with w T < `settled` and T below a thousandth of the time to lift-off; the
    position is then wrong by less than mu_k `settled`. `e` is the law of restitution; if it depends
    on the speed, `settles_softly` decides (theory 13.5).
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
    """Return the phase in rad in which hops lose 1 - 1/e of their speed, T = 3/(b n).

    For an impact that leaves w (1 - 2 b w/3) of a small speed w, with `damping` b, and hops that
    last 2 w/n each, n the load on the floor at phase `tau` (theory 18.3).
    """
    return 3 / (damping * load(drive, tau))


@compiled
def left_at_lift_off(drive: Drive, tau: float, w: float, damping: float) -> float:
    """Return an upper bound of the rebound speed that small hops still have at the next lift-off.

    w exp(-b J/3), with their rebound speed w at phase `tau`, `damping` b of the speed-dependent
    restitution, and the impulse J of the floor from there to lift-off (theory 18.3).
    """
    pressed = -rise(drive, 0.0, tau, to_lift_off(drive, tau))[0]
    return w * math.exp(-damping * pressed / 3)


@compiled
def settles_softly(drive: Drive, tau: float, w: float, damping: float, settled: float) -> bool:
    """True if hops whose restitution falls with speed are small enough to count as contact.

    Such hops never end by themselves. `w` is the rebound speed in g/w (w = 2 pi f) at phase `tau`
    in rad. w T must be below 3e-4 (`SETTLED_SOFTLY`), with the phase T in which hops lose 1 - 1/e
    of their speed, or below ten times that if `settled`, the bound for a constant restitution, is a
    rough one; and the rebound left at lift-off times `damping` below 2e-3 (`LEFT_SOFTLY`) (theory
    13.5).
    """
    bound = SETTLED_SOFTLY if settled <= SETTLED_EXACTLY else 10 * SETTLED_SOFTLY
    if not w * soft_time(drive, tau, damping) < bound:
        return False
    return damping * left_at_lift_off(drive, tau, w, damping) < LEFT_SOFTLY


@compiled
def left_out_softly(rows: Floats, count: int, drive: Drive, e: Restitution) -> tuple[float, float]:
    """Return the effect of small hops taken as contact: position over mu_k, and speed left.

    It bounds the error of a mean velocity where restitution depends on speed, since such hops never
    end (theory 13.5). The cycle is in the first `count` of `rows` (columns of `SEGMENT`; contacts
    have a take-off below 0). The first, in g/(2 pi f)^2, is the sum of w T: hops of rebound speed w
    carry a part that friction would hold on by less than mu_k w per unit of phase, during the phase
    T in which they lose 1 - 1/e of their speed. The second, in g/(2 pi f), is the largest rebound
    speed left at the next lift-off. Both are 0 for a constant restitution.
    """
    position, speed = 0.0, 0.0
    for row in range(count if e.damping > 0 else 0):
        tau, w = rows[row, SEGMENT.phase], rows[row, SEGMENT.impulse]
        if rows[row, SEGMENT.take_off] < 0 and w > 0:
            position += w * soft_time(drive, tau, e.damping)
            speed = max(speed, left_at_lift_off(drive, tau, w, e.damping))
    return position, speed
