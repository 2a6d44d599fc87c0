"""Tables in text, workbooks and files of recorders, read by one reader."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vibrafeed.core.errors import refused
from vibrafeed.core.tables.files import SUFFIXES, read_numbers, workbook
from vibrafeed.core.tables.headings import is_row_of_units, name_and_unit
from vibrafeed.core.tables.table import SEMICOLONS, Column, InputTable
from vibrafeed.core.tables.text import (
    MAX_ABOVE,
    MAX_BYTES,
    MAX_ROWS,
    ONE_MARK,
    SAMPLED,
    SIGNS,
    Lines,
    contradictions,
    is_value,
    lines_of,
    number_and_unit,
    text_of,
)

REMARKS = ("comment", "comments", "remark", "remarks", "note", "notes", "bemerkung")
"""Names of columns of remarks, which rows need not have."""
SHORTEN = "Shorten it: one second of a recording is enough"

Row = tuple[int, list[str]]


def read_table(source: str | Path, section: str = "recording") -> InputTable:
    """Return the table in a file, or in a text.

    Text may be in UTF-8, UTF-16 or Windows-1252, with tabs, semicolons, commas, bars or blanks
    between the cells; a comma is a decimal comma unless it is the separator. The table is what has
    the width and the form of most lines; the names of columns stand right above, perhaps behind a
    ``#``, with units in brackets or in a row of their own. What stands further above is kept as a
    note. Without names the columns are called by their numbers, from 1. XLSX (the first sheet),
    MAT, WAV, LVM, TDMS and UFF are read as well.

    Parameters
    ----------
    source : str or Path
        The text itself, or the path of a file.
    section : str
        Where a study names the table, for messages.

    Raises
    ------
    StudyError
        If it is no table, or larger than 50 MB or 500,000 rows.
    OSError
        If the file cannot be read.
    """
    if isinstance(source, str):
        return _table_of_lines(
            lines_of(source.removeprefix("\ufeff").translate(SIGNS), section), section
        )
    with source.open("rb") as file:  # no more is read than is allowed, whatever the file is
        raw = file.read(MAX_BYTES + 1)
    if len(raw) > MAX_BYTES:
        size = f"{source.stat().st_size / 1e6:,.0f} MB, the limit is {MAX_BYTES / 1e6:.0f} MB"
        raise refused(section, f"the table has {size}", SHORTEN)
    suffix = source.suffix.lower()
    if suffix == ".xlsx":
        return _table_of_lines(Lines(workbook(source, section), [], "\t"), section)
    if suffix in SUFFIXES:
        return read_numbers(source, section)
    try:
        return _table_of_lines(lines_of(text_of(raw), section), section)
    except UnicodeError as error:
        fix = "Export the table as CSV, in UTF-8"
        raise refused(section, f"{source.name}: {error}", fix) from None


def _table_of_lines(lines: Lines, section: str) -> InputTable:
    rows = lines.rows
    if not rows:
        raise refused(
            section, "the table is empty", "Add a row of names and rows of numbers below it"
        )
    first = _first_row_of_numbers(rows)
    if first is None:
        raise refused(section, "the table has no numbers", "Add rows of numbers below the names")
    header, units, start = _heading(lines, first)
    width = len(header) or _filled(rows[first][1])
    # Lines of another width without any number are remarks.
    body = [row for row in rows[start:] if len(row[1]) == width or any(map(is_value, row[1]))]
    if len(body) > MAX_ROWS:
        raise refused(section, f"the table has more than {MAX_ROWS:,} rows", SHORTEN)
    _check_rows(body, width, section)
    names = header or [str(number) for number in range(1, width + 1)]
    lines_above = rows[:start]
    labels = {cells[0].strip(): cells[1:] for _, cells in lines_above if cells}
    if not units:  # LabVIEW states units of values only, not of times
        unit_labels = iter(labels.get("Y_Unit_Label", []))
        units = ["" if name == "X_Value" else next(unit_labels, "") for name in names]
    step = number_and_unit((labels.get("Delta_X") or [""])[0])
    seconds = float(step[0].replace(",", ".")) if step else 0.0
    note = "\n".join(" ".join(cells) for _, cells in lines_above if cells[: len(header)] != header)
    return _table(names, units, body, lines.separator, note, section, seconds)


def _filled(cells: Sequence[str]) -> int:
    # A recorder may end its lines with separators.
    return next((k for k in range(len(cells), 0, -1) if cells[k - 1].strip()), 0)


def _first_row_of_numbers(rows: list[Row]) -> int | None:
    sample = rows[:: -max(len(rows) // SAMPLED, 1)]
    forms = Counter(tuple(map(_kind, cells[: _filled(cells)])) for _, cells in sample)
    usual_kinds = max(forms, key=lambda kinds: (any(kinds), forms[kinds], len(kinds)))
    for index, (_, cells) in enumerate(rows):
        kinds = [*map(_kind, cells[: _filled(cells)])]
        pairs = zip(kinds, usual_kinds, strict=False)
        # Cells may be empty where most are not, and text where most are.
        has_usual_kinds = all(kind in (None, usual_kind) for kind, usual_kind in pairs)
        if any(kinds) and len(kinds) == len(usual_kinds) and has_usual_kinds:
            return index
    return None


def _kind(cell: str) -> bool | None:
    return is_value(cell) if cell.strip() else None


def _heading(lines: Lines, first: int) -> tuple[list[str], list[str], int]:
    # The names of columns, their units, and the index of the first row below them.
    rows = lines.rows
    width = _filled(rows[first][1])
    widest = max(len(cells) for _, cells in rows[first : first + SAMPLED])
    heading_rows = [
        index for index in range(min(first, MAX_ABOVE)) if _can_name(rows[index][1], width, widest)
    ]
    if not heading_rows:
        remarks_above = [row for row in lines.remarks if row[0] < rows[first][0]]
        names = next(
            (cells for _, cells in remarks_above[::-1] if _can_name(cells, width, widest)), []
        )
        nearest = names or max([(0, []), *rows[:first][-1:], *remarks_above[-1:]])[1]
        # Names of too few columns are names, and a reason to look at the separator.
        is_none = not names and (_filled(nearest) < 2 or any(map(is_value, nearest)))
        return [] if is_none else nearest[: _filled(nearest)], [], first
    last_heading = heading_rows[-1]
    units: list[str] = []
    if (
        len(heading_rows) > 1
        and heading_rows[-2] == last_heading - 1
        and is_row_of_units(rows[last_heading][1])
    ):
        units = [cell.strip(" []()") for cell in rows[last_heading][1]]
        last_heading -= 1
    names = rows[last_heading][1]
    return names[: _filled(names)], units, heading_rows[-1] + 1


def _can_name(cells: Sequence[str], width: int, widest: int) -> bool:
    # Rows may lack remarks and empty cells at their end; names are no numbers.
    filled = cells[: _filled(cells)]
    surplus = [
        cell for cell in filled[max(width, widest) :] if cell.strip().casefold() not in REMARKS
    ]
    return len(filled) >= width > 0 and not surplus and not any(map(is_value, filled))


def _check_rows(body: Sequence[Row], width: int, section: str) -> None:
    too_wide = [(line, len(row)) for line, row in body if any(map(is_value, row[width:]))]
    if too_wide:
        line, count = too_wide[0]
        more = f" ({len(too_wide):,} such lines)" if len(too_wide) > 1 else ""
        message = f"line {line} has {count} cells, but the heading has {width}{more}"
        raise refused(section, message, SEMICOLONS)


def _table(
    names: list[str],
    units: list[str],
    body: list[Row],
    separator: str,
    note: str,
    section: str,
    step: float,
) -> InputTable:
    width = len(names)
    padding = [""] * width
    cells = zip(*([*row, *padding][:width] for _, row in body), strict=True)
    columns: dict[str, Column] = {}
    cells_of_column: dict[str, tuple[str, ...]] = {}
    for heading, unit_below, column in zip(names, [*units, *padding], cells, strict=False):
        name, unit = name_and_unit(heading)
        if name in columns and column != cells_of_column[name]:
            fault = f"two columns have the name '{name}'"
            columns[name] = Column(column, "", fault, "Rename one")
        elif name:
            columns[name] = Column(column, unit or unit_below.strip())
            cells_of_column[name] = column
    for name, fault in contradictions(cells_of_column).items():
        columns[name] = Column(cells_of_column[name], "", fault, ONE_MARK)
    lines = np.array([line for line, _ in body])
    return InputTable(columns, lines, section, separator != ",", note, step)
