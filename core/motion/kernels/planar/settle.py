"""The sliding velocity at the start of a cycle at which the motion along the track repeats."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Stop
from vibrafeed.core.motion.kernels.planar.drive import Drive
from vibrafeed.core.motion.kernels.planar.flow import EPSILON, MAX_ITERATIONS
from vibrafeed.core.motion.kernels.planar.slide import follow_cycle
from vibrafeed.core.motion.kernels.planar.tables import TIMES
from vibrafeed.core.motion.kernels.statuses import MODE, STATUS

LONGEST_MULTIPLE = 16  # most cycles after which a motion under two friction coefficients may repeat
MAX_UNSURE = 1e-3  # over the drive: a velocity that rounding leaves less sure gives no result

Settled = tuple[float, float, int, int]
"""Velocity, estimate of its error, cycles after which it repeats (0: not found), status."""


@compiled
def settle(
    rows: Floats,
    count: int,
    u: float,
    drive: Drive,
    tolerance: float,
    max_periods: int,
    sums: Floats,
    log: Floats,
    stop: Stop,
) -> Settled:
    """Return the slip velocity at the start of a cycle once the motion along the track repeats.

    By bracketing if mu_s = mu_k, else by following the part from cycle to cycle (theory 13.8).

    Parameters
    ----------
    rows, count
        Segments of the cycle normal to the floor (columns of `SEGMENT`), and how many.
    u
        Slip velocity in g/w (w = 2 pi f) with which the cycle is first entered.
    tolerance
        Error of the velocity that is allowed, over the drive.
    sums, log
        Work arrays of `follow_cycle`.

    Returns
    -------
    tuple
        Velocity in g/w, estimate of its error, cycles after which it repeats (0: not found),
        status.
    """
    if drive.mu_s == drive.mu_k:
        return settle_bracketed(rows, count, u, drive, tolerance, sums, log)
    return settle_followed(rows, count, u, drive, tolerance, max_periods, sums, log, stop)


@compiled
def settle_bracketed(
    rows: Floats, count: int, u: float, drive: Drive, tolerance: float, sums: Floats, log: Floats
) -> Settled:
    """Return the slip velocity with which a cycle repeats, for equal friction coefficients.

    Coulomb friction never drives two motions under the same normal force apart: the map F from the
    slip u at the start of a cycle to that at its end has 0 <= F' <= 1, so that F(u) - u falls with
    u and its sign brackets the root. Newton's step is u + (F(u) - u)/(1 - F'); where F' = 1, steps
    of F(u) - u double (theory 13.8).

    `rows` hold the `count` segments of the cycle normal to the floor, `u` is the first guess in g/w
    (w = 2 pi f), `tolerance` is relative to the size of the drive, D = c + |gs| (drive and gravity
    along), `sums` and `log` are work arrays. The result is velocity and its error in g/w, cycles
    (1, or 0 if it is not known), and status. The error is |F(u) - u|/(1 - F') and what rounding
    leaves, `EPSILON` D/(1 - F'); the status is `limit_reached` where that is above `MAX_UNSURE` D.
    """
    scale = drive.c + abs(drive.gs)
    low, high, stride = -math.inf, math.inf, 1.0
    for _ in range(MAX_ITERATIONS):
        after, slope, used = follow_cycle(rows, count, u, drive, sums, log)
        if used < 0:
            return u, math.inf, 0, STATUS.limit_reached
        change = after - u
        error = abs(change) / max(1e-300, 1 - slope) if slope < 1 else math.inf
        # The change is known but for rounding; the state the less, the nearer the slope is to 1.
        unsure = EPSILON * scale / max(1e-300, 1 - slope) if slope < 1 else math.inf
        if (change == 0 or error <= tolerance * scale) and unsure <= MAX_UNSURE * scale:
            return u, error + unsure, 1, STATUS.periodic
        if abs(change) <= EPSILON * scale and unsure > MAX_UNSURE * scale:
            return u, unsure, 0, STATUS.limit_reached
        if change > 0:
            low = u
        else:
            high = u
        if slope < 1:
            new = u + change / (1 - slope)
        else:  # nothing stopped it all cycle long: look further out, ever faster
            new = u + change * stride
            stride *= 2
        if not low < new < high:
            new = (low + high) / 2 if high - low < math.inf else after
        if new == u:
            sure = unsure <= MAX_UNSURE * scale
            return (
                u,
                abs(change) + unsure,
                1 if sure else 0,
                STATUS.periodic if sure else STATUS.limit_reached,
            )
        u = new
    return u, abs(change), 0, STATUS.limit_reached


@compiled
def settle_followed(
    rows: Floats,
    count: int,
    u: float,
    drive: Drive,
    tolerance: float,
    max_periods: int,
    sums: Floats,
    log: Floats,
    stop: Stop,
) -> Settled:
    """Return the slip velocity with which a cycle repeats, by following the motion.

    For static friction above kinetic: sticking motions may then lie beside sliding ones, and the
    start decides which is reached. The slip u_k after k cycles repeats after m if |u_k - u_(k-m)|
    <= tol (1 - f'), with f' the product of the m slopes of the cycles (theory 13.8).

    Parameters
    ----------
    rows, count
        Segments of the cycle normal to the floor (columns of `SEGMENT`), and how many.
    u
        Slip velocity at the start in g/w (w = 2 pi f).
    drive, tolerance
        Drive, gravity and friction in g; tolerance relative to the drive.
    max_periods
        Bounds the number of cycles.
    sums, log, stop
        Work arrays; flag that ends the work.

    Returns
    -------
    Velocity and its error in g/w, cycles after which it repeats (0: not found), and status.
    """
    scale = drive.c + abs(drive.gs)
    states = np.empty(LONGEST_MULTIPLE + 1)
    slopes = np.empty(LONGEST_MULTIPLE + 1)
    for cycle in range(max(8, max_periods)):
        if raised(stop):
            break
        after, slope, used = follow_cycle(rows, count, u, drive, sums, log)
        if used < 0:
            return u, math.inf, 0, STATUS.limit_reached
        if slides_away(drive, sums, u, after, slope):
            return u, math.inf, 0, STATUS.runaway
        known = min(cycle, LONGEST_MULTIPLE)
        for back in range(known, 0, -1):
            states[back] = states[back - 1]
            slopes[back] = slopes[back - 1] * slope
        states[0], slopes[0] = u, slope
        settled = repeated(after, states, slopes, known, tolerance, scale)
        if settled[2] > 0:
            return settled
        u = sped_up(rows, count, u, after, slope, drive, sums, log)
    return u, math.inf, 0, STATUS.limit_reached


@compiled
def slides_away(drive: Drive, sums: Floats, u: float, after: float, slope: float) -> bool:
    """True if a part slid downhill over a whole cycle and gained speed, so that it runs away.

    `u` and `after` are the slip velocities at the start and end of the cycle in g/w (w = 2 pi f),
    `slope` the derivative of the second by the first (1: it only slid), `sums` the times in the
    modes. Kinetic friction must be less than gravity along the track, mu_k n < |sin(gamma)| (theory
    13.8).
    """
    gs = drive.gs
    uphill = sums[TIMES + (MODE.forward if gs > 0 else MODE.backward)]
    slid_down = slope == 1 and uphill == 0 and sums[TIMES + MODE.stick] == 0
    downhill = drive.mu_k * drive.gn < abs(gs)
    return downhill and slid_down and (after - u) * gs < 0 and u * gs < 0 and after * gs < 0


@compiled
def repeated(
    after: float, states: Floats, slopes: Floats, known: int, tolerance: float, scale: float
) -> Settled:
    """Return the slip velocity with which a motion along the track repeats, and its error.

    With unequal friction coefficients the part is followed cycle by cycle of its motion normal to
    the floor; the motion repeats after m of them if the slip velocity is that of m cycles before.
    The error is d/(1 - f') of a change d with slope f', and 2e-15 of the drive over 1 - f' for
    rounding (theory 13.8). The third value is m, 0 if it does not repeat, the fourth the status.

    `after` is the slip velocity after the last cycle in g/w (w = 2 pi f), `states` the `known` + 1
    velocities at the starts of the cycles before, newest first, `slopes` the derivatives of `after`
    by each, `scale` the drive in g, `tolerance` relative to it.
    """
    for multiple in range(1, known + 2):
        earlier, factor = states[multiple - 1], abs(slopes[multiple - 1])
        error = abs(after - earlier) / max(1e-300, 1 - factor) if factor < 1 else math.inf
        unsure = EPSILON * scale / max(1e-300, 1 - factor) if factor < 1 else math.inf
        if after == earlier and unsure <= MAX_UNSURE * scale:
            return after, unsure, multiple, STATUS.periodic
        if error <= tolerance * scale and unsure <= MAX_UNSURE * scale:
            return after, error + unsure, multiple, STATUS.periodic
    return after, math.inf, 0, STATUS.limit_reached


@compiled
def sped_up(
    rows: Floats, count: int, u: float, after: float, slope: float, drive: Drive, sums: Floats,
    log: Floats,
) -> float:  # fmt: skip
    """Return the next slip velocity to try in the search for the one with which a cycle repeats.

    In g/w (w = 2 pi f). `u` and `after` = f(u) are the slips at the start and end of a cycle,
    `slope` is f'. It is f(u), or the fixed point of the tangent, u + (f(u) - u)/(1 - f'), tried if
    f' > 1/2. The latter is taken if a cycle changes it by at most a tenth of f(u) - u, and if the
    motion drifts towards it from points between, without stick, so that no other cycle is jumped
    over. `rows` hold the `count` segments of the cycle, `sums` and `log` are work arrays.
    """
    change = after - u
    guess = u + change / (1 - slope) if 0 < slope < 1 else after
    if not (slope > 0.5 and guess * after > 0):
        return after
    beyond, _, used = follow_cycle(rows, count, guess, drive, sums, log)
    nearer = used >= 0 and abs(beyond - guess) < 0.1 * abs(change)
    for part in range(1, 4):
        if nearer:
            between = after + (guess - after) * part / 4
            moved, factor, used = follow_cycle(rows, count, between, drive, sums, log)
            nearer = used >= 0 and factor > 0 and (moved - between) * change > 0
    return guess if nearer else after
