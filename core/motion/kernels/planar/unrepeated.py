"""Cells whose motion does not repeat: those that `solve` leaves `UNREPEATED`.

They are compiled apart, as most studies have none.
"""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled, raised
from core.motion.kernels.arrays import Floats, Statuses, Stop
from core.motion.kernels.planar.chaos import from_phases
from core.motion.kernels.planar.solve import turn_round, upright
from core.motion.kernels.planar.tables import MOST_SEGMENTS, SEGMENT, SUMS, cell_of
from core.motion.kernels.planar.wave import new_table, wave_of


@compiled
def average_sine_cells(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and status of cells under a sine, as `solve.solve_sine_cells` does."""
    rows, sums = np.empty((MOST_SEGMENTS, len(SEGMENT))), np.empty(SUMS)
    for number in range(groups.shape[0]):
        cell, result = cell_of(groups[number]), table[number]
        drive, phase, way = upright(cell)
        result[:] = math.nan
        found = from_phases(cell, phase, drive, rows, sums, result, stop)
        turn_round(result, way)
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = found


@compiled
def average_wave_cells(groups: Floats, table: Floats, status: Statuses, stop: Stop) -> None:
    """Fill table and status of cells under other waves, as `solve.solve_wave_cells` does."""
    rows, sums, waves = np.empty((MOST_SEGMENTS, len(SEGMENT))), np.empty(SUMS), new_table()
    for number in range(groups.shape[0]):
        row, result = groups[number], table[number]
        cell = cell_of(row)
        result[:] = math.nan
        found = from_phases(cell, 0.0, wave_of(cell, row, waves), rows, sums, result, stop)
        if raised(stop):
            result[:] = math.nan
            return
        status[number] = found
