"""The kernels of tumbling: one part that strikes and leaves a plane, compiled.

A corner i of the part lies at the angle a below the direction of transport, seen from the centre,
at the distance rho; the pitch counts clockwise and adds to a (theory 2.1). The functions take the
numbers of one cell and its state, an array that holds place, motion and the energy lost so far.

`geometry`: corners and sides; `forces`: accelerations and forces of contact; `carry`: a step with
one support; `impact`: impacts; `support`: what carries the part; `run`: its start, records and
results; `events`: from event to event; `cells`: many cells, and one path.
"""

from vibrafeed.core.motion.kernels.tumbling.cells import path_events, tumble_events
from vibrafeed.core.motion.kernels.tumbling.tables import COLUMN, PATH, PATH_COLUMNS, Cell

__all__ = [
    "COLUMN",
    "PATH",
    "PATH_COLUMNS",
    "Cell",
    "path_events",
    "tumble_events",
]
