"""The picture of a dataset."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import xarray
from matplotlib.figure import Figure

from vibrafeed.core.plots.fixed import in_letters
from vibrafeed.core.plots.pictures import GONE, NAMES, PICTURES, PlotError, is_calibration
from vibrafeed.core.plots.style import Options, Style
from vibrafeed.core.plots.text import units_of
from vibrafeed.core.plots.together import draw_together
from vibrafeed.core.quantities import letter_of
from vibrafeed.core.suggestions import suggestion


def draw(
    dataset: xarray.Dataset | Sequence[xarray.Dataset],
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, float] | None = None,
    kind: str | None = None,
    title: str | None = None,
    units: Sequence[str] | str | None = None,
    nearest: bool = False,
    dark: bool = False,
    small: bool = False,
) -> Figure:
    """Return the picture of an output with regimes shaded, of the regimes, or of one motion.

    Parameters
    ----------
    dataset : xarray.Dataset, or a sequence of them
        A sweep or simulation, as `vibrafeed.core.kinds.run_study` returns it or as its
        file is read. Of several, up to seven, the same output is drawn over the same axis.
    variable : str, optional
        The output; the first if left out.
    axes : tuple of str, optional
        One or two dimensions, the first across; the longest if left out.
    at : mapping of str to float, optional
        Values of other dimensions, in the unit of the dataset; the middle one if left out.
    kind : str, optional
        The name of a picture, one of `vibrafeed.core.plots.pictures.PICTURES`; the first that fits
        if left out. A line with two axes is a family of curves, at most seven, and what is drawn
        where an axis has no more values than that.
    title : str, optional
        The name of the picture; that of what it shows if left out.
    units : str or sequence of str, optional
        Units for reading: `trade`, those usual in practice (mm, mm/s); `si`; or units such as
        m/min, each for its kind. If left out, those of the study.
    nearest : bool
        True if a value of `at` that the dataset does not have stands for the nearest one.
    dark : bool
        Use light colours on a dark background.
    small : bool
        For a column of a document, some 11 cm wide.

    Returns
    -------
    matplotlib.figure.Figure
        A figure with a canvas of its own; a notebook shows it.

    Raises
    ------
    PlotError
        If the dataset does not hold what is asked for.

    Examples
    --------
    >>> from pathlib import Path
    >>> from vibrafeed.core.plots import draw
    >>> from vibrafeed.core.intake import load_study
    >>> from vibrafeed.core.kinds import run_study
    >>> dataset = run_study(load_study(Path("configs/figures/fig-5-1.toml")))
    >>> figure = draw(dataset, axes=("beta", "alpha"), kind="contour")
    """
    datasets = _datasets(dataset)
    dataset = datasets[0]
    axes = None if axes is None else tuple(map(letter_of, axes))
    options = Options(
        kind, variable, axes, in_letters(at or {}), nearest, title, Style(dark=dark, small=small),
        units_of(dataset, units),
    )  # fmt: skip
    if kind is not None and kind not in PICTURES:
        fix = GONE.get(kind) or suggestion(kind, NAMES)
        raise PlotError("kind", f"'{kind[:40]}' is unknown", fix)
    if nearest and not at:
        message = "nearest is given, but no value of at"
        raise PlotError("nearest", message, "Give at, or leave nearest out")
    if len(datasets) > 1:
        if kind not in (None, "line"):
            fix = "Leave the kind out, or draw each by itself"
            raise PlotError(
                "kind", "several datasets in one picture can only be drawn as lines", fix
            )
        return draw_together(datasets, options)
    if kind is None:
        named = (replace(options, kind=name, is_natural=True) for name in PICTURES)
        options = next(each for each in named if PICTURES[str(each.kind)].fits(dataset, each))
    elif is_calibration(dataset):  # its module says what else there is
        return PICTURES["posterior"].draw(dataset, options)
    return PICTURES[str(options.kind)].draw(dataset, options)


def _datasets(dataset: xarray.Dataset | Sequence[xarray.Dataset]) -> list[xarray.Dataset]:
    """Return one or several datasets as a list; raise `PlotError` if one is none."""
    datasets = list(dataset) if isinstance(dataset, Sequence) else [dataset]
    if not datasets:
        raise PlotError("dataset", "there is none", "Give one or more")
    for each in datasets:
        if not isinstance(each, xarray.Dataset):
            message = f"{reprlib.repr(each)} is not a dataset"
            fix = "Give what `sweep` or `simulate` returned, or the path of a file"
            raise PlotError("dataset", message, fix)
    return datasets
