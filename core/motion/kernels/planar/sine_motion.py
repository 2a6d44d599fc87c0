"""Flight, stick and slip of a part under a sine: what a sine tells in `plane_laws`."""

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.planar.flow import (
    LAST_STEP,
    MAX_ITERATIONS,
    MAX_PIECES,
    SMOOTH,
    TURN,
    SineDrive,
    distance_after,
    flow,
    flow_from_integrals,
    kind_of,
    phase_to,
    sine_integrals,
    sine_terms,
    velocity_after,
)

HEIGHT_PIECES = 8  # pieces on which a height is bounded: the bound is then some per cent above it
ROUNDINGS = 1e-12  # relative margin of a bound of the height, more than rounding may add


@compiled
def normal_numbers(drive: SineDrive) -> tuple[float, float]:
    """Return drive and gravity normal to the floor, s and n, in g."""
    return drive.push_normal, drive.gravity_normal


@compiled
def track_speed(drive: SineDrive, tau: float) -> float:
    """Return the velocity of the track along itself at phase `tau`, c cos(tau), in g/w."""
    return drive.push_along * math.cos(tau)


@compiled
def air_integrals(drive: SineDrive, tau: float, d: float) -> tuple[float, float]:
    """Return the `sine_integrals` of a flight from phase `tau` for the phase `d`."""
    return sine_integrals(math.sin(tau), math.cos(tau), d)


@compiled
def along_from_integrals(
    drive: SineDrive, slip: float, d: float, first_integral: float, second_integral: float
) -> tuple[float, float]:
    """Return velocity and distance along after a flight for the phase `d`, in g/w and g/w^2."""
    return flow_from_integrals(
        slip, drive.push_along, drive.gravity_along, d, first_integral, second_integral
    )


@compiled
def push_slope(drive: SineDrive, tau: float) -> tuple[float, float]:
    """Return the derivative of the drive acceleration by phase, along and normal to the floor."""
    cosine = math.cos(tau)
    return drive.push_along * cosine, drive.push_normal * cosine


@compiled
def smooth_span(drive: SineDrive, tau: float) -> float:
    """Return the phase interval in rad, 1.5, in which a sine is a polynomial up to rounding."""
    return SMOOTH


@compiled
def lift_off(drive: SineDrive, tau: float) -> float:
    """Return the phase in rad of the next lift-off, asin(n/s); NaN if the part never lifts off."""
    return drive.lift_off_phase


@compiled
def landing_root(
    take_off: float, push: float, gravity: float, sine: float, cosine: float, first_guess: float
) -> float:
    """Return a flight time in rad by Newton's method from `first_guess`, on one side of the root.

    The height bends one way between `first_guess` and the root, so that no step passes it but by
    rounding.
    """
    flight_time, first_step = first_guess, 0.0
    for _ in range(MAX_ITERATIONS):
        velocity, height = flow(take_off, push, gravity, sine, cosine, flight_time)
        if velocity >= 0:
            break
        step = height / velocity
        flight_time -= step
        first_step = step if first_step == 0 else first_step
        # Each step squares the error; one back across the root is made of rounding alone.
        if abs(step) <= LAST_STEP * flight_time or step * first_step <= 0:
            break
    return flight_time


@compiled
def lowest_phase(
    take_off: float, push: float, gravity: float, tau: float, low: float, high: float
) -> float:
    """Return the phase D in rad after take-off, in `low` to `high`, at which a height is least."""
    d = (low + high) / 2
    for _ in range(MAX_ITERATIONS):
        velocity = velocity_after(take_off, push, gravity, tau, d)
        if velocity > 0:
            high = d
        else:
            low = d
        acceleration = push * math.sin(tau + d) - gravity
        next_d = d - velocity / acceleration if acceleration > 0 else low
        if low < next_d < high and abs(next_d - d) <= LAST_STEP * d:
            return next_d
        if not low < next_d < high:
            next_d = (low + high) / 2
            if next_d in (low, high):
                return next_d
        d = next_d
    return d


@compiled
def landing(drive: SineDrive, take_off: float, tau: float) -> float:
    """Return the flight time in rad after take-off at phase `tau`, if s > n; -1 if not found.

    A piece that bends down and ends above the floor was above it all the way; on a piece that bends
    up the least height is found first (theory 13.3). As sin <= 1, the height is above the parabola
    (w + s cos(tau)) D - s (1 - sin(tau)) - n D^2/2: whole turns in which that is positive are
    skipped.
    """
    # w, s and n of the formula are `take_off`, `push` and `gravity`.
    push, gravity, bends_up_at = drive.push_normal, drive.gravity_normal, drive.lift_off_phase
    sine, cosine = math.sin(tau), math.cos(tau)
    bends_down_at = math.pi - bends_up_at
    bends_up = bends_up_at <= tau % TURN < bends_down_at
    if not bends_up and take_off > 0:
        # A small hop: twice the parabola's own time is past the landing, or soon will be.
        guess = 2 * take_off / (gravity - push * sine)
        end = phase_to(bends_up_at, tau)
        for _ in range(64):
            if not guess < end:
                break
            if flow(take_off, push, gravity, sine, cosine, guess)[1] <= 0:
                return landing_root(take_off, push, gravity, sine, cosine, guess)
            guess *= 2
    # Above a parabola the height is positive whatever the sine does: skip whole turns of that.
    parabola_speed = take_off + push * cosine
    discriminant = parabola_speed * parabola_speed - 2 * gravity * push * (1 - sine)
    skip_from = skip_to = math.inf
    if discriminant > 0 and parabola_speed > 0:
        skip_to = (parabola_speed + math.sqrt(discriminant)) / gravity
        skip_from = 2 * push * (1 - sine) / gravity / skip_to
    d, velocity = 0.0, take_off
    for _ in range(MAX_PIECES):
        if skip_from < d < skip_to - TURN:
            d += TURN * math.floor((skip_to - d) / TURN)
            velocity = flow(take_off, push, gravity, sine, cosine, d)[0]
        to_next_bend = phase_to(bends_down_at if bends_up else bends_up_at, tau + d)
        end = d + (to_next_bend if to_next_bend > 0 or d == 0 else TURN)
        end_velocity, height = flow(take_off, push, gravity, sine, cosine, end)
        if bends_up:
            if velocity < 0:
                if end_velocity > 0:
                    lowest = lowest_phase(take_off, push, gravity, tau, d, end)
                    height = flow(take_off, push, gravity, sine, cosine, lowest)[1]
                if height <= 0:
                    return landing_root(take_off, push, gravity, sine, cosine, d)
        elif end_velocity < 0 and height <= 0:
            return landing_root(take_off, push, gravity, sine, cosine, end)
        d, velocity, bends_up = end, end_velocity, not bends_up
    return -1.0


@compiled
def hop_height(
    drive: SineDrive, take_off: float, tau: float, span: float, known_height: float
) -> float:
    """Return the largest height of a flight in g/w^2, or `known_height` if that is larger."""
    if (drive.gravity_normal + drive.push_normal) * span * span / 8 <= known_height:
        return known_height
    if height_bound(drive, take_off, tau, known_height) <= known_height:
        return known_height
    top = top_phase(drive, take_off, tau, span)
    return max(
        known_height, distance_after(take_off, drive.push_normal, drive.gravity_normal, tau, top)
    )


@compiled
def height_bound(drive: SineDrive, take_off: float, tau: float, known_height: float) -> float:
    """Return an upper bound of a flight's height in g/w^2, as close as a comparison needs.

    The height z after a phase D is, with r = w + s cos(tau) and x = D - r/n,

        z = r^2/(2 n) + s sin(tau) - n x^2/2 - s sin(tau + r/n + x).
    """
    push, gravity = drive.push_normal, drive.gravity_normal
    speed = take_off + push * math.cos(tau)
    summit = speed * speed / (2 * gravity) + push * math.sin(tau)
    summit += ROUNDINGS * (summit + 3 * push)
    if summit + push <= known_height:
        return summit + push
    to_trough = abs((tau + speed / gravity + 1.5 * math.pi) % TURN - math.pi)
    width = to_trough / HEIGHT_PIECES
    excess = -push
    for piece in range(HEIGHT_PIECES):
        offset = width * piece
        excess = max(
            excess, push * math.cos(to_trough - offset - width) - gravity * offset * offset / 2
        )
    return summit + excess


@compiled
def top_phase(drive: SineDrive, take_off: float, tau: float, span: float) -> float:
    """Return the phase in rad from take-off to the top of a flight of `span` rad.

    The height is a parabola and a sine of size s: its top is within 2 sqrt(s/n) + 1 of that of the
    parabola.
    """
    push, gravity = drive.push_normal, drive.gravity_normal
    # The height is a parabola and a sine: its top lies near that of the parabola.
    parabola_top = (take_off + push * math.cos(tau)) / gravity
    top_range = 2 * math.sqrt(push / gravity) + 1
    first, last = max(0.0, parabola_top - top_range), min(span, parabola_top + top_range)
    pieces = min(MAX_PIECES, max(8, int((last - first) * 4)))
    width = (last - first) / pieces
    highest, top = 0.0, first
    for piece in range(pieces + 1):
        height = distance_after(take_off, push, gravity, tau, first + width * piece)
        if height > highest:
            highest, top = height, first + width * piece
    low, high = max(0.0, top - width), min(span, top + width)
    for _ in range(MAX_ITERATIONS):
        velocity = velocity_after(take_off, push, gravity, tau, top)
        if velocity > 0:
            low = top
        else:
            high = top
        slope = push * math.sin(tau + top) - gravity
        next_top = top - velocity / slope if slope < 0 else (low + high) / 2
        if not low <= next_top <= high:
            next_top = (low + high) / 2
        if abs(next_top - top) <= 1e-15 * span:
            break
        top = next_top
    return top


THRESHOLD = 4e-16  # rounding of the sine at which friction is overcome


@compiled
def next_crossing(drive: SineDrive, kind: int, tau: float, rising: bool) -> float:
    """Return the first phase from tau on at which C sin - k rises (or falls) through 0; or inf.

    asin(k/C) or pi - asin(k/C), with C and k of `sine_terms`, and whole turns more: the same number
    whatever `tau` was, so that a motion which sticks repeats to the last bit.
    """
    C, k = sine_terms(drive, kind)
    if not abs(k) < abs(C):
        return math.inf
    target = math.asin(k / C)
    if (C > 0) != rising:
        target = math.pi - target
    return max(tau, target + TURN * math.ceil((tau - target) / TURN - 1e-13))


@compiled
def phase_to_stop(v: float, C: float, k: float, phase: float, span: float) -> float:
    """Return the phase in rad until a velocity v >= 0 is 0 under u' = C sin(tau) - k; or -1.

    The first fall of the velocity at whose end it is not positive holds the root (theory 13.3).
    """
    if C < 0:
        C, phase = -C, phase + math.pi
    if k <= -C:
        return -1.0
    sine, cosine = math.sin(phase), math.cos(phase)
    if k >= C:
        low, high = 0.0, span
        if v == 0 or flow(v, C, k, sine, cosine, high)[0] > 0:
            return -1.0
    else:
        rise_at = math.asin(k / C)
        fall_at = math.pi - rise_at
        low = 0.0
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        if v == 0 or rise_at <= phase % TURN < fall_at:
            low = phase_to(fall_at, phase)
        high = span
        for _ in range(MAX_PIECES):
            if low >= span:
                return -1.0
            to_next_rise = phase_to(rise_at, phase + low)
            high = min(span, low + (to_next_rise if to_next_rise > 0 else TURN))
            if flow(v, C, k, sine, cosine, high)[0] <= 0:
                break
            low = high + fall_at - rise_at
    return stop_between(v, C, k, phase, sine, cosine, low, high)


@compiled
def stop_between(
    v: float, C: float, k: float, phase: float, sine: float, cosine: float, low: float, high: float
) -> float:
    """Return the phase D after `phase`, between `low` and `high`, at which a falling velocity is 0.

    u' = C sin(phase + D) - k.
    """
    velocity_at_low, velocity_at_high = (
        flow(v, C, k, sine, cosine, low)[0],
        flow(v, C, k, sine, cosine, high)[0],
    )
    d = (
        low + (high - low) * velocity_at_low / (velocity_at_low - velocity_at_high)
        if velocity_at_low > velocity_at_high
        else low
    )
    for _ in range(MAX_ITERATIONS):
        velocity = flow(v, C, k, sine, cosine, d)[0]
        if velocity > 0:
            low = d
        else:
            high = d
        acceleration = C * math.sin(phase + d) - k
        next_d = d - velocity / acceleration if acceleration < 0 else low - 1
        if low <= next_d <= high and abs(next_d - d) <= LAST_STEP * d:
            return next_d
        if not low < next_d < high:
            next_d = (low + high) / 2
            if next_d in (low, high):
                return next_d
        d = next_d
    return d


@compiled
def always_holds(drive: SineDrive) -> bool:
    """True if static friction holds the part at every phase."""
    return (
        drive.push_normal <= drive.gravity_normal
        and drive.stick_low <= -1
        and drive.stick_high >= 1
    )


@compiled
def stop_after(drive: SineDrive, sign: float, slip: float, phase: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    By `phase_to_stop` of |u|, with sign times C = c + sign mu_k s and k = sin(gamma) + sign mu_k n
    (theory 13.2).
    """
    C, k = sine_terms(drive, kind_of(sign))
    return phase_to_stop(abs(slip), sign * C, sign * k, phase, span)


@compiled
def slip_uncertainty(drive: SineDrive) -> float:
    """Return the error of the mean velocity in g/w by rounding of phases at which slips start.

    (mu_s - mu_k)(s + n) d(asin S), where a rounding dS of the threshold S of sin(tau) moves the
    phase asin(S) by dS/sqrt(1 - S^2).
    """
    jump = (drive.mu_s - drive.mu_k) * (drive.push_normal + drive.gravity_normal)
    uncertainty = 0.0
    for threshold in (drive.stick_low, drive.stick_high):
        if abs(threshold) < 1.0:
            uncertainty += jump * THRESHOLD / math.sqrt((1.0 - threshold) * (1.0 + threshold))
    return uncertainty


@compiled
def sliding_without_stick(drive: SineDrive) -> tuple[float, float]:
    """Return mean velocity and forward share of a part that slides to and fro and never sticks.

    With amplitudes c, s of the drive along and normal, gravity n onto the floor, c1 = mu s, k1 = mu
    n, H = c k1 - c1 sin(gamma) and E = pi (c1 k1 - c sin(gamma))/H, the forward slip lasts the
    phase pi + E about the phase pi - asin(S), where

        S = pi (k1^2 - sin(gamma)^2)/(2 H cos(E/2))
        v = sqrt(1 - S^2) (2 c1 cos(E/2) + (pi c + c1 E) sin(E/2))/pi
    """
    c, s, gs, gn, mu_s, mu = (
        drive.push_along,
        drive.push_normal,
        drive.gravity_along,
        drive.gravity_normal,
        drive.mu_s,
        drive.mu_k,
    )
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
    slip_middle, slip_span = math.pi - math.asin(sine), math.pi + E
    starts_free = math.sin(slip_middle - slip_span / 2) >= (gs + k1) / (c + c1)
    turns_free = math.sin(slip_middle + slip_span / 2) <= (gs - k1) / (c - c1)
    if not (starts_free and turns_free):
        return 0.0, 0.0
    bracket = 2 * c1 * math.cos(E / 2) + (math.pi * c + c1 * E) * math.sin(E / 2)
    return math.sqrt((1 - sine) * (1 + sine)) / math.pi * bracket, slip_span / TURN
