"""Planar motion of many cells: which kernels follow them, of those in `kernels.planar`.

Each kernel is compiled when it is first called, and together they take half a minute: cells under a
sine do not wait for what other waves need, nor those that repeat for those that do not.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from core.motion.kernels.arrays import Floats, Statuses, Stop
from core.motion.kernels.cells import GROUPS
from core.motion.kernels.planar.derive import derive_cells as derive_sine_cells
from core.motion.kernels.planar.energy import spend_sine_cells, spend_wave_cells
from core.motion.kernels.planar.path import follow_sine, follow_wave, sample_sine, sample_wave
from core.motion.kernels.planar.solve import UNREPEATED, solve_sine_cells, solve_wave_cells
from core.motion.kernels.planar.unrepeated import average_sine_cells, average_wave_cells
from core.motion.kernels.results import RESULTS
from core.quantities import MOTION_STATUSES

__all__ = ["derive_cells", "follow", "sample", "solve_cells", "spend_cells"]

NOT_COMPUTED = MOTION_STATUSES["not_computed"].value


def solve_cells(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and status of cells; a row of `groups` holds the fields of `Cell`, and a wave."""
    _kernel(groups, solve_sine_cells, solve_wave_cells)(groups, table, status, stop)
    _average(groups, table, status, stop)


def derive_cells(energy: bool, groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and status of cells under a sine, and derivatives: `kernels.planar.derive`."""
    derive_sine_cells(energy, groups, table, status, stop)
    _average(groups, table, status, stop)


def spend_cells(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill what a cycle of cells spends: `kernels.planar.energy`; NaN where there is none."""
    _kernel(groups, spend_sine_cells, spend_wave_cells)(groups, table, status, stop)


def follow(row: Floats, stop: Stop) -> tuple[Floats, float, float, bool]:
    """Return the pieces of the motion of one cell: `kernels.planar.path`."""
    table, status = np.empty((1, RESULTS)), np.full(1, NOT_COMPUTED, dtype=np.int8)
    solve_cells(row[np.newaxis], table, status, stop)
    return _kernel(row, follow_sine, follow_wave)(row, int(status[0]), stop)


def sample(pieces: Floats, row: Floats, shift: float, phases: Floats, repeats: bool) -> Floats:
    """Return a motion at phases since the start of its cycle: `kernels.planar.path`."""
    return _kernel(row, sample_sine, sample_wave)(pieces, row, shift, phases, repeats)


def _kernel(groups: Floats, sine: Callable[..., Any], wave: Callable[..., Any]) -> Any:
    """Return the kernel for cells under a sine, or that for cells with a wave behind each."""
    return wave if groups.shape[-1] > GROUPS else sine


def _average(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill the first columns of the table, and the status, of cells that do not repeat."""
    (cells,) = np.nonzero(status == UNREPEATED)
    if cells.size:
        means = np.full((cells.size, RESULTS), np.nan)
        found = np.full(cells.size, NOT_COMPUTED, dtype=np.int8)
        kernel = _kernel(groups, average_sine_cells, average_wave_cells)
        kernel(groups[cells], means, found, stop)
        table[cells, :RESULTS], status[cells] = means, found
