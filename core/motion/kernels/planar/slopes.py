"""Derivatives carried from event to event along a cycle, under a sine (theory 13.16).

The phase of an event moves with a parameter by -(what changes of its condition at a fixed phase)
over the rate of the condition. `nearest` holds the least distance of a decision on the way from
its other outcome, relative: where it is next to nothing the motion has a kink or a jump.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.planar.drive import (
    fly,
    hold,
    load,
    rise,
    slide,
    slip_acceleration,
    stop_after,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN, SineDrive, flow, phase_to, swings
from vibrafeed.core.motion.kernels.planar.sine_flight import lowest_at, top_at
from vibrafeed.core.motion.kernels.planar.slide import MAX_MODES, skids
from vibrafeed.core.motion.kernels.planar.slope_tables import BY, ROW
from vibrafeed.core.motion.kernels.planar.tables import SEGMENT
from vibrafeed.core.motion.kernels.quadrature import NODES, WEIGHTS
from vibrafeed.core.motion.kernels.statuses import MODE

SMOOTH = 1.5  # longest phase in rad over which Gauss's rule is used at once
SMALL_REBOUND = 1e-6  # in g/w: below it the load at a landing decides if the part stays


@borrowing
def copy_row(d: Floats, to: int, of: int) -> None:
    """Copy row `of` of the derivatives to row `to`; a slice assignment would allocate an array."""
    for i in range(d.shape[1]):
        d[to, i] = d[of, i]


@borrowing
def force(drive: SineDrive, sign: float, at: float, span: float, d: Floats) -> None:
    """Set how velocity and distance change by the parameters through the acceleration, in one mode.

    A dot is a derivative by a parameter. Rows `forced` and `path` of `d` get C. swing - k. D and C.
    sway - k. D^2/2 (a column a parameter, `BY`), from u' = C sin(tau) - k with C = c +- mu_k s and
    k = sin(gamma) +- mu_k n, over the phase D = `span` in rad from `at` on, at a fixed phase; swing
    and sway are first and second integral of sin. `sign` is 1 for a slip forward, -1 backward, 0
    for a flight, which has no friction (theory 13.16).
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

    A dot is a derivative by a parameter, delta one at a fixed phase. With delta u0 = u0. - u'(tau0)
    tau0. the velocity ends with u1. = delta u + u'(tau1) tau1., or with 0 at a stop, which moves by
    tau1. = -delta u/u'(tau1); the position with x1. - x0. = delta x + u1 tau1. - u0 tau0. (theory
    13.16).

    Parameters
    ----------
    drive
        Drive, gravity and friction in g.
    sign, mode
        Slip direction 1 or -1, 0 for a flight; and the mode whose time is counted.
    u, after
        Velocities along at the start and end, in g/w (w = 2 pi f).
    at, span
        Phase at the start and duration, in rad.
    stops
        True if the slip ends in a stop; else row `end` of `d` holds the end's derivatives.
    size
        Number of directions, the columns of `d` in use.
    d
        Derivatives, changed in place: a row a quantity (`ROW`), a column a direction (`BY`).
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
    """Add the derivatives of the work of friction over a slip to row `friction` of `d`.

    Those of the integral of mu_k n |u| over the phase, with the load n = n0 - s sin(tau) in g, by
    Gauss's rule, with both ends kept at their phases: `along`, called before, adds what their shift
    does. The slip goes in direction `sign` (1 or -1), from velocity `u` in g/(2 pi f) at phase `at`
    over `span` rad. `d` has a row a quantity (`ROW`), a column a direction (`BY`), of which `size`
    are in use (theory 13.15).
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
    """Set the derivatives of the phase at which static friction lets a part go, sin(tau) = S.

    A dot is a derivative by a parameter: tau. = S./cos(tau) with S = (sin(gamma) +- mu_s n)/(c +-
    mu_s s), for drive amplitudes c, s and the load n, in g; minus signs if `by_least` is True (S is
    the lower bound of sin(tau)) or `way` < 0. `leave` is that phase in rad. Row `phase` of `d` is
    overwritten, a column a parameter (`BY`) (theory 13.16).
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

    A dot is a derivative, in each column of `d` by one parameter (`BY`): tau. = (n. - s.
    sin(tau))/(s cos(tau)), from s sin(tau) = n, with vibration s off the floor and gravity n onto
    it.
    """
    sine = drive.gn / drive.s
    rate = drive.s * math.sqrt((1.0 - sine) * (1.0 + sine))
    d[row, :] = 0.0
    d[row, BY.gn], d[row, BY.s] = 1.0 / rate, -sine / rate


@borrowing
def slow_passage(drive: SineDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the relative distance of a slip from a stop on its way: least speed over its scale.

    Next to 0 a small change of a parameter makes the slip stop there, and the motion has a kink or
    jump instead of a derivative (theory 13.16). The slip goes in direction `sign` (1, -1), from
    velocity `u` in g/(2 pi f) at phase `at` over `span` rad, with u' = C sin(tau) - k. Its speed is
    least at asin(k/C), where it ceases to fall; the scale is |C| + |k|. 1 if it has no least speed
    within.
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
    """Return the relative distance of a flight from touching the floor on its way [1].

    The least height |z| at `lowest_at` over s + n (vibration off the floor and gravity), at most 1;
    the part takes off at phase `at` with velocity `w` in g/(2 pi f) and flies for `span` rad. Next
    to 0 the motion has a jump.
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
    """Propagate derivatives through a stick; return the phase at its end and the way of the slip.

    The part sticks from phase `at` in rad to where static friction lets go, or to `end`, whose
    derivatives are in row `end` of `d`. The derivative of the time of sticking is tau1. - tau0.,
    and row `phase` gets those of the end. The second result is True for a slip forward. If the part
    does not stick at all, `at` is returned and nothing changes.

    `fresh` is True if the part came to this phase by itself, and not by letting go: `nearest[0]` is
    then lowered to its distances from letting go at once, |sin(tau) - S| for the bounds S of
    sticking, and from `end`. `size` columns of `d` are in use (theory 13.16).
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

    The part sticks and slips by turns until the contact ends (theory 13.16).

    Parameters
    ----------
    drive
        Drive, gravity and friction in g.
    tau, span
        Phase at the start and duration, in rad.
    u
        Slip velocity at the start in g/w (w = 2 pi f), as is the result.
    fresh
        True if the contact begins at any phase, as after a landing; False if it begins at the phase
        at which sticking ends.
    energy
        True if derivatives of the work of friction are needed.
    size
        Number of directions differentiated by, the columns of `d` in use.
    d
        Derivatives, changed in place: a row for each quantity (`ROW`), a column for each direction
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
    """Return the effect of small hops that are left out: skid, later slip, and time of that slip.

    When a part comes to rest, hops that shrink to nothing are replaced by a contact; derivatives of
    the motion need what these hops did (theory 13.16). All three belong to the phase `at` in rad,
    with acceleration a along the track, load n on the floor, in g, and restitution `e`.

    Returns
    -------
    skid
        Direction in which the hops drive the part into a slip: 1, -1, or 0 if |a| <= mu_k n.
    slip
        Direction in which it slips on afterwards; at e = 0 only if |a| > mu_s n.
    time
        Phase for which it slips before it sticks, over the rebound w: (2 |a|/n - mu_k (1 + e))/((1
        - e) (mu_k n - |a|)), at least 0.

    `nearest[0]` is lowered to the relative distance of |a| from mu_k n, where the result jumps.
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
    """Set the derivatives of the phase and of the speed of a landing, in rows `end` and `normal`.

    A dot is a derivative by a parameter: tau1. = (delta z)/w and w. = n tau1. - delta w, with delta
    z = -w0 tau0. + delta w0 D + s. sway - n. D^2/2, the change of the height at a fixed phase
    (theory 13.16). The part took off at phase `tau` in rad with velocity `w` in g/(2 pi f), and
    lands after D = `span` rad with the speed `speed`; n is the load in g, sway the second integral
    of sin. Rows `normal` and `phase` of `d` must be those at take-off; `size` columns are in use.
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
    """Propagate derivatives through a flight and its landing; return the slip velocity after.

    One step in differentiating a cycle of motion by its parameters (theory 13.16). If the part then
    stays on the floor after hops that shrink to nothing, these hops are left out, and their effect
    is added.

    Parameters
    ----------
    drive, e
        Drive with gravity and friction in g; restitution.
    rows, row
        Segments of the cycle (columns of `SEGMENT`), and the index of the flight.
    rests
        True if the part then stays on the floor.
    u
        Velocity along the track at take-off in g/w (w = 2 pi f), as is the result.
    size
        Number of directions differentiated by, the columns of `d` in use.
    d
        Derivatives, changed in place: a row a quantity (`ROW`), a column a direction (`BY`).
    nearest
        Least relative distances of decisions from their other outcomes, shape (5,), lowered in
        place.
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
    """Store the derivatives of a landing speed, if the landing is the fastest of the cycle so far.

    `speed` is the landing speed in g/w (w = 2 pi f); `nearest[1]` is the largest so far, and is
    raised. Row `normal` of `d` holds the derivatives of this speed, and row `landing` gets those of
    the largest. `nearest[2]` is the relative distance of the two fastest landings, since the
    largest of two equal speeds has no derivative (theory 13.16).
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
    """Propagate derivatives through an impact with the floor: those of rebound, slip and energy.

    A dot is a derivative by a parameter. The rebound changes by (eps w). = eps. w + eps w., w the
    landing speed. The slip loses (mu_k I). = mu_k. I + mu_k I., I the normal impulse, or all of it
    if it stops; then it gains what left-out hops leave, (mu_k eps w)., NaN by restitution where
    this begins with a jump. The energy lost, (u^2 - u1^2 + w^2 - w1^2)/2 with the slip u and the
    values u1, w1 after the impact, changes by u u. - u1 u1. + w w. - w1 w1. (theory 13.16).

    `landing` describes the impact, `e` is the restitution eps; `d` holds the derivatives, a row a
    quantity (`ROW`), a column a direction (`BY`), of which `size` are in use.
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
    """Propagate derivatives through small hops that are replaced by a contact, after an impact.

    A dot is a derivative by a parameter. The time of the hops, T = 2 w/(n (1 - eps)) with the
    rebound w and the load n, changes by T. = 2 (w. - w n./n + w eps./(1 - eps))/(n (1 - eps)). In
    the derivatives of the shares it is moved from the contact's mode to the flight, and its
    friction mu_k n |u| to the impacts. Where no skid follows, the slip of the hops stops on the
    floor after the phase `slides` w (theory 13.5, 13.16).

    `landing` describes the impact, `e` is the restitution eps; `d` holds the derivatives, a row a
    quantity (`ROW`), a column a direction (`BY`), of which `size` are in use.
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
    """Store the derivatives of the height of a flight, if it is the highest of the cycle so far.

    Those of z = w D + ..., at the top, where z' = 0, so that the top's phase changes nothing
    (theory 13.16). The part takes off at phase `tau` in rad with velocity `w` in g/(2 pi f) and
    flies for `span` rad. `nearest[3]` is the largest height so far, `nearest[4]` the relative
    distance of the two highest; both are kept up to date. Row `height` of `d` gets the derivatives,
    in `size` directions; rows `normal` and `phase` must be those at take-off: call it before `land`
    and `along`.
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
