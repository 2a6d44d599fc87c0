"""Files of a result: error of what is read back, against size and time to write."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.assurance.accuracy.cells import median_seconds
from vibrafeed.core.assurance.accuracy.curves import Curve, Measured, Point
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.watch import Watch

REPEATS = 3

BITS = {"float32": 23}
"""Binary digits of the fraction of types that are shorter than the result's."""


@dataclass(frozen=True)
class StorageFormat:
    """A way to store a result.

    Attributes
    ----------
    dtype : str
        Type of float.
    level : int
        Of the compression; 0 is none.
    bits : int, optional
        Binary digits of the fraction that are kept; all of the type if left out.
    """

    dtype: str = "float64"
    level: int = 1
    bits: int | None = None

    @property
    def half_quantum(self) -> float:
        """The largest relative rounding error of a normal number; 0 for exact formats.

        A float32 of fewer bits is rounded twice.
        """
        cuts = [BITS["float32"]] if self.dtype == "float32" else []
        cuts += [self.bits] if self.bits else []
        return float(sum(2.0 ** -(bits + 1) for bits in cuts))

    def __str__(self) -> str:
        kept = f" {self.bits} bits" if self.bits else ""
        return f"{self.dtype}{kept} level {self.level}" if self.level else f"{self.dtype} plain"


SERIES: dict[str, tuple[StorageFormat, ...]] = {
    "compression": tuple(StorageFormat(level=level) for level in (0, 1, 2, 4, 6, 9)),
    "float32": tuple(StorageFormat("float32", level) for level in (0, 1, 4, 9)),
    "quantised": tuple(StorageFormat(bits=bits) for bits in (36, 28, 20, 16, 12, 8)),
    "float32 quantised": tuple(StorageFormat("float32", bits=bits) for bits in (20, 16, 12, 8)),
}
"""What is compared, by the name of its curve."""


def measure(table: Table, watch: Watch) -> Measured:
    """Measure error, size and writing time of storage formats for a result, as a benchmark.

    The table is written in each format of `SERIES` to a temporary NetCDF file and read back.

    Parameters
    ----------
    table : Table
        The result that is stored.
    watch : Watch
        Formats that are not reached before it stops are left out, and a note says so.

    Returns
    -------
    Measured
        A curve for each series of formats.
    """
    values = {n: v.values for n, v in table.variables.items() if v.values.dtype.kind == "f"}
    count = sum(variable.values.size for variable in table.variables.values())
    everything = sum(len(formats) for formats in SERIES.values())
    curves = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "result.nc"
        for name, formats in SERIES.items():
            points = []
            for storage_format in formats:
                if watch.stopped():
                    break
                points.append(_point(table, values, storage_format, path, count))
                watch.advance(1 / everything)
            if not points:
                continue
            cut = "quantised" in name
            curves.append(
                Curve("storage", "the result", name, tuple(points), "1" if cut else "",
                      1.0 if cut else math.nan, cost="half_quantum", of="largest")
            )  # fmt: skip
    notes = [
        f"The study's own result, {count:,} values of {len(table.variables)} variables, written "
        "as `vibrafeed run` writes it (which is float64 at level 1) and read back.",
        "Error: largest and median of the values, each as a share of itself. Size: of the whole "
        f"file over all values. Time: to write a value and have it on the disk, median of "
        f"{REPEATS} repeats after a warm-up.",
        "Expected: no error at any level of compression; else at most half a quantum, which is "
        "2^-(bits + 1) of a value of that many binary digits, and 2^-24 in float32, for what is a "
        "normal number of the type.",
    ]
    if sum(len(curve.points) for curve in curves) < everything:
        notes.append("The time given ran out: formats that were not reached are left out.")
    return Measured("storage", tuple(curves), tuple(notes))


def write_as(table: Table, path: Path, storage_format: StorageFormat) -> None:
    """Write a table to a NetCDF file in a storage format: type of float, compression, digits kept.

    `path` is the file, which is replaced. In the format "float32" variables are converted to 32
    bits, and coordinates stay in 64, so that cells are found again by their parameters.
    """
    if storage_format.dtype == "float32":
        # Coordinates stay as they are: a cell is to be found again.
        table = replace(
            table,
            variables={
                name: replace(v, values=_short(v.values)) if v.values.dtype == np.float64 else v
                for name, v in table.variables.items()
            },
        )
    write_netcdf(
        table,
        path,
        compression=bool(storage_format.level),
        level=storage_format.level or 1,
        significant_bits=storage_format.bits,
    )


def _short(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return values in 32 bits."""
    with np.errstate(over="ignore"):  # an infinite error tells
        return values.astype(np.float32)


def errors_of_file(path: Path, values: Mapping[str, NDArray[Any]]) -> NDArray[np.float64]:
    """Return the relative error of each finite, nonzero value that a NetCDF file stores, one array.

    `values` has the true arrays by the name of the variable; the errors of all variables are
    joined.
    """
    errors = []
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        for name, true in values.items():
            read = np.asarray(file[name][...], dtype=np.float64)
            known = np.isfinite(true) & (true != 0)
            errors.append(np.abs(read[known] - true[known]) / np.abs(true[known]))
    return np.concatenate(errors) if errors else np.zeros(0)


def _point(
    table: Table,
    values: Mapping[str, NDArray[Any]],
    storage_format: StorageFormat,
    path: Path,
    count: int,
) -> Point:
    """Write a table in a storage format, read it back; return error, size and time as a point.

    Parameters
    ----------
    table : Table
        What is written.
    values : mapping of str to ndarray
        Its variables of floats, against which the file is compared.
    storage_format : StorageFormat
        Type of float, level of compression and digits kept.
    path : Path
        The file, which is replaced.
    count : int
        Number of all values in the table, by which size and time are divided.
    """
    write: Callable[[], None] = lambda: write_as(table, path, storage_format)  # noqa: E731
    seconds = median_seconds(write, REPEATS, least=0.0) / count
    errors = errors_of_file(path, values)
    middle, largest = (float(np.median(errors)), float(errors.max())) if errors.size else (0.0, 0.0)
    return Point(
        str(storage_format),
        float(storage_format.bits) if storage_format.bits else math.nan,
        middle,
        largest,
        seconds,
        int(errors.size),
        {
            "bytes_per_value": path.stat().st_size / count,
            "half_quantum": storage_format.half_quantum,
        },
    )
