"""The tables of time stepping: what a cell is given, its state, and the tally of a period."""

from __future__ import annotations

from collections import namedtuple

PLANAR, FLOOR, WALL = 0, 1, 2
"""Scenes: motion in the plane, in space on a floor, and on a floor with a wall."""


Drive = namedtuple("Drive", "along across normal speed length share jump")
"""Rows of the drive of a period, one column a step.

Push along, across and normal, and the speed of the track along; how long the step is, and what
share of a usual one; whether the push jumped at its start. No step has a jump inside.
"""

DRIVE = Drive(*range(len(Drive._fields)))

State = namedtuple("State", "x z ux uz spare pressed uy spin y leaning")
"""Columns of a state; a scene stops where its coordinates end.

`spare` is what static friction could still take, `pressed` and `leaning` tell whether floor and
wall carried the part in the step before.
"""

STATE = State(*range(len(State._fields)))
WIDTHS = (STATE.uy, STATE.y, len(STATE))
"""Columns of the state of each scene."""
