"""Rows of parts as their kernels take them, in the units g/w, and what comes out by name."""

import numpy as np

from vibrafeed.core.motion.kernels.rows import (
    ROW_COLUMNS,
    path_of_row,
    path_of_wave_row,
    row_cells,
    wave_row_cells,
)
from vibrafeed.core.motion.kernels.rows.row_state import COLUMN, HEAD, NO_STOP
from vibrafeed.core.motion.method import STATUS
from vibrafeed.core.motion.waves import Wave

TURN = 2 * np.pi


def cell(px, pz, friction, *, kinetic=None, mass=None, gap=None, gs=0.0, gn=1.0, e=0.0, most=400,
         steps=(), wave=None, stop=NO_STOP, stop_gap=0.0):  # fmt: skip
    """Return the row of the kernel for parts from the rear on, in the units g/w.

    `steps` are ends and levels along the track; a `wave` is one of `vibrafeed.core.motion.waves`.
    """
    n = len(friction)
    kinetic, mass = friction if kinetic is None else kinetic, [1.0] * n if mass is None else mass
    gap = [0.0] * n if gap is None else [*gap, 0.0]
    if steps:  # as a wave has them: no harmonics, levels along, across and normal, ends
        ends, levels = steps
        steps = [0, len(ends), *levels, *[0.0] * (2 * len(ends)), *ends]
    if wave is not None:
        steps = wave.columns(())[0]
    head = [px, pz, gs, gn, e, most, stop, stop_gap, n, n]
    return np.array([*head, *friction, *kinetic, *mass, *gap, *steps], dtype=float)


def sines(along=(), normal=(), along_cosines=(), normal_cosines=()):
    """Return the wave of coefficients of sin(k tau) and cos(k tau), k from 1."""
    orders = max(map(len, (along, normal, along_cosines, normal_cosines)))
    harmonics = np.zeros((3, 2, orders))
    for axis, part, numbers in (
        (0, 0, along), (0, 1, along_cosines), (2, 0, normal), (2, 1, normal_cosines),
    ):  # fmt: skip
        harmonics[axis, part, : len(numbers)] = numbers
    return Wave(harmonics, np.empty((4, 0)))


def is_waved(row):
    """True if a row needs the kernels of waves: it has more than steps along the track."""
    start = HEAD + 4 * int(row[8])
    if row.size == start:
        return False
    steps, first = int(row[start + 1]), start + 2 + 6 * int(row[start])
    return row[start] > 0 or bool(row[first + 2 * steps : first + 3 * steps].any())


def path(row, phases):
    """Return places and gaps of the parts of a row at phases."""
    parts = int(row[9])
    contacts = parts - (row[6] == NO_STOP)
    places, gaps = np.empty((len(phases), parts)), np.empty((len(phases), contacts))
    kernel = path_of_wave_row if is_waved(row) else path_of_row
    kernel(row, np.asarray(phases, dtype=float), places, gaps)
    return places, gaps


def followed(row):
    """Return the columns of the result of one row, and its status."""
    width = ROW_COLUMNS + 2 * int(row[8])
    table, status = np.full((1, width), np.nan), np.zeros(1, dtype=np.int8)
    kernel = wave_row_cells if is_waved(row) else row_cells
    kernel(row[np.newaxis], table, status, np.zeros(1, dtype=np.int8))
    (name,) = [name for name, value in STATUS.items() if value == status[0]]
    return dict(zip(COLUMN._fields, table[0], strict=False)), name


def two_level(a_s, a_m):
    """Return the ends and the pushes of a track that creeps forward and jerks back, in g."""
    half = TURN * a_m / (a_s + a_m) / 2
    return [half, TURN - half, TURN], [-a_s, a_m, -a_s]
