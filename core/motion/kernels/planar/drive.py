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
    return by_type("drive", {SineDrive: for_sine, WaveDrive: for_wave})


@by_type("waves", {NoWaves: flow.upright, wave.WaveTable: wave.wave_of})
def drive_of(cell: Cell, row: Floats, waves: Waves) -> tuple[Drive, float, float]:
    """Return the drive of a cell, phase and way; those of a wave are 0 and 1.

    A sine has c and s positive: one that points down pushes up half a turn later, `phase` is where
    the study's own phase 0 lies; one that points back is the mirror image, `way` is -1 there.
    """
    raise NotImplementedError


@_by_drive(sine_flight.sizes, wave_flight.sizes)
def sizes(drive: Drive) -> tuple[float, float]:
    """Return how much the drive pushes along and normal to the floor."""
    raise NotImplementedError


@_by_drive(sine_flight.track_speed, wave_flight.track_speed)
def track_speed(drive: Drive, tau: float) -> float:
    """Return the velocity of the track along itself."""
    raise NotImplementedError


@by_type("drive", {SineDrive: flow.rounded, WaveDrive: wave.rounded})
def rounded(drive: Drive) -> Drive:
    """Return a drive with the first bits of its numbers only."""
    raise NotImplementedError


@_by_drive(sine_flight.push, wave_flight.push)
def push(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the push of the drive on a part, along and normal to the floor."""
    raise NotImplementedError


@_by_drive(sine_flight.push_slope, wave_flight.push_slope)
def push_slope(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the derivative of a sine's push by the phase, along and normal; NaN of a wave."""
    raise NotImplementedError


@_by_drive(sine_flight.smooth_span, wave_flight.smooth_span)
def smooth_span(drive: Drive, tau: float) -> float:
    """Return a phase from tau on over which the push is a polynomial, but for rounding."""
    raise NotImplementedError


# --- off the floor


@_by_drive(sine_flight.lifts, wave_flight.lifts)
def lifts(drive: Drive) -> bool:
    """Return whether the drive ever lifts a part off the floor."""
    raise NotImplementedError


@_by_drive(sine_flight.load, wave_flight.load)
def load(drive: Drive, tau: float) -> float:
    """Return the load on the floor of a part that rests on it; below 0 the drive lifts it off."""
    raise NotImplementedError


@_by_drive(sine_flight.lift_off, wave_flight.lift_off)
def lift_off(drive: Drive, tau: float) -> float:
    """Return the phase, modulo a turn, at which a part on the floor at tau lifts off."""
    raise NotImplementedError


@compiled
def to_lift_off(drive: Drive, tau: float) -> float:
    """Return the phase from tau, at which the floor carries the part, to where it lifts off."""
    return phase_to(lift_off(drive, tau), tau)


@_by_drive(sine_flight.landing, wave_flight.landing)
def landing(drive: Drive, w: float, tau: float) -> float:
    """Return the phase from take-off at tau with velocity w >= 0 to landing; -1 if none is found.

    The drive lifts the part off at times.
    """
    raise NotImplementedError


@_by_drive(sine_flight.rise, wave_flight.rise)
def rise(drive: Drive, w: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity off the floor and height a phase d after take-off with velocity w."""
    raise NotImplementedError


@_by_drive(sine_flight.hop_height, wave_flight.hop_height)
def hop_height(drive: Drive, w: float, tau: float, span: float, known: float) -> float:
    """Return the largest height of a flight, or `known` if that is larger."""
    raise NotImplementedError


@_by_drive(sine_flight.fly, wave_flight.fly)
def fly(drive: Drive, u: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along the track a phase d after velocity u, in the air."""
    raise NotImplementedError


# --- on the floor


@_by_drive(sine_slip.holds, wave_slip.holds)
def holds(drive: Drive, at: float) -> bool:
    """Return whether static friction holds a part that does not slip."""
    raise NotImplementedError


@_by_drive(sine_slip.hold, wave_slip.hold)
def hold(drive: Drive, at: float, end: float) -> tuple[bool, float, bool]:
    """Return whether a part without slip sticks, until when, and whether it then slips forward.

    Until `end` at the latest.
    """
    raise NotImplementedError


@_by_drive(sine_slip.always_holds, wave_slip.always_holds)
def always_holds(drive: Drive) -> bool:
    """Return whether friction holds a part all the time."""
    raise NotImplementedError


@_by_drive(sine_slip.first_slip, wave_slip.first_slip)
def first_slip(drive: Drive, tau: float) -> float:
    """Return a phase at which a part that never lifts off starts to slip; NaN if there is none."""
    raise NotImplementedError


@_by_drive(sine_slip.stop_after, wave_slip.stop_after)
def stop_after(drive: Drive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase until a slip of velocity u in the way of `sign` stops; -1 if it does not.

    From u = 0 it starts to slip.
    """
    raise NotImplementedError


@_by_drive(sine_slip.slide, wave_slip.slide)
def slide(drive: Drive, sign: float, u: float, at: float, d: float) -> tuple[float, float]:
    """Return velocity and distance a phase d after velocity u, in a slip in the way of `sign`."""
    raise NotImplementedError


@_by_drive(sine_slip.slip_acceleration, wave_slip.slip_acceleration)
def slip_acceleration(drive: Drive, sign: float, at: float) -> float:
    """Return the acceleration of a slip in the way of `sign`."""
    raise NotImplementedError


@_by_drive(sine_slip.two_sided, wave_slip.two_sided)
def two_sided(drive: Drive) -> tuple[float, float]:
    """Return mean velocity and forward share of sliding without stick, 0 where none is known."""
    raise NotImplementedError


@_by_drive(sine_slip.slip_doubt, wave_slip.slip_doubt)
def slip_doubt(drive: Drive) -> float:
    """Return how much velocity hangs on the rounding of the phases where a slip starts.

    Friction falls there from the static to the kinetic one, so that a slip starts with a jerk. Its
    phase is known the less, the slower the push passes the threshold.
    """
    raise NotImplementedError
