"""A sine, or steps along the track, as the drive of a row, and its first zeros (theory 17.3).

Between the zeros of u' = C sin(tau) - k the velocity is monotone; between those and the zeros of
the velocity the distance is: no zero is missed, a grazing one included.
"""

import math
from collections import namedtuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import TURN, flow, phase_to, sine_integrals
from vibrafeed.core.motion.kernels.rows.row_state import Drive, Row

MAX_STEPS = 100
"""Most steps of Newton's iteration in a bracket: bisection alone needs 60 for a turn."""
SAME = 1e-12
"""Phase in rad: what is nearer to now is now."""
LAST_BIT = 1e-16
"""Share of the terms of a sum, below which the sum is 0 up to rounding."""
ROUNDING = 1e-13
"""Share of the terms of a bound, below which the bound says nothing."""
RESOLVED = 1e-13
"""In g: a push that is so little beyond the limit of static friction is at it."""


Pull = namedtuple("Pull", "C k sine cosine")
"""The acceleration that drives a velocity, u' = C sin(tau) - k, from a phase on."""


@borrowing
def turning_phases(C: float, k: float, tau: float, span: float) -> tuple[float, float]:
    """Return the first two zeros of u' = C sin(tau) - k within `span` after `tau`, or `span`."""
    rising, falling = span, span
    if abs(C) > abs(k):
        angle = math.asin(k / C)
        rising, falling = phase_to(angle, tau), phase_to(math.pi - angle, tau)
        rising = rising if SAME < rising < span else span
        falling = falling if SAME < falling < span else span
    return min(rising, falling), max(rising, falling)


@borrowing
def zero_between(
    order: int, start_distance: float, start_velocity: float, pull: Pull, low: float, high: float
) -> float:
    """Return the zero of a velocity (`order` 0) or distance (1) between two phases, in rad."""
    C, k, sine, cosine = pull
    speed, distance = flow(start_velocity, C, k, sine, cosine, low)
    value, slope = start_distance + distance, speed
    if order == 0:
        value, slope = speed, C * (sine * math.cos(low) + cosine * math.sin(low)) - k
    rises = value < 0.0
    d = low - value / slope if slope != 0.0 else high
    if not low < d < high:
        d = 0.5 * (low + high)
    for _ in range(MAX_STEPS):
        speed, distance = flow(start_velocity, C, k, sine, cosine, d)
        value, slope = start_distance + distance, speed
        if order == 0:
            value, slope = speed, C * (sine * math.cos(d) + cosine * math.sin(d)) - k
        terms = abs(start_distance) + d * (abs(start_velocity) + d * (abs(C) + abs(k)))
        if order == 0:
            terms = abs(start_velocity) + d * (abs(C) + abs(k))
        if abs(value) <= LAST_BIT * terms:
            return d
        if (value < 0.0) == rises:
            low = d
        else:
            high = d
        step = value / slope if slope != 0.0 else math.inf
        next_d = d - step
        if not low < next_d < high:
            next_d = 0.5 * (low + high)
        if abs(next_d - d) <= 1e-16 * (1.0 + d) or high - low <= 2e-16 * (1.0 + high):
            return next_d
        d = next_d
    return d


@borrowing
def first_stop(
    velocity: float,
    direction: int,
    C: float,
    k: float,
    tau: float,
    sine: float,
    cosine: float,
    span: float,
) -> float:
    """Return the phase until a velocity in direction `direction` is 0; inf if not within `span`."""
    # It falls by no more than |C| + direction k a phase.
    largest_change = (abs(C) + direction * k) * span
    if direction * velocity - largest_change > ROUNDING * (abs(velocity) + abs(largest_change)):
        return math.inf
    first_turn, second_turn = turning_phases(C, k, tau, span)
    low, high = 0.0, first_turn
    is_at_rest = direction * velocity <= 0.0
    starts_moving = is_at_rest and direction * (C * sine - k) >= -RESOLVED
    for piece in range(3):
        velocity_at_high, _ = flow(velocity, C, k, sine, cosine, high)
        if direction * velocity_at_high <= 0.0 and (low > 0.0 or not starts_moving):
            if low == 0.0 and is_at_rest:
                return 0.0
            return zero_between(0, 0.0, velocity, Pull(C, k, sine, cosine), low, high)
        if high == span:
            break
        low, high = high, second_turn if piece == 0 else span
    return math.inf


@borrowing
def first_contact(
    g: float, v: float, C: float, k: float, tau: float, sine: float, cosine: float, span: float
) -> float:
    """Return the phase in rad until a gap between two parts closes; inf if not within `span`.

    The gap `g` changes with the rate `v`, v' = C sin(tau) - k; monotonic pieces of both tell that
    no contact is missed, a grazing one included (theory 17.3).
    """
    if C == 0.0 and k == 0.0 and v >= 0.0:
        return math.inf
    # Its velocity falls by no more than |C| + k a phase.
    approach, largest_loss = min(v, 0.0) * span, max(abs(C) + k, 0.0) * span * span / 2.0
    if g + approach - largest_loss > ROUNDING * (g - approach + largest_loss):
        return math.inf
    first_turn, second_turn = turning_phases(C, k, tau, span)
    rounding = 1e-15 * (abs(C) + abs(k) + abs(v))
    low, high, rate_at_low, gap_at_low = 0.0, first_turn, v, g
    for piece in range(3):
        rate_at_high, distance_at_high = flow(v, C, k, sine, cosine, high)
        if rate_at_low < 0.0 < rate_at_high and gap_at_low + rate_at_low * (
            high - low
        ) <= ROUNDING * (gap_at_low + abs(distance_at_high)):
            least_phase = zero_between(0, 0.0, v, Pull(C, k, sine, cosine), low, high)
            if g + flow(v, C, k, sine, cosine, least_phase)[1] < -rounding:
                return _contact_between(g, v, C, k, sine, cosine, low, least_phase)
        if g + distance_at_high < -rounding:
            if rate_at_high < 0.0 < rate_at_low:  # it opens before it closes
                low = zero_between(0, 0.0, v, Pull(C, k, sine, cosine), low, high)
            return _contact_between(g, v, C, k, sine, cosine, low, high)
        if high == span:
            break
        low, high, rate_at_low, gap_at_low = (
            high,
            second_turn if piece == 0 else span,
            rate_at_high,
            g + distance_at_high,
        )
    return math.inf


@borrowing
def _contact_between(
    g: float, v: float, C: float, k: float, sine: float, cosine: float, low: float, high: float
) -> float:
    if low == 0.0 and g <= 0.0:
        return 0.0
    return zero_between(1, g, v, Pull(C, k, sine, cosine), low, high)


@borrowing
def flight_time(push: float, gravity: float, tau: float, max_turns: int) -> float:
    """Return the duration in rad of a flight from rest at phase `tau`; inf beyond `max_turns`."""
    sine, cosine = math.sin(tau), math.cos(tau)
    height, rate, elapsed = 0.0, 0.0, 0.0
    for _ in range(max_turns):
        span = first_contact(height, rate, push, gravity, tau, sine, cosine, TURN)
        if span < math.inf and elapsed + span > 0.0:
            return elapsed + span
        rate, distance = flow(rate, push, gravity, sine, cosine, TURN)
        height += distance
        elapsed += TURN
    return math.inf


LONGEST_FLIGHT = 1000
"""Longest flight in turns of the drive: at throw numbers beyond some 3,000 no feeder works."""

Now = namedtuple("Now", "tau sine cosine")
"""A phase, its sine and its cosine."""


@borrowing
def pushes(drive: Drive, pull: float, tau: float) -> tuple[float, float]:
    """Return the push along, c sin(tau) - `pull`, and the load on the floor, at least 0, in g."""
    return drive.push_along * math.sin(tau) - pull, max(
        0.0, drive.gravity_normal - drive.push_normal * math.sin(tau)
    )


@borrowing
def lift_off(drive: Drive, tau: float) -> float:
    """Return the phase in rad until parts lift off, where s sin(tau) rises through n."""
    return (
        phase_to(math.asin(drive.gravity_normal / drive.push_normal), tau)
        if drive.push_normal > drive.gravity_normal
        else math.inf
    )


@borrowing
def is_lifted(drive: Drive, tau: float) -> bool:
    """True if parts on the floor lift off at a phase."""
    return drive.push_normal * math.sin(tau) > drive.gravity_normal


@borrowing
def flight(drive: Drive, tau: float) -> tuple[float, float]:
    """Return duration in rad and landing speed in g/w of a flight that begins at phase `tau`."""
    span = flight_time(drive.push_normal, drive.gravity_normal, tau, LONGEST_FLIGHT)
    if span == math.inf:
        return math.inf, 0.0
    return span, -flow(
        0.0, drive.push_normal, drive.gravity_normal, math.sin(tau), math.cos(tau), span
    )[0]


@borrowing
def first_rise(
    drive: Drive, body: int, direction: int, along: float, normal: float, level: float, tau: float
) -> float:
    """Return the phase until (`along` c + `normal` s) sin rises above `level`; inf if never."""
    amplitude = along * drive.push_along + normal * drive.push_normal
    if abs(amplitude) <= abs(level):
        return math.inf
    angle = math.asin(level / amplitude)
    return phase_to(angle if amplitude > 0.0 else math.pi - angle, tau)


@borrowing
def set_acceleration(
    row: Row, drive: Drive, body: int, moves: bool, friction: float, pull: float
) -> None:
    """Set C and k of a body's acceleration C sin(tau) - k; C = 0 unless it `moves`."""
    row.push_factor[body], row.pull[body] = (
        drive.push_along + friction * drive.push_normal if moves else 0.0,
        pull,
    )


@borrowing
def at_phase(drive: Drive, tau: float) -> Now:
    """Return sine and cosine of the phase, which the searches below share."""
    return Now(tau, math.sin(tau), math.cos(tau))


@borrowing
def stop_until(row: Row, drive: Drive, part: int, phase_now: Now, span: float) -> float:
    """Return the phase in rad until a sliding part's velocity is 0; inf if not within `span`."""
    return first_stop(
        row.speed[part], row.mode[part], row.push_factor[part], row.pull[part], phase_now.tau,
        phase_now.sine, phase_now.cosine, span,
    )  # fmt: skip


@borrowing
def contact_until(row: Row, drive: Drive, contact: int, phase_now: Now, span: float) -> float:
    """Return the phase in rad until a gap in a row closes; inf if not within `span`."""
    push_factor = row.push_factor[contact + 1] - row.push_factor[contact]
    pull = row.pull[contact + 1] - row.pull[contact]
    gap_rate = row.speed[contact + 1] - row.speed[contact]
    return first_contact(
        row.gap[contact],
        gap_rate,
        push_factor,
        pull,
        phase_now.tau,
        phase_now.sine,
        phase_now.cosine,
        span,
    )


@borrowing
def relative_push(row: Row, drive: Drive, contact: int, tau: float) -> float:
    """Return the share of the drive in the relative acceleration of two neighbours, in g."""
    return (row.push_factor[contact + 1] - row.push_factor[contact]) * math.sin(tau)


@borrowing
def drive_integrals(drive: Drive, tau: float, span: float) -> tuple[float, float]:
    """Return the velocity and distance that sin adds over `span` rad from phase `tau` on."""
    return sine_integrals(math.sin(tau), math.cos(tau), span)


@borrowing
def change_over_span(
    row: Row, drive: Drive, body: int, integrals: tuple[float, float], span: float
) -> tuple[float, float]:
    """Return the change of velocity and of position of a body over `span`, in g/w and g/w^2."""
    return (
        row.push_factor[body] * integrals[0] - row.pull[body] * span,
        row.speed[body] * span
        + row.push_factor[body] * integrals[1]
        - row.pull[body] * (span * span / 2.0),
    )


@borrowing
def drive_double_integrals(drive: Drive, tau: float, span: float) -> float:
    """Return the integral over `span` of the distance that sin adds from phase `tau` on.

    cos(tau + d) - cos(tau) + sin(tau) d + cos(tau) d^2/2, d = `span`.
    """
    sine, cosine = math.sin(tau), math.cos(tau)
    return math.cos(tau + span) - cosine + sine * span + cosine * span * span / 2.0


@borrowing
def gap_integral_of_drive(row: Row, drive: Drive, contact: int, integral: float) -> float:
    """Return the share of the drive in the integral of a gap over a phase."""
    return (row.push_factor[contact + 1] - row.push_factor[contact]) * integral


@borrowing
def push_sizes(drive: Drive) -> tuple[float, float]:
    """Return the amplitudes of both pushes in g, multiples of which press on the stop."""
    return drive.push_along, drive.push_normal


@borrowing
def positive_impulse(
    drive: Drive, body: int, along: float, normal: float, pull: float, tau: float, span: float
) -> float:
    """Return the integral of the positive part of a force, max(0, C sin(x) - k), over a phase."""
    amplitude = along + normal
    if amplitude == 0.0:
        return max(0.0, -pull) * span
    if abs(amplitude) <= abs(pull):
        return _force_impulse(amplitude, pull, tau, span) if pull < 0.0 else 0.0
    angle = math.asin(pull / amplitude)
    rising, falling = phase_to(angle, tau), phase_to(math.pi - angle, tau)
    total, begin = 0.0, 0.0
    for until in (min(rising, falling, span), min(max(rising, falling), span), span):
        middle = tau + 0.5 * (begin + until)
        if until > begin and amplitude * math.sin(middle) > pull:
            total += _force_impulse(amplitude, pull, tau + begin, until - begin)
        begin = until
    return total


@borrowing
def _force_impulse(amplitude: float, pull: float, tau: float, span: float) -> float:
    return amplitude * (math.cos(tau) - math.cos(tau + span)) - pull * span


@borrowing
def largest_force(
    drive: Drive, body: int, along: float, normal: float, pull: float, tau: float, span: float
) -> float:
    """Return the largest value of C sin(x) - `pull` over a phase, C = `along` + `normal`."""
    amplitude = along + normal
    top = phase_to(0.5 * math.pi if amplitude >= 0.0 else 1.5 * math.pi, tau)
    if top <= span:
        return abs(amplitude) - pull
    return max(amplitude * math.sin(tau), amplitude * math.sin(tau + span)) - pull
