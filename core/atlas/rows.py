"""Rows of parameters from a CSV file: a heading such as ``amplitude [mm]``, and numbers below."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.measured.marks import ONE_MARK
from vibrafeed.core.measured.read import name_and_unit
from vibrafeed.core.measured.table_cells import read_cells
from vibrafeed.core.quantities import QUANTITIES, letter_of
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.study.units import UnitError, read_number, with_unit
from vibrafeed.core.suggestions import suggestion

MAX_ROWS: Final = 2_000_000  # rows of a file
MAX_REPORTED: Final = 20  # problems of cells that are listed at most


def read_rows(path: Path) -> Mapping[str, tuple[float, ...]]:
    """Return the parameters of parts and drives in a CSV file, one row each, by parameter name.

    The first row has the parameter names with units. The separator is a comma, a semicolon or a
    tab; with the last two, a comma is a decimal comma. A cell may have a unit of its own, as in a
    study, in place of the heading's. Values of the result are in the units of studies, one a row.

    Raises
    ------
    StudyError
        With every problem of headings and cells.
    OSError
        If the file cannot be read.
    """
    heading, body = _cells(path)
    names, units, problems = _headings(heading)
    problems += [
        Problem(f"row {number}",
                f"row {number} of the CSV file has {len(row)} cells, but its heading has "
                f"{len(heading)}",
                "Give the row one cell for each column")
        for number, row in enumerate(body, 1)
        if len(row) != len(heading)
    ][:MAX_REPORTED]  # fmt: skip
    if problems:
        raise StudyError(problems)
    columns = {
        name: _column(name, unit, [row[k] for row in body], problems)
        for k, (name, unit) in enumerate(zip(names, units, strict=True))
    }
    if problems:
        raise StudyError(problems[:MAX_REPORTED])
    return columns


def _cells(path: Path) -> tuple[list[str], list[list[str]]]:
    """Return the texts of a CSV file: cells of the heading, and cells of each row.

    Empty rows are left out; rows may differ in length.

    Raises
    ------
    StudyError
        If `path` is no text, has no rows below the heading or more than `MAX_ROWS`, or contradicts
        itself in its decimal marks.
    """
    try:
        rows, faults = read_cells(path)
    except ValueError as error:
        fix = "Save the file in the encoding UTF-8"
        raise StudyError([Problem("rows", f"the CSV file cannot be read: {error}", fix)]) from None
    if faults:
        raise StudyError([Problem("rows", message, ONE_MARK) for message in faults])
    heading, *body = rows or [[]]
    if not body or len(body) > MAX_ROWS:
        message = f"it has {len(body):,} rows of values" if body else "it holds no rows of values"
        fix = f"Give names of parameters on top, and 1 to {MAX_ROWS:,} rows below"
        raise StudyError([Problem("rows", message, fix)])
    return heading, body


def _headings(cells: list[str]) -> tuple[list[str], list[str], list[Problem]]:
    """Return names and units of the columns of a CSV file, and the problems of their headings.

    `cells` are the headings as texts, such as `amplitude [mm]` or `beta (deg)`: a parameter and
    optionally its unit. Names and units come in the order of the columns, the unit "" without one;
    a name that is no parameter or occurs twice is a problem.
    """
    names, units, problems = [], [], []
    for cell in cells:
        name, unit = name_and_unit(cell)
        name = letter_of(name)
        if name not in PARAMETERS:
            fix = suggestion(name, PARAMETERS)
            problems.append(Problem("heading", f"'{name[:60]}' is not a parameter", fix))
        elif name in names:
            problems.append(Problem("heading", f"'{name}' stands there twice", "Remove one"))
        names.append(name)
        units.append(unit)
    return names, units, problems


def _column(name: str, unit: str, cells: list[str], problems: list[Problem]) -> tuple[float, ...]:
    """Return the numbers of one column of a CSV file in the unit of studies; NaN for wrong cells.

    Parameters
    ----------
    name : str
        The parameter of the column.
    unit : str
        Unit of its heading, for cells that have none of their own; "" without.
    cells : list of str
        The texts below the heading.
    problems : list of Problem
        A problem is added for each text that cannot be read; it names the column and the first row
        with this text, counted from 1 below the heading. Rows that repeat it add none.
    """
    quantity, known, values = QUANTITIES[name], {}, []
    for number, cell in enumerate(cells, 1):
        if cell not in known:  # columns repeat values: a text with a unit takes long to read
            try:
                known[cell] = read_number(name, quantity, with_unit(cell, unit))
            except UnitError as error:
                known[cell] = float("nan")
                place = f"row {number}, {name}"
                problems.append(Problem(place, error.message, error.fix))
        values.append(known[cell])
    return tuple(values)
