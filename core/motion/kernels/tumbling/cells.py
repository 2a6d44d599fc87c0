"""Many cells, and one path."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Statuses, Stop
from vibrafeed.core.motion.kernels.tumbling.events import run_events
from vibrafeed.core.motion.kernels.tumbling.run import fill
from vibrafeed.core.motion.kernels.tumbling.tables import PATH_COLUMNS, STATE, cell_of


@compiled
def tumble_events(cells: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the table of results and the statuses of many tumbling parts, from event to event.

    `cells` has a row of numbers for each (columns of `Cell`, SI), `table` a row with the columns of
    `COLUMN`, `status` one value. `stop` is a flag that ends the work, with the rest left as it is.
    """
    state, times, rows = np.empty(len(STATE)), np.empty(0), np.empty((0, PATH_COLUMNS))
    for number in range(cells.shape[0]):
        cell = cell_of(cells[number])
        run = run_events(cell, state, times, rows, stop)
        if raised(stop):
            return
        fill(cell, run, state, table[number])
        status[number] = run.status


@compiled
def path_events(row: Floats, times: Floats, rows: Floats, stop: Stop) -> None:
    """Write the path of one cell at ascending times in s into `rows`, by event-driven simulation.

    `row` has the columns of `Cell`; each of `rows` has those of `PATH`.
    """
    run_events(cell_of(row), np.empty(len(STATE)), times, rows, stop)
