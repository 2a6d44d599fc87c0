"""The motion normal to the floor: a cycle of segments, and how roundings grow along it."""

import math
from collections import namedtuple

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.constants import MAX_SEGMENTS, SEGMENT, SETTLED_EXACTLY
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.planar.flow import EPSILON, TURN
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    Restitution,
    impulse,
    landing,
    left_out_softly,
    lift_off,
    lifts,
    load,
    normal_numbers,
    rebound,
    rests,
    rise,
    to_lift_off,
)

ROUNDED = 2.0**-52  # relative rounding of a phase or a speed
MAX_GROWTH = 1e11
"""Of a rounding, up to where a motion repeats: of 16 digits 5 are left then, and a neighbour a few
ulp away goes the same way, but for one cell in a hundred; beyond it rounding decides."""

LAST_DIGIT = 1e15
"""Growth of a rounding up to which one digit of a way from rest to rest is left."""

Uncertainty = tuple[float, float, float]
"""Mean square of what roundings did to phase and rebound, and their mean product, in roundings."""

CERTAIN = (0.0, 0.0, 0.0)


@compiled
def grown(
    known: Uncertainty, span: float, speed: float, after: float, drive: Drive, slope: float,
    slopes: tuple[float, float, float, float],
) -> Uncertainty:  # fmt: skip
    """Return the rounding errors after one more hop, E' = M E M^T + j j^T, as mean squares.

    E = `known` are the errors of phase and rebound, M = `slopes` the derivatives of `one_hop`, j
    what one rounding of the parameters adds (theory 13.7).
    """
    square, product, rebounds = known
    tt, tw, wt, ww = slopes
    s, gn = drive.s, drive.gn
    n1 = load(drive, after)
    late = TURN + min((s + gn) * span * span / max(speed, 1e-300), span / ROUNDED)
    fast = slope * ((s + gn) * (1 + span) + abs(n1) * late)
    return (
        tt * tt * square + 2 * tt * tw * product + tw * tw * rebounds + late * late,
        tt * wt * square + (tt * ww + tw * wt) * product + tw * ww * rebounds,
        wt * wt * square + 2 * wt * ww * product + ww * ww * rebounds + fast * fast,
    )


@compiled
def growth(known: Uncertainty, speed: float, after: float, drive: Drive) -> float:
    """Return the error of the state after a hop, in roundings, weighted by its effect.

    sqrt(E_11) min(1, (|n1| + v)/(s + n)) + sqrt(E_22).
    """
    given = min(1.0, (abs(load(drive, after)) + speed) / (drive.s + drive.gn))
    return math.sqrt(known[0]) * given + math.sqrt(known[2])


SEARCH_HOPS = 512  # hops without a rest after which a motion counts as aperiodic
SEARCH_PERIODS = 400  # periods of the drive that must have passed by then, too
FIRST_LOOK = 32  # hops before the first search for a cycle; each later one waits half as long again
MAX_TRIES = 3  # at cycles of different lengths, in one search; a later one tries again
MAX_NEWTON = 40  # near a period doubling it closes in by two thirds a step: (2/3)^40 = 1e-7
LONGEST_CYCLE = 32  # impacts of a cycle without contact phase
SAME_STATE = 1e-7  # mean distance of phase and speed a hop, below which two cycles are the same
NEAR = 1e-2  # distance of phase and speed at which a search for a cycle starts
FEWEST_PERIODS = 8  # of a run that a limit ended, for its mean to count as that of the motion
SAME_LIFT_OFF = 1e-9  # distance of phase in rad below which two lift-offs are the same

Chain = namedtuple("Chain", "rows summary")
"""The segments of the last cell and their `summary`: cells that differ in friction or along the
track alone have the same, which the next takes over."""

Summary = namedtuple("Summary", "normal load restitution damping start most first end periods")
"""Columns of a summary: the numbers that set the motion, then the result of `normal_cycle`."""

SUMMARY = Summary(*range(len(Summary._fields)))


@compiled
def write_segment(
    rows: Floats, row: int, tau: float, span: float, w: float, speed: float, impulse: float
) -> None:
    """Write one segment of the motion normal to the floor, a contact or a flight, into a row."""
    rows[row, SEGMENT.phase], rows[row, SEGMENT.span], rows[row, SEGMENT.take_off] = tau, span, w
    rows[row, SEGMENT.landing], rows[row, SEGMENT.impulse] = speed, impulse


@compiled
def one_hop(
    drive: Drive, tau: float, w: float, e: Restitution
) -> tuple[float, float, float, float, float, float, float, float]:
    """Return span, landing speed, landing phase and rebound of a hop, and four derivatives.

    With the loads n0 at take-off and n1 at the landing, span D, landing speed v and rebound speed
    R(v), the last four numbers are, in this order (theory 13.16),

        d(phase)/d(tau)   = (n0 D - w)/v                 d(phase)/d(w)   = D/v
        d(rebound)/d(tau) = -R' (n0 - n1 d(phase)/d(tau))
        d(rebound)/d(w)   = -R' (1 - n1 d(phase)/d(w))
    """
    span = landing(drive, w, tau)
    speed = max(0.0, -rise(drive, w, tau, span)[0])
    after = tau + span
    if speed == 0.0:
        return span, speed, after, 0.0, 0.0, 0.0, 0.0, 0.0
    n0, n1 = load(drive, tau), load(drive, after)
    phase_tau, phase_w = (span * n0 - w) / speed, span / speed
    # The landing velocity changes by dw + n0 dtau - n1 dphase; the rebound is -R' times that.
    up, slope = rebound(e, speed)
    return (
        span, speed, after, up,
        phase_tau, phase_w, -slope * (n0 - n1 * phase_tau), -slope * (1 - n1 * phase_w),
    )  # fmt: skip


@compiled
def run_cycle(
    drive: Drive, tau: float, w: float, hops: int, e: Restitution, rows: Floats
) -> tuple[float, float, float, float, float, float]:
    """Return phase and rebound speed after `hops` hops, NaN after a stay, and four derivatives."""
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    for hop in range(hops):
        span, speed, after, up, tt, tw, wt, ww = one_hop(drive, tau, w, e)
        if span <= 0 or rests(drive, after, up, e, SETTLED_EXACTLY):
            return math.nan, 0.0, a, b, c, d
        write_segment(rows, hop, tau % TURN, span, w, speed, impulse(e, speed, up))
        a, b, c, d = tt * a + tw * c, tt * b + tw * d, wt * a + ww * c, wt * b + ww * d
        tau, w = after, up
    return tau, w, a, b, c, d


@compiled
def fixed_point(
    drive: Drive, at: float, up: float, hops: int, periods: int, e: Restitution, rows: Floats
) -> tuple[float, float, bool]:
    """Return take-off phase and speed of a cycle of hops, and True if the cycle attracts.

    Newton's iteration is (M - 1) dy = -(y1 - y0), with the state y = (phase, speed) at start and
    end and the derivatives M of `run_cycle`. It attracts if |tr M| < 1 + det M and det M < 1
    (Jury).
    """
    for _ in range(MAX_NEWTON):
        after, up_after, a, b, c, d = run_cycle(drive, at, up, hops, e, rows)
        if math.isnan(after):
            break
        off, off_up = after - at - periods * TURN, up_after - up
        determinant = (a - 1) * (d - 1) - b * c
        if determinant == 0:
            break
        step = (off * (d - 1) - b * off_up) / determinant
        step_up = ((a - 1) * off_up - c * off) / determinant
        at, up = at - step, max(0.0, up - step_up)
        if abs(step) + abs(step_up) <= 1e-14 * (TURN + drive.s):
            product = a * d - b * c
            return at, up, abs(a + d) < 1 + product and product < 1
    return at, up, False


@compiled
def shortest_part(rows: Floats, hops: int, periods: int) -> int:
    """Return the number of hops after which a cycle of `hops` hops already repeats."""
    for part in range(1, hops // 2 + 1):
        if hops % part == 0 and periods % (hops // part) == 0:
            apart = 0.0
            for hop in range(hops - part):
                apart += abs(rows[hop + part, SEGMENT.phase] - rows[hop, SEGMENT.phase])
                apart += abs(rows[hop + part, SEGMENT.take_off] - rows[hop, SEGMENT.take_off])
            if apart < SAME_STATE * hops:
                return part
    return hops


@compiled
def find_cycle(
    drive: Drive, e: Restitution, rows: Floats, count: int, tau: float, w: float
) -> tuple[int, int]:
    """Return hops and periods of an attracting cycle of hops near the last states; (0, 0) if none.

    A search starts where the motion nearly recurs. The cycle must attract, lie near, and be
    approached by the motion; its hops then overwrite the first rows (theory 13.7).
    """
    travelled, tries = 0.0, 0
    for hops in range(1, min(LONGEST_CYCLE, count) + 1):
        row = rows[count - hops]
        travelled += row[SEGMENT.span]
        periods = round(travelled / TURN)
        recurrence = abs(travelled - periods * TURN) + abs(w - row[SEGMENT.take_off])
        if periods < 1 or recurrence > NEAR:
            continue
        tries += 1
        if tries > MAX_TRIES:
            break
        at, up = tau % TURN, w
        start, start_up = at, up
        scratch = rows[count:]
        if scratch.shape[0] < hops:
            return 0, 0
        at, up, attracts = fixed_point(drive, at, up, hops, periods, e, scratch)
        distance = abs(at - start) + abs(up - start_up)
        if not attracts or distance > 100 * recurrence + 1e-9:
            continue
        after, up_after, _, _, _, _ = run_cycle(drive, start, start_up, hops, e, scratch)
        nearer = abs(after - at - periods * TURN) + abs(up_after - up)
        if not (nearer < distance or distance < 1e-9):
            continue
        if math.isnan(run_cycle(drive, at, up, hops, e, scratch)[0]):
            continue
        shortest = shortest_part(scratch, hops, periods)
        for hop in range(shortest):
            for column in range(len(SEGMENT)):
                rows[hop, column] = scratch[hop, column]
        return shortest, periods * shortest // hops
    return 0, 0


@compiled
def normal_cycle(
    drive: Drive, start: float, e: Restitution, max_periods: int, most_growth: float, rows: Floats
) -> tuple[int, int, int]:
    """Return the cycle normal to the floor into which a part settles from rest at phase `start`.

    Return the index of its first segment, the end, and its periods: 0 if it does not repeat, or
    roundings that grew beyond `most_growth` decide how; -1 if a limit came first (theory 13.7).
    """
    if not lifts(drive):
        write_segment(rows, 0, 0.0, TURN, -1.0, 0.0, 0.0)
        return 0, 1, 1
    tau = lift_off(drive, start)
    w, total, count, look_at = 0.0, 0.0, 0, FIRST_LOOK
    uncertainty = CERTAIN
    while count < MAX_SEGMENTS - LONGEST_CYCLE - 2:
        span, speed, after, up, tt, tw, wt, ww = one_hop(drive, tau, w, e)
        if span < 0:
            return 0, count, -1
        write_segment(rows, count, tau, span, w, speed, impulse(e, speed, up))
        count += 1
        total += span
        if most_growth < math.inf:
            slope = rebound(e, speed)[1]
            uncertainty = grown(uncertainty, span, speed, after, drive, slope, (tt, tw, wt, ww))
            if not growth(uncertainty, speed, after, drive) <= most_growth:
                return 0, count, 0
        tau, w = after % TURN, up
        if rests(drive, tau, w, e, SETTLED_EXACTLY):
            # On the floor until lift-off; the cycle is closed if one began there before.
            span = to_lift_off(drive, tau)
            rows[count - 1, SEGMENT.impulse] = speed
            write_segment(rows, count, tau, span, -1.0, 0.0, w)
            count += 1
            total += span
            tau, w, uncertainty = lift_off(drive, tau), 0.0, CERTAIN
            first = same_start(rows, count, tau)
            if first >= 0:
                for row in range(first):
                    total -= rows[row, SEGMENT.span]
                return first, count, round(total / TURN)
        elif count >= look_at and total > TURN:
            look_at = count + count // 2
            hops, periods = find_cycle(drive, e, rows, count, tau, w)
            if hops:
                return 0, hops, periods
        if count >= SEARCH_HOPS and total > TURN * min(SEARCH_PERIODS, max_periods):
            return 0, count, 0
    return 0, count, (0 if total > TURN * FEWEST_PERIODS else -1)


@compiled
def no_chain() -> Chain:
    """Return room for the segments of a cell, which are no cell's yet."""
    return Chain(np.empty((MAX_SEGMENTS, len(SEGMENT))), np.full(len(SUMMARY), math.nan))


@compiled
def is_owned(owner: Floats, drive: Drive, e: Restitution, start: float) -> bool:
    """True if `owner` has the numbers of a motion normal to the floor; it has them afterwards."""
    normal, load = normal_numbers(drive)
    is_same = True
    for place, number in enumerate((normal, load, e.constant, e.damping, start)):
        is_same = is_same and owner[place] == number
        owner[place] = number
    return is_same


@compiled
def cycle_in(
    chain: Chain, drive: Drive, start: float, e: Restitution, max_periods: int, most_growth: float
) -> tuple[int, int, int]:
    """Return the result of `normal_cycle`, taken over from the last cell if that had the same."""
    summary = chain.summary
    is_same = is_owned(summary, drive, e, start) and summary[SUMMARY.most] == max_periods
    summary[SUMMARY.most] = max_periods
    if not (is_same and lifts(drive)):
        first, end, periods = normal_cycle(drive, start, e, max_periods, most_growth, chain.rows)
        summary[SUMMARY.first], summary[SUMMARY.end], summary[SUMMARY.periods] = first, end, periods
    return int(summary[SUMMARY.first]), int(summary[SUMMARY.end]), int(summary[SUMMARY.periods])


@compiled
def same_start(rows: Floats, count: int, tau: float) -> int:
    """Return the index of an earlier segment that took off from rest at phase `tau`; -1 if none."""
    for row in range(count):
        if rows[row, SEGMENT.take_off] == 0.0:
            apart = abs(rows[row, SEGMENT.phase] - tau)
            if min(apart, TURN - apart) < SAME_LIFT_OFF:
                return row
    return -1


@compiled
def phase_uncertainty(rows: Floats, count: int, drive: Drive, e: Restitution) -> float:
    """Return the error in rad by rounding of a cycle's phases, weighted by its effect on the part.

    Errors grow by |M|/min |M| of the matrices of `one_hop` until the part rests; if it never rests,
    at least by (2 + |M|)/|det(M - 1)|.
    """
    s, gn = drive.s, drive.gn
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    least, growth, never_rests = 2.0, 1.0, True
    for row in range(count):
        tau, span = rows[row, SEGMENT.phase], rows[row, SEGMENT.span]
        w, speed = rows[row, SEGMENT.take_off], rows[row, SEGMENT.landing]
        if w < 0 or speed <= 0:
            a, b, c, d, least = 1.0, 0.0, 0.0, 1.0, 2.0
            never_rests = never_rests and w >= 0
            continue
        n0, n1, slope = load(drive, tau), load(drive, tau + span), rebound(e, speed)[1]
        tt, tw = (span * n0 - w) / speed, span / speed
        wt, ww = -slope * (n0 - n1 * tt), -slope * (1 - n1 * tw)
        a, b, c, d = tt * a + tw * c, tt * b + tw * d, wt * a + ww * c, wt * b + ww * d
        size = abs(a) + abs(b) + abs(c) + abs(d)
        if not 1e-100 < size < 1e100:
            a, b, c, d, size, least = 1.0, 0.0, 0.0, 1.0, 2.0, 2.0
        least = min(least, size)
        given = min(1.0, (abs(n1) + speed) / (s + gn))
        growth = max(growth, 1.0 + (size / least - 1.0) * given)
    rounding = EPSILON * (TURN + s) + left_out_softly(rows, count, drive, e)[1]
    if never_rests:
        # Of a cycle that has just doubled one half may have been kept: it does not quite close.
        last = count - 1
        apart = (
            rows[last, SEGMENT.phase] + rows[last, SEGMENT.span] - rows[0, SEGMENT.phase]
        ) / TURN
        open_by = abs(apart - round(apart)) * TURN + abs(
            rebound(e, rows[last, SEGMENT.landing])[0] - rows[0, SEGMENT.take_off]
        )
        determinant = abs((a - 1) * (d - 1) - b * c)
        return (rounding + open_by) * max(
            growth, (2 + abs(a) + abs(b) + abs(c) + abs(d)) / max(1e-9, determinant)
        )
    return rounding * growth
