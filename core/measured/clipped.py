"""Detects a channel that was driven beyond its range."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem

RUN = 3  # equal samples in a row that a clipped crest holds
CREST = 4.0  # samples at an extreme value over those at the next: more is no crest
VISITS = 12  # fewest samples of the extreme value that are compared, if they are no runs
STEPS = 4.0  # steps of the sensor: crests whose heights differ by less may be equal


def clipping_problems(
    path: str, name: str, values: NDArray[np.float64], lines: NDArray[np.int64]
) -> list[Problem]:
    """Return a problem for each end of its range at which a channel of a recording is clipped.

    `path` is the column's place in the study and `name` its name, `values` are its samples and
    `lines` their lines in the file.

    A smooth crest, rounded to steps of the sensor, rests on its last step as well. Near its top it
    is a parabola: the time spent on the last step is at most 1/(sqrt(2) - 1) = 2.4 times that on
    the last but one. Extreme values that hold 4 times as many samples as the next value are thus no
    crest, if they come in runs. Single samples may hold the extreme value at the same phase of each
    period, where the rate is a multiple of the frequency: then the crests between them are alike.
    """
    if np.ptp(values) == 0.0:  # a channel that never moves has no range
        return []
    problems = []
    for word, toward in (("highest", values), ("lowest", -values)):
        extreme = toward.max()
        held = toward == extreme
        if held.sum() < CREST * (toward == toward[~held].max()).sum():
            continue
        starts = np.flatnonzero(np.diff(held.astype(np.int8), prepend=0) == 1)
        stops = np.flatnonzero(np.diff(held.astype(np.int8), append=0) == -1) + 1
        runs = stops - starts >= RUN
        if runs.any() or _crests_differ(toward, held):
            first = lines[starts[runs][0] if runs.any() else starts[0]]
            message = (
                f"column '{name}' is clipped: {held.sum()} samples hold its {word} value "
                f"{values[starts[0]]:g}, first in line {first}"
            )
            fix = "Record again with a wider range of the sensor"
            problems.append(Problem(path, message, fix))
    return problems


def _crests_differ(values: NDArray[np.float64], held: NDArray[np.bool_]) -> bool:
    """True if samples of the highest value belong to crests of different heights: they are clipped.

    `values` are the samples of a channel, `held` is True at those that have the highest value. A
    crest is the parabola through a sample and its neighbours. Rounding moves its height by no more
    than a step or two; a period may have two crests, so that the widest gap between heights does
    not count.
    """
    crests = np.flatnonzero(held[1:-1]) + 1
    if crests.size < VISITS:
        return False
    before, at, after = values[crests - 1], values[crests], values[crests + 1]
    bend, lean = 2.0 * at - before - after, after - before
    tenth = crests.size // 10
    over = np.sort(lean**2 / (8.0 * bend))[tenth : crests.size - tenth]
    # The steps near the top: what is printed with so many digits has finer ones near zero.
    upper = np.unique(values[values >= values.max() - 0.25 * np.ptp(values)])
    return bool(np.ptp(over) - np.diff(over).max() > STEPS * np.diff(upper).min(initial=np.inf))
