"""The report as a Markdown page: sections of words, tables and pictures."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from vibrafeed.core.assurance.accuracy.curves import (
    FAMILIES,
    STEEP,
    Curve,
    Measured,
    Point,
    numbers_of,
)
from vibrafeed.core.assurance.accuracy.families import SECONDS
from vibrafeed.core.assurance.accuracy.report import ReportPart
from vibrafeed.core.dataset.markdown import markdown_table

TITLES = {
    "closed_forms": "Rounding of the closed forms",
    "motion": "Methods of motion",
    "optimisers": "Optimisers",
    "storage": "Files",
    "model": "Formulas against the true motion",
}
NO_NUMBER = "-"
PLAIN = (10.0, 1e5)  # numbers that are written without a power of ten

Column = tuple[str, Callable[[Curve, Point], str]]


@dataclass(frozen=True)
class PageSection:
    """A part of the page: a heading and what stands below it, as Markdown."""

    title: str
    body: str


def write_page(title: str, head: Sequence[str], sections: Sequence[PageSection]) -> str:
    """Return a report on accuracy as a Markdown page.

    Parameters
    ----------
    title : str
        The heading of the page.
    head : sequence of str
        Paragraphs below the heading.
    sections : sequence of PageSection
        Title and Markdown body of each section, in order.
    """
    parts = [f"# {title}", *head]
    for section in sections:
        parts += [f"## {section.title}", section.body]
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


def head_of(attributes: Mapping[str, str], command: str) -> list[str]:
    """Return the first paragraphs of the accuracy report: purpose and conditions of measurement.

    `attributes` has the texts "machine", "date" and "versions"; `command` is the shell command that
    makes the report. Paragraphs are Markdown.
    """
    return [
        "Error against run time, measured by the program itself. The whole page is made by the "
        "command",
        f"```sh\n{command}\n```",
        "and each part of it by the one that stands there.",
        f"Machine: {attributes['machine']}. Date: {attributes['date']}. Versions: "
        f"{attributes['versions']}. Times vary from run to run, errors do not: the cells are drawn "
        "with a fixed seed.",
        "Slope: of the logarithms of error over cost, by least squares over the points that lie "
        "above the reference's own error; the tables of slopes say which error and which cost.",
    ]


def sections_of(
    part: ReportPart, pictures: Mapping[str, str], seconds: float = SECONDS
) -> Iterator[PageSection]:
    """Yield a section of the accuracy report for each family of measurements of a study.

    Parameters
    ----------
    part : ReportPart
        The measurements of the study.
    pictures : mapping of str to str
        File of each family's picture, relative to the page; a family may have none.
    seconds : float
        Time that each family was given [s], for the command that repeats the measurement.
    """
    for measured in part.measured:
        title = f"{TITLES[measured.family]} ({Path(part.name).stem})"
        command = command_of(part.name, measured.family, seconds)
        yield PageSection(title, _body(part, measured, command, pictures.get(measured.family)))


def command_of(name: str, family: str, seconds: float = SECONDS) -> str:
    """Return the command that repeats the measurement of one family."""
    words = ["vibrafeed", "report", name, "--only", family]
    return shlex.join(words + ([] if seconds == SECONDS else ["--seconds", f"{seconds:g}"]))


def _body(part: ReportPart, measured: Measured, command: str, picture: str | None) -> str:
    """Return the text of one family's section of the accuracy report, as Markdown.

    It has the command that repeats the measurement, notes, a table of all points, a table of slopes
    where theory expects any, and the picture.

    Parameters
    ----------
    part, measured : ReportPart, Measured
        The study, and the measurements of the family.
    command, picture : str, str or None
        The shell command, and the picture's file relative to the page.
    """
    family = measured.family
    lines = [
        f"*{part.title}* ({part.scene}). Compared: {FAMILIES[family]}.",
        f"`{command}`",
        "\n".join(f"- {note}" for note in measured.notes),
    ]
    rows = [(curve, point) for curve in measured.curves for point in curve.points]
    if rows:
        lines.append(_table(COLUMNS[family], rows))
    slopes = [(c, c.points[-1]) for c in measured.curves if c.expected and c.points]
    slopes = [(c, p) for c, p in slopes if not math.isnan(c.slope) or c.expected_slope == STEEP]
    if slopes:
        lines.append(_table(SLOPES, slopes))
    if picture:
        lines.append(f"![{TITLES[family]}]({quote(picture)})")
    return "\n\n".join(lines)


def _table(columns: Sequence[Column], rows: Iterable[tuple[Curve, Point]]) -> str:
    """Return a Markdown table of curves and points."""
    cells = [[cell(curve, point) for _, cell in columns] for curve, point in rows]
    return "\n".join(markdown_table([name for name, _ in columns], cells))


def _number(value: float) -> str:
    """Return a number with two digits as text; "-" for NaN, "infinite" for infinity.

    Numbers from 10 to 100,000 are rounded to whole ones.
    """
    if math.isnan(value):
        return NO_NUMBER
    if math.isinf(value):
        return "infinite"
    if value == 0:
        return "0"
    return f"{value:.0f}" if PLAIN[0] <= abs(value) < PLAIN[1] else f"{value:.2g}"


def _gap(value: float) -> str:
    """Return a gap as text."""
    return "none found" if math.isinf(value) else _number(value)


def _time(seconds: float) -> str:
    """Return a time [s] in words with three digits, in s, ms, us or ns, such as 1.23 ms.

    NaN, a time that was not measured, gives the dash of an empty table cell (`NO_NUMBER`).
    """
    if math.isnan(seconds):
        return NO_NUMBER
    for unit, factor in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _share(value: float) -> str:
    """Return a share in per cent."""
    return NO_NUMBER if math.isnan(value) else f"{value:.0%}".replace("%", " %")


def _slope(value: float) -> str:
    """Return a slope as text."""
    if value == STEEP:
        return "steep: less error at the same cost"
    return NO_NUMBER if math.isnan(value) else f"{round(value, 2) + 0.0:.2f}"


def _fitted(curve: Curve, _: Point) -> str:
    """Return the fitted slope of a benchmark curve as text, for a cell of the table of slopes.

    The second argument, a point, is not used: all cells of these tables take curve and point. Where
    all errors are within that of the reference, a phrase says so.
    """
    if all(numbers_of(point, curve.of) <= curve.floor for point in curve.points):
        return "all at the reference's error"
    return _slope(curve.slope)


def _more(name: str, show: Callable[[float], str] = _number) -> Callable[[Curve, Point], str]:
    """Return the function that shows a further measurement in a table cell."""
    return lambda _, point: show(numbers_of(point, name))


WORDS = {
    "seconds": "time",
    "value": "slip speed",
    "steps": "steps",
    "unit_roundoff": "unit roundoff",
    "half_quantum": "half a quantum",
    "error": "median error",
    "largest": "largest error",
    "conditioned_ulps": "ulps over kappa",
}

SETTING: Column = ("setting", lambda _, p: p.setting)
METHOD: Column = ("method", lambda c, _: c.method)
SUBJECT: Column = ("output", lambda c, _: c.subject)
MEDIAN: Column = ("median error", lambda _, p: _number(p.error))
LARGEST: Column = ("largest error", lambda _, p: _number(p.largest))
TIME: Column = ("time of a cell", lambda _, p: _time(p.seconds))
CELLS: Column = ("cells", lambda _, p: f"{p.cells:,}")

COLUMNS: dict[str, tuple[Column, ...]] = {
    "closed_forms": (
        SUBJECT,
        ("type", SETTING[1]),
        CELLS,
        TIME,
        MEDIAN,
        LARGEST,
        ("largest, ulps", _more("ulps")),
        ("largest, ulps over kappa", _more("conditioned_ulps")),
        ("largest kappa", _more("condition")),
    ),
    "motion": (
        ("cells", lambda c, p: f"{p.cells} {c.subject.removesuffix(' cells')}"),
        METHOD,
        SETTING,
        TIME,
        MEDIAN,
        LARGEST,
        ("within own estimate", _more("within_estimate", _share)),
    ),
    "optimisers": (
        METHOD,
        ("designs", CELLS[1]),
        ("time of a design", TIME[1]),
        ("points", _more("evaluations", lambda v: f"{v:,.0f}")),
        ("median gap", lambda _, p: _gap(p.error)),
        ("largest gap", lambda _, p: _gap(p.largest)),
        ("median error of the variables", _more("variable_error")),
        ("missed", _more("missed", _share)),
    ),
    "storage": (
        ("series", METHOD[1]),
        ("format", SETTING[1]),
        ("bytes a value", _more("bytes_per_value", lambda v: f"{v:.2f}")),
        ("time of a value", TIME[1]),
        MEDIAN,
        LARGEST,
        ("half a quantum", _more("half_quantum")),
    ),
    "model": (
        SUBJECT,
        ("true motion", SETTING[1]),
        CELLS,
        ("median of formula/true", _more("ratio")),
        MEDIAN,
        ("within 10 %", _more("within_tenth", _share)),
        ("within a factor of 2", _more("within_factor_two", _share)),
        ("rank correlation", _more("rank_correlation", _slope)),
    ),
}
"""The columns of each family's table."""

SLOPES: tuple[Column, ...] = (
    ("curve", lambda c, _: c.method if c.family == "storage" else f"{c.subject}, {c.method}"),
    ("slope of", lambda c, _: f"{WORDS[c.of]} over {WORDS[c.cost]}"),
    ("fitted", _fitted),
    ("expected", lambda c, _: c.expected),
)
