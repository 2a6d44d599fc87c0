"""Stick and slip on the floor under a wave: its part of `drive`."""

from __future__ import annotations

import math

from core.compiled import compiled
from core.motion.kernels.planar.flow import LAST_STEP, MOST_ITERATIONS, MOST_PIECES
from core.motion.kernels.planar.wave import (
    AIR,
    BACKWARD,
    FORWARD,
    ROOTS,
    Wave,
    acceleration,
    flow,
    later_passage,
    next_of_way,
)
from core.motion.kernels.planar.wave_flight import lifts
from core.motion.kernels.waves import value_and_slope

THRESHOLD = 4e-16  # rounding of the push at which friction is overcome, over its size


@compiled
def holding(drive: Wave) -> tuple[float, float, float]:
    """Return nothing of use: all that is asked stands in the table."""
    return 0.0, 0.0, 0.0


@compiled
def holds(drive: Wave, held: tuple[float, float, float], at: float) -> bool:
    """Return whether static friction holds a part that does not slip."""
    return (
        acceleration(drive, drive.forward, at) <= 0.0
        and acceleration(drive, drive.backward, at) >= 0.0
    )


@compiled
def hold(
    drive: Wave, held: tuple[float, float, float], at: float, end: float
) -> tuple[bool, float, bool]:
    """Return whether a part without slip sticks, until when, and whether it then slips forward."""
    if not holds(drive, held, at):
        return False, at, acceleration(drive, AIR, at) > 0.0
    forward = next_of_way(drive, drive.forward, at, True)
    backward = next_of_way(drive, drive.backward, at, False)
    return True, min(forward, backward, end), forward < backward


@compiled
def always_holds(drive: Wave) -> bool:
    """Return whether friction holds a part all the time."""
    never = drive.table[ROOTS + drive.forward, 0] + drive.table[ROOTS + drive.backward, 0] == 0.0
    return never and not lifts(drive) and holds(drive, (0.0, 0.0, 0.0), 0.0)


@compiled
def first_slip(drive: Wave, tau: float) -> float:
    """Return a phase at which a part that never lifts off starts to slip; NaN if there is none."""
    forward = next_of_way(drive, drive.forward, tau, True)
    slip = min(forward, next_of_way(drive, drive.backward, tau, False))
    return slip if slip < math.inf else math.nan


@compiled
def kind_of(sign: float) -> int:
    """Return the kind of a slip in the way of `sign`."""
    return FORWARD if sign > 0.0 else BACKWARD


@compiled
def stop_after(drive: Wave, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase until a slip in the way of `sign` stops; -1 if it does not.

    Between two changes of sign of its acceleration the velocity runs one way.
    """
    kind, low = kind_of(sign), 0.0
    if u == 0.0:
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        low = next_of_way(drive, kind, at, sign < 0.0) - at
    for _ in range(MOST_PIECES):
        if not low < span:
            return -1.0
        high = min(span, later_passage(drive, kind, at + low)[0] - at)
        if sign * flow(drive, kind, u, at, high)[0] <= 0.0:
            return stop_root(drive, sign, u, at, low, high)
        low = high
    return -1.0


@compiled
def stop_root(drive: Wave, sign: float, u: float, at: float, low: float, high: float) -> float:
    """Return where a slip that loses speed from `low` to `high` stops."""
    kind = kind_of(sign)
    first = sign * flow(drive, kind, u, at, low)[0]
    last = sign * flow(drive, kind, u, at, high)[0]
    d = low + (high - low) * first / (first - last) if first > last else low
    for _ in range(MOST_ITERATIONS):
        value = sign * flow(drive, kind, u, at, d)[0]
        if value > 0.0:
            low = d
        else:
            high = d
        slope = sign * acceleration(drive, kind, at + d)
        new = d - value / slope if slope < 0.0 else low - 1.0
        if low <= new <= high and abs(new - d) <= LAST_STEP * d:
            return new
        if not low < new < high:
            new = 0.5 * (low + high)
            if new in (low, high):
                return new
        d = new
    return d


@compiled
def slide(drive: Wave, sign: float, u: float, at: float, d: float) -> tuple[float, float]:
    """Return velocity and distance a phase d after velocity u, in a slip in the way of `sign`."""
    return flow(drive, kind_of(sign), u, at, d)


@compiled
def slip_acceleration(drive: Wave, sign: float, at: float) -> float:
    """Return the acceleration of a slip in the way of `sign`."""
    return acceleration(drive, kind_of(sign), at)


@compiled
def slip_doubt(drive: Wave) -> float:
    """Return how much velocity hangs on the rounding of the phases where a slip starts.

    A phase at which a sum of sines passes a threshold is known the less, the slower it passes it;
    one at which the push jumps is given.
    """
    if drive.steps > 0:
        return 0.0
    size = drive.along + drive.mu_s * (drive.normal + drive.gn)
    jump, doubt = (drive.mu_s - drive.mu_k) * (drive.normal + drive.gn), 0.0
    for kind in (drive.forward, drive.backward):
        row = drive.table[ROOTS + kind]
        for number in range(1, int(row[0]) + 1):
            slope = value_and_slope(drive.table, 2 * kind, 2 * kind + 1, drive.orders, row[number])[
                1
            ]
            doubt += jump * THRESHOLD * size / max(abs(slope), 1e-8 * size)
    return doubt
