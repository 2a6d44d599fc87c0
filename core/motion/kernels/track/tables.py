"""The tables of exact motion in space: what a cell is given, its state, the series of a step."""

from __future__ import annotations

import math
from collections import namedtuple
from typing import TypeAlias

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Flags, Floats

TURN = 2.0 * math.pi
MAX_ORDER = 24
"""Of the series: those of order 16 are judged by those of order 24."""
INVERSE = np.array([math.inf, *(1.0 / k for k in range(1, MAX_ORDER + 2))])
"""1/k, by which a term is integrated: a division takes four times as long as a product."""


State = namedtuple("State", "x y z ux uy uz spin")
"""Columns of a state: place, velocity relative to the track, and spin.

The spin of a cylinder is the velocity across that it gives the lowest point.
"""

Hold = namedtuple("Hold", "contacts slips event")
"""Columns of what holds a part: its contacts, whether they slip, the event before."""


FREE, FLOOR, WALL, BOTH = 0, 1, 2, 3
"""Contacts that carry the part: the floor is bit 0, the wall bit 1."""

Event = namedtuple("Event", "nothing start lift land leave bump stop slip press release seat")
"""What ends a stretch of motion.

`nothing` where the series had to be made anew; `seat` where the floor, or `press` where the
wall, comes to carry a part that touches it without moving, and `release` where the wall ceases
to carry one that the floor holds; `leave` where a part that slips loses the wall.
"""


STATE = State(*range(len(State._fields)))
HOLD = Hold(*range(len(Hold._fields)))
EVENT = Event(*range(len(Event._fields)))

Row = namedtuple(
    "Row",
    "free track velocity place slip square load extra event scratch lifts wave sines cosines "
    "levels speeds rows",
)
"""First rows of the table of a step: series in powers of the phase since its start.

One table, since a call hands on each array at a price.

Attributes
----------
free : int
    Acceleration of a part without contacts, along, across and normal; what a curve adds is in
    the second once the velocity along is known.
track : int
    Velocity of the track along itself.
velocity, place : int
    Of the part relative to the track, along, across and normal.
slip : int
    Of the contact that slips, two rows.
square : int
    Of the slip's size.
load : int
    Of the contact that slips.
extra : int
    Seven of use to one function only.
event, scratch : int
    What turns negative at an event, and a copy that its search destroys.
lifts : int
    No series: how many times a period the floor loses a part that rests on it, and the phases.
wave : int
    Of the drive: how many harmonics and steps it has, and the speed of the track.
sines, cosines : int
    Three rows each, along, across and normal: a wave's coefficients by order.
levels : int
    Three rows, and one of the phases at which the steps end.
speeds : int
    Velocity of the track along itself at the start of each step.
rows : int
    How many there are.
"""

ROW = Row(0, 3, 4, 7, 10, 12, 13, 14, 21, 22, 23, 24, 25, 28, 31, 35, 36)
Work: TypeAlias = Floats
"""The table of a step."""


@compiled
def new_work() -> Work:
    """Return the table for the series of a step, a row for each quantity of `ROW`; zeros."""
    return np.zeros((ROW.rows, MAX_ORDER + 2))


@compiled
def at_rest() -> tuple[Floats, Flags]:
    """Return state and contacts of a part at rest on the floor that touches the wall.

    Zeros in the columns of `STATE` and `HOLD`, with the event `start`: the forces then decide which
    contact carries the part.
    """
    hold = np.zeros(len(HOLD), dtype=np.int64)
    hold[HOLD.event] = EVENT.start
    return np.zeros(len(STATE)), hold
