"""The seam between planar motion and its drive: what a drive has to tell.

All drives have the fields `c` and `s`, the largest push along and normal to the floor in g, `gs`,
`gn`, `mu_s` and `mu_k`; the drive acceleration b is minus that of the track.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias

from vibrafeed.core.compiled import borrowing, by_type, compiled
from vibrafeed.core.motion.kernels.given import Cell, Floats
from vibrafeed.core.motion.kernels.planar import sine_motion, wave, wave_motion
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


def _by_drive(for_sine: Any, for_wave: Any) -> Any:
    # compiled code sees by the type of `drive` which one is meant
    return by_type("drive", {SineDrive: for_sine, WaveDrive: for_wave})(for_sine.py_func)


@by_type("waves", {NoWaves: upright, wave.WaveTable: wave.wave_of})
def drive_of(cell: Cell, row: Floats, waves: Waves) -> tuple[Drive, float, float]:
    """Return the drive of a cell, its phase shift in rad and its direction sign."""
    raise NotImplementedError


track_speed: Callable[[Drive, float], float] = _by_drive(
    sine_motion.track_speed, wave_motion.track_speed
)


rounded: Callable[[Drive], Drive] = _by_drive(sine_rounded, wave.rounded)


normal_numbers: Callable[[Drive], tuple[float, float]] = _by_drive(
    sine_motion.normal_numbers, wave_motion.normal_numbers
)


acceleration: Callable[[Drive, int, float], float] = _by_drive(sine_acceleration, wave.acceleration)


flow: Callable[[Drive, int, float, float, float], tuple[float, float]] = _by_drive(
    sine_flow, wave.flow
)


next_of_way: Callable[[Drive, int, float, bool], float] = _by_drive(
    sine_motion.next_of_way, wave.next_of_way
)


@borrowing
def push(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the drive acceleration along and normal to the floor at the phase `tau`, in g.

    Minus the acceleration of the track: that of a part in the air, plus gravity along, sin(gamma),
    and onto the floor, n (theory 13.2, 13.14).
    """
    return acceleration(drive, AIR, tau) + drive.gs, acceleration(drive, NORMAL, tau) + drive.gn


push_slope: Callable[[Drive, float], tuple[float, float]] = _by_drive(
    sine_motion.push_slope, wave_motion.push_slope
)


smooth_span: Callable[[Drive, float], float] = _by_drive(
    sine_motion.smooth_span, wave_motion.smooth_span
)


# --- off the floor


@borrowing
def load(drive: Drive, tau: float) -> float:
    """Return the load on the floor of a part in contact at the phase `tau`, n - b_z(tau), in g."""
    return -acceleration(drive, NORMAL, tau)


lift_off: Callable[[Drive, float], float] = _by_drive(sine_motion.lift_off, wave_motion.lift_off)


@borrowing
def lifts(drive: Drive) -> bool:
    """True if the drive lifts parts off the floor at any phase: n - b_z(tau) < 0."""
    return not math.isnan(lift_off(drive, 0.0))


@compiled
def to_lift_off(drive: Drive, tau: float) -> float:
    """Return the phase interval in rad from `tau`, where a part is in contact, to its lift-off."""
    return phase_to(lift_off(drive, tau), tau)


landing: Callable[[Drive, float, float], float] = _by_drive(
    sine_motion.landing, wave_motion.landing
)


@borrowing
def rise(drive: Drive, w: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity off the floor and height at the phase `d` after take-off at phase `tau`.

    w1 = w + integral of (b_z - n) in g/w, and the integral of w1 in g/w^2 (theory 13.2).
    """
    return flow(drive, NORMAL, w, tau, d)


hop_height: Callable[[Drive, float, float, float, float], float] = _by_drive(
    sine_motion.hop_height, wave_motion.hop_height
)


@borrowing
def fly(drive: Drive, u: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along the track at the phase `d` of a flight.

    u1 = u + integral of (b_x - sin(gamma)) in g/w, and the integral of u1 in g/w^2 (theory 13.2).
    """
    return flow(drive, AIR, u, tau, d)


air_swings: Callable[[Drive, float, float], tuple[float, float]] = _by_drive(
    sine_motion.air_swings, wave_motion.air_swings
)


swung_along: Callable[[Drive, float, float, float, float], tuple[float, float]] = _by_drive(
    sine_motion.swung_along, wave_motion.swung_along
)


# --- on the floor


@borrowing
def holds(drive: Drive, at: float) -> bool:
    """True if static friction holds a part without slip at the phase `at` in rad.

    |b_x - sin(gamma)| <= mu_s n(tau) (theory 13.3, 13.14).
    """
    return (
        acceleration(drive, STATIC_FORWARD, at) <= 0.0
        and acceleration(drive, STATIC_BACKWARD, at) >= 0.0
    )


@borrowing
def hold(drive: Drive, at: float, end: float) -> tuple[bool, float, bool]:
    """Return True if a part without slip sticks at phase `at`, its last phase, and the slip after.

    The last phase is `end` at the latest, `at` if it does not stick; the third value is True for a
    slip forward.
    """
    if not holds(drive, at):
        return False, at, acceleration(drive, AIR, at) > 0.0
    forward = next_of_way(drive, STATIC_FORWARD, at, True)
    backward = next_of_way(drive, STATIC_BACKWARD, at, False)
    return True, min(forward, backward, end), forward < backward


@borrowing
def first_slip(drive: Drive, tau: float) -> float:
    """Return the phase in rad from `tau` on at which a part that never lifts off starts to slip."""
    forward = next_of_way(drive, STATIC_FORWARD, tau, True)
    slip = min(forward, next_of_way(drive, STATIC_BACKWARD, tau, False))
    return slip if slip < math.inf else math.nan


always_holds: Callable[[Drive], bool] = _by_drive(
    sine_motion.always_holds, wave_motion.always_holds
)


@borrowing
def slide(drive: Drive, sign: float, u: float, at: float, d: float) -> tuple[float, float]:
    """Return slip velocity and distance at the phase `d` after slip velocity `u`, in g/w and g/w^2.

    u' = b_x - sin(gamma) - `sign` mu_k n(tau) from phase `at` on (theory 13.2).
    """
    return flow(drive, kind_of(sign), u, at, d)


@borrowing
def slip_acceleration(drive: Drive, sign: float, at: float) -> float:
    """Return the acceleration u' of a slip at the phase `at`, in g; of a flight for `sign` 0."""
    return acceleration(drive, kind_of(sign), at)


stop_after: Callable[[Drive, float, float, float, float], float] = _by_drive(
    sine_motion.stop_after, wave_motion.stop_after
)


two_sided: Callable[[Drive], tuple[float, float]] = _by_drive(
    sine_motion.two_sided, wave_motion.two_sided
)


slip_uncertainty: Callable[[Drive], float] = _by_drive(
    sine_motion.slip_uncertainty, wave_motion.slip_uncertainty
)
