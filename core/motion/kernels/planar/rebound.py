"""The speed of a part after an impact with the floor: one restitution, or one that falls.

Hunt and Crossley's contact F = k x^n (1 + b x') has the restitution e(d) of d = b v, v the speed of
impact, whatever n and k (theory 18.3):

    d - ln(1 + d) = -e d - ln(1 - e d).
"""

from __future__ import annotations

import math
from collections import namedtuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.cells import Cell

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
    """Return exp(x) - 1 - x, without loss of digits near 0, where a series is summed.

    The law of restitution of Hunt and Crossley is solved with it.
    """
    if abs(x) >= SMALL:
        return math.expm1(x) - x
    series = 1.0
    for k in range(TERMS, 2, -1):
        series = 1.0 + x / k * series
    return 0.5 * x * x * series


@compiled
def hunt_crossley(number: float) -> float:
    """Return rebound speed times damping, e d, of an impact on a floor with Hunt-Crossley damping.

    The impact has the number d = b v > 0 (`number`); b is the damping of the contact, v the speed
    of impact, e the restitution: d - ln(1 + d) = -e d - ln(1 - e d). With s = ln(1 + d) and t =
    -ln(1 - e d) this is exp(s) - 1 - s = exp(-t) - 1 + t, solved for t by Newton's method from s
    (theory 18.3).
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

    `speed` v and the result in g/w (w = 2 pi f). With a constant restitution eps: eps v and eps. By
    Hunt-Crossley's law with damping b, `e.damping`: e(d) v and (1 - e d)/((1 + d) e), where d = b v
    and the restitution e(d) falls with d. The derivative lies between 0 and 1: a faster impact
    rebounds faster, so that landings stay in their order (theory 18.3).
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
    """Return the impulse per mass of an impact on the floor: speed before plus speed after.

    `speed` is the speed before, `up` the rebound speed; a constant restitution gives (1 + eps)
    `speed`.
    """
    if e.damping == 0.0:
        return (1.0 + e.constant) * speed
    return speed + up
