"""Names of regimes on a plane, and texts that give way to others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.textpath import TextPath
from matplotlib.transforms import BboxBase
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, uniform_filter

from vibrafeed.core.plots.parts import cell_edges
from vibrafeed.core.plots.regimes import ON_FILL, Look
from vibrafeed.core.plots.selection import PlotAxis
from vibrafeed.core.plots.style import NARROW, SMALL, Style
from vibrafeed.core.plots.text import words

TEXT_SIZE = 10  # points
BOX = (500.0, 330.0)  # points: width and height of the frame of a normal picture, roughly
RASTER = (250, 165)  # of the frame, in which room for labels is sought
CLEARANCE = 1.3  # of a label's size
OTHERS = 0.02  # of a label's box that may lie over other regimes
DEPTH_TOLERANCE = 0.1  # how much less deep a place may be that lies nearer to the middle
GIVES_WAY = "gives way"
AIR = 2.0  # dots between texts


def gives_way(text: Text) -> None:
    """Mark a text to be hidden if it would touch others or leave its axes."""
    text.set_gid(GIVES_WAY)


def number_lines(axes: Axes, lines: ContourSet, style: Style, size: float, **look: Any) -> None:
    """Write its value on each line of equal value; a number gives way to what stands there."""
    for label in axes.clabel(lines, fontsize=style.text(size), inline=False, **look):
        gives_way(label)
        label.set_path_effects([withStroke(linewidth=3.0, foreground=style.ground)])


def leave_out_what_meets(figure: Figure) -> None:
    """Hide less important texts of a figure that touch other texts or leave their axes.

    Less important texts, such as numbers on contour lines, are marked by the group id `GIVES_WAY`.
    Of two that touch, the one drawn on top (the larger z-order) stays. The figure has to be laid
    out.
    """
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    kept = [text.get_window_extent(renderer) for text in shown if text.get_gid() != GIVES_WAY]
    loose = [text for text in shown if text.get_gid() == GIVES_WAY]
    for text in sorted(loose, key=lambda text: -text.get_zorder()):
        box = text.get_window_extent(renderer)
        frame = text.axes.get_window_extent() if text.axes else figure.bbox
        if _lies_within(box, frame) and not any(box.padded(AIR).overlaps(other) for other in kept):
            kept.append(box)
        else:
            text.set_visible(False)


def _lies_within(box: BboxBase, frame: BboxBase) -> bool:
    """True if a box lies within a frame."""
    return bool(frame.x0 < box.x0 and frame.y0 < box.y0 and box.x1 < frame.x1 and box.y1 < frame.y1)


def _cells_at(axis: PlotAxis, edges: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """Return the indices of the cells at `count` points spread evenly over an axis as drawn.

    `edges` are the borders of the cells along the axis.
    """
    drawn = np.log(edges) if axis.is_log else edges
    points = drawn[0] + (np.arange(count) + 0.5) / count * (drawn[-1] - drawn[0])
    return np.searchsorted(drawn[1:-1], points)


def add_names(
    axes: Axes,
    across: PlotAxis,
    up: PlotAxis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    style: Style,
    *,
    on_fill: bool = False,
) -> None:
    """Write the name of each regime into a map, where its region is widest, if it has room.

    Parameters
    ----------
    axes : Axes
        Where to write.
    across, up : PlotAxis
        The axes of the map.
    regimes : ndarray, shape (rows, columns)
        Number of the regime of each cell, rows upward.
    looks : sequence of Look
        The regimes that occur, with their colours.
    style : Style
        Colours and sizes.
    on_fill : bool
        True if the cells are filled with the colours of their regimes; else a single regime that is
        everywhere is not named.
    """
    if len(looks) < 2 and not on_fill:
        return
    raster = regimes[
        np.ix_(
            _cells_at(up, cell_edges(up), RASTER[1]),
            _cells_at(across, cell_edges(across), RASTER[0]),
        )
    ]
    text = style.text(TEXT_SIZE)
    # In a small frame a text takes a larger share.
    zoom = SMALL / NARROW if style.small else 1.0
    for look in looks:
        bounds = TextPath((0, 0), words(look.name), size=TEXT_SIZE * zoom).get_extents()
        size = (bounds.width, max(bounds.height, TEXT_SIZE * zoom))
        for (width, height), rotation in ((size, 0), (size[::-1], 90)):
            place = _centre(raster == look.value, width, height)
            if place is not None:
                name = axes.text(
                    *place, words(look.name), transform=axes.transAxes, ha="center", va="center",
                    rotation=rotation, fontsize=text, zorder=9,
                    color=ON_FILL if on_fill else style.ink,
                )  # fmt: skip
                gives_way(name)
                halo = look.fill if on_fill else style.ground
                name.set_path_effects([withStroke(linewidth=2.5, foreground=halo)])
                break


def _centre(inside: NDArray[np.bool_], width: float, height: float) -> tuple[float, float] | None:
    """Return the centre for a text in an area, in shares of the frame; None if it does not fit.

    `inside` is True in the area, on a raster of the frame, shape (rows, columns); `width` and
    `height` are those of the text in points. The place is deep in the area and near its middle.
    """
    columns = math.ceil(width * RASTER[0] / BOX[0] * CLEARANCE)
    rows = math.ceil(height * RASTER[1] / BOX[1] * CLEARANCE)
    framed = np.pad(inside, 1)  # the frame is a border too
    filled = uniform_filter(framed.astype(float), size=(rows, columns), mode="constant")
    free = filled[1:-1, 1:-1] > 1 - OTHERS
    if not free.any():
        return None
    depth = distance_transform_edt(framed)[1:-1, 1:-1]
    row, column = np.meshgrid(*(np.arange(n) for n in inside.shape), indexing="ij")
    aside = np.hypot(row - row[inside].mean(), column - column[inside].mean())
    best = int(np.where(free, depth - DEPTH_TOLERANCE * aside, -np.inf).argmax())
    return (best % RASTER[0] + 0.5) / RASTER[0], (best // RASTER[0] + 0.5) / RASTER[1]
