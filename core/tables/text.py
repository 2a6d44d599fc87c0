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
    has_utf16_mark = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    # Without a mark, text in UTF-16 has a zero in every other byte, as no other text has.
    is_half_zero = [raw[start:2000:2].count(0) > len(raw[start:2000:2]) // 2 for start in (0, 1)]
    if has_utf16_mark:
        encodings = ["utf-16"]
    elif any(is_half_zero):
        encodings = ["utf-16-be" if is_half_zero[0] else "utf-16-le"]
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
    match = _NUMBER.fullmatch(cell.strip())
    remainder = (match[2] or "") if match else ""
    return (match[1], remainder) if match and not remainder.lstrip()[:1].isdigit() else None


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
    stated_separator = ""
    lines: list[tuple[int, str]] = []
    # Each line is a row with its number in the file, also within a quoted cell of several lines.
    for number, line in enumerate(StringIO(text, newline=None), start=1):
        if len(line) > MAX_LETTERS:
            raise refused(
                section,
                f"line {number} has {len(line):,} characters",
                "Remove columns that are not used",
            )
        if not lines and (match := _NAMED_SEPARATOR.fullmatch(line.strip())):
            stated_separator = match[1]
        elif line.strip(" \t;,\n"):
            lines.append((number, line.rstrip("\n")))
        if len(lines) > MAX_ROWS + MAX_ABOVE:
            break
    separator = stated_separator or _separator([line for _, line in lines])
    rows = [(number, cells_of(line, separator)) for number, line in lines if not _is_remark(line)]
    remarks = [
        (number, cells_of(line.lstrip("# \t"), separator))
        for number, line in lines[:MAX_ABOVE]
        if _is_remark(line)
    ]
    return Lines(rows, remarks, separator)


def _is_remark(line: str) -> bool:
    return line.lstrip().startswith("#")


def _separator(lines: list[str]) -> str:
    sampled = [line for line in lines[:: -max(len(lines) // SAMPLED, 1)] if not _is_remark(line)]

    def number_score(separator: str) -> int:
        rows = ([cell for cell in cells_of(line, separator) if cell.strip()] for line in sampled)
        return sum(max(0, sum(1 if is_value(cell) else -1 for cell in row)) for row in rows)

    # The separator whose cells are numbers most often, less those that are not.
    best = max(SEPARATORS, key=number_score)
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
        name: [match[0] for cell in dict.fromkeys(cells) if (match := number_and_unit(cell))]
        for name, cells in columns.items()
    }
    # By column and mark the first cell that has it; then by mark the first column that has it.
    cell_with_mark = {
        name: {mark: cell for cell in cells[::-1] for mark in ",." if mark in cell}
        for name, cells in numbers.items()
    }
    column_with_mark = {
        mark: name for name in [*cell_with_mark][::-1] for mark in cell_with_mark[name]
    }
    faults: dict[str, str] = {}
    for name, marks in cell_with_mark.items():
        if marks and len(column_with_mark) == 2:
            shown = " and ".join(
                f"column '{column_name}' has '{cell_with_mark[column_name][mark]}'"
                for mark, column_name in [*column_with_mark.items()][::-1]
            )
            faults[name] = f"{shown}: one of the two marks separates thousands"
        elif marks and (number := _thousands(numbers[name])) is not None:
            marked_cell = next(iter(marks.values()))
            faults[name] = (
                f"column '{name}' has '{marked_cell}' beside '{number}': thousands are separated"
            )
    return faults


def _thousands(cells: Sequence[str]) -> str | None:
    whole_numbers = [cell for cell in cells if _WHOLE.fullmatch(cell)]
    others = [cell for cell in cells if not _WHOLE.fullmatch(cell)]
    are_short = all(len(cell.lstrip("+-")) <= 3 for cell in whole_numbers)
    return (
        whole_numbers[-1]
        if whole_numbers and are_short and all(map(_THOUSANDS.fullmatch, others))
        else None
    )
