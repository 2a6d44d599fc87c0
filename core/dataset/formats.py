"""The formats of results, by the suffix of a file: its writer, and its limits.

NetCDF and Zarr can be read back as well, and written in any other format.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import numpy as np

from vibrafeed.core.dataset import matlab, workbook
from vibrafeed.core.dataset.files import USUAL, Storage, whole
from vibrafeed.core.dataset.frame import Frame, csv, parquet
from vibrafeed.core.dataset.group import write_zarr
from vibrafeed.core.dataset.limits import Size
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.read import attributes_of_file, read_netcdf, read_zarr
from vibrafeed.core.dataset.stores import attributes_at
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import MissingPackageError, VibrafeedError
from vibrafeed.core.system import installing

NETCDF: Final = ".nc"
ZARR: Final = ".zarr"
MAKER: Final = "vibrafeed "  # begins the attribute `source` of every result of vibrafeed


def _everything(size: Size) -> None:
    """Accept any size."""


@dataclass(frozen=True)
class Format:
    """A format of results.

    Attributes
    ----------
    name : str
        The name that people know.
    write : callable
        Writes a table at a place, all of it or nothing.
    pieces : callable, optional
        Yields the bytes of the rows of a table, if it is a format of rows.
    check : callable
        Raises `LimitError` if the format cannot hold a result of a size.
    media : str, optional
        Media type of a format of rows, which is sent over HTTP under the suffix without its dot.
    package : tuple of str and str or None, optional
        The package that writes it, on whose version the bytes depend, and the extra that it belongs
        to.
    seconds_a_value : float
        Roughly, of writing a value, where that takes long.
    """

    name: str
    write: Callable[[Table, str, Storage], None]
    pieces: Callable[[Frame], Iterator[bytes]] | None = None
    check: Callable[[Size], None] = _everything
    media: str | None = None
    package: tuple[str, str | None] | None = None
    seconds_a_value: float = 0.0

    def needs(self) -> None:
        """Raise `MissingPackageError` if its package is not installed."""
        if self.package is not None and find_spec(self.package[0]) is None:
            raise MissingPackageError(self.name, self.package[0], installing(*self.package))


def suffix_of(where: str) -> str:
    """Return the suffix that selects the format of an output; URLs are Zarr groups."""
    return ZARR if "://" in where else Path(where).suffix.lower()


def is_zarr(where: str) -> bool:
    """True if a path or URL names a Zarr group."""
    return suffix_of(where) == ZARR


def attributes_there(where: str) -> Mapping[str, object]:
    """Return the global attributes of an existing, complete result; none if there is none."""
    if is_zarr(where):
        return attributes_at(where)
    return attributes_of_file(Path(where)) if Path(where).exists() else {}


def known_suffixes() -> str:
    """Return the suffixes of all formats as text for messages."""
    *first, last = FORMATS
    return f"{', '.join(first)} or {last}"


def write_result(table: Table, where: str, *, history: str, storage: Storage = USUAL) -> None:
    """Write a table in the format of the output's suffix; the file appears only when complete.

    Parameters
    ----------
    table : Table
        The result to write.
    where : str
        A path with a known suffix, or the URL of a Zarr group.
    history : str
        The CF history attribute: a date and a command.
    storage : Storage
        The choices that the format leaves.

    Raises
    ------
    MissingPackageError
        If a package is missing.
    LimitError
        If the format cannot hold the table.
    OSError
        If the file cannot be written.
    """
    form = FORMATS[suffix_of(where)]
    form.needs()
    form.write(table.with_history(history), where, storage)


def read_result(where: str, *, most_bytes: int | None = None) -> Table:
    """Return the table in a NetCDF file or Zarr group that vibrafeed has written.

    Parameters
    ----------
    where : str
        A file, a folder, or the URL of a Zarr group.
    most_bytes : int, optional
        Largest size of all arrays; of a larger result none is read.

    Raises
    ------
    LimitError
        If the arrays are larger.
    VibrafeedError
        If it is not a result of vibrafeed.
    OSError
        If it cannot be read.
    """
    is_group = "://" in where or Path(where).is_dir()
    attributes = attributes_at(where) if is_group else attributes_of_file(Path(where))
    if not str(attributes.get("source", "")).startswith(MAKER):
        fix = "Give a NetCDF file or a Zarr group that vibrafeed wrote"
        raise VibrafeedError(f"the file is not a result of vibrafeed. {fix}")
    if is_group:
        return read_zarr(where, most_bytes=most_bytes)
    return read_netcdf(Path(where), most_bytes=most_bytes)


def _write_rows(
    pieces: Callable[[Frame], Iterator[bytes]], table: Table, where: str, _: Storage
) -> None:
    with whole(Path(where)) as temporary, temporary.open("wb") as file:
        file.writelines(pieces(Frame.of(table)))


def _write_csv(table: Table, where: str, storage: Storage) -> None:
    """Write a table as CSV, and what CSV cannot hold as JSON in a file beside it."""
    path = Path(where)
    description = table.to_xarray().to_dict(data=False) | {"attrs": Frame.of(table).about}
    text = json.dumps(description, indent=2, ensure_ascii=False, default=np.ndarray.tolist)
    with whole(path.with_name(f"{path.name}.json")) as json_file:
        json_file.write_text(f"{text}\n", encoding="utf-8")
        _write_rows(partial(csv, style=storage.csv_style), table, where, storage)


FORMATS: Final[Mapping[str, Format]] = {
    NETCDF: Format("NetCDF", write_netcdf, package=("netCDF4", None)),
    ZARR: Format("Zarr", write_zarr, package=("zarr", None)),
    ".csv": Format("CSV", _write_csv, csv, media="text/csv"),
    ".parquet": Format(
        "Parquet", partial(_write_rows, parquet), parquet,
        media="application/vnd.apache.parquet", package=("pyarrow", "tables"),
    ),
    ".xlsx": Format(
        "Excel", partial(_write_rows, workbook.xlsx), workbook.xlsx,
        workbook.check,
        media="application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
        package=("xlsxwriter", None), seconds_a_value=5e-6,
    ),
    ".mat": Format("MATLAB", matlab.write_mat, check=matlab.check),
}  # fmt: skip
"""Every format, by the suffix of a file."""
