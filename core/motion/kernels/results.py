"""The columns of tables of results of motion along the track."""

from __future__ import annotations

from typing import NamedTuple


class Columns(NamedTuple):
    """One column a field of `Motion`, in its order; the status has an array of its own.

    The shares of the four modes stand in the order of the modes' own numbers.
    """

    velocity: int
    spread: int
    error: int
    stick: int
    forward: int
    backward: int
    flight: int
    impacts: int
    landing_speed: int
    hop_height: int
    multiple: int
    across: int


RESULTS = len(Columns._fields)
COLUMN = Columns(*range(RESULTS))


class Spending(NamedTuple):
    """One column a field of `Energy`, in its order."""

    friction: int
    impact: int
    drive: int


SPENT = Spending(*range(len(Spending._fields)))
