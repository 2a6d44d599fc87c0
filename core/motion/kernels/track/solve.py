"""One cell from its groups to its results, and many cells."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Flags, Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.cells import GROUPS, Cell, cell_of
from vibrafeed.core.motion.kernels.means import (
    ended,
    fill_means,
    mean_error,
    mean_velocity,
    scatter,
)
from vibrafeed.core.motion.kernels.results import COLUMN, TALLY
from vibrafeed.core.motion.kernels.statuses import STATUS
from vibrafeed.core.motion.kernels.track import drive
from vibrafeed.core.motion.kernels.track.cycle import (
    History,
    Series,
    Settled,
    follow_period,
    new_history,
    remaining,
    settle,
    to_cycle,
)
from vibrafeed.core.motion.kernels.track.tables import STATE, TURN, Work, at_rest, new_work

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
"""Of the restitution: what other runs lose more at each impact than the first.

Series of all orders are alike under steps, and only this parts such runs. It comes to `STRAYED`
where changes grow by 1e11 on the way, from where on digits decide in the plane, too.
"""
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

    |sin(gamma)| > mu n + mu_w max(0, n_y) with the larger friction mu of the floor and that of the
    wall, mu_w: the mean loads of the floor, n, and of the wall of a straight track, n_y, are those
    of gravity, in g. Without a wall (`wall` False) gravity across pulls as well. False for a curved
    wall with friction, whose load grows with speed (theory 13.8). `cell` holds the part's numbers.
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
    """Fill the result of a motion that did not repeat, and return its status.

    `aperiodic` with the mean velocity of the last three quarters of its `done` periods, in g/w (w =
    2 pi f), and the error and spread from batches of them; `runaway` or `limit_reached` without a
    mean where the velocity keeps growing or drifts (theory 13.13).

    Parameters
    ----------
    cell, wall
        The cell's numbers; True if there is a wall.
    speed
        Velocity amplitude of the drive in g/w.
    history
        Sums of each period (`tallies`, columns of `TALLY`).
    result
        Row with the columns of `COLUMN`, filled.
    """
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
    """Return the status of a cell that needs no simulation (else `UNDECIDED`); True if it rubs.

    `limit_reached` if a number is not finite, nothing presses the part onto the floor, or no period
    may be followed; `runaway` if gravity along exceeds friction. It rubs if floor or wall have
    friction. `row` holds all numbers of the cell, with its wave, `wall` is True if there is a wall.
    """
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

    The means over the cycle. The error is twice the difference to the velocity of other runs, plus
    the rest of the transient and 2e-10 of the drive's speed; `sensitive` is returned if the last
    digits decide the motion (theory 13.13).

    `row` holds the cell's numbers, `wall` is True if there is a wall, `rolling` is m r^2/I of a
    cylinder or 0, `history` receives the periods, `result` has the columns of `COLUMN`. The record
    has the status, the periods after which the motion repeats (0 if it does not), the periods
    followed, and the rest of the transient in g/w (w = 2 pi f).
    """
    cell = cell_of(row)
    result[:] = math.nan
    at_once, rubs = solve_at_once(cell, row, wall)
    if at_once != UNDECIDED:
        return Settled(at_once, 0, 0, math.inf)
    work = new_work()
    settled, state, hold = to_cycle(row, wall, rolling, FINE, history, work)
    speed = drive.size(work)
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
    """Return an estimate of the error of a mean velocity in g/w, by a run with shorter series.

    The run follows the cycle of `multiple` periods twice from its start (`state`, `hold`, both
    changed). The result is the difference of its mean velocity in the second time from `velocity`,
    plus the distance that its state still has to go to repeat; NaN if the run fails. Here w = 2 pi
    f. `cell` holds the part's numbers, `wall` is True if there is a wall, `rolling` is m r^2/I of a
    cylinder or 0; `history` and `work` are overwritten.
    """
    last = min(2 * multiple, history.starts.shape[0])
    for period in range(last):
        if not follow_period(cell, wall, rolling, COARSE, period, state, hold, history, work):
            return math.nan
    travel = history.tallies[:, TALLY.travel]
    off = abs(mean_velocity(travel, last - multiple, last, TURN) - velocity)
    return off + remaining(wall, rolling, history, last - 1, multiple, 0)


@compiled
def changed(row: Floats, hairs: float) -> Cell:
    """Return the numbers of a cell with restitutions of floor and wall reduced to e (1 - k 1e-12).

    k is `hairs`, `row` the row of the kernel's table, which stays as it is. If such a cell ends in
    another motion, the last digits decide in which of several motions a part ends.
    """
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

    With rebounds, the last digits may decide in which of several motions a part ends (theory
    13.13). So it is run again from rest with shorter series and restitutions smaller by 1e-12 of
    themselves (`changed`). The mean is not confirmed if the velocity along at the ends of its
    periods is anywhere more than 0.1 of the drive's speed from that of the first run; three more
    runs, of yet smaller restitutions, then take part in the difference, the largest |v' - v| of
    their means v' from `velocity` v, in g/w (w = 2 pi f). NaN if a run fails.

    Parameters
    ----------
    row, wall, rolling
        The cell's numbers; True with a wall; m r^2/I of a cylinder or 0.
    settled, velocity
        Record of how the first run came to repeat, of which the number of periods is used, and its
        mean velocity in g/w.
    history, work
        Periods of the first run, and work table; both are overwritten.
    """
    speeds = history.ends[: settled.done, STATE.ux].copy()
    state, hold = at_rest()
    other, done = settled_velocity(
        changed(row, 1.0), wall, rolling, COARSE, settled.done, state, hold, history, work
    )
    most, strayed = abs(other - velocity), 0.0
    for period in range(min(done, speeds.size)):
        strayed = max(strayed, abs(history.ends[period, STATE.ux] - speeds[period]))
    if strayed < STRAYED * drive.size(work):
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
    """Return the mean velocity of another run of a cell in g/w, and the periods it took.

    A run with shorter series shows the error of the first. It starts from `state` and `hold`, which
    change, and may take four times as long as the `done` periods of the first run, and 32 more; NaN
    if it does not repeat then. Here w = 2 pi f. `cell` holds the part's numbers, `wall` is True if
    there is a wall, `rolling` is m r^2/I of a cylinder or 0, `series` sets order and tolerance;
    `history` and `work` are overwritten.
    """
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
    """Fill table and statuses of cells with the means of their motion.

    Parameters
    ----------
    wall, rolling
        If there is a wall, and m r^2/I of a cylinder (radius r, moment of inertia I) or 0.
    groups
        A row a cell: the fields of `Cell`, then its wave.
    table
        A row a cell, with the columns of `COLUMN`; NaN for a cell without means.
    status
        A value of `STATUS` for each cell.
    stop
        Flag that ends the work; cells not reached are left as they are.
    """
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
