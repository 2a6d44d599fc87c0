"""Cells in the plane: their means, their courses, and what friction, impacts and the drive do."""

import math
from collections import namedtuple

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.constants import (
    COLUMN,
    MAX_SEGMENTS,
    MODE,
    NODES,
    PIECE,
    POWER,
    RESULTS,
    SEGMENT,
    STATUS,
    SUMS,
    UNREPEATED,
    WEIGHTS,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats, Statuses, Stop, cell_of
from vibrafeed.core.motion.kernels.planar.along import (
    ROUNDING,
    fill_repeating,
    follow_cycle,
    velocity_at_start,
    write_piece,
)
from vibrafeed.core.motion.kernels.planar.chaos import fill_means_from_phases
from vibrafeed.core.motion.kernels.planar.cycle import (
    LAST_DIGIT,
    MAX_GROWTH,
    Chain,
    cached_cycle,
    empty_chain,
    normal_cycle,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.planar.plane_laws import (
    Drive,
    Waves,
    always_holds,
    drive_of,
    fly,
    lifts,
    push,
    push_slope,
    restitution_of,
    rise,
    slide,
    sliding_without_stick,
    smooth_span,
)
from vibrafeed.core.motion.kernels.planar.within import (
    LEAST_TOLERANCE,
    empty_landings,
    means_within,
)

UNDECIDED = -1  # no status of results: the cell needs its cycle
LEAST_GRAVITY = 1e-12  # onto the floor, in g: less is the rounding of an upright track


@compiled
def mirror_back(result: Floats, direction: float) -> None:
    """Turn the results of a motion on a mirrored track (`direction` -1) back."""
    if direction < 0:
        result[COLUMN.velocity] = -result[COLUMN.velocity]
        forward, backward = result[COLUMN.forward], result[COLUMN.backward]
        result[COLUMN.forward], result[COLUMN.backward] = backward, forward


@compiled
def fill_without_cycle(drive: Drive, restitution: float, result: Floats) -> int:
    """Fill the result of a cell that needs no cycle and return its status; else `UNDECIDED`.

    `runaway` if |sin(gamma)| > mu_s n, `at_rest` if static friction always holds, `limit_reached`
    if a number is not finite, nothing presses the part onto the floor, or |sin(gamma)| = mu_k n:
    the mean is then that of the start, for ever (theory 13.8).
    """
    gravity_along, gravity_normal, mu_s, mu_k = (
        drive.gravity_along,
        drive.gravity_normal,
        drive.mu_s,
        drive.mu_k,
    )
    if not math.isfinite(
        drive.push_along
        + drive.push_normal
        + gravity_along
        + gravity_normal
        + mu_s
        + mu_k
        + restitution
    ):
        return STATUS.limit_reached
    if abs(gravity_along) > mu_s * gravity_normal:
        # Friction gives no more than mu_s times the mean normal force, which is gravity's.
        return STATUS.runaway
    if gravity_normal <= LEAST_GRAVITY:
        return STATUS.limit_reached
    if always_holds(drive):
        result[:] = 0.0
        result[COLUMN.stick], result[COLUMN.multiple] = 1.0, 1.0
        return STATUS.at_rest
    if gravity_along != 0 and abs(abs(gravity_along) - mu_k * gravity_normal) <= 4e-16 * abs(
        gravity_along
    ):
        # Kinetic friction just balances gravity: the mean is that of the start, for ever.
        return STATUS.limit_reached
    return UNDECIDED


@compiled
def fill_if_never_sticks(drive: Drive, result: Floats) -> bool:
    """Fill the result of a part that slides to and fro and never sticks; return True if it does."""
    velocity, forward = sliding_without_stick(drive)
    if not forward > 0:
        return False
    result[:] = 0.0
    result[COLUMN.velocity] = velocity
    friction = drive.mu_k * (drive.push_normal + drive.gravity_normal)
    result[COLUMN.error] = ROUNDING * (drive.push_along + abs(drive.gravity_along) + friction)
    result[COLUMN.forward], result[COLUMN.backward] = forward, 1 - forward
    result[COLUMN.multiple] = 1.0
    return True


@compiled
def fill_by_cycle(
    drive: Drive, phase: float, cell: Cell, chain: Chain, sums: Floats, log: Floats, result: Floats,
    stop: Stop,
) -> tuple[int, int, int, float]:  # fmt: skip
    """As `fill_cell`, by the cycle of the motion normal to the floor, then along the track."""
    segments, restitution = chain.rows, restitution_of(cell)
    max_periods = int(cell.max_periods)
    first, count, periods = cached_cycle(chain, drive, phase, restitution, max_periods, MAX_GROWTH)
    if periods < 1:
        status = UNREPEATED if periods == 0 else STATUS.limit_reached
        first, count, slip = 0, 0, 0.0
    else:
        slip = velocity_at_start(drive, phase, segments, first, count)
        status, slip = fill_repeating(
            segments[first:], count - first, periods, phase, slip, drive, cell, sums, log, result,
            stop,
        )  # fmt: skip
    if math.isnan(result[COLUMN.velocity]):
        return status, 0, 0, 0.0
    result[COLUMN.across] = 0.0
    return status, first, count, slip


@compiled
def fill_cell(
    cell: Cell, row: Floats, waves: Waves, tries_closed_form: bool, chain: Chain, sums: Floats,
    log: Floats, result: Floats, stop: Stop,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Fill the result of a cell of planar motion; return status, cycle and slip at its start.

    The cycle is the rows `first` to before `count` of `chain.rows`; 0, 0 if it has none.
    """
    drive, phase, direction = drive_of(cell, row, waves)
    result[:] = math.nan
    restitution_and_damping = cell.restitution + cell.impact_damping
    status, first, count, slip = (
        fill_without_cycle(drive, restitution_and_damping, result),
        0,
        0,
        0.0,
    )
    if status == UNDECIDED and tries_closed_form and fill_if_never_sticks(drive, result):
        status = STATUS.periodic
    if status == UNDECIDED:
        status, first, count, slip = fill_by_cycle(
            drive, phase, cell, chain, sums, log, result, stop
        )
    mirror_back(result, direction)
    return status, first, count, slip


@compiled
def solve_cells(groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and statuses of cells with the means of their motion.

    `groups` has a row a cell: the fields of `Cell`, then its wave; `table` the columns of `COLUMN`;
    the status is `UNREPEATED` if no cycle was found. Cells not reached when `stop` is raised are
    left as they are.
    """
    chain, sums, log = empty_chain(), np.empty(SUMS), np.empty((0, len(PIECE)))
    for index in range(groups.shape[0]):
        row, result = groups[index], table[index]
        outcome = fill_cell(cell_of(row), row, waves, True, chain, sums, log, result, stop)
        if raised(stop):
            result[:] = math.nan
            return
        status[index] = outcome[0]


SHOWN_PERIODS = 4  # periods of an aperiodic motion that its path shows
UNKNOWN = (STATUS.aperiodic, STATUS.sensitive, STATUS.limit_reached)
"""Statuses of motions that do not repeat, of which the last stretch is shown."""

Sample = namedtuple("Sample", "position height velocity_along velocity_normal mode")
"""Columns of a path."""

SAMPLE = Sample(*range(len(Sample._fields)))


@compiled
def follow(
    row: Floats, waves: Waves, known_status: int, stop: Stop
) -> tuple[Floats, float, float, bool]:
    """Return the motion of one cell in pieces, for drawing the path of its part.

    Then phase shift, direction of a mirrored drive (-1, else 1), and True if the pieces repeat.
    """
    cell = cell_of(row)
    chain, result = empty_chain(), np.empty(RESULTS)
    sums, log = np.empty(SUMS), np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    log[:, PIECE.span] = -1.0
    status, first, count, slip = fill_cell(cell, row, waves, False, chain, sums, log, result, stop)
    status = known_status if status == UNREPEATED else status
    drive, phase, direction = drive_of(cell, row, waves)
    pieces, repeats = pieces_to_draw(
        drive, phase, cell, status, chain.rows[first:], count - first, slip, sums, log
    )
    return pieces, phase, direction, repeats


@compiled
def pieces_to_draw(
    drive: Drive, phase: float, cell: Cell, status: int, segments: Floats, count: int, slip: float,
    sums: Floats, log: Floats,
) -> tuple[Floats, bool]:  # fmt: skip
    """Return the pieces of a solved motion, each in one mode, and True if it repeats after them.

    `segments[:count]` is the cycle of the normal motion, `slip` the velocity relative to the track
    at its start; without a cycle `count` is 0. `sums` and `log` are overwritten.
    """
    log_rows = 0
    if status == STATUS.at_rest:
        log_rows = write_piece(log, log_rows, 0.0, TURN, MODE.stick, 0.0, 0.0, 0.0)
        status, count = STATUS.periodic, 1
    elif count > 0:
        _, _, log_rows = follow_cycle(segments, count, slip, drive, sums, log)
    elif status in UNKNOWN and lifts(drive):
        # Of a motion that does not repeat the last periods are shown.
        restitution, max_periods = restitution_of(cell), int(cell.max_periods)
        _, count, _ = normal_cycle(drive, phase, restitution, max_periods, math.inf, segments)
        shown, shown_time = 0, 0.0
        while shown < count and shown_time < SHOWN_PERIODS * TURN:
            shown += 1
            shown_time += segments[count - shown, SEGMENT.span]
        start = velocity_at_start(drive, phase, segments, 0, count)
        # First without pieces, for the slip at the start of the periods shown.
        slip, _, _ = follow_cycle(segments, count - shown, start, drive, sums, log[:0])
        _, _, log_rows = follow_cycle(segments[count - shown :], shown, slip, drive, sums, log)
    return log[: max(0, log_rows)].copy(), count > 0 and status == STATUS.periodic


@compiled
def sample(
    pieces: Floats, row: Floats, waves: Waves, start_phase: float, phases: Floats, repeats: bool
) -> Floats:
    """Return position, height, velocities and mode of a part at given phases of the drive.

    Shape (n, 5), columns of `SAMPLE`, in g/w^2 and g/w; NaN and mode `unknown` where none is known.
    """
    drive, _, _ = drive_of(cell_of(row), row, waves)
    samples = np.full((phases.size, len(SAMPLE)), math.nan)
    samples[:, SAMPLE.mode] = MODE.unknown
    if pieces.shape[0] == 0:
        return samples
    ends = np.cumsum(pieces[:, PIECE.span])
    length = ends[-1]
    last = pieces.shape[0] - 1
    cycle_distance = at_piece(pieces[last], pieces[last, PIECE.span], drive)[0]
    # The cycle is laid out from where the study's own period starts.
    offset = (start_phase - pieces[0, PIECE.phase]) % TURN
    first_position = 0.0
    for index in range(phases.size):
        phase = phases[index]
        if not repeats and phase + offset > length:
            break
        turns, phase_in_cycle = divmod(phase + offset, length)
        piece = min(np.searchsorted(ends, phase_in_cycle, side="right"), last)
        phase_in_piece = phase_in_cycle - (ends[piece] - pieces[piece, PIECE.span])
        position, height, along, normal = at_piece(pieces[piece], phase_in_piece, drive)
        position += turns * cycle_distance
        if index == 0:
            first_position = position
        samples[index, SAMPLE.position], samples[index, SAMPLE.height] = (
            position - first_position,
            height,
        )
        samples[index, SAMPLE.velocity_along] = along
        samples[index, SAMPLE.velocity_normal] = normal
        samples[index, SAMPLE.mode] = pieces[piece, PIECE.mode]
    return samples


@compiled
def at_piece(piece: Floats, elapsed: float, drive: Drive) -> tuple[float, float, float, float]:
    """Return position, height, velocity along and normal at a phase within a motion piece."""
    tau, mode, position = piece[PIECE.phase], piece[PIECE.mode], piece[PIECE.position]
    slip, normal_velocity = piece[PIECE.along], piece[PIECE.normal]
    if mode == MODE.stick:
        return position, 0.0, 0.0, 0.0
    if mode == MODE.flight:
        along, distance = fly(drive, slip, tau, elapsed)
        normal, height = rise(drive, normal_velocity, tau, elapsed)
        return position + distance, max(0.0, height), along, normal
    along, distance = slide(drive, 1.0 if mode == MODE.forward else -1.0, slip, tau, elapsed)
    return position + distance, 0.0, along, 0.0


# --- energies


@compiled
def add_work_of_piece(drive: Drive, piece: Floats, work: Floats) -> None:
    """Add the work of drive and friction over one motion piece to `work`, per mass, in (g/w)^2.

    The integrals over the phase of b.u (drive), of b'.u (swing: it gives the mass that the drive
    feels) and of mu_k N |u| (friction), with push b, velocity u and load N = n - b_z,
    by Gauss's rule (theory 13.15).
    """
    tau, span, in_flight = piece[PIECE.phase], piece[PIECE.span], piece[PIECE.mode] == MODE.flight
    if piece[PIECE.mode] == MODE.stick:
        return
    begin = 0.0
    while begin < span:
        half_span = 0.5 * min(smooth_span(drive, tau + begin), span - begin)
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905 # numba knows no strict
            for signed_node in (-node, node):
                elapsed = begin + half_span * (1.0 + signed_node)
                _, _, velocity_along, velocity_normal = at_piece(piece, elapsed, drive)
                push_along, push_normal = push(drive, tau + elapsed)
                work[POWER.drive] += (
                    half_span
                    * weight
                    * (push_along * velocity_along + push_normal * velocity_normal)
                )
                slope_along, slope_normal = push_slope(drive, tau + elapsed)
                work[POWER.swing] += (
                    half_span
                    * weight
                    * (slope_along * velocity_along + slope_normal * velocity_normal)
                )
                if not in_flight:
                    load = drive.gravity_normal - push_normal
                    work[POWER.friction] += (
                        half_span * weight * drive.mu_k * load * abs(velocity_along)
                    )
        begin += 2.0 * half_span


@compiled
def fill_mean_powers(
    drive: Drive, segments: Floats, count: int, slip: float, periods: float, sums: Floats,
    log: Floats, powers: Floats,
) -> None:  # fmt: skip
    """Fill `powers` (columns of `POWER`) with mean powers per mass over a cycle of planar motion.

    In g^2/w. An impact takes (u-^2 - u+^2 + w-^2 - w+^2)/2 of the velocities along and normal
    before and after it. NaN if the log is too short (theory 13.15).
    """
    powers[:] = 0.0
    last_rebound = max(0.0, segments[0, SEGMENT.take_off])
    for _ in range(max(1, round(periods * TURN / segments[:count, SEGMENT.span].sum()))):
        slip, _, log_rows = follow_cycle(segments, count, slip, drive, sums, log)
        if not 0 < log_rows < log.shape[0]:  # a full log may lack pieces
            powers[:] = math.nan
            return
        for index in range(log_rows):
            piece = log[index]
            add_work_of_piece(drive, piece, powers)
            if piece[PIECE.mode] == MODE.flight:
                _, _, along_before, normal_before = at_piece(piece, piece[PIECE.span], drive)
                along_after, normal_after = slip, last_rebound
                if index + 1 < log_rows:
                    along_after, normal_after = (
                        log[index + 1, PIECE.along],
                        log[index + 1, PIECE.normal],
                    )
                twice_loss = (along_before - along_after) * (along_before + along_after) + (
                    normal_before - normal_after
                ) * (normal_before + normal_after)
                powers[POWER.impact] += 0.5 * twice_loss
    powers /= periods * TURN


@compiled
def power_cells(groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill a table (columns of `POWER`) with mean powers of cells per mass in g^2/w."""
    chain, sums, result = empty_chain(), np.empty(SUMS), np.empty(RESULTS)
    log = np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    for index in range(groups.shape[0]):
        row, powers = groups[index], table[index]
        cell = cell_of(row)
        powers[:] = math.nan
        outcome, first, count, slip = fill_cell(
            cell, row, waves, False, chain, sums, log[:0], result, stop
        )
        if raised(stop):
            return
        status[index] = outcome
        if outcome == STATUS.at_rest:
            powers[:] = 0.0
        elif count > 0:
            segments, periods = chain.rows[first:], result[COLUMN.multiple]
            drive, _, _ = drive_of(cell, row, waves)
            fill_mean_powers(drive, segments, count - first, slip, periods, sums, log, powers)


FELT_PERIODS = 256
"""Periods of the drive over which energies of a motion that does not repeat are averaged; they
scatter by some 3 %."""
LED_IN = 8
"""One segment in so many at the start of a motion is not counted, while the motion settles."""


@compiled
def widen_error_by_first_way(
    drive: Drive, phase: float, cell: Cell, chain: Chain, sums: Floats, result: Floats, stop: Stop
) -> None:
    """Enlarge the error of an aperiodic mean so that it covers the first way from rest to rest.

    error >= |v_way - v| + error(v_way) (theory 13.7).
    """
    first_way, no_log = np.full(RESULTS, math.nan), np.empty((0, len(PIECE)))
    segments, restitution, max_periods = chain.rows, restitution_of(cell), int(cell.max_periods)
    first, count, periods = cached_cycle(chain, drive, phase, restitution, max_periods, LAST_DIGIT)
    if periods < 1:
        return
    slip = velocity_at_start(drive, phase, segments, first, count)
    status, _ = fill_repeating(
        segments[first:],
        count - first,
        periods,
        phase,
        slip,
        drive,
        cell,
        sums,
        no_log,
        first_way,
        stop,
    )
    if status == STATUS.periodic:
        difference = abs(first_way[COLUMN.velocity] - result[COLUMN.velocity])
        result[COLUMN.error] = max(result[COLUMN.error], difference + first_way[COLUMN.error])


@compiled
def average_cells(
    groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill table and statuses of cells whose motion does not repeat, with means over long runs."""
    segments, sums = np.empty((MAX_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    chain, landings = empty_chain(), empty_landings()
    for index in range(groups.shape[0]):
        row, result = groups[index], table[index]
        cell = cell_of(row)
        drive, phase, direction = drive_of(cell, row, waves)
        result[:] = math.nan
        outcome = UNREPEATED
        if cell.tolerance >= LEAST_TOLERANCE:
            outcome, landings = means_within(cell, phase, drive, landings, result, stop)
        if outcome == UNREPEATED:
            outcome = fill_means_from_phases(cell, phase, drive, segments, sums, result, stop)
        if outcome == STATUS.aperiodic:
            widen_error_by_first_way(drive, phase, cell, chain, sums, result, stop)
        if not math.isnan(result[COLUMN.velocity]):
            result[COLUMN.across] = 0.0
        mirror_back(result, direction)
        if raised(stop):
            result[:] = math.nan
            return
        status[index] = outcome


@compiled
def average_power_cells(
    groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill the energy table of cells whose motion does not repeat, from long runs."""
    segments, sums = np.empty((MAX_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    log = np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    for index in range(groups.shape[0]):
        row, powers = groups[index], table[index]
        cell = cell_of(row)
        drive, phase, _ = drive_of(cell, row, waves)
        powers[:] = math.nan
        if raised(stop):
            return
        restitution = restitution_of(cell)
        _, count, _ = normal_cycle(drive, phase, restitution, FELT_PERIODS, math.inf, segments)
        first = count // LED_IN
        if count - first < LED_IN:
            continue
        slip = velocity_at_start(drive, phase, segments, 0, count)
        slip = follow_cycle(segments, first, slip, drive, sums, log[:0])[0]
        periods = segments[first:count, SEGMENT.span].sum() / TURN
        fill_mean_powers(drive, segments[first:], count - first, slip, periods, sums, log, powers)
        status[index] = STATUS.aperiodic
