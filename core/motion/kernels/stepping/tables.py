"""The tables of time stepping: what a cell is given, its state, and the tally of a period."""

from __future__ import annotations

from typing import NamedTuple

from numba.np.unsafe.ndarray import to_fixed_tuple

from core.compiled import compiled
from core.motion.kernels.arrays import Floats

PLANAR, FLOOR, WALL = 0, 1, 2
"""Scenes."""


class Cell(NamedTuple):
    """The groups of one cell; a row of the kernels' table in this order."""

    drive_number_along: float
    drive_number_across: float
    drive_number_normal: float
    gravity_number_along: float
    gravity_number_across: float
    gravity_number_normal: float
    curvature_number: float
    friction_static: float
    friction_kinetic: float
    wall_friction: float
    restitution: float
    wall_restitution: float


GROUPS = len(Cell._fields)


@compiled
def cell_of(row: Floats) -> Cell:
    """Return the cell of a row."""
    return Cell(*to_fixed_tuple(row, GROUPS))  # type: ignore[call-arg] # the compiler gives one


class Drive(NamedTuple):
    """Rows of the drive of a period, one column a step.

    Push along, across and normal, and the speed of the track along; how long the step is, and what
    share of a usual one; whether the push jumped at its start. No step has a jump inside.
    """

    along: int
    across: int
    normal: int
    speed: int
    length: int
    share: int
    jump: int


DRIVE = Drive(*range(len(Drive._fields)))


class State(NamedTuple):
    """Columns of a state; a scene stops where its coordinates end.

    `spare` is what static friction could still take, `pressed` and `leaning` tell whether floor and
    wall carried the part in the step before.
    """

    x: int
    z: int
    ux: int
    uz: int
    spare: int
    pressed: int
    uy: int
    spin: int
    y: int
    leaning: int


STATE = State(*range(len(State._fields)))
WIDTHS = (STATE.uy, STATE.y, len(STATE))
"""Columns of the state of each scene."""


class Tally(NamedTuple):
    """Columns of the tally of one period.

    The distance; the steps in each mode; impacts, the largest speed of a landing, height and
    velocity; the steps at the wall, and those without a solution; the distance across.
    """

    travel: int
    forward: int
    backward: int
    stick: int
    flight: int
    impacts: int
    landing: int
    height: int
    peak: int
    at_wall: int
    failed: int
    across: int


TALLY = Tally(*range(len(Tally._fields)))
