"""The times of samples: a rate, or a column that ascends in steps that are nearly equal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import Problem
from core.measured.read import RecordingTable
from core.quantities import Quantity
from core.study.units import UnitError, problem, read_number, unit_factor

RATE = Quantity(
    "Hz", "f_s", "Sampling rate", "Samples a second.", 0.0, strict=True, parameter=True,
    examples=("5 kHz",),
)  # fmt: skip
SECONDS = Quantity("s", "t", "Time", "Time of a sample.", examples=("1 ms",))
LONGEST_UNIT = 60.0  # s
USUAL_NAMES = ("time", "t")
UNEVEN = 0.5  # of a step: smaller deviations are kept, and fitted at their true times
ROUNDED = 0.75
"""Deviation from even times that is rounding, over the unit that times are rounded to."""


def read_times(
    table: RecordingTable, rate: float | str | None, time: str | None, problems: list[Problem]
) -> NDArray[np.float64] | None:
    """Return the times of the samples of a recording [s]; None if they cannot be determined.

    They come from `rate`, samples a second (a number or a text with a unit), or from the column
    `time` of the `table`, by default one with a usual name. Times that differ from even ones by no
    more than their own rounding are made even; others are kept, since least squares needs no even
    times. Problems are added to `problems`.
    """
    usual = next((name for name in table.columns if name.casefold() in USUAL_NAMES), None)
    if rate is not None:
        if time is not None:
            fix = "Give only the one that the recorder measures more accurately"
            problems.append(
                Problem(
                    "rate",
                    "the recording has both a sampling rate (rate) and a time column (time)",
                    fix,
                )
            )
            return None
        try:
            return np.arange(len(table.lines)) / read_number("rate", RATE, rate)
        except UnitError as error:
            problems.append(problem("rate", error))
            return None
    name = time or usual
    if name is None:
        fix = "Give rate = the samples per second, or time = the name of the column of times"
        problems.append(
            Problem("rate", "the recording has neither a sampling rate nor a column of times", fix)
        )
        return None
    column = table.column(name, "time", problems)
    if column is None:
        return None
    factor = _seconds(column.unit)
    if factor is None:
        fix = "Write s, ms, us or min in the header, or give rate and leave time out"
        problems.append(
            Problem(
                "time",
                f"the recording's time column has the unit '{column.unit[:40]}', which is "
                f"not a unit of time",
                fix,
            )
        )
        return None
    times = factor * (column.values - column.values[0])
    wrong = _uneven(name, times, table.lines)
    if wrong:
        problems.append(wrong)
        return None
    return _even_if_rounded(times)


def _seconds(unit: str) -> float | None:
    """Return the factor from the unit of a column of times to seconds; None if it has none.

    No unit means seconds. No recorder of vibrations counts hours.
    """
    try:
        factor = float(unit_factor("time", SECONDS, unit or SECONDS.unit))
    except UnitError:
        return None
    return factor if factor <= LONGEST_UNIT else None


def _uneven(name: str, times: NDArray[np.float64], lines: NDArray[np.int64]) -> Problem | None:
    """Return the problem of times that do not increase, or are far from even; None without one.

    `name` is the column of the recording, `times` are its values [s], `lines` their lines in the
    file, for the message.
    """
    steps = np.diff(times)
    if not steps.size:
        return None
    backward = np.flatnonzero(steps <= 0)
    if backward.size:
        return Problem(
            "time",
            f"the times in the recording's column '{name}' do not increase in {backward.size} "
            f"place{'s' * (backward.size > 1)}, first in line {lines[backward[0] + 1]}",
            "Write the times with more digits, or give the sampling rate (rate) and leave time out",
        )
    usual = float(np.median(steps))
    away = np.abs(steps / usual - 1.0)
    if away.max() <= UNEVEN:
        return None
    worst = int(away.argmax())
    return Problem(
        "time",
        f"the times in the recording's column '{name}' are not evenly spaced: steps are "
        f"{1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms, usually "
        f"{1e3 * usual:.4g} ms; the most uneven one is before line "
        f"{lines[worst + 1]}",
        "Cut out a piece of the recording without gaps, or record again: time "
        f"steps may differ by {100 * UNEVEN:.0f} %",
    )


def _even_if_rounded(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return exactly even times of samples, if `times` are even up to their own rounding.

    Else `times` [s] as they are. Recorders print times with few digits; the unit of the last digit
    is the smallest difference between the steps that occur, and times within a share of it from a
    straight line count as even.
    """
    place = np.arange(times.size, dtype=np.float64)
    slope, start = np.polyfit(place, times, 1) if times.size > 1 else (0.0, 0.0)
    even = start + slope * place
    steps = np.unique(np.diff(times))
    noise = 1e-9 * times[-1]  # of differences of numbers in floating point
    distinct = steps[np.flatnonzero(np.diff(steps, prepend=-np.inf) > noise)]
    unit = float(np.diff(distinct).min()) if distinct.size > 1 else noise
    return even if np.abs(times - even).max() <= ROUNDED * unit else times
