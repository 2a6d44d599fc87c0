"""From a NetCDF file to picture files."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray
from matplotlib.figure import Figure

from core.dataset.files import whole
from core.plots.draw import draw
from core.plots.fixed import read_fixed
from core.plots.problem import PlotError

DPI = 150
FORMATS = {".png": "png", ".svg": "svg", ".pdf": "pdf"}
METADATA = {
    "png": {"Software": "vibrafeed"},
    "svg": {"Creator": "vibrafeed", "Date": None},
    "pdf": {"Creator": "vibrafeed", "CreationDate": None},
}


def draw_file(
    file: Path,
    targets: Sequence[Path],
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, str] | None = None,
    kind: str | None = None,
    **look: Any,
) -> None:
    """Draw a NetCDF file that `vibrafeed run` wrote; see `draw`.

    Parameters
    ----------
    file : Path
        The NetCDF file.
    targets : sequence of Path
        The pictures, PNG, SVG or PDF by their suffix; existing ones are replaced.
    variable, axes, kind
        As for `draw`.
    at : mapping of str to str, optional
        Values of other dimensions as a user writes them, in the unit of the file.
    **look
        title, units, nearest, dark and small, as for `draw`.

    Raises
    ------
    PlotError
        If the file is no such result, or does not hold what is asked for.
    OSError
        If the file cannot be read or a picture cannot be written; no part of one is left behind.
    """
    for target in targets:
        check_format(target)
    held = read_fixed(at or {})
    figure = draw(_read(file), variable=variable, axes=axes, at=held, kind=kind, **look)
    for target in targets:
        save(figure, target)


def check_format(target: Path) -> None:
    """Raise `PlotError` if pictures are not written in the format of a file's name."""
    if target.suffix.lower() not in FORMATS:
        message = f"'{target.suffix}' is no format for pictures"
        raise PlotError("output", message, "End the name in .png, .svg or .pdf")


def save(figure: Figure, target: Path) -> None:
    """Write a figure as PNG, SVG or PDF, by the suffix of its name; all of it or nothing."""
    name = FORMATS[target.suffix.lower()]
    picture = io.BytesIO()
    figure.savefig(picture, format=name, dpi=DPI, metadata=METADATA[name])
    with whole(target) as temporary:
        temporary.write_bytes(picture.getvalue())


def _read(file: Path) -> xarray.Dataset:
    with file.open("rb"):  # the system says why a file cannot be read; the library does not
        pass
    try:
        with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as dataset:
            return dataset.load()
    except (OSError, ValueError) as error:
        message = "it is no NetCDF file, or a damaged one"
        raise PlotError("dataset", message, "Draw a file that `vibrafeed run` wrote") from error
