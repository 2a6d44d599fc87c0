"""The state of a row, and the columns of its cells and results."""

from __future__ import annotations

from collections import namedtuple
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.motion.kernels.arrays import Floats

Whole = NDArray[np.int64]

Head = namedtuple(
    "Head",
    "drive_number_along drive_number_normal gravity_number_along gravity_number_normal "
    "part_restitution most_periods room parts",
)
"""The first columns of a cell; static friction, kinetic friction, mass and the gap in front of
each part follow, each with room for as many parts as the longest row of a study has, then the ends
and the levels of the steps of the drive."""

HEAD = len(Head._fields)

RowColumns = namedtuple(
    "RowColumns",
    "velocity spread error platoons slowest fastest contact collisions impact flight multiple",
)
"""One column a field of `core.motion.methods.rows.RowMotion`, in its order."""

COLUMN = RowColumns(*range(len(RowColumns._fields)))
ROW_COLUMNS = len(RowColumns._fields)


class Drive(NamedTuple):
    """Push and load per weight: c sin(tau) + level - gs along, gn - s sin(tau) onto the floor.

    `ends` are the phases at which the steps of the drive end, `levels` what they add to the push.
    """

    c: float
    s: float
    gs: float
    gn: float
    ends: Floats
    levels: Floats


class Row(NamedTuple):
    """Parts from the rear to the front: their numbers, their state, and room for the work.

    `closed[i]` is 1 where part i touches the one in front of it and both have the same velocity: a
    flag, and no test of gap and velocities, which rounding would decide. `gain` and `drag` are C
    and k of u' = C sin(tau) - k. `mode` is 1 of parts that slide forward, -1 backward, 0 at rest.
    """

    mass: Floats
    static: Floats
    kinetic: Floats
    gap: Floats
    speed: Floats
    place: Floats
    gain: Floats
    drag: Floats
    mode: Whole
    closed: Whole
    value: Floats
    weight: Floats
    last: Whole


@compiled
def drive_of(cell: Floats) -> Drive:
    """Return the drive of a cell; a sine has one step, of no level."""
    start = HEAD + 4 * int(cell[HEAD - 2])
    steps = (cell.size - start) // 2
    if steps == 0:
        ends, levels = np.array([2 * np.pi]), np.zeros(1)
    else:
        ends, levels = cell[start : start + steps].copy(), cell[start + steps :].copy()
    return Drive(cell[0], cell[1], cell[2], cell[3], ends, levels)


@compiled
def row_of(cell: Floats) -> Row:
    """Return the row of a cell, at rest on the track."""
    room, parts = int(cell[HEAD - 2]), int(cell[HEAD - 1])
    static = cell[HEAD : HEAD + parts].copy()
    kinetic = cell[HEAD + room : HEAD + room + parts].copy()
    mass = cell[HEAD + 2 * room : HEAD + 2 * room + parts].copy()
    gap = cell[HEAD + 3 * room : HEAD + 3 * room + parts - 1].copy()
    closed = np.zeros(parts - 1, dtype=np.int64)
    for i in range(parts - 1):
        closed[i] = 1 if gap[i] == 0.0 else 0
    return Row(
        mass, static, kinetic, gap, np.zeros(parts), np.zeros(parts), np.zeros(parts),
        np.zeros(parts), np.zeros(parts, dtype=np.int64), closed, np.zeros(parts),
        np.zeros(parts), np.zeros(parts, dtype=np.int64),
    )  # fmt: skip
