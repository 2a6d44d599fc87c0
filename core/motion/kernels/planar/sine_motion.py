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
    kind_of,
    phase_to,
    sine_terms,
    swings,
    swung,
    velocity_after,
)

HEIGHT_PIECES = 8  # pieces on which a height is bounded: the bound is then some per cent above it
ROUNDINGS = 1e-12  # relative margin of a bound of the height, more than rounding may add


@compiled
def normal_numbers(drive: SineDrive) -> tuple[float, float]:
    """Return drive and gravity normal to the floor, s and n, in g."""
    return drive.s, drive.gn


@compiled
def track_speed(drive: SineDrive, tau: float) -> float:
    """Return the velocity of the track along itself at phase `tau`, c cos(tau), in g/w."""
    return drive.c * math.cos(tau)


@compiled
def air_swings(drive: SineDrive, tau: float, d: float) -> tuple[float, float]:
    """Return the `swings` of a flight from phase `tau` for the phase `d`."""
    return swings(math.sin(tau), math.cos(tau), d)


@compiled
def swung_along(
    drive: SineDrive, u: float, d: float, swing: float, sway: float
) -> tuple[float, float]:
    """Return velocity and distance along after a flight for the phase `d`, in g/w and g/w^2."""
    return swung(u, drive.c, drive.gs, d, swing, sway)


@compiled
def push_slope(drive: SineDrive, tau: float) -> tuple[float, float]:
    """Return the derivative of the drive acceleration by phase, along and normal to the floor."""
    cosine = math.cos(tau)
    return drive.c * cosine, drive.s * cosine


@compiled
def smooth_span(drive: SineDrive, tau: float) -> float:
    """Return the phase interval in rad, 1.5, in which a sine is a polynomial up to rounding."""
    return SMOOTH


@compiled
def lift_off(drive: SineDrive, tau: float) -> float:
    """Return the phase in rad of the next lift-off, asin(n/s); NaN if the part never lifts off."""
    return drive.up_at


@compiled
def landing_root(w: float, s: float, gn: float, sine: float, cosine: float, start: float) -> float:
    """Return the time of a flight in rad by Newton's method from `start`, on one side of the root.

    The height bends one way between `start` and the root, so that no step passes it but by
    rounding.
    """
    d, first = start, 0.0
    for _ in range(MAX_ITERATIONS):
        slope, height = flow(w, s, gn, sine, cosine, d)
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
def lowest_at(w: float, s: float, gn: float, tau: float, low: float, high: float) -> float:
    """Return the phase D in rad after take-off, in `low` to `high`, at which a height is least."""
    d = (low + high) / 2
    for _ in range(MAX_ITERATIONS):
        value = velocity_after(w, s, gn, tau, d)
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
def landing(drive: SineDrive, w: float, tau: float) -> float:
    """Return the flight time in rad after take-off at phase `tau`, if s > n; -1 if not found.

    A piece that bends down and ends above the floor was above it all the way; on a piece that bends
    up the least height is found first (theory 13.3). As sin <= 1, the height is above the parabola
    (w + s cos(tau)) D - s (1 - sin(tau)) - n D^2/2: whole turns in which that is positive are
    skipped.
    """
    s, gn, up_at = drive.s, drive.gn, drive.up_at
    sine, cosine = math.sin(tau), math.cos(tau)
    down_at = math.pi - up_at
    bends_up = up_at <= tau % TURN < down_at
    if not bends_up and w > 0:
        # A small hop: twice the parabola's own time is past the landing, or soon will be.
        guess = 2 * w / (gn - s * sine)
        end = phase_to(up_at, tau)
        for _ in range(64):
            if not guess < end:
                break
            if flow(w, s, gn, sine, cosine, guess)[1] <= 0:
                return landing_root(w, s, gn, sine, cosine, guess)
            guess *= 2
    # Above a parabola the height is positive whatever the sine does: skip whole turns of that.
    rise = w + s * cosine
    inner = rise * rise - 2 * gn * s * (1 - sine)
    skip_from = skip_to = math.inf
    if inner > 0 and rise > 0:
        skip_to = (rise + math.sqrt(inner)) / gn
        skip_from = 2 * s * (1 - sine) / gn / skip_to
    d, velocity = 0.0, w
    for _ in range(MAX_PIECES):
        if skip_from < d < skip_to - TURN:
            d += TURN * math.floor((skip_to - d) / TURN)
            velocity = flow(w, s, gn, sine, cosine, d)[0]
        ahead = phase_to(down_at if bends_up else up_at, tau + d)
        end = d + (ahead if ahead > 0 or d == 0 else TURN)
        last, height = flow(w, s, gn, sine, cosine, end)
        if bends_up:
            if velocity < 0:
                if last > 0:
                    lowest = lowest_at(w, s, gn, tau, d, end)
                    height = flow(w, s, gn, sine, cosine, lowest)[1]
                if height <= 0:
                    return landing_root(w, s, gn, sine, cosine, d)
        elif last < 0 and height <= 0:
            return landing_root(w, s, gn, sine, cosine, end)
        d, velocity, bends_up = end, last, not bends_up
    return -1.0


@compiled
def hop_height(drive: SineDrive, w: float, tau: float, span: float, known: float) -> float:
    """Return the largest height of a flight in g/w^2, or `known` if that is larger."""
    if (drive.gn + drive.s) * span * span / 8 <= known:
        return known
    if height_bound(drive, w, tau, known) <= known:
        return known
    at = top_at(drive, w, tau, span)
    return max(known, distance_after(w, drive.s, drive.gn, tau, at))


@compiled
def height_bound(drive: SineDrive, w: float, tau: float, known: float) -> float:
    """Return an upper bound of a flight's height in g/w^2, as close as a comparison needs.

    The height z after a phase D is, with r = w + s cos(tau) and x = D - r/n,

        z = r^2/(2 n) + s sin(tau) - n x^2/2 - s sin(tau + r/n + x).
    """
    s, gn = drive.s, drive.gn
    speed = w + s * math.cos(tau)
    summit = speed * speed / (2 * gn) + s * math.sin(tau)
    summit += ROUNDINGS * (summit + 3 * s)
    if summit + s <= known:
        return summit + s
    trough = abs((tau + speed / gn + 1.5 * math.pi) % TURN - math.pi)
    width = trough / HEIGHT_PIECES
    most = -s
    for piece in range(HEIGHT_PIECES):
        near = width * piece
        most = max(most, s * math.cos(trough - near - width) - gn * near * near / 2)
    return summit + most


@compiled
def top_at(drive: SineDrive, w: float, tau: float, span: float) -> float:
    """Return the phase in rad from take-off to the top of a flight of `span` rad.

    The height is a parabola and a sine of size s: its top is within 2 sqrt(s/n) + 1 of that of the
    parabola.
    """
    s, gn = drive.s, drive.gn
    # The height is a parabola and a sine: its top lies near that of the parabola.
    top = (w + s * math.cos(tau)) / gn
    reach = 2 * math.sqrt(s / gn) + 1
    first, last = max(0.0, top - reach), min(span, top + reach)
    pieces = min(MAX_PIECES, max(8, int((last - first) * 4)))
    width = (last - first) / pieces
    best, at = 0.0, first
    for piece in range(pieces + 1):
        height = distance_after(w, s, gn, tau, first + width * piece)
        if height > best:
            best, at = height, first + width * piece
    low, high = max(0.0, at - width), min(span, at + width)
    for _ in range(MAX_ITERATIONS):
        velocity = velocity_after(w, s, gn, tau, at)
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
    return at


THRESHOLD = 4e-16  # rounding of the sine at which friction is overcome


@compiled
def next_of_way(drive: SineDrive, kind: int, tau: float, rising: bool) -> float:
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
def phase_to_stop(v: float, C: float, k: float, at: float, span: float) -> float:
    """Return the phase in rad until a velocity v >= 0 is 0 under u' = C sin(tau) - k; or -1.

    The first fall of the velocity at whose end it is not positive holds the root (theory 13.3).
    """
    if C < 0:
        C, at = -C, at + math.pi
    if k <= -C:
        return -1.0
    sine, cosine = math.sin(at), math.cos(at)
    if k >= C:
        low, high = 0.0, span
        if v == 0 or flow(v, C, k, sine, cosine, high)[0] > 0:
            return -1.0
    else:
        rise_at = math.asin(k / C)
        fall_at = math.pi - rise_at
        low = 0.0
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        if v == 0 or rise_at <= at % TURN < fall_at:
            low = phase_to(fall_at, at)
        high = span
        for _ in range(MAX_PIECES):
            if low >= span:
                return -1.0
            ahead = phase_to(rise_at, at + low)
            high = min(span, low + (ahead if ahead > 0 else TURN))
            if flow(v, C, k, sine, cosine, high)[0] <= 0:
                break
            low = high + fall_at - rise_at
    return stop_between(v, C, k, at, sine, cosine, low, high)


@compiled
def stop_between(
    v: float, C: float, k: float, at: float, sine: float, cosine: float, low: float, high: float
) -> float:
    """Return the phase D after `at`, between `low` and `high`, at which a falling velocity is 0.

    u' = C sin(at + D) - k.
    """
    first, last = flow(v, C, k, sine, cosine, low)[0], flow(v, C, k, sine, cosine, high)[0]
    d = low + (high - low) * first / (first - last) if first > last else low
    for _ in range(MAX_ITERATIONS):
        value = flow(v, C, k, sine, cosine, d)[0]
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
def always_holds(drive: SineDrive) -> bool:
    """True if static friction holds the part at every phase."""
    return drive.s <= drive.gn and drive.least <= -1 and drive.largest >= 1


@compiled
def stop_after(drive: SineDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    By `phase_to_stop` of |u|, with sign times C = c + sign mu_k s and k = sin(gamma) + sign mu_k n
    (theory 13.2).
    """
    C, k = sine_terms(drive, kind_of(sign))
    return phase_to_stop(abs(u), sign * C, sign * k, at, span)


@compiled
def slip_uncertainty(drive: SineDrive) -> float:
    """Return the error of the mean velocity in g/w by rounding of phases at which slips start.

    (mu_s - mu_k)(s + n) d(asin S), where a rounding dS of the threshold S of sin(tau) moves the
    phase asin(S) by dS/sqrt(1 - S^2).
    """
    jump = (drive.mu_s - drive.mu_k) * (drive.s + drive.gn)
    uncertainty = 0.0
    for threshold in (drive.least, drive.largest):
        if abs(threshold) < 1.0:
            uncertainty += jump * THRESHOLD / math.sqrt((1.0 - threshold) * (1.0 + threshold))
    return uncertainty


@compiled
def two_sided(drive: SineDrive) -> tuple[float, float]:
    """Return mean velocity and forward share of a part that slides to and fro and never sticks.

    With amplitudes c, s of the drive along and normal, gravity n onto the floor, c1 = mu s, k1 = mu
    n, H = c k1 - c1 sin(gamma) and E = pi (c1 k1 - c sin(gamma))/H, the forward slip lasts the
    phase pi + E about the phase pi - asin(S), where

        S = pi (k1^2 - sin(gamma)^2)/(2 H cos(E/2))
        v = sqrt(1 - S^2) (2 c1 cos(E/2) + (pi c + c1 E) sin(E/2))/pi
    """
    c, s, gs, gn, mu_s, mu = drive.c, drive.s, drive.gs, drive.gn, drive.mu_s, drive.mu_k
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
