"""A flight from take-off to landing, under a wave: its part of `drive`."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import (
    AIR,
    MAX_ITERATIONS,
    MAX_PIECES,
    NORMAL,
    SMOOTH,
    TURN,
)
from vibrafeed.core.motion.kernels.planar.wave import (
    ENDS,
    LAST_STEP,
    SLACK,
    WaveDrive,
    acceleration,
    flow,
    folded,
    later_passage,
    next_of_way,
    next_passage,
    speed_from,
    speed_start,
    step_at,
    zero_of_velocity,
)
from vibrafeed.core.motion.kernels.waves import halley, is_near_root


@borrowing
def normal_numbers(drive: WaveDrive) -> tuple[float, float]:
    """Return NaN, as two numbers do not tell a wave, and gravity onto the floor, n, in g."""
    return math.nan, drive.gn


@borrowing
def track_speed(drive: WaveDrive, tau: float) -> float:
    """Return the velocity of the track along itself under a wave at phase `tau` [rad], in g/w.

    Minus the integral of the push along over the phase, without its mean (w = 2 pi f): sum of (s_k
    cos(k tau) - c_k sin(k tau))/k with the coefficients s_k and c_k; of steps v -> v - p D over
    each, with level p in g and duration D in rad, less the mean of that (theory 13.14).
    """
    if drive.steps == 0:
        velocity = 0.0
        for k in range(1, drive.orders + 1):
            a, b = drive.table[2 * AIR, k], drive.table[2 * AIR + 1, k]
            velocity += (a * math.cos(k * tau) - b * math.sin(k * tau)) / k
        return velocity
    at, now, mean, speed, within = 0.0, 0.0, 0.0, 0.0, tau % TURN
    for step in range(drive.steps):
        end, level = drive.table[ENDS, step], drive.table[2 * AIR, step]
        if at <= within:
            speed = now - level * (within - at)
        mean += (now - 0.5 * level * (end - at)) * (end - at) / TURN
        now, at = now - level * (end - at), end
    return speed - mean


@borrowing
def air_swings(drive: WaveDrive, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along after a flight from phase `tau`, taken off without slip.

    In g/w and g/w^2 (w = 2 pi f), at the phase `d` after take-off.
    """
    return flow(drive, AIR, 0.0, tau, d)


@borrowing
def swung_along(
    drive: WaveDrive, u: float, d: float, swing: float, sway: float
) -> tuple[float, float]:
    """Return velocity and distance along after a flight for the phase `d`, in g/w and g/w^2.

    u + u0 and u D + x0, with the slip `u` at take-off, D = `d`, and u0 = `swing` and x0 = `sway` of
    a flight without slip (w = 2 pi f).
    """
    return u + swing, u * d + sway


@borrowing
def push_slope(drive: WaveDrive, tau: float) -> tuple[float, float]:
    """Return NaN: a wave has steps and several harmonics, so its slope is not used."""
    return math.nan, math.nan


@borrowing
def smooth_span(drive: WaveDrive, tau: float) -> float:
    """Return a phase interval in rad after `tau` in which the drive is nearly a polynomial.

    Gauss's rule integrates over such intervals. 1.5/n for sums of sines of highest order n; for a
    drive in steps the phase to its next jump.
    """
    if drive.steps == 0:
        return SMOOTH / drive.orders
    within = folded(tau)
    return max(SLACK, drive.table[ENDS, step_at(drive, within)] - within)


@borrowing
def lift_off(drive: WaveDrive, tau: float) -> float:
    """Return the phase of the next lift-off, where p_z - n rises through 0 (theory 13.14)."""
    return next_of_way(drive, NORMAL, tau, True) % TURN


@borrowing
def landing(drive: WaveDrive, w: float, tau: float) -> float:
    """Return the flight time in rad after take-off at phase `tau` under a wave; -1 if not found.

    `w` >= 0 is the velocity at take-off in g/(2 pi f). Between two changes of sign of the normal
    acceleration the height bends one way: a piece that bends down and ends above the floor was
    above it all the way; on a piece that bends up the least height is found first (theory 13.14).
    """
    d, velocity = 0.0, w
    force = acceleration(drive, NORMAL, tau)
    if w > 0.0 and force < 0.0:
        # A small hop: twice the parabola's own time is past the landing, or soon will be.
        end, guess = next_passage(drive, NORMAL, tau)[0] - tau, -2.0 * w / force
        for _ in range(64):
            if not guess < end:
                break
            if flow(drive, NORMAL, w, tau, guess)[1] <= 0.0:
                return landing_root(drive, 0.0, w, tau, 0.0, guess)
            guess *= 2.0
    start = speed_start(drive, NORMAL, tau)
    for _ in range(MAX_PIECES):
        at, rises = later_passage(drive, NORMAL, tau + d)
        end = at - tau
        last, height = flow(drive, NORMAL, w, tau, end)
        if not rises:  # it falls at the end: the height bent up
            if velocity < 0.0:
                low = end
                if last > 0.0:
                    low = zero_of_velocity(drive, NORMAL, w, tau, start, d, end, velocity, last)
                    height = flow(drive, NORMAL, w, tau, low)[1]
                if height <= 0.0:
                    return landing_root(drive, 0.0, w, tau, d, low)
        elif last < 0.0 and height <= 0.0:
            return landing_root(drive, 0.0, w, tau, d, end)
        d, velocity = end, last
    return -1.0


@borrowing
def landing_root(
    drive: WaveDrive, z: float, w: float, tau: float, low: float, high: float
) -> float:
    """Return the phase between `low` and `high` at which the height of a part falls through 0.

    Phases count from `tau`, where the height is `z` in g/w^2 and the velocity `w` in g/w (here w =
    2 pi f). Halley's iteration in this bracket, with z' = w and z'' = p_z - n: push p_z off the
    floor less gravity n. It starts where the parabola at `high` falls through 0: `high` may be the
    lowest point, where the velocity is rounding and no step of Halley's or Newton's leads anywhere.
    """
    velocity, height = flow(drive, NORMAL, w, tau, high)
    height += z
    force = acceleration(drive, NORMAL, tau + high)
    reach = math.sqrt(max(0.0, velocity * velocity - 2.0 * height * force)) - velocity
    guess = high + 2.0 * height / reach if reach > 0.0 else low
    d = guess if low < guess <= high else 0.5 * (low + high)
    for _ in range(MAX_ITERATIONS):
        velocity, height = flow(drive, NORMAL, w, tau, d)
        height += z
        if height > 0.0:
            low = d
        else:
            high = d
        force = acceleration(drive, NORMAL, tau + d)
        new = d - halley(height, velocity, force)
        short = low <= new <= high and abs(new - d) <= LAST_STEP * d
        if short and is_near_root(height, velocity, force, LAST_STEP):
            return new
        if not low < new < high:
            new = 0.5 * (low + high)
            if new in (low, high):
                return new
        d = new
    return d


@borrowing
def hop_height(drive: WaveDrive, w: float, tau: float, span: float, known: float) -> float:
    """Return the largest height of a flight in g/(2 pi f)^2, or `known` if that is larger.

    The part takes off at phase `tau` with velocity `w` and flies for `span` rad; tops are where w
    falls through 0. They are looked for only if the bound (n + s) span^2/8 is above
    `known`: z'' >= -(n + s), and both ends are on the floor.
    """
    if (drive.gn + drive.s) * span * span / 8 <= known:
        return known
    best, d, velocity = known, 0.0, w
    start = speed_start(drive, NORMAL, tau)
    for _ in range(MAX_PIECES):
        end = min(span, later_passage(drive, NORMAL, tau + d)[0] - tau)
        last = speed_from(drive, NORMAL, w, tau, start, end)[0]
        if velocity >= 0.0 > last:
            top = zero_of_velocity(drive, NORMAL, w, tau, start, d, end, velocity, last)
            best = max(best, flow(drive, NORMAL, w, tau, top)[1])
        d, velocity = end, last
        if d >= span:
            break
    return best
