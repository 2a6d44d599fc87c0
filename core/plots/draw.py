"""The picture of a dataset."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence

import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from core.plots.contour import draw_contour
from core.plots.line import draw_line
from core.plots.problem import PlotError
from core.plots.regime_map import draw_map
from core.plots.regimes import Look, looks_of
from core.plots.selection import Selection, select
from core.plots.surface import draw_surface
from core.plots.text import long_name
from core.plots.trajectory import TIME, draw_trajectory, read_trajectory

SIZE = (8.0, 6.4)  # inches
Painter = Callable[[Figure, Selection, Sequence[Look]], tuple[Axes, list[Artist]]]
PAINTERS: dict[str, Painter] = {
    "contour": draw_contour,
    "surface": draw_surface,
    "line": draw_line,
    "map": draw_map,
}
LINE_LENGTH = 108  # characters of the subtitle
SHORT_LINE = 90  # beside a legend, or above a surface
LEGEND_LENGTH = 112
HANDLE_LENGTH = 10  # the like of a swatch in the legend
TRAJECTORY = "Motion of the part on the moving track"
DOT = " \N{MIDDLE DOT} "
QUIET = "#444444"


def draw(
    dataset: xarray.Dataset,
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, float] | None = None,
    kind: str | None = None,
) -> Figure:
    """Return the picture of an output with the regime shaded, of the regimes, or of one motion.

    Parameters
    ----------
    dataset : xarray.Dataset
        A sweep or simulation, as `core.sweep.sweep` or `core.motion.simulate` returns it or as its
        file is read.
    variable : str, optional
        The output; the first if left out.
    axes : tuple of str, optional
        One or two dimensions, the first across; the longest if left out.
    at : mapping of str to float, optional
        Values of other dimensions, in the unit of the dataset; the middle one if left out.
    kind : str, optional
        contour, surface, line, map or trajectory. If left out: contour over two axes, line over
        one, trajectory where the dataset holds a motion over a cycle. A line with two axes is a
        family of curves, at most seven. A map shows the regimes alone; it and a trajectory have no
        use for `variable`.

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
    >>> from core.plots import draw
    >>> from core.study import load_study
    >>> from core.sweep import sweep
    >>> dataset = sweep(load_study(Path("configs/figures/fig-5-1.toml")))
    >>> figure = draw(dataset, axes=("beta", "alpha"), kind="surface")
    """
    if kind in ("front", "landscape") or (kind is None and not axes and "knee" in dataset):
        from core.plots.optimum import draw_front, draw_landscape  # loads the optimiser

        return draw_landscape(dataset, at) if kind == "landscape" else draw_front(dataset)
    if "regime" not in dataset.data_vars or "scene" not in dataset.attrs:
        fix = "Draw a file that `vibrafeed run` wrote"
        raise PlotError("dataset", "it is no result of vibrafeed: no regime or no scene", fix)
    figure = Figure(figsize=SIZE, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    if kind == "trajectory" or (
        (kind, variable, axes) == (None, None, None) and TIME in dataset.dims
    ):
        trajectory = read_trajectory(dataset, variable, axes, at or {})
        top, entries = draw_trajectory(figure, trajectory)
        name, facts, length = TRAJECTORY, trajectory.facts, LINE_LENGTH
    else:
        selection = select(dataset, variable, axes, at or {}, kind)
        looks = looks_of(dataset["regime"], selection.regimes)
        top, entries = PAINTERS[selection.kind](figure, selection, looks)
        name = "Regimes" if selection.kind == "map" else long_name(selection.variable)
        facts = list(selection.fixed)
        wide = selection.kind in ("contour", "map") or len(selection.axes) == 1
        length = LINE_LENGTH if wide else SHORT_LINE
    heading = figure.suptitle(name, x=0.02, ha="left", fontsize=13, fontweight="bold")
    subtitle = top.set_title(
        _subtitle(facts, length, dataset), loc="left", fontsize=8.5, color=QUIET, linespacing=1.4
    )
    _add_legend(figure, entries)
    figure.draw_without_rendering()
    heading.set_x(subtitle.get_window_extent().x0 / figure.bbox.width)
    return figure


def _subtitle(facts: Sequence[str], length: int, dataset: xarray.Dataset) -> str:
    """Return what is held fixed, and where the values come from, in lines of a length."""
    fixed = [line.strip(DOT) for line in textwrap.wrap(DOT.join(facts), length)]
    parts = (dataset.attrs.get(name) for name in ("scene", "variant", "method"))
    origin = ",\N{NO-BREAK SPACE}".join(str(part) for part in parts if part)
    title = dataset.attrs.get("title")
    source = f"{title} ({origin})" if title else origin
    return "\n".join(fixed + textwrap.wrap(source, length, break_on_hyphens=False))


def _add_legend(figure: Figure, entries: Sequence[Artist]) -> None:
    longest = max((len(str(entry.get_label())) for entry in entries), default=0)
    figure.legend(
        handles=list(entries),
        loc="outside lower left",
        ncols=max(1, min(len(entries), LEGEND_LENGTH // (longest + HANDLE_LENGTH))),
        frameon=False,
        fontsize=9,
        handlelength=3.0,
        handleheight=1.4,
    )
