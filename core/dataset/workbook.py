"""A result as a workbook of Excel: its rows, the meaning of its columns, and its study."""

import math
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from typing import Any, Final

from vibrafeed.core.dataset.frame import Frame, finished, heading
from vibrafeed.core.dataset.limits import Size, check_limit
from vibrafeed.core.dataset.table import TableVariable

MAX_ROWS: Final = 2**20 - 1  # that a sheet of Excel has under its headings
MAX_COLUMNS: Final = 2**14
ROWS: Final = 1024  # rows that are added at a time; writing can be stopped in between
LONGEST: Final = 32_767 // 2  # characters that surely fit into a cell of Excel
# Equal results are equal files, so that what was fetched before need not be fetched again.
CREATED: Final = datetime(1980, 1, 1)

Row = Iterable[Any]


def check(size: Size) -> None:
    """Raise `LimitError` if an Excel sheet cannot hold the rows or columns of a result."""
    others = "Write CSV, Parquet or NetCDF, or fewer"
    check_limit("rows in a sheet of Excel", size.rows, MAX_ROWS, f"{others} values on an axis")
    check_limit("columns in a sheet of Excel", size.columns, MAX_COLUMNS, f"{others} outputs")


def xlsx(frame: Frame) -> Iterator[bytes]:
    """Yield the bytes of a workbook in pieces; pieces are empty while rows are added.

    Its sheets are `values`, axes and outputs, with headings as in CSV; `constants`, the parameters
    that have one value; `columns`, with units and descriptions; and `study`, with the attributes of
    the table. NaN is an empty cell; an infinite number is a text, since Excel has none.

    Raises
    ------
    LimitError
        If there are more rows or columns than a sheet has; before the first piece.
    """
    check(Size(frame.rows, len(frame.columns)))
    return _pieces(frame)


def _pieces(frame: Frame) -> Iterator[bytes]:
    import xlsxwriter  # heavy, and few results are workbooks

    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as file:
        options = {
            "constant_memory": True,
            "tmpdir": folder,
            "strings_to_formulas": False,
            "strings_to_urls": False,
            "use_zip64": True,
        }
        with xlsxwriter.Workbook(file, options) as book:
            book.set_properties({"created": CREATED})
            for title, (widths, rows) in _sheets(frame).items():
                sheet = book.add_worksheet(title)
                sheet.freeze_panes(1, 0)
                for number, width in enumerate(widths):
                    sheet.set_column(number, number, width)
                for number, row in enumerate(rows):
                    sheet.write_row(number, 0, map(_cell, row))
                    if number % ROWS == 0:
                        yield b""
        yield from finished(file)


def _sheets(frame: Frame) -> dict[str, tuple[list[int], Iterable[Row]]]:
    """Return the widths of the columns and the rows of each sheet by its title."""
    constant_names = {name for name, column in frame.table.coordinates.items() if not column.dims}
    varying = {name: column for name, column in frame.columns.items() if name not in constant_names}
    constants = {name: column for name, column in frame.columns.items() if name in constant_names}
    widths = [max(10, len(heading(name, column)) + 2) for name, column in varying.items()]
    return {
        "values": (widths, _values(frame, varying)),
        "constants": ([30, 24, 12, 40], _constants(frame, constants)),
        "columns": ([30, 12, 10, 40, 100, 30], _columns(frame.columns)),
        "study": ([24, 120], _study(frame.about)),
    }


def _values(frame: Frame, shown: Mapping[str, TableVariable]) -> Iterator[Row]:
    yield [heading(name, column) for name, column in shown.items()]
    for piece in frame.pieces(ROWS):
        yield from zip(*(piece[name].tolist() for name in shown), strict=True)


def _constants(frame: Frame, constants: Mapping[str, TableVariable]) -> Iterator[Row]:
    yield "name", "value", "unit", "label"
    first = next(frame.pieces(1))
    for name, column in constants.items():
        yield name, *first[name].tolist(), *_texts(column, "units", "long_name")


def _columns(columns: Mapping[str, TableVariable]) -> Iterator[Row]:
    yield "name", "unit", "symbol", "label", "description", "depends on"
    for name, column in columns.items():
        texts = _texts(column, "units", "symbol", "long_name", "comment")
        yield name, *texts, ", ".join(column.dims)


def _texts(column: TableVariable, *attributes: str) -> list[str]:
    return [str(column.attributes.get(name, "")) for name in attributes]


def _study(about: Mapping[str, Any]) -> Iterator[Row]:
    yield "attribute", "value"
    for name, value in about.items():
        if isinstance(value, int | float):
            yield name, value
            continue
        text = str(value)
        for start in range(0, max(1, len(text)), LONGEST):
            yield name, text[start : start + LONGEST]


def _cell(value: Any) -> Any:
    if not isinstance(value, float):
        return value
    if not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return _Number(value)


class _Number(float):
    """A number that XlsxWriter writes with all its digits, not with 16."""

    def __format__(self, _: str) -> str:
        return repr(float(self))
