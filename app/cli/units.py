"""Values as a person reads them: in units of the trade, with few digits."""

import math
from pathlib import Path

import numpy as np

from vibrafeed.app.cli.studies import refuse
from vibrafeed.core.errors import Problem
from vibrafeed.core.study.shown import ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError

DIGITS = 4
"""Digits of a value; more where the least and the largest would look alike."""

DEFAULT_DIGITS = 6
"""Digits of a default: those of standard gravity."""

SPAN_DIGITS = 2  # digits of the difference between the least and the largest value
MAX_DIGITS = 15  # digits that a double holds in any case
WHOLE = 1e7  # below it a whole number is shown in full
PLAIN = (1e-4, 1e7)  # sizes that are written without an exponent


def units_asked(text: str | None, otherwise: str = "") -> ShownUnits:
    """Return the units for printing; exit if a unit is unknown.

    `text` is the option `--units`; without it `otherwise`, the units of the study, count. Both are
    names such as `m/min`, separated by commas.
    """
    words = [word for word in (otherwise if text is None else text).split(",") if word.strip()]
    try:
        return read_shown(words)
    except UnitError as error:
        return refuse({Path("--units"): [Problem("units", error.message, error.fix)]})


def format_number(value: float | None, digits: int = DIGITS) -> str:
    """Return a number with `digits` significant digits, whole numbers in full; `-` for NaN."""
    if value is None or not math.isfinite(value):
        return "-"
    if value == round(value) and abs(value) < WHOLE:
        return str(int(value))
    if PLAIN[0] <= abs(value) < PLAIN[1]:
        return np.format_float_positional(
            value, precision=digits, unique=False, fractional=False, trim="-"
        )
    return f"{value:.{digits}g}"


def shown_range(
    unit: str, least: float | None, largest: float | None, units: ShownUnits
) -> tuple[str, str, str]:
    """Return the unit for printing an output, and its smallest and largest value as texts in it.

    Both have as many digits as make their difference visible.

    Parameters
    ----------
    unit : str
        The unit of the values in files.
    least, largest : float or None
        The smallest and largest value in that unit; None, for an output without values, gives a
        dash.
    units : ShownUnits
        Chooses the unit for printing.
    """
    if least is None or largest is None:
        return units.of(unit, 0.0).unit, "-", "-"
    size = max(abs(least), abs(largest))
    shown = units.of(unit, size)
    digits, span = DIGITS, largest - least
    if 0 < span < size:
        # The first decimals that both values share, and those that tell them apart.
        digits = SPAN_DIGITS + math.floor(math.log10(size)) - math.floor(math.log10(span))
        digits = min(max(DIGITS, digits), MAX_DIGITS)
    return (
        shown.unit,
        format_number(shown.factor * least, digits),
        format_number(shown.factor * largest, digits),
    )
