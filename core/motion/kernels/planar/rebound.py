"""Rebounds: the speed after an impact, and the rule by which shrinking hops become a stay.

Hunt and Crossley's contact F = k x^n (1 + b x') has the restitution e(d) of d = b v, v the speed of
impact, whatever n and k (theory 18.3): d - ln(1 + d) = -e d - ln(1 - e d).
"""

from __future__ import annotations

import math
from collections import namedtuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.constants import (
    LEFT_SOFTLY,
    SEGMENT,
    SETTLED_EXACTLY,
    SETTLED_SOFTLY,
    SETTLED_TIME,
)
from vibrafeed.core.motion.kernels.given import Cell, Floats
from vibrafeed.core.motion.kernels.planar.plane_drive import Drive, load, rise, to_lift_off

STEPS = 8  # most steps of Newton's method: two more than twelve orders of magnitude need
SMALL, TERMS = 0.5, 16  # below this |x| exp(x) - 1 - x is summed as a series of so many terms
CONVERGED = 1e-15  # relative step that ends Newton's method

Restitution = namedtuple("Restitution", "constant damping")
"""The share of the speed that an impact leaves; with a damping b, by the law above instead."""


@compiled
def restitution_of(cell: Cell) -> Restitution:
    """Return the rebound law of a cell: restitution, and damping where it depends on speed."""
    return Restitution(cell.restitution, cell.impact_damping)


@compiled
def excess(x: float) -> float:
    """Return exp(x) - 1 - x, without loss of digits near 0, where a series is summed."""
    if abs(x) >= SMALL:
        return math.expm1(x) - x
    series = 1.0
    for k in range(TERMS, 2, -1):
        series = 1.0 + x / k * series
    return 0.5 * x * x * series


@compiled
def hunt_crossley(number: float) -> float:
    """Return rebound speed times damping, e d, of an impact on a floor with Hunt-Crossley damping.

    Of the number d = b v > 0 (`number`): d - ln(1 + d) = -e d - ln(1 - e d). With s = ln(1 + d) and
    t = -ln(1 - e d) this is exp(s) - 1 - s = exp(-t) - 1 + t, solved for t by Newton's method from
    s (theory 18.3).
    """
    t = math.log1p(number)
    known = excess(t)
    for _ in range(STEPS):
        step = (excess(-t) - known) / math.expm1(-t)
        t += step
        if abs(step) <= CONVERGED * t:
            break
    return -math.expm1(-t)


@compiled
def rebound(e: Restitution, speed: float) -> tuple[float, float]:
    """Return the rebound speed after an impact on the floor, and its derivative by impact speed.

    In g/w; eps v and eps, or by Hunt and Crossley's law with damping b: e(d) v and (1 - e d)/((1 +
    d) e), d = b v. The derivative lies between 0 and 1, so that landings stay in their order
    (theory 18.3).
    """
    if e.damping == 0.0:
        return e.constant * speed, e.constant
    number = e.damping * speed
    if number <= 0.0:
        return speed, 1.0
    left = hunt_crossley(number)
    return left / e.damping, (1.0 - left) * number / ((1.0 + number) * left)


@compiled
def impulse(e: Restitution, speed: float, up: float) -> float:
    """Return the impulse per mass of an impact on the floor: speed before plus speed after."""
    if e.damping == 0.0:
        return (1.0 + e.constant) * speed
    return speed + up


@compiled
def rests(drive: Drive, tau: float, w: float, e: Restitution, settled: float) -> bool:
    """True if a part that has just landed stays on the floor, its hops shrinking to nothing.

    Without rebound if the floor presses it or it lands at a lift-off. With a rebound `w` if the
    hops end within T = 2 w/(n (1 - eps)), w T < `settled` and T below a thousandth of the time to
    lift-off (theory 13.5).
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
    """Return the phase in rad in which hops lose 1 - 1/e of their speed, T = 3/(b n)."""
    return 3 / (damping * load(drive, tau))


@compiled
def left_at_lift_off(drive: Drive, tau: float, w: float, damping: float) -> float:
    """Return an upper bound of the rebound speed that small hops still have at the next lift-off.

    w exp(-b J/3), with the impulse J of the floor from phase `tau` to lift-off (theory 18.3).
    """
    pressed = -rise(drive, 0.0, tau, to_lift_off(drive, tau))[0]
    return w * math.exp(-damping * pressed / 3)


@compiled
def settles_softly(drive: Drive, tau: float, w: float, damping: float, settled: float) -> bool:
    """True if hops whose restitution falls with speed are small enough to count as contact.

    w T below 3e-4 with T of `soft_time`, or below ten times that for a rough bound `settled`, and
    the rebound left at lift-off times `damping` below 2e-3 (theory 13.5).
    """
    bound = SETTLED_SOFTLY if settled <= SETTLED_EXACTLY else 10 * SETTLED_SOFTLY
    if not w * soft_time(drive, tau, damping) < bound:
        return False
    return damping * left_at_lift_off(drive, tau, w, damping) < LEFT_SOFTLY


@compiled
def left_out_softly(rows: Floats, count: int, drive: Drive, e: Restitution) -> tuple[float, float]:
    """Return the effect of small hops taken as contact: position over mu_k, and speed left.

    Bounds of the error where hops never end: the sum of w T in g/w^2, with T of `soft_time`, and
    the largest rebound speed left at the next lift-off in g/w; 0 for a constant restitution (theory
    13.5).
    """
    position, speed = 0.0, 0.0
    for row in range(count if e.damping > 0 else 0):
        tau, w = rows[row, SEGMENT.phase], rows[row, SEGMENT.impulse]
        if rows[row, SEGMENT.take_off] < 0 and w > 0:
            position += w * soft_time(drive, tau, e.damping)
            speed = max(speed, left_at_lift_off(drive, tau, w, e.damping))
    return position, speed
