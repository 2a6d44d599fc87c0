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
    lift_off,
    lifts,
    load,
    normal_numbers,
    rebound,
    rests,
    rise,
    soft_hop_errors,
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
def errors_after_hop(
    errors: Uncertainty, span: float, landing_speed: float, landing_phase: float, drive: Drive,
    slope: float, slopes: tuple[float, float, float, float],
) -> Uncertainty:  # fmt: skip
    """Return the rounding errors after one more hop, E' = M E M^T + j j^T, as mean squares.

    E = `errors` are those of phase and rebound, M = `slopes` the derivatives of `one_hop`, j
    what one rounding of the parameters adds (theory 13.7).
    """
    phase_square, product, speed_square = errors
    # M = ((tt, tw), (wt, ww)): t for the phase, w for the rebound, derivative of the first letter.
    tt, tw, wt, ww = slopes
    push_normal, gravity_normal = drive.push_normal, drive.gravity_normal
    load_at_landing = load(drive, landing_phase)
    phase_rounding = TURN + min(
        (push_normal + gravity_normal) * span * span / max(landing_speed, 1e-300), span / ROUNDED
    )
    speed_rounding = slope * (
        (push_normal + gravity_normal) * (1 + span) + abs(load_at_landing) * phase_rounding
    )
    return (
        tt * tt * phase_square
        + 2 * tt * tw * product
        + tw * tw * speed_square
        + phase_rounding * phase_rounding,
        tt * wt * phase_square + (tt * ww + tw * wt) * product + tw * ww * speed_square,
        wt * wt * phase_square
        + 2 * wt * ww * product
        + ww * ww * speed_square
        + speed_rounding * speed_rounding,
    )


@compiled
def weighted_error(
    errors: Uncertainty, landing_speed: float, landing_phase: float, drive: Drive
) -> float:
    """Return the error of the state after a hop, in roundings, weighted by its effect.

    sqrt(E_11) min(1, (|n1| + v)/(s + n)) + sqrt(E_22).
    """
    # E_11, E_22: squares of the errors of phase and rebound; n1, v: load and speed at the landing.
    phase_weight = min(
        1.0,
        (abs(load(drive, landing_phase)) + landing_speed)
        / (drive.push_normal + drive.gravity_normal),
    )
    return math.sqrt(errors[0]) * phase_weight + math.sqrt(errors[2])


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
    rows: Floats,
    index: int,
    tau: float,
    span: float,
    take_off: float,
    landing_speed: float,
    impulse: float,
) -> None:
    """Write one segment of the motion normal to the floor, a contact or a flight, into a row."""
    rows[index, SEGMENT.phase], rows[index, SEGMENT.span], rows[index, SEGMENT.take_off] = (
        tau,
        span,
        take_off,
    )
    rows[index, SEGMENT.landing], rows[index, SEGMENT.impulse] = landing_speed, impulse


@compiled
def one_hop(
    drive: Drive, tau: float, take_off: float, restitution: Restitution
) -> tuple[float, float, float, float, float, float, float, float]:
    """Return span, landing speed, landing phase and rebound of a hop, and four derivatives.

    With the loads n0 at take-off and n1 at the landing, span D, landing speed v and rebound speed
    R(v), the last four numbers are, in this order (theory 13.16),

        d(phase)/d(tau)   = (n0 D - w)/v                 d(phase)/d(w)   = D/v
        d(rebound)/d(tau) = -R' (n0 - n1 d(phase)/d(tau))
        d(rebound)/d(w)   = -R' (1 - n1 d(phase)/d(w))
    """
    span = landing(drive, take_off, tau)
    landing_speed = max(0.0, -rise(drive, take_off, tau, span)[0])
    landing_phase = tau + span
    if landing_speed == 0.0:
        return span, landing_speed, landing_phase, 0.0, 0.0, 0.0, 0.0, 0.0
    n0, n1 = load(drive, tau), load(drive, landing_phase)
    phase_tau, phase_w = (span * n0 - take_off) / landing_speed, span / landing_speed
    # The landing velocity changes by dw + n0 dtau - n1 dphase; the rebound is -R' times that.
    rebound_speed, rebound_slope = rebound(restitution, landing_speed)
    return (
        span, landing_speed, landing_phase, rebound_speed, phase_tau, phase_w,
        -rebound_slope * (n0 - n1 * phase_tau), -rebound_slope * (1 - n1 * phase_w),
    )  # fmt: skip


@compiled
def run_cycle(
    drive: Drive, tau: float, take_off: float, hops: int, restitution: Restitution, rows: Floats
) -> tuple[float, float, float, float, float, float]:
    """Return phase and rebound speed after `hops` hops, NaN after a stay, and four derivatives."""
    m_tt, m_tw, m_wt, m_ww = 1.0, 0.0, 0.0, 1.0
    for hop in range(hops):
        span, landing_speed, landing_phase, rebound_speed, tt, tw, wt, ww = one_hop(
            drive, tau, take_off, restitution
        )
        if span <= 0 or rests(drive, landing_phase, rebound_speed, restitution, SETTLED_EXACTLY):
            return math.nan, 0.0, m_tt, m_tw, m_wt, m_ww
        write_segment(
            rows,
            hop,
            tau % TURN,
            span,
            take_off,
            landing_speed,
            impulse(restitution, landing_speed, rebound_speed),
        )
        # Chain rule: the matrix of this hop times that of all hops before.
        m_tt, m_tw, m_wt, m_ww = (
            tt * m_tt + tw * m_wt,
            tt * m_tw + tw * m_ww,
            wt * m_tt + ww * m_wt,
            wt * m_tw + ww * m_ww,
        )
        tau, take_off = landing_phase, rebound_speed
    return tau, take_off, m_tt, m_tw, m_wt, m_ww


@compiled
def fixed_point(
    drive: Drive,
    phase: float,
    take_off: float,
    hops: int,
    periods: int,
    restitution: Restitution,
    rows: Floats,
) -> tuple[float, float, bool]:
    """Return take-off phase and speed of a cycle of hops, and True if the cycle attracts.

    Newton's iteration is (M - 1) dy = -(y1 - y0), with the state y = (phase, speed) at start and
    end and the derivatives M of `run_cycle`. It attracts if |tr M| < 1 + det M and det M < 1
    (Jury).
    """
    for _ in range(MAX_NEWTON):
        phase_after, take_off_after, m_tt, m_tw, m_wt, m_ww = run_cycle(
            drive, phase, take_off, hops, restitution, rows
        )
        if math.isnan(phase_after):
            break
        phase_change, take_off_change = (
            phase_after - phase - periods * TURN,
            take_off_after - take_off,
        )
        newton_determinant = (m_tt - 1) * (m_ww - 1) - m_tw * m_wt
        if newton_determinant == 0:
            break
        phase_step = (phase_change * (m_ww - 1) - m_tw * take_off_change) / newton_determinant
        take_off_step = ((m_tt - 1) * take_off_change - m_wt * phase_change) / newton_determinant
        phase, take_off = phase - phase_step, max(0.0, take_off - take_off_step)
        if abs(phase_step) + abs(take_off_step) <= 1e-14 * (TURN + drive.push_normal):
            m_determinant = m_tt * m_ww - m_tw * m_wt
            return phase, take_off, abs(m_tt + m_ww) < 1 + m_determinant and m_determinant < 1
    return phase, take_off, False


@compiled
def shortest_part(rows: Floats, hops: int, periods: int) -> int:
    """Return the number of hops after which a cycle of `hops` hops already repeats."""
    for fewer_hops in range(1, hops // 2 + 1):
        if hops % fewer_hops == 0 and periods % (hops // fewer_hops) == 0:
            distance = 0.0  # of the hops to those so many later
            for hop in range(hops - fewer_hops):
                distance += abs(rows[hop + fewer_hops, SEGMENT.phase] - rows[hop, SEGMENT.phase])
                distance += abs(
                    rows[hop + fewer_hops, SEGMENT.take_off] - rows[hop, SEGMENT.take_off]
                )
            if distance < SAME_STATE * hops:
                return fewer_hops
    return hops


@compiled
def find_cycle(
    drive: Drive, restitution: Restitution, rows: Floats, count: int, tau: float, take_off: float
) -> tuple[int, int]:
    """Return hops and periods of an attracting cycle of hops near the last states; (0, 0) if none.

    A search starts where the motion nearly recurs. The cycle must attract, lie near, and be
    approached by the motion; its hops then overwrite the first rows (theory 13.7).
    """
    elapsed, tries = 0.0, 0
    for hops in range(1, min(LONGEST_CYCLE, count) + 1):
        row = rows[count - hops]
        elapsed += row[SEGMENT.span]
        periods = round(elapsed / TURN)
        recurrence = abs(elapsed - periods * TURN) + abs(take_off - row[SEGMENT.take_off])
        if periods < 1 or recurrence > NEAR:
            continue
        tries += 1
        if tries > MAX_TRIES:
            break
        phase, cycle_take_off = tau % TURN, take_off
        start_phase, start_take_off = phase, cycle_take_off
        scratch = rows[count:]
        if scratch.shape[0] < hops:
            return 0, 0
        phase, cycle_take_off, attracts = fixed_point(
            drive, phase, cycle_take_off, hops, periods, restitution, scratch
        )
        distance = abs(phase - start_phase) + abs(cycle_take_off - start_take_off)
        if not attracts or distance > 100 * recurrence + 1e-9:
            continue
        phase_after, take_off_after, _, _, _, _ = run_cycle(
            drive, start_phase, start_take_off, hops, restitution, scratch
        )
        distance_after = abs(phase_after - phase - periods * TURN) + abs(
            take_off_after - cycle_take_off
        )
        if not (distance_after < distance or distance < 1e-9):
            continue
        if math.isnan(run_cycle(drive, phase, cycle_take_off, hops, restitution, scratch)[0]):
            continue
        shortest = shortest_part(scratch, hops, periods)
        for hop in range(shortest):
            for column in range(len(SEGMENT)):
                rows[hop, column] = scratch[hop, column]
        return shortest, periods * shortest // hops
    return 0, 0


@compiled
def normal_cycle(
    drive: Drive,
    start: float,
    restitution: Restitution,
    max_periods: int,
    most_growth: float,
    rows: Floats,
) -> tuple[int, int, int]:
    """Return the cycle normal to the floor into which a part settles from rest at phase `start`.

    Return the index of its first segment, the end, and its periods: 0 if it does not repeat, or
    roundings that grew beyond `most_growth` decide how; -1 if a limit came first (theory 13.7).
    """
    if not lifts(drive):
        write_segment(rows, 0, 0.0, TURN, -1.0, 0.0, 0.0)
        return 0, 1, 1
    tau = lift_off(drive, start)
    take_off, elapsed, count, next_search = 0.0, 0.0, 0, FIRST_LOOK
    uncertainty = CERTAIN
    while count < MAX_SEGMENTS - LONGEST_CYCLE - 2:
        span, landing_speed, landing_phase, rebound_speed, tt, tw, wt, ww = one_hop(
            drive, tau, take_off, restitution
        )
        if span < 0:
            return 0, count, -1
        write_segment(
            rows,
            count,
            tau,
            span,
            take_off,
            landing_speed,
            impulse(restitution, landing_speed, rebound_speed),
        )
        count += 1
        elapsed += span
        if most_growth < math.inf:
            slope = rebound(restitution, landing_speed)[1]
            uncertainty = errors_after_hop(
                uncertainty, span, landing_speed, landing_phase, drive, slope, (tt, tw, wt, ww)
            )
            if not weighted_error(uncertainty, landing_speed, landing_phase, drive) <= most_growth:
                return 0, count, 0
        tau, take_off = landing_phase % TURN, rebound_speed
        if rests(drive, tau, take_off, restitution, SETTLED_EXACTLY):
            # On the floor until lift-off; the cycle is closed if one began there before.
            span = to_lift_off(drive, tau)
            rows[count - 1, SEGMENT.impulse] = landing_speed
            write_segment(rows, count, tau, span, -1.0, 0.0, take_off)
            count += 1
            elapsed += span
            tau, take_off, uncertainty = lift_off(drive, tau), 0.0, CERTAIN
            first = index_of_lift_off(rows, count, tau)
            if first >= 0:
                for row in range(first):
                    elapsed -= rows[row, SEGMENT.span]
                return first, count, round(elapsed / TURN)
        elif count >= next_search and elapsed > TURN:
            next_search = count + count // 2
            hops, periods = find_cycle(drive, restitution, rows, count, tau, take_off)
            if hops:
                return 0, hops, periods
        if count >= SEARCH_HOPS and elapsed > TURN * min(SEARCH_PERIODS, max_periods):
            return 0, count, 0
    return 0, count, (0 if elapsed > TURN * FEWEST_PERIODS else -1)


@compiled
def empty_chain() -> Chain:
    """Return room for the segments of a cell, which are no cell's yet."""
    return Chain(np.empty((MAX_SEGMENTS, len(SEGMENT))), np.full(len(SUMMARY), math.nan))


@compiled
def matches_and_stores(
    stored: Floats, drive: Drive, restitution: Restitution, start: float
) -> bool:
    """True if `stored` has the numbers of a motion normal to the floor; it has them afterwards."""
    normal, load = normal_numbers(drive)
    is_same = True
    for place, number in enumerate(
        (normal, load, restitution.constant, restitution.damping, start)
    ):
        is_same = is_same and stored[place] == number
        stored[place] = number
    return is_same


@compiled
def cached_cycle(
    chain: Chain,
    drive: Drive,
    start: float,
    restitution: Restitution,
    max_periods: int,
    most_growth: float,
) -> tuple[int, int, int]:
    """Return the result of `normal_cycle`, taken over from the last cell if that had the same."""
    summary = chain.summary
    is_same = (
        matches_and_stores(summary, drive, restitution, start)
        and summary[SUMMARY.most] == max_periods
    )
    summary[SUMMARY.most] = max_periods
    if not (is_same and lifts(drive)):
        first, end, periods = normal_cycle(
            drive, start, restitution, max_periods, most_growth, chain.rows
        )
        summary[SUMMARY.first], summary[SUMMARY.end], summary[SUMMARY.periods] = first, end, periods
    return int(summary[SUMMARY.first]), int(summary[SUMMARY.end]), int(summary[SUMMARY.periods])


@compiled
def index_of_lift_off(rows: Floats, count: int, tau: float) -> int:
    """Return the index of an earlier segment that took off from rest at phase `tau`; -1 if none."""
    for row in range(count):
        if rows[row, SEGMENT.take_off] == 0.0:
            phase_distance = abs(rows[row, SEGMENT.phase] - tau)
            if min(phase_distance, TURN - phase_distance) < SAME_LIFT_OFF:
                return row
    return -1


@compiled
def phase_uncertainty(rows: Floats, count: int, drive: Drive, restitution: Restitution) -> float:
    """Return the error in rad by rounding of a cycle's phases, weighted by its effect on the part.

    Errors grow by |M|/min |M| of the matrices of `one_hop` until the part rests; if it never rests,
    at least by (2 + |M|)/|det(M - 1)|.
    """
    push_normal, gravity_normal = drive.push_normal, drive.gravity_normal
    m_tt, m_tw, m_wt, m_ww = 1.0, 0.0, 0.0, 1.0
    least_size, growth, never_rests = 2.0, 1.0, True
    for row in range(count):
        tau, span = rows[row, SEGMENT.phase], rows[row, SEGMENT.span]
        take_off, landing_speed = rows[row, SEGMENT.take_off], rows[row, SEGMENT.landing]
        if take_off < 0 or landing_speed <= 0:
            m_tt, m_tw, m_wt, m_ww, least_size = 1.0, 0.0, 0.0, 1.0, 2.0
            never_rests = never_rests and take_off >= 0
            continue
        load_at_take_off, load_at_landing, slope = (
            load(drive, tau),
            load(drive, tau + span),
            rebound(restitution, landing_speed)[1],
        )
        tt, tw = (span * load_at_take_off - take_off) / landing_speed, span / landing_speed
        wt, ww = (
            -slope * (load_at_take_off - load_at_landing * tt),
            -slope * (1 - load_at_landing * tw),
        )
        m_tt, m_tw, m_wt, m_ww = (
            tt * m_tt + tw * m_wt,
            tt * m_tw + tw * m_ww,
            wt * m_tt + ww * m_wt,
            wt * m_tw + ww * m_ww,
        )
        size = abs(m_tt) + abs(m_tw) + abs(m_wt) + abs(m_ww)
        if not 1e-100 < size < 1e100:
            m_tt, m_tw, m_wt, m_ww, size, least_size = 1.0, 0.0, 0.0, 1.0, 2.0, 2.0
        least_size = min(least_size, size)
        phase_weight = min(
            1.0, (abs(load_at_landing) + landing_speed) / (push_normal + gravity_normal)
        )
        growth = max(growth, 1.0 + (size / least_size - 1.0) * phase_weight)
    rounding = EPSILON * (TURN + push_normal) + soft_hop_errors(rows, count, drive, restitution)[1]
    if never_rests:
        # Of a cycle that has just doubled one half may have been kept: it does not quite close.
        last = count - 1
        cycle_turns = (
            rows[last, SEGMENT.phase] + rows[last, SEGMENT.span] - rows[0, SEGMENT.phase]
        ) / TURN
        closing_error = abs(cycle_turns - round(cycle_turns)) * TURN + abs(
            rebound(restitution, rows[last, SEGMENT.landing])[0] - rows[0, SEGMENT.take_off]
        )
        determinant = abs((m_tt - 1) * (m_ww - 1) - m_tw * m_wt)
        return (rounding + closing_error) * max(
            growth, (2 + abs(m_tt) + abs(m_tw) + abs(m_wt) + abs(m_ww)) / max(1e-9, determinant)
        )
    return rounding * growth
