"""The times of samples: a rate, or a column that ascends in steps of which most are equal."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import StudyError, refused
from vibrafeed.core.quantities import Quantity
from vibrafeed.core.study.units import UnitError, problem, read_number, unit_factor
from vibrafeed.core.tables.headings import stem_and_unit
from vibrafeed.core.tables.table import InputTable

RATE = Quantity(
    "Hz", "f_s", "Sampling rate", "Samples a second.", 0.0, strict=True, parameter=True,
    examples=("5 kHz",),
)  # fmt: skip
SECONDS = Quantity("s", "t", "Time", "Time of a sample.", examples=("1 ms",))
USUAL_NAMES = (
    "",
    "time",
    "t",
    "timestamp",
    "elapsed",
    "zeit",
    "temps",
    "tiempo",
    "tempo",
    "x_value",
)
"""Names of a column of times, without what they say of its unit; the last is LabVIEW's."""
DAYS = 20_000.0, 80_000.0  # of dates of Excel, from 1954 to 2119
SHORT = 1e-5  # steps of a column without a unit that are days rather than seconds
PERIODS = (2.0**16, 2.0**24, 2.0**32, 60.0, 3600.0, 86_400.0)
"""Counts after which counters and clocks begin anew."""
LEAST_SAMPLES = 100  # samples that a recording needs
UNEVEN = 0.5  # of a step: larger deviations count as lost samples, or as samples that came early
MOST_LOST = 0.1  # of the samples, which may be lost; the others are fitted at their true times
ROUNDED = 0.75
"""Deviation from even times that is rounding, over the unit that times are rounded to."""


class Times(NamedTuple):
    """The times of the samples of a recording that are used.

    Attributes
    ----------
    seconds : ndarray
        From the first sample [s].
    kept : slice
        The samples that are used.
    assumed : str
        The column that was taken for seconds, since nothing names its unit; else "".
    note : str
        What was left out, in words; else "".
    """

    seconds: NDArray[np.float64]
    kept: slice = slice(None)
    assumed: str = ""
    note: str = ""


def read_times(table: InputTable, rate: float | str | None, time: str | None) -> Times:
    """Return the times of the samples of a recording.

    They come from `rate`, samples a second (a number or a text with a unit), or from the column
    `time` of the `table`, by default one with a usual name, or the only one whose heading has a
    unit of time, or from the step that the file states. The unit stands in the heading, or at the
    end of the name, as in ``time_ms``; if nothing names it, seconds are assumed, or days of Excel.
    Counters that begin anew are continued. Times that differ from even ones by no more than their
    own rounding are made even; others are kept, since least squares needs no even times. Of a
    recording with large gaps the longest piece without one is used.

    Raises
    ------
    StudyError
        If they cannot be determined.
    """
    count = len(table.lines)
    if rate is not None:
        if time is not None:
            raise refused(
                "rate",
                "the recording has both a sampling rate (rate) and a time column (time)",
                "Give only the one that the recorder measures more accurately",
            )
        try:
            return Times(np.arange(count) / read_number("rate", RATE, rate))
        except UnitError as error:
            raise StudyError([problem("rate", error)]) from None
    name = time or _name_of_time_column(table)
    is_empty = name is not None and name in table.columns and table.is_faulty(name)
    if table.step > 0.0 and time is None and (name is None or is_empty):
        return Times(np.arange(count, dtype=np.float64) * table.step)
    if name is None:
        raise refused(
            "rate",
            "the recording has neither a sampling rate nor a time column",
            "Give rate = the samples per second, or time = the name of the time column",
        )
    if is_empty:
        raise refused(
            "time",
            f"the cells of column '{name}' are neither numbers nor times of ISO 8601, as in "
            f"{str(table.columns[name].cells[0]).strip()[:40]!r} in line {table.lines[0]}",
            "Give rate = the samples per second, or write times as seconds or as 12:30:05.002",
        )
    times, assumed = _seconds_of(table, name)
    steps, lines = np.diff(times), table.lines
    backward = np.flatnonzero(steps <= 0)
    if backward.size:
        # Without its times, a recording that runs backwards would turn the ellipse round.
        is_unsorted = (steps < 0).mean() > MOST_LOST
        fix = (
            "Write the times with more digits, or give the sampling rate (rate) and leave time out"
        )
        raise refused(
            "time",
            f"the times in the recording's column '{name}' do not increase in {backward.size} "
            f"place{'s' * (backward.size > 1)}, first in line {lines[backward[0] + 1]}",
            "Sort the rows by their times" if is_unsorted else fix,
        )
    evened = _even_if_rounded(times)
    if steps.size and evened is times and _lost_fraction(steps) > MOST_LOST:
        return _longest_piece(times, assumed, name, lines)
    return Times(evened, assumed=assumed)


def _seconds_of(table: InputTable, name: str) -> tuple[NDArray[np.float64], str]:
    # Seconds from the first sample, and the name of the column if its unit had to be assumed.
    values, unit_in_heading = table.numbers(name, "time")
    unit = unit_in_heading or stem_and_unit(name)[1]
    steps = np.diff(values)
    usual_step = float(np.median(steps)) if steps.size else 0.0
    if not unit and DAYS[0] < values.min() and values.max() < DAYS[1] and 0.0 < usual_step < SHORT:
        return 86_400.0 * (values - values[0]), name
    factor = _factor(unit)
    if factor is None:
        raise refused(
            "time",
            f"the recording's time column has the unit '{unit[:40]}', which is not a unit of time",
            "Write s, ms, us or min in the header, or give the rate (rate) and leave time out",
        )
    starts_anew = steps < 0
    for period in PERIODS if starts_anew.any() else ():
        if np.all(np.abs(steps[starts_anew] + period - usual_step) <= UNEVEN * usual_step):
            values = values + period * np.concatenate([[0], np.cumsum(starts_anew)])
            break
    return factor * (values - values[0]), "" if unit else name


def _longest_piece(
    times: NDArray[np.float64], assumed: str, name: str, lines: NDArray[np.int64]
) -> Times:
    steps = np.diff(times)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > (1.0 + UNEVEN) * usual)
    piece_ends = np.concatenate([[0], gaps + 1, [times.size]])
    longest = int(np.diff(piece_ends).argmax())
    piece = slice(int(piece_ends[longest]), int(piece_ends[longest + 1]))
    size = piece.stop - piece.start
    if size < LEAST_SAMPLES:
        raise refused(
            "time",
            f"the times in the recording's column '{name}' are not evenly spaced: steps are "
            f"{1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms, usually {1e3 * usual:.4g} ms; "
            f"the longest one is before line {lines[int(steps.argmax()) + 1]}",
            f"Record again: at most {100 * MOST_LOST:.0f} % of the samples may be lost, or a piece "
            f"of {LEAST_SAMPLES} samples must have no gap",
        )
    note = (
        f"the recording has {gaps.size} gap{'s' * (gaps.size > 1)}: the fit uses the longest "
        f"piece without one, {size:,} of {times.size:,} samples"
    )
    return Times(_even_if_rounded(times[piece] - times[piece.start]), piece, assumed, note)


def _name_of_time_column(table: InputTable) -> str | None:
    columns = table.columns.items()
    usually_named = [
        name
        for name in table.columns
        if (found := stem_and_unit(name))[0] in USUAL_NAMES and _factor(found[1]) is not None
    ]
    with_unit_of_time = [name for name, column in columns if column.unit and _factor(column.unit)]
    return next(iter(usually_named), with_unit_of_time[0] if len(with_unit_of_time) == 1 else None)


def _factor(unit: str) -> float | None:
    try:
        return float(unit_factor("time", SECONDS, unit or SECONDS.unit))
    except UnitError:
        return None


def _lost_fraction(steps: NDArray[np.float64]) -> float:
    deviations = np.abs(steps / np.median(steps) - 1.0)
    return float(deviations[deviations > UNEVEN].sum()) / steps.size


def _even_if_rounded(times: NDArray[np.float64]) -> NDArray[np.float64]:
    index = np.arange(times.size, dtype=np.float64)
    slope, start = np.polyfit(index, times, 1) if times.size > 1 else (0.0, 0.0)
    even_times = start + slope * index
    steps = np.unique(np.diff(times))
    rounding = 1e-9 * times[-1]  # of differences of numbers in floating point
    distinct = steps[np.flatnonzero(np.diff(steps, prepend=-np.inf) > rounding)]
    if steps.size and steps[-1] > (1.0 + UNEVEN) * np.median(np.diff(times)):
        has_one_or_two_units = distinct.size == 2 and distinct[1] <= 2.0 * distinct[0] + rounding
        if _lost_fraction(np.diff(times)) <= MOST_LOST or not has_one_or_two_units:
            return times  # some samples are lost
    timer_unit = float(np.diff(distinct).min()) if distinct.size > 1 else rounding
    return even_times if np.abs(times - even_times).max() <= ROUNDED * timer_unit else times
