"""Rows of parameters from a CSV file: a heading such as ``amplitude [mm]``, and numbers below."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from core.errors import Problem, StudyError
from core.quantities import QUANTITIES
from core.study.grid_study import PARAMETERS
from core.study.units import UnitError, read_number
from core.suggestions import suggestion

MAX_ROWS: Final = 2_000_000  # rows of a file
MAX_REPORTED: Final = 20  # problems of cells that are listed at most

_HEADING = re.compile(r"\s*([^\[\]()]*?)\s*(?:[\[(]([^\[\]()]*)[\])])?\s*")


def read_rows(path: Path) -> Mapping[str, tuple[float, ...]]:
    """Return the parameters in a CSV file by column, in the units of studies.

    Comma, semicolon or tab part the cells; beside the last two a comma is a decimal comma. A cell
    may have a unit of its own, as in a study; else the heading's counts.

    Raises
    ------
    StudyError
        With every problem of headings and cells.
    OSError
        If the file cannot be read.
    """
    heading, body, delimiter = _cells(path)
    names, units, problems = _headings(heading)
    problems += [
        Problem(f"row {number}",
                f"row {number} has {len(row)} cells, but the heading has {len(heading)}",
                "Give the row one cell for each column")
        for number, row in enumerate(body, 1)
        if len(row) != len(heading)
    ][:MAX_REPORTED]  # fmt: skip
    if problems:
        raise StudyError(problems)
    columns = {
        name: _column(name, unit, [row[k] for row in body], delimiter != ",", problems)
        for k, (name, unit) in enumerate(zip(names, units, strict=True))
    }
    if problems:
        raise StudyError(problems[:MAX_REPORTED])
    return columns


def _cells(path: Path) -> tuple[list[str], list[list[str]], str]:
    """Return heading, rows and column separator of a CSV file.

    Raises `StudyError` if it is no UTF-8 text, or has no rows or too many.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise StudyError(
            [
                Problem(
                    "rows", "the CSV file is not UTF-8 text", "Save the file in the encoding UTF-8"
                )
            ]
        ) from None
    delimiter = next((mark for mark in "\t;" if lines and mark in lines[0]), ",")
    heading, *body = [row for row in csv.reader(lines, delimiter=delimiter) if any(row)] or [[]]
    if not body or len(body) > MAX_ROWS:
        message = f"it has {len(body):,} rows of values" if body else "it holds no rows of values"
        fix = f"Give names of parameters on top, and 1 to {MAX_ROWS:,} rows below"
        raise StudyError([Problem("rows", message, fix)])
    return heading, body, delimiter


def _headings(cells: list[str]) -> tuple[list[str], list[str], list[Problem]]:
    """Return names and units of columns from their headings, and problems of unknown names."""
    names, units, problems = [], [], []
    for cell in cells:
        match = _HEADING.fullmatch(cell)
        name, unit = (match[1], match[2] or "") if match else (cell.strip(), "")
        if name not in PARAMETERS:
            fix = suggestion(name, PARAMETERS)
            problems.append(Problem("heading", f"'{name[:60]}' is not a parameter", fix))
        elif name in names:
            problems.append(Problem("heading", f"'{name}' stands there twice", "Remove one"))
        names.append(name)
        units.append(unit)
    return names, units, problems


def _column(
    name: str, unit: str, cells: list[str], decimal_commas: bool, problems: list[Problem]
) -> tuple[float, ...]:
    """Return the values of a column, in the unit of studies; NaN where a cell is wrong.

    `unit` is that of the heading, `decimal_commas` true if a comma is a decimal point; problems of
    cells are added to `problems`.
    """
    quantity, known, values = QUANTITIES[name], {}, []
    for number, cell in enumerate(cells, 1):
        if cell not in known:  # columns repeat values: a text with a unit takes long to read
            text = cell.replace(",", ".") if decimal_commas else cell
            text = text.strip()
            bare = not unit or not text or text[-1] not in "0123456789."
            try:
                known[cell] = read_number(name, quantity, text if bare else f"{text} {unit}")
            except UnitError as error:
                known[cell] = float("nan")
                place = f"row {number}, {name}"
                problems.append(Problem(place, error.message, error.fix))
        values.append(known[cell])
    return tuple(values)
