"""The motion along the track over a chain of segments."""

from __future__ import annotations

import math

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.flow import (
    LAST_STEP,
    MOST_ITERATIONS,
    MOST_PIECES,
    TURN,
    Drive,
    flow,
    phase_to,
)
from core.motion.kernels.planar.tables import DISTANCE, PIECE, SEGMENT, TIMES
from core.motion.kernels.statuses import MODE

MOST_MODES = 1_000  # stops and starts in one segment


@compiled
def next_phase(target: float, at: float) -> float:
    """Return the first phase from `at` on that is `target` modulo a turn.

    It is the same number whatever `at` was, so that a motion which sticks repeats to the last bit.
    """
    return max(at, target + TURN * math.ceil((at - target) / TURN - 1e-13))


@compiled
def phase_to_stop(v: float, C: float, k: float, at: float, span: float) -> float:
    """Return the phase until the velocity v >= 0 under C sin - k is zero; -1 if not within span."""
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
        for _ in range(MOST_PIECES):
            if low >= span:
                return -1.0
            ahead = phase_to(rise_at, at + low)
            high = min(span, low + (ahead if ahead > 0 else TURN))
            if flow(v, C, k, sine, cosine, high)[0] <= 0:
                break
            low = high + fall_at - rise_at
    first, last = flow(v, C, k, sine, cosine, low)[0], flow(v, C, k, sine, cosine, high)[0]
    d = low + (high - low) * first / (first - last) if first > last else low
    for _ in range(MOST_ITERATIONS):
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
def stick_range(
    c: float, s: float, gs: float, gn: float, mu_s: float
) -> tuple[float, float, float]:
    """Return the least and largest sin(tau) at which friction holds, and the slip beyond the top.

    Below the least value the part slips backward; beyond the largest one forward (1), or backward
    (-1) where the drive lifts it off more than it pushes it on (theory 13.3).
    """
    least, largest, way = -math.inf, math.inf, 1.0
    if c + mu_s * s > 0:
        largest = (gs + mu_s * gn) / (c + mu_s * s)
    elif gs + mu_s * gn < 0:
        largest = -math.inf
    lifting = c - mu_s * s
    holding = mu_s * gn - gs
    if lifting > 0:
        least = -holding / lifting
    elif lifting < 0:
        if holding / -lifting < largest:
            largest, way = holding / -lifting, -1.0
    elif holding < 0:
        least = math.inf
    return least, largest, way


@compiled
def write_piece(
    log: Floats, used: int, at: float, span: float, mode: int, u: float, w: float, x: float
) -> int:
    """Write one piece of the motion into the log, if there is one and it has room."""
    if used < log.shape[0]:
        log[used, PIECE.phase], log[used, PIECE.span], log[used, PIECE.mode] = at, span, mode
        log[used, PIECE.along], log[used, PIECE.normal], log[used, PIECE.position] = u, w, x
        return used + 1
    return used


@compiled
def contact(
    tau: float, span: float, u: float, drive: Drive, sums: Floats, log: Floats, used: int
) -> tuple[float, float, int]:
    """Return velocity and its derivative after a stretch on the floor; add to `sums` and `log`.

    `sums` holds the distance and the times in the four modes. The last value returned is the number
    of rows of the log in use, -1 if the stretch held too many stops.
    """
    c, s, gs, gn, mu_s, mu_k = drive
    least, largest, way = stick_range(c, s, gs, gn, mu_s)
    at, end, slope = tau, tau + span, 1.0
    for _ in range(MOST_MODES):
        if at >= end:
            return u, slope, used
        if u == 0:
            sine = math.sin(at)
            forward = c * sine > gs
            if least <= sine <= largest:
                slope = 0.0
                leave = end
                if -1 < largest < 1:
                    leave = min(leave, next_phase(math.asin(largest), at))
                    forward = way > 0
                if -1 < least < 1:
                    fall = next_phase(math.pi - math.asin(least), at)
                    if fall < leave:
                        leave, forward = fall, False
                used = write_piece(log, used, at, leave - at, MODE.stick, 0.0, 0.0, sums[DISTANCE])
                sums[TIMES + MODE.stick] += leave - at
                if leave >= end:
                    return 0.0, slope, used
                at = leave
            sign = 1.0 if forward else -1.0
        else:
            sign = 1.0 if u > 0 else -1.0
        C, k = c + sign * mu_k * s, gs + sign * mu_k * gn
        stop = phase_to_stop(abs(u), sign * C, sign * k, at, end - at)
        d = end - at if stop < 0 else stop
        mode = MODE.forward if sign > 0 else MODE.backward
        used = write_piece(log, used, at, d, mode, u, 0.0, sums[DISTANCE])
        after, distance = flow(u, C, k, math.sin(at), math.cos(at), d)
        sums[DISTANCE] += distance
        sums[TIMES + mode] += d
        if stop < 0:
            return (after if after * sign > 0 else 0.0), slope, used
        at += d
        u = 0.0
        sine = math.sin(at)
        if slope > 0 and not least <= sine <= largest:
            # The part turns round at once: a later stop shortens the way back.
            before = C * sine - k
            after = (c - sign * mu_k * s) * sine - (gs - sign * mu_k * gn)
            slope = slope * after / before if before != 0 else 0.0
    return u, slope, -1


@compiled
def follow_cycle(
    rows: Floats, count: int, u: float, drive: Drive, sums: Floats, log: Floats
) -> tuple[float, float, int]:
    """Return velocity and its derivative after one cycle, from velocity u at its start.

    Fills `sums`; the last value is the number of rows of the log in use, -1 if a limit came first.
    """
    c, gs, mu_k = drive.c, drive.gs, drive.mu_k
    sums[:] = 0.0
    slope, used = 1.0, 0
    for row in range(count):
        tau, span = rows[row, SEGMENT.phase], rows[row, SEGMENT.span]
        w = rows[row, SEGMENT.take_off]
        if w < 0:
            u, factor, used = contact(tau, span, u, drive, sums, log, used)
            if used < 0:
                return u, slope, used
            slope *= factor
            continue
        used = write_piece(log, used, tau, span, MODE.flight, u, w, sums[DISTANCE])
        u, distance = flow(u, c, gs, math.sin(tau), math.cos(tau), span)
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        friction = mu_k * rows[row, SEGMENT.impulse]
        if abs(u) <= friction:
            u = 0.0
            slope = 0.0 if friction > 0 else slope
        else:
            u -= friction if u > 0 else -friction
    return u, slope, used


@compiled
def two_sided(drive: Drive) -> tuple[float, float]:
    """Return mean velocity and forward share of sliding without stick, theory 13.8 (i).

    The share is 0 where there is no such motion: the part lifts off, or sticks.
    """
    c, s, gs, gn, mu_s, mu = drive
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
