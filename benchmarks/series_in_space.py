"""Where the time of a cell in space goes, and whether another order of the series is cheaper.

    python -m benchmarks.series_in_space [--cells 200] [--seed 14]

Random cells of the kinds of `benchmarks.events_in_space` that repeat. For each order the mean time
until a cell repeats and that of one of its periods, at the tolerance that the method has; then the
whole cell, which has the error to state as well, and the periods that a cell is followed before the
cycle, which no start but the cycle itself would save.
"""

from __future__ import annotations

import time

import numpy as np

from benchmarks.events_in_space import KINDS, SETTINGS, random_groups, timed
from benchmarks.options import options
from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.groups import cells_of
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.cells import cell_of
from vibrafeed.core.motion.kernels.track import drive
from vibrafeed.core.motion.kernels.track.cycle import Series, new_history, settle
from vibrafeed.core.motion.kernels.track.solve import FINE
from vibrafeed.core.motion.kernels.track.tables import at_rest, new_work

ORDERS = (8, 12, 14, 16, 18, 20, 24)


@compiled
def followed(wall: bool, rolling: float, series: Series, row: Floats) -> tuple[int, int]:
    """Follow a cell until it repeats; return periods followed and those of the cycle."""
    cell = cell_of(row)
    history = new_history(int(cell.max_periods), np.zeros(1, dtype=np.int8))
    state, hold = at_rest()
    work = new_work()
    drive.set_drive(cell, row, work)
    end = settle(cell, wall, rolling, series, int(cell.max_periods), state, hold, history, work)
    return end.done, end.multiple


def main() -> None:
    """Print a row for each kind."""
    asked = options(__doc__, cells=200, seed=14)
    orders = " | ".join(f"order {order}" for order in ORDERS)
    print(f"| cells that repeat | us until it does: {orders} | whole cell | periods | of a cycle |")
    print("| --- " * (len(ORDERS) + 4) + "|")
    for place, (name, kind) in enumerate(KINDS.items()):
        rows, _ = cells_of(random_groups(kind, asked.cells, asked.seed + place), **SETTINGS)
        timed(kind, rows[:1], 1)  # compiled
        _, whole = timed(kind, rows, 2)
        seconds = np.full((len(ORDERS), len(rows)), np.inf)
        periods = np.zeros((len(rows), 2))
        for _ in range(3):  # the first compiles
            for number, row in enumerate(rows):
                for which, order in enumerate(ORDERS):
                    series = Series(order, FINE.tolerance)
                    started = time.perf_counter()
                    found = followed(kind.wall, kind.rolling, series, row)
                    took = time.perf_counter() - started
                    seconds[which, number] = min(seconds[which, number], took)
                    if order == FINE.order:
                        periods[number] = found
        repeats = periods[:, 1] > 0
        means = " | ".join(f"{1e6 * each:.0f}" for each in seconds[:, repeats].mean(axis=1))
        done, multiple = periods[repeats].mean(axis=0)
        print(
            f"| {name}: {repeats.sum()} | {means} | {1e6 * whole[repeats].mean():.0f} | "
            f"{done:.1f} | {multiple:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
