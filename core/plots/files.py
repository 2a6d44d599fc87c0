"""From a NetCDF file to picture files."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import xarray
from matplotlib.figure import Figure

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.fixed import read_fixed
from vibrafeed.core.plots.pictures import PlotError, unreadable

DPI = 150  # dots per inch of a PNG
MOVING = (".gif", ".mp4")  # of which `animate` writes the first
FORMATS = {".png": "png", ".svg": "svg", ".pdf": "pdf"}
METADATA: Mapping[str, dict[str, str | None]] = {
    "png": {"Software": "vibrafeed"},
    "svg": {"Creator": "vibrafeed", "Date": None},
    "pdf": {"Creator": "vibrafeed", "CreationDate": None},
}


def draw_file(
    file: Path | Sequence[Path],
    targets: Sequence[Path],
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, str] | None = None,
    kind: str | None = None,
    slow: float | None = None,
    **look: Any,
) -> None:
    """Draw one or several result files of `vibrafeed run` and save the picture.

    Parameters
    ----------
    file : Path, or a sequence of them
        The NetCDF files.
    targets : sequence of Path
        The pictures, PNG, SVG, PDF or GIF (of a motion) by suffix; existing ones are replaced.
    variable, axes, kind
        Output, axes and kind of picture, as for `draw`; by default what suits the data.
    at : mapping of str to str, optional
        Values of other dimensions as a user writes them, in the unit of the file.
    slow : float, optional
        Slow-motion factor of an animation.
    **look
        title, units, nearest, dark and small, as for `draw`.

    Raises
    ------
    PlotError, OSError
        If a file does not have what is asked for; if one cannot be read or written. No half picture
        is left behind.
    """
    files = [file] if isinstance(file, Path) else list(file)
    moving = kind == "animation" or any(target.suffix.lower() in MOVING for target in targets)
    if moving:
        _animate_file(files, targets, (variable, axes, at), kind, slow, look)
        return
    if slow is not None:
        raise PlotError(
            "slow",
            "slow is given, but only an animation has a slow-motion factor",
            "Give the picture a name that ends in .gif, or leave out slow",
        )
    for target in targets:
        check_format(target)
    held = read_fixed(at or {})
    figure = draw(
        [read(each) for each in files], variable=variable, axes=axes, at=held, kind=kind, **look
    )
    for target in targets:
        save(figure, target)


def _animate_file(
    files: Sequence[Path],
    targets: Sequence[Path],
    chosen: Sequence[object],
    kind: str | None,
    slow: float | None,
    look: Mapping[str, Any],
) -> None:
    """Save the animation of a result file's trajectory; raise `PlotError` for wrong options.

    Parameters
    ----------
    files, targets : sequence of Path
        One result file, and the animations to write.
    chosen : sequence
        The options variable, axes and at, which an animation does not take.
    kind, slow : str or None, float or None
        The kind of picture asked for, and the slow-motion factor.
    look : mapping
        Title, units and colours.
    """
    # Here, since it loads what draws bodies, and the whole of motion.
    from vibrafeed.core.plots.movie import animate

    if len(files) > 1:
        raise PlotError(
            "dataset",
            "an animation shows one result, but several files are given",
            "Give one result file",
        )
    if kind not in (None, "animation", "trajectory"):
        fix = "End the name in .png, .svg or .pdf, or leave the kind out"
        raise PlotError("kind", f"a {kind} does not move", fix)
    if any(chosen) or look.get("nearest"):
        fix = "Leave out variable, axes, at and nearest"
        raise PlotError(
            "kind",
            "an animation shows the whole trajectory, without a variable, axes or fixed values",
            fix,
        )
    look = {name: value for name, value in look.items() if name != "nearest"}
    dataset = read(files[0])
    for target in targets:
        animate(dataset, target, slow=slow, **look)


def check_format(target: Path) -> None:
    """Raise `PlotError` if pictures cannot be saved in the format of a file name."""
    if target.suffix.lower() not in FORMATS:
        message = f"'{target.suffix}': unknown picture format"
        fix = "End the name of the picture in .png, .svg or .pdf"
        raise PlotError("output", message, fix)


def save(figure: Figure, target: Path) -> None:
    """Save a figure as PNG, SVG or PDF, by the suffix; a file appears only when complete."""
    name = FORMATS[target.suffix.lower()]
    picture = io.BytesIO()
    figure.savefig(picture, format=name, dpi=DPI, metadata=METADATA[name])
    with whole(target) as temporary:
        temporary.write_bytes(picture.getvalue())


def read(file: str | PathLike[str]) -> xarray.Dataset:
    """Return the dataset in a result file, loaded into memory.

    Raises
    ------
    PlotError
        If it is not a NetCDF file.
    OSError
        If it cannot be read.
    """
    file = Path(file)
    with file.open("rb"):  # the system says why a file cannot be read; the library does not
        pass
    try:
        with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as dataset:
            return dataset.load()
    except (OSError, ValueError) as error:
        raise unreadable("it is not a NetCDF file, or it is damaged") from error
