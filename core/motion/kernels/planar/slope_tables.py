"""Tables of derivatives: names, directions, and the scratch table that carries them."""

from __future__ import annotations

from collections import namedtuple

Direction = namedtuple("Direction", "c s gs gn mu_s mu_k e start_along start_phase start_normal")
"""What a motion is derived by: the groups, and the state at the start of its cycle.

The state is last: of a cycle that starts at a lift-off only its velocity is free.
"""

DerivedMeans = namedtuple(
    "DerivedMeans",
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
DERIVED = DerivedMeans(*range(len(DerivedMeans._fields)))
ROW = Carried(*range(len(Carried._fields)))
DERIVED_BY = 7  # number of parameters among the directions; the others are of the state
DIRECTIONS = len(Direction._fields)
SUMMED = (
    (DERIVED.velocity, ROW.distance), (DERIVED.stick, ROW.stick), (DERIVED.forward, ROW.forward),
    (DERIVED.backward, ROW.backward), (DERIVED.flight, ROW.flight),
    (DERIVED.friction, ROW.friction), (DERIVED.impact, ROW.impact),
)  # fmt: skip
"""Means, and the rows of the scratch table with the sums over a cycle that they are made from."""
