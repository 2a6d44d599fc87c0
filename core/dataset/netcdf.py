"""The NetCDF writer.

The netCDF4 library crashes when two threads of a process are in it, even on different files. These
functions take no lock: a process that has threads gives all of them to one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.dataset.table import Table, TableVariable

if TYPE_CHECKING:
    import netCDF4

COMPRESSION_LEVEL: Final = 1  # higher levels take up to three times as long to save a few per cent


def write_netcdf(
    table: Table,
    path: Path,
    *,
    compression: bool = True,
    level: int = COMPRESSION_LEVEL,
    significant_bits: int | None = None,
) -> None:
    """Write a table as a CF NetCDF-4 file, which appears only when complete and on the disk.

    Equal results give equal bytes: the cost of the run is left out, unless `Table.with_history` has
    put it among the attributes.

    Parameters
    ----------
    table : Table
        The result to write.
    path : Path
        The file; an existing one is replaced.
    compression : bool
        True for deflate with shuffle, which every reader opens.
    level : int
        Level of compression, 1 to 9.
    significant_bits : int, optional
        Binary digits of the fraction that floats are rounded to; all by default. Digits that are
        cut off take almost no space after compression.

    Raises
    ------
    OSError
        If the file cannot be written; nothing is left behind.
    """
    with whole(path) as temporary:
        _define(temporary, table, _Storage(compression, level, significant_bits))


def define(
    path: Path,
    table: Table,
    *,
    compression: bool,
    chunks: Mapping[str, tuple[int, ...]],
) -> None:
    """Create the NetCDF file of a table without the values of its arrays, which are written later.

    Coordinates and texts have their values.

    Parameters
    ----------
    path, table : Path, Table
        The file, and the result whose names, shapes, types and attributes count.
    compression : bool
        Whether arrays are to be compressed.
    chunks : mapping of str to tuple of int
        The chunk lengths of the arrays.
    """
    _define(path, table, _Storage(compression, chunks=chunks), empty=True)


@contextmanager
def opened(path: Path, mode: Literal["w", "a"]) -> Iterator[netCDF4.Dataset]:
    """Open a NetCDF file to write; what the disk does not take is an `OSError`."""
    import netCDF4  # a process that writes nothing does not load it

    try:
        with netCDF4.Dataset(path, mode, format="NETCDF4") as file:
            yield file
    except RuntimeError as error:
        if not str(error).startswith("NetCDF:"):
            raise
        raise OSError(f"{error} (is the disk full?)") from error


@dataclass(frozen=True)
class _Storage:
    """The storage of a variable: chunks, compression and type."""

    compression: bool
    level: int = COMPRESSION_LEVEL
    significant_bits: int | None = None
    chunks: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    def of(self, name: str, values: NDArray[Any]) -> dict[str, Any]:
        """Return the keyword arguments of netCDF4's `createVariable` for the storage of an array.

        Arrays without dimension are not compressed, and only floats are rounded.
        """
        settings: dict[str, Any] = {"chunksizes": self.chunks.get(name) or None}
        if self.compression and values.ndim:
            settings |= {"compression": "zlib", "complevel": self.level}
        if self.significant_bits is not None and values.ndim and values.dtype.kind == "f":
            settings |= {"significant_digits": self.significant_bits, "quantize_mode": "BitRound"}
        return settings


PLAIN = _Storage(compression=False)


def _define(path: Path, table: Table, storage: _Storage, *, empty: bool = False) -> None:
    """Create a NetCDF file and its dimensions, attributes and variables with the netCDF4 library.

    Parameters
    ----------
    path : Path
        The file, which is overwritten.
    table : Table
        The result.
    storage : _Storage
        Chunks and compression of the arrays.
    empty : bool
        True to leave out the values of arrays, which are written later.
    """
    with opened(path, "w") as file:
        _fill(file, table, storage, empty=empty)


def _fill(file: netCDF4.Dataset, table: Table, storage: _Storage, *, empty: bool) -> None:
    """Write attributes, dimensions, coordinates and variables of a table into an open NetCDF file.

    Parameters
    ----------
    file : netCDF4.Dataset
        The new file.
    table : Table
        The result.
    storage : _Storage
        Compression and rounding of the variables.
    empty : bool
        Whether arrays are only created, for their values to be written later.
    """
    file.setncatts(_attributes(table.attributes))
    axes = [name for name, one in table.coordinates.items() if one.dims == (name,)]
    for name in axes:
        file.createDimension(name, table.coordinates[name].values.size)
    for name, coordinate in table.coordinates.items():
        _add(file, name, coordinate, {}, PLAIN)[...] = coordinate.values
    for name, variable in table.variables.items():
        created = _add(file, name, variable, _links(table, name), storage)
        if not empty or variable.values.dtype == object:
            created[...] = variable.values


def _links(table: Table, name: str) -> dict[str, str]:
    """Return the CF attribute that links a variable to its coordinates that are no axes.

    They are names in a text; `name` is that of a variable of the table. The result may be empty.
    """
    dims = set(table.variables[name].dims)
    others = [n for n, one in table.coordinates.items() if one.dims != (n,)]
    near = [n for n in others if set(table.coordinates[n].dims) <= dims]
    return {"coordinates": " ".join(near)} if near else {}


def _add(
    file: netCDF4.Dataset,
    name: str,
    variable: TableVariable,
    links: Mapping[str, str],
    storage: _Storage,
) -> netCDF4.Variable[Any]:
    """Create a variable in a NetCDF file, without values, and return it.

    Parameters
    ----------
    file : netCDF4.Dataset
        The open file.
    name, variable : str, TableVariable
        Its name; its dimensions, type, shape and attributes.
    links : mapping
        Attributes that link it to others.
    storage : _Storage
        Compression and rounding.
    """
    # CF forbids fill values in coordinates, and in flags they would turn integers into floats.
    if variable.values.dtype == object:  # texts, of any length: the library compresses none
        created = file.createVariable(name, str, variable.dims)
    else:
        created = file.createVariable(
            name,
            variable.values.dtype,
            variable.dims,
            fill_value=False,
            shuffle=True,
            **storage.of(name, variable.values),
        )
    created.setncatts({**_attributes(variable.attributes), **links})
    return created


def _attributes(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes in the types that netCDF4 takes: arrays, floats, 32-bit integers, texts."""

    def taken(value: Any) -> Any:
        """Return one attribute in a type that the library takes."""
        if isinstance(value, np.ndarray | float):
            return value
        return np.int32(value) if isinstance(value, int) else str(value)

    return {name: taken(value) for name, value in attributes.items()}
