"""A result as rows and columns: one row a cell, for spreadsheets, pandas, R and databases.

CSV has units in its headings, `frequency [Hz]`, as it has no other place for them, and as the CSV
files have that vibrafeed reads; Parquet has bare names, and units as metadata of the columns.
"""

import math
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import IO, TYPE_CHECKING, Any, Final

import numpy as np

from vibrafeed.core.dataset.files import CsvStyle
from vibrafeed.core.dataset.limits import check_limit
from vibrafeed.core.dataset.table import Table, TableVariable, regime_counts
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.flags import is_regime

if TYPE_CHECKING:
    import pandas

CSV_ROWS: Final = 8192  # rows of a piece; other threads wait while the interpreter writes one
PARQUET_ROWS: Final = 131_072  # rows of a group in the file
PIECE: Final = 2**20  # bytes of a finished file that are handed on at a time


@dataclass(frozen=True)
class Frame:
    """A table with one row a cell, cut into pieces as it is written.

    The columns are the axes, the fixed parameters, then the outputs; flags such as `regime` are
    words. A value that does not depend on an axis is repeated along it.

    Attributes
    ----------
    table : Table
        The result.
    sizes : mapping of str to int
        Length of each dimension; the last one runs fastest.
    """

    table: Table
    sizes: Mapping[str, int]

    @classmethod
    def of(cls, table: Table, *, most: int | None = None) -> "Frame":
        """Return the rows of a table, one for each cell, to be written as CSV, Parquet or Excel.

        Raises `LimitError` if there are more than `most` rows; None allows any number.
        """
        sizes = {
            dim: size
            for column in (*table.coordinates.values(), *table.variables.values())
            for dim, size in zip(column.dims, column.values.shape, strict=True)
        }
        check_rows(sizes, most)
        # In the order of the axes, whatever the order within a variable.
        order = [name for name in (*table.coordinates, *sizes) if name in sizes]
        return cls(table, {name: sizes[name] for name in order})

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
            invalid = {
                regime_name: count
                for regime_name, count in counts.items()
                if not REGIMES[regime_name].valid
            }
            if invalid:
                cells = f"{sum(invalid.values()):,} of {regime.values.size:,} cells"
                sentences.append(
                    f"{cells} do not describe a real part: {name} {', '.join(invalid)}"
                )
        return "; ".join(sentences)

    @property
    def about(self) -> dict[str, Any]:
        """The attributes of the table, with cost and notes."""
        note = {"note": self.note} if self.note else {}
        return {**self.table.attributes, **self.table.price, **note}

    @cached_property
    def columns(self) -> dict[str, TableVariable]:
        """The columns by name: first the coordinates of the table, then its variables."""
        return {**self.table.coordinates, **self.table.variables}

    @property
    def headings(self) -> list[str]:
        """The names of the columns with their units."""
        return [heading(name, column) for name, column in self.columns.items()]

    def pieces(self, rows: int) -> "Iterator[pandas.DataFrame]":
        """Yield the rows as data frames of pandas, so many at a time; flags are categories."""
        import pandas  # heavy, and NetCDF and Zarr do without it

        for start in range(0, self.rows, rows):
            yield pandas.DataFrame(
                {name: self._cells(column, start, rows) for name, column in self.columns.items()}
            )

    def _cells(self, column: TableVariable, start: int, rows: int) -> Any:
        # Some rows of a column that is broadcast over all dimensions; flags become their names.
        import pandas

        order = [column.dims.index(dim) for dim in self.sizes if dim in column.dims]
        shape = [size if dim in column.dims else 1 for dim, size in self.sizes.items()]
        values = column.values.transpose(order).reshape(shape)
        cells = np.broadcast_to(values, tuple(self.sizes.values())).flat[start : start + rows]
        if "flag_values" not in column.attributes:
            return cells
        codes = pandas.Index(column.attributes["flag_values"]).get_indexer(cells)
        return pandas.Categorical.from_codes(codes, column.attributes["flag_meanings"].split())


def check_rows(sizes: Mapping[str, int], most: int | None) -> None:
    """Raise `LimitError` if a table of some dimensions has more rows; None allows any number."""
    fix = "Take the NetCDF file, or Zarr, or slices over fewer axes"
    check_limit("rows", math.prod(sizes.values()), most, fix)


def heading(name: str, column: TableVariable) -> str:
    """Return the name of a column, with its unit in brackets."""
    unit = column.attributes.get("units", "1")
    return name if unit in ("", "1") else f"{name} [{unit}]"


def csv(frame: Frame, style: CsvStyle = "plain") -> Iterator[bytes]:
    """Yield a CSV file (RFC 4180) as UTF-8 bytes, `CSV_ROWS` rows at a time.

    The first row has the column names with units, the others one cell of the result each. Numbers
    have all their digits; NaN gives an empty field.
    """
    in_europe = style == "excel"
    for number, piece in enumerate(frame.pieces(CSV_ROWS)):
        piece.columns = frame.headings
        text = piece.to_csv(
            sep=";" if in_europe else ",",
            decimal="," if in_europe else ".",
            header=number == 0,
            index=False,
            lineterminator="\r\n",
        )
        yield text.encode("utf-8-sig" if in_europe and number == 0 else "utf-8")


def parquet(frame: Frame) -> Iterator[bytes]:
    """Yield the bytes of a Parquet file in pieces; pieces are empty while rows are added.

    Units, labels and descriptions are metadata of the columns; the attributes of the table, such as
    the study and its hash, are metadata of the schema.
    """
    import pyarrow.parquet  # of an extra

    inferred = pyarrow.Schema.from_pandas(next(frame.pieces(1)), preserve_index=False)
    columns = frame.columns.items()
    fields = [
        inferred.field(name).with_metadata(_texts(column.attributes)) for name, column in columns
    ]
    schema = pyarrow.schema(fields, metadata=_texts(frame.about))
    with tempfile.TemporaryFile() as file:
        with pyarrow.parquet.ParquetWriter(file, schema) as writer:
            for piece in frame.pieces(PARQUET_ROWS):
                writer.write_table(pyarrow.Table.from_pandas(piece, schema, preserve_index=False))
                yield b""
        yield from finished(file)


def _texts(attributes: Mapping[str, Any]) -> dict[str, str]:
    return {n: str(v) for n, v in attributes.items() if not n.startswith("flag_")}


def finished(file: IO[bytes]) -> Iterator[bytes]:
    """Yield the bytes of a file from its beginning on."""
    file.seek(0)
    yield from iter(partial(file.read, PIECE), b"")
