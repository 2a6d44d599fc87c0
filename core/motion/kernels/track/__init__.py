"""Exact motion in space, on floor and wall, from event to event (theory 13.13), compiled.

Phases in rad, lengths in g/w^2, velocities in g/w. In each mode of contact the motion is a Taylor
series; the first root of a polynomial ends a step where something happens.
"""

from vibrafeed.core.motion.kernels.track.space_cells import follow, power_cells, solve_cells

__all__ = ["follow", "power_cells", "solve_cells"]
