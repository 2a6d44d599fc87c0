"""A table that was read: columns by name, as numbers, as times, or as rows of a study."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, raise_any, refused
from vibrafeed.core.study.units import BARE_NUMBER, with_unit
from vibrafeed.core.suggestions import suggestion
from vibrafeed.core.tables.text import is_clock, number_and_unit, seconds_of

SEMICOLONS = "Where a comma is a decimal comma, separate the cells by semicolons"


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes
    ----------
    cells : sequence of str, or ndarray
        Texts as written, or the numbers of a file that holds numbers.
    unit : str
        What the heading or the file says; empty if it says nothing.
    fault, fix : str
        Why the column cannot be read, and what to do; empty if it can.
    """

    cells: Sequence[str] | NDArray[np.float64]
    unit: str = ""
    fault: str = ""
    fix: str = ""


@dataclass(frozen=True)
class InputTable:
    """Columns of equal length, by name.

    Attributes
    ----------
    columns : mapping of str to Column
    lines : ndarray
        The line of the file on which each row stands, or its number.
    section : str
        Where a study names the table, such as "observations".
    commas : bool
        True if a comma is a decimal mark.
    note : str
        The text above the names of the columns.
    step : float
        Time between two rows [s], if the file says it; else 0.
    """

    columns: Mapping[str, Column]
    lines: NDArray[np.int64]
    section: str = "recording"
    commas: bool = False
    note: str = ""
    step: float = 0.0

    def column(self, name: str, path: str) -> Column:
        """Return a column that can be read; raise `StudyError` if there is none of that name.

        `path` is the section in the study where the column is named, for the messages.
        """
        column = self.columns.get(name)
        if column is None:
            message = f"the table has no column '{name[:60]}'"
            fix = suggestion(name, self.columns)
            if all(map(str.isdigit, self.columns)):
                fix = f"The columns have no names: give a number from 1 to {len(self.columns)}"
            raise refused(path, message, fix, name)
        if column.fault:
            raise refused(path, column.fault, column.fix, name)
        return column

    def is_faulty(self, name: str) -> bool:
        """True if a column holds no number and no time at all."""
        return not np.isfinite(self._values(self.columns[name])).any()

    def numbers(self, name: str, path: str) -> tuple[NDArray[np.float64], str]:
        """Return the numbers of a column and their unit; dates and times become seconds.

        Raises `StudyError` if the table has no such column, or if cells are no finite numbers.
        """
        column = self.column(name, path)
        values = self._values(column)
        unit = "s" if len(values) and is_clock(str(column.cells[0])) else column.unit
        not_numbers = np.flatnonzero(~np.isfinite(values)).tolist()
        if not_numbers:
            cell = str(column.cells[not_numbers[0]]).strip()[:40]
            count_in_words = f" ({len(not_numbers):,} such cells)" if len(not_numbers) > 1 else ""
            message = (
                f"line {self.lines[not_numbers[0]]} of column '{name}' is not a number: {cell!r}"
            )
            fix = SEMICOLONS if "," in cell else "Correct or remove the line"
            raise refused(path, message + count_in_words, fix, name)
        return values, unit

    def rows(self) -> list[dict[str, Any]]:
        """Return the rows, each a mapping by column, without the empty cells.

        Numbers get the unit of their column, as texts. Raises `StudyError` if a column has a fault.
        """
        raise_any(
            Problem(self.section, column.fault, column.fix)
            for column in self.columns.values()
            if column.fault
        )
        columns = {
            name: [self._value(cell, column.unit) for cell in column.cells]
            for name, column in self.columns.items()
        }
        rows_of_cells = zip(*columns.values(), strict=True)
        rows = [dict(zip(columns, cells, strict=True)) for cells in rows_of_cells]
        return [{name: cell for name, cell in row.items() if cell != ""} for row in rows]

    def _value(self, cell: Any, unit: str) -> Any:
        if not isinstance(cell, str):
            return f"{cell!r} {unit}" if unit else float(cell)
        number_and_rest = number_and_unit(cell)
        if number_and_rest and self.commas:
            cell = number_and_rest[0].replace(",", ".") + number_and_rest[1]
        text = with_unit(cell, unit)
        return float(text) if BARE_NUMBER.fullmatch(text) and "," not in text else text

    def _values(self, column: Column) -> NDArray[np.float64]:
        # Numbers, or seconds if all cells are times; NaN for any other cell.
        cells = column.cells
        if isinstance(cells, np.ndarray):
            return cells.astype(np.float64)
        texts = [cell.replace(",", ".") for cell in cells] if self.commas else cells
        try:
            return np.fromiter(map(float, texts), np.float64, len(texts))
        except ValueError:
            seconds = seconds_of(cells) if all(map(is_clock, cells)) else None
        return np.array(seconds or [_number(text) for text in texts], np.float64)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan
