"""Rows of parts by time stepping with isotonic contact: any planar drive, first order (theory 17).

A step h takes velocities u to those that minimise sum m (u' - u - h D)^2/2 + mu m I |u'| under the
order of touching parts, I the impulse of the floor per mass, and places by the mean of both.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.rows.advance import ON_FLOOR, Air
from vibrafeed.core.motion.kernels.rows.contact import pooled
from vibrafeed.core.motion.kernels.rows.repeat import (
    AGREES_NEARLY,
    MULTIPLES,
    Past,
    cycle_of,
    finish,
    keep,
    past_of,
    remaining,
    shortest,
)
from vibrafeed.core.motion.kernels.rows.tables import (
    AT,
    COLUMN,
    IN_SPACE,
    NO_STOP,
    TALLIES,
    Row,
    columns_of,
    row_of,
)
from vibrafeed.core.motion.kernels.statuses import STATUS

SAFETY = 3.0
"""Factor of the difference between two step lengths, which may be small by chance."""
TOUCHES = 1e-12
"""In g/w^2: parts that are no farther apart touch; rounding leaves some 1e-16."""
STEP_SHARE = 0.5
"""Share of the change of velocity in a step that counts as error: landings, stops and strokes fall
anywhere within a step."""


class Pushes(NamedTuple):
    """The push along and that off the floor in the middles of the steps of a period, in g.

    `backward` is the velocity of a body at rest in space relative to the track, at the ends of the
    steps, in g/w.
    """

    along: Floats
    normal: Floats
    backward: Floats


@compiled
def pushes_of(cell: Floats, steps: int) -> Pushes:
    """Return the drive of a row, sampled in the middles of the `steps` time steps of a period.

    Push along and normal to the floor in g, and the velocity relative to the track of a body at
    rest in space in g/w (w = 2 pi f), such as a stop; each of shape (steps,). `cell` holds the
    row's numbers: columns of `Head`, then the parts and the wave.
    """
    columns, h = columns_of(cell), TURN / steps
    along, normal, backward = np.zeros(steps), np.zeros(steps), np.zeros(steps)
    orders, levels = columns.orders, columns.steps
    for k in range(steps):
        tau = (k + 0.5) * h
        if orders == 0 and levels == 0:
            sine = math.sin(tau)
            along[k] = cell[AT.drive_number_along] * sine
            normal[k] = cell[AT.drive_number_normal] * sine
        for order in range(orders):
            sine, cosine = math.sin((order + 1) * tau), math.cos((order + 1) * tau)
            at, up = columns.along + order, columns.normal + order
            along[k] += cell[at] * sine + cell[at + orders] * cosine
            normal[k] += cell[up] * sine + cell[up + orders] * cosine
        if levels > 0:
            step = 0
            while step < levels - 1 and tau >= cell[columns.ends + step]:
                step += 1
            along[k] += cell[columns.levels + step]
            normal[k] += cell[columns.normal_levels + step]
        backward[k] = (backward[k - 1] if k > 0 else 0.0) + h * along[k]
    return Pushes(along, normal, backward - backward.mean() + 0.5 * h * along.mean())


@compiled
def impel(row: Row, first: int, end: int, v: Floats, mu: Floats, impulse: float) -> None:
    """Set a chain's speeds after an impulse of the floor: v - mu I or v + mu I pooled, or 0.

    Pooled: parts that would move into each other get their common mean. Parts `first` to before
    `end` of `row`, with velocities `v` without friction in g/w (w = 2 pi f) and coefficients `mu`;
    `impulse` is I per mass, in g/w. Forward speeds are those of v - mu I above 0, backward ones
    those of v + mu I below 0.
    """
    for i in range(first, end):
        row.value[i] = v[i] - mu[i] * impulse
    pooled(row, first, end)
    for i in range(first, end):
        row.speed[i] = max(0.0, row.value[i])
        row.value[i] = v[i] + mu[i] * impulse
    pooled(row, first, end)
    for i in range(first, end):
        row.speed[i] += min(0.0, row.value[i])


@compiled
def stepped_chain(
    row: Row, first: int, end: int, push: float, impulse: float, held: bool, v: Floats, mu: Floats
) -> float:
    """Set the speeds of a chain of touching parts after a time step; return impulse on the stop.

    The chain has the parts `first` to before `end` of `row`. `push` is the change of velocity
    without friction in g/w, `impulse` that of the floor per mass in g/w (w = 2 pi f); `held` is
    True if the chain touches the stop in front; `v` and `mu` are work arrays. Parts at rest have
    their static friction until they move. The result is in mass times g/w, 0 without a stop.
    """
    for i in range(first, end):
        v[i] = row.speed[i] + push
        mu[i] = row.static[i] if row.speed[i] == 0.0 else row.kinetic[i]
    impel(row, first, end, v, mu, impulse)
    starts = False
    for i in range(first, end):
        if row.speed[i] != 0.0 and mu[i] != row.kinetic[i]:
            mu[i], starts = row.kinetic[i], True
    if starts:
        impel(row, first, end, v, mu, impulse)
    if not held:
        return 0.0
    taken, limit = 0.0, row.speed[row.mass.size]
    for i in range(first, end):
        if row.speed[i] > limit or (row.speed[i] == limit and limit != 0.0):
            free = v[i] + (mu[i] if limit < 0.0 else -mu[i]) * impulse
            row.speed[i] = limit
            taken += row.mass[i] * (free - limit)
    return max(0.0, taken)


@compiled
def moved(row: Row, before: Floats, h: float, tally: Floats, swept: Floats) -> None:
    """Move all parts of a row over a time step of `h` rad by their mean speeds, h (u + u')/2.

    `before` holds the speeds u before the step in g/w (w = 2 pi f), `row` the speeds u' after it.
    Gaps change by the difference of two parts, and are at least 0. A contact is closed where gap
    and relative speed after the step are at most `TOUCHES`. `tally[0]` gets h times the closed
    contacts between parts, `swept` h times each gap between parts at the end of the step.
    """
    parts = row.mass.size
    for i in range(row.speed.size):
        way = 0.5 * h * (before[i] + row.speed[i])
        if i < parts:
            row.place[i] += way
        if i > 0:
            row.gap[i - 1] += way
        if i < row.gap.size:
            row.gap[i] -= way
    for i in range(row.gap.size):
        row.gap[i] = max(0.0, row.gap[i])
        near = abs(row.speed[i] - row.speed[i + 1]) <= TOUCHES
        touches = row.gap[i] <= TOUCHES and near
        row.closed[i] = 1 if touches else 0
        if i < parts - 1:
            tally[0] += h if touches else 0.0
            swept[i] += h * row.gap[i]


@compiled
def _touches_next(row: Row, v: Floats, i: int, span: float) -> bool:
    """True if part `i` touches the next one after `span` rad: gap + span (v' - v) <= TOUCHES.

    `v` are the speeds of the parts, v' that of the next one.
    """
    return row.gap.size > i and row.gap[i] + span * (v[i + 1] - v[i]) <= TOUCHES


@compiled
def stepped_period(
    row: Row, gs: float, gn: float, pushes: Pushes, height: float, rate: float, tally: Floats,
    swept: Floats, before: Floats, v: Floats, mu: Floats, past: Past, period: int,
) -> tuple[float, float]:  # fmt: skip
    """Follow a row over a period by time steps; return height and normal velocity at its end.

    Parameters
    ----------
    row
        Parts and contacts, changed to those at the end.
    gs, gn
        Gravity along and onto the floor in g.
    pushes
        Drive in the middles of the steps in g.
    height, rate
        Height in g/w^2 (w = 2 pi f) and normal velocity in g/w, the same for all parts.
    tally
        Sums over the period in the order of `Tally`, which are added.
    swept
        The integrals of the gaps between parts over the phase are added.
    before, v, mu
        Work arrays of a value a part (and the stop).
    past, period
        Record of the periods in which contacts touched, and the number of this one.
    """
    steps, parts = pushes.along.size, row.mass.size
    h = TURN / steps
    for k in range(steps):
        fall = rate + h * (pushes.normal[k] - gn)
        impulse = max(0.0, -fall) if height + 0.5 * h * rate <= 0.0 else 0.0
        height = max(0.0, height + 0.5 * h * (rate + fall + impulse))
        rate = fall + impulse
        before[: row.speed.size] = row.speed
        if row.stop == IN_SPACE:
            row.speed[parts] = pushes.backward[k]
        first, taken, held = 0, 0.0, False
        for i in range(parts):
            more = _touches_next(row, before, i, 0.5 * h)
            held = more and i == parts - 1
            if more:
                past.touched[i] = period
            if not more or held:
                taken += stepped_chain(
                    row, first, i + 1, h * (pushes.along[k] - gs), impulse, held, v, mu
                )
                first = i + 1
        moved(row, before, h, tally, swept)
        tally[1] += h if impulse == 0.0 else 0.0
        tally[4] += taken
        tally[7] += h if row.stop != NO_STOP and row.closed[parts - 1] == 1 else 0.0
        slides = before[:parts].any() or row.speed[:parts].any()
        tally[8] += h if impulse == 0.0 or slides else 0.0
    return height, rate


@compiled
def follow_steps(cell: Floats, steps: int, result: Floats, stop: Stop) -> int:
    """Follow a row of parts by time stepping until it repeats; fill results and return status.

    A second method beside events, for verification. `cell` holds the row's numbers (columns of
    `Head`, then the parts and the wave), `steps` is the number of steps a period of the drive;
    `result` has the columns of `COLUMN`, then velocity and platoon of each part; `stop` is a flag
    that ends the work.
    """
    result[:] = math.nan
    row, pushes, most = row_of(cell), pushes_of(cell, steps), int(cell[AT.max_periods])
    parts = row.mass.size
    gs, gn = cell[AT.gravity_number_along], cell[AT.gravity_number_normal]
    if row.stop == IN_SPACE:
        row.speed[parts] = pushes.backward[-1]
    scale = max(1e-300, np.abs(pushes.along).max() + np.abs(pushes.normal).max())
    if gn <= 0.0:
        return int(STATUS.limit_reached)
    past, air, height, rate = past_of(row), ON_FLOOR, 0.0, 0.0
    means = np.zeros((most, TALLIES + 2 * parts - 1))
    before, v, mu = np.zeros(parts + 1), np.zeros(parts), np.zeros(parts)
    for period in range(most):
        if raised(stop):
            return int(STATUS.not_computed)
        keep(row, air, past, period)
        here = means[period]
        height, rate = stepped_period(
            row, gs, gn, pushes, height, rate, here, here[TALLIES + parts :], before, v, mu,
            past, period,
        )  # fmt: skip
        air = Air(height + rate, 0.0) if height > 0.0 else ON_FLOOR
        here[TALLIES : TALLIES + parts] = row.place - past.place[period % (MULTIPLES + 1)]
        cycle = cycle_of(row, air, past, period + 1, 0, scale)
        if cycle > 0:
            left = remaining(row, past, period + 1, cycle, 0, scale)
            status = finish(row, past, means, period + 1, cycle, left, scale, result)
            result[COLUMN.multiple] = shortest(
                row, air, past, period + 1, cycle, AGREES_NEARLY, scale
            )
            return status
    return finish(row, past, means, most, 0, 0.0, scale, result)


@compiled
def stepped_rows(steps: int, cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the result table of cells by time stepping; two step lengths give the error.

    Collisions and the energy that they take, and impulse and largest force on the stop, are NaN, as
    steps do not tell them.

    Parameters
    ----------
    steps
        Steps a period of the coarse run; the fine one takes 2 `steps` + 1.
    cells
        A row for each cell: columns of `Head`, then parts and wave.
    table
        A row for each cell: columns of `COLUMN`, then velocity and platoon of each part.
    status
        A value of `STATUS` for each cell.
    stop
        Flag that ends the work; cells not reached are left as they are.
    """
    coarse = np.zeros(table.shape[1])
    for number in range(cells.shape[0]):
        cell, fine = cells[number], table[number]
        found = follow_steps(cell, 2 * steps + 1, fine, stop)
        follow_steps(cell, steps, coarse, stop)
        if raised(stop):
            return
        apart = abs(fine[COLUMN.velocity] - coarse[COLUMN.velocity])
        pushes = pushes_of(cell, steps)
        most = np.abs(pushes.along).max() + np.abs(pushes.normal).max()
        most += cell[AT.gravity_number_normal]
        fine[COLUMN.error] += SAFETY * apart + STEP_SHARE * most * TURN / (2 * steps + 1)
        fine[COLUMN.collisions], fine[COLUMN.impact] = math.nan, math.nan
        fine[COLUMN.stop_impulse], fine[COLUMN.stop_peak] = math.nan, math.nan
        status[number] = found
