"""Tumbling parts from event to event: one run, many cells, one path."""

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.constants import STATUS
from vibrafeed.core.motion.kernels.inputs import Floats, Statuses, Stop, copy
from vibrafeed.core.motion.kernels.tumbling.corners import (
    COLUMN,
    FLAT,
    FREE,
    OVERLAP,
    PARADOX,
    PATH,
    PATH_COLUMNS,
    STATE,
    Cell,
    cell_of,
    corner_at,
    corner_count,
    gap_of,
    gap_rate_of,
    lowest_gap,
    lowest_rate,
    side_below,
)
from vibrafeed.core.motion.kernels.tumbling.supports import (
    apply_impact,
    choose_support,
    rests_for_ever,
    step_on_support,
    support_fits,
)

MAX_STEPS = 20_000_000
"""Of a cell: 400 s of motion at 50 Hz and 1,000 steps a period, where all parts have long
settled."""


class TumblingRun(NamedTuple):
    """The results of a run besides its state, as the columns of its table follow `Tumble`.

    Times in s, `largest_bounce` in m; `side` is the number of the side that lies flat, 0 if none.
    """

    status: int
    time: float
    settling_time: float
    impacts: int
    largest_bounce: float
    side: int


@compiled
def set_start(cell: Cell, state: Floats) -> None:
    """Set the state of a tumbling part to the start of its run, from the numbers of the cell."""
    state[:] = 0.0
    state[STATE.pitch], state[STATE.pitch_rate] = cell.pitch, cell.pitch_rate
    state[STATE.along_rate], state[STATE.up_rate] = cell.velocity_along, cell.velocity_upward
    lowest = 0.0
    for corner in range(corner_count(cell)):
        sine, _ = corner_at(cell, corner, cell.pitch)
        lowest = max(lowest, sine)
    state[STATE.up] = cell.half_diagonal * lowest + cell.gap_normal


@compiled
def write_path_row(cell: Cell, state: Floats, time: float, support: int, row: Floats) -> None:
    """Write time, state, lowest gap and touching corners of a part into a row of its path."""
    row[:] = 0.0
    row[PATH.time] = time
    copy(state, row[PATH.state : PATH.gap])
    row[PATH.gap] = lowest_gap(cell, state)
    if support >= 0:
        row[PATH.touching + support] = 1.0
    elif support == FLAT:
        quarter_turns = side_below(state[STATE.pitch])
        row[PATH.touching + (-quarter_turns) % 4] = 1.0
        row[PATH.touching + (1 - quarter_turns) % 4] = 1.0


@compiled
def write_path_until(
    cell: Cell, state: Floats, time: float, support: int, times: Floats, rows_written: int,
    rows: Floats,
) -> int:  # fmt: skip
    """Write the state of a tumbling part into the rows of all wanted times up to `time` (s)."""
    while rows_written < times.size and times[rows_written] <= time:
        write_path_row(cell, state, times[rows_written], support, rows[rows_written])
        rows_written += 1
    return rows_written


@compiled
def side_of(cell: Cell, support: int, pitch: float) -> int:
    """Return the number of the side that lies flat, 1 to 4; 0 if none does, 1 for a ball."""
    if support == FLAT:
        return side_below(pitch) % 4 + 1
    return 1 if support >= 0 and cell.turning == 0.0 else 0


@compiled
def fill_results(cell: Cell, run: TumblingRun, state: Floats, row: Floats) -> None:
    """Write the results of the run of a tumbling part into its row of the table."""
    row[COLUMN.pitch] = state[STATE.pitch]
    row[COLUMN.resting_side] = run.side
    row[COLUMN.settling_time] = run.settling_time
    row[COLUMN.impacts] = run.impacts
    row[COLUMN.largest_bounce] = run.largest_bounce
    elapsed = cell.duration if run.status == STATUS.settled else run.time
    row[COLUMN.velocity] = state[STATE.along] / elapsed if elapsed > 0.0 else 0.0
    row[COLUMN.energy_lost] = state[STATE.lost]


EVENTS, EVENTS_A_STEP = 20_000, 20  # most events of a run: so many, and so many more a step
STEPS_MORE = 50
"""Factor of the largest number of steps, which are shorter where the part turns fast."""
HALVINGS = 60  # most steps of the search for the end of a support
TOP_HALVINGS = 40  # of the time of a hop's top: its height is then off by a rounding
LARGEST_TURN = 0.1  # rad a step, so that no corner swings down and up again unseen


@compiled
def highest_gap(
    cell: Cell, support: int, state: Floats, after: Floats, time: float, step: float, trial: Floats
) -> float:  # fmt: skip
    """Return the largest height in m of the lowest corner of a tumbling part within a step."""
    highest = max(lowest_gap(cell, state), lowest_gap(cell, after))
    if support != FREE or lowest_rate(cell, state) <= 0.0 or lowest_rate(cell, after) >= 0.0:
        return highest
    low, high = 0.0, step
    for _ in range(TOP_HALVINGS):
        middle = (low + high) / 2
        step_on_support(cell, support, 0, state, time, middle, trial)
        if lowest_rate(cell, trial) > 0.0:
            low = middle
        else:
            high = middle
    return max(highest, lowest_gap(cell, trial))


@compiled
def time_of_dip(
    cell: Cell, support: int, sigma: int, state: Floats, time: float, step: float, after: Floats,
    trial: Floats,
) -> float:  # fmt: skip
    """Return the time in s within a step at which a corner dips into the plane; else `step`."""
    if support == FLAT:
        return step
    for corner in range(corner_count(cell)):
        rate_before, rate_after = gap_rate_of(cell, state, corner), gap_rate_of(cell, after, corner)
        if corner != support and rate_before < 0.0 < rate_after:
            # Its rate taken as linear, the corner is lowest then.
            turning_time = step * rate_before / (rate_before - rate_after)
            step_on_support(cell, support, sigma, state, time, turning_time, trial)
            if gap_of(cell, trial, corner) < -OVERLAP * cell.half_diagonal:
                return turning_time
    return step


@compiled
def first_misfit(
    cell: Cell, support: int, sigma: int, state: Floats, time: float, step: float, after: Floats,
    trial: Floats,
) -> float:  # fmt: skip
    """Return the time in s within a step at which the support of a tumbling part ceases to fit."""
    overlap = OVERLAP * cell.half_diagonal
    low, high, fitted = 0.0, step, False
    for _ in range(HALVINGS):
        guess = (low + high) / 2
        deepest, falling = -overlap, -1
        for corner in range(corner_count(cell)):
            gap = gap_of(cell, after, corner)
            if corner != support and gap < deepest:
                deepest, falling = gap, corner
        at_plane = falling >= 0 and deepest >= -1.5 * overlap
        if high - low <= (1e-9 if at_plane else 1e-12 if falling < 0 else 0.0) * step:
            break
        if at_plane:  # was the corner the first? just before, everything has to fit
            guess = max(guess, high - 1e-9 * step)
        elif falling >= 0:
            rate = gap_rate_of(cell, after, falling)
            if rate < 0.0 and not fitted:
                newton_guess = high - (deepest + overlap) / rate
                if low < newton_guess < high:
                    guess = newton_guess
        if guess in (low, high):
            break
        step_on_support(cell, support, sigma, state, time, guess, trial)
        fitted = support_fits(cell, support, sigma, trial, time + guess)
        if fitted:
            low = guess
        else:
            high = guess
            copy(trial, after)
    return high


@compiled
def end_of_step(cell: Cell, state: Floats, time: float, times: Floats, rows_written: int) -> float:
    """Return the end in s of the next time step of a tumbling part that starts at `time`."""
    end, pitch_rate = min(time + cell.time_step, cell.duration), state[STATE.pitch_rate]
    if rows_written < times.size:
        end = min(end, times[rows_written])
    if abs(pitch_rate) * (end - time) > LARGEST_TURN:
        return time + LARGEST_TURN / abs(pitch_rate)
    return end


@compiled
def run_events(cell: Cell, state: Floats, times: Floats, rows: Floats, stop: Stop) -> TumblingRun:
    """Simulate one tumbling part from event to event; return the record of its run.

    A step on one support is integrated, and cut where that support ceases to fit; then follow
    impacts and the choice of the next support, until the part rests for good or its duration ends
    (theory 13.11). `rows` (columns of `PATH`) are filled at the ascending `times` in s.
    """
    after, trial = np.empty_like(state), np.empty_like(state)
    set_start(cell, state)
    time, settling_time, largest_bounce = 0.0, np.nan, 0.0
    impacts = events = rows_written = 0
    status = STATUS.limit_reached
    if apply_impact(cell, state, after):
        impacts = 1
    support, sigma = choose_support(cell, state, time)
    steps = math.ceil(min(cell.duration / cell.time_step, MAX_STEPS))
    most_events = EVENTS + EVENTS_A_STEP * steps
    steps_left = min(1000 + STEPS_MORE * steps, MAX_STEPS) + times.size
    while True:
        rows_written = write_path_until(cell, state, time, support, times, rows_written, rows)
        if support == PARADOX:
            status = STATUS.no_solution
            break
        if rests_for_ever(cell, support, sigma, state):
            status, settling_time = STATUS.settled, time
            break
        if time >= cell.duration:
            status = STATUS.moving
            break
        if steps_left <= 0 or events >= most_events or raised(stop):
            break
        steps_left -= 1
        end = end_of_step(cell, state, time, times, rows_written)
        step = end - time
        step_on_support(cell, support, sigma, state, time, step, after)
        span = time_of_dip(cell, support, sigma, state, time, step, after, trial)
        fits = span == step and support_fits(cell, support, sigma, after, end)
        if not fits:
            if span != step:
                step_on_support(cell, support, sigma, state, time, span, after)
            span = first_misfit(cell, support, sigma, state, time, span, after, trial)
        if impacts > 0:
            largest_bounce = max(
                largest_bounce, highest_gap(cell, support, state, after, time, span, trial)
            )
        copy(after, state)
        time = end if span == step else time + span
        if fits:
            continue
        events += 1
        if apply_impact(cell, state, after):
            impacts += 1
        support, sigma = choose_support(cell, state, time)
    if status in (STATUS.settled, STATUS.moving) or time >= cell.duration:
        write_path_until(cell, state, math.inf, support, times, rows_written, rows)
    return TumblingRun(
        status,
        time,
        settling_time,
        impacts,
        largest_bounce,
        side_of(cell, support, state[STATE.pitch]),
    )


@compiled
def tumble_events(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the table of results and the statuses of many tumbling parts, from event to event."""
    state, times, rows = np.empty(len(STATE)), np.empty(0), np.empty((0, PATH_COLUMNS))
    for index in range(cells.shape[0]):
        cell = cell_of(cells[index])
        run = run_events(cell, state, times, rows, stop)
        if raised(stop):
            return
        fill_results(cell, run, state, table[index])
        status[index] = run.status


@compiled
def path_events(row: Floats, times: Floats, rows: Floats, stop: Stop) -> None:
    """Write the path of one cell at ascending times in s into `rows` (columns of `PATH`)."""
    run_events(cell_of(row), np.empty(len(STATE)), times, rows, stop)
