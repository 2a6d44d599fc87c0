"""The flow in one mode: a sine and a constant, integrated in closed form."""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.inputs import Cell, Floats

TURN = 2 * math.pi

NORMAL, AIR, FORWARD, BACKWARD, STATIC_FORWARD, STATIC_BACKWARD = range(6)
"""Kinds of acceleration: off the floor, along in the air, and of slips forward and backward at the
kinetic and at the static coefficient."""

MAX_ITERATIONS = 200
"""Most steps of a search in a bracket: halving alone ends after 53, and may come between Newton's
steps."""
MAX_PIECES = 20_000
"""Most stretches of a flight on which its height bends one way: two a turn of a sine, so that a hop
may last 10,000 periods, at a throw number of some 30,000."""
LAST_STEP = 1e-10
"""Relative step that ends Newton's iteration: the next is of the order of its square."""
SMOOTH = 1.5
"""Phase in rad over which a sine is a polynomial of order ten up to rounding."""
EPSILON = 2e-15  # rounding of the change of velocity over a cycle, over the drive
KEPT_BITS = 2.0**32
"""Cells whose numbers agree in 32 bits have the same runs: a result that depends on the last bit of
a parameter is of no use."""


class NoWaves(NamedTuple):
    """The stand-in for the buffer of waves where the drive is a sine."""


NO_WAVES = NoWaves()


SineDrive = namedtuple(
    "SineDrive",
    "push_along push_normal gravity_along gravity_normal mu_s mu_k lift_off_phase "
    "stick_low stick_high slip_above",
)
"""A sine drive: accelerations along and normal to the floor in g, gravity, and friction.

Pushes are amplitudes; gravity along is downhill, normal onto the floor. The phase of lift-off is
NaN without; the last three fields are those of `stick_range`.
"""


@compiled
def stick_range(
    push_along: float, push_normal: float, gravity_along: float, gravity_normal: float, mu_s: float
) -> tuple[float, float, float]:
    """Return the range of sin(tau) within which friction holds, and the slip direction above it.

    (gs + mu_s gn)/(c + mu_s s) is one bound, (gs - mu_s gn)/(c - mu_s s) the other. Below the least
    the part slips backward, beyond the largest forward (1), or backward (-1) where the drive lifts
    it off more than it pushes it on (theory 13.3).
    """
    low, high, slip_above = -math.inf, math.inf, 1.0
    if push_along + mu_s * push_normal > 0:
        high = (gravity_along + mu_s * gravity_normal) / (push_along + mu_s * push_normal)
    elif gravity_along + mu_s * gravity_normal < 0:
        high = -math.inf
    lifting = push_along - mu_s * push_normal
    holding = mu_s * gravity_normal - gravity_along
    if lifting > 0:
        low = -holding / lifting
    elif lifting < 0:
        if holding / -lifting < high:
            high, slip_above = holding / -lifting, -1.0
    elif holding < 0:
        low = math.inf
    return low, high, slip_above


@compiled
def sine_of(
    push_along: float,
    push_normal: float,
    gravity_along: float,
    gravity_normal: float,
    mu_s: float,
    mu_k: float,
) -> SineDrive:
    """Return the sine drive with amplitudes c, s along and normal, gravity gs, gn, and friction."""
    stick_low, stick_high, slip_above = stick_range(
        push_along, push_normal, gravity_along, gravity_normal, mu_s
    )
    lift_off_phase = (
        math.asin(gravity_normal / push_normal) if push_normal > gravity_normal else math.nan
    )
    return SineDrive(
        push_along,
        push_normal,
        gravity_along,
        gravity_normal,
        mu_s,
        mu_k,
        lift_off_phase,
        stick_low,
        stick_high,
        slip_above,
    )


@compiled
def mirrored_sine(cell: Cell, row: Floats, waves: NoWaves) -> tuple[SineDrive, float, float]:
    """Return the sine drive of a cell, mirrored to positive amplitudes, a phase shift and a sign.

    (c, s) sin(tau) = (-c, -s) sin(tau - pi): the phase shift in rad (0 or pi) is where the study's
    own phase 0 lies. A drive that then points back is mirrored, (c, sin(gamma)) -> (-c,
    -sin(gamma)), and the sign is -1.
    """
    push_along, push_normal, gravity_along = (
        cell.drive_number_along,
        cell.drive_number_normal,
        cell.gravity_number_along,
    )
    phase, direction = 0.0, 1.0
    if push_normal < 0:
        push_along, push_normal, phase = -push_along, -push_normal, math.pi
    if push_along < 0:
        push_along, gravity_along, direction = -push_along, -gravity_along, -1.0
    gravity_normal, mu_s, mu_k = (
        cell.gravity_number_normal,
        cell.friction_static,
        cell.friction_kinetic,
    )
    return (
        sine_of(push_along, push_normal, gravity_along, gravity_normal, mu_s, mu_k),
        phase,
        direction,
    )


@compiled
def rounded_to_32_bits(value: float) -> float:
    """Return a number rounded to 32 bits, so that neighbouring studies have equal runs."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(np.rint(mantissa * KEPT_BITS) / KEPT_BITS, exponent)


@compiled
def sine_rounded(drive: SineDrive) -> SineDrive:
    """Return a drive with all numbers rounded to 32 bits, if the part then still lifts off."""
    rounded = sine_of(
        rounded_to_32_bits(drive.push_along), rounded_to_32_bits(drive.push_normal),
        rounded_to_32_bits(drive.gravity_along), rounded_to_32_bits(drive.gravity_normal),
        rounded_to_32_bits(drive.mu_s), rounded_to_32_bits(drive.mu_k),
    )  # fmt: skip
    return rounded if rounded.push_normal > rounded.gravity_normal else drive


@compiled
def arc_terms(d: float) -> tuple[float, float]:
    """Return D - sin D and 1 - cos D = 2 sin^2(D/2) of a phase D in rad, without loss of digits.

    Below 0.7 from their series, D^3/6 (1 - D^2/20 (1 - D^2/42 ...)) and D^2/2 (1 - D^2/12 (1 -
    D^2/30 ...)), since differences lose digits (theory 13.2).
    """
    if abs(d) > 0.7:
        sine_of_half = math.sin(d / 2)
        return d - math.sin(d), 2 * sine_of_half * sine_of_half
    d_squared = d * d
    cubic_tail = 1 - d_squared / 110 * (
        1 - d_squared / 156 * (1 - d_squared / 210 * (1 - d_squared / 272))
    )
    square_tail = 1 - d_squared / 90 * (
        1 - d_squared / 132 * (1 - d_squared / 182 * (1 - d_squared / 240))
    )
    return (
        d
        * d_squared
        / 6
        * (1 - d_squared / 20 * (1 - d_squared / 42 * (1 - d_squared / 72 * cubic_tail))),
        d_squared
        / 2
        * (1 - d_squared / 12 * (1 - d_squared / 30 * (1 - d_squared / 56 * square_tail))),
    )


@compiled
def sine_integrals(sine: float, cosine: float, d: float) -> tuple[float, float]:
    """Return the velocity and distance that an acceleration sin(tau) adds over a phase D from tau0.

    cos(tau0) (1 - cos D) + sin(tau0) sin D and cos(tau0) (D - sin D) + sin(tau0) (1 - cos D).
    """
    d_minus_sine, one_minus_cosine = arc_terms(d)
    return cosine * one_minus_cosine + sine * (
        d - d_minus_sine
    ), cosine * d_minus_sine + sine * one_minus_cosine


@compiled
def flow(v: float, C: float, k: float, sine: float, cosine: float, d: float) -> tuple[float, float]:
    """Return velocity and distance at phase `d` after velocity `v`, under u' = C sin(tau) - k."""
    first_integral, second_integral = sine_integrals(sine, cosine, d)
    return flow_from_integrals(v, C, k, d, first_integral, second_integral)


@compiled
def flow_from_integrals(
    v: float, C: float, k: float, d: float, first_integral: float, second_integral: float
) -> tuple[float, float]:
    """Return velocity and distance as `flow` does, from the `sine_integrals` of its phases.

    u = v + C swing - k D and x = v D + C sway - k D^2/2, D = `d` (theory 13.2).
    """
    return v + C * first_integral - k * d, v * d + C * second_integral - k * d * d / 2


@compiled
def kind_of(sign: float) -> int:
    """Return the kind of acceleration along: `FORWARD` for 1, `BACKWARD` for -1, `AIR` for 0."""
    return FORWARD if sign > 0.0 else BACKWARD if sign < 0.0 else AIR


@compiled
def sine_terms(drive: SineDrive, kind: int) -> tuple[float, float]:
    """Return C and k of an acceleration C sin(tau) - k of a kind, in g (theory 13.2).

    s and n off the floor, c and sin(gamma) in the air, and c +- mu s and sin(gamma) +- mu n of
    slips forward and backward, at mu_k and at mu_s.
    """
    if kind == NORMAL:
        return drive.push_normal, drive.gravity_normal
    if kind == AIR:
        return drive.push_along, drive.gravity_along
    friction = drive.mu_k if kind < STATIC_FORWARD else drive.mu_s
    if kind % 2 == BACKWARD % 2:
        friction = -friction
    return (
        drive.push_along + friction * drive.push_normal,
        drive.gravity_along + friction * drive.gravity_normal,
    )


@compiled
def sine_acceleration(drive: SineDrive, kind: int, tau: float) -> float:
    """Return the acceleration C sin(tau) - k of a kind, in g, with C and k of `sine_terms`."""
    C, k = sine_terms(drive, kind)
    return C * math.sin(tau) - k


@compiled
def sine_flow(drive: SineDrive, kind: int, v: float, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance at the phase `d` after velocity `v` at phase `tau`."""
    C, k = sine_terms(drive, kind)
    return flow(v, C, k, math.sin(tau), math.cos(tau), d)


@compiled
def velocity_after(v: float, C: float, k: float, tau: float, d: float) -> float:
    """Return the velocity at phase `d` after velocity `v` at phase `tau`, u' = C sin(tau) - k."""
    return flow(v, C, k, math.sin(tau), math.cos(tau), d)[0]


@compiled
def distance_after(v: float, C: float, k: float, tau: float, d: float) -> float:
    """Return the distance at phase `d` after velocity `v` at phase `tau`, u' = C sin(tau) - k."""
    return flow(v, C, k, math.sin(tau), math.cos(tau), d)[1]


@compiled
def phase_to(target: float, tau: float) -> float:
    """Return the phase interval from tau to the next `target`, (target - tau) mod 2 pi, in rad.

    In [0, 2 pi); a target up to 1e-12 before tau counts as reached, 0.
    """
    d = (target - tau) % TURN
    # What rounding put a hair before tau is at tau.
    return 0.0 if d > TURN - 1e-12 else d
