"""A table of measured channels, read from CSV as recorders and spreadsheets write it.

What is wrong in a column is kept with it and told only if the column is used: a recorder's column
of remarks does not spoil its accelerations.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.measured.marks import ONE_MARK, contradictions
from vibrafeed.core.suggestions import suggestion

MAX_BYTES = 50_000_000  # bytes of a file, or characters of a text
MAX_ROWS = 500_000  # whose fit in three axes takes half a gigabyte and some ten seconds
MAX_COLUMNS = 256  # columns of a table
MAX_LETTERS = 20_000  # characters of a line
SHOWN = 3  # faults of a column that are listed one by one
SAMPLED = 50  # rows that show the form of most rows
MAX_ABOVE = 1_000  # rows and remarks above the table
REMARKS = ("comment", "comments", "remark", "remarks")

_IN_BRACKETS = re.compile(r"(\[[^\[\]]*\]|[\[(][^\[\]()]*[\])])\Z")
_UNITS_ONLY = re.compile(r"([\[(][^\[\]]*[\])])?")
_BARE_UNIT = re.compile(
    r"-?|[nuµμm]?s(?:ec)?|[mk]?[gG]n?|Gal|[mc]?m[/·* ]?s\S{0,3}[2²]|m?V|[k]?Hz|°C?"
)
SEPARATOR = re.compile(r'"?sep=(.)"?', re.IGNORECASE)
"""A line on top of a table that names what separates its cells, as spreadsheets have it."""
_CLOCK = re.compile(r"(?:\d{4}-\d\d-\d\d[T ])?\d\d:\d\d(?::\d\d.*)?")
_ENCODINGS = ("utf-8-sig", "cp1252")  # the second is what a spreadsheet in Europe writes
_MINUS = "\u2212"  # the minus sign of word processors and PDF files


class Fault(NamedTuple):
    """A cell that is no finite number: its line in the file and its text."""

    line: int
    text: str


@dataclass(frozen=True)
class RecordingColumn:
    """One channel.

    Attributes
    ----------
    values : ndarray, shape (n,)
        As written in the file; NaN where a cell is faulty.
    unit : str
        What the header says in brackets; empty if it says nothing.
    faults : tuple of Fault
        The first faulty cells.
    faulty : int
        How many there are.
    contradiction : str
        Why its decimal marks cannot be what they seem; empty if they can.
    """

    values: NDArray[np.float64]
    unit: str
    faults: tuple[Fault, ...] = ()
    faulty: int = 0
    contradiction: str = ""


@dataclass(frozen=True)
class RecordingTable:
    """Columns of equal length, by name, and the line of the file on which each row stands."""

    columns: Mapping[str, RecordingColumn]
    lines: NDArray[np.int64]

    def column(self, name: str, path: str, problems: list[Problem]) -> RecordingColumn | None:
        """Return a recording's column by name; None if it is missing or has faulty cells.

        Its problems are then added to `problems`, with the lines of the first faulty cells. `path`
        is the place in the study where the column is named, for the messages.
        """
        column = self.columns.get(name)
        if column is None:
            message = f"the recording has no column '{name[:60]}'"
            problems.append(Problem(path, message, suggestion(name, self.columns), name))
            return None
        if column.contradiction:
            fix = ONE_MARK
            problems.append(Problem(path, column.contradiction, fix, name))
            return None
        for fault in column.faults:
            message = f"line {fault.line} of column '{name}' is not a number: {fault.text[:40]!r}"
            problems.append(
                Problem(path, message, "Correct the line of the recording, or remove it", name)
            )
        if column.faulty > SHOWN:
            message = f"{column.faulty:,} cells of column '{name}' are not finite numbers"
            problems.append(Problem(path, message, "Export the recording again", name))
        return None if column.faulty else column


def read_table(source: str | Path) -> RecordingTable:
    """Return the table in a CSV file or text.

    Comma, semicolon or tab part the cells; beside the last two a comma is a decimal comma. A row
    of names stands above the numbers, with units in brackets if need be (``ax [g]``); a row of
    units alone may follow it. Whatever a recorder writes above the names is passed over, as are
    blank lines and those that begin with ``#``, unless such a line is the only one that can hold
    the names. Cells may be dates with times, or times of day, after ISO 8601: they become seconds
    from the first.

    Parameters
    ----------
    source : str or Path
        A text is the content itself, a Path the file that holds it.

    Raises
    ------
    StudyError
        If it is no table, or larger than 50 MB, 500,000 rows or 256 columns.
    OSError
        If the file cannot be read.
    """
    lines = _lines(_text_of(source))
    header, below, body = _parted(lines)
    _check_header(header)
    names, units = _names(header)
    units = [unit or other for unit, other in zip(units, below or units, strict=False)]
    if not body:
        raise _refused("the recording holds no numbers", "Give rows of numbers below the names")
    if len(body) > MAX_ROWS:
        raise _refused(
            f"it has more than {MAX_ROWS:,} rows",
            "Shorten the recording: one second is enough",
        )
    _check_rows(body, names)
    numbers = np.array([line for line, _ in body])
    cells = dict(zip(names, zip(*(row for _, row in body), strict=True), strict=True))
    wrong = contradictions(cells)
    columns = {}
    for (name, texts), unit in zip(cells.items(), units, strict=True):
        points = texts if lines.delimiter == "," else [text.replace(",", ".") for text in texts]
        column = _column(texts, points, unit, numbers)
        columns[name] = replace(column, contradiction=wrong.get(name, ""))
    return RecordingTable(columns, numbers)


class _Lines(NamedTuple):
    """The lines of a recording, taken apart: number and cells of each row and of each remark.

    Remarks, lines that begin with ``#``, are kept as far as they may hold the names of columns.
    """

    rows: list[tuple[int, list[str]]]
    remarks: list[tuple[int, list[str]]]
    delimiter: str

    def is_number(self, cell: str) -> bool:
        """True if a cell is a number, with a decimal comma where commas do not part cells."""
        return _is_number(cell if self.delimiter == "," else cell.replace(",", "."))

    def first_of_body(self) -> int:
        """Return the index of the first row that has the form of most rows: its numbers."""
        sampled = self.rows[:: -max(len(self.rows) // SAMPLED, 1)]
        forms = Counter(tuple(map(self.is_number, cells)) for _, cells in sampled)
        form = max(forms, key=lambda form: (forms[form], len(form)))
        for index, (_, cells) in enumerate(self.rows):
            if len(cells) == len(form) and all(
                self.is_number(cell) for cell, held in zip(cells, form, strict=True) if held
            ):
                return index
        return 0

    def can_name(self, cells: list[str], width: int) -> bool:
        """True if cells may be the names of so many columns: texts that do not begin as numbers."""
        if len(cells) != width and len(_without_remark(cells)) != width:
            return False
        texts = [cell.strip() for cell in cells if cell.strip()]
        return bool(texts) and not any(
            text[0] in "+-.,0123456789" or self.is_number(text) for text in texts
        )


def _parted(lines: _Lines) -> tuple[list[str], list[str], list[tuple[int, list[str]]]]:
    """Return the cells of a table's header, those of a row of units, if any, and the body.

    The header is the last row above the numbers that can name their columns; without one, the last
    such remark; else the first row, whatever it holds.
    """
    rows = lines.rows
    if not rows:
        return [], [], []
    first = lines.first_of_body()
    width = len(rows[first][1])
    heads = [k for k in range(min(first, MAX_ABOVE)) if lines.can_name(rows[k][1], width)]
    if not heads:
        headings = [
            cells
            for line, cells in lines.remarks
            if line < rows[first][0] and lines.can_name(cells, width)
        ]
        if headings:
            return headings[-1], [], rows[first:]
        heads = [0]
    header, end = heads[-1], heads[-1] + 1
    units: list[str] = []
    if header - 1 in heads and _holds_units(rows[header][1]):
        header -= 1
        units = [cell.strip(" []()") for cell in rows[header + 1][1]]
    named = rows[header][1]
    return named if len(named) == width else _without_remark(named), units, rows[end:]


def _without_remark(cells: list[str]) -> list[str]:
    """Return the headings without a last one that recorders leave out of rows where it is empty."""
    return cells[:-1] if cells[-1].strip().casefold() in REMARKS else cells


def _holds_units(cells: Sequence[str]) -> bool:
    """True if the cells of a row are units of columns, and nothing else."""
    texts = [cell.strip() for cell in cells]
    return all(_UNITS_ONLY.fullmatch(text) or _BARE_UNIT.fullmatch(text) for text in texts)


def _check_header(header: list[str]) -> None:
    """Raise `StudyError` if the first row of a recording does not name its columns.

    `header` holds the cells of that row. Also if it is empty or has too many columns.
    """
    if not header:
        raise _refused("the recording is empty", "Give a row of names, and rows of numbers below")
    if len(header) > MAX_COLUMNS:
        raise _refused(
            f"it has {len(header):,} columns", f"Keep the {MAX_COLUMNS} that are used at most"
        )
    if all(_is_number(cell) for cell in header):
        raise _refused(
            "the first row of the recording holds numbers, not column names",
            "Put a row with the names of columns on top",
        )


def _text_of(source: str | Path) -> str:
    """Return the text of a recording, from a text itself or a file, without byte order mark.

    Raises `StudyError` if it is too long, or the file is not text in a known encoding.
    """
    if isinstance(source, str):
        if len(source) > MAX_BYTES:
            raise _too_long(len(source))
        return source.removeprefix("\ufeff").replace(_MINUS, "-")
    with source.open("rb") as file:  # no more is read than is allowed, whatever the file is
        raw = file.read(MAX_BYTES + 1)
    if len(raw) > MAX_BYTES:
        raise _too_long(source.stat().st_size)
    try:
        return decoded(raw)
    except ValueError:
        fix = "Export the recording as CSV, in UTF-8"
        raise _refused("the file is not a text file", fix) from None


def decoded(raw: bytes) -> str:
    """Return the text of a table as recorders and spreadsheets write it, with plain minus signs.

    Its encoding is UTF-8, with or without a byte order mark, UTF-16 with one, or Windows-1252.

    Raises
    ------
    ValueError
        If it is none of them.
    """
    is_wide = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if is_wide or b"\0" not in raw:
        for encoding in ("utf-16",) if is_wide else _ENCODINGS:
            try:
                return raw.decode(encoding).replace(_MINUS, "-")
            except UnicodeDecodeError:
                continue
    raise ValueError("it is not text in UTF-8, UTF-16 or Windows-1252")


def _lines(text: str) -> _Lines:
    """Return the lines of a recording, taken apart, without blank ones.

    `text` is the whole file. A line ``sep=;`` on top, as spreadsheets have it, names the delimiter.
    """
    rows: list[tuple[int, list[str]]] = []
    remarks: list[tuple[int, list[str]]] = []
    delimiter = ""
    # A cell of several lines is no number; each line is a row of its own, and keeps its number.
    for number, line in enumerate(StringIO(text, newline=None), start=1):
        line = line.rstrip("\n")
        if not line.strip(" \t;,"):
            continue
        if len(line) > MAX_LETTERS:
            raise _refused(f"line {number} has {len(line):,} letters", "Keep the columns in use")
        if not delimiter and (named := SEPARATOR.fullmatch(line.strip())):
            delimiter = named[1]
            continue
        remark = line.lstrip().startswith("#")
        line = line.lstrip("# \t") if remark else line
        mark = delimiter or _delimiter(line, text)
        delimiter = delimiter if remark else mark
        if not remark:
            rows.append((number, _cells(number, line, mark)))
        elif len(rows) + len(remarks) < MAX_ABOVE:
            remarks.append((number, _cells(number, line, mark)))
        if len(rows) > MAX_ROWS + MAX_ABOVE:
            break
    return _Lines(rows, remarks, delimiter or ",")


def _delimiter(line: str, text: str) -> str:
    """Return the character that parts the cells of a recording: a tab, a semicolon or a comma.

    `line` is its first row and `text` the whole: where the two differ in their number of cells,
    something else stands on top, and the row in the middle decides.
    """
    middle = text.rfind("\n", 0, len(text) // 2) + 1
    inner = text[middle : middle + MAX_LETTERS].partition("\n")[0]
    of_first, of_inner = (
        next((mark for mark in "\t;" if mark in some), ",") for some in (line, inner)
    )
    return of_first if line.count(of_first) == inner.count(of_first) or not inner else of_inner


def _cells(number: int, line: str, delimiter: str) -> list[str]:
    """Return the cells of a line of a recording, without empty ones at its end.

    `number` is the line's number, for a message; `delimiter` is one character.
    """
    row = _quoted(number, line, delimiter) if '"' in line else line.split(delimiter)
    while len(row) > 1 and not row[-1].strip():  # a recorder may end its lines with a delimiter
        row.pop()
    return row


def _quoted(number: int, line: str, delimiter: str) -> list[str]:
    """Return the cells of a line of a recording that contains quotes, by the rules of CSV.

    `number` is the line's number, for the message of the `StudyError` that is raised if it cannot
    be split; `delimiter` is one character.
    """
    try:
        return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error as error:
        raise _refused(f"line {number} is not a row of cells", "Correct the line") from error


def _names(header: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return names and units of the columns of a recording from its headings.

    `header` holds a heading a column, such as "ax [m/s2]". Raises an error for a name given twice.
    """
    names, units = [], []
    for cell in header:
        name, unit = name_and_unit(cell)
        names.append(name)
        units.append(unit)
    twice = sorted({name for name in names if names.count(name) > 1 and name})
    if twice:
        raise _refused(f"two columns have the name '{twice[0]}'", "Rename one")
    return names, units


def name_and_unit(heading: str) -> tuple[str, str]:
    """Return name and unit of a heading such as ``time (s)``; an empty unit without brackets.

    It takes no longer than reading the heading, whatever that holds.
    """
    heading = heading.strip()
    start = heading.rfind("[") if heading.endswith("]") else -1  # as in [J/(kg m)]
    start = start if start >= 0 else max(heading.rfind("["), heading.rfind("("))
    name = heading[: max(start, 0)].strip()
    if name and _IN_BRACKETS.match(heading, start):
        return name, heading[start + 1 : -1].strip()
    return heading, ""


def _check_rows(body: Sequence[tuple[int, Sequence[str]]], names: Sequence[str]) -> None:
    """Raise `StudyError` if rows of a recording differ from the header in their number of cells.

    `body` holds the line number and the cells of each row, `names` the names of the columns.
    """
    odd = [(line, len(row)) for line, row in body if len(row) != len(names)]
    problems = [
        Problem(
            "recording",
            f"line {line} of the recording has {count} cell{'s' * (count != 1)}, but "
            f"its header has {len(names)}",
            "Correct the line of the recording, or remove it",
        )
        for line, count in odd[:SHOWN]
    ]
    if len(odd) > SHOWN:
        fix = "Export it again; where a comma is a decimal comma, separate the cells by semicolons"
        problems.append(Problem("recording", f"{len(odd):,} lines are not whole", fix))
    if problems:
        raise StudyError(problems)


def _column(
    texts: Sequence[str], points: Sequence[str], unit: str, lines: NDArray[np.int64]
) -> RecordingColumn:
    """Return one column of a recording: its values, unit, and the cells that are no numbers.

    `texts` are the cells of the column as they were written and `points` those with decimal points,
    `unit` is that of its heading, `lines` the line number of each cell in the file, for messages.
    Values that are no finite number count as faults, of which the first `SHOWN` are kept with line
    and text.
    """
    try:
        values = np.fromiter(map(float, points), np.float64, len(points))
    except ValueError:
        if all(_CLOCK.fullmatch(text.strip()) for text in points):
            seconds = _seconds(points)
            if seconds is not None:
                return RecordingColumn(seconds, "s")
        values = np.array([float(text) if _is_number(text) else np.nan for text in points])
    wrong = np.flatnonzero(~np.isfinite(values))
    faults = tuple(Fault(int(lines[row]), texts[row].strip()) for row in wrong[:SHOWN])
    return RecordingColumn(values, unit, faults, wrong.size)


def _seconds(texts: Sequence[str]) -> NDArray[np.float64] | None:
    """Return dates with times, or times of day, after ISO 8601 as seconds from the first.

    None if one is no such text.
    """
    day = "" if len(texts[0].strip()) > len("00:00:00.000000000") else "2000-01-01T"
    try:
        times = [datetime.fromisoformat(day + text.strip()) for text in texts]
        return np.array([(time - times[0]).total_seconds() for time in times])
    except (TypeError, ValueError):  # the first: some have a time zone, some do not
        return None


def _is_number(text: str) -> bool:
    """True if a text is a number as Python reads it, NaN and infinity included."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _refused(message: str, fix: str) -> StudyError:
    """Return the error of a recording that cannot be read."""
    return StudyError([Problem("recording", message, fix)])


def _too_long(size: int) -> StudyError:
    """Return the error of a recording of `size` bytes, which is more than the limit."""
    return _refused(
        f"the recording has {size / 1e6:,.0f} MB, the limit is {MAX_BYTES / 1e6:.0f} MB",
        "Shorten the recording: one second is enough",
    )
