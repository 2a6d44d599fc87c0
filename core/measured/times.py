"""The times of samples: a rate, or a column that ascends in steps of which most are equal."""

import re

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import StudyError, refused
from vibrafeed.core.measured.csv_table import RecordingTable
from vibrafeed.core.quantities import Quantity
from vibrafeed.core.study.units import UnitError, problem, read_number, unit_factor

RATE = Quantity(
    "Hz", "f_s", "Sampling rate", "Samples a second.", 0.0, strict=True, parameter=True,
    examples=("5 kHz",),
)  # fmt: skip
SECONDS = Quantity("s", "t", "Time", "Time of a sample.", examples=("1 ms",))
LONGEST_UNIT = 60.0  # s
USUAL_NAMES = ("time", "t", "timestamp", "elapsed", "zeit", "temps", "tiempo", "tempo", "x_value")
"""Names of a column of times, without what they say of its unit; the last is LabVIEW's."""
ENDINGS = {
    "s": "s sec secs second seconds",
    "ms": "ms msec millis millisecond milliseconds",
    "us": "us µs μs usec micros microsecond microseconds",
    "ns": "ns nanos nanosecond nanoseconds",
    "min": "min minutes",
}
"""Last words of names that are units, by the unit: ``time_ms``, ``t_us``, ``seconds``."""
UNEVEN = 0.5  # of a step: larger deviations count as lost samples, or as samples that came early
MOST_LOST = 0.1  # of the samples, which may be lost; the others are fitted at their true times
ROUNDED = 0.75
"""Deviation from even times that is rounding, over the unit that times are rounded to."""


def read_times(
    table: RecordingTable, rate: float | str | None, time: str | None
) -> tuple[NDArray[np.float64], str]:
    """Return the times of the samples of a recording [s], and the column taken for seconds.

    They come from `rate`, samples a second (a number or a text with a unit), or from the column
    `time` of the `table`, by default one with a usual name, or the only one whose heading has a
    unit of time. The unit stands in the heading, or at the end of the name, as in ``time_ms``; if
    nothing names it, seconds are assumed, and the column is returned, else "". Times that differ
    from even ones by no more than their own rounding are made even; others are kept, since least
    squares needs no even times.

    Raises
    ------
    StudyError
        If they cannot be determined.
    """
    if rate is not None:
        if time is not None:
            raise refused(
                "rate",
                "the recording has both a sampling rate (rate) and a time column (time)",
                "Give only the one that the recorder measures more accurately",
            )
        try:
            return np.arange(len(table.lines)) / read_number("rate", RATE, rate), ""
        except UnitError as error:
            raise StudyError([problem("rate", error)]) from None
    name = time or _column_of_times(table)
    if name is None:
        raise refused(
            "rate",
            "the recording has neither a sampling rate nor a column of times",
            "Give rate = the samples per second, or time = the name of the column of times",
        )
    if name in table.columns and table.columns[name].faulty == len(table.lines):
        line, text = table.columns[name].faults[0]
        raise refused(
            "time",
            f"the cells of column '{name}' are not numbers and not times after ISO 8601, such "
            f"as {text[:40]!r} in line {line}",
            "Give rate = the samples per second, or write seconds, or times such as 12:30:05.002",
        )
    column = table.column(name, "time")
    unit = column.unit or _stem_and_unit(name)[1]
    factor = _seconds(unit)
    if factor is None:
        raise refused(
            "time",
            f"the recording's time column has the unit '{column.unit[:40]}', which is "
            "not a unit of time",
            "Write s, ms, us or min in the header, or give the rate (rate) and leave time out",
        )
    times = factor * (column.values - column.values[0])
    steps, lines = np.diff(times), table.lines
    backward = np.flatnonzero(steps <= 0)
    if backward.size:
        raise refused(
            "time",
            f"the times in the recording's column '{name}' do not increase in {backward.size} "
            f"place{'s' * (backward.size > 1)}, first in line {lines[backward[0] + 1]}",
            "Write the times with more digits, or give the sampling rate (rate) and leave time out",
        )
    even = _even_if_rounded(times)
    if steps.size and even is times and _lost(steps) > MOST_LOST:
        usual = float(np.median(steps))
        worst = int(np.abs(steps / usual - 1.0).argmax())
        raise refused(
            "time",
            f"the times in the recording's column '{name}' are not evenly spaced: steps are "
            f"{1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms, usually "
            f"{1e3 * usual:.4g} ms; the most uneven one is before line {lines[worst + 1]}",
            "Cut out a piece of the recording without gaps, or record again: at most "
            f"{100 * MOST_LOST:.0f} % of the samples may be lost",
        )
    return even, "" if unit else name


def _stem_and_unit(name: str) -> tuple[str, str]:
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).casefold()
    plain = re.sub(r"[\s.,:/\-_]+", "_", plain).strip("_")
    for unit, words in ENDINGS.items():
        for word in words.split():
            stem = plain.removesuffix(word)
            if plain == word and len(word) > 1:
                return USUAL_NAMES[0], unit
            if stem != plain and (stem.endswith("_") or stem in USUAL_NAMES):
                return stem.rstrip("_").removesuffix("_in"), unit
    return plain, ""


def _column_of_times(table: RecordingTable) -> str | None:
    columns = table.columns.items()
    usual = [name for name in table.columns if _stem_and_unit(name)[0] in USUAL_NAMES]
    timed = [name for name, column in columns if column.unit and _seconds(column.unit)]
    return next(iter(usual), timed[0] if len(timed) == 1 else None)


def _seconds(unit: str) -> float | None:
    try:
        factor = float(unit_factor("time", SECONDS, unit or SECONDS.unit))
    except UnitError:
        return None
    return factor if factor <= LONGEST_UNIT else None


def _lost(steps: NDArray[np.float64]) -> float:
    away = np.abs(steps / np.median(steps) - 1.0)
    return float(away[away > UNEVEN].sum()) / steps.size


def _even_if_rounded(times: NDArray[np.float64]) -> NDArray[np.float64]:
    place = np.arange(times.size, dtype=np.float64)
    slope, start = np.polyfit(place, times, 1) if times.size > 1 else (0.0, 0.0)
    even = start + slope * place
    steps = np.unique(np.diff(times))
    noise = 1e-9 * times[-1]  # of differences of numbers in floating point
    distinct = steps[np.flatnonzero(np.diff(steps, prepend=-np.inf) > noise)]
    if steps.size and steps[-1] > (1.0 + UNEVEN) * np.median(np.diff(times)):
        has_one_or_two_units = distinct.size == 2 and distinct[1] <= 2.0 * distinct[0] + noise
        if _lost(np.diff(times)) <= MOST_LOST or not has_one_or_two_units:
            return times  # some samples are lost
    unit = float(np.diff(distinct).min()) if distinct.size > 1 else noise
    return even if np.abs(times - even).max() <= ROUNDED * unit else times
