"""The seam between planar motion and its drive: what a drive has to tell.

Each function here is two, one for a sine and one for any other wave; which one is meant the
compiler sees from the type of `drive`. All drives have the fields `gs`, `gn`, `mu_s` and `mu_k`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

from core.compiled import by_type, compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.cells import Cell
from core.motion.kernels.planar import (
    flow,
    sine_flight,
    sine_slip,
    wave,
    wave_flight,
    wave_slip,
)
from core.motion.kernels.planar.flow import NoWaves, SineDrive, phase_to
from core.motion.kernels.planar.wave import WaveDrive

Drive: TypeAlias = SineDrive | WaveDrive
Waves: TypeAlias = NoWaves | wave.WaveTable
"""Room for the wave that stands behind a cell in its row; its type tells whether there is one."""


Function = TypeVar("Function", bound=Callable[..., Any])


def _by_drive(for_sine: Any, for_wave: Any) -> Callable[[Function], Function]:
    """Return a decorator that selects the sine's or the wave's function by the type of `drive`."""
    return by_type("drive", {SineDrive: for_sine, WaveDrive: for_wave})


@by_type("waves", {NoWaves: flow.upright, wave.WaveTable: wave.wave_of})
def drive_of(cell: Cell, row: Floats, waves: Waves) -> tuple[Drive, float, float]:
    """Return the drive of a cell, its phase shift and direction sign (0 and 1 for waves).

    A sine has c and s positive: `flow.upright`. One that points down pushes up half a turn later,
    `phase` is where the study's own phase 0 lies; one that points back is the mirror image, `way`
    is -1 there.
    """
    raise NotImplementedError


@_by_drive(sine_flight.sizes, wave_flight.sizes)
def sizes(drive: Drive) -> tuple[float, float]:
    """Return the largest drive acceleration along and normal to the floor.

    max |b_x| and max |b_z| in units of g, p cb and p sb of a sine, bounds for a wave.
    """
    raise NotImplementedError


@_by_drive(sine_flight.track_speed, wave_flight.track_speed)
def track_speed(drive: Drive, tau: float) -> float:
    """Return the velocity of the track along itself at a phase.

    Minus the integral of the push b_x, without mean.
    """
    raise NotImplementedError


@by_type("drive", {SineDrive: flow.rounded, WaveDrive: wave.rounded})
def rounded(drive: Drive) -> Drive:
    """Return the drive with its numbers rounded to their first bits, by `flow.kept`."""
    raise NotImplementedError


@_by_drive(sine_flight.push, wave_flight.push)
def push(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the drive acceleration along and normal to the floor at a phase.

    Minus the acceleration of the track over g, (c, s) sin(tau) of a sine (theory 13.2), p(tau) of a
    wave (13.14).
    """
    raise NotImplementedError


@_by_drive(sine_flight.push_slope, wave_flight.push_slope)
def push_slope(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the derivative of the drive acceleration by phase, (c, s) cos(tau); NaN for a wave."""
    raise NotImplementedError


@_by_drive(sine_flight.smooth_span, wave_flight.smooth_span)
def smooth_span(drive: Drive, tau: float) -> float:
    """Return a phase interval after tau in which b(tau + D) is a polynomial, up to rounding.

    `SMOOTH` over the highest order, 1.5 of a sine, whose terms beyond D^10 are rounding; of steps
    that to the next one.
    """
    raise NotImplementedError


# --- off the floor


@_by_drive(sine_flight.lifts, wave_flight.lifts)
def lifts(drive: Drive) -> bool:
    """True if the drive lifts parts off the floor at any phase: n(tau) = n - b_z(tau) < 0."""
    raise NotImplementedError


@_by_drive(sine_flight.load, wave_flight.load)
def load(drive: Drive, tau: float) -> float:
    """Return the load on the floor of a part in contact, n(tau) = n - b_z(tau).

    With gravity's n; below 0 the drive lifts it off (theory 13.2).
    """
    raise NotImplementedError


@_by_drive(sine_flight.lift_off, wave_flight.lift_off)
def lift_off(drive: Drive, tau: float) -> float:
    """Return the phase, in [0, 2 pi), at which a part in contact at tau lifts off.

    The next at which n(tau) of `load` falls through 0 (theory 13.3).
    """
    raise NotImplementedError


@compiled
def to_lift_off(drive: Drive, tau: float) -> float:
    """Return the phase interval from tau, where the part is in contact, to its `lift_off`.

    (tau1 - tau) mod 2 pi.
    """
    return phase_to(lift_off(drive, tau), tau)


@_by_drive(sine_flight.landing, wave_flight.landing)
def landing(drive: Drive, w: float, tau: float) -> float:
    """Return the flight time (phase) after take-off at tau with velocity w >= 0; -1 if not found.

    The first D > 0 at which the height of `rise` comes down to z = 0 (theory 13.3). The drive lifts
    the part off at times.
    """
    raise NotImplementedError


@_by_drive(sine_flight.rise, wave_flight.rise)
def rise(drive: Drive, w: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity off the floor and height at phase D after take-off with velocity w.

    w1 = w + integral of (b_z - n), z = integral of w over the phase: C = s, k = n in 13.2.
    """
    raise NotImplementedError


@_by_drive(sine_flight.hop_height, wave_flight.hop_height)
def hop_height(drive: Drive, w: float, tau: float, span: float, known: float) -> float:
    """Return the largest height of a flight, max z over 0 <= D <= span of `rise`.

    `known` if larger.
    """
    raise NotImplementedError


@_by_drive(sine_flight.fly, wave_flight.fly)
def fly(drive: Drive, u: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along the track at phase D of a flight, u at its start.

    u1 = u + integral of (b_x - sin(gamma)), x = integral of u: C = c, k = sin(gamma) in 13.2.
    """
    raise NotImplementedError


# --- on the floor


@_by_drive(sine_slip.holds, wave_slip.holds)
def holds(drive: Drive, at: float) -> bool:
    """True if static friction holds a part without slip at a phase.

    |b_x - sin(gamma)| <= mu_s n(tau), by the bounds of 13.3.
    """
    raise NotImplementedError


@_by_drive(sine_slip.hold, wave_slip.hold)
def hold(drive: Drive, at: float, end: float) -> tuple[bool, float, bool]:
    """Return the stick of a part without slip: if it sticks, its last phase, the slip after it.

    It sticks while |b_x - sin(gamma)| <= mu_s n(tau) (theory 13.3), until `end` at the latest.
    """
    raise NotImplementedError


@_by_drive(sine_slip.always_holds, wave_slip.always_holds)
def always_holds(drive: Drive) -> bool:
    """True if static friction holds a part at every phase: |b_x - sin(gamma)| <= mu_s n(tau)."""
    raise NotImplementedError


@_by_drive(sine_slip.first_slip, wave_slip.first_slip)
def first_slip(drive: Drive, tau: float) -> float:
    """Return a phase at which a part that never lifts off starts to slip, where `hold` ends.

    NaN if there is none.
    """
    raise NotImplementedError


@_by_drive(sine_slip.stop_after, wave_slip.stop_after)
def stop_after(drive: Drive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase until a slip in direction `sign` stops; -1 if it does not within `span`.

    The first D at which the velocity of `slide` is 0. From u = 0 it starts to slip.
    """
    raise NotImplementedError


@_by_drive(sine_slip.slide, wave_slip.slide)
def slide(drive: Drive, sign: float, u: float, at: float, d: float) -> tuple[float, float]:
    """Return slip velocity and distance at phase D after velocity u, in direction `sign`.

    u' = b_x - sin(gamma) -+ mu_k n(tau): C = c +- mu_k s, k = sin(gamma) +- mu_k n in 13.2.
    """
    raise NotImplementedError


@_by_drive(sine_slip.slip_acceleration, wave_slip.slip_acceleration)
def slip_acceleration(drive: Drive, sign: float, at: float) -> float:
    """Return the acceleration of a slip in direction `sign`, u' of `slide`.

    Of a flight for sign 0.
    """
    raise NotImplementedError


@_by_drive(sine_slip.two_sided, wave_slip.two_sided)
def two_sided(drive: Drive) -> tuple[float, float]:
    """Return mean velocity and forward share of sliding that never sticks; 0 where not known.

    The closed form of a sine, `sine_slip.two_sided`.
    """
    raise NotImplementedError


@_by_drive(sine_slip.slip_uncertainty, wave_slip.slip_uncertainty)
def slip_uncertainty(drive: Drive) -> float:
    """Return the uncertainty of the mean velocity by rounding of the phases at which slips start.

    Friction falls there by (mu_s - mu_k) n, so that a slip starts with a jerk, and velocity changes
    by that times the error of the phase, which is known the less, the slower the push passes the
    threshold.
    """
    raise NotImplementedError
