"""Files that hold tables as numbers: workbooks, MAT, WAV, TDMS and UFF."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from vibrafeed.core.errors import StudyError, refused
from vibrafeed.core.system import installing
from vibrafeed.core.tables.table import Column, InputTable
from vibrafeed.core.tables.text import MAX_ROWS

FULL_SCALE = "full scale"
"""The unit of samples that are shares of the largest value which a file can hold."""
_PACKAGES = {"openpyxl": "XLSX", "nptdms": "TDMS", "pyuff": "UFF"}


def workbook(path: Path, section: str) -> list[tuple[int, list[str]]]:
    """Return the rows of the first sheet of an XLSX workbook, each its number and its cells."""
    try:
        from openpyxl import load_workbook

        book = load_workbook(path, read_only=True, data_only=True)
        sheet = book.worksheets[0]
        rows = [
            (number, [*map(_shown_cell, cells)])
            for number, cells in enumerate(sheet.iter_rows(), 1)
        ]
        book.close()
    except Exception as error:  # openpyxl raises many kinds for damaged files
        raise _unreadable(path, section, error) from error
    return [(number, cells) for number, cells in rows if any(map(str.strip, cells))]


def _shown_cell(cell: Any) -> str:
    value = cell.value
    if isinstance(value, int | float) and "%" in str(cell.number_format):
        return f"{100 * value:.15g} %"
    return "" if value is None else str(value)


def _unreadable(path: Path, section: str, error: Exception) -> StudyError:
    if isinstance(error, ModuleNotFoundError) and error.name in _PACKAGES:
        package = error.name
        message = f"reading {_PACKAGES[package]} needs {package}, which is not installed"
        return refused(section, message, f"{installing(package)}, or export the table as CSV")
    message = f"{path.name} is damaged, or is not a file of its kind: {error}"
    return refused(section, message[:300], "Export the table as CSV")


def _of_wav(path: Path) -> tuple[dict[str, Column], float]:
    # The channels by name, and the seconds between samples, 0 if not stated.
    from scipy.io import wavfile  # slow to import, and rarely needed

    rate, samples = wavfile.read(path)
    channels = samples.reshape(len(samples), -1).T
    if channels.dtype.kind in "iu":
        zero_level = 128 if channels.dtype.kind == "u" else 0
        channels = (channels.astype(np.float64) - zero_level) / 2.0 ** (8 * channels.itemsize - 1)
    columns = {str(number): Column(values, FULL_SCALE) for number, values in enumerate(channels, 1)}
    return columns, 1.0 / rate


def _of_mat(path: Path) -> tuple[dict[str, Column], float]:
    # The channels by name, and the seconds between samples, 0 if not stated.
    from scipy.io import loadmat  # as above

    columns: dict[str, Column] = {}
    for name, values in loadmat(path).items():
        if name.startswith("__") or getattr(values, "dtype", np.dtype("O")).kind not in "iuf":
            continue
        array = np.atleast_2d(np.squeeze(values))
        channels = array if len(array) <= array.shape[1] else array.T
        names = (
            [name]
            if len(channels) == 1
            else [f"{name}_{number + 1}" for number in range(len(channels))]
        )
        columns |= {
            channel_name: Column(row) for channel_name, row in zip(names, channels, strict=True)
        }
    return columns, 0.0


def _of_tdms(path: Path) -> tuple[dict[str, Column], float]:
    # The channels by name, and the seconds between samples, 0 if not stated.
    from nptdms import TdmsFile

    channels = [channel for group in TdmsFile.read(path).groups() for channel in group.channels()]
    columns = {}
    for channel in channels:
        values, unit = channel[:], str(channel.properties.get("unit_string", ""))
        if values.dtype.kind == "M":
            values, unit = (values - values[0]) / np.timedelta64(1, "s"), "s"
        columns[channel.name] = Column(values, unit)
    steps = [float(channel.properties.get("wf_increment", 0.0)) for channel in channels]
    return columns, max(steps, default=0.0)


def _of_uff(path: Path) -> tuple[dict[str, Column], float]:
    # The channels by name, and the seconds between samples, 0 if not stated.
    import pyuff

    datasets = pyuff.UFF(str(path)).read_sets()
    # Type 58 of the format is a function at nodes: the only one with samples.
    functions = [
        function
        for function in (datasets if isinstance(datasets, list) else [datasets])
        if function["type"] == 58
    ]
    columns = {}
    for number, function in enumerate(functions, 1):
        name = str(function.get("id1", "")).strip()
        name = name if name not in ("", "NONE") and name not in columns else str(number)
        unit = str(function.get("ordinate_axis_units_lab", "")).strip()
        columns[name] = Column(np.real(function["data"]), "" if unit == "NONE" else unit)
    return columns, float(functions[0]["abscissa_inc"]) if functions else 0.0


_FILES: Final[Mapping[str, Callable[[Path], tuple[dict[str, Column], float]]]] = {
    ".wav": _of_wav,
    ".mat": _of_mat,
    ".tdms": _of_tdms,
    **dict.fromkeys((".uff", ".unv"), _of_uff),
}
SUFFIXES: Final = (".xlsx", *_FILES)
"""Endings of files that are not text."""


def read_numbers(path: Path, section: str) -> InputTable:
    """Return the channels of a file that holds numbers, those of the most frequent length.

    Raises `StudyError` if the file is damaged, or holds no channel.
    """
    try:
        columns, step = _FILES[path.suffix.lower()](path)
    except Exception as error:  # the libraries raise many kinds for damaged files
        raise _unreadable(path, section, error) from error
    lengths = [len(column.cells) for column in columns.values()]
    count = max(lengths, key=lambda length: (lengths.count(length), length), default=0)
    if not 0 < count <= MAX_ROWS:
        fix = f"Give channels of 1 to {MAX_ROWS:,} samples"
        raise refused(section, f"{path.name} has {count:,} samples per channel", fix)
    columns = {name: column for name, column in columns.items() if len(column.cells) == count}
    return InputTable(columns, np.arange(1, count + 1), section, step=step)
