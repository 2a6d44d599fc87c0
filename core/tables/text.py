"""Lines and cells of a table in text, whatever its encoding, separator and decimal mark."""

import codecs
import csv
import re
from collections.abc import Mapping, Sequence
from datetime import datetime
from io import StringIO
from typing import NamedTuple

from vibrafeed.core.errors import refused

MAX_BYTES = 50_000_000  # bytes of a file, or characters of a text
MAX_ROWS = 500_000  # whose fit in three axes takes half a gigabyte and some ten seconds
MAX_LETTERS = 20_000  # characters of a line
MAX_ABOVE = 1_000  # lines above the table
SAMPLED = 50  # lines that show the separator and the form of most rows

SEPARATORS = "\t;|, "
_NAMED_SEPARATOR = re.compile(r'"?sep=(.)"?', re.IGNORECASE)
_NUMBER = re.compile(r"([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)([^\d.,:;|\t-][^,;|\t]*)?")
_CLOCK = re.compile(r"(?:\d{4}-\d\d-\d\d[T ])?\d{1,2}:\d\d(?::\d\d.*)?")
_WORD_WITH_UNIT = re.compile(r"[^\s\[(]+(?:\s?[\[(][^\])]*[\])])?|[\[(][^\])]*[\])]")
SIGNS = str.maketrans({"\u2212": "-", "\xa0": " ", "\u202f": " "})


class Lines(NamedTuple):
    """The lines of a table, each its number and its cells, and those behind a ``#``."""

    rows: list[tuple[int, list[str]]]
    remarks: list[tuple[int, list[str]]]
    separator: str


def text_of(raw: bytes) -> str:
    """Return the text of a table as recorders and spreadsheets write it, with plain minus signs.

    Its encoding is UTF-8, with or without a byte order mark, UTF-16, or Windows-1252. Raises
    `UnicodeError` if it is none of them.
    """
    wide = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    # Without a mark, text in UTF-16 has a zero in every other byte, as no other text has.
    halves = [raw[start:2000:2].count(0) > len(raw[start:2000:2]) // 2 for start in (0, 1)]
    if wide:
        encodings = ["utf-16"]
    elif any(halves):
        encodings = ["utf-16-be" if halves[0] else "utf-16-le"]
    else:
        encodings = [] if b"\0" in raw else ["utf-8-sig", "cp1252"]
    for encoding in encodings:
        try:
            return raw.decode(encoding).translate(SIGNS)
        except UnicodeDecodeError:
            continue
    raise UnicodeError("it is not text in UTF-8, UTF-16 or Windows-1252")


def number_and_unit(cell: str) -> tuple[str, str] | None:
    """Return the number of a cell, which may have a comma, and the rest; None if it is none."""
    found = _NUMBER.fullmatch(cell.strip())
    rest = (found[2] or "") if found else ""
    return (found[1], rest) if found and not rest.lstrip()[:1].isdigit() else None


def is_value(cell: str) -> bool:
    """True if a cell holds a number, with a unit or without, or a time."""
    return number_and_unit(cell) is not None or is_clock(cell)


def is_clock(cell: str) -> bool:
    """True if a cell has the form of a date with a time, or of a time of day."""
    return _CLOCK.fullmatch(cell.strip()) is not None


def seconds_of(texts: Sequence[str]) -> list[float] | None:
    """Return dates with times, or times of day, as seconds from the first; None if they are not."""
    day = "" if len(texts[0].strip()) > len("00:00:00.000000000") else "2000-01-01T"
    try:
        times = [datetime.fromisoformat(day + text.strip().replace(",", ".")) for text in texts]
        return [(time - times[0]).total_seconds() for time in times]
    except (TypeError, ValueError):  # the first: some have a time zone, some do not
        return None


def lines_of(text: str, section: str) -> Lines:
    """Return the cells of all lines of a text; `section` is that of the table, for messages.

    Blank lines are left out. Raises `StudyError` if a line is too long.
    """
    named = ""
    lines: list[tuple[int, str]] = []
    # A cell of several lines is no number; each line is a row of its own, and keeps its number.
    for number, line in enumerate(StringIO(text, newline=None), start=1):
        if len(line) > MAX_LETTERS:
            raise refused(
                section,
                f"line {number} has {len(line):,} characters",
                "Remove columns that are not used",
            )
        if not lines and (found := _NAMED_SEPARATOR.fullmatch(line.strip())):
            named = found[1]
        elif line.strip(" \t;,\n"):
            lines.append((number, line.rstrip("\n")))
        if len(lines) > MAX_ROWS + MAX_ABOVE:
            break
    separator = named or _separator([line for _, line in lines])
    rows = [(n, cells_of(line, separator)) for n, line in lines if not _is_remark(line)]
    remarks = [
        (n, cells_of(line.lstrip("# \t"), separator))
        for n, line in lines[:MAX_ABOVE]
        if _is_remark(line)
    ]
    return Lines(rows, remarks, separator)


def _is_remark(line: str) -> bool:
    return line.lstrip().startswith("#")


def _separator(lines: list[str]) -> str:
    sampled = [line for line in lines[:: -max(len(lines) // SAMPLED, 1)] if not _is_remark(line)]

    def values(separator: str) -> int:
        parted = ([cell for cell in cells_of(one, separator) if cell.strip()] for one in sampled)
        return sum(max(0, sum(1 if is_value(cell) else -1 for cell in row)) for row in parted)

    best = max(SEPARATORS, key=values)
    return "," if all(len(cells_of(line, best)) == 1 for line in sampled) else best


def cells_of(line: str, separator: str) -> list[str]:
    """Return the cells of a line."""
    if separator == " ":
        return _WORD_WITH_UNIT.findall(line) if "[" in line or "(" in line else line.split()
    if '"' in line:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    return line.split(separator)


# --- Decimal marks of a table's columns: a comma cannot part thousands here and decimals there.


ONE_MARK = (
    "Export it without separators of thousands, and the numbers of a column with equally many "
    "decimals"
)
"""What to do where the marks of a table contradict each other."""
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}[.,]\d{3}")
_WHOLE = re.compile(r"[-+]?\d+")


def contradictions(columns: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return the contradictions of a table's decimal marks, in words, by the name of a column.

    `columns` holds the cells of each column as they were written. In the cells that are numbers
    either commas or points are decimal marks. Columns that disagree, or one that has both, part
    thousands by one of the two; so does a column in which the mark stands before three digits
    everywhere, never behind a zero, and is missing from whole numbers below a thousand only.
    """
    numbers = {
        name: [found[0] for cell in dict.fromkeys(cells) if (found := number_and_unit(cell))]
        for name, cells in columns.items()
    }
    marked = {
        name: {mark: cell for cell in cells[::-1] for mark in ",." if mark in cell}
        for name, cells in numbers.items()
    }
    first = {mark: name for name in [*marked][::-1] for mark in marked[name]}
    faults: dict[str, str] = {}
    for name, marks in marked.items():
        if marks and len(first) == 2:
            shown = " and ".join(
                f"column '{n}' has '{marked[n][m]}'" for m, n in [*first.items()][::-1]
            )
            faults[name] = f"{shown}: one of the two marks separates thousands"
        elif marks and (short := _thousands(numbers[name])) is not None:
            seen = next(iter(marks.values()))
            faults[name] = f"column '{name}' has '{seen}' beside '{short}': thousands are separated"
    return faults


def _thousands(cells: Sequence[str]) -> str | None:
    whole = [cell for cell in cells if _WHOLE.fullmatch(cell)]
    others = [cell for cell in cells if not _WHOLE.fullmatch(cell)]
    are_short = all(len(cell.lstrip("+-")) <= 3 for cell in whole)
    return whole[-1] if whole and are_short and all(map(_THOUSANDS.fullmatch, others)) else None
