"""A map of the regimes over two axes: each cell in the fill of its regime."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import FigureBase
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import percent
from vibrafeed.core.plots.islands import without_specks
from vibrafeed.core.plots.names import add_names
from vibrafeed.core.plots.parts import cell_edges, limit_to_cells, set_plane
from vibrafeed.core.plots.regimes import HATCH_WIDTH, Look, swatch
from vibrafeed.core.plots.selection import PlotAxis, Selection
from vibrafeed.core.plots.sliced import fits_as, renderer_of
from vibrafeed.core.plots.style import RGB, Style

MAX_POINTS = 500  # of an axis; a cell is then two points of the picture wide
BORDER = "#1a1a1a"  # on fills, which are light in every style


def draw_map(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw a map of regimes over two axes; return its axes and legend entries with shares of cells.

    Each cell is filled with the colour of its regime, and large regions are named in the map.
    `selection` has the regimes and the two axes, `looks` the colours of the regimes that occur.
    """
    axes = figure.add_subplot()
    across, up, _, regimes = set_plane(axes, selection, MAX_POINTS)
    fill_cells(axes, across, up, regimes, looks, [look.fill for look in looks])
    plain = add_borders(axes, across, up, regimes, looks)
    add_names(axes, across, up, plain, looks, style, on_fill=True)
    limit_to_cells(axes, across, up)
    return axes, share_entries(selection.regimes, looks, [look.fill for look in looks])


def fill_cells(
    axes: Axes,
    across: PlotAxis,
    up: PlotAxis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    fills: Sequence[RGB],
) -> None:
    """Fill every cell of a map with the colour of its regime, hatched where formulas do not hold.

    Parameters
    ----------
    across, up : PlotAxis
        The axes of the map.
    regimes : ndarray, shape (up, across)
        The number of the regime of each cell.
    looks : sequence of Look
        The regimes that occur, ascending by number.
    fills : sequence of RGB
        Their colours.
    """
    x, y = cell_edges(across), cell_edges(up)
    values = [look.value for look in looks]  # ascending
    colours = ListedColormap(list(fills))
    axes.pcolormesh(
        x, y, np.searchsorted(values, regimes), cmap=colours, vmin=-0.5, vmax=len(looks) - 0.5,
        rasterized=True, zorder=1,
    )  # fmt: skip
    for look in looks:
        if not look.valid and look.hatch:
            corners, cells = _as_corners(x, y, regimes == look.value)
            area = axes.contourf(
                *corners, cells, levels=[0.5, 1.5], colors=["none"], hatches=[look.hatch], zorder=2
            )
            area.set(edgecolor=look.hatch_ink, linewidth=0.0, hatch_linewidth=HATCH_WIDTH)


def add_borders(
    axes: Axes,
    across: PlotAxis,
    up: PlotAxis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    colour: str | RGB = BORDER,
) -> NDArray[np.int64]:
    """Draw borders between the regimes of a map; return the regimes without tiny islands.

    `regimes` has the number of the regime of each cell, shape (up, across), and the result the
    same; islands have no borders. `looks` are the regimes that occur.
    """
    x, y = cell_edges(across), cell_edges(up)
    plain = without_specks(regimes)
    for look in looks:
        inside = plain == look.value
        if inside.min() < inside.max():
            corners, cells = _as_corners(x, y, inside)
            axes.contour(*corners, cells, levels=[0.5], colors=[colour], linewidths=[0.8], zorder=3)
    return plain


def _as_corners(
    x: NDArray[np.float64], y: NDArray[np.float64], inside: NDArray[np.bool_]
) -> tuple[tuple[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    """Return each cell as four points, so that contours follow the sides of cells.

    The results are x, y and the values at these points: 1 in cells that are `inside`, else 0. `x`
    and `y` are the borders of the cells.
    """
    corners = np.repeat(x, 2)[1:-1], np.repeat(y, 2)[1:-1]
    return corners, inside.repeat(2, axis=0).repeat(2, axis=1).astype(float)


def share_entries(
    regimes: NDArray[np.int64], looks: Sequence[Look], fills: Sequence[RGB]
) -> list[Artist]:
    """Return the legend entries of a map of regimes, each with the share of cells in that regime.

    `regimes` has the number of the regime or category in each cell, of any shape; `fills` are the
    colours of `looks`, one each.
    """
    return [
        _entry(look, fill, float(np.mean(regimes == look.value)))
        for look, fill in zip(looks, fills, strict=True)
    ]


def _entry(look: Look, fill: RGB, share: float) -> Artist:
    """Return the legend entry of a regime, a patch of the colour `fill`, with its share.

    `share` is that of the cells in this regime, 0 to 1.
    """
    ink = to_rgb(BORDER) if look.valid else look.hatch_ink
    entry = swatch(look, fill, ink, hatched=not look.valid)
    entry.set_label(f"{look.label}, {percent(share)}")
    return entry


fits = fits_as("map")
draw = renderer_of(draw_map, "map", beyond="Hatched")
