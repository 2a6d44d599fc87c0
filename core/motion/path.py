"""The position of a part in space, at given phases."""

from __future__ import annotations

from typing import NamedTuple

from vibrafeed.core.mechanics.arrays import Array


class Path(NamedTuple):
    """Positions and velocities of one part relative to the track, at given phases.

    Attributes
    ----------
    phase : ndarray, shape (n,)
    position : ndarray, shape (n, 3)
        Along, across (from the wall) and normal to the floor, in g/w^2.
    velocity : ndarray, shape (n, 3)
        In g/w. NaN, as is the position, where the contact laws had no solution.
    """

    phase: Array
    position: Array
    velocity: Array
