"""The motion along the track over a cycle: slide, the slip at which it repeats, its means."""

import math

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.constants import (
    COLUMN,
    DISTANCE,
    MODE,
    MODES,
    PIECE,
    SEGMENT,
    STATUS,
    SUMS,
    TIMES,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats, Stop, copy
from vibrafeed.core.motion.kernels.planar.cycle import phase_uncertainty
from vibrafeed.core.motion.kernels.planar.flow import EPSILON, MAX_ITERATIONS, TURN
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    first_slip,
    fly,
    hold,
    holds,
    hop_height,
    left_out_softly,
    lifts,
    load,
    restitution_of,
    slide,
    slip_acceleration,
    slip_uncertainty,
    stop_after,
    to_lift_off,
    track_speed,
)

MAX_MODES = 1_000
"""Stops and starts in one segment: an acceleration of ten harmonics changes sign 20 times a period.
More are roundings that go on for ever."""


@borrowing
def write_piece(
    log: Floats, used: int, at: float, span: float, mode: int, u: float, w: float, x: float
) -> int:
    """Write one piece of a motion into the log (columns of `PIECE`); return the rows in use."""
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

    It sticks until `hold` ends, slips until `stop_after`, and so on (theory 13.4). The derivative
    is 1 while sliding, u'(after)/u'(before) times that at a turn, 0 after a stick (13.8); -1 rows:
    too many stops.
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

    If |a| > mu_k n, with a = b_x - sin(gamma), the slip grows from hop to hop (theory 13.5).
    """
    along = slip_acceleration(drive, 0.0, tau)
    return math.copysign(1.0, along) if abs(along) > drive.mu_k * load(drive, tau) else 0.0


@borrowing
def after_hops(drive: Drive, tau: float, u: float, w: float) -> float:
    """Return the slip velocity at the start of a contact that stands for many small hops.

    In g/w; u if |u| > mu_k w with the rebound w of the first hop left out, else 0, or +-mu_k w of a
    part that tiny hops drive on (`skids`) (theory 13.5).
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

    A landing with the impulse I takes mu_k I off the slip in g/w, or all of it if |u| <= mu_k I
    (theory 13.4). Return slip at the end, its derivative by `u`, log rows in use; -1 if a limit
    came first.
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
    """
    if drive.mu_s == drive.mu_k:
        return settle_bracketed(rows, count, u, drive, tolerance, sums, log)
    return settle_followed(rows, count, u, drive, tolerance, max_periods, sums, log, stop)


@compiled
def settle_bracketed(
    rows: Floats, count: int, u: float, drive: Drive, tolerance: float, sums: Floats, log: Floats
) -> Settled:
    """Return the slip velocity with which a cycle repeats, for equal friction coefficients.

    Coulomb friction never drives two motions under one normal force apart: the map F from slip to
    slip over a cycle has 0 <= F' <= 1, so that the sign of F(u) - u brackets the root (theory
    13.8).
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

    For static friction above kinetic, where the start decides which of several motions is reached.
    The slip u_k after k cycles repeats after m if |u_k - u_(k-m)| <= tol (1 - f'), f' the product
    of the m slopes of the cycles (theory 13.8).
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

    `slope` is 1 if it only slid; mu_k n < |sin(gamma)| (theory 13.8).
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
    """Return the slip velocity with which a motion along the track repeats, and its error."""
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

    f(u), or the fixed point of the tangent, u + (f(u) - u)/(1 - f'), where that jumps over no other
    cycle.
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


ROUNDING = 4e-14  # error of a mean velocity by rounding, over the drive and friction's impulses
CLOSE = 1e-9
"""Largest error of the slip at which a cycle repeats: it is read off a slope that may change on the
way there; where a hundredth was asked for, a mean was off by up to 29 times what was said."""
MAX_RUBBING = 8.0
"""Friction adds up over no more than so many times the share of the period in which a part slides,
times its largest: what is huge acts for as short a time."""


@compiled
def velocity_at_start(drive: Drive, phase: float, rows: Floats, first: int, count: int) -> float:
    """Return the slip velocity in g/w at the start of the cycle of a part at rest at `phase`."""
    if drive.mu_s == 0 and drive.gs == 0:  # nothing acts along the track but the drive
        return track_speed(drive, phase) - track_speed(drive, rows[first, SEGMENT.phase])
    if lifts(drive):
        sums, no_log = np.zeros(SUMS), np.empty((0, len(PIECE)))
        # A part that lifts off starts on the floor, at least at the drive's own zero.
        span = to_lift_off(drive, phase)
        u = contact(phase, span, 0.0, drive, sums, no_log, 0)[0]
        if rows[count - 1, SEGMENT.take_off] >= 0:
            # A cycle without contact: friction brings any velocity to the same motion.
            return 0.0
        return follow_cycle(rows, first, u, drive, sums, no_log)[0] if first > 0 else u
    slip = first_slip(drive, phase)
    if not math.isnan(slip):
        rows[first, SEGMENT.phase] = slip
    return 0.0


@compiled
def keep_speed(
    drive: Drive, phase: float, rows: Floats, count: int, periods: int, sums: Floats
) -> None:
    """Fill the sums over a cycle of a part without friction on the level, which keeps its speed."""
    flying = 0.0
    for row in range(count):
        flying += rows[row, SEGMENT.span] if rows[row, SEGMENT.take_off] >= 0 else 0.0
    sums[:] = 0.0
    speed = track_speed(drive, phase)
    sums[DISTANCE] = speed * periods * TURN
    sums[TIMES + (MODE.forward if speed >= 0 else MODE.backward)] = periods * TURN - flying
    sums[TIMES + MODE.flight] = flying


@compiled
def write_impacts(rows: Floats, count: int, drive: Drive, periods: int, result: Floats) -> None:
    """Fill the results that depend on flights: impacts a period, landing speed, hop height."""
    impacts, fastest, highest = 0, 0.0, 0.0
    for row in range(count):
        if rows[row, SEGMENT.take_off] >= 0:
            impacts += 1
            fastest = max(fastest, rows[row, SEGMENT.landing])
            highest = hop_height(
                drive,
                rows[row, SEGMENT.take_off],
                rows[row, SEGMENT.phase],
                rows[row, SEGMENT.span],
                highest,
            )
    result[COLUMN.impacts] = impacts / periods
    result[COLUMN.landing_speed], result[COLUMN.hop_height] = fastest, highest


@compiled
def repeating(
    rows: Floats, count: int, periods: int, phase: float, u: float, drive: Drive, cell: Cell,
    sums: Floats, log: Floats, result: Floats, stop: Stop,
) -> tuple[int, float]:  # fmt: skip
    """Fill `result` with the means of a motion that repeats; return its status and slip."""
    c, s, gs, gn, mu_s, mu_k = drive.c, drive.s, drive.gs, drive.gn, drive.mu_s, drive.mu_k
    error, cycles, status = 0.0, 1, STATUS.neutral
    if mu_s == 0:
        keep_speed(drive, phase, rows, count, periods, sums)
    else:
        u, error, cycles, status = settle(
            rows, count, u, drive, min(cell.tolerance, CLOSE), int(cell.max_periods), sums, log,
            stop,
        )  # fmt: skip
        if cycles == 0:
            return status, 0.0
    if mu_s != mu_k:
        total = np.zeros(SUMS)
        velocity = u
        for _ in range(cycles):
            velocity, _, _ = follow_cycle(rows, count, velocity, drive, sums, log)
            for place in range(SUMS):
                total[place] += sums[place]
        copy(total, sums)
    time = periods * cycles * TURN
    result[COLUMN.velocity], result[COLUMN.spread] = sums[DISTANCE] / time, 0.0
    slides = (sums[TIMES + MODE.forward] + sums[TIMES + MODE.backward]) / time
    e = restitution_of(cell)
    doubt = ROUNDING + (phase_uncertainty(rows, count, drive, e) if lifts(drive) else 0.0)
    rubbing = mu_k * (s + gn) * min(1.0, MAX_RUBBING * slides)
    result[COLUMN.error] = error + doubt * (c + abs(gs) + rubbing)
    result[COLUMN.error] += mu_k * left_out_softly(rows, count, drive, e)[0] / (periods * TURN)
    if mu_s > mu_k and sums[TIMES + MODE.stick] > 0.0:
        result[COLUMN.error] += slip_uncertainty(drive) * slides
    for mode in range(MODES):
        result[COLUMN.stick + mode] = sums[TIMES + mode] / time
    write_impacts(rows, count, drive, periods, result)
    result[COLUMN.multiple] = float(periods * cycles)
    return status, u
