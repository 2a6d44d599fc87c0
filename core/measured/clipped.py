"""Whether a channel was driven beyond its range."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import Problem

RUN = 3  # equal samples in a row
CREST = 4.0


def clipped(
    place: str, name: str, values: NDArray[np.float64], lines: NDArray[np.int64]
) -> list[Problem]:
    """Return a problem for each end of the range at which a channel sticks.

    A smooth crest, rounded to steps of the sensor, rests on its last step as well. Near its top it
    is a parabola: the time spent on the last step is at most 1/(sqrt(2) - 1) = 2.4 times that on
    the last but one. Runs of equal extreme values that hold 4 times as many samples as the next
    value are thus no crest.
    """
    if np.ptp(values) == 0.0:  # a channel that never moves has no range
        return []
    problems = []
    for word, toward in (("highest", values), ("lowest", -values)):
        extreme = toward.max()
        held = toward == extreme
        starts = np.flatnonzero(np.diff(held.astype(np.int8), prepend=0) == 1)
        stops = np.flatnonzero(np.diff(held.astype(np.int8), append=0) == -1) + 1
        runs = stops - starts >= RUN
        next_value = toward[~held].max()
        if runs.any() and held.sum() >= CREST * (toward == next_value).sum():
            first = lines[starts[runs][0]]
            message = (
                f"column '{name}' is clipped: {held.sum()} samples hold its {word} value "
                f"{values[starts[0]]:g}, first in line {first}"
            )
            fix = "Record again with a wider range of the sensor"
            problems.append(Problem(place, message, fix))
    return problems
