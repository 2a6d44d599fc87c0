"""The motion along the track over a chain of segments."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.planar.drive import (
    Drive,
    fly,
    hold,
    holds,
    load,
    slide,
    slip_acceleration,
    stop_after,
)
from vibrafeed.core.motion.kernels.planar.tables import DISTANCE, PIECE, SEGMENT, TIMES
from vibrafeed.core.motion.kernels.statuses import MODE

MAX_MODES = 1_000
"""Stops and starts in one segment, a period at most: between two of them an acceleration changes
its sign, which those of ten harmonics do 20 times each. More are roundings that go on for ever."""


@borrowing
def write_piece(
    log: Floats, used: int, at: float, span: float, mode: int, u: float, w: float, x: float
) -> int:
    """Write one piece of a motion into the log for trajectories; return the number of rows in use.

    A piece is a stretch in one mode (columns of `PIECE`): start phase `at` and duration `span` in
    rad, `mode`, velocities `u` along and `w` normal in g/(2 pi f), and position `x` in g/(2 pi f)^2
    at its start. `used` rows were in use before; a log that is full, or has no rows, stays as it
    is.
    """
    if used < log.shape[0]:
        log[used, PIECE.phase], log[used, PIECE.span], log[used, PIECE.mode] = at, span, mode
        log[used, PIECE.along], log[used, PIECE.normal], log[used, PIECE.position] = u, w, x
        return used + 1
    return used


@borrowing
def contact(
    tau: float, span: float, u: float, drive: Drive, sums: Floats, log: Floats, used: int
) -> tuple[float, float, int]:
    """Return slip velocity after a contact, its derivative by that before, and log rows in use.

    The part touches the floor from phase `tau` for `span` rad, with slip `u` in g/w (w = 2 pi f) at
    first. It sticks until `hold` ends, slips until `stop_after`, and so on (theory 13.4). The
    derivative is 1 while sliding, u'(after)/u'(before) times that at a turn, 0 after a stick
    (13.8).

    Parameters
    ----------
    tau, span, u
        Phase at the start, duration in rad, and slip velocity at the start.
    drive
        Drive numbers of the cell.
    sums
        Distance and times in the modes; those of the contact are added.
    log, used
        Table of motion pieces (columns of `PIECE`), and its rows in use; the pieces are added. The
        last value returned is -1 if the contact held too many stops.
    """
    at, end, slope = tau, tau + span, 1.0
    for _ in range(MAX_MODES):
        if at >= end:
            return u, slope, used
        if u == 0:
            sticks, leave, forward = hold(drive, at, end)
            if sticks:
                slope = 0.0
                used = write_piece(log, used, at, leave - at, MODE.stick, 0.0, 0.0, sums[DISTANCE])
                sums[TIMES + MODE.stick] += leave - at
                if leave >= end:
                    return 0.0, slope, used
                at = leave
            sign = 1.0 if forward else -1.0
        else:
            sign = 1.0 if u > 0 else -1.0
        stop = stop_after(drive, sign, u, at, end - at)
        d = end - at if stop < 0 else stop
        mode = MODE.forward if sign > 0 else MODE.backward
        used = write_piece(log, used, at, d, mode, u, 0.0, sums[DISTANCE])
        after, distance = slide(drive, sign, u, at, d)
        sums[DISTANCE] += distance
        sums[TIMES + mode] += d
        if stop < 0:
            return (after if after * sign > 0 else 0.0), slope, used
        at += d
        u = 0.0
        if slope > 0 and not holds(drive, at):
            # The part turns round at once: a later stop shortens the way back.
            before = slip_acceleration(drive, sign, at)
            after = slip_acceleration(drive, -sign, at)
            slope = slope * after / before if before != 0 else 0.0
    return u, slope, -1


@borrowing
def skids(drive: Drive, tau: float) -> float:
    """Return the direction in which tiny hops at phase `tau` drive a part from rest: 1, -1 or 0.

    A hop with rebound w gives the part the slip 2 |a| w/n, its landing takes mu_k (1 + eps) w, with
    the acceleration along a = b_x - sin(gamma) and the load n. If |a| > mu_k n the slip grows from
    hop to hop, and the floor does not stop it afterwards, whatever static friction could hold
    (theory 13.5).
    """
    along = slip_acceleration(drive, 0.0, tau)
    return math.copysign(1.0, along) if abs(along) > drive.mu_k * load(drive, tau) else 0.0


@borrowing
def after_hops(drive: Drive, tau: float, u: float, w: float) -> float:
    """Return the slip velocity at the start of a contact that stands for many small hops.

    In g/(2 pi f). `u` is the slip after the last landing, at phase `tau`, `w` the rebound velocity
    of the first of the hops left out. The result is u if |u| > mu_k w, else 0, or +-mu_k w of a
    part that tiny hops drive on (`skids`): the landing had no slip to take, and the hops after it
    rub by w less than the floor in their time (theory 13.5).
    """
    if w == 0.0 or abs(u) > drive.mu_k * w:
        return u
    way = skids(drive, tau)
    return u if way == 0.0 else way * drive.mu_k * w


@borrowing
def follow_cycle(
    rows: Floats, count: int, u: float, drive: Drive, sums: Floats, log: Floats
) -> tuple[float, float, int]:
    """Follow the slip of a part along a cycle that is known normal to the floor.

    Stick and slip on the floor by turns, free flight off it; a landing with the impulse I takes
    mu_k I off the slip, or all of it if |u| <= mu_k I (theory 13.4).

    Parameters
    ----------
    rows, count
        Segments of the cycle, contacts and flights (columns of `SEGMENT`), and how many.
    u
        Slip velocity at the start in g/w (w = 2 pi f).
    drive
        Drive, gravity and friction in g.
    sums, log
        Filled with distance and times in the modes, and with the motion pieces.

    Returns
    -------
    Slip velocity at the end in g/w, its derivative by `u`, and the rows of the log in use; -1 if a
    limit came first.
    """
    mu_k = drive.mu_k
    sums[:] = 0.0
    slope, used = 1.0, 0
    for row in range(count):
        tau, span = rows[row, SEGMENT.phase], rows[row, SEGMENT.span]
        w = rows[row, SEGMENT.take_off]
        if w < 0:
            entered = after_hops(drive, tau, u, rows[row, SEGMENT.impulse])
            if entered != u:
                u, slope = entered, 0.0
            u, factor, used = contact(tau, span, u, drive, sums, log, used)
            if used < 0:
                return u, slope, used
            slope *= factor
            continue
        used = write_piece(log, used, tau, span, MODE.flight, u, w, sums[DISTANCE])
        u, distance = fly(drive, u, tau, span)
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        friction = mu_k * rows[row, SEGMENT.impulse]
        if abs(u) <= friction:
            u = 0.0
            slope = 0.0 if friction > 0 else slope
        else:
            u -= friction if u > 0 else -friction
    return u, slope, used
