"""The NetCDF writer.

The netCDF4 library crashes when two threads of a process are in it, even on different files. These
functions take no lock: a process that has threads gives all of them to one.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from vibrafeed.core.dataset.files import USUAL, Storage, whole
from vibrafeed.core.dataset.table import Table, TableVariable

if TYPE_CHECKING:
    import netCDF4

LEVEL: Final = 1  # higher levels take up to three times as long to save a few per cent


def write_netcdf(table: Table, where: str | Path, storage: Storage = USUAL) -> None:
    """Write a table as a CF NetCDF-4 file, which appears only when complete and on the disk.

    Equal results give equal bytes: the cost of the run is left out, unless `Table.with_history` has
    put it among the attributes.

    Parameters
    ----------
    table : Table
        The result to write.
    where : str or Path
        The file; an existing one is replaced.
    storage : Storage
        With compression: deflate with shuffle, which every reader opens.

    Raises
    ------
    OSError
        If the file cannot be written; nothing is left behind.
    """
    with (
        whole(Path(where)) as temporary,
        created(temporary, table, compression=storage.compression) as file,
    ):
        for name, variable in table.variables.items():
            file[name][...] = variable.values


@contextmanager
def created(
    path: Path,
    table: Table,
    *,
    compression: bool,
    chunks: Mapping[str, tuple[int, ...]] = MappingProxyType({}),
) -> "Iterator[netCDF4.Dataset]":
    """Create the NetCDF file of a table, and keep it open for the values of its variables.

    Coordinates have their values.

    Parameters
    ----------
    path, table : Path, Table
        The file, and the result whose names, shapes, types and attributes count.
    compression : bool
        Whether arrays are to be compressed.
    chunks : mapping of str to tuple of int
        The chunk lengths of the arrays; the library's by default.

    Raises
    ------
    OSError
        If the file cannot be written, such as to a full disk.
    """
    import netCDF4  # slow to import, and only writing needs it

    try:
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            _define(file, table, compression, chunks)
            yield file
    except RuntimeError as error:
        if not str(error).startswith("NetCDF:"):
            raise
        raise OSError(f"{error} (is the disk full?)") from error


def _define(
    file: "netCDF4.Dataset", table: Table, compression: bool, chunks: Mapping[str, tuple[int, ...]]
) -> None:
    file.setncatts(_attributes(table.attributes))
    for name, coordinate in table.coordinates.items():
        if coordinate.dims == (name,):
            file.createDimension(name, coordinate.values.size)
    for name, coordinate in table.coordinates.items():
        _add(file, name, coordinate)[...] = coordinate.values
    for name, variable in table.variables.items():
        storage: dict[str, Any] = {"chunksizes": chunks.get(name) or None}
        if compression and variable.dims:
            storage |= {"compression": "zlib", "complevel": LEVEL}
        _add(file, name, variable, **storage).setncatts(table.links(name))


def _add(
    file: "netCDF4.Dataset", name: str, variable: TableVariable, **storage: Any
) -> "netCDF4.Variable[Any]":
    # CF forbids fill values in coordinates, and in flags they would turn integers into floats.
    dtype: Any = variable.values.dtype
    if dtype.kind == "O":  # texts, of any length: the library compresses none
        dtype, storage = str, {}
    created = file.createVariable(name, dtype, variable.dims, fill_value=False, **storage)
    created.setncatts(_attributes(variable.attributes))
    return created


def _attributes(attributes: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: value
        if isinstance(value, np.ndarray | float)
        else np.int32(value)
        if isinstance(value, int)
        else str(value)
        for name, value in attributes.items()
    }
