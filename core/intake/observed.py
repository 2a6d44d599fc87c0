"""The section `observations`: rows of a study, or of a CSV or XLSX file with a heading."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, Final, NoReturn

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.intake.section import (
    Content,
    Resolved,
    Section,
    Stranger,
    advice_on_path,
    dotted,
)
from vibrafeed.core.measured.marks import ONE_MARK
from vibrafeed.core.measured.read import name_and_unit
from vibrafeed.core.measured.table_cells import read_cells
from vibrafeed.core.quantities import letter_of
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.study.section_names import MAX_RUNS, OBSERVED
from vibrafeed.core.study.units import with_unit
from vibrafeed.core.system import installing

SUFFIXES = (".csv", ".xlsx")
OWN: Final = (*OBSERVED, "error", "regime")
"""Columns that are no parameters."""
_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?")
HEADING = (
    "Begin it with a line of names and units, such as amplitude [mm], conveying_velocity [mm/s]"
)


def beside(observations: Any, folder: Path) -> Any:
    """Return the section `observations`, a file's name in it joined to the study's folder."""
    return str(folder / observations) if isinstance(observations, str) else observations


def with_rows(content: Content, files: bool) -> Resolved:
    """Return the content of a study with the rows of its file of observations in place of the name.

    `files` is True if files of this machine may be read, which a service does not allow. Rows that
    stand in the study itself stay. Without a readable file the section is left out, and the result
    has the problems. The cells are checked later.
    """
    named = content["observations"]
    if not isinstance(named, str):
        return Resolved(content)
    try:
        if not files:
            _fail("the service reads no files", "Give its rows: a list of objects")
        return Resolved({**content, "observations": read_rows(Path(named))})
    except StudyError as error:
        rest = {name: value for name, value in content.items() if name != "observations"}
        return Resolved(rest, error.problems)


def read_rows(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a CSV or XLSX file of observations, each a mapping by column.

    Numbers get the unit in the heading of their column, as texts; empty cells are left out.

    Raises
    ------
    StudyError
        If the file cannot be read, or has no rows.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        _fail(f"'{path.name}' is not a CSV or XLSX file", "Save the table as CSV")
    try:
        lines = [*islice(_workbook(path) if suffix == ".xlsx" else _csv(path), MAX_RUNS + 2)]
    except (OSError, ValueError) as error:  # a NUL in its name is the second
        message = f"{path.name} cannot be read: {getattr(error, 'strerror', None) or error}"
        _fail(message, advice_on_path(path, "Name a CSV or XLSX file in the study's folder"))
    if len(lines) < 2:
        _fail(f"{path.name} has no rows", HEADING)
    names, units = _headings(lines[0], path)
    for number, line in enumerate(lines[1:], 1):
        if any(str(cell).strip() for cell in line[len(names) :]):
            message = f"row {number} of {path.name} has more cells than the heading"
            _fail(message, "Where a comma is a decimal comma, separate the cells by semicolons")
    return [
        {
            name: _value(cell, unit)
            for name, unit, cell in zip(names, units, [*line, *[""] * len(names)], strict=False)
            if name and str(cell).strip()
        }
        for line in lines[1:]
    ]


def _headings(cells: Iterable[Any], path: Path) -> tuple[list[str], list[str]]:
    """Return names and units of the columns of a file of observations.

    `cells` are those of the first line of the file at `path`; the unit is empty where a heading has
    none. Raises `StudyError` if the heading has a fault, such as a name given twice.
    """
    names, units = [], []
    for cell in cells:
        name, unit = name_and_unit(str(cell))
        names.append(letter_of(name))
        units.append(unit)
    twice = [name for k, name in enumerate(names) if name and name in names[:k]]
    if twice:
        _fail(f"{path.name} has two columns named {twice[0][:60]}", "Name each column once")
    if not any(names) or all(_NUMBER.fullmatch(name) for name in names):
        _fail(f"{path.name} has no heading", HEADING)
    return names, units


def _value(cell: Any, unit: str) -> Any:
    """Return a cell of a file as a study holds it: a number with its column's unit, or a text.

    `unit` is empty where the heading has none: the number is then in the unit of studies.
    """
    if isinstance(cell, int | float) and not isinstance(cell, bool):
        return f"{cell!r} {unit}" if unit else cell
    text = with_unit(str(cell), unit)
    return float(text) if _NUMBER.fullmatch(text) and "," not in text else text


def _csv(path: Path) -> Iterable[list[str]]:
    """Return the rows of a CSV file as lists of cells; raise `StudyError` where marks contradict.

    `path` is that of the file.
    """
    rows, faults = read_cells(path)
    for message in faults:
        _fail(f"{path.name}: {message}", ONE_MARK)
    return rows


def _workbook(path: Path) -> Iterable[list[Any]]:
    """Yield the rows of the first sheet of an Excel workbook, without empty rows.

    `path` is that of the file; empty cells are empty texts. Raises `StudyError` without openpyxl,
    and `ValueError` if the file is damaged.
    """
    try:
        import openpyxl
    except ImportError:
        fix = f"{installing('openpyxl')}, or save the table as CSV"
        _fail("reading XLSX needs openpyxl, which is not installed", fix)
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    except (OSError, ValueError):
        raise
    except Exception as error:  # what a damaged workbook raises is of many kinds
        raise ValueError(
            "the file of observations is not an XLSX workbook, or is damaged"
        ) from error
    try:
        for line in book.worksheets[0].iter_rows():
            cells = [_shown_cell(cell) for cell in line]
            if any(str(cell).strip() for cell in cells):
                yield cells
    finally:
        book.close()


def _shown_cell(cell: Any) -> Any:
    """Return the value of a cell of a workbook; as text if it is shown in per cent."""
    if cell.value is None:
        return ""
    if isinstance(cell.value, int | float) and "%" in str(cell.number_format):
        return f"{100 * cell.value:.15g} %"
    return cell.value


def _fail(message: str, fix: str) -> NoReturn:
    """Raise `StudyError` for a problem of the observations."""
    raise StudyError([Problem("observations", message, fix)])


def _names(rows: Any, known: Collection[str]) -> Iterable[str]:
    """Yield the parameters that the rows of observations give values of.

    They are all columns but the measured values, their error and the regime: parameters that some
    runs set individually. `rows` is the section as it was read; `known` is not used.
    """
    del known
    for row in rows if isinstance(rows, list | tuple) else ():
        if isinstance(row, Mapping):
            yield from (name for name in row if name not in OWN)


def _problem_path(path: Sequence[Any]) -> str:
    """Return the place of a problem as users read it, with rows counted from 1.

    `path` holds the section, the row from 0, and the column.
    """
    if len(path) < 2:
        return dotted(path)
    return f"observations row {int(path[1]) + 1}" + "".join(f", {name}"[:60] for name in path[2:3])


def _unknown_column(stranger: Stranger) -> Problem:
    """Return the problem of a column that is neither a parameter nor an observation."""
    known, shown = (*OWN, *PARAMETERS), (*OWN, *stranger.parameters)
    message = f"'{stranger.name}' is not a parameter, and not measured"
    return Problem(stranger.place, message, stranger.suggest(stranger.name, known, shown))


OBSERVATIONS: Final = Section(
    names=_names,
    outputs=lambda _: OBSERVED[:1],
    place=_problem_path,
    unknown=_unknown_column,
    beside=beside,
    resolve=with_rows,
)
"""The section `observations`."""
