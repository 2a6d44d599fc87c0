"""The formats of results, by the suffix of a file: what writes each, and what it can hold.

NetCDF and Zarr can be read back as well, and written in any other format.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Final

from vibrafeed.core.dataset import matlab, workbook
from vibrafeed.core.dataset.csv_metadata import csv_metadata, metadata_path
from vibrafeed.core.dataset.files import whole
from vibrafeed.core.dataset.frame import Frame, pyarrow
from vibrafeed.core.dataset.group import read_zarr, write_zarr
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.read import attributes_of_file, read_netcdf
from vibrafeed.core.dataset.stores import attributes_at, needed_for
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import VibrafeedError

NETCDF: Final = ".nc"
ZARR: Final = ".zarr"
MAKER: Final = "vibrafeed "  # begins the attribute `source` of every result of vibrafeed


def _nothing() -> None:
    """Do nothing: the format needs no package."""


def _everything(rows: int, size: int) -> None:
    """Accept any number of rows and bytes."""


@dataclass(frozen=True)
class Format:
    """A format of results.

    Attributes
    ----------
    name : str
        What people call it.
    write : callable
        Writes a table at a place, all of it or nothing. Takes besides the CF history attribute, and
        whether to compress, which counts where a format lets one choose.
    pieces : callable, optional
        Yields the bytes of the rows of a table, if it is a format of rows.
    needs : callable
        Raises `MissingPackageError` if a package is missing.
    media : str, optional
        Media type of a format of rows, which is sent over HTTP under the suffix without its dot.
    package : tuple of str and str or None, optional
        What has to be installed besides, on whose version the bytes depend, and the extra that it
        belongs to.
    text : bool
        Whether compressing it on its way is worth while.
    check : callable
        Takes a number of rows and of bytes; raises `LimitError` if the format cannot hold them.
    """

    name: str
    write: Callable[[Table, str, str, bool], None]
    pieces: Callable[[Frame], Iterator[bytes]] | None = None
    needs: Callable[[], object] = _nothing
    check: Callable[[int, int], None] = _everything
    media: str | None = None
    package: tuple[str, str | None] | None = None
    text: bool = False


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


def write_result(table: Table, where: str, *, history: str, compression: bool = True) -> None:
    """Write a table in the format of the output's suffix; the file appears only when complete.

    Parameters
    ----------
    table : Table
        The result to write.
    where : str
        A path with a known suffix, or the URL of a Zarr group.
    history : str
        The CF history attribute: a date and a command.
    compression : bool
        True to compress NetCDF and MAT files; the other formats always do, or never.

    Raises
    ------
    MissingPackageError
        If a package is missing.
    LimitError
        If the format cannot hold the table.
    OSError
        If the file cannot be written.
    """
    FORMATS[suffix_of(where)].write(table, where, history, compression)


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
        wanted = "Give a NetCDF file or a Zarr group that vibrafeed wrote"
        raise VibrafeedError(f"the file is not a result of vibrafeed. {wanted}")
    if is_group:
        return read_zarr(where, most_bytes=most_bytes)
    return read_netcdf(Path(where), most_bytes=most_bytes)


def _with_history(table: Table, history: str) -> Table:
    """Return the table with a `history` attribute."""
    return replace(table, attributes={**table.attributes, "history": history})


def _write_netcdf(table: Table, where: str, history: str, compression: bool) -> None:
    """Write a table as NetCDF."""
    write_netcdf(table, Path(where), history=history, compression=compression)


def _write_zarr(table: Table, where: str, history: str, compression: bool) -> None:
    """Write a table as a Zarr group."""
    write_zarr(table, where, history=history)


def _write_csv(table: Table, where: str, history: str, compression: bool) -> None:
    """Write a table as CSV, and its metadata as JSON in a file beside it.

    `where` is the path of the CSV file, `history` the CF history attribute (a date and a command).
    `compression`, which all writers of formats take, is not used.
    """
    frame, path = Frame.of(_with_history(table, history)), Path(where)
    with whole(metadata_path(path)) as beside, whole(path) as temporary:
        beside.write_bytes(csv_metadata(frame, path.name))
        with temporary.open("wb") as file:
            file.writelines(frame.csv())


def _write_parquet(table: Table, where: str, history: str, compression: bool) -> None:
    """Write a table as Parquet."""
    _write_pieces(Frame.of(_with_history(table, history)).parquet(), Path(where))


def _write_xlsx(table: Table, where: str, history: str, compression: bool) -> None:
    """Write a table as an Excel workbook."""
    _write_pieces(workbook.xlsx(Frame.of(_with_history(table, history))), Path(where))


def _write_pieces(pieces: Iterator[bytes], path: Path) -> None:
    """Write pieces of bytes to a file that appears when complete."""
    with whole(path) as temporary, temporary.open("wb") as file:
        file.writelines(pieces)


def _write_mat(table: Table, where: str, history: str, compression: bool) -> None:
    """Write a table as a MAT file."""
    matlab.write_mat(_with_history(table, history), Path(where), compression=compression)


FORMATS: Final[Mapping[str, Format]] = {
    NETCDF: Format("NetCDF", _write_netcdf),
    ZARR: Format("Zarr", _write_zarr, needs=partial(needed_for, ".zarr")),
    ".csv": Format("CSV", _write_csv, Frame.csv, media="text/csv", text=True),
    ".parquet": Format(
        "Parquet", _write_parquet, Frame.parquet, pyarrow,
        media="application/vnd.apache.parquet", package=("pyarrow", "tables"),
    ),
    ".xlsx": Format(
        "Excel", _write_xlsx, workbook.xlsx, workbook.openpyxl,
        lambda rows, size: workbook.check_rows_of_sheet(rows),
        media="application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
        package=("openpyxl", None),
    ),
    ".mat": Format("MATLAB", _write_mat, check=lambda rows, size: matlab.check_bytes(size)),
}  # fmt: skip
"""Every format, by the suffix of a file."""
