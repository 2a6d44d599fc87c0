"""The seam between planar motion and its drive: what a drive has to tell.

Each function without a body is two, one for a sine and one for any other wave; which one is meant
the compiler sees from the type of `drive`. The others are made of these. All drives have the fields
`c` and `s`, the largest push along and normal to the floor in g, `gs`, `gn`, `mu_s` and `mu_k`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

from vibrafeed.core.compiled import borrowing, by_type, compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.cells import Cell
from vibrafeed.core.motion.kernels.planar import (
    sine_flight,
    sine_slip,
    wave,
    wave_flight,
    wave_slip,
)
from vibrafeed.core.motion.kernels.planar.flow import (
    AIR,
    NORMAL,
    STATIC_BACKWARD,
    STATIC_FORWARD,
    NoWaves,
    SineDrive,
    kind_of,
    phase_to,
    sine_acceleration,
    sine_flow,
    sine_rounded,
    upright,
)
from vibrafeed.core.motion.kernels.planar.wave import WaveDrive

Drive: TypeAlias = SineDrive | WaveDrive
Waves: TypeAlias = NoWaves | wave.WaveTable
"""Room for the wave that stands behind a cell in its row; its type tells whether there is one."""


Function = TypeVar("Function", bound=Callable[..., Any])


def _by_drive(for_sine: Any, for_wave: Any) -> Callable[[Function], Function]:
    """Return a decorator that selects a sine's or a wave's function by the type of `drive`."""
    return by_type("drive", {SineDrive: for_sine, WaveDrive: for_wave})


@by_type("waves", {NoWaves: upright, wave.WaveTable: wave.wave_of})
def drive_of(cell: Cell, row: Floats, waves: Waves) -> tuple[Drive, float, float]:
    """Return the drive of a cell, its phase shift in rad and its direction sign.

    `row` holds the cell's numbers, `waves` the room for the coefficients of a wave. A sine is
    mirrored so that its amplitudes along, c, and normal, s, are positive: the phase shift (0 or pi)
    is where the study's own phase 0 lies, and the sign is -1 if the track's direction is mirrored.
    Waves have 0 and 1.
    """
    raise NotImplementedError


@_by_drive(sine_flight.track_speed, wave_flight.track_speed)
def track_speed(drive: Drive, tau: float) -> float:
    """Return the velocity of the track along itself at the phase `tau`, in g/w.

    Minus the integral of the drive acceleration b_x over the phase, without its mean. Here w = 2 pi
    f.
    """
    raise NotImplementedError


@_by_drive(sine_rounded, wave.rounded)
def rounded(drive: Drive) -> Drive:
    """Return the drive with its numbers rounded to their first 32 bits; a wave is unchanged.

    Neighbouring studies then have the same runs, where rounding decides the motion.
    """
    raise NotImplementedError


@_by_drive(sine_flight.normal_numbers, wave_flight.normal_numbers)
def normal_numbers(drive: Drive) -> tuple[float, float]:
    """Return the numbers that set the motion normal to the floor, drive and gravity in g: (s, n).

    Of waves the first is NaN: two numbers do not tell them.
    """
    raise NotImplementedError


@_by_drive(sine_acceleration, wave.acceleration)
def acceleration(drive: Drive, kind: int, tau: float) -> float:
    """Return the acceleration p(tau) - k of a kind at the phase `tau`, in g.

    p is the push and k the constant pull of the kind: `NORMAL` off the floor, `AIR` along in the
    air, `FORWARD` and `BACKWARD` in slips at the kinetic, `STATIC_FORWARD` and `STATIC_BACKWARD` at
    the static coefficient (theory 13.2, 13.14).
    """
    raise NotImplementedError


@_by_drive(sine_flow, wave.flow)
def flow(drive: Drive, kind: int, v: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance at the phase `d` after velocity `v` at phase `tau`.

    In g/w (w = 2 pi f) and g/w^2, the integrals of the acceleration of a kind.
    """
    raise NotImplementedError


@_by_drive(sine_slip.next_of_way, wave.next_of_way)
def next_of_way(drive: Drive, kind: int, tau: float, rising: bool) -> float:
    """Return the first phase from `tau` on at which an acceleration rises (or falls) through 0.

    It rises if `rising` is True, else falls; infinite if it never does.
    """
    raise NotImplementedError


@borrowing
def push(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the drive acceleration along and normal to the floor at the phase `tau`, in g.

    Minus the acceleration of the track: that of a part in the air, plus gravity along, sin(gamma),
    and onto the floor, n (theory 13.2, 13.14).
    """
    return acceleration(drive, AIR, tau) + drive.gs, acceleration(drive, NORMAL, tau) + drive.gn


@_by_drive(sine_flight.push_slope, wave_flight.push_slope)
def push_slope(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the derivative of the drive acceleration by the phase, along and normal to the floor.

    (c, s) cos(`tau`) for a sine with the amplitudes c and s; NaN for a wave.
    """
    raise NotImplementedError


@_by_drive(sine_flight.smooth_span, wave_flight.smooth_span)
def smooth_span(drive: Drive, tau: float) -> float:
    """Return a phase interval after `tau` in which the drive is a polynomial up to rounding.

    In rad: 1.5 for a sine, whose terms beyond the tenth power are rounding there; 1.5 over the
    highest order for a sum of sines; for a drive in steps the phase to the next step. Integrals are
    taken over such intervals.
    """
    raise NotImplementedError


# --- off the floor


@borrowing
def load(drive: Drive, tau: float) -> float:
    """Return the load on the floor of a part in contact at the phase `tau`, n - b_z(tau), in g.

    n is the gravity onto the floor, b_z the drive acceleration normal to it; below 0 the drive
    lifts the part off (theory 13.2).
    """
    return -acceleration(drive, NORMAL, tau)


@_by_drive(sine_flight.lift_off, wave_flight.lift_off)
def lift_off(drive: Drive, tau: float) -> float:
    """Return the phase in [0, 2 pi) at which a part in contact at the phase `tau` lifts off.

    The next phase at which the load on the floor falls through 0; NaN if it never does (theory
    13.3).
    """
    raise NotImplementedError


@borrowing
def lifts(drive: Drive) -> bool:
    """True if the drive lifts parts off the floor at any phase: n - b_z(tau) < 0.

    n is the gravity onto the floor and b_z the drive acceleration normal to it, in g.
    """
    return not math.isnan(lift_off(drive, 0.0))


@compiled
def to_lift_off(drive: Drive, tau: float) -> float:
    """Return the phase interval in rad from `tau`, where a part is in contact, to its lift-off.

    (tau1 - tau) mod 2 pi, with the phase tau1 of `lift_off`.
    """
    return phase_to(lift_off(drive, tau), tau)


@_by_drive(sine_flight.landing, wave_flight.landing)
def landing(drive: Drive, w: float, tau: float) -> float:
    """Return the flight time in rad of a part that takes off at phase `tau`; -1 if not found.

    `w` >= 0 is the velocity off the floor at take-off in g/(2 pi f). The first phase D > 0 at which
    the height comes down to 0 (theory 13.3). The drive must be one that lifts the part off
    (`lifts`).
    """
    raise NotImplementedError


@borrowing
def rise(drive: Drive, w: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity off the floor and height at the phase `d` after take-off at phase `tau`.

    In g/(2 pi f) and g/(2 pi f)^2, `w` being the velocity at take-off: w1 = w + integral of (b_z -
    n), and the height is the integral of w1, with the drive acceleration b_z normal to the floor
    and gravity n (theory 13.2).
    """
    return flow(drive, NORMAL, w, tau, d)


@_by_drive(sine_flight.hop_height, wave_flight.hop_height)
def hop_height(drive: Drive, w: float, tau: float, span: float, known: float) -> float:
    """Return the largest height of a flight in g/(2 pi f)^2, or `known` if that is larger.

    The part takes off at phase `tau` with velocity `w` in g/(2 pi f) and flies for `span` rad.
    `known` is the largest height of earlier flights; most flights are then recognised as lower
    without a search.
    """
    raise NotImplementedError


@borrowing
def fly(drive: Drive, u: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along the track at the phase `d` of a flight.

    In g/w (w = 2 pi f) and g/w^2; `u` is the velocity along at take-off at phase `tau`: u1 = u +
    integral of (b_x - sin(gamma)), distance = integral of u1, with the drive acceleration b_x
    (theory 13.2).
    """
    return flow(drive, AIR, u, tau, d)


@_by_drive(sine_flight.air_swings, wave_flight.air_swings)
def air_swings(drive: Drive, tau: float, d: float) -> tuple[float, float]:
    """Return two numbers of a flight that cells which land at the same times have in common.

    `swung_along` has velocity and distance along from them, without a sine. The flight begins at
    phase `tau` and lasts for the phase `d`, in rad.
    """
    raise NotImplementedError


@_by_drive(sine_flight.swung_along, wave_flight.swung_along)
def swung_along(drive: Drive, u: float, d: float, swing: float, sway: float) -> tuple[float, float]:
    """Return velocity and distance along the track as `fly` does, from the flight's `air_swings`.

    In g/w (w = 2 pi f) and g/w^2, at the phase `d` in rad after a take-off with the velocity `u`
    along. `swing` and `sway` are the two numbers.
    """
    raise NotImplementedError


# --- on the floor


@borrowing
def holds(drive: Drive, at: float) -> bool:
    """True if static friction holds a part without slip at the phase `at` in rad.

    |b_x - sin(gamma)| <= mu_s n(tau), with the drive acceleration b_x along and the load n on the
    floor (theory 13.3, 13.14).
    """
    return (
        acceleration(drive, STATIC_FORWARD, at) <= 0.0
        and acceleration(drive, STATIC_BACKWARD, at) >= 0.0
    )


@borrowing
def hold(drive: Drive, at: float, end: float) -> tuple[bool, float, bool]:
    """Return True if a part without slip sticks at phase `at`, its last phase, and the slip after.

    It sticks while |b_x - sin(gamma)| <= mu_s n(tau), with the drive acceleration b_x along and the
    load n on the floor (theory 13.3), until the phase `end` at the latest. The third value is True
    if the slip that follows is forward. If it does not stick the phase is `at`.
    """
    if not holds(drive, at):
        return False, at, acceleration(drive, AIR, at) > 0.0
    forward = next_of_way(drive, STATIC_FORWARD, at, True)
    backward = next_of_way(drive, STATIC_BACKWARD, at, False)
    return True, min(forward, backward, end), forward < backward


@borrowing
def first_slip(drive: Drive, tau: float) -> float:
    """Return the phase in rad from `tau` on at which a part that never lifts off starts to slip.

    The first at which |b_x - sin(gamma)| exceeds mu_s n; NaN if static friction always holds it.
    """
    forward = next_of_way(drive, STATIC_FORWARD, tau, True)
    slip = min(forward, next_of_way(drive, STATIC_BACKWARD, tau, False))
    return slip if slip < math.inf else math.nan


@_by_drive(sine_slip.always_holds, wave_slip.always_holds)
def always_holds(drive: Drive) -> bool:
    """True if static friction holds a part at every phase: |b_x - sin(gamma)| <= mu_s n(tau).

    b_x is the drive acceleration along and n the load on the floor.
    """
    raise NotImplementedError


@borrowing
def slide(drive: Drive, sign: float, u: float, at: float, d: float) -> tuple[float, float]:
    """Return slip velocity and distance at the phase `d` after slip velocity `u`, in g/w and g/w^2.

    The part slips in direction `sign` (1 forward, -1 backward) from the phase `at` on: u' = b_x -
    sin(gamma) -+ mu_k n(tau), with the drive acceleration b_x and the load n on the floor (theory
    13.2). Here w = 2 pi f.
    """
    return flow(drive, kind_of(sign), u, at, d)


@borrowing
def slip_acceleration(drive: Drive, sign: float, at: float) -> float:
    """Return the acceleration u' of a slip at the phase `at`, in g; of a flight for `sign` 0.

    u' = b_x - sin(gamma) - sign mu_k n(tau), with the drive acceleration b_x, the load n on the
    floor, and `sign` 1 for a slip forward, -1 backward.
    """
    return acceleration(drive, kind_of(sign), at)


@_by_drive(sine_slip.stop_after, wave_slip.stop_after)
def stop_after(drive: Drive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase in rad until a slip stops; -1 if it does not stop within `span`.

    The part slips in direction `sign` (1 forward, -1 backward) with velocity `u` in g/w (w = 2 pi
    f) at the phase `at`. From u = 0 it starts to slip, and stops later.
    """
    raise NotImplementedError


@_by_drive(sine_slip.two_sided, wave_slip.two_sided)
def two_sided(drive: Drive) -> tuple[float, float]:
    """Return mean velocity in g/w and forward share of a slide to and fro that never sticks.

    A closed form for a sine drive; 0, 0 if it does not hold, and for waves (theory 13.8). Here w =
    2 pi f.
    """
    raise NotImplementedError


@_by_drive(sine_slip.slip_uncertainty, wave_slip.slip_uncertainty)
def slip_uncertainty(drive: Drive) -> float:
    """Return the error of the mean velocity in g/w by rounding of phases at which slips start.

    Friction falls there by (mu_s - mu_k) n, with the load n, so that the velocity changes by that
    times the error of the phase, which is larger the slower the push passes the threshold. Here w =
    2 pi f.
    """
    raise NotImplementedError
