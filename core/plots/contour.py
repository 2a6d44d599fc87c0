"""Filled and labelled contours over two axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from core.plots.parts import add_colour_bar, set_log
from core.plots.regimes import VEIL, Look, shade, veiled_swatch
from core.plots.scale import Scale, scale_of
from core.plots.selection import Selection, thin
from core.plots.text import number

MOST_POINTS = 1000  # of an axis; a picture shows no more
LINE = "#1a1a1a"
MARGIN = 0.035  # of the frame, free of labels
APART = 0.05  # of the frame, between labels


def draw_contour(
    figure: Figure, selection: Selection, looks: Sequence[Look]
) -> tuple[Axes, list[Artist]]:
    """Draw the contours; return the axes and the legend's entries."""
    axes = figure.add_subplot()
    across, up = selection.axes
    columns, rows = thin(across.values.size, MOST_POINTS), thin(up.values.size, MOST_POINTS)
    x, y = across.values[columns], up.values[rows]
    part = np.ix_(columns, rows)
    values, regimes = selection.values[part].T, selection.regimes[part].T
    for axis, spine in ((across, axes.xaxis), (up, axes.yaxis)):
        if axis.is_log:
            set_log(spine, axis.values)
    scale = scale_of(values)
    faces = {look: to_rgb(VEIL) for look in looks}
    if scale is not None:
        faces = {look: scale.typical(values[regimes == look.value]) for look in looks}
        filled = axes.contourf(
            x, y, np.ma.masked_invalid(values), levels=scale.levels, cmap=scale.colours,
            norm=scale.norm, extend=scale.extend, zorder=1,
        )  # fmt: skip
        add_colour_bar(figure, axes, filled, scale, selection, pad=0.02, aspect=28)
    shade(axes, x, y, regimes, faces)
    if scale is not None:
        _add_lines(axes, x, y, np.ma.masked_invalid(values), scale)
    axes.set_xlabel(across.label)
    axes.set_ylabel(up.label)
    return axes, [veiled_swatch(look, face) for look, face in faces.items()]


def _add_lines(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    values: np.ma.MaskedArray[tuple[int, ...], np.dtype[np.float64]],
    scale: Scale,
) -> None:
    """Add contour lines with labels, but for those that would cross the frame or each other."""
    inner = scale.levels[(scale.levels > values.min()) & (scale.levels < values.max())]
    if not inner.size:
        return
    widths = np.where(inner == 0, 1.4, 0.6).tolist()
    lines = axes.contour(x, y, values, levels=inner, colors=[LINE], linewidths=widths, zorder=3)
    kept: list[NDArray[np.float64]] = []
    into_frame = axes.transData + axes.transAxes.inverted()
    for label in axes.clabel(lines, fontsize=8, fmt=number, inline=False, zorder=6):
        place = into_frame.transform(label.get_position())
        inside = bool((np.abs(place - 0.5) < 0.5 - MARGIN).all())
        if inside and all(np.hypot(*(place - other)) > APART for other in kept):
            kept.append(place)
        else:
            label.set_visible(False)
        label.set_path_effects([withStroke(linewidth=3.0, foreground="white")])
