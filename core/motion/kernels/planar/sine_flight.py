"""A flight from take-off to landing, under a sine: its part of `drive`."""

from __future__ import annotations

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
    phase_to,
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
    """Return the velocity of the track along itself at phase `tau`, c cos(tau), in g/w.

    Minus the integral of the drive acceleration c sin(tau), c its amplitude in g. Here w = 2 pi f.
    """
    return drive.c * math.cos(tau)


@compiled
def air_swings(drive: SineDrive, tau: float, d: float) -> tuple[float, float]:
    """Return the `swings` of a flight from phase `tau` for the phase `d`, the same for every drive.

    Velocity and distance along that a drive of 1 g gives.
    """
    return swings(math.sin(tau), math.cos(tau), d)


@compiled
def swung_along(
    drive: SineDrive, u: float, d: float, swing: float, sway: float
) -> tuple[float, float]:
    """Return velocity and distance along after a flight for the phase `d`, in g/w and g/w^2.

    `u` is the velocity at take-off, `swing` and `sway` are the `air_swings` (w = 2 pi f).
    """
    return swung(u, drive.c, drive.gs, d, swing, sway)


@compiled
def push_slope(drive: SineDrive, tau: float) -> tuple[float, float]:
    """Return the derivative of the drive acceleration by phase, along and normal to the floor.

    (c, s) cos(tau) at phase `tau`, with the amplitudes c and s in g.
    """
    cosine = math.cos(tau)
    return drive.c * cosine, drive.s * cosine


@compiled
def smooth_span(drive: SineDrive, tau: float) -> float:
    """Return the phase interval in rad, 1.5, in which a sine is a polynomial up to rounding."""
    return SMOOTH


@compiled
def lift_off(drive: SineDrive, tau: float) -> float:
    """Return the phase in rad of the next lift-off, asin(n/s); NaN if the part never lifts off.

    There s sin(tau) rises through n, with normal drive amplitude s and gravity n, once in each
    period, so that it does not depend on the phase `tau` (theory 13.3).
    """
    return drive.up_at


@compiled
def landing_root(w: float, s: float, gn: float, sine: float, cosine: float, start: float) -> float:
    """Return the time of a flight in rad by Newton's method from `start`, on one side of the root.

    D -> D - z(D)/w(D), with the height z and velocity w off the floor, w' = s sin(tau) - gn, with
    the drive `s` and gravity `gn` in g. `w` is the velocity at take-off in g/(2 pi f), `sine` and
    `cosine` are those of its phase. The caller chooses `start` such that the height bends one way
    between it and the root, so that no step passes the root but by rounding.
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
    """Return the phase D in rad after take-off, in `low` to `high`, at which a height is least.

    The part takes off at phase `tau` in rad with velocity `w` in g/(2 pi f); its acceleration is s
    sin(tau + D) - gn in g, with drive `s` and gravity `gn`. At the least height the velocity rises
    through 0: a root found by Newton's iteration in the bracket, halved where it leaves it. Used to
    see if a flight touches the floor on its way.
    """
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

    s and n are vibration off the floor and gravity of `drive`, `w` >= 0 is the velocity at take-off
    in g/(2 pi f). The height's second derivative is s sin(tau) - n: it bends down where s sin(tau)
    < n, and up elsewhere. A piece that bends down and ends above the floor was above it all the
    way; on a piece that bends up the least height is found first (theory 13.3). As sin <= 1, the
    height is above the parabola (w + s cos(tau)) D - s (1 - sin(tau)) - n D^2/2 after a phase D:
    whole turns in which that is positive are skipped.
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
    """Return the largest height of a flight in g/(2 pi f)^2, or `known` if that is larger.

    The part takes off at phase `tau` in rad with velocity `w` in g/(2 pi f) and flies for `span`
    rad; `known` is the largest height of earlier flights. To save time the top is sought only if
    two bounds are above `known`: (n + s) span^2/8, since z'' >= -(n + s) with gravity n and drive s
    in g and both ends are on the floor, and `height_bound`.
    """
    if (drive.gn + drive.s) * span * span / 8 <= known:
        return known
    if height_bound(drive, w, tau, known) <= known:
        return known
    at = top_at(drive, w, tau, span)
    return max(known, distance_after(w, drive.s, drive.gn, tau, at))


@compiled
def height_bound(drive: SineDrive, w: float, tau: float, known: float) -> float:
    """Return an upper bound of a flight's height in g/w^2, as close as a comparison needs.

    Most flights are lower than the highest `known` height (here w = 2 pi f), which this tells
    without a search for the summit. The part takes off at phase `tau` with velocity `w` in g/(2 pi
    f); s and n are vibration off the floor and gravity of `drive`. The height z after a phase D is,
    with r = w + s cos(tau) and x = D - r/n,

        z = r^2/(2 n) + s sin(tau) - n x^2/2 - s sin(tau + r/n + x).

    The last term is at most s, and s cos(d - |x|) where the sine's trough is d <= pi away at x = 0.
    That rises with |x| up to d while -n x^2/2 falls: on each of some pieces it is bounded by the
    end of the one and the start of the other.
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

    The part takes off at phase `tau` in rad with velocity `w` in g/(2 pi f). With drive s and
    gravity n normal to the floor in g, the height is the parabola w D + s cos(tau) D - n D^2/2 and
    a sine of size s, so that its top is within 2 sqrt(s/n) + 1 of that of the parabola, (w + s
    cos(tau))/n: the highest of many points there, then the zero of the velocity by Newton's
    iteration.
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
