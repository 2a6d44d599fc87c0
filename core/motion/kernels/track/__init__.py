"""Exact motion in space, on floor and wall, from event to event (theory 13.13), compiled.

All numbers are dimensionless: phase, lengths in g/w^2, velocities in g/w. In each mode of contact
the motion is a Taylor series, made term by term from the law of the mode; the first root of a
polynomial ends a step where something happens.

`polynomials`: first roots; `drive`: what shakes the track; `slide`, `modes`: the series of a step;
`contacts`: what happens at an event; `advance`: one period; `cycle`: until it repeats; `solve`: one
cell, and many; `spend`: what friction and the drive do over a step; `again`: a cycle followed once
more, for the course of one part and for its energies.
"""

from vibrafeed.core.motion.kernels.track.again import follow, spend_cells
from vibrafeed.core.motion.kernels.track.solve import solve_cells

__all__ = ["follow", "solve_cells", "spend_cells"]
