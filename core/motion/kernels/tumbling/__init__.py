"""The kernels of tumbling: one part that strikes and leaves a plane, compiled.

A corner i lies at the angle a below the direction of transport, seen from the centre, at the
distance rho; the pitch counts clockwise and adds to a (theory 2.1). SI.
"""

from vibrafeed.core.motion.kernels.tumbling.corners import COLUMN, PATH, PATH_COLUMNS, Cell
from vibrafeed.core.motion.kernels.tumbling.tumble_cells import path_events, tumble_events

__all__ = [
    "COLUMN",
    "PATH",
    "PATH_COLUMNS",
    "Cell",
    "path_events",
    "tumble_events",
]
