"""Stick and slip on the floor under a sine: its part of `drive`."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.planar.flow import (
    LAST_STEP,
    MAX_ITERATIONS,
    MAX_PIECES,
    TURN,
    SineDrive,
    flow,
    kind_of,
    phase_to,
    sine_terms,
)

THRESHOLD = 4e-16  # rounding of the sine at which friction is overcome


@compiled
def next_of_way(drive: SineDrive, kind: int, tau: float, rising: bool) -> float:
    """Return the first phase from tau on at which C sin - k rises (or falls) through 0; or inf.

    asin(k/C) or pi - asin(k/C), with C and k of `sine_terms`, and whole turns more. It is the same
    number whatever `tau` was, so that a motion which sticks repeats to the last bit.
    """
    C, k = sine_terms(drive, kind)
    if not abs(k) < abs(C):
        return math.inf
    target = math.asin(k / C)
    if (C > 0) != rising:
        target = math.pi - target
    return max(tau, target + TURN * math.ceil((tau - target) / TURN - 1e-13))


@compiled
def phase_to_stop(v: float, C: float, k: float, at: float, span: float) -> float:
    """Return the phase in rad until a velocity v >= 0 is 0 under u' = C sin(tau) - k; or -1.

    So the end of a slip is found. Counted from the phase `at` in rad, where the velocity is `v` in
    g/(2 pi f); -1 if it does not stop within `span` rad. The velocity rises from asin(k/C) to pi -
    asin(k/C) in each turn and falls elsewhere: the first fall at whose end it is not positive holds
    the root, which Newton's iteration finds in that bracket (theory 13.3).
    """
    if C < 0:
        C, at = -C, at + math.pi
    if k <= -C:
        return -1.0
    sine, cosine = math.sin(at), math.cos(at)
    if k >= C:
        low, high = 0.0, span
        if v == 0 or flow(v, C, k, sine, cosine, high)[0] > 0:
            return -1.0
    else:
        rise_at = math.asin(k / C)
        fall_at = math.pi - rise_at
        low = 0.0
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        if v == 0 or rise_at <= at % TURN < fall_at:
            low = phase_to(fall_at, at)
        high = span
        for _ in range(MAX_PIECES):
            if low >= span:
                return -1.0
            ahead = phase_to(rise_at, at + low)
            high = min(span, low + (ahead if ahead > 0 else TURN))
            if flow(v, C, k, sine, cosine, high)[0] <= 0:
                break
            low = high + fall_at - rise_at
    return stop_between(v, C, k, at, sine, cosine, low, high)


@compiled
def stop_between(
    v: float, C: float, k: float, at: float, sine: float, cosine: float, low: float, high: float
) -> float:
    """Return the phase D after `at`, between `low` and `high`, at which a falling velocity is 0.

    All phases in rad. The velocity follows u' = C sin(at + D) - k in g, from `v` in g/(2 pi f) at
    `at`, whose `sine` and `cosine` are passed to save time; it is above 0 at `low` and not above 0
    at `high`. Newton's iteration in this bracket, D -> D - u/u', halved where it leaves it. So the
    end of a slip is found.
    """
    first, last = flow(v, C, k, sine, cosine, low)[0], flow(v, C, k, sine, cosine, high)[0]
    d = low + (high - low) * first / (first - last) if first > last else low
    for _ in range(MAX_ITERATIONS):
        value = flow(v, C, k, sine, cosine, d)[0]
        if value > 0:
            low = d
        else:
            high = d
        slope = C * math.sin(at + d) - k
        new = d - value / slope if slope < 0 else low - 1
        if low <= new <= high and abs(new - d) <= LAST_STEP * d:
            return new
        if not low < new < high:
            new = (low + high) / 2
            if new in (low, high):
                return new
        d = new
    return d


@compiled
def always_holds(drive: SineDrive) -> bool:
    """True if static friction holds the part at every phase.

    s <= n, and -1 and 1 within the bounds of `stick_range`.
    """
    return drive.s <= drive.gn and drive.least <= -1 and drive.largest >= 1


@compiled
def stop_after(drive: SineDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    The slip velocity is `u` at phase `at`; `sign` is 1 forward, -1 backward. By `phase_to_stop` of
    |u|, with sign times C = c + sign mu_k s and k = sin(gamma) + sign mu_k n (theory 13.2).
    """
    C, k = sine_terms(drive, kind_of(sign))
    return phase_to_stop(abs(u), sign * C, sign * k, at, span)


@compiled
def slip_uncertainty(drive: SineDrive) -> float:
    """Return the error of the mean velocity in g/w by rounding of phases at which slips start.

    (mu_s - mu_k)(s + n) d(asin S), where a rounding dS of the threshold S of sin(tau) moves the
    phase asin(S) by dS/sqrt(1 - S^2): the phase is known the less, the nearer |S| is to 1. s and n
    are vibration off the floor and gravity of `drive` in g; here w = 2 pi f.
    """
    jump = (drive.mu_s - drive.mu_k) * (drive.s + drive.gn)
    uncertainty = 0.0
    for threshold in (drive.least, drive.largest):
        if abs(threshold) < 1.0:
            uncertainty += jump * THRESHOLD / math.sqrt((1.0 - threshold) * (1.0 + threshold))
    return uncertainty


@compiled
def two_sided(drive: SineDrive) -> tuple[float, float]:
    """Return mean velocity and forward share of a part that slides to and fro and never sticks.

    In closed form; the velocity is in g/(2 pi f). Both are 0 if there is no such motion: the part
    lifts off, or sticks. With amplitudes c, s of the drive along and normal, gravity n onto the
    floor, c1 = mu s, k1 = mu n, H = c k1 - c1 sin(gamma) and E = pi (c1 k1 - c sin(gamma))/H, the
    forward slip lasts the phase pi + E about the phase pi - asin(S), where

        S = pi (k1^2 - sin(gamma)^2)/(2 H cos(E/2))
        v = sqrt(1 - S^2) (2 c1 cos(E/2) + (pi c + c1 E) sin(E/2))/pi
    """
    c, s, gs, gn, mu_s, mu = drive.c, drive.s, drive.gs, drive.gn, drive.mu_s, drive.mu_k
    c1, k1 = mu * s, mu * gn
    H = c * k1 - c1 * gs
    if s > gn or mu_s != mu or H <= 0 or c <= c1:
        return 0.0, 0.0
    E = math.pi * (c1 * k1 - c * gs) / H
    if abs(E) >= math.pi:
        return 0.0, 0.0
    sine = math.pi * (k1 - gs) * (k1 + gs) / (2 * H * math.cos(E / 2))
    if not abs(sine) <= 1:
        return 0.0, 0.0
    middle, span = math.pi - math.asin(sine), math.pi + E
    starts_free = math.sin(middle - span / 2) >= (gs + k1) / (c + c1)
    turns_free = math.sin(middle + span / 2) <= (gs - k1) / (c - c1)
    if not (starts_free and turns_free):
        return 0.0, 0.0
    bracket = 2 * c1 * math.cos(E / 2) + (math.pi * c + c1 * E) * math.sin(E / 2)
    return math.sqrt((1 - sine) * (1 + sine)) / math.pi * bracket, span / TURN
