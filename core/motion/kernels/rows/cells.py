"""Rows of many cells, period by period until they repeat, and the path of one (theory 17.4)."""

from __future__ import annotations

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from core.compiled import compiled, raised
from core.motion.kernels.arrays import Floats, Statuses, Stop
from core.motion.kernels.planar.flow import TURN
from core.motion.kernels.rows.advance import (
    HIT,
    ON_FLOOR,
    START,
    Air,
    happened,
    move,
    next_event,
    refreshed,
)
from core.motion.kernels.rows.tables import COLUMN, Drive, Row, Whole, drive_of, row_of
from core.motion.kernels.statuses import STATUS

MULTIPLES = 12
"""Periods of the longest cycle that is looked for: 2 and 4 are common, longer ones rare."""
AGREES = 1e-12
"""Of the drive: states that are no farther apart are the same. Rounding leaves some 1e-15."""
BATCHES = 16
"""Of the second half of a motion that does not repeat; their means give its error."""
MOST_EVENTS = 100_000
"""Of a period: a row of 64 parts has some hundreds, so this is one that sticks in its rounding."""


class Past(NamedTuple):
    """States at the starts of the last periods: the row of period p is p % (MULTIPLES + 1).

    `touched` counts of each contact the last period in which its parts touched.
    """

    speed: Floats
    place: Floats
    gap: Floats
    landing: Floats
    touched: Whole


Tally = namedtuple("Tally", "closed air hits lost failed")
"""Of a period: phase times closed contacts, phase in the air, collisions, energy they took."""


@compiled
def past_of(row: Row) -> Past:
    """Return room for the last periods of a row."""
    size, parts = MULTIPLES + 1, row.mass.size
    return Past(
        np.zeros((size, parts)), np.zeros((size, parts)), np.zeros((size, parts - 1)),
        np.zeros(size), np.zeros(parts - 1, dtype=np.int64),
    )  # fmt: skip


@compiled
def keep(row: Row, air: Air, past: Past, period: int) -> None:
    """Keep the state at the start of a period."""
    at = period % (MULTIPLES + 1)
    past.speed[at, :] = row.speed
    past.place[at, :] = row.place
    past.gap[at, :] = row.gap
    past.landing[at] = air.landing


@compiled
def one_period(
    row: Row, drive: Drive, restitution: float, air: Air, past: Past, period: int
) -> tuple[Air, Tally]:
    """Follow a row over one period of the drive."""
    tau, step, events = 0.0, 0, 0
    closed, flying, hits, lost = 0.0, 0.0, 0.0, 0.0
    refreshed(row, drive, drive.levels[0], tau, air.landing < math.inf, -1)
    while True:
        end = drive.ends[step]
        event = next_event(row, drive, drive.levels[step], tau, end - tau, air.landing)
        move(row, tau, event.span)
        for i in range(row.closed.size):
            if row.closed[i] == 1:
                closed += event.span
                past.touched[i] = period
        if air.landing < math.inf:
            flying += event.span
        air = Air(air.landing - event.span, air.impulse)
        tau += event.span
        if event.kind == 0:
            tau, step = end, step + 1
            if step == drive.ends.size:
                return air, Tally(closed, flying, hits, lost, False)
        if event.kind == HIT:
            hits += 1.0
            past.touched[event.part] = period
        air, taken = happened(row, drive, event, tau, air, restitution)
        lost += taken
        events += 1
        if events > MOST_EVENTS:
            return air, Tally(closed, flying, hits, lost, True)
        forced = event.part if event.kind == START else -1
        refreshed(row, drive, drive.levels[step], tau, air.landing < math.inf, forced)


@compiled
def repeats(row: Row, air: Air, past: Past, period: int, multiple: int, scale: float) -> bool:
    """True if the state after a period is that of `multiple` periods before.

    A gap may have grown, if its parts did not touch in between: each side of it then moves as it
    did, and the gap grows for ever.
    """
    at = (period - multiple) % (MULTIPLES + 1)
    here, before = air.landing, past.landing[at]
    if (here < math.inf) != (before < math.inf):
        return False
    if here < math.inf and abs(here - before) > AGREES:
        return False
    for i in range(row.mass.size):
        if abs(row.speed[i] - past.speed[at, i]) > AGREES * scale:
            return False
    for i in range(row.gap.size):
        grown = row.gap[i] - past.gap[at, i]
        touched = past.touched[i] > period - multiple - 1
        if abs(grown) > AGREES * scale and (grown < 0.0 or touched):
            return False
    return True


@compiled
def platoons(row: Row, past: Past, period: int, multiple: int, scale: float) -> int:
    """Return how many groups of parts have left each other for ever, or as it seems."""
    at = (period - multiple) % (MULTIPLES + 1)
    count = 1
    for i in range(row.gap.size):
        if row.gap[i] - past.gap[at, i] > AGREES * scale:
            count += past.touched[i] < period - multiple
    return count


@compiled
def follow(cell: Floats, result: Floats, stop: Stop) -> int:
    """Write the results of a row of parts; return its status."""
    drive, row = drive_of(cell), row_of(cell)
    restitution, most = cell[4], int(cell[5])
    scale = max(1e-300, abs(drive.c) + np.abs(drive.levels).max())
    past, air = past_of(row), ON_FLOOR
    if drive.s > 0.0 and drive.gn <= 0.0:
        return int(STATUS.limit_reached)
    means = np.zeros((most, 4 + row.mass.size))
    for period in range(most):
        if raised(stop):
            return int(STATUS.not_computed)
        keep(row, air, past, period)
        air, tally = one_period(row, drive, restitution, air, past, period)
        if tally.failed:
            return int(STATUS.limit_reached)
        means[period, :4] = (tally.closed, tally.air, tally.hits, tally.lost)
        means[period, 4:] = row.place - past.place[period % (MULTIPLES + 1)]
        for multiple in range(1, min(MULTIPLES, period) + 1):
            if repeats(row, air, past, period + 1, multiple, scale):
                result[COLUMN.platoons] = platoons(row, past, period + 1, multiple, scale)
                _write(means[period + 1 - multiple : period + 1], result)
                result[COLUMN.multiple] = multiple
                result[COLUMN.error] = AGREES * scale
                result[COLUMN.spread] = 0.0
                moves = np.abs(means[period + 1 - multiple : period + 1, 4:]).max() > 0.0
                return int(STATUS.periodic if moves else STATUS.at_rest)
    half = means[most // 2 :]
    _write(half, result)
    batch = max(1, half.shape[0] // BATCHES)
    batches = np.empty(half.shape[0] // batch)
    for b in range(batches.size):
        batches[b] = half[b * batch : (b + 1) * batch, 4:].mean() / TURN
    result[COLUMN.spread] = batches.std()
    result[COLUMN.error] = 2.0 * batches.std() / math.sqrt(batches.size)
    result[COLUMN.platoons] = platoons(row, past, most, min(MULTIPLES, most), scale)
    result[COLUMN.multiple] = 0.0
    return int(STATUS.aperiodic)


@compiled
def _write(periods: Floats, result: Floats) -> None:
    """Write means over periods, whose columns are those of `Tally`, then the ways of the parts."""
    count, parts = periods.shape[0], periods.shape[1] - 4
    phase = count * TURN
    slowest, fastest, total = math.inf, -math.inf, 0.0
    for i in range(parts):
        speed = periods[:, 4 + i].sum() / phase
        slowest, fastest = min(slowest, speed), max(fastest, speed)
        total += speed
    result[COLUMN.velocity] = total / parts
    result[COLUMN.slowest], result[COLUMN.fastest] = slowest, fastest
    result[COLUMN.contact] = periods[:, 0].sum() / (phase * (parts - 1))
    result[COLUMN.flight] = periods[:, 1].sum() / phase
    result[COLUMN.collisions] = periods[:, 2].sum() / count
    result[COLUMN.impact] = periods[:, 3].sum() / count


@compiled
def row_cells(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the table of cells, each a row."""
    for number in range(cells.shape[0]):
        found = follow(cells[number], table[number], stop)
        if raised(stop):
            return
        status[number] = found


@compiled
def path_of_row(cell: Floats, phases: Floats, places: Floats, gaps: Floats) -> None:
    """Write places and gaps of the parts of a row at phases from its start on, in order."""
    drive, row = drive_of(cell), row_of(cell)
    air = ON_FLOOR
    tau, step, turn, at, forced = 0.0, 0, 0, 0, -1
    while at < phases.size:
        refreshed(row, drive, drive.levels[step], tau, air.landing < math.inf, forced)
        until = min(drive.ends[step], max(tau, phases[at] - turn * TURN))
        event = next_event(row, drive, drive.levels[step], tau, until - tau, air.landing)
        move(row, tau, event.span)
        air = Air(air.landing - event.span, air.impulse)
        tau += event.span
        if event.kind == 0:
            tau = until
            if phases[at] - turn * TURN <= tau:
                places[at, :], gaps[at, :] = row.place, row.gap
                at += 1
            if tau == drive.ends[step]:
                step += 1
                if step == drive.ends.size:
                    tau, step, turn = 0.0, 0, turn + 1
        air, _ = happened(row, drive, event, tau, air, cell[4])
        forced = event.part if event.kind == START else -1
