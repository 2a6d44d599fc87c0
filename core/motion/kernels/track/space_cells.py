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
    ended,
    fill_means,
    mean_error,
    mean_velocity,
    scatter,
)
from vibrafeed.core.motion.kernels.track import push
from vibrafeed.core.motion.kernels.track.advance import advance
from vibrafeed.core.motion.kernels.track.push import STATE, TURN, Work, at_rest, new_work
from vibrafeed.core.motion.kernels.track.settling import (
    NO_PHASES,
    History,
    Series,
    Settled,
    follow_period,
    new_history,
    remaining,
    settle,
    to_cycle,
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
def without_repeating(
    cell: Cell, wall: bool, speed: float, history: History, done: int, result: Floats
) -> int:
    """Fill the result of a motion that did not repeat, and return its status."""
    travel, pull = history.tallies[:done, TALLY.travel], abs(cell.gravity_number_along)
    status, batches = ended(cell, wall, pull, travel, TURN, LEAST_ERROR * speed)
    if status != STATUS.aperiodic:
        return status
    fill_means(history.tallies, done // 4, done, TURN, result)
    result[COLUMN.velocity] = np.mean(batches)
    result[COLUMN.spread] = scatter(batches)
    result[COLUMN.error] = mean_error(batches) + LEAST_ERROR * speed
    return STATUS.aperiodic


@compiled
def solve_at_once(cell: Cell, row: Floats, wall: bool) -> tuple[int, bool]:
    """Return the status of a cell that needs no simulation (else `UNDECIDED`); True if it rubs."""
    total = 0.0
    for value in row:
        total += value
    weightless = cell.gravity_number_normal <= 0.0
    if not math.isfinite(total) or weightless or int(cell.max_periods) < 1:
        return STATUS.limit_reached, False
    rubs = cell.friction_kinetic + cell.friction_static > 0.0
    if wall:
        rubs = rubs or cell.wall_friction > 0.0
    away = never_settles(cell, wall) if rubs else cell.gravity_number_along != 0.0
    return STATUS.runaway if away else UNDECIDED, rubs


@compiled
def solve(row: Floats, wall: bool, rolling: float, history: History, result: Floats) -> Settled:
    """Fill the result of a cell followed from rest in space; return how its motion repeats.

    The error is twice the difference to the velocity of other runs, plus the rest of the transient
    and 2e-10 of the drive's speed (theory 13.13).
    """
    cell = cell_of(row)
    result[:] = math.nan
    at_once, rubs = solve_at_once(cell, row, wall)
    if at_once != UNDECIDED:
        return Settled(at_once, 0, 0, math.inf)
    work = new_work()
    settled, state, hold = to_cycle(row, wall, rolling, FINE, history, work)
    speed = push.size(work)
    if settled.multiple == 0:
        if settled.status == STATUS.aperiodic:
            status = without_repeating(cell, wall, speed, history, settled.done, result)
            return Settled(status, 0, settled.done, math.inf)
        return settled
    fill_means(history.tallies, settled.done - settled.multiple, settled.done, TURN, result)
    result[COLUMN.multiple] = float(settled.multiple)
    if settled.status == STATUS.at_rest:
        result[COLUMN.velocity] = 0.0
        return settled
    status = settled.status if rubs else STATUS.neutral
    velocity = result[COLUMN.velocity]
    if cell.restitution > 0.0 or (wall and cell.wall_restitution > 0.0):
        apart, confirmed = settled_anew(row, wall, rolling, settled, velocity, history, work)
    else:
        confirmed = True
        apart = followed_on(
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
        if not apart < SLOWLY * speed:
            other, _ = settled_velocity(
                cell, wall, rolling, COARSE, settled.done, state, hold, history, work
            )
            apart = abs(other - velocity)
    error = 2.0 * apart + settled.left + LEAST_ERROR * speed
    result[COLUMN.error] = error if error < 2.0 * speed else 2.0 * speed
    if not confirmed or not error < max(SURELY, 100.0 * cell.tolerance) * speed:
        result[COLUMN.multiple] = 0.0
        return Settled(STATUS.sensitive, 0, settled.done, error)
    return Settled(status, settled.multiple, settled.done, settled.left)


@compiled
def followed_on(
    cell: Cell, wall: bool, rolling: float, multiple: int, state: Floats, hold: Flags,
    velocity: float, history: History, work: Work,
) -> float:  # fmt: skip
    """Return an estimate of the error of a mean velocity in g/w, by a run with shorter series."""
    last = min(2 * multiple, history.starts.shape[0])
    for period in range(last):
        if not follow_period(cell, wall, rolling, COARSE, period, state, hold, history, work):
            return math.nan
    travel = history.tallies[:, TALLY.travel]
    off = abs(mean_velocity(travel, last - multiple, last, TURN) - velocity)
    return off + remaining(wall, rolling, history, last - 1, multiple, 0)


@compiled
def changed(row: Floats, hairs: float) -> Cell:
    """Return a cell with restitutions of floor and wall reduced to e (1 - `hairs` 1e-12)."""
    row = row.copy()
    row[RESTITUTION] *= 1.0 - hairs * HAIR
    row[WALL_RESTITUTION] *= 1.0 - hairs * HAIR
    return cell_of(row)


@compiled
def settled_anew(
    row: Floats, wall: bool, rolling: float, settled: Settled, velocity: float, history: History,
    work: Work,
) -> tuple[float, bool]:  # fmt: skip
    """Return the largest difference of other runs from a mean velocity, True if it is confirmed.

    It is run again from rest with shorter series and `changed` restitutions. The mean is not
    confirmed if a velocity strays by more than 0.1 of the drive's speed; three more runs then take
    part (theory 13.13).
    """
    speeds = history.ends[: settled.done, STATE.ux].copy()
    state, hold = at_rest()
    other, done = settled_velocity(
        changed(row, 1.0), wall, rolling, COARSE, settled.done, state, hold, history, work
    )
    most, strayed = abs(other - velocity), 0.0
    for period in range(min(done, speeds.size)):
        strayed = max(strayed, abs(history.ends[period, STATE.ux] - speeds[period]))
    if strayed < STRAYED * push.size(work):
        return most, True
    for number in range(OTHERS):
        series = Series(COARSE.order, COARSE.tolerance / (2.0 + number))
        state, hold = at_rest()
        other, _ = settled_velocity(
            changed(row, 2.0 + number), wall, rolling, series, settled.done, state, hold, history,
            work,
        )  # fmt: skip
        most = max(most, abs(other - velocity)) if math.isfinite(other) else math.nan
    return most, False


@compiled
def settled_velocity(
    cell: Cell, wall: bool, rolling: float, series: Series, done: int, state: Floats, hold: Flags,
    history: History, work: Work,
) -> tuple[float, int]:  # fmt: skip
    """Return the mean velocity of another run of a cell in g/w, and the periods it took."""
    most = min(history.starts.shape[0] - 1, 4 * done + 32)
    again = settle(cell, wall, rolling, series, most, state, hold, history, work)
    if again.multiple == 0:
        return math.nan, again.done
    travel = history.tallies[:, TALLY.travel]
    return mean_velocity(travel, again.done - again.multiple, again.done, TURN), again.done


@compiled
def solve_cells(
    wall: bool, rolling: float, groups: Floats, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill table and statuses of cells with the means of their motion."""
    if groups.shape[0] == 0:
        return
    most = max(1, int(groups[:, GROUPS - 1].max()))
    history = new_history(most, stop)
    for number in range(groups.shape[0]):
        settled = solve(groups[number], wall, rolling, history, table[number])
        if raised(stop):
            table[number] = np.nan
            return
        status[number] = settled.status
        if settled.status in (STATUS.runaway, STATUS.limit_reached):
            table[number] = np.nan


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
    found, state, hold = to_cycle(group, wall, rolling, FINE, history, work)
    if found.status == STATUS.limit_reached:
        return samples
    state[STATE.x] = 0.0
    tally, sampled, periods = np.zeros(len(TALLY)), 0, 0
    while sampled < phases.size and not raised(stop):
        before = periods * TURN
        end = sampled
        while end < phases.size and phases[end] < before + TURN:
            end += 1
        fine = advance(
            cell, wall, rolling, FINE.order, FINE.tolerance * push.size(work), state, hold,
            tally, work, phases[sampled:end] - before, samples[sampled:end], tally[:0],
        )  # fmt: skip
        if not fine:
            return samples
        sampled, periods = end, periods + 1
    return samples


@compiled
def spend_cells(
    wall: bool, rolling: float, groups: Floats, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill the table of mean powers of cells in space: what friction, impacts and the drive do.

    `table` has the columns of `SPENT`, per mass in g^2/w; NaN without a cycle (theory 13.15).
    """
    if groups.shape[0] == 0:
        return
    history, work = new_history(max(1, int(groups[:, GROUPS - 1].max())), stop), new_work()
    tally = np.zeros(len(TALLY))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        settled, state, hold = to_cycle(row, wall, rolling, FINE, history, work)
        spent[:] = math.nan
        if raised(stop):
            return
        status[number] = settled.status
        if settled.multiple == 0:
            continue
        tolerance, fine = FINE.tolerance * push.size(work), True
        spent[:] = 0.0
        for _ in range(settled.multiple):
            fine = fine and advance(
                cell_of(row), wall, rolling, FINE.order, tolerance, state, hold, tally, work,
                NO_PHASES, history.ends[:0], spent,
            )  # fmt: skip
        spent /= settled.multiple * TURN if fine else math.nan
