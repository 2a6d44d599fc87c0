"""Event-driven motion in a vertical plane along the track (theory 13.2 to 13.8), compiled.

Scales: phase tau = w t, lengths g/w^2, velocities g/w, accelerations g. The drive accelerates the
part, in the frame of the track, by (c, s) sin(tau); gravity by -(gs, gn). In every mode the flow is
closed, so a motion is a chain of events: lift-off, landing, stop, start of slip. Each is isolated
on a piece of its flow that bends one way only, where Newton's iteration runs to the root from one
side: none can be missed.

The motion normal to the floor knows nothing of friction. Its attractor is found first, as a chain
of segments (contact, flight) that repeats after whole periods; what is left is a map of one number,
the sliding velocity at the start of the chain, onto itself. Under one coefficient of friction it
never stretches distances, so its fixed point is bracketed by every evaluation.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from core.compiled import compiled
from core.motion.kernels.statuses import (
    APERIODIC,
    AT_REST,
    BACKWARD,
    FLYING,
    FORWARD,
    LIMIT_REACHED,
    NEUTRAL,
    PERIODIC,
    RUNAWAY,
    STICK,
    UNKNOWN,
)  # fmt: skip

TURN = 2 * math.pi
CONTACT, FLIGHT = 0, 1
MOST_SEGMENTS = 8_000  # of a cycle; a run of shrinking hops at restitution 0.995 fills it
MOST_ITERATIONS = 200  # of a bracketed search
MOST_PIECES = 20_000  # of one flow
LAST_STEP = 1e-10  # of Newton's iteration, relative: the next would be of the order of its square
MOST_MODES = 1_000  # stops and starts in one segment
SEARCH_HOPS = 512  # before a motion without contact phase is taken to be aperiodic
SEARCH_PERIODS = 400
FIRST_LOOK = 32  # hops before the first search for a cycle; each later one waits half as long again
MOST_TRIES = 3  # at cycles of different lengths, in one search
MOST_NEWTON = 40  # near a period doubling it closes in by two thirds a step at first
LONGEST_CYCLE = 32  # impacts of a cycle without contact phase
LONGEST_MULTIPLE = 16  # cycles after which a motion under two coefficients may repeat
EPSILON = 2e-15  # rounding of the change over a cycle, per unit of the drive
MOST_UNSURE = 1e-3  # of the drive: a state that rounding leaves less sure is no answer
SAME_STATE = 1e-7  # distance of two states of a cycle that are one
MOST_GROWTH = 1e6  # of a rounding error along a cycle that is taken to repeat
NEAR = 1e-2  # recurrence that a search for a cycle starts from
LEAST_GRAVITY = 1e-12  # onto the floor, of all: less is the rounding of an upright track
SHOWN_PERIODS = 4  # of an aperiodic motion, in its path
PHASES = 8  # runs of an aperiodic motion, started at as many phases
SHARE_SETTLING = 0.2  # of an aperiodic run, before its mean is taken
HOPS_PER_PERIOD = 16  # of an aperiodic run, on average; more end it
FEWEST_PERIODS = 8  # of a run that a limit ended, for its mean to be given as that of the motion
SETTLED = 1e-13  # rebound times remaining time, below which a run of shrinking hops ends
ROUNDING = 4e-14  # of a mean velocity, per unit of the drive and of friction's impulses
SURE = 5.41  # standard deviations of a mean of 8 runs that hold 99.9 % (Student, 7 degrees)
SETTLED_ROUGHLY = 1e-8  # the same in an aperiodic run, whose mean has a spread of 1e-3 at best
SETTLED_TIME = 1e-3  # its remaining time, as a share of the time to lift-off


class Drive(NamedTuple):
    """Drive and gravity along and normal to the floor, and both coefficients of friction."""

    c: float
    s: float
    gs: float
    gn: float
    mu_s: float
    mu_k: float


# --- flows


@compiled
def _arc(d):
    """Return d - sin d and 1 - cos d."""
    if abs(d) > 0.7:
        half = math.sin(d / 2)
        return d - math.sin(d), 2 * half * half
    q = d * d
    cubic = 1 - q / 110 * (1 - q / 156 * (1 - q / 210 * (1 - q / 272)))
    square = 1 - q / 90 * (1 - q / 132 * (1 - q / 182 * (1 - q / 240)))
    return (
        d * q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * cubic))),
        q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * square))),
    )


@compiled
def _flow(v, C, k, sine, cosine, d):
    """Return velocity and distance a phase d after the velocity was v, under C sin(tau) - k.

    `sine` and `cosine` are those of the phase at the start.
    """
    cubic, square = _arc(d)
    velocity = v + C * (cosine * square + sine * (d - cubic)) - k * d
    return velocity, v * d + C * (cosine * cubic + sine * square) - k * d * d / 2


@compiled
def _velocity(v, C, k, tau, d):
    """Return the velocity a phase d after it was v at tau."""
    return _flow(v, C, k, math.sin(tau), math.cos(tau), d)[0]


@compiled
def _distance(v, C, k, tau, d):
    """Return the distance covered in the same time."""
    return _flow(v, C, k, math.sin(tau), math.cos(tau), d)[1]


@compiled
def _ahead(target, tau):
    """Return the phase from tau on to the next `target`, a phase modulo a turn; in [0, 2 pi)."""
    d = (target - tau) % TURN
    # What rounding put a hair before tau is at tau.
    return 0.0 if d > TURN - 1e-12 else d


@compiled
def _arc_sine(value):
    return math.asin(min(1.0, max(-1.0, value)))


# --- flight


@compiled
def _landing_root(w, s, gn, sine, cosine, start):
    """Return the landing time by Newton's iteration from `start`, on its own side of the root."""
    d, first = start, 0.0
    for _ in range(MOST_ITERATIONS):
        slope, height = _flow(w, s, gn, sine, cosine, d)
        if slope >= 0:
            break
        step = height / slope
        d -= step
        first = step if first == 0 else first
        # Each step squares the error; one back across the root is made of rounding alone.
        if abs(step) <= LAST_STEP * d or step * first <= 0:
            break
    return d


@compiled
def _lowest(w, s, gn, tau, low, high):
    """Return where the normal velocity, rising from negative to positive, is zero."""
    d = (low + high) / 2
    for _ in range(MOST_ITERATIONS):
        value = _velocity(w, s, gn, tau, d)
        if value > 0:
            high = d
        else:
            low = d
        slope = s * math.sin(tau + d) - gn
        new = d - value / slope if slope > 0 else low
        if low < new < high and abs(new - d) <= LAST_STEP * d:
            return new
        if not low < new < high:
            new = (low + high) / 2
            if new in (low, high):
                return new
        d = new
    return d


@compiled
def landing(w, s, gn, tau):
    """Return the phase from take-off at tau to landing, for s > gn and w >= 0; -1 if none is found.

    The height bends down where s sin(tau) < gn, and up elsewhere. Where it bends down and ends
    above the floor it was above all the way; where it bends up its least value is found first.
    """
    sine, cosine = math.sin(tau), math.cos(tau)
    up_at = math.asin(gn / s)
    down_at = math.pi - up_at
    bends_up = up_at <= tau % TURN < down_at
    if not bends_up and w > 0:
        # A small hop: twice the parabola's own time is past the landing, or soon will be.
        guess = 2 * w / (gn - s * sine)
        end = _ahead(up_at, tau)
        for _ in range(64):
            if not guess < end:
                break
            if _flow(w, s, gn, sine, cosine, guess)[1] <= 0:
                return _landing_root(w, s, gn, sine, cosine, guess)
            guess *= 2
    # Above a parabola the height is positive whatever the sine does: skip whole turns of that.
    rise = w + s * cosine
    inner = rise * rise - 2 * gn * s * (1 - sine)
    skip_from = skip_to = math.inf
    if inner > 0 and rise > 0:
        skip_to = (rise + math.sqrt(inner)) / gn
        skip_from = 2 * s * (1 - sine) / gn / skip_to
    d, velocity = 0.0, w
    for _ in range(MOST_PIECES):
        if skip_from < d < skip_to - TURN:
            d += TURN * math.floor((skip_to - d) / TURN)
            velocity = _flow(w, s, gn, sine, cosine, d)[0]
        ahead = _ahead(down_at if bends_up else up_at, tau + d)
        end = d + (ahead if ahead > 0 or d == 0 else TURN)
        last, height = _flow(w, s, gn, sine, cosine, end)
        if bends_up:
            if velocity < 0:
                if last > 0:
                    lowest = _lowest(w, s, gn, tau, d, end)
                    height = _flow(w, s, gn, sine, cosine, lowest)[1]
                if height <= 0:
                    return _landing_root(w, s, gn, sine, cosine, d)
        elif last < 0 and height <= 0:
            return _landing_root(w, s, gn, sine, cosine, end)
        d, velocity, bends_up = end, last, not bends_up
    return -1.0


@compiled
def _height(w, s, gn, tau, span, known):
    """Return the largest height of a flight, or `known` if that is larger."""
    if (gn + s) * span * span / 8 <= known:
        return known
    # The height is a parabola and a sine: its top lies near that of the parabola.
    top = (w + s * math.cos(tau)) / gn
    reach = 2 * math.sqrt(s / gn) + 1
    first, last = max(0.0, top - reach), min(span, top + reach)
    pieces = min(MOST_PIECES, max(8, int((last - first) * 4)))
    width = (last - first) / pieces
    best, at = 0.0, first
    for piece in range(pieces + 1):
        height = _distance(w, s, gn, tau, first + width * piece)
        if height > best:
            best, at = height, first + width * piece
    low, high = max(0.0, at - width), min(span, at + width)
    for _ in range(MOST_ITERATIONS):
        velocity = _velocity(w, s, gn, tau, at)
        if velocity > 0:
            low = at
        else:
            high = at
        slope = s * math.sin(tau + at) - gn
        new = at - velocity / slope if slope < 0 else (low + high) / 2
        if not low <= new <= high:
            new = (low + high) / 2
        if abs(new - at) <= 1e-15 * span:
            break
        at = new
    return max(known, _distance(w, s, gn, tau, at))


# --- the motion normal to the floor: a cycle of segments
#
# A segment is a row: phase at its start, its span, the take-off velocity (-1 for contact), speed of
# the landing and its normal impulse.


COLUMNS_OF_ROW = 5
RESULTS = 11  # of a cell: the fields of `Motion`, without the status


@compiled
def _write(rows, row, tau, span, w, speed, impulse):
    """Write a segment."""
    rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4] = (
        tau, span, w, speed, impulse,
    )  # fmt: skip


@compiled
def _hop(tau, w, s, gn, e):
    """Return span, landing speed, phase and rebound after a hop, and the derivatives of the two.

    The last four are d(phase)/d(tau), d(phase)/d(w), d(rebound)/d(tau), d(rebound)/d(w).
    """
    span = landing(w, s, gn, tau)
    speed = max(0.0, -_velocity(w, s, gn, tau, span))
    after = tau + span
    if speed == 0.0:
        return span, speed, after, 0.0, 0.0, 0.0, 0.0, 0.0
    n0, n1 = gn - s * math.sin(tau), gn - s * math.sin(after)
    phase_tau, phase_w = (span * n0 - w) / speed, span / speed
    # The landing velocity changes by dw + n0 dtau - n1 dphase; the rebound is -e times that.
    return (
        span, speed, after, e * speed,
        phase_tau, phase_w, -e * (n0 - n1 * phase_tau), -e * (1 - n1 * phase_w),
    )  # fmt: skip


@compiled
def _rests(tau, w, s, gn, e, up_at, settled):
    """Return whether the part stays on the floor after a landing with rebound w (theory 13.5).

    It does where it does not rebound, and where the hops still to come shrink to nothing within
    less than `settled` of w times their time, and long before lift-off. Their impulses then add up
    to what the floor gives in that time, less w: the last impact is taken as one without rebound,
    and the hops as a stay on the floor. The position is wrong by less than friction times
    `settled`.
    """
    n = gn - s * math.sin(tau)
    if n <= 0:
        return False
    if w == 0:
        return True
    if e >= 1:
        return False
    left = 2 * w / (n * (1 - e))
    return w * left < settled and left < SETTLED_TIME * _ahead(up_at, tau)


@compiled
def _run_cycle(tau, w, hops, s, gn, e, up_at, rows):
    """Return phase, rebound and their four derivatives after some hops; fill `rows`.

    A hop that ends on the floor, or that never ends, gives a phase of NaN.
    """
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    for hop in range(hops):
        span, speed, after, rebound, tt, tw, wt, ww = _hop(tau, w, s, gn, e)
        if span <= 0 or _rests(after, rebound, s, gn, e, up_at, SETTLED):
            return math.nan, 0.0, a, b, c, d
        _write(rows, hop, tau % TURN, span, w, speed, (1 + e) * speed)
        a, b, c, d = tt * a + tw * c, tt * b + tw * d, wt * a + ww * c, wt * b + ww * d
        tau, w = after, rebound
    return tau, w, a, b, c, d


@compiled
def _find_cycle(s, gn, e, up_at, rows, count, tau, w):
    """Return hops and periods of an attracting cycle near the last states; 0, 0 if there is none.

    Fills the first rows with the cycle. Newton's iteration on the map of some hops, from where the
    motion nearly recurs; accepted if it attracts (Jury's criterion) and the motion nears it.
    """
    travelled, tries = 0.0, 0
    for hops in range(1, min(LONGEST_CYCLE, count) + 1):
        row = rows[count - hops]
        travelled += row[1]
        periods = round(travelled / TURN)
        recurrence = abs(travelled - periods * TURN) + abs(w - row[2])
        if periods < 1 or recurrence > NEAR:
            continue
        tries += 1
        if tries > MOST_TRIES:
            break
        at, rebound = tau % TURN, w
        start, start_rebound = at, rebound
        scratch = rows[count:]
        if scratch.shape[0] < hops:
            return 0, 0
        found = False
        attracts = False
        for _ in range(MOST_NEWTON):
            after, rebound_after, a, b, c, d = _run_cycle(
                at, rebound, hops, s, gn, e, up_at, scratch
            )
            if math.isnan(after):
                break
            off, off_rebound = after - at - periods * TURN, rebound_after - rebound
            determinant = (a - 1) * (d - 1) - b * c
            if determinant == 0:
                break
            step = (off * (d - 1) - b * off_rebound) / determinant
            step_rebound = ((a - 1) * off_rebound - c * off) / determinant
            at, rebound = at - step, max(0.0, rebound - step_rebound)
            if abs(step) + abs(step_rebound) <= 1e-14 * (TURN + s):
                found = True
                product = a * d - b * c
                attracts = abs(a + d) < 1 + product and product < 1
                break
        distance = abs(at - start) + abs(rebound - start_rebound)
        if not (found and attracts) or distance > 100 * recurrence + 1e-9:
            continue
        after, rebound_after, a, b, c, d = _run_cycle(
            start, start_rebound, hops, s, gn, e, up_at, scratch
        )
        nearer = abs(after - at - periods * TURN) + abs(rebound_after - rebound)
        if not (nearer < distance or distance < 1e-9):
            continue
        after, rebound_after, a, b, c, d = _run_cycle(at, rebound, hops, s, gn, e, up_at, scratch)
        if math.isnan(after):
            continue
        # The shortest cycle: near a period doubling two hops may be one hop twice.
        shortest = hops
        for part in range(1, hops // 2 + 1):
            if hops % part == 0 and periods % (hops // part) == 0:
                apart = 0.0
                for hop in range(hops - part):
                    apart += abs(scratch[hop + part, 0] - scratch[hop, 0])
                    apart += abs(scratch[hop + part, 2] - scratch[hop, 2])
                if apart < SAME_STATE * hops:
                    shortest = part
                    break
        for hop in range(shortest):
            for column in range(COLUMNS_OF_ROW):
                rows[hop, column] = scratch[hop, column]
        return shortest, periods * shortest // hops
    return 0, 0


@compiled
def normal_cycle(s, gn, e, most_periods, rows):
    """Return the segments and periods of the cycle that the part falls into from rest on the floor.

    Fills `rows`. Periods 0 means that the motion does not repeat, or that rounding decides where it
    does; -1 that a limit came first.
    """
    if s <= gn:
        _write(rows, 0, 0.0, TURN, -1.0, 0.0, 0.0)
        return 1, 1
    up_at = math.asin(gn / s)
    tau, w, total, count, look_at = up_at, 0.0, 0.0, 0, FIRST_LOOK
    a, b, c, d = 1.0, 0.0, 0.0, 1.0  # derivatives of phase and rebound by those at the start
    least, growth = 2.0, 1.0
    while count < MOST_SEGMENTS - LONGEST_CYCLE - 2:
        span, speed, after, rebound, tt, tw, wt, ww = _hop(tau, w, s, gn, e)
        if span < 0:
            return count, -1
        _write(rows, count, tau, span, w, speed, (1 + e) * speed)
        a, b, c, d = tt * a + tw * c, tt * b + tw * d, wt * a + ww * c, wt * b + ww * d
        size = abs(a) + abs(b) + abs(c) + abs(d)
        if not 1e-100 < size < 1e100:
            a, b, c, d, size, least = 1.0, 0.0, 0.0, 1.0, 2.0, 2.0
        least = min(least, size)
        growth = max(growth, size / least)
        count += 1
        total += span
        tau, w = after % TURN, rebound
        if _rests(tau, w, s, gn, e, up_at, SETTLED):
            # On the floor until lift-off, where the motion began: the cycle is closed.
            span = _ahead(up_at, tau)
            rows[count - 1, 4] = speed
            _write(rows, count, tau, span, -1.0, 0.0, 0.0)
            periods = round((total + span) / TURN)
            return count + 1, (periods if periods == 1 or growth < MOST_GROWTH else 0)
        if count >= look_at and total > TURN:
            look_at = count + count // 2
            hops, periods = _find_cycle(s, gn, e, up_at, rows, count, tau, w)
            if hops:
                return hops, periods
        if count >= SEARCH_HOPS and total > TURN * min(SEARCH_PERIODS, most_periods):
            return count, 0
    return count, (0 if total > TURN * FEWEST_PERIODS else -1)


@compiled
def _doubt(rows, count, s, gn, e):
    """Return by how much roundings may move a phase of the cycle.

    They grow along a chain of hops until the part rests on the floor; where it never does, the
    cycle is known the less, the nearer its map is to one that has it twice.
    """
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    least, growth, never_rests = 2.0, 1.0, True
    for row in range(count):
        tau, span, w, speed = rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3]
        if w < 0 or speed <= 0:
            a, b, c, d, least = 1.0, 0.0, 0.0, 1.0, 2.0
            never_rests = never_rests and w >= 0
            continue
        n0, n1 = gn - s * math.sin(tau), gn - s * math.sin(tau + span)
        tt, tw = (span * n0 - w) / speed, span / speed
        wt, ww = -e * (n0 - n1 * tt), -e * (1 - n1 * tw)
        a, b, c, d = tt * a + tw * c, tt * b + tw * d, wt * a + ww * c, wt * b + ww * d
        size = abs(a) + abs(b) + abs(c) + abs(d)
        if not 1e-100 < size < 1e100:
            a, b, c, d, size, least = 1.0, 0.0, 0.0, 1.0, 2.0, 2.0
        least = min(least, size)
        growth = max(growth, size / least)
    rounding = EPSILON * (TURN + s)
    if never_rests:
        # Of a cycle that has just doubled one half may have been kept: it does not quite close.
        last = count - 1
        apart = (rows[last, 0] + rows[last, 1] - rows[0, 0]) / TURN
        open_by = abs(apart - round(apart)) * TURN + abs(e * rows[last, 3] - rows[0, 2])
        determinant = abs((a - 1) * (d - 1) - b * c)
        return (rounding + open_by) * max(
            growth, (2 + abs(a) + abs(b) + abs(c) + abs(d)) / max(1e-9, determinant)
        )
    return rounding * growth


# --- the motion along the track


@compiled
def _next(target, at):
    """Return the first phase from `at` on that is `target` modulo a turn.

    It is the same number whatever `at` was, so that a motion which sticks repeats to the last bit.
    """
    return max(at, target + TURN * math.ceil((at - target) / TURN - 1e-13))


@compiled
def _stop(v, C, k, at, span):
    """Return the phase until the velocity v >= 0 under C sin - k is zero; -1 if not within span."""
    if C < 0:
        C, at = -C, at + math.pi
    if k <= -C:
        return -1.0
    sine, cosine = math.sin(at), math.cos(at)
    if k >= C:
        low, high = 0.0, span
        if v == 0 or _flow(v, C, k, sine, cosine, high)[0] > 0:
            return -1.0
    else:
        rise_at = math.asin(k / C)
        fall_at = math.pi - rise_at
        low = 0.0
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        if v == 0 or rise_at <= at % TURN < fall_at:
            low = _ahead(fall_at, at)
        high = span
        for _ in range(MOST_PIECES):
            if low >= span:
                return -1.0
            ahead = _ahead(rise_at, at + low)
            high = min(span, low + (ahead if ahead > 0 else TURN))
            if _flow(v, C, k, sine, cosine, high)[0] <= 0:
                break
            low = high + fall_at - rise_at
    first, last = _flow(v, C, k, sine, cosine, low)[0], _flow(v, C, k, sine, cosine, high)[0]
    d = low + (high - low) * first / (first - last) if first > last else low
    for _ in range(MOST_ITERATIONS):
        value = _flow(v, C, k, sine, cosine, d)[0]
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
def _stick_range(c, s, gs, gn, mu_s):
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
def _log(log, used, at, span, mode, u, w, x):
    """Write one piece of the motion into the log, if there is one and it has room."""
    if used < log.shape[0]:
        log[used, 0], log[used, 1], log[used, 2] = at, span, mode
        log[used, 3], log[used, 4], log[used, 5] = u, w, x
        return used + 1
    return used


@compiled
def _contact(tau, span, u, drive, sums, log, used):
    """Return velocity and its derivative after a stretch on the floor; add to `sums` and `log`.

    `sums` holds the distance and the times in the four modes. The last value returned is the number
    of rows of the log in use, -1 if the stretch held too many stops.
    """
    c, s, gs, gn, mu_s, mu_k = drive
    least, largest, way = _stick_range(c, s, gs, gn, mu_s)
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
                    leave = min(leave, _next(math.asin(largest), at))
                    forward = way > 0
                if -1 < least < 1:
                    fall = _next(math.pi - math.asin(least), at)
                    if fall < leave:
                        leave, forward = fall, False
                used = _log(log, used, at, leave - at, STICK, 0.0, 0.0, sums[0])
                sums[1 + STICK] += leave - at
                if leave >= end:
                    return 0.0, slope, used
                at = leave
            sign = 1.0 if forward else -1.0
        else:
            sign = 1.0 if u > 0 else -1.0
        C, k = c + sign * mu_k * s, gs + sign * mu_k * gn
        stop = _stop(abs(u), sign * C, sign * k, at, end - at)
        d = end - at if stop < 0 else stop
        mode = FORWARD if sign > 0 else BACKWARD
        used = _log(log, used, at, d, mode, u, 0.0, sums[0])
        after, distance = _flow(u, C, k, math.sin(at), math.cos(at), d)
        sums[0] += distance
        sums[1 + mode] += d
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
def _pass(rows, count, u, drive, sums, log):
    """Return velocity and its derivative after one cycle, from velocity u at its start.

    Fills `sums`; the last value is the number of rows of the log in use, -1 if a limit came first.
    """
    c, gs, mu_k = drive.c, drive.gs, drive.mu_k
    sums[:] = 0.0
    slope, used = 1.0, 0
    for row in range(count):
        tau, span, w = rows[row, 0], rows[row, 1], rows[row, 2]
        if w < 0:
            u, factor, used = _contact(tau, span, u, drive, sums, log, used)
            if used < 0:
                return u, slope, used
            slope *= factor
            continue
        used = _log(log, used, tau, span, FLYING, u, w, sums[0])
        u, distance = _flow(u, c, gs, math.sin(tau), math.cos(tau), span)
        sums[0] += distance
        sums[1 + FLYING] += span
        friction = mu_k * rows[row, 4]
        if abs(u) <= friction:
            u = 0.0
            slope = 0.0 if friction > 0 else slope
        else:
            u -= friction if u > 0 else -friction
    return u, slope, used


@compiled
def _settle(rows, count, u, drive, tolerance, most_periods, sums, log):
    """Return the velocity at the start of the cycle once the motion repeats.

    Returns
    -------
    tuple
        Velocity, estimate of its error, cycles after which it repeats (0: not found), status.
    """
    if drive.mu_s == drive.mu_k:
        return _settle_bracketed(rows, count, u, drive, tolerance, sums, log)
    return _settle_followed(rows, count, u, drive, tolerance, most_periods, sums, log)


@compiled
def _settle_bracketed(rows, count, u, drive, tolerance, sums, log):
    """Return the fixed point of the map of one cycle where one coefficient of friction serves.

    Coulomb friction never drives two motions under the same normal force apart: the map is
    increasing and stretches nothing, so that the change over a cycle falls with the velocity.
    """
    scale = abs(drive.c) + abs(drive.gs)
    low, high, stride = -math.inf, math.inf, 1.0
    for _ in range(MOST_ITERATIONS):
        after, slope, used = _pass(rows, count, u, drive, sums, log)
        if used < 0:
            return u, math.inf, 0, LIMIT_REACHED
        change = after - u
        error = abs(change) / max(1e-300, 1 - slope) if slope < 1 else math.inf
        # The change is known but for rounding; the state the less, the nearer the slope is to 1.
        unsure = EPSILON * scale / max(1e-300, 1 - slope) if slope < 1 else math.inf
        if (change == 0 or error <= tolerance * scale) and unsure <= MOST_UNSURE * scale:
            return u, error + unsure, 1, PERIODIC
        if abs(change) <= EPSILON * scale and unsure > MOST_UNSURE * scale:
            return u, unsure, 0, LIMIT_REACHED
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
            sure = unsure <= MOST_UNSURE * scale
            return u, abs(change) + unsure, 1 if sure else 0, PERIODIC if sure else LIMIT_REACHED
        u = new
    return u, abs(change), 0, LIMIT_REACHED


@compiled
def _settle_followed(rows, count, u, drive, tolerance, most_periods, sums, log):
    """Return a periodic state by following the motion, where static friction is the larger.

    Sticking motions may then lie beside sliding ones, and which is reached depends on the start.
    """
    c, gs, gn, mu_k = drive.c, drive.gs, drive.gn, drive.mu_k
    scale = abs(c) + abs(gs)
    states = np.empty(LONGEST_MULTIPLE + 1)
    slopes = np.empty(LONGEST_MULTIPLE + 1)
    downhill = mu_k * gn < abs(gs)
    for cycle in range(max(8, most_periods)):
        after, slope, used = _pass(rows, count, u, drive, sums, log)
        if used < 0:
            return u, math.inf, 0, LIMIT_REACHED
        uphill = sums[1 + (FORWARD if gs > 0 else BACKWARD)]
        slid_down = slope == 1 and uphill == 0 and sums[1 + STICK] == 0
        if downhill and slid_down and (after - u) * gs < 0 and u * gs < 0 and after * gs < 0:
            # It slid downhill all cycle long and gained speed: so it will in every cycle to come.
            return u, math.inf, 0, RUNAWAY
        known = min(cycle, LONGEST_MULTIPLE)
        for back in range(known, 0, -1):
            states[back] = states[back - 1]
            slopes[back] = slopes[back - 1] * slope
        states[0], slopes[0] = u, slope
        for multiple in range(1, known + 2):
            earlier, factor = states[multiple - 1], abs(slopes[multiple - 1])
            error = abs(after - earlier) / max(1e-300, 1 - factor) if factor < 1 else math.inf
            unsure = EPSILON * scale / max(1e-300, 1 - factor) if factor < 1 else math.inf
            if after == earlier and unsure <= MOST_UNSURE * scale:
                return after, unsure, multiple, PERIODIC
            if error <= tolerance * scale and unsure <= MOST_UNSURE * scale:
                return after, error + unsure, multiple, PERIODIC
        change = after - u
        guess = u + change / (1 - slope) if 0 < slope < 1 else after
        if slope > 0.5 and guess * after > 0:
            # Slow convergence: try the fixed point of the tangent. It is kept if it is nearer, and
            # if the motion would drift there: no stick and no turning back on the way.
            beyond, _, used = _pass(rows, count, guess, drive, sums, log)
            nearer = used >= 0 and abs(beyond - guess) < 0.1 * abs(change)
            for part in range(1, 4):
                if nearer:
                    between = after + (guess - after) * part / 4
                    moved, factor, used = _pass(rows, count, between, drive, sums, log)
                    nearer = used >= 0 and factor > 0 and (moved - between) * change > 0
            if nearer:
                after = guess
        u = after
    return u, math.inf, 0, LIMIT_REACHED


@compiled
def _two_sided(drive):
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


@compiled
def _long_run(tau, periods, hops, drive, e, guess, sums):
    """Run from rest on the floor at tau; fill `sums`.

    The first part of the run is dropped. `sums` is as in `_contact`.

    Returns
    -------
    tuple
        Time, 0 if the hops allowed did not reach beyond the first part; impacts, largest landing
        speed and height; how far the part strayed from a steady travel at the velocity `guess`;
        and whether it slid downhill all the time, gaining speed.
    """
    c, s, gs, gn, mu_k = drive.c, drive.s, drive.gs, drive.gn, drive.mu_k
    up_at = math.asin(gn / s)
    no_log = np.empty((0, 6))
    settling = periods * SHARE_SETTLING * TURN
    total, began, impacts, fastest, highest = 0.0, math.inf, 0, 0.0, 0.0
    settling_hops = int(hops * SHARE_SETTLING)
    sums[:] = 0.0
    u, w = 0.0, 0.0
    ahead, behind = 0.0, 0.0
    u_began, slips_down = 0.0, mu_k * gn < abs(gs)
    if s * math.sin(tau) < gn:
        span = _ahead(up_at, tau)
        u = _contact(tau, span, u, drive, sums, no_log, 0)[0]
        tau, total = up_at, span
    for hop in range(hops):
        if began == math.inf and (total >= settling or hop >= settling_hops):
            began, impacts, fastest, highest = total, 0, 0.0, 0.0
            sums[:] = 0.0
            u_began = u
        if total - began >= periods * TURN - settling:
            break
        span = landing(w, s, gn, tau)
        if span < 0:
            break
        speed = max(0.0, -_velocity(w, s, gn, tau, span))
        if began < math.inf:
            highest = _height(w, s, gn, tau, span, highest)
        u, distance = _flow(u, c, gs, math.sin(tau), math.cos(tau), span)
        sums[0] += distance
        sums[1 + FLYING] += span
        impacts, fastest = impacts + 1, max(fastest, speed)
        total += span
        tau, w = (tau + span) % TURN, e * speed
        stays = _rests(tau, w, s, gn, e, up_at, SETTLED_ROUGHLY)
        friction = mu_k * (speed if stays else speed + w)
        u = 0.0 if abs(u) <= friction else u - (friction if u > 0 else -friction)
        if stays:
            span = _ahead(up_at, tau)
            u = _contact(tau, span, u, drive, sums, no_log, 0)[0]
            tau, w, total = up_at, 0.0, total + span
        if began < math.inf:
            strayed = sums[0] - guess * (total - began)
            ahead, behind = max(ahead, strayed), min(behind, strayed)
            slips_down = slips_down and u * gs < 0
    uphill = sums[1 + (FORWARD if gs > 0 else BACKWARD)] + sums[1 + STICK]
    runs_away = slips_down and uphill == 0 and abs(u) > abs(u_began)
    return max(0.0, total - began), impacts, fastest, highest, ahead - behind, runs_away


@compiled
def _from_phases(phase, drive, e, most_periods, result):
    """Fill the result of an aperiodic motion: means over runs from several phases; return a status.

    The error of the mean is of two kinds: the scatter of the runs, and what all have alike, since
    each ends somewhere in a motion that may nearly repeat. Of the second the runs tell nothing; it
    is at most how far a part strays from a steady travel, over the time.
    """
    sums = np.empty(5)
    periods = max(1, most_periods // PHASES)
    mean, square, time, impacts, fastest, highest = 0.0, 0.0, 0.0, 0, 0.0, 0.0
    shares = np.zeros(4)
    common, away = 0.0, 0
    for run in range(PHASES):
        start = (phase + TURN * run / PHASES) % TURN
        span, hits, speed, height, strayed, runs_away = _long_run(
            start, periods, HOPS_PER_PERIOD * periods + FIRST_LOOK, drive, e, mean, sums
        )
        if span <= 0:
            return LIMIT_REACHED
        away += 1 if runs_away else 0
        if run > 0:  # the first has no velocity to stray from
            common = max(common, strayed / span)
        velocity = sums[0] / span
        deviation = velocity - mean
        mean += deviation / (run + 1)
        square += deviation * (velocity - mean)
        time, impacts = time + span, impacts + hits
        fastest, highest = max(fastest, speed), max(highest, height)
        for mode in range(4):
            shares[mode] += sums[1 + mode]
    if away == PHASES:
        return RUNAWAY
    spread = math.sqrt(square / (PHASES - 1))
    result[0], result[1] = mean, spread
    result[2] = SURE * spread / math.sqrt(PHASES) + common
    for mode in range(4):
        result[3 + mode] = shares[mode] / time
    result[7], result[8], result[9], result[10] = impacts * TURN / time, fastest, highest, 0.0
    return APERIODIC


@compiled
def _start(drive, phase, rows, count):
    """Return the velocity at the start of a cycle of a part at rest on the floor at `phase`.

    Where it never lifts off the cycle may start anywhere: it is moved to where slip begins.
    """
    c, s, gs, gn, mu_s = drive.c, drive.s, drive.gs, drive.gn, drive.mu_s
    if mu_s == 0 and gs == 0:  # nothing acts along the track but the drive
        return c * (math.cos(phase) - math.cos(rows[0, 0]))
    if s > gn:
        sums = np.zeros(5)
        # A part that lifts off starts on the floor, at least at the drive's own zero.
        span = _ahead(math.asin(gn / s), phase)
        u = _contact(phase, span, 0.0, drive, sums, np.empty((0, 6)), 0)[0]
        if rows[count - 1, 2] >= 0:
            # A cycle without contact: friction brings any velocity to the same motion.
            return 0.0
        return u
    least, largest, _ = _stick_range(c, s, gs, gn, mu_s)
    rises, falls = largest < 1, least > -1
    if rises and (math.cos(phase) > 0 or not falls):
        rows[0, 0] = _arc_sine(largest)
    elif falls:
        rows[0, 0] = math.pi - _arc_sine(least)
    return 0.0


@compiled
def _solve(group, rows, sums, log, result):
    """Fill `result`, one value a field of `Motion`; return status, segments, velocity, cycles, log.

    `rows` then holds the cycle and the log its last pass, in the axes of the drive as mirrored by
    `_upright`.
    """
    c, s, gs, phase, way = _upright(group[0], group[1], group[2])
    gn, mu_s, mu_k, e = group[3], group[4], group[5], group[6]
    tolerance, most_periods = group[7], int(group[8])
    drive = Drive(c, s, gs, gn, mu_s, mu_k)
    result[:] = math.nan
    if not math.isfinite(c + s + gs + gn + mu_s + mu_k + e):
        return LIMIT_REACHED, 0, 0.0, 0
    if abs(gs) > mu_s * gn:
        # Friction gives no more than mu_s times the mean normal force, which is gravity's.
        return RUNAWAY, 0, 0.0, 0
    if gn <= LEAST_GRAVITY:
        return LIMIT_REACHED, 0, 0.0, 0
    least, largest, _ = _stick_range(c, s, gs, gn, mu_s)
    if s <= gn and least <= -1 and largest >= 1:
        result[:] = 0.0
        result[3], result[10] = 1.0, 1.0
        return AT_REST, 0, 0.0, 1
    if gs != 0 and abs(abs(gs) - mu_k * gn) <= 4e-16 * abs(gs):
        # Kinetic friction just balances gravity: the mean is that of the start, for ever.
        return LIMIT_REACHED, 0, 0.0, 0
    velocity, forward = _two_sided(drive)
    if forward > 0 and log.shape[0] == 0:
        result[:] = 0.0
        result[0] = way * velocity
        result[2] = ROUNDING * (abs(c) + abs(gs) + mu_k * (s + gn))
        result[4], result[5] = (forward, 1 - forward) if way > 0 else (1 - forward, forward)
        result[10] = 1.0
        return PERIODIC, 0, 0.0, 1
    count, periods = normal_cycle(s, gn, e, most_periods, rows)
    if periods < 1:
        status = LIMIT_REACHED
        if periods == 0:
            status = _from_phases(phase, drive, e, most_periods, result)
        if status == APERIODIC:
            _turn_round(result, way)
        else:
            result[:] = math.nan
        return status, 0, 0.0, 0
    u = _start(drive, phase, rows, count)
    error, cycles, status = 0.0, 1, NEUTRAL
    if mu_s == 0:
        # Without friction, and as it does not run away on the level, the part keeps the speed that
        # the track had at the start: the fastest forward, or backward half a turn later.
        flying = 0.0
        for row in range(count):
            flying += rows[row, 1] if rows[row, 2] >= 0 else 0.0
        sums[:] = 0.0
        sums[0] = c * math.cos(phase) * periods * TURN
        sums[1 + (FORWARD if math.cos(phase) > 0 else BACKWARD)] = periods * TURN - flying
        sums[1 + FLYING] = flying
    else:
        u, error, cycles, status = _settle(
            rows, count, u, drive, tolerance, most_periods, sums, log
        )
        if cycles == 0:
            return status, 0, 0.0, 0
    if mu_s != mu_k:
        total = np.zeros(5)
        velocity = u
        for _ in range(cycles):
            velocity, _, _ = _pass(rows, count, velocity, drive, sums, log)
            total += sums
        sums[:] = total
    time = periods * cycles * TURN
    result[0], result[1] = sums[0] / time, 0.0
    doubt = ROUNDING + (_doubt(rows, count, s, gn, e) if s > gn else 0.0)
    result[2] = error + doubt * (abs(c) + abs(gs) + mu_k * (s + gn))
    for mode in range(4):
        result[3 + mode] = sums[1 + mode] / time
    impacts, fastest, highest = 0, 0.0, 0.0
    for row in range(count):
        if rows[row, 2] >= 0:
            impacts += 1
            fastest = max(fastest, rows[row, 3])
            highest = _height(rows[row, 2], s, gn, rows[row, 0], rows[row, 1], highest)
    result[7], result[8], result[9] = impacts / periods, fastest, highest
    result[10] = float(periods * cycles)
    _turn_round(result, way)
    return status, count, u, cycles


@compiled
def _upright(c, s, gs):
    """Return the drive and gravity along the track with c and s positive, phase and way.

    A drive that points down pushes up half a turn later; one that points back is the mirror image.
    `phase` is where the study's own phase 0 lies, `way` is -1 in the mirror.
    """
    phase, way = 0.0, 1.0
    if s < 0:
        c, s, phase = -c, -s, math.pi
    if c < 0:
        c, gs, way = -c, -gs, -1.0
    return c, s, gs, phase, way


@compiled
def _turn_round(result, way):
    """Undo the mirror image of `_upright`."""
    if way < 0:
        result[0] = -result[0]
        result[4], result[5] = result[5], result[4]


@compiled
def solve_cells(groups, table, status):
    """Fill table and status of cells.

    `groups` holds (c, s, gs, gn, mu_s, mu_k, restitution, tolerance, most periods).
    """
    rows = np.empty((MOST_SEGMENTS, COLUMNS_OF_ROW))
    sums = np.empty(5)
    log = np.empty((0, 6))
    for cell in range(groups.shape[0]):
        status[cell] = _solve(groups[cell], rows, sums, log, table[cell])[0]


# --- the path of one part


def follow(group):
    """Return the pieces of the cycle of one cell, the phase shift and the way of `_upright`.

    The last value tells whether the motion repeats after them. A piece is a row of the log: phase,
    span, mode, velocity along and normal, position.
    """
    rows = np.empty((MOST_SEGMENTS, COLUMNS_OF_ROW))
    sums = np.empty(5)
    log = np.empty((4 * MOST_SEGMENTS, 6))
    result = np.empty(RESULTS)
    log[:, 1] = -1.0
    c, s, gs, phase, way = _upright(group[0], group[1], group[2])
    status, count, u, _ = _solve(group, rows, sums, log, result)
    gn, mu_s, mu_k, e = group[3], group[4], group[5], group[6]
    drive = Drive(c, s, gs, gn, mu_s, mu_k)
    if status == AT_REST:
        log[0] = 0.0, TURN, STICK, 0.0, 0.0, 0.0
        used, status, count = 1, PERIODIC, 1
    elif count > 0:
        _, _, used = _pass(rows, count, u, drive, sums, log)
    elif status in (APERIODIC, LIMIT_REACHED) and s > gn:
        count, _ = normal_cycle(s, gn, e, int(group[8]), rows)
        shown, span = 0, 0.0
        while shown < count and span < SHOWN_PERIODS * TURN:
            shown += 1
            span += rows[count - shown, 1]
        start = _start(drive, phase, rows, count)
        u, _, _ = _pass(rows, count - shown, start, drive, sums, log[:0])
        _, _, used = _pass(rows[count - shown :], shown, u, drive, sums, log)
    else:
        used = 0
    return log[: max(0, used)].copy(), phase, way, count > 0 and status == PERIODIC


def sample(pieces, group, shift, phases, repeats):
    """Return position, height, velocities and mode at phases since the start of the cycle.

    The columns of the result, shape (n, 5). NaN and mode `unknown` where there is no cycle, and
    beyond the end of pieces after which the motion does not repeat.
    """
    samples = np.full((phases.size, 5), math.nan)
    samples[:, 4] = UNKNOWN
    if not pieces.size:
        return samples
    c, s, gs, _, _ = _upright(group[0], group[1], group[2])
    gn, mu_k = group[3], group[5]
    ends = np.cumsum(pieces[:, 1])
    length = ends[-1]
    covered = _at_piece(pieces[-1], pieces[-1, 1], c, s, gs, gn, mu_k)[0]
    # The cycle is laid out from where the study's own period starts.
    offset = (shift - pieces[0, 0]) % TURN
    before = None
    for number, phase in enumerate(phases):
        if not repeats and phase + offset > length:
            break
        turns, within = divmod(phase + offset, length)
        piece = min(int(np.searchsorted(ends, within, side="right")), len(pieces) - 1)
        since = within - (ends[piece] - pieces[piece, 1])
        values = _at_piece(pieces[piece], since, c, s, gs, gn, mu_k)
        along = values[0] + turns * covered
        before = along if before is None else before
        samples[number] = along - before, *values[1:], pieces[piece, 2]
    return samples


def _at_piece(piece, since, c, s, gs, gn, mu_k):
    """Return position, height and velocities some phase after a piece began."""
    tau, _, mode, u, w, x = piece
    if mode == STICK:
        return x, 0.0, 0.0, 0.0
    if mode == FLYING:
        return (
            x + _distance(u, c, gs, tau, since), max(0.0, _distance(w, s, gn, tau, since)),
            _velocity(u, c, gs, tau, since), _velocity(w, s, gn, tau, since),
        )  # fmt: skip
    sign = 1.0 if mode == FORWARD else -1.0
    C, k = c + sign * mu_k * s, gs + sign * mu_k * gn
    return x + _distance(u, C, k, tau, since), 0.0, _velocity(u, C, k, tau, since), 0.0
