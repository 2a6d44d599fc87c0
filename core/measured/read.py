"""A table of measured channels, read from CSV as recorders and spreadsheets write it.

What is wrong in a column is kept with it and told only if the column is used: a recorder's column
of remarks does not spoil its accelerations.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.errors import Problem, StudyError
from core.suggestions import suggestion

MAX_BYTES = 50_000_000  # bytes of a file, or characters of a text
MAX_ROWS = 500_000  # whose fit in three axes takes half a gigabyte and some ten seconds
MAX_COLUMNS = 256  # columns of a table
MAX_LETTERS = 20_000  # characters of a line
SHOWN = 3  # faults of a column that are listed one by one

_IN_BRACKETS = re.compile(r"(\[[^\[\]]*\]|[\[(][^\[\]()]*[\])])\Z")
_UNITS_ONLY = re.compile(r"([\[(][^\[\]]*[\])])?")
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
    """

    values: NDArray[np.float64]
    unit: str
    faults: tuple[Fault, ...] = ()
    faulty: int = 0


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

    Comma, semicolon or tab part the cells; beside the last two a comma is a decimal comma. The
    first row holds names, with units in brackets if need be (``ax [g]``); a row of units alone
    may follow it. Blank lines and lines that begin with ``#`` are passed over.

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
    text = _text_of(source)
    rows = _rows(text)
    _, header = next(rows, (0, []))
    _check_header(header)
    names, units = _names(header)
    body = list(islice(rows, MAX_ROWS + 2))
    if body and all(_UNITS_ONLY.fullmatch(cell.strip()) for cell in body[0][1]):
        below = (cell.strip(" []()") for cell in body.pop(0)[1])
        units = [unit or other for unit, other in zip(units, below, strict=False)]
    if not body:
        raise _refused("the recording holds no numbers", "Give rows of numbers below the names")
    if len(body) > MAX_ROWS:
        raise _refused(
            f"it has more than {MAX_ROWS:,} rows",
            "Shorten the recording: one second is enough",
        )
    _check_rows(body, names)
    lines = np.array([line for line, _ in body])
    cells = list(zip(*(row for _, row in body), strict=True))
    columns = {
        name: _column(texts, unit, lines)
        for name, unit, texts in zip(names, units, cells, strict=True)
    }
    return RecordingTable(columns, lines)


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

    Its encoding is UTF-8, with or without a byte order mark, or Windows-1252.

    Raises
    ------
    ValueError
        If it is neither.
    """
    if b"\0" not in raw:
        for encoding in _ENCODINGS:
            try:
                return raw.decode(encoding).replace(_MINUS, "-")
            except UnicodeDecodeError:
                continue
    raise ValueError("it is not text in UTF-8 or Windows-1252")


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield line number and cells of each row of a recording, without blank lines and comments.

    `text` is the whole file. Decimal commas become points where the cells are not separated by
    commas.
    """
    delimiter = ""
    # A cell of several lines is no number; each line is a row of its own, and keeps its number.
    for number, line in enumerate(StringIO(text, newline=None), start=1):
        line = line.rstrip("\n")
        if line.lstrip().startswith("#") or not line.strip(" \t;,"):
            continue
        if len(line) > MAX_LETTERS:
            raise _refused(f"line {number} has {len(line):,} letters", "Keep the columns in use")
        if not delimiter:
            delimiter = next((mark for mark in "\t;" if mark in line), ",")
        row = _quoted(number, line, delimiter) if '"' in line else line.split(delimiter)
        while len(row) > 1 and not row[-1].strip():  # a recorder may end its lines with a delimiter
            row.pop()
        yield number, row if delimiter == "," else [cell.replace(",", ".") for cell in row]


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


def _column(texts: Sequence[str], unit: str, lines: NDArray[np.int64]) -> RecordingColumn:
    """Return one column of a recording: its values, unit, and the cells that are no numbers.

    `texts` are the cells of the column, `unit` that of its heading, `lines` the line number of each
    cell in the file, for messages. Values that are no finite number count as faults, of which the
    first `SHOWN` are kept with line and text.
    """
    try:
        values = np.fromiter(map(float, texts), np.float64, len(texts))
    except ValueError:
        values = np.array([float(text) if _is_number(text) else np.nan for text in texts])
    wrong = np.flatnonzero(~np.isfinite(values))
    faults = tuple(Fault(int(lines[row]), texts[row].strip()) for row in wrong[:SHOWN])
    return RecordingColumn(values, unit, faults, wrong.size)


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
