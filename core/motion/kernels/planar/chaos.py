"""Means of a motion that rounding decides, over runs from several phases."""

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import borrowing, compiled, raised
from vibrafeed.core.motion.kernels.constants import (
    COLUMN,
    DISTANCE,
    MAX_SEGMENTS,
    MODE,
    MODES,
    PIECE,
    RESULTS,
    STATUS,
    TIMES,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats, Stop
from vibrafeed.core.motion.kernels.means import SETTLING, mean_error, scatter
from vibrafeed.core.motion.kernels.planar.along import contact, fill_repeating, slip_after_hops
from vibrafeed.core.motion.kernels.planar.cycle import (
    FIRST_LOOK,
    LONGEST_CYCLE,
    find_cycle,
    write_segment,
)
from vibrafeed.core.motion.kernels.planar.flow import EPSILON, KEPT_BITS, TURN, rounded_to_32_bits
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    Restitution,
    fly,
    hop_height,
    impulse,
    landing,
    lift_off,
    load,
    rebound,
    rests,
    rise,
    rounded,
    to_lift_off,
)

PHASES = 8  # runs of a motion that rounding decides, started at as many phases
SURE = 5.41  # Student's quantile for 99.9 % and eight numbers (7 degrees), in standard errors
QUARTERS = 4  # means of a run: two make a batch, and their differences show a drift
SLOWING = 0.9  # largest ratio of a drift to that half a run before: slower decays are cut to it
SEARCHES = 3  # of the runs, that many look for a cycle; if none finds one, the others do not look
LAST_LOOK = 2  # of `max_periods`, for one more run that looks for a cycle if no other has found one
PATIENCE = 512  # hops without rest after which no cycle of hops is expected any more
MORE_PATIENCE = 1024  # the same, if another run has fallen into a cycle
RECENT = 64  # hops since the last rest, from which on a part may be nearing a cycle
PERIODS_A_START = 32  # of `max_periods`, for each start of a motion that is `sensitive`
MAX_STARTS = 256  # starts: a share of them is then known to 1/16 of its standard deviation
HOPS_PER_PERIOD = 16  # largest mean number of hops a period of a run; more end it
SETTLED_ROUGHLY = 1e-8  # as `SETTLED_EXACTLY`, for runs whose mean is known to 1e-3 at best
JOLT = 1e-8
"""Largest take-off speed of a lift-off from rest, in g/w; it grows as roundings do, or more."""
GOLDEN = 0.6180339887498949  # golden ratio: its multiples modulo 1 never coincide
COARSER = 1.0 / (KEPT_BITS * EPSILON)
"""Factor from the error by roundings of `EPSILON` to that beyond 32 bits."""


class FollowedRun(NamedTuple):
    """Sums over one long run of a part whose motion does not repeat.

    `time` (phase in rad) is what the sums are taken over, 0 if the hops allowed did not reach
    beyond the part that is dropped; the first `periods` periods are complete. `runs_away`: it slid
    downhill all the time and gained speed. `least` and `most` are the extreme mean velocities from
    one rest on the floor to the next. `hops` is not 0 if the run ended in a cycle of so many, which
    takes `time`.
    """

    time: float
    periods: int
    impacts: int
    fastest: float
    highest: float
    runs_away: bool
    least: float
    most: float
    hops: int


@borrowing
def jolt_speed(number: int, gn: float) -> float:
    """Return a tiny take-off speed for the `number`-th lift-off from rest, different for every one.

    1e-8 n (0.618 k mod 1) in g/w, with the load number n = `gn` and k = `number`.
    """
    return JOLT * gn * ((GOLDEN * number) % 1.0)


@borrowing
def distribute_distance(
    travel: Floats, period: int, begin: float, end: float, distance: float
) -> int:
    """Share a distance out to the periods in which it was covered; return how many are complete."""
    while period < travel.size and period * TURN < end:
        period_end = (period + 1) * TURN
        overlap = min(end, period_end) - max(begin, period * TURN)
        travel[period] += distance * overlap / (end - begin)
        if end < period_end:
            break
        period += 1
    return period


@borrowing
def slip_after_landing(
    slip: float, mu_k: float, landing_speed: float, rebound_speed: float
) -> float:
    """Return the slip velocity after a landing, which friction lowers by mu_k times both speeds."""
    friction_impulse = mu_k * (landing_speed + rebound_speed)
    return (
        0.0
        if abs(slip) <= friction_impulse
        else slip - (friction_impulse if slip > 0 else -friction_impulse)
    )


@compiled
def flight_and_landing(
    drive: Drive, restitution: Restitution, slip: float, take_off: float, tau: float, span: float
) -> tuple[float, float, float, float, bool]:
    """Return landing speed, rebound, slip and distance of a flight, and True if the part stays."""
    landing_speed = max(0.0, -rise(drive, take_off, tau, span)[0])
    rebound_speed = rebound(restitution, landing_speed)[0]
    slip, distance = fly(drive, slip, tau, span)
    stays = rests(drive, (tau + span) % TURN, rebound_speed, restitution, SETTLED_ROUGHLY)
    return (
        landing_speed,
        rebound_speed,
        slip_after_landing(slip, drive.mu_k, landing_speed, 0.0 if stays else rebound_speed),
        distance,
        stays,
    )


@borrowing
def first_flight(
    number: int, phase: float, drive: Drive, sums: Floats, no_log: Floats
) -> tuple[float, float, float, float, bool]:
    """Return the first lift-off of a long run: slip, take-off speed, phase, and time before it."""
    # The last value is True if the part lay on the floor before. Runs start at equal phases; each
    # further round of them is shifted by the golden ratio.
    tau = (phase + TURN * (number + GOLDEN * (number // PHASES)) / PHASES) % TURN
    if load(drive, tau) > 0.0:
        slip, tau, span = contact_to_lift_off(drive, tau, 0.0, sums, no_log)
        return slip, jolt_speed(number, drive.gravity_normal), tau, span, True
    return 0.0, 0.0, tau, 0.0, False


@borrowing
def contact_to_lift_off(
    drive: Drive, tau: float, slip: float, sums: Floats, no_log: Floats
) -> tuple[float, float, float]:
    """Return slip velocity and phase at lift-off of a part on the floor, and the contact time."""
    span = to_lift_off(drive, tau)
    slip, _, _ = contact(tau, span, slip, drive, sums, no_log, 0)
    return slip, lift_off(drive, tau), span


@borrowing
def ran_away(slips_down: bool, gs: float, slip_at_begin: float, slip: float, sums: Floats) -> bool:
    """True if a run slid downhill at all landings, gained speed, and never stuck or slid uphill."""
    uphill = sums[TIMES + (MODE.forward if gs > 0 else MODE.backward)] + sums[TIMES + MODE.stick]
    return slips_down and uphill == 0 and abs(slip) > abs(slip_at_begin)


@borrowing
def widened(least: float, most: float, velocity: float) -> tuple[float, float]:
    """Return `least` and `most` of a range, widened to hold `velocity`; unchanged if it is NaN."""
    if math.isnan(velocity):
        return least, most
    return min(least, velocity), max(most, velocity)


@compiled
def long_run(
    run: int, phase: float, periods: int, patience: int, drive: Drive, restitution: Restitution,
    travel: Floats, rows: Floats, sums: Floats, stop: Stop,
) -> FollowedRun:  # fmt: skip
    """Follow a part for `periods` periods from rest, and return sums and extremes of its motion.

    Its first quarter is dropped. Each lift-off from rest gets another tiny jolt, so that the mean
    is over all ways that the part may take. If it falls into a cycle of hops, `rows` start with
    that.
    """
    gravity_along, gravity_normal, mu_k = drive.gravity_along, drive.gravity_normal, drive.mu_k
    no_log = np.empty((0, len(PIECE)))
    settling_phase = periods * SETTLING * TURN
    max_hops = HOPS_PER_PERIOD * periods + FIRST_LOOK
    elapsed, begin, impacts, fastest, highest = 0.0, math.inf, 0, 0.0, 0.0
    settling_hops = int(max_hops * SETTLING)
    sums[:], travel[:] = 0.0, 0.0
    complete_periods = 0
    slip_at_begin, slips_down = 0.0, mu_k * gravity_normal < abs(gravity_along)
    hops_since_rest, next_search, jolt_number = 0, FIRST_LOOK, run
    dropped_distance, rest_distance, rest_time = 0.0, math.nan, 0.0
    least, largest = math.inf, -math.inf
    slip, take_off, tau, elapsed, began_at_rest = first_flight(run, phase, drive, sums, no_log)
    if began_at_rest:
        rest_distance, rest_time = sums[DISTANCE], elapsed
    for hop in range(max_hops + patience):
        if raised(stop):
            break
        has_settled = elapsed >= settling_phase or hop >= settling_hops
        if has_settled and begin == math.inf:
            # From here on all is counted.
            begin, impacts, fastest, highest = elapsed, 0, 0.0, 0.0
            dropped_distance = sums[DISTANCE]
            sums[:] = 0.0
            slip_at_begin = slip
        is_long_enough = elapsed - begin >= periods * TURN - settling_phase or hop >= max_hops
        # A run that may be nearing a cycle goes on.
        if is_long_enough and not RECENT <= hops_since_rest < patience:
            break
        span = landing(drive, take_off, tau)
        if span < 0:
            break
        landing_speed, rebound_speed, slip_next, distance, stays_down = flight_and_landing(
            drive, restitution, slip, take_off, tau, span
        )
        write_segment(
            rows,
            hops_since_rest,
            tau,
            span,
            take_off,
            landing_speed,
            impulse(restitution, landing_speed, rebound_speed),
        )
        hops_since_rest += 1
        time_before, distance_before = elapsed - begin, sums[DISTANCE]
        if begin < math.inf:
            highest = hop_height(drive, take_off, tau, span, highest)
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        impacts, fastest = impacts + 1, max(fastest, landing_speed)
        elapsed += span
        tau, slip, take_off = (tau + span) % TURN, slip_next, rebound_speed
        if stays_down:
            slip, tau, span = contact_to_lift_off(
                drive, tau, slip_after_hops(drive, tau, slip, take_off), sums, no_log
            )
            jolt_number += MAX_STARTS
            take_off, elapsed = jolt_speed(jolt_number, gravity_normal), elapsed + span
            hops_since_rest, next_search = 0, FIRST_LOOK
            # The mean velocity from rest to rest, which bounds what another start may give.
            velocity = (dropped_distance + sums[DISTANCE] - rest_distance) / (elapsed - rest_time)
            least, largest = widened(least, largest, velocity)
            rest_distance, rest_time = dropped_distance + sums[DISTANCE], elapsed
        elif hops_since_rest >= next_search and patience > 0:
            next_search = hops_since_rest + hops_since_rest // 2
            cycle, turns = find_cycle(drive, restitution, rows, hops_since_rest, tau, take_off)
            if cycle:
                return FollowedRun(TURN * turns, 0, 0, 0.0, 0.0, False, least, largest, cycle)
        if hops_since_rest >= MAX_SEGMENTS - LONGEST_CYCLE - 2:  # no room for more hops
            hops_since_rest, next_search = 0, FIRST_LOOK
        if begin < math.inf:
            complete_periods = distribute_distance(
                travel,
                complete_periods,
                time_before,
                elapsed - begin,
                sums[DISTANCE] - distance_before,
            )
            slips_down = slips_down and slip * gravity_along < 0
    has_run_away = ran_away(slips_down, gravity_along, slip_at_begin, slip, sums)
    time = max(0.0, elapsed - begin)
    return FollowedRun(
        time, complete_periods, impacts, fastest, highest, has_run_away, least, largest, 0
    )


@compiled
def fill_run_means(
    run: FollowedRun, phase: float, cell: Cell, drive: Drive, rows: Floats, sums: Floats,
    result: Floats, stop: Stop,
) -> int:  # fmt: skip
    """Fill `result` (columns of `COLUMN`) with the means of one long run; return its status."""
    if run.hops > 0:
        periods, no_log = round(run.time / TURN), np.empty((0, len(PIECE)))
        return fill_repeating(
            rows, run.hops, periods, phase, 0.0, drive, cell, sums, no_log, result, stop
        )[0]  # fmt: skip
    if run.time <= 0:
        return STATUS.limit_reached
    if run.runs_away:
        return STATUS.runaway
    result[COLUMN.velocity] = sums[DISTANCE] / run.time
    result[COLUMN.error] = 0.0
    for mode in range(MODES):
        result[COLUMN.stick + mode] = sums[TIMES + mode] / run.time
    result[COLUMN.impacts] = run.impacts * TURN / run.time
    result[COLUMN.landing_speed], result[COLUMN.hop_height] = run.fastest, run.highest
    return STATUS.aperiodic


@compiled
def significant_change(later: Floats, before: Floats) -> float:
    """Return the mean difference of two sets of n numbers, 0 if chance may explain it."""
    change = later - before
    mean = change.mean()
    return mean if abs(mean) > SURE * scatter(change) / math.sqrt(change.size) else 0.0


@compiled
def batch_error(quarters: Floats) -> float:
    """Return the statistical error of the mean velocity of several runs, in g/w.

    `mean_error` of half runs plus the drift |d|, by which second halves differ from first ones
    beyond chance; where it goes on by a factor q from half to half it counts (1 + q)/(2 (1 - q))
    times (theory 13.8).
    """
    runs = quarters.shape[0]
    halves = np.empty(2 * runs)
    for run in range(runs):
        halves[2 * run] = quarters[run, :2].mean()
        halves[2 * run + 1] = quarters[run, 2:].mean()
    drift = significant_change(halves[1::2], halves[::2])
    last_change, extrapolation = significant_change(quarters[:, 3], quarters[:, 2]), 1.0
    if drift * last_change > 0.0:
        first_change = abs((quarters[:, 1] - quarters[:, 0]).mean())
        decay_ratio = abs(last_change) / max(first_change, abs(last_change) / SLOWING)
        extrapolation = max(1.0, 0.5 * (1.0 + decay_ratio) / (1.0 - decay_ratio))
    return mean_error(halves) + abs(drift) * extrapolation


@borrowing
def patience(number: int, cycles: int) -> int:
    """Return the hops without rest that run `number` waits for a cycle; 0 if it looks for none."""
    if cycles > 0:
        return MORE_PATIENCE
    return PATIENCE if number < SEARCHES or number >= PHASES else 0


@compiled
def fill_means_from_phases(
    cell: Cell, phase: float, drive: Drive, rows: Floats, sums: Floats, result: Floats, stop: Stop
) -> int:
    """Fill `result` with means over runs from several phases of the drive; return the status.

    `aperiodic` if no run ends in a cycle, nor a last one that is followed four times as long, with
    the `batch_error`. If one does, more starts follow, and the error reaches to the furthest of all
    means: `sensitive`.
    """
    drive = rounded(drive)
    restitution = Restitution(
        rounded_to_32_bits(cell.restitution), rounded_to_32_bits(cell.impact_damping)
    )
    max_periods = int(cell.max_periods)
    starts = min(MAX_STARTS, max(PHASES, max_periods // PERIODS_A_START))
    runs, quarters = np.empty((starts, RESULTS)), np.empty((PHASES, QUARTERS))
    count, cycles, cycle_error = 0, 0, 0.0
    least, largest = math.inf, -math.inf
    periods = max(1, max_periods // PHASES)
    travel = np.empty(int((1.0 - SETTLING) * periods))
    for number in range(starts):
        is_last_search = cycles == 0 and number >= PHASES
        if number >= PHASES:
            periods, travel = (
                max(1, max_periods // (LAST_LOOK if is_last_search else starts)),
                travel[:0],
            )
        hops_to_wait = patience(number, cycles)
        run = long_run(
            number, phase, periods, hops_to_wait, drive, restitution, travel, rows, sums, stop
        )
        if is_last_search and run.hops == 0:
            break
        least, largest = min(least, run.least), max(largest, run.most)
        means = runs[count]
        status = fill_run_means(run, phase, cell, drive, rows, sums, means, stop)
        if status == STATUS.limit_reached:
            return status
        if status == STATUS.runaway:
            continue
        if status != STATUS.aperiodic:
            cycles += 1
            cycle_error = max(cycle_error, COARSER * means[COLUMN.error])
        elif number < PHASES:
            quarter_periods = run.periods // QUARTERS
            quarters[count] = means[COLUMN.velocity]  # of all of a run that took few periods
            for quarter in range(QUARTERS if quarter_periods > 0 else 0):
                quarter_distance = travel[
                    quarter * quarter_periods : (quarter + 1) * quarter_periods
                ].sum()
                quarters[count, quarter] = quarter_distance / (quarter_periods * TURN)
        count += 1
    if count == 0:
        return STATUS.runaway
    velocities = runs[:count, COLUMN.velocity]
    spread = velocities.std() * math.sqrt(count / max(1, count - 1))
    for column in range(RESULTS):
        result[column] = runs[:count, column].mean()
    result[COLUMN.landing_speed] = runs[:count, COLUMN.landing_speed].max()
    result[COLUMN.hop_height] = runs[:count, COLUMN.hop_height].max()
    result[COLUMN.multiple], result[COLUMN.spread] = 0.0, spread
    if cycles == 0:
        if count == 1:  # all others run away
            result[:] = math.nan
            return STATUS.limit_reached
        result[COLUMN.velocity] = quarters[:count].mean()
        result[COLUMN.error] = batch_error(quarters[:count])
        return STATUS.aperiodic
    mean = result[COLUMN.velocity]
    least, largest = min(least, velocities.min()), max(largest, velocities.max())
    result[COLUMN.error] = max(mean - least, largest - mean) + cycle_error
    return STATUS.sensitive
