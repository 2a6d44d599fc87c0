"""Pictures over two axes: filled contours, lines of equal value, and maps of regimes."""

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.textpath import TextPath
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, uniform_filter

from vibrafeed.core.dataset.table import percent
from vibrafeed.core.plots.line import fits, render
from vibrafeed.core.plots.looks import HATCH_WIDTH, ON_FILL, Look, shade, swatch, veiled_swatch
from vibrafeed.core.plots.parts import (
    GIVES_WAY,
    Plane,
    add_colour_bar,
    cell_edges,
    limit_to_cells,
    number_lines,
    say_nothing_is_finite,
    scale_of,
    set_plane,
    value_range,
)
from vibrafeed.core.plots.selection import PlotAxis, Selection
from vibrafeed.core.plots.style import (
    NARROW,
    RGB,
    SMALL,
    Array,
    Options,
    Style,
    axis_label,
    mix,
    number,
    with_unit,
    words,
)
from vibrafeed.core.quantities.pictures import LEVELS

__all__ = ["draw", "fits"]

MAX_POINTS = 500  # of an axis of cells; one is then two points of the picture wide
BORDER = "#1a1a1a"  # on fills, which are light in every style

PALE = 0.5  # share of the ground colour in the colour of a regime
HATCH = "\\\\"
UNSETTLED = ".."  # the hatch where a speed changes its sign within a band
TEXT_SIZE = 10  # points
BOX = (500.0, 330.0)  # points: width and height of the frame of a normal picture, roughly
RASTER = (250, 165)  # of the frame, in which room for labels is sought
CLEARANCE = 1.3  # of a label's size

Masked = np.ma.MaskedArray[tuple[int, ...], np.dtype[np.float64]]


def _draw_contour(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw filled contours of an output, with regimes hatched and named."""
    axes = figure.add_subplot()
    across, up, values, regimes = set_plane(axes, selection, 1000)
    x, y = across.values, up.values
    scale = scale_of(values, style)
    faces = {look: to_rgb(style.ground) for look in looks}
    if scale is None:
        say_nothing_is_finite(axes, selection, style)
    else:
        faces = {look: scale.typical(values[regimes == look.value]) for look in looks}
        filled = axes.contourf(
            x, y, np.ma.masked_invalid(values), levels=scale.levels, cmap=scale.colours,
            norm=scale.norm, extend=scale.extend, zorder=1,
        )  # fmt: skip
        add_colour_bar(axes, filled, scale, axis_label(selection.variable, selection.unit), style)
    shade(axes, x, y, regimes, faces, style)
    if scale is not None:
        plane = (x, y, np.ma.masked_invalid(values))
        inner = scale.levels[(scale.levels > plane[2].min()) & (scale.levels < plane[2].max())]
        if inner.size:
            lines = axes.contour(
                *plane, levels=inner, colors=[style.on(scale.colour(level)) for level in inner],
                linewidths=[style.width(1.4 if level == 0 else 0.6) for level in inner], zorder=3,
            )  # fmt: skip
            number_lines(axes, lines, style, 8, fmt=number, zorder=6, colors=[style.ink])
        _mark_level(axes, plane, selection, style)
    _add_names(axes, across, up, regimes, looks, style)
    entries: list[Artist] = [veiled_swatch(look, face) for look, face in faces.items()]
    return axes, [*entries, *_hatch_unsettled(axes, selection, style)]


def _mark_level(
    axes: Axes, plane: tuple[Array, Array, Masked], selection: Selection, style: Style
) -> None:
    # The line on which an output passes its threshold, such as throw number 1.
    level, meaning = LEVELS.get(str(selection.variable.name), (np.nan, ""))
    if not plane[2].min() < level < plane[2].max():
        return
    look: Any = {"colors": [style.accent]}
    line = axes.contour(*plane, levels=[level], linewidths=[style.width(2.4)], zorder=7, **look)
    for label in axes.clabel(
        line, fontsize=style.text(9), fmt=f"{number(level)}: {meaning}", inline=False, zorder=8,
        **look,
    )[:1]:  # fmt: skip
        label.set_path_effects([withStroke(linewidth=3.0, foreground=style.ground)])


def _draw_levels(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    # Negative values are dashed, of another colour, and hatched: parts that travel backwards are
    # seen without colours, too.
    axes = figure.add_subplot()
    plane = set_plane(axes, selection, MAX_POINTS)
    across, up, values, regimes = plane
    faces = [mix(look.fill, style.ground, PALE) for look in looks]
    _fill_cells(axes, plane, looks, faces, mix(style.ground, style.ink, 0.45))
    backward = str(selection.variable.attrs.get("units")) == "m s-1"
    entries = _add_lines(axes, plane, "speed" if backward else "value", selection.unit, style)
    if _hatch_below(axes, across.values, up.values, values, style):
        label = "backward" if backward else "below zero"
        entry = Patch(
            facecolor="none", edgecolor=style.accent, hatch=HATCH, hatch_linewidth=HATCH_WIDTH,
            label=label,
        )  # fmt: skip
        entries.append(entry)
    entries += _hatch_unsettled(axes, selection, style)
    _add_names(axes, across, up, regimes, looks, style)
    limit_to_cells(axes, across, up)
    return axes, [*entries, *share_entries(selection.regimes, looks, faces)]


def _hatch_below(axes: Axes, x: Array, y: Array, values: Array, style: Style) -> bool:
    """Hatch the area of a map where values are negative; True if there is any."""
    # Of the largest value; what is smaller counts as 0.
    negative = np.nan_to_num(values) < -1e-6 * np.nanmax(np.abs(values), initial=0.0)
    if not negative.any():
        return False
    shown = np.ones_like(values) if negative.all() else np.ma.masked_invalid(-values)
    area = axes.contourf(
        x, y, shown, levels=[0.0, np.inf], colors=["none"], hatches=[HATCH], zorder=3
    )
    area.set(edgecolor=style.accent, linewidth=0.0, hatch_linewidth=HATCH_WIDTH)
    return True


def _hatch_unsettled(axes: Axes, selection: Selection, style: Style) -> list[Artist]:
    """Hatch the area of a map where a speed changes its sign within a band."""
    if selection.unsettled is None or not selection.unsettled.any():
        return []
    across, up = selection.axes
    look: Any = {"hatch_linewidth": HATCH_WIDTH, "edgecolor": style.quiet}
    area = axes.contourf(
        across.values, up.values, selection.unsettled.T.astype(float), levels=[0.5, 1.5],
        colors=["none"], hatches=[UNSETTLED], zorder=3,
    )  # fmt: skip
    area.set(linewidth=0.0, **look)
    label = f"sign not settled {selection.band_label}"
    return [Patch(facecolor="none", hatch=UNSETTLED, label=label, **look)]


def _add_lines(axes: Axes, plane: Plane, noun: str, unit: str, style: Style) -> list[Artist]:
    """Add level lines with numbers to a map; return the legend entries of the signs that occur."""
    across, up, values, _ = plane
    ends = value_range(values)
    if ends is None:
        return []
    locator = MaxNLocator(10, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(*ends))
    levels = levels[(levels > ends[0]) & (levels < ends[1])]
    masked = np.ma.masked_invalid(values)
    looks: tuple[tuple[int, str, str, float, Literal["solid", "dashed"]], ...] = (
        (1, noun, style.ink, 1.3, "solid"),
        (0, "zero", style.ink, 2.2, "solid"),
        (-1, f"{noun} below zero", style.accent, 1.5, "dashed"),
    )
    entries: list[Artist] = []
    for sign, text, colour, width, dashes in looks:
        levels_of_sign = levels[np.sign(levels) == sign]
        if not levels_of_sign.size:
            continue
        lines = axes.contour(
            across.values, up.values, masked, levels=levels_of_sign, colors=[colour],
            linewidths=[style.width(width)], linestyles=[dashes], zorder=4,
        )  # fmt: skip
        number_lines(axes, lines, style, 8.5, fmt=number, zorder=6)
        label = with_unit(text, f"({unit})" if unit and sign else "")
        entries.append(Line2D([], [], color=colour, linewidth=width, linestyle=dashes, label=label))
    return entries


def _draw_map(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    axes = figure.add_subplot()
    plane = set_plane(axes, selection, MAX_POINTS)
    across, up, _, regimes = plane
    fills = [look.fill for look in looks]
    _fill_cells(axes, plane, looks, fills, BORDER)
    _add_names(axes, across, up, regimes, looks, style, on_fill=True)
    limit_to_cells(axes, across, up)
    return axes, share_entries(selection.regimes, looks, fills)


def _fill_cells(
    axes: Axes, plane: Plane, looks: Sequence[Look], fills: Sequence[RGB], border: str | RGB
) -> None:
    """Fill every cell of a map with the colour of its regime, and draw the borders of regimes.

    `looks` ascend by number; where formulas do not hold they are hatched.
    """
    across, up, _, regimes = plane
    x, y = cell_edges(across), cell_edges(up)
    values = [look.value for look in looks]
    colours = ListedColormap(list(fills))
    axes.pcolormesh(
        x, y, np.searchsorted(values, regimes), cmap=colours, vmin=-0.5, vmax=len(looks) - 0.5,
        rasterized=True, zorder=1,
    )  # fmt: skip
    # Each cell has four points, so that contours follow the sides of cells.
    corners = np.repeat(x, 2)[1:-1], np.repeat(y, 2)[1:-1]
    for look in looks:
        inside = (regimes == look.value).repeat(2, axis=0).repeat(2, axis=1).astype(float)
        if not look.valid and look.hatch:
            area = axes.contourf(
                *corners, inside, levels=[0.5, 1.5], colors=["none"], hatches=[look.hatch], zorder=2
            )
            area.set(edgecolor=look.hatch_ink, linewidth=0.0, hatch_linewidth=HATCH_WIDTH)
        if inside.min() < inside.max():
            axes.contour(
                *corners, inside, levels=[0.5], colors=[border], linewidths=[0.8], zorder=3
            )


def share_entries(
    regimes: NDArray[np.int64], looks: Sequence[Look], fills: Sequence[RGB]
) -> list[Artist]:
    """Return the legend entries of a map: patches of `fills`, with the share of cells of each."""
    entries: list[Artist] = []
    for look, fill in zip(looks, fills, strict=True):
        ink = to_rgb(BORDER) if look.valid else look.hatch_ink
        entry = swatch(look, fill, ink, hatched=not look.valid)
        entry.set_label(f"{look.label}, {percent(float(np.mean(regimes == look.value)))}")
        entries.append(entry)
    return entries


def _cells_at(axis: PlotAxis, edges: Array, count: int) -> NDArray[np.intp]:
    """Return the cell at each of evenly spaced points of an axis as it is drawn."""
    edges_as_drawn = np.log(edges) if axis.is_log else edges
    points = edges_as_drawn[0] + (np.arange(count) + 0.5) / count * (
        edges_as_drawn[-1] - edges_as_drawn[0]
    )
    return np.searchsorted(edges_as_drawn[1:-1], points)


def _add_names(
    axes: Axes,
    across: PlotAxis,
    up: PlotAxis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    style: Style,
    *,
    on_fill: bool = False,
) -> None:
    # On fills a single regime is named, too; each name stands where its region is widest.
    if len(looks) < 2 and not on_fill:
        return
    raster = regimes[
        np.ix_(
            _cells_at(up, cell_edges(up), RASTER[1]),
            _cells_at(across, cell_edges(across), RASTER[0]),
        )
    ]
    font_size = style.text(TEXT_SIZE)
    # In a small frame a text takes a larger share.
    zoom = SMALL / NARROW if style.small else 1.0
    for look in looks:
        bounds = TextPath((0, 0), words(look.name), size=TEXT_SIZE * zoom).get_extents()
        size = (bounds.width, max(bounds.height, TEXT_SIZE * zoom))
        for (width, height), rotation in ((size, 0), (size[::-1], 90)):
            position = _place_for(raster == look.value, width, height)
            if position is not None:
                name = axes.text(
                    *position, words(look.name), transform=axes.transAxes, ha="center", va="center",
                    rotation=rotation, fontsize=font_size, zorder=9,
                    color=ON_FILL if on_fill else style.ink,
                )  # fmt: skip
                name.set_gid(GIVES_WAY)
                halo = look.fill if on_fill else style.ground
                name.set_path_effects([withStroke(linewidth=2.5, foreground=halo)])
                break


def _place_for(
    inside: NDArray[np.bool_], width: float, height: float
) -> tuple[float, float] | None:
    """Return where a label fits best into a region, from 0 to 1 across and up; None if nowhere."""
    columns = math.ceil(width * RASTER[0] / BOX[0] * CLEARANCE)
    rows = math.ceil(height * RASTER[1] / BOX[1] * CLEARANCE)
    framed = np.pad(inside, 1)  # the frame is a border too
    filled = uniform_filter(framed.astype(float), size=(rows, columns), mode="constant")
    # So much of a label's box may lie over other regimes.
    free = filled[1:-1, 1:-1] > 1 - 0.02
    if not free.any():
        return None
    depth = distance_transform_edt(framed)[1:-1, 1:-1]
    row, column = np.meshgrid(*(np.arange(size) for size in inside.shape), indexing="ij")
    distance = np.hypot(row - row[inside].mean(), column - column[inside].mean())
    # A place may be so much less deep if it lies nearer to the middle.
    best = int(np.where(free, depth - 0.1 * distance, -np.inf).argmax())
    return (best % RASTER[0] + 0.5) / RASTER[0], (best // RASTER[0] + 0.5) / RASTER[1]


PAINTERS = {
    "contour": (_draw_contour, "{pale} and hatched"),
    "levels": (_draw_levels, "Hatched"),
    "map": (_draw_map, "Hatched"),
}


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a slice over two axes, of kind contour, levels or map."""
    painter, beyond = PAINTERS[str(options.kind)]
    return render(dataset, options, painter, beyond)
