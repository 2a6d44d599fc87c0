"""Rows of parts as their kernels take them, in the units g/w, and what comes out by name."""

from __future__ import annotations

import numpy as np

from core.motion.kernels.rows import ROW_COLUMNS, row_cells, stepped_rows
from core.motion.kernels.rows.tables import COLUMN, NO_STOP
from core.motion.result import STATUS

TURN = 2 * np.pi


def cell(px, pz, friction, *, kinetic=None, mass=None, gap=None, gs=0.0, gn=1.0, e=0.0, most=400,
         steps=(), stop=NO_STOP, stop_gap=0.0):  # fmt: skip
    """Return the row of the kernel for parts from the rear on, in the units g/w."""
    n = len(friction)
    kinetic, mass = friction if kinetic is None else kinetic, [1.0] * n if mass is None else mass
    gap = [0.0] * n if gap is None else [*gap, 0.0]
    if steps:  # as a wave has them: no harmonics, levels along, across and normal, ends
        ends, levels = steps
        none = [0.0] * len(ends)
        steps = [0, len(ends), *levels, *none, *none, *ends]
    numbers = [
        px,
        pz,
        gs,
        gn,
        e,
        most,
        stop,
        stop_gap,
        n,
        n,
        *friction,
        *kinetic,
        *mass,
        *gap,
        *steps,
    ]
    return np.array(numbers, dtype=float)


def followed(row, steps=None):
    """Return the columns of the result of one row, by events or by so many steps; its status."""
    width = ROW_COLUMNS + 2 * int(row[8])
    table, status = np.full((1, width), np.nan), np.zeros(1, dtype=np.int8)
    if steps is None:
        row_cells(row[np.newaxis], table, status, np.zeros(1, dtype=np.int8))
    else:
        stepped_rows(steps, row[np.newaxis], table, status, np.zeros(1, dtype=np.int8))
    (name,) = [name for name, value in STATUS.items() if value == status[0]]
    return dict(zip(COLUMN._fields, table[0], strict=False)), name


def two_level(a_s, a_m):
    """Return the ends and the pushes of a track that creeps forward and jerks back, in g."""
    half = TURN * a_m / (a_s + a_m) / 2
    return [half, TURN - half, TURN], [-a_s, a_m, -a_s]
