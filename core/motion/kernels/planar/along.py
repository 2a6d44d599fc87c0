"""The motion along the track over a cycle: slide, the slip at which it repeats, its means."""

import math

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.constants import (
    COLUMN,
    DISTANCE,
    MODE,
    MODES,
    PIECE,
    SEGMENT,
    STATUS,
    SUMS,
    TIMES,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats, Stop, copy
from vibrafeed.core.motion.kernels.planar.cycle import phase_uncertainty
from vibrafeed.core.motion.kernels.planar.flow import EPSILON, MAX_ITERATIONS, TURN
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    first_slip,
    fly,
    hold,
    holds,
    hop_height,
    lifts,
    load,
    restitution_of,
    slide,
    slip_acceleration,
    slip_uncertainty,
    soft_hop_errors,
    stop_after,
    to_lift_off,
    track_speed,
)

MAX_MODES = 1_000
"""Stops and starts in one segment: an acceleration of ten harmonics changes sign 20 times a period.
More are roundings that go on for ever."""


@borrowing
def write_piece(
    log: Floats,
    row: int,
    phase: float,
    span: float,
    mode: int,
    slip: float,
    normal_velocity: float,
    position: float,
) -> int:
    """Write one piece of a motion into the log (columns of `PIECE`); return the rows in use."""
    if row < log.shape[0]:
        log[row, PIECE.phase], log[row, PIECE.span], log[row, PIECE.mode] = phase, span, mode
        log[row, PIECE.along], log[row, PIECE.normal], log[row, PIECE.position] = (
            slip,
            normal_velocity,
            position,
        )
        return row + 1
    return row


@borrowing
def contact(
    tau: float, span: float, slip: float, drive: Drive, sums: Floats, log: Floats, log_rows: int
) -> tuple[float, float, int]:
    """Return slip velocity after a contact, its derivative by that before, and log rows in use.

    It sticks until `hold` ends, slips until `stop_after`, and so on (theory 13.4). The derivative
    is 1 while sliding, u'(after)/u'(before) times that at a turn, 0 after a stick (13.8); -1 rows:
    too many stops.
    """
    phase, end, derivative = tau, tau + span, 1.0
    for _ in range(MAX_MODES):
        if phase >= end:
            return slip, derivative, log_rows
        if slip == 0:
            sticks, leave, forward = hold(drive, phase, end)
            if sticks:
                derivative = 0.0
                log_rows = write_piece(
                    log, log_rows, phase, leave - phase, MODE.stick, 0.0, 0.0, sums[DISTANCE]
                )
                sums[TIMES + MODE.stick] += leave - phase
                if leave >= end:
                    return 0.0, derivative, log_rows
                phase = leave
            sign = 1.0 if forward else -1.0
        else:
            sign = 1.0 if slip > 0 else -1.0
        stop = stop_after(drive, sign, slip, phase, end - phase)
        duration = end - phase if stop < 0 else stop
        mode = MODE.forward if sign > 0 else MODE.backward
        log_rows = write_piece(log, log_rows, phase, duration, mode, slip, 0.0, sums[DISTANCE])
        slip_after, distance = slide(drive, sign, slip, phase, duration)
        sums[DISTANCE] += distance
        sums[TIMES + mode] += duration
        if stop < 0:
            return (slip_after if slip_after * sign > 0 else 0.0), derivative, log_rows
        phase += duration
        slip = 0.0
        if derivative > 0 and not holds(drive, phase):
            # The part turns round at once: a later stop shortens the way back.
            slip_rate_before = slip_acceleration(drive, sign, phase)
            slip_rate_after = slip_acceleration(drive, -sign, phase)
            derivative = (
                derivative * slip_rate_after / slip_rate_before if slip_rate_before != 0 else 0.0
            )
    return slip, derivative, -1


@borrowing
def tiny_hop_direction(drive: Drive, tau: float) -> float:
    """Return the direction in which tiny hops at phase `tau` drive a part from rest: 1, -1 or 0.

    If |a| > mu_k n, with a = b_x - sin(gamma), the slip grows from hop to hop (theory 13.5).
    """
    acceleration = slip_acceleration(drive, 0.0, tau)
    return (
        math.copysign(1.0, acceleration)
        if abs(acceleration) > drive.mu_k * load(drive, tau)
        else 0.0
    )


@borrowing
def slip_after_hops(drive: Drive, tau: float, slip: float, rebound: float) -> float:
    """Return the slip velocity at the start of a contact that stands for many small hops.

    In g/w; the slip itself if it exceeds mu_k w with the `rebound` w of the first hop left out,
    else 0, or +-mu_k w of a part that tiny hops drive on (`tiny_hop_direction`) (theory 13.5).
    """
    if rebound == 0.0 or abs(slip) > drive.mu_k * rebound:
        return slip
    direction = tiny_hop_direction(drive, tau)
    return slip if direction == 0.0 else direction * drive.mu_k * rebound


@borrowing
def follow_cycle(
    segments: Floats, count: int, slip: float, drive: Drive, sums: Floats, log: Floats
) -> tuple[float, float, int]:
    """Follow the slip of a part along a cycle that is known normal to the floor.

    A landing with the impulse I takes mu_k I off the slip in g/w, or all of it if it is no larger
    (theory 13.4). Return slip at the end, its derivative by `slip`, log rows in use; -1 if a limit
    came first.
    """
    mu_k = drive.mu_k
    sums[:] = 0.0
    derivative, log_rows = 1.0, 0
    for segment in range(count):
        tau, span = segments[segment, SEGMENT.phase], segments[segment, SEGMENT.span]
        take_off = segments[segment, SEGMENT.take_off]
        if take_off < 0:
            slip_after = slip_after_hops(drive, tau, slip, segments[segment, SEGMENT.impulse])
            if slip_after != slip:
                slip, derivative = slip_after, 0.0
            slip, contact_derivative, log_rows = contact(
                tau, span, slip, drive, sums, log, log_rows
            )
            if log_rows < 0:
                return slip, derivative, log_rows
            derivative *= contact_derivative
            continue
        log_rows = write_piece(
            log, log_rows, tau, span, MODE.flight, slip, take_off, sums[DISTANCE]
        )
        slip, distance = fly(drive, slip, tau, span)
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        friction_impulse = mu_k * segments[segment, SEGMENT.impulse]
        if abs(slip) <= friction_impulse:
            slip = 0.0
            derivative = 0.0 if friction_impulse > 0 else derivative
        else:
            slip -= friction_impulse if slip > 0 else -friction_impulse
    return slip, derivative, log_rows


LONGEST_MULTIPLE = 16  # most cycles after which a motion under two friction coefficients may repeat
MAX_UNSURE = 1e-3  # over the drive: a velocity that rounding leaves less sure gives no result

RepeatingSlip = tuple[float, float, int, int]
"""Velocity, estimate of its error, cycles after which it repeats (0: not found), status."""


@compiled
def repeating_slip(
    segments: Floats,
    count: int,
    slip: float,
    drive: Drive,
    tolerance: float,
    max_periods: int,
    sums: Floats,
    log: Floats,
    stop: Stop,
) -> RepeatingSlip:
    """Return the slip velocity at the start of a cycle once the motion along the track repeats.

    By bracketing if mu_s = mu_k, else by following the part from cycle to cycle (theory 13.8).
    """
    if drive.mu_s == drive.mu_k:
        return bracketed_slip(segments, count, slip, drive, tolerance, sums, log)
    return followed_slip(segments, count, slip, drive, tolerance, max_periods, sums, log, stop)


@compiled
def bracketed_slip(
    segments: Floats,
    count: int,
    slip: float,
    drive: Drive,
    tolerance: float,
    sums: Floats,
    log: Floats,
) -> RepeatingSlip:
    """Return the slip velocity with which a cycle repeats, for equal friction coefficients.

    Coulomb friction never drives two motions under one normal force apart: the map F from slip to
    slip over a cycle has 0 <= F' <= 1, so that the sign of F(u) - u brackets the root u (theory
    13.8).
    """
    scale = drive.push_along + abs(drive.gravity_along)
    low, high, stride = -math.inf, math.inf, 1.0
    for _ in range(MAX_ITERATIONS):
        slip_after, derivative, log_rows = follow_cycle(segments, count, slip, drive, sums, log)
        if log_rows < 0:
            return slip, math.inf, 0, STATUS.limit_reached
        change = slip_after - slip
        error = abs(change) / max(1e-300, 1 - derivative) if derivative < 1 else math.inf
        # The change is known but for rounding; the state the less, the nearer the slope is to 1.
        rounding_error = (
            EPSILON * scale / max(1e-300, 1 - derivative) if derivative < 1 else math.inf
        )
        if (change == 0 or error <= tolerance * scale) and rounding_error <= MAX_UNSURE * scale:
            return slip, error + rounding_error, 1, STATUS.periodic
        if abs(change) <= EPSILON * scale and rounding_error > MAX_UNSURE * scale:
            return slip, rounding_error, 0, STATUS.limit_reached
        if change > 0:
            low = slip
        else:
            high = slip
        if derivative < 1:
            next_slip = slip + change / (1 - derivative)
        else:  # nothing stopped it all cycle long: look further out, ever faster
            next_slip = slip + change * stride
            stride *= 2
        if not low < next_slip < high:
            next_slip = (low + high) / 2 if high - low < math.inf else slip_after
        if next_slip == slip:
            is_sure = rounding_error <= MAX_UNSURE * scale
            return (
                slip,
                abs(change) + rounding_error,
                1 if is_sure else 0,
                STATUS.periodic if is_sure else STATUS.limit_reached,
            )
        slip = next_slip
    return slip, abs(change), 0, STATUS.limit_reached


@compiled
def followed_slip(
    segments: Floats,
    count: int,
    slip: float,
    drive: Drive,
    tolerance: float,
    max_periods: int,
    sums: Floats,
    log: Floats,
    stop: Stop,
) -> RepeatingSlip:
    """Return the slip velocity with which a cycle repeats, by following the motion.

    For static friction above kinetic, where the start decides which of several motions is reached.
    The slip u_k after k cycles repeats after m if |u_k - u_(k-m)| <= tol (1 - f'), f' the product
    of the m slopes of the cycles (theory 13.8).
    """
    scale = drive.push_along + abs(drive.gravity_along)
    slips = np.empty(LONGEST_MULTIPLE + 1)
    derivatives = np.empty(LONGEST_MULTIPLE + 1)
    for cycle in range(max(8, max_periods)):
        if raised(stop):
            break
        slip_after, derivative, log_rows = follow_cycle(segments, count, slip, drive, sums, log)
        if log_rows < 0:
            return slip, math.inf, 0, STATUS.limit_reached
        if slides_away(drive, sums, slip, slip_after, derivative):
            return slip, math.inf, 0, STATUS.runaway
        history = min(cycle, LONGEST_MULTIPLE)
        for age in range(history, 0, -1):
            slips[age] = slips[age - 1]
            derivatives[age] = derivatives[age - 1] * derivative
        slips[0], derivatives[0] = slip, derivative
        result = slip_in_history(slip_after, slips, derivatives, history, tolerance, scale)
        if result[2] > 0:
            return result
        slip = extrapolated_slip(segments, count, slip, slip_after, derivative, drive, sums, log)
    return slip, math.inf, 0, STATUS.limit_reached


@compiled
def slides_away(
    drive: Drive, sums: Floats, slip: float, slip_after: float, derivative: float
) -> bool:
    """True if a part slid downhill over a whole cycle and gained speed, so that it runs away.

    `derivative` is 1 if it only slid; mu_k n < |sin(gamma)| (theory 13.8).
    """
    gravity_along = drive.gravity_along
    uphill = sums[TIMES + (MODE.forward if gravity_along > 0 else MODE.backward)]
    slid_down = derivative == 1 and uphill == 0 and sums[TIMES + MODE.stick] == 0
    is_steep = drive.mu_k * drive.gravity_normal < abs(gravity_along)
    return (
        is_steep
        and slid_down
        and (slip_after - slip) * gravity_along < 0
        and slip * gravity_along < 0
        and slip_after * gravity_along < 0
    )


@compiled
def slip_in_history(
    slip_after: float,
    slips: Floats,
    derivatives: Floats,
    history: int,
    tolerance: float,
    scale: float,
) -> RepeatingSlip:
    """Return the slip velocity with which a motion along the track repeats, and its error."""
    for multiple in range(1, history + 2):
        earlier_slip, derivative = slips[multiple - 1], abs(derivatives[multiple - 1])
        error = (
            abs(slip_after - earlier_slip) / max(1e-300, 1 - derivative)
            if derivative < 1
            else math.inf
        )
        rounding_error = (
            EPSILON * scale / max(1e-300, 1 - derivative) if derivative < 1 else math.inf
        )
        if slip_after == earlier_slip and rounding_error <= MAX_UNSURE * scale:
            return slip_after, rounding_error, multiple, STATUS.periodic
        if error <= tolerance * scale and rounding_error <= MAX_UNSURE * scale:
            return slip_after, error + rounding_error, multiple, STATUS.periodic
    return slip_after, math.inf, 0, STATUS.limit_reached


@compiled
def extrapolated_slip(
    segments: Floats, count: int, slip: float, slip_after: float, derivative: float, drive: Drive,
    sums: Floats, log: Floats,
) -> float:  # fmt: skip
    """Return the next slip velocity to try in the search for the one with which a cycle repeats.

    f(u) of the slip u, or the fixed point of the tangent, u + (f(u) - u)/(1 - f'), if it jumps over
    no other cycle.
    """
    change = slip_after - slip
    tangent_slip = slip + change / (1 - derivative) if 0 < derivative < 1 else slip_after
    if not (derivative > 0.5 and tangent_slip * slip_after > 0):
        return slip_after
    slip_after_tangent, _, log_rows = follow_cycle(segments, count, tangent_slip, drive, sums, log)
    is_accepted = log_rows >= 0 and abs(slip_after_tangent - tangent_slip) < 0.1 * abs(change)
    for quarter in range(1, 4):
        if is_accepted:
            slip_between = slip_after + (tangent_slip - slip_after) * quarter / 4
            slip_after_between, derivative_between, log_rows = follow_cycle(
                segments, count, slip_between, drive, sums, log
            )
            is_accepted = (
                log_rows >= 0
                and derivative_between > 0
                and (slip_after_between - slip_between) * change > 0
            )
    return tangent_slip if is_accepted else slip_after


ROUNDING = 4e-14  # error of a mean velocity by rounding, over the drive and friction's impulses
CLOSE = 1e-9
"""Largest error of the slip at which a cycle repeats: it is read off a slope that may change on the
way there; where a hundredth was asked for, a mean was off by up to 29 times what was said."""
MAX_RUBBING = 8.0
"""Friction adds up over no more than so many times the share of the period in which a part slides,
times its largest: what is huge acts for as short a time."""


@compiled
def velocity_at_start(
    drive: Drive, phase: float, segments: Floats, first: int, count: int
) -> float:
    """Return the slip velocity in g/w at the start of the cycle of a part at rest at `phase`."""
    if drive.mu_s == 0 and drive.gravity_along == 0:  # nothing acts along the track but the drive
        return track_speed(drive, phase) - track_speed(drive, segments[first, SEGMENT.phase])
    if lifts(drive):
        sums, no_log = np.zeros(SUMS), np.empty((0, len(PIECE)))
        # A part that lifts off starts on the floor, at least at the drive's own zero.
        span = to_lift_off(drive, phase)
        slip = contact(phase, span, 0.0, drive, sums, no_log, 0)[0]
        if segments[count - 1, SEGMENT.take_off] >= 0:
            # A cycle without contact: friction brings any velocity to the same motion.
            return 0.0
        return follow_cycle(segments, first, slip, drive, sums, no_log)[0] if first > 0 else slip
    slip_phase = first_slip(drive, phase)
    if not math.isnan(slip_phase):
        segments[first, SEGMENT.phase] = slip_phase
    return 0.0


@compiled
def fill_frictionless_sums(
    drive: Drive, phase: float, segments: Floats, count: int, periods: int, sums: Floats
) -> None:
    """Fill the sums over a cycle of a part without friction on the level, which keeps its speed."""
    flight_time = 0.0
    for segment in range(count):
        flight_time += (
            segments[segment, SEGMENT.span] if segments[segment, SEGMENT.take_off] >= 0 else 0.0
        )
    sums[:] = 0.0
    speed = track_speed(drive, phase)
    sums[DISTANCE] = speed * periods * TURN
    sums[TIMES + (MODE.forward if speed >= 0 else MODE.backward)] = periods * TURN - flight_time
    sums[TIMES + MODE.flight] = flight_time


@compiled
def write_impacts(segments: Floats, count: int, drive: Drive, periods: int, result: Floats) -> None:
    """Fill the results that depend on flights: impacts a period, landing speed, hop height."""
    impacts, fastest, highest = 0, 0.0, 0.0
    for segment in range(count):
        if segments[segment, SEGMENT.take_off] >= 0:
            impacts += 1
            fastest = max(fastest, segments[segment, SEGMENT.landing])
            highest = hop_height(
                drive,
                segments[segment, SEGMENT.take_off],
                segments[segment, SEGMENT.phase],
                segments[segment, SEGMENT.span],
                highest,
            )
    result[COLUMN.impacts] = impacts / periods
    result[COLUMN.landing_speed], result[COLUMN.hop_height] = fastest, highest


@compiled
def fill_repeating(
    segments: Floats, count: int, periods: int, phase: float, slip: float, drive: Drive, cell: Cell,
    sums: Floats, log: Floats, result: Floats, stop: Stop,
) -> tuple[int, float]:  # fmt: skip
    """Fill `result` with the means of a motion that repeats; return its status and slip."""
    push_along, push_normal, gravity_along, gravity_normal, mu_s, mu_k = (
        drive.push_along,
        drive.push_normal,
        drive.gravity_along,
        drive.gravity_normal,
        drive.mu_s,
        drive.mu_k,
    )
    error, cycles, status = 0.0, 1, STATUS.neutral
    if mu_s == 0:
        fill_frictionless_sums(drive, phase, segments, count, periods, sums)
    else:
        slip, error, cycles, status = repeating_slip(
            segments, count, slip, drive, min(cell.tolerance, CLOSE), int(cell.max_periods), sums,
            log, stop,
        )  # fmt: skip
        if cycles == 0:
            return status, 0.0
    if mu_s != mu_k:
        total = np.zeros(SUMS)
        velocity = slip
        for _ in range(cycles):
            velocity, _, _ = follow_cycle(segments, count, velocity, drive, sums, log)
            for index in range(SUMS):
                total[index] += sums[index]
        copy(total, sums)
    time = periods * cycles * TURN
    result[COLUMN.velocity], result[COLUMN.spread] = sums[DISTANCE] / time, 0.0
    sliding_fraction = (sums[TIMES + MODE.forward] + sums[TIMES + MODE.backward]) / time
    restitution = restitution_of(cell)
    phase_error = ROUNDING + (
        phase_uncertainty(segments, count, drive, restitution) if lifts(drive) else 0.0
    )
    friction_bound = (
        mu_k * (push_normal + gravity_normal) * min(1.0, MAX_RUBBING * sliding_fraction)
    )
    result[COLUMN.error] = error + phase_error * (push_along + abs(gravity_along) + friction_bound)
    result[COLUMN.error] += (
        mu_k * soft_hop_errors(segments, count, drive, restitution)[0] / (periods * TURN)
    )
    if mu_s > mu_k and sums[TIMES + MODE.stick] > 0.0:
        result[COLUMN.error] += slip_uncertainty(drive) * sliding_fraction
    for mode in range(MODES):
        result[COLUMN.stick + mode] = sums[TIMES + mode] / time
    write_impacts(segments, count, drive, periods, result)
    result[COLUMN.multiple] = float(periods * cycles)
    return status, slip
