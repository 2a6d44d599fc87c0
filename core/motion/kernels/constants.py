"""Numbers that kernels share, and need no compiler for: statuses, columns of tables, limits."""

from collections import namedtuple

import numpy as np

from vibrafeed.core.quantities.flags import MOTION_MODES, MOTION_STATUSES

Status = namedtuple(
    "Status",
    "not_computed periodic at_rest aperiodic runaway neutral limit_reached no_solution "
    "settled moving sensitive",
)
"""The values of the statuses that a kernel may give."""

Mode = namedtuple("Mode", "stick forward backward flight unknown")
"""The values of the modes."""

STATUS = Status(**{name: MOTION_STATUSES[name].value for name in Status._fields})
MODE = Mode(**{name: MOTION_MODES[name].value for name in Mode._fields})
UNREPEATED = -2  # no status of results: no cycle was found, and long runs give the means
MODES = 4  # modes in which time is spent: all but the unknown

Columns = namedtuple(
    "Columns",
    "velocity spread error stick forward backward flight impacts landing_speed hop_height "
    "multiple across",
)
"""One column a field of `Motion`, in its order; the status has an array of its own.

The shares of the four modes stand in the order of the modes' own numbers.
"""

RESULTS = len(Columns._fields)
COLUMN = Columns(*range(RESULTS))

Powers = namedtuple("Powers", "friction impact drive swing")
"""One column a field of `Energy`, in its order."""

POWER = Powers(*range(len(Powers._fields)))

Tally = namedtuple(
    "Tally",
    "travel across stick forward backward flight impacts landing height at_wall signature",
)
"""Columns of the sums over one period of a motion: distances, phases in modes, impacts, largest
speed of landing and height, stretches at the wall, and the signature of the events."""

TALLY = Tally(*range(len(Tally._fields)))

Segment = namedtuple("Segment", "phase span take_off landing impulse")
"""Columns of the cycle of the motion normal to the floor, a row a segment.

`take_off` is the velocity off the floor at the start, -1 for contact; `landing` the speed at the
end, and `impulse` what it takes from the floor; of a contact the rebound of the hops that it stands
for (theory 13.5).
"""

Piece = namedtuple("Piece", "phase span mode along normal position")
"""Columns of the log of a motion, a row a piece in one mode; velocities at its start."""

SEGMENT = Segment(*range(len(Segment._fields)))
PIECE = Piece(*range(len(Piece._fields)))
MAX_SEGMENTS = 8_000  # of a cycle; a run of shrinking hops at restitution 0.995 fills it

# Sums over a motion: the distance, and from TIMES on the time in each mode.
DISTANCE, TIMES = 0, 1
SUMS = TIMES + MODES

SETTLED_EXACTLY = 1e-13
"""Rebound times remaining phase of all hops, in g/w, below which a run of hops ends."""
SETTLED_TIME = 1e-3  # remaining phase of all hops over that to lift-off, below which a run may end

SETTLED_SOFTLY = 3e-4
"""The same, rebound times remaining time, where restitution falls with the speed of impact: such
hops never end, and a speed w takes 3/(2 b w) of them. What is left out is stated as an error.
"""

LEFT_SOFTLY = 2e-3
"""Damping times rebound at the next lift-off, below which such hops pass for a stay on the floor.

Those that do not are some 750 up to there.
"""

NODES = np.array([
    0.1252334085114689, 0.3678314989981802, 0.5873179542866175, 0.7699026741943047,
    0.9041172563704749, 0.9815606342467192,
])  # fmt: skip
"""Nodes above 0 of Gauss and Legendre's rule of twelve places, exact up to the power 23; the others
lie opposite, between -1 and 1."""

WEIGHTS = np.array([
    0.24914704581340277, 0.2334925365383548, 0.20316742672306592, 0.16007832854334622,
    0.10693932599531843, 0.04717533638651183,
])  # fmt: skip
"""Their weights, and those of the opposite ones."""
