"""Planar motion of many cells: the kernels of `kernels.planar`, under the drive of each cell.

Each kernel is compiled when it is first called, for a sine and for other waves apart, and together
they take half a minute: cells under a sine do not wait for what other waves need, nor those that
repeat for those that do not. What a sine earns: see `kernels.planar`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.motion import compiled
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.kernels.constants import RESULTS, UNREPEATED
from vibrafeed.core.quantities import MOTION_STATUSES

if TYPE_CHECKING:
    from vibrafeed.core.motion.kernels.inputs import Floats, Statuses, Stop
    from vibrafeed.core.motion.kernels.planar.plane_laws import Waves

NOT_COMPUTED = MOTION_STATUSES["not_computed"].value
NORMAL_DRIVE = Groups._fields.index("drive_number_normal")
NEARLY = 1.0 + 2.0**-30  # factor up to which two numbers may have the same first 32 bits
FEWEST_EQUAL = 0.125  # share of cells with an equal drive from which on an order repays its time
OTHER_FACTORS = {"gravity_number_normal": 1.0, "restitution": 1e2, "impact_damping": 1e4}
"""Factors of the numbers, beside the drive's, that set the motion normal to the floor, in a sum by
which cells are sorted. Where two sums are equal by chance it costs time, and changes nothing."""


def solve_cells(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill result table and statuses of cells; a row of `groups` holds `Cell` and a wave.

    `table` has the columns of a `Motion`; `stop` is a flag that ends the work.
    """
    order = _beside_equal_landings(groups)
    if order is None:
        compiled.plane_cells.solve_cells(groups, waves_of(groups), table, status, stop)
        _average(groups, table, status, stop)
        return
    cells, means, found = groups[order], table[order], status[order]
    compiled.plane_cells.solve_cells(cells, waves_of(cells), means, found, stop)
    _average(cells, means, found, stop)
    table[order], status[order] = means, found


def spend_cells(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the energy table of cells; NaN where the motion does not repeat.

    A row of `groups` holds `Cell` and a wave; `table` has the columns of an `Energy`.
    """
    compiled.plane_cells.spend_cells(groups, waves_of(groups), table, status, stop)


def average_spent(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the energy table of cells that do not repeat, from long runs.

    A row of `groups` holds `Cell` and a wave; `table` has the columns of an `Energy`.
    """
    compiled.plane_cells.average_spent(groups, waves_of(groups), table, status, stop)


def follow(row: Floats, stop: Stop) -> tuple[Floats, float, float, bool]:
    """Return one cell's motion pieces, phase shift, direction sign, and True if they repeat.

    `row` holds `Cell` and a wave; see the kernel `plane_cells.follow`.
    """
    table, status = np.empty((1, RESULTS)), np.full(1, NOT_COMPUTED, dtype=np.int8)
    solve_cells(row[np.newaxis], table, status, stop)
    return compiled.plane_cells.follow(row, waves_of(row), int(status[0]), stop)


def sample(pieces: Floats, row: Floats, shift: float, phases: Floats, repeats: bool) -> Floats:
    """Return position, height, velocities and mode at phases from the start of a period, (n, 5).

    `pieces`, `shift` and `repeats` come from `follow`, `row` holds `Cell` and a wave.
    """
    return compiled.plane_cells.sample(pieces, row, waves_of(row), shift, phases, repeats)


def waves_of(groups: Floats) -> Waves:
    """Return a buffer for the wave behind each cell's numbers; empty for a sine.

    Its type selects the compiled kernel.
    """
    if groups.shape[-1] > compiled.inputs.GROUPS:
        return compiled.wave.WaveTable(np.zeros(compiled.wave.TABLE))
    return compiled.flow.NO_WAVES


def _average(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill results and statuses of the cells whose motion does not repeat, from long runs.

    These are the cells with the status `UNREPEATED`. `groups` has a row of numbers for each cell,
    `table` a row of results, `status` one value; `stop` is a flag that ends the work.
    """
    (cells,) = np.nonzero(status == UNREPEATED)
    if cells.size:
        means = np.full((cells.size, RESULTS), np.nan)
        found = np.full(cells.size, NOT_COMPUTED, dtype=np.int8)
        compiled.plane_cells.average_cells(groups[cells], waves_of(groups), means, found, stop)
        table[cells, :RESULTS], status[cells] = means, found


def _beside_equal_landings(groups: Floats) -> NDArray[np.intp] | None:
    """Return the order of cells in which those that land at the same times follow each other.

    `groups` has a row a cell. Such cells have the same motion normal to the floor, which is found
    once for all of them (`kernels.planar.cycle` and, to 32 bits, `within`). None if too few
    have an equal.
    """
    drives = groups[:, NORMAL_DRIVE]
    ordered = np.sort(drives)  # a third of the time of an order, which is seldom for nothing then
    # Those below 0 pass for unequal: they are few, and to find them takes as long again.
    if np.count_nonzero(ordered[1:] <= NEARLY * ordered[:-1]) < FEWEST_EQUAL * len(groups):
        return None
    by_drive = np.argsort(drives, kind="stable")
    others = np.zeros(len(groups))
    for name, factor in OTHER_FACTORS.items():
        others += factor * groups[:, Groups._fields.index(name)]
    return by_drive[np.argsort(others[by_drive], kind="stable")]
