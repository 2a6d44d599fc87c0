"""Drive and floor of a part in the plane: the seam to sines and waves, rebounds, rests.

All drives have the largest push and gravity, along and normal to the floor in g, and `mu_s` and
`mu_k`; the drive acceleration b is minus that of the track. Hunt and Crossley's
contact F = k x^n (1 + b x') has the restitution e(d) of d = b v, v the speed of impact, whatever n
and k (theory 18.3): d - ln(1 + d) = -e d - ln(1 - e d).
"""

import math
from collections import namedtuple
from collections.abc import Callable
from typing import Any, TypeAlias

from vibrafeed.core.compiled import borrowing, by_type, compiled
from vibrafeed.core.motion.kernels.constants import (
    LEFT_SOFTLY,
    SEGMENT,
    SETTLED_EXACTLY,
    SETTLED_SOFTLY,
    SETTLED_TIME,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats
from vibrafeed.core.motion.kernels.planar import sine_motion, wave, wave_motion
from vibrafeed.core.motion.kernels.planar.flow import (
    AIR,
    NORMAL,
    STATIC_BACKWARD,
    STATIC_FORWARD,
    NoWaves,
    SineDrive,
    kind_of,
    mirrored_sine,
    phase_to,
    sine_acceleration,
    sine_flow,
    sine_rounded,
)
from vibrafeed.core.motion.kernels.planar.wave import WaveDrive

Drive: TypeAlias = SineDrive | WaveDrive
Waves: TypeAlias = NoWaves | wave.WaveTable
"""Room for the wave that stands behind a cell in its row; its type tells whether there is one."""


def _by_drive(for_sine: Any, for_wave: Any) -> Any:
    # compiled code sees by the type of `drive` which one is meant
    return by_type("drive", {SineDrive: for_sine, WaveDrive: for_wave})(for_sine.py_func)


@by_type("waves", {NoWaves: mirrored_sine, wave.WaveTable: wave.wave_of})
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

next_crossing: Callable[[Drive, int, float, bool], float] = _by_drive(
    sine_motion.next_crossing, wave.next_crossing
)


@borrowing
def push(drive: Drive, tau: float) -> tuple[float, float]:
    """Return the drive acceleration along and normal to the floor at the phase `tau`, in g.

    Minus the acceleration of the track: that of a part in the air, plus gravity along, sin(gamma),
    and onto the floor, n (theory 13.2, 13.14).
    """
    return acceleration(drive, AIR, tau) + drive.gravity_along, acceleration(
        drive, NORMAL, tau
    ) + drive.gravity_normal


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
def rise(drive: Drive, take_off: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity off the floor and height at the phase `d` after take-off at phase `tau`.

    w1 = `take_off` + integral of (b_z - n) in g/w, and the integral of w1 in g/w^2 (theory 13.2).
    """
    return flow(drive, NORMAL, take_off, tau, d)


hop_height: Callable[[Drive, float, float, float, float], float] = _by_drive(
    sine_motion.hop_height, wave_motion.hop_height
)


@borrowing
def fly(drive: Drive, slip: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along the track at the phase `d` of a flight.

    u1 = `slip` + integral of (b_x - sin(gamma)) in g/w, and the integral of u1 in g/w^2 (theory
    13.2).
    """
    return flow(drive, AIR, slip, tau, d)


air_integrals: Callable[[Drive, float, float], tuple[float, float]] = _by_drive(
    sine_motion.air_integrals, wave_motion.air_integrals
)

along_from_integrals: Callable[[Drive, float, float, float, float], tuple[float, float]] = (
    _by_drive(sine_motion.along_from_integrals, wave_motion.along_from_integrals)
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
def hold(drive: Drive, phase: float, end: float) -> tuple[bool, float, bool]:
    """Return True if a part without slip sticks at a phase, its last phase, and the slip after.

    The last phase is `end` at the latest, `phase` if it does not stick; the third value is True for
    a slip forward.
    """
    if not holds(drive, phase):
        return False, phase, acceleration(drive, AIR, phase) > 0.0
    forward_slip = next_crossing(drive, STATIC_FORWARD, phase, True)
    backward_slip = next_crossing(drive, STATIC_BACKWARD, phase, False)
    return True, min(forward_slip, backward_slip, end), forward_slip < backward_slip


@borrowing
def first_slip(drive: Drive, tau: float) -> float:
    """Return the phase in rad from `tau` on at which a part that never lifts off starts to slip."""
    forward = next_crossing(drive, STATIC_FORWARD, tau, True)
    slip = min(forward, next_crossing(drive, STATIC_BACKWARD, tau, False))
    return slip if slip < math.inf else math.nan


always_holds: Callable[[Drive], bool] = _by_drive(
    sine_motion.always_holds, wave_motion.always_holds
)


@borrowing
def slide(drive: Drive, sign: float, slip: float, phase: float, d: float) -> tuple[float, float]:
    """Return slip velocity and distance a phase `d` after `slip`, in g/w and g/w^2.

    u' = b_x - sin(gamma) - `sign` mu_k n(tau) from phase `phase` on (theory 13.2).
    """
    return flow(drive, kind_of(sign), slip, phase, d)


@borrowing
def slip_acceleration(drive: Drive, sign: float, at: float) -> float:
    """Return the acceleration u' of a slip at the phase `at`, in g; of a flight for `sign` 0."""
    return acceleration(drive, kind_of(sign), at)


stop_after: Callable[[Drive, float, float, float, float], float] = _by_drive(
    sine_motion.stop_after, wave_motion.stop_after
)

sliding_without_stick: Callable[[Drive], tuple[float, float]] = _by_drive(
    sine_motion.sliding_without_stick, wave_motion.sliding_without_stick
)

slip_uncertainty: Callable[[Drive], float] = _by_drive(
    sine_motion.slip_uncertainty, wave_motion.slip_uncertainty
)


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
    excess_before = excess(t)
    for _ in range(STEPS):
        step = (excess(-t) - excess_before) / math.expm1(-t)
        t += step
        if abs(step) <= CONVERGED * t:
            break
    return -math.expm1(-t)


@compiled
def rebound(restitution: Restitution, speed: float) -> tuple[float, float]:
    """Return the rebound speed after an impact on the floor, and its derivative by impact speed.

    In g/w; eps v and eps, or by Hunt and Crossley's law with damping b: e(d) v and (1 - e d)/((1 +
    d) e), d = b v. The derivative lies between 0 and 1, so that landings stay in their order
    (theory 18.3).
    """
    if restitution.damping == 0.0:
        return restitution.constant * speed, restitution.constant
    number = restitution.damping * speed
    if number <= 0.0:
        return speed, 1.0
    rebound_number = hunt_crossley(number)
    return rebound_number / restitution.damping, (1.0 - rebound_number) * number / (
        (1.0 + number) * rebound_number
    )


@compiled
def impulse(restitution: Restitution, speed: float, rebound_speed: float) -> float:
    """Return the impulse per mass of an impact on the floor: speed before plus speed after."""
    if restitution.damping == 0.0:
        return (1.0 + restitution.constant) * speed
    return speed + rebound_speed


@compiled
def rests(
    drive: Drive, tau: float, rebound_speed: float, restitution: Restitution, bound: float
) -> bool:
    """True if a part that has just landed stays on the floor, its hops shrinking to nothing.

    Without rebound if the floor presses it or it lands at a lift-off. With a rebound w if the
    hops end within T = 2 w/(n (1 - eps)), w T < `bound` and T below a thousandth of the time to
    lift-off (theory 13.5).
    """
    load_at_landing = load(drive, tau)
    if rebound_speed == 0:
        return load_at_landing > 0 or to_lift_off(drive, tau) == 0.0
    if load_at_landing <= 0:
        return False
    if restitution.damping > 0:
        return settles_softly(drive, tau, rebound_speed, restitution.damping, bound)
    if restitution.constant >= 1:
        return False
    time_left = 2 * rebound_speed / (load_at_landing * (1 - restitution.constant))
    return rebound_speed * time_left < bound and time_left < SETTLED_TIME * to_lift_off(drive, tau)


@compiled
def soft_time(drive: Drive, tau: float, damping: float) -> float:
    """Return the phase in rad in which hops lose 1 - 1/e of their speed, T = 3/(b n)."""
    return 3 / (damping * load(drive, tau))


@compiled
def rebound_at_lift_off(drive: Drive, tau: float, rebound_speed: float, damping: float) -> float:
    """Return an upper bound of the rebound speed that small hops still have at the next lift-off.

    w exp(-b J/3), w = `rebound_speed`, with the impulse J of the floor from phase `tau` to lift-off
    (theory 18.3).
    """
    floor_impulse = -rise(drive, 0.0, tau, to_lift_off(drive, tau))[0]
    return rebound_speed * math.exp(-damping * floor_impulse / 3)


@compiled
def settles_softly(
    drive: Drive, tau: float, rebound_speed: float, damping: float, settled: float
) -> bool:
    """True if hops whose restitution falls with speed are small enough to count as contact.

    w T below 3e-4 with T of `soft_time`, or below ten times that for a rough bound `settled`, and
    the rebound left at lift-off times `damping` below 2e-3 (theory 13.5).
    """
    bound = SETTLED_SOFTLY if settled <= SETTLED_EXACTLY else 10 * SETTLED_SOFTLY
    if not rebound_speed * soft_time(drive, tau, damping) < bound:
        return False
    return damping * rebound_at_lift_off(drive, tau, rebound_speed, damping) < LEFT_SOFTLY


@compiled
def soft_hop_errors(
    segments: Floats, count: int, drive: Drive, restitution: Restitution
) -> tuple[float, float]:
    """Return the effect of small hops taken as contact: position over mu_k, and speed left.

    Bounds of the error where hops never end: the sum of w T in g/w^2, with T of `soft_time`, and
    the largest rebound speed left at the next lift-off in g/w; 0 for a constant restitution (theory
    13.5).
    """
    position, speed = 0.0, 0.0
    for segment in range(count if restitution.damping > 0 else 0):
        tau, rebound_speed = segments[segment, SEGMENT.phase], segments[segment, SEGMENT.impulse]
        if segments[segment, SEGMENT.take_off] < 0 and rebound_speed > 0:
            position += rebound_speed * soft_time(drive, tau, restitution.damping)
            speed = max(speed, rebound_at_lift_off(drive, tau, rebound_speed, restitution.damping))
    return position, speed
