"""The growth of rounding errors along a chain of hops."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.planar.drive import Drive, load
from vibrafeed.core.motion.kernels.planar.flow import TURN

ROUNDED = 2.0**-52  # relative rounding of a phase or a speed
MAX_GROWTH = 1e11
"""Of a rounding, up to where a motion repeats: of 16 digits 5 are left then.

Below it a neighbour a few ulp away goes the same way, unless it passes within some 1e-4 of an edge
between two ways, and one cell in a hundred is that near to the bound; beyond it a few hops more
lose the rest, and rounding decides where they lead.
"""

LAST_DIGIT = 1e15
"""Growth of a rounding up to which one digit of a way from rest to rest is left."""

Uncertainty = tuple[float, float, float]
"""Mean square of what roundings did to phase and rebound, and their mean product, in roundings."""

CERTAIN = (0.0, 0.0, 0.0)


@compiled
def grown(
    known: Uncertainty, span: float, speed: float, after: float, drive: Drive, slope: float,
    slopes: tuple[float, float, float, float],
) -> Uncertainty:  # fmt: skip
    """Return the rounding errors after one more hop, E' = M E M^T + j j^T, as mean squares.

    E = `known` holds the mean squares of the errors of phase and rebound and their mean product, in
    roundings; so it is decided if digits determine the motion. M = `slopes`: d(phase)/d(tau),
    d(phase)/d(w), d(rebound)/d(tau), d(rebound)/d(w) of the hop, by phase tau and velocity w at
    take-off. j is what one rounding of the parameters adds: it moves the height at the landing by
    (s + n) D^2, thus the phase by that over the landing speed, at most the flight itself.

    `span` is the flight D in rad, `speed` the landing speed in g/w (w = 2 pi f), `after` the
    landing phase, `slope` the derivative of the rebound by the landing speed (theory 13.7).
    """
    square, product, rebounds = known
    tt, tw, wt, ww = slopes
    s, gn = drive.s, drive.gn
    n1 = load(drive, after)
    late = TURN + min((s + gn) * span * span / max(speed, 1e-300), span / ROUNDED)
    fast = slope * ((s + gn) * (1 + span) + abs(n1) * late)
    return (
        tt * tt * square + 2 * tt * tw * product + tw * tw * rebounds + late * late,
        tt * wt * square + (tt * ww + tw * wt) * product + tw * ww * rebounds,
        wt * wt * square + 2 * wt * ww * product + ww * ww * rebounds + fast * fast,
    )


@compiled
def growth(known: Uncertainty, speed: float, after: float, drive: Drive) -> float:
    """Return the error of the state after a hop, in roundings, weighted by its effect.

    sqrt(E_11) min(1, (|n1| + v)/(s + n)) + sqrt(E_22) with the error matrix E = `known`, landing
    speed v = `speed` and load n1 at the landing phase `after`: a late landing matters by what the
    floor gives there, its force and the impulse, next to nothing if the part has hardly lifted off.
    """
    given = min(1.0, (abs(load(drive, after)) + speed) / (drive.s + drive.gn))
    return math.sqrt(known[0]) * given + math.sqrt(known[2])
