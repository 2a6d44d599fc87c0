"""Flight, stick and slip of a part under a wave: what a wave tells in `plane_laws`."""

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import (
    AIR,
    MAX_ITERATIONS,
    MAX_PIECES,
    NORMAL,
    SMOOTH,
    STATIC_BACKWARD,
    STATIC_FORWARD,
    TURN,
    kind_of,
)
from vibrafeed.core.motion.kernels.planar.wave import (
    ENDS,
    LAST_STEP,
    ROOTS,
    SLACK,
    WaveDrive,
    acceleration,
    flow,
    folded,
    later_passage,
    next_of_way,
    next_passage,
    push_of,
    speed_from,
    speed_start,
    step_at,
    zero_of_velocity,
)
from vibrafeed.core.motion.kernels.sine_sums import halley, is_near_root, value_and_slope


@borrowing
def normal_numbers(drive: WaveDrive) -> tuple[float, float]:
    """Return NaN, as two numbers do not tell a wave, and gravity onto the floor, n, in g."""
    return math.nan, drive.gn


@borrowing
def track_speed(drive: WaveDrive, tau: float) -> float:
    """Return the velocity of the track along itself under a wave at phase `tau` [rad], in g/w.

    Minus the integral of the push along, without its mean: sum of (s_k cos(k tau) - c_k sin(k
    tau))/k; of steps v -> v - p D over each, less the mean of that (theory 13.14).
    """
    if drive.steps == 0:
        velocity = 0.0
        for k in range(1, drive.orders + 1):
            a, b = drive.table[2 * AIR, k], drive.table[2 * AIR + 1, k]
            velocity += (a * math.cos(k * tau) - b * math.sin(k * tau)) / k
        return velocity
    at, now, mean, speed, within = 0.0, 0.0, 0.0, 0.0, tau % TURN
    for step in range(drive.steps):
        end, level = drive.table[ENDS, step], drive.table[2 * AIR, step]
        if at <= within:
            speed = now - level * (within - at)
        mean += (now - 0.5 * level * (end - at)) * (end - at) / TURN
        now, at = now - level * (end - at), end
    return speed - mean


@borrowing
def air_swings(drive: WaveDrive, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along after a flight from phase `tau` without slip."""
    return flow(drive, AIR, 0.0, tau, d)


@borrowing
def swung_along(
    drive: WaveDrive, u: float, d: float, swing: float, sway: float
) -> tuple[float, float]:
    """Return velocity and distance along after a flight for the phase `d`, in g/w and g/w^2."""
    return u + swing, u * d + sway


@borrowing
def push_slope(drive: WaveDrive, tau: float) -> tuple[float, float]:
    """Return NaN: a wave has steps and several harmonics, so its slope is not used."""
    return math.nan, math.nan


@borrowing
def smooth_span(drive: WaveDrive, tau: float) -> float:
    """Return a phase interval in rad after `tau` in which the drive is nearly a polynomial."""
    if drive.steps == 0:
        return SMOOTH / drive.orders
    within = folded(tau)
    return max(SLACK, drive.table[ENDS, step_at(drive, within)] - within)


@borrowing
def lift_off(drive: WaveDrive, tau: float) -> float:
    """Return the phase of the next lift-off, where p_z - n rises through 0 (theory 13.14)."""
    return next_of_way(drive, NORMAL, tau, True) % TURN


@borrowing
def landing(drive: WaveDrive, w: float, tau: float) -> float:
    """Return the flight time in rad after take-off at phase `tau` under a wave; -1 if not found.

    As under a sine, between two changes of sign of the normal acceleration (theory 13.14).
    """
    d, velocity = 0.0, w
    force = acceleration(drive, NORMAL, tau)
    if w > 0.0 and force < 0.0:
        # A small hop: twice the parabola's own time is past the landing, or soon will be.
        end, guess = next_passage(drive, NORMAL, tau)[0] - tau, -2.0 * w / force
        for _ in range(64):
            if not guess < end:
                break
            if flow(drive, NORMAL, w, tau, guess)[1] <= 0.0:
                return landing_root(drive, 0.0, w, tau, 0.0, guess)
            guess *= 2.0
    start = speed_start(drive, NORMAL, tau)
    for _ in range(MAX_PIECES):
        at, rises = later_passage(drive, NORMAL, tau + d)
        end = at - tau
        last, height = flow(drive, NORMAL, w, tau, end)
        if not rises:  # it falls at the end: the height bent up
            if velocity < 0.0:
                low = end
                if last > 0.0:
                    low = zero_of_velocity(drive, NORMAL, w, tau, start, d, end, velocity, last)
                    height = flow(drive, NORMAL, w, tau, low)[1]
                if height <= 0.0:
                    return landing_root(drive, 0.0, w, tau, d, low)
        elif last < 0.0 and height <= 0.0:
            return landing_root(drive, 0.0, w, tau, d, end)
        d, velocity = end, last
    return -1.0


@borrowing
def landing_root(
    drive: WaveDrive, z: float, w: float, tau: float, low: float, high: float
) -> float:
    """Return the phase between `low` and `high` at which the height of a part falls through 0.

    Halley's iteration from where the parabola at `high` falls through 0: `high` may be the lowest
    point, where the velocity is rounding and no step leads anywhere.
    """
    velocity, height = flow(drive, NORMAL, w, tau, high)
    height += z
    force = acceleration(drive, NORMAL, tau + high)
    reach = math.sqrt(max(0.0, velocity * velocity - 2.0 * height * force)) - velocity
    guess = high + 2.0 * height / reach if reach > 0.0 else low
    d = guess if low < guess <= high else 0.5 * (low + high)
    for _ in range(MAX_ITERATIONS):
        velocity, height = flow(drive, NORMAL, w, tau, d)
        height += z
        if height > 0.0:
            low = d
        else:
            high = d
        force = acceleration(drive, NORMAL, tau + d)
        new = d - halley(height, velocity, force)
        short = low <= new <= high and abs(new - d) <= LAST_STEP * d
        if short and is_near_root(height, velocity, force, LAST_STEP):
            return new
        if not low < new < high:
            new = 0.5 * (low + high)
            if new in (low, high):
                return new
        d = new
    return d


@borrowing
def hop_height(drive: WaveDrive, w: float, tau: float, span: float, known: float) -> float:
    """Return the largest height of a flight in g/w^2, or `known` if that is larger.

    Tops are looked for only if (n + s) span^2/8 is above `known`: z'' >= -(n + s), and both ends
    are on the floor.
    """
    if (drive.gn + drive.s) * span * span / 8 <= known:
        return known
    best, d, velocity = known, 0.0, w
    start = speed_start(drive, NORMAL, tau)
    for _ in range(MAX_PIECES):
        end = min(span, later_passage(drive, NORMAL, tau + d)[0] - tau)
        last = speed_from(drive, NORMAL, w, tau, start, end)[0]
        if velocity >= 0.0 > last:
            top = zero_of_velocity(drive, NORMAL, w, tau, start, d, end, velocity, last)
            best = max(best, flow(drive, NORMAL, w, tau, top)[1])
        d, velocity = end, last
        if d >= span:
            break
    return best


THRESHOLD = 4e-16  # rounding of the push at which friction is overcome, over its size


@borrowing
def always_holds(drive: WaveDrive) -> bool:
    """True if no acceleration changes its sign, the part never lifts off, and friction holds it."""
    table = drive.table
    if table[ROOTS + NORMAL, 0] + table[ROOTS + STATIC_FORWARD, 0] > 0.0:
        return False
    return (
        table[ROOTS + STATIC_BACKWARD, 0] == 0.0
        and acceleration(drive, STATIC_FORWARD, 0.0) <= 0.0
        and acceleration(drive, STATIC_BACKWARD, 0.0) >= 0.0
    )


@borrowing
def stop_after(drive: WaveDrive, sign: float, u: float, at: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    Between two changes of sign of the acceleration the velocity is monotonic, so that one piece
    after the other is tested by its end (theory 13.14).
    """
    kind, low, first = kind_of(sign), 0.0, u
    start = speed_start(drive, kind, at)
    if u == 0.0:
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        low, first = next_of_way(drive, kind, at, sign < 0.0) - at, sign
    for _ in range(MAX_PIECES):
        if not low < span:
            return -1.0
        high = min(span, later_passage(drive, kind, at + low)[0] - at)
        last = speed_from(drive, kind, u, at, start, high)[0]
        if sign * last <= 0.0:
            return zero_of_velocity(drive, kind, u, at, start, low, high, first, last)
        low, first = high, last
    return -1.0


@borrowing
def slip_uncertainty(drive: WaveDrive) -> float:
    """Return the error of a mean velocity in g/w by rounding of the phases at which slips start.

    The phase is uncertain by the rounding of the push over its slope; steps have no such error.
    """
    if drive.steps > 0:
        return 0.0
    size = drive.c + drive.mu_s * (drive.s + drive.gn)
    jump, uncertainty = (drive.mu_s - drive.mu_k) * (drive.s + drive.gn), 0.0
    for kind in (STATIC_FORWARD, STATIC_BACKWARD):
        row = drive.table[ROOTS + kind]
        for number in range(1, int(row[0]) + 1):
            slope = value_and_slope(push_of(drive, kind), row[number])[1]
            uncertainty += jump * THRESHOLD * size / max(abs(slope), 1e-8 * size)
    return uncertainty


@borrowing
def two_sided(drive: WaveDrive) -> tuple[float, float]:
    """Return no closed form of sliding without stick (0, 0): under a wave none is known."""
    return 0.0, 0.0
