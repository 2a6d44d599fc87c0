"""Cells in space: their means, their courses, and what friction, impacts and the drive do."""

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.constants import COLUMN, MODE, STATUS, TALLY
from vibrafeed.core.motion.kernels.inputs import (
    GROUPS,
    Cell,
    Flags,
    Floats,
    Statuses,
    Stop,
    cell_of,
)
from vibrafeed.core.motion.kernels.means import (
    fill_means,
    mean_error,
    mean_velocity,
    scatter,
    status_without_cycle,
)
from vibrafeed.core.motion.kernels.track import push
from vibrafeed.core.motion.kernels.track.advance import advance
from vibrafeed.core.motion.kernels.track.push import STATE, TURN, Work, at_rest, new_work
from vibrafeed.core.motion.kernels.track.settling import (
    NO_PHASES,
    History,
    Series,
    Settling,
    follow_from_rest,
    follow_period,
    follow_until_repeating,
    new_history,
    remaining_transient,
)

FINE = Series(16, 1e-11)
"""Order and tolerance of the series of the results."""
COARSE = Series(12, 1e-9)
"""Order and tolerance of the run from which the error is estimated."""
LEAST_ERROR = 2e-10
"""In the drive's speed: smallest stated error of a motion that repeats."""
SLOWLY = 1e-8
"""In the drive's speed: a run that differs by more is followed until it repeats."""
SURELY = 1e-4
"""In the drive's speed: a motion whose mean is known less well does not count as repeating."""
STRAYED = 0.1
"""In the drive's speed: two runs that were so far apart no longer depend on their common start."""
HAIR = 1e-12
"""Of the restitution: what other runs lose more at each impact than the first, which alone parts
runs of series of any order; it comes to `STRAYED` where changes grow by 1e11 on the way."""
UNDECIDED = -1
"""No status of results: the cell needs its motion."""
OTHERS = 3
"""Further runs of a part whose motion is decided by the last digits."""
RESTITUTION, WALL_RESTITUTION = (
    Cell._fields.index(name) for name in ("restitution", "wall_restitution")
)


@compiled
def never_settles(cell: Cell, wall: bool) -> bool:
    """True if gravity along the track exceeds the mean friction available: the part runs away.

    |sin(gamma)| > mu n + mu_w max(0, n_y) with the mean loads of gravity in g; without a wall
    gravity across pulls as well. False for a curved wall with friction, whose load grows with speed
    (theory 13.8).
    """
    friction = max(cell.friction_static, cell.friction_kinetic) * cell.gravity_number_normal
    pull = abs(cell.gravity_number_along)
    if wall:
        if cell.curvature_number > 0.0 and cell.wall_friction > 0.0:
            return False
        friction += cell.wall_friction * max(0.0, cell.gravity_number_across)
    else:
        pull = math.hypot(pull, cell.gravity_number_across)
    return pull > friction


@compiled
def fill_without_repeating(
    cell: Cell, wall: bool, speed: float, history: History, periods: int, result: Floats
) -> int:
    """Fill the result of a motion that did not repeat, and return its status."""
    travel, pull = history.tallies[:periods, TALLY.travel], abs(cell.gravity_number_along)
    status, batches = status_without_cycle(cell, wall, pull, travel, TURN, LEAST_ERROR * speed)
    if status != STATUS.aperiodic:
        return status
    fill_means(history.tallies, periods // 4, periods, TURN, result)
    result[COLUMN.velocity] = np.mean(batches)
    result[COLUMN.spread] = scatter(batches)
    result[COLUMN.error] = mean_error(batches) + LEAST_ERROR * speed
    return STATUS.aperiodic


@compiled
def status_without_motion(cell: Cell, row: Floats, wall: bool) -> tuple[int, bool]:
    """Return the status of a cell that needs no simulation (else `UNDECIDED`); True if it rubs."""
    total = 0.0
    for value in row:
        total += value
    weightless = cell.gravity_number_normal <= 0.0
    if not math.isfinite(total) or weightless or int(cell.max_periods) < 1:
        return STATUS.limit_reached, False
    has_friction = cell.friction_kinetic + cell.friction_static > 0.0
    if wall:
        has_friction = has_friction or cell.wall_friction > 0.0
    runs_away = never_settles(cell, wall) if has_friction else cell.gravity_number_along != 0.0
    return STATUS.runaway if runs_away else UNDECIDED, has_friction


@compiled
def fill_cell(
    row: Floats, wall: bool, rolling: float, history: History, result: Floats
) -> Settling:
    """Fill the result of a cell followed from rest in space; return how its motion repeats.

    The error is twice the difference to the velocity of other runs, plus the rest of the transient
    and 2e-10 of the drive's speed (theory 13.13).
    """
    cell = cell_of(row)
    result[:] = math.nan
    early_status, has_friction = status_without_motion(cell, row, wall)
    if early_status != UNDECIDED:
        return Settling(early_status, 0, 0, math.inf)
    work = new_work()
    settled, state, hold = follow_from_rest(row, wall, rolling, FINE, history, work)
    speed = push.drive_speed(work)
    if settled.multiple == 0:
        if settled.status == STATUS.aperiodic:
            status = fill_without_repeating(cell, wall, speed, history, settled.periods, result)
            return Settling(status, 0, settled.periods, math.inf)
        return settled
    fill_means(history.tallies, settled.periods - settled.multiple, settled.periods, TURN, result)
    result[COLUMN.multiple] = float(settled.multiple)
    if settled.status == STATUS.at_rest:
        result[COLUMN.velocity] = 0.0
        return settled
    status = settled.status if has_friction else STATUS.neutral
    velocity = result[COLUMN.velocity]
    if cell.restitution > 0.0 or (wall and cell.wall_restitution > 0.0):
        difference, is_confirmed = difference_of_other_runs(
            row, wall, rolling, settled, velocity, history, work
        )
    else:
        is_confirmed = True
        difference = error_by_short_series(
            cell,
            wall,
            rolling,
            settled.multiple,
            state.copy(),
            hold.copy(),
            velocity,
            history,
            work,
        )
        if not difference < SLOWLY * speed:
            coarse_velocity, _ = velocity_of_run(
                cell, wall, rolling, COARSE, settled.periods, state, hold, history, work
            )
            difference = abs(coarse_velocity - velocity)
    error = 2.0 * difference + settled.transient + LEAST_ERROR * speed
    result[COLUMN.error] = error if error < 2.0 * speed else 2.0 * speed
    if not is_confirmed or not error < max(SURELY, 100.0 * cell.tolerance) * speed:
        result[COLUMN.multiple] = 0.0
        return Settling(STATUS.sensitive, 0, settled.periods, error)
    return Settling(status, settled.multiple, settled.periods, settled.transient)


@compiled
def error_by_short_series(
    cell: Cell, wall: bool, rolling: float, multiple: int, state: Floats, hold: Flags,
    velocity: float, history: History, work: Work,
) -> float:  # fmt: skip
    """Return an estimate of the error of a mean velocity in g/w, by a run with shorter series."""
    last = min(2 * multiple, history.starts.shape[0])
    for period in range(last):
        if not follow_period(cell, wall, rolling, COARSE, period, state, hold, history, work):
            return math.nan
    travel = history.tallies[:, TALLY.travel]
    difference = abs(mean_velocity(travel, last - multiple, last, TURN) - velocity)
    return difference + remaining_transient(wall, rolling, history, last - 1, multiple, 0)


@compiled
def with_less_restitution(row: Floats, hairs: float) -> Cell:
    """Return a cell with restitutions of floor and wall reduced to e (1 - `hairs` 1e-12)."""
    row = row.copy()
    row[RESTITUTION] *= 1.0 - hairs * HAIR
    row[WALL_RESTITUTION] *= 1.0 - hairs * HAIR
    return cell_of(row)


@compiled
def difference_of_other_runs(
    row: Floats, wall: bool, rolling: float, settled: Settling, velocity: float, history: History,
    work: Work,
) -> tuple[float, bool]:  # fmt: skip
    """Return the largest difference of other runs from a mean velocity, True if it is confirmed.

    It is run again from rest with shorter series and `with_less_restitution` restitutions. The mean
    is not confirmed if a velocity strays by more than 0.1 of the drive's speed; three more runs
    then take part (theory 13.13).
    """
    speeds = history.ends[: settled.periods, STATE.ux].copy()
    state, hold = at_rest()
    run_velocity, periods = velocity_of_run(
        with_less_restitution(row, 1.0),
        wall,
        rolling,
        COARSE,
        settled.periods,
        state,
        hold,
        history,
        work,
    )
    largest, largest_strayed = abs(run_velocity - velocity), 0.0
    for period in range(min(periods, speeds.size)):
        largest_strayed = max(largest_strayed, abs(history.ends[period, STATE.ux] - speeds[period]))
    if largest_strayed < STRAYED * push.drive_speed(work):
        return largest, True
    for run in range(OTHERS):
        series = Series(COARSE.order, COARSE.tolerance / (2.0 + run))
        state, hold = at_rest()
        run_velocity, _ = velocity_of_run(
            with_less_restitution(row, 2.0 + run), wall, rolling, series, settled.periods, state,
            hold, history, work,
        )  # fmt: skip
        largest = (
            max(largest, abs(run_velocity - velocity)) if math.isfinite(run_velocity) else math.nan
        )
    return largest, False


@compiled
def velocity_of_run(
    cell: Cell, wall: bool, rolling: float, series: Series, periods: int, state: Floats,
    hold: Flags, history: History, work: Work,
) -> tuple[float, int]:  # fmt: skip
    """Return the mean velocity of another run of a cell in g/w, and the periods it took."""
    max_periods = min(history.starts.shape[0] - 1, 4 * periods + 32)
    settled = follow_until_repeating(
        cell, wall, rolling, series, max_periods, state, hold, history, work
    )
    if settled.multiple == 0:
        return math.nan, settled.periods
    travel = history.tallies[:, TALLY.travel]
    return mean_velocity(
        travel, settled.periods - settled.multiple, settled.periods, TURN
    ), settled.periods


@compiled
def solve_cells(
    wall: bool, rolling: float, groups: Floats, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill table and statuses of cells with the means of their motion."""
    if groups.shape[0] == 0:
        return
    max_periods = max(1, int(groups[:, GROUPS - 1].max()))
    history = new_history(max_periods, stop)
    for index in range(groups.shape[0]):
        settled = fill_cell(groups[index], wall, rolling, history, table[index])
        if raised(stop):
            table[index] = np.nan
            return
        status[index] = settled.status
        if settled.status in (STATUS.runaway, STATUS.limit_reached):
            table[index] = np.nan


SAMPLE = 7
"""Columns of a sample: place (3), velocity (3), mode."""


@compiled
def follow(wall: bool, rolling: float, group: Floats, phases: Floats, stop: Stop) -> Floats:
    """Return position, velocity and mode of a part at phases of its cycle, for its trajectory.

    Shape (phases, 7): place (3) in g/w^2, velocity (3) in g/w, mode.
    """
    cell = cell_of(group)
    samples = np.full((phases.size, SAMPLE), math.nan)
    samples[:, SAMPLE - 1] = MODE.unknown
    history, work = new_history(int(cell.max_periods), stop), new_work()
    settled, state, hold = follow_from_rest(group, wall, rolling, FINE, history, work)
    if settled.status == STATUS.limit_reached:
        return samples
    state[STATE.x] = 0.0
    tally, begin, periods = np.zeros(len(TALLY)), 0, 0
    while begin < phases.size and not raised(stop):
        start_phase = periods * TURN
        end = begin
        while end < phases.size and phases[end] < start_phase + TURN:
            end += 1
        succeeded = advance(
            cell, wall, rolling, FINE.order, FINE.tolerance * push.drive_speed(work), state, hold,
            tally, work, phases[begin:end] - start_phase, samples[begin:end], tally[:0],
        )  # fmt: skip
        if not succeeded:
            return samples
        begin, periods = end, periods + 1
    return samples


@compiled
def power_cells(
    wall: bool, rolling: float, groups: Floats, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill the table of mean powers of cells in space: what friction, impacts and the drive do.

    `table` has the columns of `POWER`, per mass in g^2/w; NaN without a cycle (theory 13.15).
    """
    if groups.shape[0] == 0:
        return
    history, work = new_history(max(1, int(groups[:, GROUPS - 1].max())), stop), new_work()
    tally = np.zeros(len(TALLY))
    for index in range(groups.shape[0]):
        row, powers = groups[index], table[index]
        settled, state, hold = follow_from_rest(row, wall, rolling, FINE, history, work)
        powers[:] = math.nan
        if raised(stop):
            return
        status[index] = settled.status
        if settled.multiple == 0:
            continue
        tolerance, succeeded = FINE.tolerance * push.drive_speed(work), True
        powers[:] = 0.0
        for _ in range(settled.multiple):
            succeeded = succeeded and advance(
                cell_of(row), wall, rolling, FINE.order, tolerance, state, hold, tally, work,
                NO_PHASES, history.ends[:0], powers,
            )  # fmt: skip
        powers /= settled.multiple * TURN if succeeded else math.nan
