"""What is derived, by what, and the scratch table on which derivatives are carried along."""

from __future__ import annotations

from collections import namedtuple

Direction = namedtuple("Direction", "c s gs gn mu_s mu_k e start_along start_phase start_normal")
"""What a motion is derived by: the groups, and the state at the start of its cycle.

The state is last: of a cycle that starts at a lift-off only its velocity is free.
"""

Told = namedtuple(
    "Told",
    "velocity stick forward backward flight landing_speed hop_height friction impact drive",
)
"""The means of a motion that are derived."""

Carried = namedtuple(
    "Carried",
    "phase along normal end begin forced path distance stick forward backward flight landing "
    "height friction impact",
)
"""Rows of the scratch table; a column a direction.

`phase`, `along` and `normal` are the derivatives of the phase and the velocities at an event,
`end` that of the phase at which a segment ends. `begin` and `forced` are what changes of a
velocity seen at a fixed phase, by what was before and by the acceleration; `path` and `rise`
are distances.
"""

BY = Direction(*range(len(Direction._fields)))
TOLD = Told(*range(len(Told._fields)))
ROW = Carried(*range(len(Carried._fields)))
DERIVED_BY = 7  # the groups among the directions
DIRECTIONS = len(Direction._fields)
SUMMED = (
    (TOLD.velocity, ROW.distance), (TOLD.stick, ROW.stick), (TOLD.forward, ROW.forward),
    (TOLD.backward, ROW.backward), (TOLD.flight, ROW.flight), (TOLD.friction, ROW.friction),
    (TOLD.impact, ROW.impact),
)  # fmt: skip
"""Means, and the rows of what they are means of."""
