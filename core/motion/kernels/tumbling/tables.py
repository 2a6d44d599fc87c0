"""The tables of tumbling: what a cell is given, its state, its results and its path."""

from __future__ import annotations

from collections import namedtuple

from numba.np.unsafe.ndarray import to_fixed_tuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats

FREE, FLAT, PARADOX = -1, -2, -3
"""What carries the part, if not the corner with that number: nothing, a side, and contact laws
without one solution."""

OVERLAP = 4e-15
"""Overlap over the half diagonal that counts as an impact: some roundings of a height."""
TOUCH = 1e-13
"""Gap over the half diagonal that counts as touching."""
DEEP = 1e-12
"""Overlap over the half diagonal that is more than rounding."""
SLOW = 1e-6
"""Velocity that counts as none, of sqrt(acceleration times half diagonal).

A fall through `OVERLAP` ends at 0.09e-6 of it: with not much less, the rounding of a height would
keep a part bouncing for ever.
"""


Cell = namedtuple(
    "Cell",
    "half_diagonal inertia_ratio corner_angle turning pull_along pull_normal drive_along "
    "drive_normal circular_frequency start_phase friction_kinetic friction_static restitution "
    "gap_normal pitch velocity_along velocity_upward pitch_rate duration time_step",
)
"""The numbers of one cell, SI; a row of the kernels' table in this order.

`turning` is 1 for a part with corners, 0 for a ball, whose one contact stays below the centre. The
pulls are gravity's components against the transport and towards the plane, the drives those of the
drive's acceleration.
"""

GROUPS = len(Cell._fields)


@compiled
def cell_of(row: Floats) -> Cell:
    """Return a row of a kernel's table, shape (columns,), as a named tuple `Cell`."""
    return Cell(*to_fixed_tuple(row, GROUPS))  # type: ignore[call-arg] # the compiler gives one


State = namedtuple("State", "along up pitch along_rate up_rate pitch_rate lost")
"""Places in the state: centre, pitch, their rates, energy per mass lost so far."""

STATE = State(*range(len(State._fields)))

Columns = namedtuple(
    "Columns",
    "pitch resting_side settling_time impacts largest_bounce velocity energy_lost",
)
"""Columns of a table of results: the fields of `Tumble`; the status has an array of its own."""

COLUMN = Columns(*range(len(Columns._fields)))

Path = namedtuple("Path", "time state gap touching")
"""Where in a row of a path stand time, state, lowest gap, and whether each corner carries."""

PATH = Path(time=0, state=1, gap=1 + len(STATE), touching=2 + len(STATE))
PATH_COLUMNS = PATH.touching + 4
