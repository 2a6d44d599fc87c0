"""The columns of tables of results of motion along the track."""

from __future__ import annotations

from collections import namedtuple

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

Spending = namedtuple("Spending", "friction impact drive swing")
"""One column a field of `Energy`, in its order."""

SPENT = Spending(*range(len(Spending._fields)))

Tally = namedtuple(
    "Tally",
    "travel across stick forward backward flight impacts landing height at_wall peak failed "
    "signature",
)
"""Columns of what a motion that is followed period by period does in one period.

The distance along, and across; the phase, or the steps, in each mode; impacts on the floor, the
largest speed of a landing and the largest height; the stretches or steps at the wall. Of steps:
the largest velocity, and how many had no solution; of stretches: the signature of the events.
"""

TALLY = Tally(*range(len(Tally._fields)))
