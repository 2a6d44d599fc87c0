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
    later_passage,
    next_crossing,
    next_passage,
    push_integral_at,
    push_of,
    step_at,
    velocity_from,
    within_turn,
    zero_of_velocity,
)
from vibrafeed.core.motion.kernels.sine_sums import halley, is_near_root, value_and_slope


@borrowing
def normal_numbers(drive: WaveDrive) -> tuple[float, float]:
    """Return NaN, as two numbers do not tell a wave, and gravity onto the floor, n, in g."""
    return math.nan, drive.gravity_normal


@borrowing
def track_speed(drive: WaveDrive, tau: float) -> float:
    """Return the velocity of the track along itself under a wave at phase `tau` [rad], in g/w.

    Minus the integral of the push along, without its mean: sum of (s_k cos(k tau) - c_k sin(k
    tau))/k; of steps v -> v - p D over each, less the mean of that (theory 13.14).
    """
    # Rows 2 AIR and 2 AIR + 1 of the table are the push along: its sines and cosines, or levels.
    if drive.steps == 0:
        velocity = 0.0
        for k in range(1, drive.orders + 1):
            sine_part, cosine_part = drive.table[2 * AIR, k], drive.table[2 * AIR + 1, k]
            velocity += (sine_part * math.cos(k * tau) - cosine_part * math.sin(k * tau)) / k
        return velocity
    step_start, step_velocity, mean, velocity_at_phase, phase = 0.0, 0.0, 0.0, 0.0, tau % TURN
    for step in range(drive.steps):
        end, level = drive.table[ENDS, step], drive.table[2 * AIR, step]
        if step_start <= phase:
            velocity_at_phase = step_velocity - level * (phase - step_start)
        mean += (step_velocity - 0.5 * level * (end - step_start)) * (end - step_start) / TURN
        step_velocity, step_start = step_velocity - level * (end - step_start), end
    return velocity_at_phase - mean


@borrowing
def air_integrals(drive: WaveDrive, tau: float, d: float) -> tuple[float, float]:
    """Return velocity and distance along after a flight from phase `tau` without slip."""
    return flow(drive, AIR, 0.0, tau, d)


@borrowing
def along_from_integrals(
    drive: WaveDrive, slip: float, d: float, first_integral: float, second_integral: float
) -> tuple[float, float]:
    """Return velocity and distance along after a flight for the phase `d`, in g/w and g/w^2."""
    return slip + first_integral, slip * d + second_integral


@borrowing
def push_slope(drive: WaveDrive, tau: float) -> tuple[float, float]:
    """Return NaN: a wave has steps and several harmonics, so its slope is not used."""
    return math.nan, math.nan


@borrowing
def smooth_span(drive: WaveDrive, tau: float) -> float:
    """Return a phase interval in rad after `tau` in which the drive is nearly a polynomial."""
    if drive.steps == 0:
        return SMOOTH / drive.orders
    within = within_turn(tau)
    return max(SLACK, drive.table[ENDS, step_at(drive, within)] - within)


@borrowing
def lift_off(drive: WaveDrive, tau: float) -> float:
    """Return the phase of the next lift-off, where p_z - n rises through 0 (theory 13.14)."""
    return next_crossing(drive, NORMAL, tau, True) % TURN


@borrowing
def landing(drive: WaveDrive, take_off: float, tau: float) -> float:
    """Return the flight time in rad after take-off at phase `tau` under a wave; -1 if not found.

    As under a sine, between two changes of sign of the normal acceleration (theory 13.14).
    """
    d, velocity = 0.0, take_off
    net_push = acceleration(drive, NORMAL, tau)
    if take_off > 0.0 and net_push < 0.0:
        # A small hop: twice the parabola's own time is past the landing, or soon will be.
        end, guess = next_passage(drive, NORMAL, tau)[0] - tau, -2.0 * take_off / net_push
        for _ in range(64):
            if not guess < end:
                break
            if flow(drive, NORMAL, take_off, tau, guess)[1] <= 0.0:
                return landing_root(drive, 0.0, take_off, tau, 0.0, guess)
            guess *= 2.0
    push_integral = push_integral_at(drive, NORMAL, tau)
    for _ in range(MAX_PIECES):
        passage, rises = later_passage(drive, NORMAL, tau + d)
        end = passage - tau
        end_velocity, height = flow(drive, NORMAL, take_off, tau, end)
        if not rises:  # it falls at the end: the height bent up
            if velocity < 0.0:
                lowest = end
                if end_velocity > 0.0:
                    lowest = zero_of_velocity(
                        drive, NORMAL, take_off, tau, push_integral, d, end, velocity, end_velocity
                    )
                    height = flow(drive, NORMAL, take_off, tau, lowest)[1]
                if height <= 0.0:
                    return landing_root(drive, 0.0, take_off, tau, d, lowest)
        elif end_velocity < 0.0 and height <= 0.0:
            return landing_root(drive, 0.0, take_off, tau, d, end)
        d, velocity = end, end_velocity
    return -1.0


@borrowing
def landing_root(
    drive: WaveDrive,
    start_height: float,
    start_velocity: float,
    tau: float,
    low: float,
    high: float,
) -> float:
    """Return the phase after `tau`, from `low` to `high`, at which a part's height falls through 0.

    Halley's iteration from where the parabola at `high` falls through 0: `high` may be the lowest
    point, where the velocity is rounding and no step leads anywhere.
    """
    velocity, height = flow(drive, NORMAL, start_velocity, tau, high)
    height += start_height
    net_push = acceleration(drive, NORMAL, tau + high)
    slowing = math.sqrt(max(0.0, velocity * velocity - 2.0 * height * net_push)) - velocity
    guess = high + 2.0 * height / slowing if slowing > 0.0 else low
    d = guess if low < guess <= high else 0.5 * (low + high)
    for _ in range(MAX_ITERATIONS):
        velocity, height = flow(drive, NORMAL, start_velocity, tau, d)
        height += start_height
        if height > 0.0:
            low = d
        else:
            high = d
        net_push = acceleration(drive, NORMAL, tau + d)
        next_d = d - halley(height, velocity, net_push)
        is_small_step = low <= next_d <= high and abs(next_d - d) <= LAST_STEP * d
        if is_small_step and is_near_root(height, velocity, net_push, LAST_STEP):
            return next_d
        if not low < next_d < high:
            next_d = 0.5 * (low + high)
            if next_d in (low, high):
                return next_d
        d = next_d
    return d


@borrowing
def hop_height(
    drive: WaveDrive, take_off: float, tau: float, span: float, known_height: float
) -> float:
    """Return the largest height of a flight in g/w^2, or `known_height` if larger.

    Tops are looked for only if (n + s) span^2/8 is above that: z'' >= -(n + s), and both ends
    are on the floor.
    """
    if (drive.gravity_normal + drive.push_normal) * span * span / 8 <= known_height:
        return known_height
    highest, d, velocity = known_height, 0.0, take_off
    push_integral = push_integral_at(drive, NORMAL, tau)
    for _ in range(MAX_PIECES):
        end = min(span, later_passage(drive, NORMAL, tau + d)[0] - tau)
        end_velocity = velocity_from(drive, NORMAL, take_off, tau, push_integral, end)[0]
        if velocity >= 0.0 > end_velocity:
            top = zero_of_velocity(
                drive, NORMAL, take_off, tau, push_integral, d, end, velocity, end_velocity
            )
            highest = max(highest, flow(drive, NORMAL, take_off, tau, top)[1])
        d, velocity = end, end_velocity
        if d >= span:
            break
    return highest


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
def stop_after(drive: WaveDrive, sign: float, slip: float, phase: float, span: float) -> float:
    """Return the phase in rad until a slip in direction `sign` stops; -1 if not within `span`.

    Between two changes of sign of the acceleration the velocity is monotonic, so that one piece
    after the other is tested by its end (theory 13.14).
    """
    kind, low, velocity_at_low = kind_of(sign), 0.0, slip
    push_integral = push_integral_at(drive, kind, phase)
    if slip == 0.0:
        # From rest a part starts to slide only where it gains speed, whatever rounding says.
        low, velocity_at_low = next_crossing(drive, kind, phase, sign < 0.0) - phase, sign
    for _ in range(MAX_PIECES):
        if not low < span:
            return -1.0
        high = min(span, later_passage(drive, kind, phase + low)[0] - phase)
        velocity_at_high = velocity_from(drive, kind, slip, phase, push_integral, high)[0]
        if sign * velocity_at_high <= 0.0:
            return zero_of_velocity(
                drive,
                kind,
                slip,
                phase,
                push_integral,
                low,
                high,
                velocity_at_low,
                velocity_at_high,
            )
        low, velocity_at_low = high, velocity_at_high
    return -1.0


@borrowing
def slip_uncertainty(drive: WaveDrive) -> float:
    """Return the error of a mean velocity in g/w by rounding of the phases at which slips start.

    The phase is uncertain by the rounding of the push over its slope; steps have no such error.
    """
    if drive.steps > 0:
        return 0.0
    size = drive.push_along + drive.mu_s * (drive.push_normal + drive.gravity_normal)
    jump, uncertainty = (drive.mu_s - drive.mu_k) * (drive.push_normal + drive.gravity_normal), 0.0
    for kind in (STATIC_FORWARD, STATIC_BACKWARD):
        row = drive.table[ROOTS + kind]
        for number in range(1, int(row[0]) + 1):
            slope = value_and_slope(push_of(drive, kind), row[number])[1]
            uncertainty += jump * THRESHOLD * size / max(abs(slope), 1e-8 * size)
    return uncertainty


@borrowing
def sliding_without_stick(drive: WaveDrive) -> tuple[float, float]:
    """Return no closed form of sliding without stick (0, 0): under a wave none is known."""
    return 0.0, 0.0
