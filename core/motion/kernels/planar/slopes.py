"""Derivatives carried from event to event along a cycle, under a sine (theory 13.16).

The phase of an event moves with a parameter by -(what changes of its condition at a fixed phase)
over the rate of the condition. `nearest` holds the least distance of a decision on the way from
its other outcome, relative: where it is next to nothing the motion has a kink or a jump.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from core.compiled import borrowing
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.drive import (
    fly,
    hold,
    load,
    rise,
    slide,
    slip_acceleration,
    stop_after,
)
from core.motion.kernels.planar.flow import TURN, SineDrive, flow, phase_to, swings
from core.motion.kernels.planar.sine_flight import lowest_at, top_at
from core.motion.kernels.planar.slide import MAX_MODES, skids
from core.motion.kernels.planar.slope_tables import BY, ROW
from core.motion.kernels.planar.tables import SEGMENT
from core.motion.kernels.quadrature import NODES, WEIGHTS
from core.motion.kernels.statuses import MODE

SMOOTH = 1.5  # longest phase in rad over which Gauss's rule is used at once
SMALL_REBOUND = 1e-6  # in g/w: below it the load at a landing decides if the part stays


@borrowing
def copy_row(d: Floats, to: int, of: int) -> None:
    """Copy row `of` of the derivatives to row `to`; a slice assignment would allocate an array."""
    for i in range(d.shape[1]):
        d[to, i] = d[of, i]


@borrowing
def force(drive: SineDrive, sign: float, at: float, span: float, d: Floats) -> None:
    """Fill the derivatives of velocity and distance along by the parameters, at a fixed phase.

    Rows `forced` and `path` of `d`: C. swing - k. D and C. sway - k. D^2/2 over the phase D =
    `span` from `at` on, with the derivatives C. and k. of C = c +- mu_k s and k = sin(gamma) +-
    mu_k n, and the integrals swing, sway of `swings`. `sign` is 1 for a slip forward, -1 backward,
    0 for a flight (theory 13.16).
    """
    swing, sway = swings(math.sin(at), math.cos(at), span)
    half = span * span / 2
    d[ROW.forced, :], d[ROW.path, :] = 0.0, 0.0
    d[ROW.forced, BY.c], d[ROW.path, BY.c] = swing, sway
    d[ROW.forced, BY.gs], d[ROW.path, BY.gs] = -span, -half
    if sign != 0:
        mu = sign * drive.mu_k
        d[ROW.forced, BY.s], d[ROW.path, BY.s] = mu * swing, mu * sway
        d[ROW.forced, BY.gn], d[ROW.path, BY.gn] = -mu * span, -mu * half
        d[ROW.forced, BY.mu_k] = sign * (drive.s * swing - drive.gn * span)
        d[ROW.path, BY.mu_k] = sign * (drive.s * sway - drive.gn * half)


@borrowing
def along(
    drive: SineDrive, sign: float, u: float, after: float, at: float, span: float, stops: bool,
    mode: int, size: int, d: Floats,
) -> None:  # fmt: skip
    """Propagate derivatives along the track through a slip or flight that ends in a stop or event.

    A dot is a derivative by a parameter. With delta u0 = u0. - u'(tau0) tau0. it ends with u1. =
    delta u + u'(tau1) tau1., or with 0 at a stop, which moves by tau1. = -delta u/u'(tau1); x1. -
    x0. = delta x + u1 tau1. - u0 tau0. (theory 13.16).

    Parameters
    ----------
    sign, mode
        Slip direction 1 or -1, 0 for a flight; and the mode whose time is counted.
    u, after
        Velocities along at the start and end, in g/w (w = 2 pi f).
    at, span
        Phase at the start and duration, in rad.
    stops
        If the slip ends in a stop; else row `end` of `d` holds the end's derivatives.
    size
        Number of directions, the columns of `d` in use.
    d
        Derivatives, a row a quantity (`ROW`), a column a direction (`BY`).
    """
    first = slip_acceleration(drive, sign, at)
    last = slip_acceleration(drive, sign, at + span)
    force(drive, sign, at, span, d)
    for i in range(size):
        begin = d[ROW.along, i] - first * d[ROW.phase, i]
        change = begin + d[ROW.forced, i]
        end = -change / last if stops else d[ROW.end, i]
        d[ROW.begin, i] = begin
        d[ROW.distance, i] += begin * span + d[ROW.path, i] - u * d[ROW.phase, i]
        d[ROW.distance, i] += after * end
        d[ROW.stick + mode, i] += end - d[ROW.phase, i]
        d[ROW.along, i] = 0.0 if stops else change + last * end
        if sign != 0:
            rub = drive.mu_k * sign
            d[ROW.friction, i] += rub * load(drive, at + span) * after * end
            d[ROW.friction, i] -= rub * load(drive, at) * u * d[ROW.phase, i]
        d[ROW.phase, i] = end


@borrowing
def rub(
    drive: SineDrive, sign: float, u: float, at: float, span: float, size: int, d: Floats
) -> None:
    """Add the derivatives of friction work over a slip at fixed phases; call it after `along`.

    Those of the integral of mu_k n |u| over the phase, with the load n = n0 - s sin(tau), by
    Gauss's rule. The slip goes in direction `sign` (1 or -1), from velocity `u` at phase `at` over
    `span` rad; `d` holds the derivatives, in `size` directions (theory 13.15).
    """
    loads = swung = spans = rubs = slips = waves = 0.0
    C, k = drive.c + sign * drive.mu_k * drive.s, drive.gs + sign * drive.mu_k * drive.gn
    sine, cosine = math.sin(at), math.cos(at)
    done = 0.0
    while done < span:
        half = 0.5 * min(SMOOTH, span - done)
        for place, weight in zip(NODES, WEIGHTS):  # noqa: B905 # numba knows no strict
            for side in (-place, place):
                since = done + half * (1.0 + side)
                swing, _ = swings(sine, cosine, since)
                velocity, push = u + C * swing - k * since, math.sin(at + since)
                share, given = half * weight, drive.gn - drive.s * push
                loads += share * given
                swung += share * given * swing
                spans += share * given * since
                rubs += share * given * velocity
                slips += share * velocity
                waves += share * push * velocity
        done += 2.0 * half
    mu = drive.mu_k * sign
    for i in range(size):
        d[ROW.friction, i] += mu * loads * d[ROW.begin, i]
    d[ROW.friction, BY.c] += mu * swung
    d[ROW.friction, BY.gs] -= mu * spans
    d[ROW.friction, BY.s] += mu * (mu * swung - waves)
    d[ROW.friction, BY.gn] += mu * (slips - mu * spans)
    d[ROW.friction, BY.mu_k] += sign * (rubs + mu * (drive.s * swung - drive.gn * spans))


@borrowing
def release(drive: SineDrive, by_least: bool, way: float, leave: float, d: Floats) -> None:
    """Fill the derivative of the phase at which static friction lets go, sin(tau) = S.

    Into row `phase` of `d`: tau. = S./cos(tau) with S = (sin(gamma) +- mu_s n)/(c +- mu_s s), minus
    signs if `by_least` (the lower bound of sin(tau)) or `way` < 0; `leave` is that phase.
    """
    c, s, mu, gn = drive.c, drive.s, drive.mu_s, drive.gn
    rate = math.cos(leave)
    # The threshold is (gs + sign mu gn)/(c + sign mu s).
    sign = -1.0 if by_least or way < 0 else 1.0
    below = (c + sign * mu * s) * rate
    sine = math.sin(leave)
    d[ROW.phase, :] = 0.0
    d[ROW.phase, BY.c] = -sine / below
    d[ROW.phase, BY.s] = -sine * sign * mu / below
    d[ROW.phase, BY.gs] = 1.0 / below
    d[ROW.phase, BY.gn] = sign * mu / below
    d[ROW.phase, BY.mu_s] = sign * (gn - s * sine) / below


@borrowing
def lift(drive: SineDrive, row: int, d: Floats) -> None:
    """Fill the derivative of the lift-off phase by the parameters into row `row` of `d`.

    tau. = (n. - s. sin(tau))/(s cos(tau)), from s sin(tau) = n.
    """
    sine = drive.gn / drive.s
    rate = drive.s * math.sqrt((1.0 - sine) * (1.0 + sine))
    d[row, :] = 0.0
    d[row, BY.gn], d[row, BY.s] = 1.0 / rate, -sine / rate


@borrowing
def slow_passage(drive: SineDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the relative distance of a slip from a stop on its way: least speed over its scale.

    The slip goes in direction `sign`, from velocity `u` at phase `at` over `span` rad. Its speed is
    least at asin(k/C), where it ceases to fall; the scale is |C| + |k|, with u' = C sin(tau) - k.
    Next to 0 the motion has a kink or jump.
    """
    C, k = sign * drive.c + drive.mu_k * drive.s, sign * drive.gs + drive.mu_k * drive.gn
    if C < 0:
        C, at = -C, at + math.pi
    if not abs(k) < C:
        return 1.0
    least, since = 1.0, phase_to(math.asin(k / C), at)
    sine, cosine = math.sin(at), math.cos(at)
    while 0.0 < since < span:
        least = min(least, abs(flow(abs(u), C, k, sine, cosine, since)[0]) / (C + abs(k)))
        since += TURN
    return least


@borrowing
def low_passage(drive: SineDrive, w: float, at: float, span: float) -> float:
    """Return the relative distance of a flight from touching the floor on its way.

    The least height |z| at `lowest_at` over s + n; the part takes off at phase `at` with velocity
    `w` and flies for `span` rad. Next to 0 the motion has a jump.
    """
    s, gn = drive.s, drive.gn
    least, since = 1.0, phase_to(drive.up_at, at)
    up = math.pi - 2.0 * drive.up_at
    while since + up < span:
        if since > 0.0 and rise(drive, w, at, since)[0] < 0 < rise(drive, w, at, since + up)[0]:
            low = lowest_at(w, s, gn, at, since, since + up)
            least = min(least, abs(rise(drive, w, at, low)[1]) / (s + gn))
        since += TURN
    return least


@borrowing
def pull_of(drive: SineDrive) -> float:
    """Return the largest acceleration along the track, c + |sin(gamma)| + mu_k (s + n)."""
    return abs(drive.c) + abs(drive.gs) + drive.mu_k * (drive.s + drive.gn)


@borrowing
def stick(
    drive: SineDrive, at: float, end: float, fresh: bool, size: int, d: Floats, nearest: Floats
) -> tuple[float, bool]:
    """Propagate derivatives through a stick; return the phase at its end and the slip direction.

    The part sticks from phase `at` to where friction lets go (`release`) or to `end`, whose
    derivatives are in row `end` of `d`; the time of sticking changes by tau1. - tau0. The direction
    is True for forward. `fresh` is True if the part came to this phase by itself: `nearest[0]` then
    notes its distances from letting go at once, |sin(tau) - S|, and from `end`. `size` directions
    are in use.
    """
    least, largest, way = drive.least, drive.largest, drive.way
    sticks, leave, forward = hold(drive, at, end)
    if fresh:
        sine = math.sin(at)
        nearest[0] = min(nearest[0], abs(sine - least), abs(sine - largest))
    if not sticks:
        return at, forward
    lets_go = leave < end
    if fresh:
        nearest[0] = min(nearest[0], end - leave if lets_go else 1.0)
    for i in range(size):
        d[ROW.stick + MODE.stick, i] -= d[ROW.phase, i]
    if lets_go:
        release(drive, not forward and way > 0, way, leave, d)
    else:
        copy_row(d, ROW.phase, ROW.end)
    for i in range(size):
        d[ROW.stick + MODE.stick, i] += d[ROW.phase, i]
    return leave, forward


@borrowing
def on_floor(
    drive: SineDrive, tau: float, span: float, u: float, fresh: bool, energy: bool, size: int,
    d: Floats, nearest: Floats,
) -> float:  # fmt: skip
    """Propagate derivatives through a contact with the floor; return the slip velocity at its end.

    The contact is followed as `slide.contact` does: stick and slip by turns until it ends.

    Parameters
    ----------
    tau, span
        Phase at the start and duration, in rad.
    u
        Slip velocity at the start in g/w (w = 2 pi f).
    fresh
        True if the contact begins at any phase, as after a landing; False if it begins at the phase
        at which sticking ends.
    energy
        True if derivatives of the work of friction are needed.
    size
        Number of the parameters differentiated by, the columns of `d` in use.
    d
        Derivatives, changed in place: a row for each quantity (`ROW`), a column for each parameter
        (`BY`).
    nearest
        Changed in place: `nearest[0]` is the least relative distance, so far, of a decision such as
        stick or slip from its other outcome.
    """
    at, end = tau, tau + span
    for _ in range(MAX_MODES):
        if at >= end:
            return u
        if u == 0:
            leave, forward = stick(drive, at, end, fresh, size, d, nearest)
            if leave >= end:
                return 0.0
            at, sign = leave, 1.0 if forward else -1.0
        else:
            sign = 1.0 if u > 0 else -1.0
        fresh = True
        stop = stop_after(drive, sign, u, at, end - at)
        stops = stop >= 0
        span = stop if stops else end - at
        mode = MODE.forward if sign > 0 else MODE.backward
        after = 0.0 if stops else slide(drive, sign, u, at, span)[0]
        nearest[0] = min(nearest[0], slow_passage(drive, sign, u, at, span))
        size_of = pull_of(drive)
        if stops:
            rate = slip_acceleration(drive, sign, at + span) / size_of
            nearest[0] = min(nearest[0], rate * rate, end - at - span)
        elif span > 1e-9:
            nearest[0] = min(nearest[0], abs(after) / size_of)
        along(drive, sign, u, after, at, span, stops, mode, size, d)
        if energy:
            rub(drive, sign, u, at, span, size, d)
        if not stops:
            return after if after * sign > 0 else 0.0
        at, u = at + span, 0.0
    nearest[0] = 0.0
    return u


@borrowing
def in_hops(drive: SineDrive, e: float, at: float, nearest: Floats) -> tuple[float, float, float]:
    """Return the effect of small hops left out at phase `at`: skid, later slip, and its time.

    First the direction in which they drive the part into a slip (`skids`: 1, -1, 0); then that in
    which it slips on afterwards (at restitution `e` = 0 static friction decides); then for how long
    it slips before it sticks, per rebound w: (2 |a|/n - mu_k (1 + e))/((1 - e) (mu_k n - |a|)), if
    above 0, with acceleration a along and load n. `nearest[0]` notes how near |a| is to mu_k n.
    """
    n, skid = load(drive, at), skids(drive, at)
    forced, rubbed = abs(drive.c * math.sin(at) - drive.gs), drive.mu_k * n
    nearest[0] = min(nearest[0], abs(forced - rubbed) / pull_of(drive))
    if skid != 0.0:
        return skid, skid if e > 0.0 or forced > drive.mu_s * n else 0.0, 0.0
    gained = max(0.0, 2.0 * forced / max(n, 1e-300) - drive.mu_k * (1.0 + e))
    return 0.0, 0.0, gained / ((1.0 - e) * max(1e-300, rubbed - forced))


@borrowing
def land(
    drive: SineDrive, w: float, tau: float, span: float, speed: float, size: int, d: Floats
) -> None:
    """Fill the derivatives of a landing's phase, (delta z)/w, and speed, n tau1. - delta w.

    Into rows `end` and `normal` of `d`, in `size` directions; delta z = -w0 tau0. + delta w0 D + s.
    sway - n. D^2/2. The part took off at phase `tau` with velocity `w`, and lands after `span` rad
    with the speed `speed` (theory 13.16).
    """
    swing, sway = swings(math.sin(tau), math.cos(tau), span)
    n0, n1 = load(drive, tau), load(drive, tau + span)
    for i in range(size):
        begin = d[ROW.normal, i] + n0 * d[ROW.phase, i]
        height, fall = begin * span - w * d[ROW.phase, i], begin
        if i == BY.s:
            height, fall = height + sway, fall + swing
        elif i == BY.gn:
            height, fall = height - span * span / 2, fall - span
        d[ROW.end, i] = height / speed
        d[ROW.normal, i] = n1 * d[ROW.end, i] - fall


@borrowing
def in_air(
    drive: SineDrive, e: float, rows: Floats, row: int, rests: bool, u: float, size: int,
    d: Floats, nearest: Floats,
) -> float:  # fmt: skip
    """Propagate derivatives through a flight and its landing; return the slip velocity after it.

    By `land`, `along` and `rebound`, and by `leave_out_hops` if the part then rests after hops that
    shrink to nothing (theory 13.16).

    Parameters
    ----------
    e
        Restitution.
    rows, row
        Segments of the cycle (columns of `SEGMENT`), and the index of the flight.
    rests
        If the part then stays on the floor.
    u
        Velocity along at take-off in g/w (w = 2 pi f).
    size
        Number of directions, the columns of `d` in use.
    d
        Derivatives, a row a quantity (`ROW`), a column a direction (`BY`).
    nearest
        Least relative distances of decisions from their other outcomes, shape (5,).
    """
    tau, span = rows[row, SEGMENT.phase], rows[row, SEGMENT.span]
    w, speed = rows[row, SEGMENT.take_off], rows[row, SEGMENT.landing]
    impulse = rows[row, SEGMENT.impulse]
    size_of = drive.s + drive.gn
    grazing = speed / (size_of * min(1.0, span))
    nearest[0] = min(nearest[0], grazing * grazing, low_passage(drive, w, tau, span))
    highest(drive, w, tau, span, size, d, nearest)
    land(drive, w, tau, span, speed, size, d)
    n1 = load(drive, tau + span)
    after = fly(drive, u, tau, span)[0]
    along(drive, 0.0, u, after, tau, span, False, MODE.flight, size, d)
    note_fastest(speed, d, nearest)
    friction = drive.mu_k * impulse
    stops = abs(after) <= friction
    pull = pull_of(drive)
    nearest[0] = min(nearest[0], abs(abs(after) - friction) / pull)
    if e * speed < SMALL_REBOUND:
        nearest[0] = min(nearest[0], abs(n1) / size_of)
    sign = 1.0 if after > 0 else -1.0
    slow = 0.0 if stops else after - sign * friction
    left = time_of_hops(n1, e) if rests else 0.0
    stops = stops or (rests and abs(slow) <= drive.mu_k * e * speed)
    if not stops and abs(slow) < pull * left * e * speed:
        nearest[0] = 0.0  # the slip stops, or not, among hops that are left out
    skid, slips, slides = 0.0, 0.0 if stops else sign, 0.0
    if rests and stops:
        skid, slips, slides = in_hops(drive, e, tau + span, nearest)
        slow = skid * drive.mu_k * e * speed
    landing = Landing(tau + span, speed, impulse, after, slow, rests, stops, skid, slips)
    rebound(drive, e, landing, size, d)
    if rests:
        leave_out_hops(drive, e, landing, slides, size, d)
    return slow


@borrowing
def note_fastest(speed: float, d: Floats, nearest: Floats) -> None:
    """Fill the derivatives of the largest landing speed, if this landing has it.

    `speed` is its speed in g/w (w = 2 pi f), `nearest[1]` the largest so far; `nearest[2]` notes
    the relative distance of the two fastest, since the largest of equals has no derivative. `d`
    holds the derivatives.
    """
    if speed > nearest[1]:
        nearest[2] = (speed - nearest[1]) / speed
        nearest[1] = speed
        copy_row(d, ROW.landing, ROW.normal)
    else:
        nearest[2] = min(nearest[2], (nearest[1] - speed) / nearest[1])


@borrowing
def time_of_hops(n1: float, e: float) -> float:
    """Return the duration in rad of omitted hops over their rebound speed, 2/(n (1 - eps)).

    n = `n1` is the load on the floor at the landing, eps = `e` the restitution. At a kink the part
    lands as the floor lets go, and n is taken above 0 (theory 13.5).
    """
    return 2.0 / (max(n1, 1e-300) * (1.0 - e))


class Landing(NamedTuple):
    """A landing: its phase `at` in rad, its speed, and the slip velocity `after` the flight.

    Attributes
    ----------
    impulse
        Of the floor, I in g/w; the slip loses mu_k I, or all of it if it `stops`.
    slow
        The slip velocity that is left, in g/w.
    rests
        If the part then stays on the floor, after hops that shrink to nothing.
    skid, slips
        Direction (1, -1, 0) in which such hops drive the part, and in which it then slips.
    """

    at: float
    speed: float
    impulse: float
    after: float
    slow: float
    rests: bool
    stops: bool
    skid: float
    slips: float


@borrowing
def rebound(drive: SineDrive, e: float, landing: Landing, size: int, d: Floats) -> None:
    """Propagate derivatives through an impact: those of rebound, slip and energy.

    (eps w). = eps. w + eps w.; the slip loses (mu_k I). = mu_k. I + mu_k I., or all of it if it
    stops; then it gains what hops leave, (mu_k eps w)., which has no derivative by restitution `e`
    where it begins with a jump. The energy (u^2 - u1^2 + w^2 - w1^2)/2 changes by u u. - u1 u1. + w
    w. - w1 w1. `d` holds the derivatives, in `size` directions (theory 13.16). `landing` is the
    impact.
    """
    speed, up = landing.speed, 0.0 if landing.rests else e * landing.speed
    factor, sign = 1.0 if landing.rests else 1.0 + e, 1.0 if landing.after > 0 else -1.0
    for i in range(size):
        fast, down = d[ROW.along, i], d[ROW.normal, i]
        rebounds, given = e * down, factor * down
        if i == BY.e:
            rebounds += speed
            given += 0.0 if landing.rests else speed
        rubbed = drive.mu_k * given + (landing.impulse if i == BY.mu_k else 0.0)
        if not landing.stops:
            d[ROW.along, i] = fast - sign * rubbed
        else:
            left = drive.mu_k * rebounds + (e * speed if i == BY.mu_k else 0.0)
            d[ROW.along, i] = landing.skid * left
            if i == BY.e and landing.skid != landing.slips:
                d[ROW.along, i] = math.nan
        d[ROW.impact, i] += landing.after * fast - landing.slow * d[ROW.along, i] + speed * down
        if not landing.rests:
            d[ROW.impact, i] -= up * rebounds
            d[ROW.normal, i] = rebounds


@borrowing
def leave_out_hops(
    drive: SineDrive, e: float, landing: Landing, slides: float, size: int, d: Floats
) -> None:
    """Propagate derivatives through small hops that count as contact, after `rebound`.

    Their time T = 2 w/(n (1 - eps)), with rebound w, changes by T. = 2 (w. - w n./n + w eps./(1 -
    eps))/(n (1 - eps)). It goes from the contact's mode to the flight, and its friction mu_k n |u|
    to the impacts. A slip that no skid follows stops on the floor after `slides` w. `e` is the
    restitution, `d` holds the derivatives, in `size` directions (theory 13.5, 13.16). `landing` is
    the impact before them.
    """
    at, speed = landing.at, landing.speed
    n1, slips = load(drive, at), landing.slips
    carried, left = max(n1, 1e-300), time_of_hops(n1, e)
    steep = drive.s * math.cos(at)
    mode = MODE.stick if slips == 0 else MODE.forward if slips > 0 else MODE.backward
    way = MODE.forward if drive.c * math.sin(at) > drive.gs else MODE.backward
    for i in range(size):
        rebounds = e * d[ROW.normal, i]
        loads = -steep * d[ROW.phase, i]
        if i == BY.gn:
            loads += 1.0
        elif i == BY.s:
            loads -= math.sin(at)
        elif i == BY.e:
            rebounds += speed
        hops = left * (rebounds - e * speed * loads / carried)
        if i == BY.e:
            hops += left * e * speed / (1.0 - e)
        d[ROW.flight, i] += hops
        d[ROW.stick + mode, i] -= hops
        # Each of their landings takes its part of what the floor would rub.
        rubbing = drive.mu_k * n1 * abs(landing.slow) * hops
        d[ROW.impact, i] += rubbing
        d[ROW.friction, i] -= rubbing
        # The slip of hops that no skid follows stops on the floor after (mu_k n - |a|)^-1 of it.
        d[ROW.stick + way, i] += slides * rebounds
        d[ROW.stick + MODE.stick, i] -= slides * rebounds
        d[ROW.normal, i] = 0.0


@borrowing
def highest(
    drive: SineDrive, w: float, tau: float, span: float, size: int, d: Floats, nearest: Floats
) -> None:
    """Fill the derivatives of the largest height, if this flight has it; call it before `along`.

    The part takes off at phase `tau` with velocity `w` and flies for `span` rad. At the top z' = 0,
    so that its phase changes nothing. `nearest[3]` is the largest height so far, `nearest[4]` the
    relative distance of the two highest; `d` holds the derivatives, in `size` directions.
    """
    s, gn = drive.s, drive.gn
    if (gn + s) * span * span / 8 <= nearest[3]:
        return
    top = top_at(drive, w, tau, span)
    height = rise(drive, w, tau, top)[1]
    if height <= nearest[3]:
        nearest[4] = min(nearest[4], (nearest[3] - height) / nearest[3])
        return
    nearest[3], nearest[4] = height, (height - nearest[3]) / height
    _, sway = swings(math.sin(tau), math.cos(tau), top)
    n0 = load(drive, tau)
    for i in range(size):
        begin = d[ROW.normal, i] + n0 * d[ROW.phase, i]
        d[ROW.height, i] = begin * top - w * d[ROW.phase, i]
    d[ROW.height, BY.s] += sway
    d[ROW.height, BY.gn] -= top * top / 2
