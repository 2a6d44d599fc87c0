"""What friction, impacts and the drive do over a cycle, per mass (theory 13.15)."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled, raised
from core.motion.kernels.arrays import Floats, Statuses, Stop
from core.motion.kernels.cells import GROUPS, cell_of
from core.motion.kernels.results import TALLY
from core.motion.kernels.track import drive
from core.motion.kernels.track.advance import advance
from core.motion.kernels.track.cycle import NO_PHASES, new_history, to_cycle
from core.motion.kernels.track.solve import FINE
from core.motion.kernels.track.tables import TURN, new_work


@compiled
def spend_cells(
    wall: bool, rolling: float, groups: Floats, table: Floats, status: Statuses, stop: Stop
) -> None:
    """Fill table, columns as in `SPENT`, and status of cells; NaN where a motion has no cycle.

    The cycle is followed once more, from where the run to it found its start.
    """
    if groups.shape[0] == 0:
        return
    history, work = new_history(max(1, int(groups[:, GROUPS - 1].max())), stop), new_work()
    tally = np.zeros(len(TALLY))
    for number in range(groups.shape[0]):
        row, spent = groups[number], table[number]
        found, state, hold = to_cycle(row, wall, rolling, FINE, history, work)
        spent[:] = math.nan
        if raised(stop):
            return
        status[number] = found.status
        if found.multiple == 0:
            continue
        tolerance, fine = FINE.tolerance * drive.size(work), True
        spent[:] = 0.0
        for _ in range(found.multiple):
            fine = fine and advance(
                cell_of(row), wall, rolling, FINE.order, tolerance, state, hold, tally, work,
                NO_PHASES, history.ends[:0], spent,
            )  # fmt: skip
        spent /= found.multiple * TURN if fine else math.nan
