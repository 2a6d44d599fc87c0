"""Stick and slip on the floor under a wave: its part of `drive`."""

from __future__ import annotations

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import (
    MAX_PIECES,
    NORMAL,
    STATIC_BACKWARD,
    STATIC_FORWARD,
    kind_of,
)
from vibrafeed.core.motion.kernels.planar.wave import (
    ROOTS,
    WaveDrive,
    acceleration,
    later_passage,
    next_of_way,
    push_of,
    speed_from,
    speed_start,
    zero_of_velocity,
)
from vibrafeed.core.motion.kernels.waves import value_and_slope

THRESHOLD = 4e-16  # rounding of the push at which friction is overcome, over its size


@borrowing
def always_holds(drive: WaveDrive) -> bool:
    """True if no acceleration changes its sign, the part never lifts off, and friction holds it."""
    table = drive.table
    if table[ROOTS + NORMAL, 0] + table[ROOTS + STATIC_FORWARD, 0] > 0.0:
        return False
    return (
        table[ROOTS + STATIC_BACKWARD, 0] == 0.0
        and acceleration(drive, STATIC_FORWARD, 0.0) <= 0.0
        and acceleration(drive, STATIC_BACKWARD, 0.0) >= 0.0
    )


@borrowing
def stop_after(drive: WaveDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    The slip velocity is `u` in g/(2 pi f) at phase `at` in rad, under a drive that is a wave;
    `sign` is 1 forward, -1 backward. With u = 0 the slip begins where the acceleration has the sign
    of the direction. Between two changes of sign of the acceleration the velocity is monotonic, so
    that one piece after the other is tested by its end (theory 13.14).
    """
    kind, low, first = kind_of(sign), 0.0, u
    start = speed_start(drive, kind, at)
    if u == 0.0:
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        low, first = next_of_way(drive, kind, at, sign < 0.0) - at, sign
    for _ in range(MAX_PIECES):
        if not low < span:
            return -1.0
        high = min(span, later_passage(drive, kind, at + low)[0] - at)
        last = speed_from(drive, kind, u, at, start, high)[0]
        if sign * last <= 0.0:
            return zero_of_velocity(drive, kind, u, at, start, low, high, first, last)
        low, first = high, last
    return -1.0


@borrowing
def slip_uncertainty(drive: WaveDrive) -> float:
    """Return the error of a mean velocity in g/w by rounding of the phases at which slips start.

    Where mu_s > mu_k the part is released with the force (mu_s - mu_k) n(tau), n the load on the
    floor. Its phase is uncertain by the rounding of the push over its slope: the slower a sum of
    sines passes a threshold, the less is the phase known. Steps, which jump over it, have no such
    error. w = 2 pi f; `drive` holds the wave, gravity and friction.
    """
    if drive.steps > 0:
        return 0.0
    size = drive.c + drive.mu_s * (drive.s + drive.gn)
    jump, uncertainty = (drive.mu_s - drive.mu_k) * (drive.s + drive.gn), 0.0
    for kind in (STATIC_FORWARD, STATIC_BACKWARD):
        row = drive.table[ROOTS + kind]
        for number in range(1, int(row[0]) + 1):
            slope = value_and_slope(push_of(drive, kind), row[number])[1]
            uncertainty += jump * THRESHOLD * size / max(abs(slope), 1e-8 * size)
    return uncertainty


@borrowing
def two_sided(drive: WaveDrive) -> tuple[float, float]:
    """Return no closed form of sliding without stick (0, 0): under a wave none is known."""
    return 0.0, 0.0
