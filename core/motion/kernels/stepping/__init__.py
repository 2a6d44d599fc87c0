"""Compiled time stepping of one part by the midpoint rule of Moreau and Jean (theory 13.9).

Three scenes, each with the coordinates and contacts that it has and no others: `PLANAR` (along and
normal to the floor), `FLOOR` (across as well, and spin), `WALL` (the distance from the wall as
well). All numbers are dimensionless: phase, lengths in g/w^2, velocities in g/w.

`contacts`: one step; `period`: one period; `repeat`: whether periods repeat; `cells`: one cell, and
many; `paths`: the course of one part.
"""

from vibrafeed.core.motion.kernels.cells import GROUPS
from vibrafeed.core.motion.kernels.stepping.cells import step_cells
from vibrafeed.core.motion.kernels.stepping.paths import path
from vibrafeed.core.motion.kernels.stepping.tables import FLOOR, PLANAR, WALL, WIDTHS

__all__ = ["FLOOR", "GROUPS", "PLANAR", "WALL", "WIDTHS", "path", "step_cells"]
