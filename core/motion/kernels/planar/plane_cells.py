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
    RESULTS,
    SEGMENT,
    SPENT,
    STATUS,
    SUMS,
    UNREPEATED,
    WEIGHTS,
)
from vibrafeed.core.motion.kernels.inputs import Cell, Floats, Statuses, Stop, cell_of
from vibrafeed.core.motion.kernels.planar.along import (
    ROUNDING,
    follow_cycle,
    repeating,
    velocity_at_start,
    write_piece,
)
from vibrafeed.core.motion.kernels.planar.chaos import from_phases
from vibrafeed.core.motion.kernels.planar.cycle import (
    LAST_DIGIT,
    MAX_GROWTH,
    Chain,
    cycle_in,
    no_chain,
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
    smooth_span,
    two_sided,
)
from vibrafeed.core.motion.kernels.planar.within import LEAST_TOLERANCE, means_within, no_landings

UNDECIDED = -1  # no status of results: the cell needs its cycle
LEAST_GRAVITY = 1e-12  # onto the floor, in g: less is the rounding of an upright track


@compiled
def turn_round(result: Floats, way: float) -> None:
    """Turn the results of a motion on a mirrored track (`way` -1) back."""
    if way < 0:
        result[COLUMN.velocity] = -result[COLUMN.velocity]
        forward, backward = result[COLUMN.forward], result[COLUMN.backward]
        result[COLUMN.forward], result[COLUMN.backward] = backward, forward


@compiled
def solve_at_once(drive: Drive, e: float, result: Floats) -> int:
    """Fill the result of a cell that needs no cycle and return its status; else `UNDECIDED`.

    `runaway` if |sin(gamma)| > mu_s n, `at_rest` if static friction always holds, `limit_reached`
    if a number is not finite, nothing presses the part onto the floor, or |sin(gamma)| = mu_k n:
    the mean is then that of the start, for ever (theory 13.8).
    """
    gs, gn, mu_s, mu_k = drive.gs, drive.gn, drive.mu_s, drive.mu_k
    if not math.isfinite(drive.c + drive.s + gs + gn + mu_s + mu_k + e):
        return STATUS.limit_reached
    if abs(gs) > mu_s * gn:
        # Friction gives no more than mu_s times the mean normal force, which is gravity's.
        return STATUS.runaway
    if gn <= LEAST_GRAVITY:
        return STATUS.limit_reached
    if always_holds(drive):
        result[:] = 0.0
        result[COLUMN.stick], result[COLUMN.multiple] = 1.0, 1.0
        return STATUS.at_rest
    if gs != 0 and abs(abs(gs) - mu_k * gn) <= 4e-16 * abs(gs):
        # Kinetic friction just balances gravity: the mean is that of the start, for ever.
        return STATUS.limit_reached
    return UNDECIDED


@compiled
def slides_on(drive: Drive, result: Floats) -> bool:
    """Fill the result of a part that slides to and fro and never sticks; return True if it does."""
    velocity, forward = two_sided(drive)
    if not forward > 0:
        return False
    result[:] = 0.0
    result[COLUMN.velocity] = velocity
    rubbing = drive.mu_k * (drive.s + drive.gn)
    result[COLUMN.error] = ROUNDING * (drive.c + abs(drive.gs) + rubbing)
    result[COLUMN.forward], result[COLUMN.backward] = forward, 1 - forward
    result[COLUMN.multiple] = 1.0
    return True


@compiled
def solve(
    drive: Drive, phase: float, cell: Cell, chain: Chain, sums: Floats, log: Floats, result: Floats,
    stop: Stop,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Solve the motion of one cell: fill `result`, and return the status and the cycle's place."""
    rows, e = chain.rows, restitution_of(cell)
    max_periods = int(cell.max_periods)
    first, count, periods = cycle_in(chain, drive, phase, e, max_periods, MAX_GROWTH)
    if periods < 1:
        status = UNREPEATED if periods == 0 else STATUS.limit_reached
        first, count, u = 0, 0, 0.0
    else:
        u = velocity_at_start(drive, phase, rows, first, count)
        status, u = repeating(
            rows[first:], count - first, periods, phase, u, drive, cell, sums, log, result,
            stop,
        )  # fmt: skip
    if math.isnan(result[COLUMN.velocity]):
        return status, 0, 0, 0.0
    result[COLUMN.across] = 0.0
    return status, first, count, u


@compiled
def solve_cell(
    cell: Cell, row: Floats, waves: Waves, closed: bool, chain: Chain, sums: Floats, log: Floats,
    result: Floats, stop: Stop,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Fill the result of a cell of planar motion; return its status and where its cycle stands."""
    drive, phase, way = drive_of(cell, row, waves)
    result[:] = math.nan
    e = cell.restitution + cell.impact_damping
    status, first, count, u = solve_at_once(drive, e, result), 0, 0, 0.0
    if status == UNDECIDED and closed and slides_on(drive, result):
        status = STATUS.periodic
    if status == UNDECIDED:
        status, first, count, u = solve(drive, phase, cell, chain, sums, log, result, stop)
    turn_round(result, way)
    return status, first, count, u


@compiled
def solve_cells(groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and statuses of cells with the means of their motion.

    `groups` has a row a cell: the fields of `Cell`, then its wave; `table` the columns of `COLUMN`;
    the status is `UNREPEATED` if no cycle was found. Cells not reached when `stop` is raised are
    left as they are.
    """
    chain, sums, log = no_chain(), np.empty(SUMS), np.empty((0, len(PIECE)))
    for number in range(groups.shape[0]):
        row, result = groups[number], table[number]
        found = solve_cell(cell_of(row), row, waves, True, chain, sums, log, result, stop)
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = found[0]


SHOWN_PERIODS = 4  # periods of an aperiodic motion that its path shows
UNKNOWN = (STATUS.aperiodic, STATUS.sensitive, STATUS.limit_reached)
"""Statuses of motions that do not repeat, of which the last stretch is shown."""

Sample = namedtuple("Sample", "position height velocity_along velocity_normal mode")
"""Columns of a path."""

SAMPLE = Sample(*range(len(Sample._fields)))


@compiled
def follow(row: Floats, waves: Waves, known: int, stop: Stop) -> tuple[Floats, float, float, bool]:
    """Return the motion of one cell in pieces, for drawing the path of its part."""
    cell = cell_of(row)
    chain, result = no_chain(), np.empty(RESULTS)
    sums, log = np.empty(SUMS), np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    log[:, PIECE.span] = -1.0
    status, first, count, u = solve_cell(cell, row, waves, False, chain, sums, log, result, stop)
    status = known if status == UNREPEATED else status
    drive, phase, way = drive_of(cell, row, waves)
    pieces, repeats = pieces_of(
        drive, phase, cell, status, chain.rows[first:], count - first, u, sums, log
    )
    return pieces, phase, way, repeats


@compiled
def pieces_of(
    drive: Drive, phase: float, cell: Cell, status: int, rows: Floats, count: int, u: float,
    sums: Floats, log: Floats,
) -> tuple[Floats, bool]:  # fmt: skip
    """Return the pieces of a solved motion, each in one mode, and True if it repeats after them."""
    used = 0
    if status == STATUS.at_rest:
        used = write_piece(log, used, 0.0, TURN, MODE.stick, 0.0, 0.0, 0.0)
        status, count = STATUS.periodic, 1
    elif count > 0:
        _, _, used = follow_cycle(rows, count, u, drive, sums, log)
    elif status in UNKNOWN and lifts(drive):
        e, max_periods = restitution_of(cell), int(cell.max_periods)
        _, count, _ = normal_cycle(drive, phase, e, max_periods, math.inf, rows)
        shown, span = 0, 0.0
        while shown < count and span < SHOWN_PERIODS * TURN:
            shown += 1
            span += rows[count - shown, SEGMENT.span]
        start = velocity_at_start(drive, phase, rows, 0, count)
        u, _, _ = follow_cycle(rows, count - shown, start, drive, sums, log[:0])
        _, _, used = follow_cycle(rows[count - shown :], shown, u, drive, sums, log)
    return log[: max(0, used)].copy(), count > 0 and status == STATUS.periodic


@compiled
def sample(
    pieces: Floats, row: Floats, waves: Waves, shift: float, phases: Floats, repeats: bool
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
    covered = at_piece(pieces[last], pieces[last, PIECE.span], drive)[0]
    # The cycle is laid out from where the study's own period starts.
    offset = (shift - pieces[0, PIECE.phase]) % TURN
    before = 0.0
    for number in range(phases.size):
        phase = phases[number]
        if not repeats and phase + offset > length:
            break
        turns, within = divmod(phase + offset, length)
        piece = min(np.searchsorted(ends, within, side="right"), last)
        since = within - (ends[piece] - pieces[piece, PIECE.span])
        position, height, along, normal = at_piece(pieces[piece], since, drive)
        position += turns * covered
        if number == 0:
            before = position
        samples[number, SAMPLE.position], samples[number, SAMPLE.height] = position - before, height
        samples[number, SAMPLE.velocity_along] = along
        samples[number, SAMPLE.velocity_normal] = normal
        samples[number, SAMPLE.mode] = pieces[piece, PIECE.mode]
    return samples


@compiled
def at_piece(piece: Floats, since: float, drive: Drive) -> tuple[float, float, float, float]:
    """Return position, height, velocity along and normal at a phase within a motion piece."""
    tau, mode, x = piece[PIECE.phase], piece[PIECE.mode], piece[PIECE.position]
    u, w = piece[PIECE.along], piece[PIECE.normal]
    if mode == MODE.stick:
        return x, 0.0, 0.0, 0.0
    if mode == MODE.flight:
        along, covered = fly(drive, u, tau, since)
        normal, height = rise(drive, w, tau, since)
        return x + covered, max(0.0, height), along, normal
    along, covered = slide(drive, 1.0 if mode == MODE.forward else -1.0, u, tau, since)
    return x + covered, 0.0, along, 0.0


# --- energies


@compiled
def spend_over_piece(drive: Drive, piece: Floats, spent: Floats) -> None:
    """Add the work of drive and friction over one motion piece to `spent`, per mass, in (g/w)^2.

    The integrals over the phase of b.u (drive), of b'.u (swing: it gives the mass that the drive
    feels) and of mu_k N |u| (friction), with the push b, the velocity u and the load N = n - b_z,
    by Gauss's rule (theory 13.15).
    """
    tau, span, flies = piece[PIECE.phase], piece[PIECE.span], piece[PIECE.mode] == MODE.flight
    if piece[PIECE.mode] == MODE.stick:
        return
    at = 0.0
    while at < span:
        half = 0.5 * min(smooth_span(drive, tau + at), span - at)
        for place, weight in zip(NODES, WEIGHTS):  # noqa: B905 # numba knows no strict
            for side in (-place, place):
                since = at + half * (1.0 + side)
                _, _, u, w = at_piece(piece, since, drive)
                along, normal = push(drive, tau + since)
                spent[SPENT.drive] += half * weight * (along * u + normal * w)
                slope, rising = push_slope(drive, tau + since)
                spent[SPENT.swing] += half * weight * (slope * u + rising * w)
                if not flies:
                    load = drive.gn - normal
                    spent[SPENT.friction] += half * weight * drive.mu_k * load * abs(u)
        at += 2.0 * half


@compiled
def spend_over_cycle(
    drive: Drive, rows: Floats, count: int, u: float, periods: float, sums: Floats, log: Floats,
    spent: Floats,
) -> None:  # fmt: skip
    """Fill `spent` (columns of `SPENT`) with mean powers per mass over a cycle of planar motion.

    In g^2/w. An impact takes (u-^2 - u+^2 + w-^2 - w+^2)/2 of the velocities along and normal
    before and after it. NaN if the log is too short (theory 13.15).
    """
    spent[:] = 0.0
    after_last = max(0.0, rows[0, SEGMENT.take_off])
    for _ in range(max(1, round(periods * TURN / rows[:count, SEGMENT.span].sum()))):
        u, _, used = follow_cycle(rows, count, u, drive, sums, log)
        if not 0 < used < log.shape[0]:  # a full log may lack pieces
            spent[:] = math.nan
            return
        for number in range(used):
            piece = log[number]
            spend_over_piece(drive, piece, spent)
            if piece[PIECE.mode] == MODE.flight:
                _, _, fast, down = at_piece(piece, piece[PIECE.span], drive)
                slow, up = u, after_last
                if number + 1 < used:
                    slow, up = log[number + 1, PIECE.along], log[number + 1, PIECE.normal]
                lost = (fast - slow) * (fast + slow) + (down - up) * (down + up)
                spent[SPENT.impact] += 0.5 * lost
    spent /= periods * TURN


@compiled
def spend_cells(groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill a table (columns of `SPENT`) with mean powers of cells per mass in g^2/w."""
    chain, sums, result = no_chain(), np.empty(SUMS), np.empty(RESULTS)
    log = np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        cell = cell_of(row)
        spent[:] = math.nan
        outcome, first, count, u = solve_cell(
            cell, row, waves, False, chain, sums, log[:0], result, stop
        )
        if raised(stop):
            return
        status[number] = outcome
        if outcome == STATUS.at_rest:
            spent[:] = 0.0
        elif count > 0:
            rest, periods = chain.rows[first:], result[COLUMN.multiple]
            drive, _, _ = drive_of(cell, row, waves)
            spend_over_cycle(drive, rest, count - first, u, periods, sums, log, spent)


FELT_PERIODS = 256
"""Periods of the drive over which energies of a motion that does not repeat are averaged; they
scatter by some 3 %."""
LED_IN = 8
"""One segment in so many at the start of a motion is not counted, while the motion settles."""


@compiled
def reach_way(
    drive: Drive, phase: float, cell: Cell, chain: Chain, sums: Floats, result: Floats, stop: Stop
) -> None:
    """Enlarge the error of an aperiodic mean so that it covers the first way from rest to rest.

    error >= |v_way - v| + error(v_way) (theory 13.7).
    """
    own, no_log = np.full(RESULTS, math.nan), np.empty((0, len(PIECE)))
    rows, e, max_periods = chain.rows, restitution_of(cell), int(cell.max_periods)
    first, count, periods = cycle_in(chain, drive, phase, e, max_periods, LAST_DIGIT)
    if periods < 1:
        return
    u = velocity_at_start(drive, phase, rows, first, count)
    status, _ = repeating(
        rows[first:], count - first, periods, phase, u, drive, cell, sums, no_log, own, stop
    )
    if status == STATUS.periodic:
        apart = abs(own[COLUMN.velocity] - result[COLUMN.velocity])
        result[COLUMN.error] = max(result[COLUMN.error], apart + own[COLUMN.error])


@compiled
def average_cells(
    groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill table and statuses of cells whose motion does not repeat, with means over long runs."""
    rows, sums = np.empty((MAX_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    ways, landings = no_chain(), no_landings()
    for number in range(groups.shape[0]):
        row, result = groups[number], table[number]
        cell = cell_of(row)
        drive, phase, way = drive_of(cell, row, waves)
        result[:] = math.nan
        outcome = UNREPEATED
        if cell.tolerance >= LEAST_TOLERANCE:
            outcome, landings = means_within(cell, phase, drive, landings, result, stop)
        if outcome == UNREPEATED:
            outcome = from_phases(cell, phase, drive, rows, sums, result, stop)
        if outcome == STATUS.aperiodic:
            reach_way(drive, phase, cell, ways, sums, result, stop)
        if not math.isnan(result[COLUMN.velocity]):
            result[COLUMN.across] = 0.0
        turn_round(result, way)
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = outcome


@compiled
def average_spent(
    groups: Floats, waves: Waves, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill the energy table of cells whose motion does not repeat, from long runs."""
    rows, sums = np.empty((MAX_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    log = np.empty((4 * MAX_SEGMENTS, len(PIECE)))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        cell = cell_of(row)
        drive, phase, _ = drive_of(cell, row, waves)
        spent[:] = math.nan
        if raised(stop):
            return
        e = restitution_of(cell)
        _, count, _ = normal_cycle(drive, phase, e, FELT_PERIODS, math.inf, rows)
        first = count // LED_IN
        if count - first < LED_IN:
            continue
        u = velocity_at_start(drive, phase, rows, 0, count)
        u = follow_cycle(rows, first, u, drive, sums, log[:0])[0]
        periods = rows[first:count, SEGMENT.span].sum() / TURN
        spend_over_cycle(drive, rows[first:], count - first, u, periods, sums, log, spent)
        status[number] = STATUS.aperiodic
