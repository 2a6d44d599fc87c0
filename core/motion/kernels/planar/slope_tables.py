"""What is derived, by what, and the scratch table on which derivatives are carried along."""

from __future__ import annotations

from typing import NamedTuple


class Direction(NamedTuple):
    """What a motion is derived by: the groups, and the state at the start of its cycle.

    The state is last: of a cycle that starts at a lift-off only its velocity is free.
    """

    c: int
    s: int
    gs: int
    gn: int
    mu_s: int
    mu_k: int
    e: int
    start_along: int
    start_phase: int
    start_normal: int


class Told(NamedTuple):
    """The means of a motion that are derived."""

    velocity: int
    stick: int
    forward: int
    backward: int
    flight: int
    landing_speed: int
    hop_height: int
    friction: int
    impact: int
    drive: int


class Carried(NamedTuple):
    """Rows of the scratch table; a column a direction.

    `phase`, `along` and `normal` are the derivatives of the phase and the velocities at an event,
    `end` that of the phase at which a segment ends. `begin` and `forced` are what changes of a
    velocity seen at a fixed phase, by what was before and by the acceleration; `path` and `rise`
    are distances.
    """

    phase: int
    along: int
    normal: int
    end: int
    begin: int
    forced: int
    path: int
    distance: int
    stick: int
    forward: int
    backward: int
    flight: int
    landing: int
    height: int
    friction: int
    impact: int


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
