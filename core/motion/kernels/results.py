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

Spending = namedtuple("Spending", "friction impact drive")
"""One column a field of `Energy`, in its order."""

SPENT = Spending(*range(len(Spending._fields)))
