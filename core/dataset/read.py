"""Reading a NetCDF file or Zarr group of ours back as a table."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.frame import check_rows
from vibrafeed.core.dataset.limits import check_limit
from vibrafeed.core.dataset.stores import open_group, plain_errors
from vibrafeed.core.dataset.table import Table, TableVariable


def attributes_of_file(path: Path) -> dict[str, Any]:
    """Return the global attributes of a NetCDF file; none for any other file.

    Raises
    ------
    OSError
        If there is no such file, or it cannot be read.
    """
    import h5netcdf

    with path.open("rb"):  # the system's error says why it cannot be read, the library's does not
        pass
    try:
        with h5netcdf.File(path) as file:
            return _attributes(file.attrs)
    except OSError:
        return {}


def read_netcdf(
    path: Path, *, most_rows: int | None = None, most_bytes: int | None = None
) -> Table:
    """Return the table in a NetCDF file that `write_netcdf` wrote.

    It is read by h5netcdf, which, unlike the NetCDF library, any thread may use.

    Parameters
    ----------
    path : Path
        The file.
    most_rows : int, optional
        Largest number of cells; of a larger result no array is read.
    most_bytes : int, optional
        Largest size of all arrays, likewise.

    Raises
    ------
    LimitError
        If the result has more cells, or bytes.
    OSError
        If the file cannot be read.
    """
    return _table(path, "h5netcdf", most_rows, most_bytes)


def read_zarr(where: str, *, most_bytes: int | None = None) -> Table:
    """Return the table in a Zarr group that vibrafeed has written.

    Parameters
    ----------
    where : str
        A folder, or the URL of an object store.
    most_bytes : int, optional
        Largest size of all arrays; of a larger result none is read.

    Raises
    ------
    LimitError
        If the arrays are larger.
    OSError
        If the group cannot be read.
    """
    with plain_errors():
        return _table(open_group(where, read_only=True).store, "zarr", None, most_bytes)


def _table(source: Any, engine: str, most_rows: int | None, most_bytes: int | None) -> Table:
    import xarray  # heavy, and a process that reads nothing does without it

    with xarray.open_dataset(
        source, engine=engine, mask_and_scale=False, decode_times=False
    ) as dataset:
        check_rows({str(dim): size for dim, size in dataset.sizes.items()}, most_rows)
        fix = "Read slices of it with xarray, in Python"
        check_limit("bytes of memory", dataset.nbytes, most_bytes, fix)
        table = Table.of_xarray(dataset.load())
    return Table(_plain(table.coordinates), _plain(table.variables), _attributes(table.attributes))


def _plain(variables: Mapping[str, TableVariable]) -> dict[str, TableVariable]:
    return {
        name: TableVariable(
            variable.dims, _native(variable.values), _attributes(variable.attributes)
        )
        for name, variable in variables.items()
    }


def _native(values: NDArray[Any]) -> NDArray[Any]:
    """Return numbers without a stated order of bytes, which netCDF4 minds, and texts as objects."""
    if values.dtype.kind in "UT":
        return values.astype(object)
    native = values.dtype.newbyteorder("=")
    return values.view(native) if values.dtype.isnative else values.astype(native)


def _attributes(raw: Mapping[str, Any]) -> dict[str, Any]:
    attributes = {
        name: value.item() if isinstance(value, np.generic) else value
        for name, value in raw.items()
        if not name.startswith("_")
    }
    if "flag_values" in attributes:
        attributes["flag_values"] = np.atleast_1d(attributes["flag_values"]).astype(np.int8)
    return attributes
