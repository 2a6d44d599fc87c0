"""The tables of the planar kernels: what a cell is given, and what is kept of its motion."""

from __future__ import annotations

from collections import namedtuple

from vibrafeed.core.motion.kernels.statuses import MODES

Segment = namedtuple("Segment", "phase span take_off landing impulse")
"""Columns of the cycle of the motion normal to the floor, a row a segment.

`take_off` is the velocity off the floor at the start, -1 for contact; `landing` the speed at
the end, and `impulse` what it takes from the floor there. The impulse of a contact is the
rebound of the hops that it stands for (theory 13.5), 0 if there are none.
"""

Piece = namedtuple("Piece", "phase span mode along normal position")
"""Columns of the log of a motion, a row a piece in one mode; velocities at its start."""

SEGMENT = Segment(*range(len(Segment._fields)))
PIECE = Piece(*range(len(Piece._fields)))
MAX_SEGMENTS = 8_000  # of a cycle; a run of shrinking hops at restitution 0.995 fills it

# Sums over a motion: the distance, and from TIMES on the time in each mode.
DISTANCE, TIMES = 0, 1
SUMS = TIMES + MODES
