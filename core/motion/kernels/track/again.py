"""A cycle followed once more: the course of one part, and what friction, impacts and the drive do.

Energies are means over the cycle, per mass (theory 13.15).
"""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.cells import GROUPS, cell_of
from vibrafeed.core.motion.kernels.results import TALLY
from vibrafeed.core.motion.kernels.statuses import MODE, STATUS
from vibrafeed.core.motion.kernels.track import drive
from vibrafeed.core.motion.kernels.track.advance import advance
from vibrafeed.core.motion.kernels.track.cycle import NO_PHASES, new_history, to_cycle
from vibrafeed.core.motion.kernels.track.solve import FINE
from vibrafeed.core.motion.kernels.track.tables import STATE, TURN, new_work

SAMPLE = 7
"""Columns of a sample: place (3), velocity (3), mode."""


@compiled
def follow(wall: bool, rolling: float, group: Floats, phases: Floats, stop: Stop) -> Floats:
    """Return position, velocity and mode of a part at phases of its cycle, for its trajectory.

    Shape (phases, 7): place (3) in g/w^2 (w = 2 pi f), velocity (3) in g/w, mode. If the motion
    does not repeat they are those after the periods that it is followed for. NaN and mode `unknown`
    on failure.

    Parameters
    ----------
    wall, rolling
        If there is a wall, and m r^2/I of a cylinder (radius r, moment of inertia I) or 0.
    group
        The cell's numbers: columns of `Cell`, then its wave.
    phases
        Ascending phases in rad from the start of the cycle.
    stop
        Flag that ends the work.
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
            cell, wall, rolling, FINE.order, FINE.tolerance * drive.size(work), state, hold,
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

    The cycle of each motion is found, and followed once more. `table` has the columns of `SPENT`,
    powers per mass in g^2/w (w = 2 pi f); NaN without a cycle. `status` gets the status of the
    motion. `groups` has a row of numbers for each cell, `wall` is True if there is a wall,
    `rolling` is m r^2/I of a cylinder or 0, `stop` is a flag that ends the work (theory 13.15).
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
        tolerance, fine = FINE.tolerance * drive.size(work), True
        spent[:] = 0.0
        for _ in range(settled.multiple):
            fine = fine and advance(
                cell_of(row), wall, rolling, FINE.order, tolerance, state, hold, tally, work,
                NO_PHASES, history.ends[:0], spent,
            )  # fmt: skip
        spent /= settled.multiple * TURN if fine else math.nan
