"""A result as a workbook of Excel: its rows, what its columns mean, and its study."""

from __future__ import annotations

import contextlib
import math
import re
import shutil
import tempfile
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any, Final
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.frame import Frame, FrameColumn, heading
from vibrafeed.core.errors import LimitError, MissingPackageError
from vibrafeed.core.system import installing

MAX_ROWS: Final = 2**20 - 1  # that a sheet of Excel has under its headings
ROWS: Final = 1024  # rows that are added at a time; writing can be stopped in between
PIECE: Final = 2**20  # bytes of the finished file that are handed on at a time
LONGEST: Final = 32_767  # characters of a cell of Excel
# Equal results are equal files, so that what was fetched before need not be fetched again.
NEVER: Final = datetime(1980, 1, 1)  # the first day that a ZIP file can name
_CONTROL: Final = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f]")  # no XML holds them


def openpyxl() -> Any:
    """Return the package openpyxl; raise `MissingPackageError` if it is not installed."""
    try:
        import openpyxl
    except ImportError:
        raise MissingPackageError("XLSX", "openpyxl", installing("openpyxl")) from None
    return openpyxl


def check_rows_of_sheet(rows: int) -> None:
    """Raise `LimitError` if an Excel sheet cannot hold this many rows."""
    if rows > MAX_ROWS:
        fix = "Write CSV, Parquet or NetCDF, or fewer values on an axis"
        raise LimitError("rows in a sheet of Excel", rows, MAX_ROWS, fix)


def xlsx(frame: Frame) -> Iterator[bytes]:
    """Yield the bytes of a workbook in pieces; pieces are empty while rows are added.

    Its sheets are `values`, axes and outputs, with headings as in CSV; `constants`, the parameters
    that have one value; `columns`, with units and descriptions; and `study`, with the attributes of
    the table. NaN is an empty cell; an infinite number is a text, since Excel has none.

    Raises
    ------
    MissingPackageError
        If openpyxl is not installed; before the first piece.
    LimitError
        If there are more rows than a sheet has; before the first piece.
    """
    library = openpyxl()
    check_rows_of_sheet(frame.rows)
    return _pieces(library, frame)


def _pieces(library: Any, frame: Frame) -> Iterator[bytes]:
    """Yield the bytes of an Excel workbook; the first pieces are empty, while rows are added.

    The empty ones let a caller stop between rows. `library` is the package openpyxl; temporary
    files are removed at the end or when the generator is closed.
    """
    from openpyxl.writer.excel import ExcelWriter

    book = library.Workbook(write_only=True)
    book.properties.created = book.properties.modified = NEVER
    try:
        for _ in _add_values(book, frame):
            yield b""
        _add_constants(book, frame)
        _add_columns(book, frame)
        _add_study(book, frame)
        with tempfile.TemporaryFile() as file:
            ExcelWriter(book, _Archive(file, "w", ZIP_DEFLATED)).save()
            file.seek(0)
            while piece := file.read(PIECE):
                yield piece
    finally:
        _remove_rests(book)


def _add_values(book: Any, frame: Frame) -> Iterator[None]:
    """Add the sheet `values` with the rows to a workbook, yielding after every 1,024 rows.

    The pauses let a caller stop. Constant parameters have a sheet of their own. `book` is a
    workbook of openpyxl.
    """
    shown = [column for column in frame.columns if not _is_constant(frame, column)]
    headings = [heading(column) for column in shown]
    sheet = _sheet(book, "values", [max(10, len(text) + 2) for text in headings])
    sheet.append(headings)
    for start in range(0, frame.rows, ROWS):
        columns = [_cells(sheet, frame.piece(one, start, ROWS)) for one in shown]
        for row in zip(*columns, strict=True):
            sheet.append(row)
        yield


def _is_constant(frame: Frame, column: FrameColumn) -> bool:
    """True if a column is a parameter with a single value, which has its own sheet."""
    return column.name in frame.table.coordinates and not column.variable.dims


def _add_constants(book: Any, frame: Frame) -> None:
    """Add the sheet of the constant parameters to a workbook: name, value, unit, label.

    `book` is a workbook of openpyxl, `frame` the result.
    """
    sheet = _sheet(book, "constants", [30, 24, 12, 40])
    sheet.append(["name", "value", "unit", "label"])
    for column in frame.columns:
        if _is_constant(frame, column):
            told = column.variable.attributes
            (value,) = _cells(sheet, np.ravel(column.values))
            texts = [_text(sheet, str(told.get(key, ""))) for key in ("units", "long_name")]
            sheet.append([column.name, value, *texts])


def _add_columns(book: Any, frame: Frame) -> None:
    """Add the sheet that describes the columns to a workbook: unit, symbol, label, dimensions.

    `book` is a workbook of openpyxl, `frame` the result.
    """
    sheet = _sheet(book, "columns", [30, 12, 10, 40, 100, 30])
    sheet.append(["name", "unit", "symbol", "label", "description", "depends on"])
    for column in frame.columns:
        told = column.variable.attributes
        texts = [str(told.get(key, "")) for key in ("units", "symbol", "long_name", "comment")]
        dims = _dims(column)
        sheet.append([_text(sheet, text) for text in (column.name, *texts, dims)])


def _dims(column: FrameColumn) -> str:
    """Return the dimensions of a column as text."""
    return ", ".join(column.variable.dims)


def _add_study(book: Any, frame: Frame) -> None:
    """Add a sheet with the attributes of a result, the study among them, to an Excel workbook.

    `book` is the openpyxl workbook; `frame` has the attributes (`about`), one row each. Texts too
    long for a cell continue in the rows below.
    """
    sheet = _sheet(book, "study", [24, 120])
    sheet.append(["attribute", "value"])
    for name, value in frame.about.items():
        if isinstance(value, int | float):
            sheet.append([name, value])
            continue
        text = str(value)
        for start in range(0, max(1, len(text)), LONGEST):
            sheet.append([name, _text(sheet, text[start : start + LONGEST])])


def _sheet(book: Any, title: str, widths: list[int]) -> Any:
    """Return a new sheet of an openpyxl workbook, with column widths and the first row fixed.

    `widths` are in characters, one for each column from the first on.
    """
    sheet = book.create_sheet(title)
    sheet.freeze_panes = "A2"
    for number, width in enumerate(widths, 1):
        sheet.column_dimensions[openpyxl().utils.get_column_letter(number)].width = width
    return sheet


def _cells(sheet: Any, values: NDArray[Any]) -> list[Any]:
    """Return an array of values as cells of a sheet, as openpyxl takes them.

    Texts are never formulas, numbers have all digits, NaN is None (an empty cell).
    """
    if values.dtype == object:
        return [_text(sheet, str(value)) for value in values.tolist()]
    if values.dtype.kind == "f":
        return [_number(sheet, value) for value in values.tolist()]
    return values.tolist()


def _number(sheet: Any, value: float) -> Any:
    """Return a number as a cell of an Excel sheet (`sheet`) with all its digits.

    openpyxl alone would write 16 digits. NaN becomes None, an empty cell; an infinite `value`
    becomes a text, as Excel has none.
    """
    if not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    if float(f"{value:.16g}") == value:
        return value
    return _cell(sheet, repr(value), "n")


def _text(sheet: Any, text: str) -> Any:
    """Return a text as a cell of an Excel sheet that is never interpreted as a formula or an error.

    `sheet` is the openpyxl sheet of the cell. Texts that begin with "=" or "#" become cells of text
    type; others are returned as they are, and an empty one as None. Control characters, which Excel
    cannot hold, are removed.
    """
    if not text:
        return None
    text = _CONTROL.sub("", text)
    return _cell(sheet, text, "s") if text[:1] in ("=", "#") else text


def _cell(sheet: Any, text: str, kind: str) -> Any:
    """Return a cell with a text and a type of openpyxl, `n` for a number or `s` for a text."""
    cell = openpyxl().cell.WriteOnlyCell(sheet, value=text)
    cell.data_type = kind
    return cell


class _Archive(ZipFile):
    """A ZIP file without the time at which it was made, so that equal contents give equal bytes."""

    def writestr(self, name: Any, data: Any, *others: Any) -> None:
        """Write data into the archive without a date."""
        super().writestr(_dateless_entry(name), data, *others)

    def write(self, filename: Any, arcname: Any = None, *others: Any) -> None:
        """Write a file into the archive without a date, so that equal contents give equal bytes.

        `filename` is the path of the file, `arcname` its name in the archive; further arguments of
        `ZipFile.write` are ignored.
        """
        with (
            Path(filename).open("rb") as source,
            self.open(_dateless_entry(str(arcname)), "w", force_zip64=True) as entry,
        ):
            shutil.copyfileobj(source, entry)


def _dateless_entry(name: str) -> ZipInfo:
    """Return the archive entry of a file, with the fixed date 1980-01-01."""
    info = ZipInfo(name, NEVER.timetuple()[:6])
    info.compress_type = ZIP_DEFLATED
    return info


def _remove_rests(book: Any) -> None:
    """Remove the temporary files of a workbook's sheets, whether it was saved or not.

    openpyxl leaves them behind when writing is broken off. `book` is the workbook.
    """
    for sheet in book.worksheets:
        writer = sheet._writer
        if writer is None:
            continue
        with contextlib.suppress(Exception):  # it was saved, or its rows were left half-way
            sheet.close()
        with contextlib.suppress(OSError, ValueError):
            writer.cleanup()
