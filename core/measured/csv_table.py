"""A table of measured channels, read from CSV as recorders and spreadsheets write it.

What is wrong in a column is kept with it and told only if the column is used: a recorder's column
of remarks does not spoil its accelerations.
"""

import codecs
import csv
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.study.units import UnitError, problem
from vibrafeed.core.suggestions import suggestion

MAX_BYTES = 50_000_000  # bytes of a file, or characters of a text
MAX_ROWS = 500_000  # whose fit in three axes takes half a gigabyte and some ten seconds
MAX_COLUMNS = 256  # columns of a table
MAX_LETTERS = 20_000  # characters of a line
SHOWN = 3  # faults of a column that are listed one by one
SAMPLED = 50  # rows that show the form of most rows
MAX_ABOVE = 1_000  # rows and remarks above the table

_IN_BRACKETS = re.compile(r"(\[[^\[\]]*\]|[\[(][^\[\]()]*[\])])\Z")
_UNITS_ONLY = re.compile(
    r"([\[(][^\[\]]*[\])])?"
    r"|-?|[nuµμm]?s(?:ec)?|[mk]?[gG]n?|Gal|[mc]?m[/·* ]?s\S{0,3}[2²]|m?V|[k]?Hz|°C?"
)
SEPARATOR = re.compile(r'"?sep=(.)"?', re.IGNORECASE)
"""A line on top of a table that names what separates its cells, as spreadsheets have it."""
_REMARKS = ("comment", "comments", "remark", "remarks")
_CLOCK = re.compile(r"(?:\d{4}-\d\d-\d\d[T ])?\d\d:\d\d(?::\d\d.*)?")
_MINUS = "\u2212"  # the minus sign of word processors and PDF files


@dataclass(frozen=True)
class RecordingColumn:
    """One channel.

    Attributes
    ----------
    values : ndarray, shape (n,)
        As written in the file; NaN where a cell is faulty.
    unit : str
        What the header says in brackets; empty if it says nothing.
    faults : tuple of (int, str)
        Line and text of the first cells that are no finite numbers.
    faulty : int
        How many there are.
    contradiction : str
        Why its decimal marks cannot be what they seem; empty if they can.
    """

    values: NDArray[np.float64]
    unit: str
    faults: tuple[tuple[int, str], ...] = ()
    faulty: int = 0
    contradiction: str = ""


@dataclass(frozen=True)
class RecordingTable:
    """Columns of equal length, by name, and the line of the file on which each row stands."""

    columns: Mapping[str, RecordingColumn]
    lines: NDArray[np.int64]

    def column(self, name: str, path: str) -> RecordingColumn:
        """Return a column by name; raise `StudyError` if it is missing or has faulty cells.

        `path` is the place in the study where the column is named, for the messages.
        """
        column = self.columns.get(name)
        if column is None:
            raise refused(
                path,
                f"the recording has no column '{name[:60]}'",
                suggestion(name, self.columns),
                name,
            )
        if column.contradiction:
            raise refused(path, column.contradiction, ONE_MARK, name)
        problems = [
            Problem(
                path,
                f"line {line} of column '{name}' is not a number: {text[:40]!r}",
                "Correct the line of the recording, or remove it",
                name,
            )
            for line, text in column.faults
        ]
        if column.faulty > SHOWN:
            problems.append(
                Problem(
                    path,
                    f"{column.faulty:,} cells of column '{name}' are not finite numbers",
                    "Export the recording again",
                    name,
                )
            )
        raise_any(problems)
        return column


@contextmanager
def gathered(problems: list[Problem], path: str = "") -> Iterator[None]:
    """Add the problems found within to `problems`, so that what follows is looked at as well.

    `path` is the place in the study of a value that may have a wrong unit.
    """
    try:
        yield
    except UnitError as error:
        problems.append(problem(path, error))
    except StudyError as error:
        problems += error.problems


_refused = partial(refused, "recording")


def read_table(source: str | Path) -> RecordingTable:
    """Return the table in a CSV file or text.

    Comma, semicolon or tab part the cells; beside the last two a comma is a decimal comma. A row
    of names stands above the numbers, with units in brackets if need be (``ax [g]``); a row of
    units alone may follow it. Whatever a recorder writes above the names is passed over, as are
    blank lines and those that begin with ``#``, unless such a line is the only one that can hold
    the names. Cells may be dates with times, or times of day, after ISO 8601: they become seconds
    from the first.

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
    headings = [name_and_unit(cell) for cell in header]
    names = [name for name, _ in headings]
    twice = sorted({name for name in names if names.count(name) > 1 and name})
    if twice:
        raise _refused(f"two columns have the name '{twice[0]}'", "Rename one")
    under = below or [""] * len(headings)
    units = [unit or other for (_, unit), other in zip(headings, under, strict=False)]
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
    columns = {
        name: _column(texts, lines.delimiter, unit, numbers, wrong.get(name, ""))
        for (name, texts), unit in zip(cells.items(), units, strict=True)
    }
    return RecordingTable(columns, numbers)


class _Lines(NamedTuple):
    """The lines of a recording, taken apart: number and cells of each row and of each remark."""

    rows: list[tuple[int, list[str]]]
    remarks: list[tuple[int, list[str]]]  # those that may hold the names of columns
    delimiter: str

    def is_number(self, cell: str) -> bool:
        return _is_number(cell if self.delimiter == "," else cell.replace(",", "."))

    def first_of_body(self) -> int:
        sampled = self.rows[:: -max(len(self.rows) // SAMPLED, 1)]
        forms = Counter(tuple(map(self.is_number, cells)) for _, cells in sampled)
        form = max(forms, key=lambda form: (forms[form], len(form)))
        return next(
            index
            for index, (_, cells) in enumerate(self.rows)
            if len(cells) == len(form)
            and all(self.is_number(cell) for cell, held in zip(cells, form, strict=True) if held)
        )

    def can_name(self, cells: list[str], width: int) -> bool:
        if len(cells) != width and len(_without_remark(cells)) != width:
            return False
        texts = [cell.strip() for cell in cells if cell.strip()]
        return bool(texts) and not any(
            text[0] in "+-.,0123456789" or self.is_number(text) for text in texts
        )


def _parted(lines: _Lines) -> tuple[list[str], list[str], list[tuple[int, list[str]]]]:
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
    if header - 1 in heads and all(_UNITS_ONLY.fullmatch(one.strip()) for one in rows[header][1]):
        header -= 1
        units = [cell.strip(" []()") for cell in rows[header + 1][1]]
    named = rows[header][1]
    return named if len(named) == width else _without_remark(named), units, rows[end:]


def _without_remark(cells: list[str]) -> list[str]:
    return cells[:-1] if cells[-1].strip().casefold() in _REMARKS else cells


def _check_header(header: list[str]) -> None:
    if not header:
        raise _refused("the recording is empty", "Give a row of names, and rows of numbers below")
    if len(header) > MAX_COLUMNS:
        raise _refused(
            f"it has {len(header):,} columns",
            f"Keep the {MAX_COLUMNS} that are used at most",
        )
    if all(_is_number(cell) for cell in header):
        raise _refused(
            "the first row of the recording holds numbers, not column names",
            "Put a row with the names of columns on top",
        )


def _text_of(source: str | Path) -> str:
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
        raise _refused(
            "the file is not a text file", "Export the recording as CSV, in UTF-8"
        ) from None


def decoded(raw: bytes) -> str:
    """Return the text of a table as recorders and spreadsheets write it, with plain minus signs.

    Its encoding is UTF-8, with or without a byte order mark, UTF-16 with one, or Windows-1252.
    Raises `ValueError` if it is none of them.
    """
    is_wide = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if is_wide or b"\0" not in raw:
        # The last is what a spreadsheet in Europe writes.
        for encoding in ("utf-16",) if is_wide else ("utf-8-sig", "cp1252"):
            try:
                return raw.decode(encoding).replace(_MINUS, "-")
            except UnicodeDecodeError:
                continue
    raise ValueError("it is not text in UTF-8, UTF-16 or Windows-1252")


def _lines(text: str) -> _Lines:
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
    middle = text.rfind("\n", 0, len(text) // 2) + 1
    inner = text[middle : middle + MAX_LETTERS].partition("\n")[0]
    of_first, of_inner = (
        next((mark for mark in "\t;" if mark in some), ",") for some in (line, inner)
    )
    return of_first if line.count(of_first) == inner.count(of_first) or not inner else of_inner


def _cells(number: int, line: str, delimiter: str) -> list[str]:
    row = _quoted(number, line, delimiter) if '"' in line else line.split(delimiter)
    while len(row) > 1 and not row[-1].strip():  # a recorder may end its lines with a delimiter
        row.pop()
    return row


def _quoted(number: int, line: str, delimiter: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error as error:
        raise _refused(f"line {number} is not a row of cells", "Correct the line") from error


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
        problems.append(
            Problem(
                "recording",
                f"{len(odd):,} lines are not whole",
                "Export it again; where a comma is a decimal comma, separate the cells by "
                "semicolons",
            )
        )
    raise_any(problems)


def _column(
    texts: Sequence[str], delimiter: str, unit: str, lines: NDArray[np.int64], contradiction: str
) -> RecordingColumn:
    points = texts if delimiter == "," else [text.replace(",", ".") for text in texts]
    try:
        values = np.fromiter(map(float, points), np.float64, len(points))
    except ValueError:
        if all(_CLOCK.fullmatch(text.strip()) for text in points):
            seconds = _seconds(points)
            if seconds is not None:
                return RecordingColumn(seconds, "s", contradiction=contradiction)
        values = np.array([float(text) if _is_number(text) else np.nan for text in points])
    wrong = np.flatnonzero(~np.isfinite(values))
    return RecordingColumn(
        values,
        unit,
        tuple((int(lines[row]), texts[row].strip()) for row in wrong[:SHOWN]),
        wrong.size,
        contradiction,
    )


def _seconds(texts: Sequence[str]) -> NDArray[np.float64] | None:
    day = "" if len(texts[0].strip()) > len("00:00:00.000000000") else "2000-01-01T"
    try:
        times = [datetime.fromisoformat(day + text.strip()) for text in texts]
        return np.array([(time - times[0]).total_seconds() for time in times])
    except (TypeError, ValueError):  # the first: some have a time zone, some do not
        return None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _too_long(size: int) -> StudyError:
    return _refused(
        f"the recording has {size / 1e6:,.0f} MB, the limit is {MAX_BYTES / 1e6:.0f} MB",
        "Shorten the recording: one second is enough",
    )


# --- Decimal marks of a table's columns: a comma cannot part thousands here and decimals there.


ONE_MARK = (
    "Export it without separators of thousands, and the numbers of a column with equally many "
    "decimals"
)
"""What to do where the marks of a table contradict each other."""
_WITH_MARK = re.compile(r"[-+]?\d*([.,])\d*(?:[eE][-+]?\d+)?")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}[.,]\d{3}")
_WHOLE = re.compile(r"[-+]?\d+")


def contradictions(columns: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return the contradictions of a table's decimal marks, in words, by the name of a column.

    `columns` holds the cells of each column as they were written. In the cells that are numbers
    either commas or points are decimal marks. Columns that disagree, or one that has both, part
    thousands by one of the two; so does a column in which the mark stands before three digits
    everywhere, never behind a zero, and is missing from whole numbers below a thousand only.
    """
    examples = {name: _examples(cells) for name, cells in columns.items()}
    marked = {mark: [n for n, found in examples.items() if mark in found] for mark in ".,"}
    faults: dict[str, str] = {}
    for mark, other in (",.", ".,"):
        for name in marked[mark]:
            if marked[other]:
                beside = next((n for n in marked[other] if n != name), name)
                faults[name] = (
                    f"column '{name}' has '{examples[name][mark]}' and column '{beside}' "
                    f"'{examples[beside][other]}': one of the two marks separates thousands"
                )
    for name in {*marked[","], *marked["."]} - faults.keys():
        short = _thousands(columns[name])
        if short is not None:
            seen = next(iter(examples[name].values()))
            faults[name] = f"column '{name}' has '{seen}' beside '{short}': thousands are separated"
    return faults


def _examples(cells: Sequence[str]) -> dict[str, str]:
    examples: dict[str, str] = {}
    for cell in cells:
        match = _WITH_MARK.fullmatch(cell.strip())
        if match and match[1] not in examples:
            examples[match[1]] = cell.strip()
            if len(examples) > 1:
                break
    return examples


def _thousands(cells: Sequence[str]) -> str | None:
    short = None
    for cell in map(str.strip, cells):
        if _WHOLE.fullmatch(cell):
            if len(cell.lstrip("+-")) > 3:
                return None
            short = cell
        elif cell and not _THOUSANDS.fullmatch(cell):
            return None
    return short
