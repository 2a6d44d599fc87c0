"""Reading a NetCDF file of ours back as a table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibrafeed.core.dataset.frame import check_rows
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import LimitError

if TYPE_CHECKING:
    import h5py

# What the formats keep for themselves, and what follows from the names of dimensions.
_OWN = {"CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "coordinates"}


def attributes_of_file(path: Path) -> dict[str, object]:
    """Return the global attributes of a NetCDF file; none for any other file.

    Raises
    ------
    OSError
        If there is no such file, or it cannot be read.
    """
    import h5py

    with path.open("rb"):  # the system says why it cannot be read; the library only that
        pass
    try:
        with h5py.File(path) as file:
            return _attributes(file.attrs)
    except OSError:
        return {}


def read_netcdf(
    path: Path, *, most_rows: int | None = None, most_bytes: int | None = None
) -> Table:
    """Return the table in a NetCDF file that `write_netcdf` wrote.

    It is read by h5py, which, unlike the NetCDF library, any thread may use.

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
    import h5py  # a process that reads nothing does not load it

    with h5py.File(path) as file:
        sizes = {
            name: dataset.size
            for name, dataset in file.items()
            if dataset.is_scale and dataset.ndim
        }
        check_rows(sizes, most_rows)
        check_size(sum(dataset.nbytes for dataset in file.values()), most_bytes)
        named = " ".join(_plain(dataset.attrs.get("coordinates", "")) for dataset in file.values())
        coordinates: dict[str, TableVariable] = {}
        variables: dict[str, TableVariable] = {}
        for name, dataset in file.items():
            is_coordinate = dataset.is_scale or name in named.split()
            (coordinates if is_coordinate else variables)[name] = _variable(file, name, dataset)
        return Table(coordinates, variables, _attributes(file.attrs))


def check_size(size: int, most: int | None) -> None:
    """Raise `LimitError` if arrays have more bytes than `most`; None allows any size."""
    if most is not None and size > most:
        fix = "Read slices of it with xarray, in Python"
        raise LimitError("bytes of memory", size, most, fix)


def _variable(file: h5py.File, name: str, dataset: h5py.Dataset) -> TableVariable:
    """Return a variable of a NetCDF file with its dimensions and attributes, all values loaded.

    `file` is the file as h5py reads it, `name` and `dataset` are the variable's name and HDF5
    dataset.
    """
    dims = tuple(file[ref[0]].name[1:] for ref in dataset.attrs.get("DIMENSION_LIST", ()))
    if dataset.is_scale:
        dims = (name,)
    values = dataset.asstr()[()] if dataset.dtype == object else dataset[()]
    return TableVariable(dims, np.asarray(values), _attributes(dataset.attrs))


def _attributes(raw: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes that vibrafeed wrote, without those that HDF5 and NetCDF add.

    `raw` are the attributes of a file or variable as h5py reads them.
    """
    return {
        name: _plain(value)
        for name, value in raw.items()
        if name not in _OWN and not name.startswith("_")
    }


def _plain(value: Any) -> Any:
    """Return an attribute read by h5py as a text, a number or an array, as tables have it.

    Bytes become a text, and arrays of one value a number; flag values (int8) stay an array.
    """
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.ndarray) and value.size == 1 and value.dtype != np.int8:
        return value.item()
    return value
