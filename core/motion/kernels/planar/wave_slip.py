"""Stick and slip on the floor under a wave: its part of `drive`."""

from __future__ import annotations

import math

from core.compiled import borrowing
from core.motion.kernels.planar.flow import MAX_PIECES
from core.motion.kernels.planar.wave import (
    AIR,
    BACKWARD,
    FORWARD,
    ROOTS,
    WaveDrive,
    acceleration,
    flow,
    later_passage,
    next_of_way,
    push_of,
    speed_from,
    speed_start,
    zero_of_velocity,
)
from core.motion.kernels.planar.wave_flight import lifts
from core.motion.kernels.waves import value_and_slope

THRESHOLD = 4e-16  # rounding of the push at which friction is overcome, over its size


@borrowing
def holds(drive: WaveDrive, at: float) -> bool:
    """True if static friction holds a part without slip at the phase `at`.

    p_x - sin(gamma) - mu_s n(tau) <= 0 <= p_x - sin(gamma) + mu_s n(tau), with the load on the
    floor n(tau) = n - p_z (theory 13.14).
    """
    return (
        acceleration(drive, drive.forward, at) <= 0.0
        and acceleration(drive, drive.backward, at) >= 0.0
    )


@borrowing
def hold(drive: WaveDrive, at: float, end: float) -> tuple[bool, float, bool]:
    """Return True if a part without slip sticks at phase `at`, its last phase, and the slip after.

    It sticks until the first phase at which |p_x - sin(gamma)| exceeds mu_s n(tau), at the latest
    until `end`. The third value is True if the slip that follows is forward.
    """
    if not holds(drive, at):
        return False, at, acceleration(drive, AIR, at) > 0.0
    forward = next_of_way(drive, drive.forward, at, True)
    backward = next_of_way(drive, drive.backward, at, False)
    return True, min(forward, backward, end), forward < backward


@borrowing
def always_holds(drive: WaveDrive) -> bool:
    """True if static friction holds the part at every phase, and it never lifts off."""
    never = drive.table[ROOTS + drive.forward, 0] + drive.table[ROOTS + drive.backward, 0] == 0.0
    return never and not lifts(drive) and holds(drive, 0.0)


@borrowing
def first_slip(drive: WaveDrive, tau: float) -> float:
    """Return a phase in rad at which a part that never lifts off starts to slip; NaN if none.

    The first from `tau` on at which |p_x - sin(gamma)| exceeds mu_s n(tau).
    """
    forward = next_of_way(drive, drive.forward, tau, True)
    slip = min(forward, next_of_way(drive, drive.backward, tau, False))
    return slip if slip < math.inf else math.nan


@borrowing
def kind_of(sign: float) -> int:
    """Return the kind of acceleration of a slip in direction `sign`: `FORWARD` or `BACKWARD`."""
    return FORWARD if sign > 0.0 else BACKWARD


@borrowing
def stop_after(drive: WaveDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    The slip velocity is `u` at phase `at`; `sign` is 1 forward, -1 backward. Between two changes of
    sign of the acceleration the velocity is monotonic (theory 13.14).
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
def slide(drive: WaveDrive, sign: float, u: float, at: float, d: float) -> tuple[float, float]:
    """Return slip velocity and distance at the phase `d` after slip velocity `u` at phase `at`.

    In g/w (w = 2 pi f) and g/w^2; `sign` is 1 forward, -1 backward. Under the acceleration p_x +
    sign mu_k p_z - (sin(gamma) + sign mu_k n), with the push p and gravity n onto the floor.
    """
    return flow(drive, kind_of(sign), u, at, d)


@borrowing
def slip_acceleration(drive: WaveDrive, sign: float, at: float) -> float:
    """Return the acceleration of a slip in direction `sign` at phase `at`, in g.

    p_x + sign mu_k p_z - (sin(gamma) + sign mu_k n); 1 is forward, -1 backward.
    """
    return acceleration(drive, kind_of(sign), at)


@borrowing
def slip_uncertainty(drive: WaveDrive) -> float:
    """Return the error of the mean velocity in g/w by rounding of phases at which slips start.

    (mu_s - mu_k) max |n(tau)| times the rounding of the push over its slope: the slower a sum of
    sines passes a threshold, the less is the phase known; one at which the push jumps is exact.
    Here w = 2 pi f.
    """
    if drive.steps > 0:
        return 0.0
    size = drive.along + drive.mu_s * (drive.normal + drive.gn)
    jump, uncertainty = (drive.mu_s - drive.mu_k) * (drive.normal + drive.gn), 0.0
    for kind in (drive.forward, drive.backward):
        row = drive.table[ROOTS + kind]
        for number in range(1, int(row[0]) + 1):
            slope = value_and_slope(push_of(drive, kind), row[number])[1]
            uncertainty += jump * THRESHOLD * size / max(abs(slope), 1e-8 * size)
    return uncertainty


@borrowing
def two_sided(drive: WaveDrive) -> tuple[float, float]:
    """Return no closed form of sliding without stick (0, 0): under a wave none is known."""
    return 0.0, 0.0
