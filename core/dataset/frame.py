"""A result as rows and columns: one row a cell, for spreadsheets, pandas, R and databases.

CSV has units in its headings, `frequency [Hz]`, as it has no other place for them, and as the CSV
files have that vibrafeed reads; Parquet has bare names, and units as metadata of the columns.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import Table, TableVariable, regime_counts
from vibrafeed.core.errors import LimitError, MissingPackageError
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.system import installing

CSV_ROWS: Final = 8192  # rows of a piece; other threads wait while the interpreter writes one
PARQUET_ROWS: Final = 131_072  # rows of a group in the file


@dataclass(frozen=True)
class Frame:
    """A table with one row a cell, cut into pieces as it is written.

    The columns are the axes, the fixed parameters, then the outputs; flags such as `regime` are
    words. What does not depend on an axis is repeated along it.

    Attributes
    ----------
    table : Table
        What it shows.
    sizes : mapping of str to int
        Length of each dimension; the last one runs fastest.
    """

    table: Table
    sizes: Mapping[str, int]

    @classmethod
    def of(cls, table: Table, *, most: int | None = None) -> Frame:
        """Return the rows of a table, one for each cell, to be written as CSV, Parquet or Excel.

        Raises `LimitError` if there are more than `most` rows; None allows any number.
        """
        columns = (*table.coordinates.values(), *table.variables.values())
        sizes: dict[str, int] = {}
        for column in columns:
            sizes |= dict(zip(column.dims, column.values.shape, strict=True))
        check_rows(sizes, most)
        # In the order of the axes, whatever the order within a variable.
        order = [name for name in (*table.coordinates, *sizes) if name in sizes]
        sizes = {name: sizes[name] for name in dict.fromkeys(order)}
        return cls(table, sizes)

    @property
    def rows(self) -> int:
        """The number of rows without the heading."""
        return math.prod(self.sizes.values())

    @property
    def note(self) -> str:
        """Sentences for the file on the cells whose regime does not describe a real part.

        Each has their number and the names of their regimes; it is empty if there are none.
        """
        sentences = []
        for name, regime in self.table.variables.items():
            if not is_regime(name) or "flag_values" not in regime.attributes:
                continue
            counts = regime_counts(regime.values)
            beyond = {one: count for one, count in counts.items() if not REGIMES[one].valid}
            if beyond:
                share = f"{sum(beyond.values()):,} of {regime.values.size:,} cells"
                told = f"{share} do not describe a real part: {name} {', '.join(beyond)}"
                sentences.append(told)
        return "; ".join(sentences)

    @property
    def about(self) -> dict[str, Any]:
        """The attributes of the table, with cost and notes."""
        note = {"note": self.note} if self.note else {}
        return {**self.table.attributes, **self.table.price, **note}

    def csv(self) -> Iterator[bytes]:
        """Yield a CSV file (RFC 4180) of the table, as UTF-8 bytes of `CSV_ROWS` rows at a time.

        The first row has the column names with units, the others one cell of the result each.
        Numbers have all their digits; NaN gives an empty field.
        """
        yield ",".join(map(_quote_field, map(heading, self.columns))).encode() + b"\r\n"
        # What is repeated is put into words once.
        texts = [
            FrameColumn(c.name, c.variable, _texts(c.values)) if c.values.size < self.rows else c
            for c in self.columns
        ]
        for start in range(0, self.rows, CSV_ROWS):
            pieces = (self.piece(column, start, CSV_ROWS) for column in texts)
            words = [
                (piece if piece.dtype == object else _texts(piece)).tolist() for piece in pieces
            ]
            yield ("\r\n".join(map(",".join, zip(*words, strict=True))) + "\r\n").encode()

    def parquet(self) -> Iterator[bytes]:
        """Yield the pieces of a Parquet file.

        Units, labels and descriptions are metadata of the columns; the attributes of the table,
        such as the study and its hash, are metadata of the schema.

        Raises
        ------
        MissingPackageError
            If pyarrow is not installed; before the first piece.
        """
        return _parquet(self)

    @cached_property
    def columns(self) -> list[FrameColumn]:
        """The columns of the frame: first the coordinates of the table, then its variables."""
        return [
            FrameColumn(name, variable)
            for name, variable in (*self.table.coordinates.items(), *self.table.variables.items())
        ]

    def piece(self, column: FrameColumn, start: int, rows: int) -> NDArray[Any]:
        """Return the values of a column in `rows` rows from row `start` on; fewer at the end.

        Values that do not depend on an axis are repeated along it; rows count from 0 and the last
        axis runs fastest.
        """
        own = column.variable.dims
        order = [own.index(dim) for dim in self.sizes if dim in own]
        shape = [size if dim in own else 1 for dim, size in self.sizes.items()]
        values = column.values.transpose(order).reshape(shape)
        whole = np.broadcast_to(values, tuple(self.sizes.values()))
        piece: NDArray[Any] = whole.flat[start : start + rows]
        return piece


def check_rows(sizes: Mapping[str, int], most: int | None) -> None:
    """Raise `LimitError` if a table has more than `most` rows; None allows any number.

    `sizes` are the lengths of its dimensions, whose product is the number of rows.
    """
    rows = math.prod(sizes.values())
    if most is not None and rows > most:
        fix = "Take the NetCDF file, or Zarr, or slices over fewer axes"
        raise LimitError("rows", rows, most, fix)


def pyarrow() -> Any:
    """Return the package pyarrow; raise `MissingPackageError` if it is not installed."""
    try:
        import pyarrow.parquet
    except ImportError:
        raise MissingPackageError("Parquet", "pyarrow", installing("pyarrow", "tables")) from None
    return pyarrow


@dataclass(frozen=True)
class FrameColumn:
    """A variable with its name."""

    name: str
    variable: TableVariable
    texts: NDArray[Any] | None = field(default=None)

    @cached_property
    def words(self) -> list[str]:
        """The words of a flag's values; empty for other columns."""
        return str(self.variable.attributes.get("flag_meanings", "")).split()

    @cached_property
    def values(self) -> NDArray[Any]:
        """The values of the column as they are shown, in the shape of the table's variable.

        These are its numbers or texts; for a flag the name of each integer value, empty where a
        value has no name.
        """
        if self.texts is not None:
            return self.texts
        if not self.words:
            return self.variable.values
        # Of a flag without dimension an index would take a word out of its array.
        return np.asarray(np.array([*self.words, ""], dtype=object)[self.codes], dtype=object)

    @cached_property
    def codes(self) -> NDArray[np.int8]:
        """The index of each flag value's word; one beyond the last word for an unknown value.

        An array of int8 in the shape of the values.
        """
        known = np.asarray(self.variable.attributes["flag_values"])
        found = np.full(256, known.size, dtype=np.int8)
        found[known.astype(np.uint8)] = np.arange(known.size)
        return np.asarray(found[self.variable.values.astype(np.uint8)])


def heading(column: FrameColumn) -> str:
    """Return the name of a column, with its unit in brackets."""
    unit = column.variable.attributes.get("units", "1")
    return column.name if unit in ("", "1") else f"{column.name} [{unit}]"


def _texts(values: NDArray[Any]) -> NDArray[Any]:
    """Return values as texts of CSV fields, in the same shape; numbers with all digits.

    Texts are quoted where necessary, and NaN becomes an empty field.
    """
    flat = values.reshape(-1)
    write: Callable[[Any], str] = repr
    if flat.dtype == object:
        write = _quote_field
    elif flat.dtype.kind == "f" and np.isnan(flat).any():
        write = _number
    found = np.empty(flat.size, dtype=object)
    found[:] = list(map(write, flat.tolist()))
    return found.reshape(values.shape)


def _number(value: float) -> str:
    """Return a number with the fewest exact digits; empty for NaN."""
    return repr(value) if value == value else ""


def _quote_field(text: object) -> str:
    """Return a text as a CSV field, quoted if necessary."""
    told = str(text)
    return '"' + told.replace('"', '""') + '"' if set(told) & set(',"\r\n') else told


class _Sink:
    """A file in memory from which the bytes written so far can be taken, piece by piece."""

    closed = False

    def __init__(self) -> None:
        """Begin with no bytes."""
        self.pieces: list[bytes] = []
        self._size = 0

    def write(self, piece: Any) -> int:
        """Append bytes; return their number."""
        self.pieces.append(bytes(piece))
        self._size += len(self.pieces[-1])
        return len(self.pieces[-1])

    def tell(self) -> int:
        """Return the number of bytes written so far."""
        return self._size

    def flush(self) -> None:
        """Do nothing: the bytes are in memory."""
        pass

    def close(self) -> None:
        """Do nothing: the bytes stay until they are taken."""
        pass

    def taken(self) -> bytes:
        """Return the bytes written since the last call."""
        pieces, self.pieces = self.pieces, []
        return b"".join(pieces)


def _parquet(frame: Frame) -> Iterator[bytes]:
    """Return the pieces of a Parquet file; fails at once without pyarrow."""
    arrow = pyarrow()  # now, not when the first piece is asked for
    return _parquet_pieces(arrow, frame)


def _parquet_pieces(arrow: Any, frame: Frame) -> Iterator[bytes]:
    """Yield the bytes of a Parquet file in pieces, each a group of rows; the last ends the file.

    `arrow` is the package pyarrow.
    """
    columns = frame.columns
    schema = arrow.schema(
        [
            arrow.field(c.name, _type(arrow, c), metadata=_metadata(c.variable.attributes))
            for c in columns
        ],
        metadata=_metadata(frame.about),
    )
    sink = _Sink()
    with arrow.parquet.ParquetWriter(arrow.PythonFile(sink, "w"), schema) as writer:
        for start in range(0, frame.rows, PARQUET_ROWS):
            arrays = [_array(arrow, frame, column, start) for column in columns]
            writer.write_batch(arrow.record_batch(arrays, schema=schema))
            yield sink.taken()
    yield sink.taken()


def _type(arrow: Any, column: FrameColumn) -> Any:
    """Return the type of a table column in Apache Arrow, for a Parquet or Feather file.

    `arrow` is the package pyarrow, which is only loaded when needed; `column` is the column. Flags
    become dictionary-encoded texts, texts strings, and numbers keep their type in native byte
    order.
    """
    if column.words:
        return arrow.dictionary(arrow.int8(), arrow.string())
    dtype = column.variable.values.dtype
    if dtype.kind == "O":
        return arrow.string()
    return arrow.from_numpy_dtype(dtype.newbyteorder("="))


def _array(arrow: Any, frame: Frame, column: FrameColumn, start: int) -> Any:
    """Return a group of rows of a column, from row `start` on, as an Arrow array for Parquet.

    Flags become words; unknown ones are null. Numbers keep NaN. `arrow` is the package pyarrow.
    """
    if not column.words:
        piece = frame.piece(column, start, PARQUET_ROWS)
        piece = piece.astype(piece.dtype.newbyteorder("="), copy=False)
        return arrow.array(piece, type=_type(arrow, column))
    codes = frame.piece(
        FrameColumn(column.name, column.variable, column.codes), start, PARQUET_ROWS
    )
    indices = arrow.array(codes, mask=codes == len(column.words))
    return arrow.DictionaryArray.from_arrays(indices, column.words)


def _metadata(attributes: Mapping[str, Any]) -> dict[str, str]:
    """Return attributes as texts, without those that describe flags."""
    return {n: str(v) for n, v in attributes.items() if not n.startswith("flag_")}
