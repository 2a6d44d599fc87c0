"""Filled and labelled contours over two axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from core.plots.regimes import VEIL, Look, shade, swatch, veiled
from core.plots.scale import scale_of
from core.plots.selection import Selection, thin
from core.plots.text import number, short_label

MOST_POINTS = 1000  # of an axis; a picture shows no more
LINE = "#1a1a1a"


def draw_contour(
    figure: Figure, selection: Selection, looks: Sequence[Look]
) -> tuple[Axes, list[Artist]]:
    """Draw the contours; return the axes and the legend's entries."""
    axes = figure.add_subplot()
    across, up = selection.axes
    columns, rows = thin(across.values.size, MOST_POINTS), thin(up.values.size, MOST_POINTS)
    x, y = across.values[columns], up.values[rows]
    values = np.ma.masked_invalid(selection.values[np.ix_(columns, rows)].T)
    regimes = selection.regimes[np.ix_(columns, rows)].T
    for axis, set_scale in ((across, axes.set_xscale), (up, axes.set_yscale)):
        if axis.is_log:
            set_scale("log")
    scale = scale_of(selection.values)
    if scale is not None:
        filled = axes.contourf(
            x, y, values, levels=scale.levels, cmap=scale.colours, norm=scale.norm,
            extend=scale.extend, zorder=1,
        )  # fmt: skip
        bar = figure.colorbar(filled, ax=axes, pad=0.02, aspect=28)
        bar.set_label(short_label(selection.variable, selection.unit), fontsize=10)
        bar.ax.tick_params(labelsize=9)
        bar.set_ticks(scale.levels.tolist())
    shade(axes, x, y, regimes, looks)
    if scale is not None:
        inner = scale.levels[(scale.levels > values.min()) & (scale.levels < values.max())]
        if inner.size:
            lines = axes.contour(
                x, y, values, levels=inner, colors=[LINE], linewidths=[0.6], zorder=3
            )
            labels = axes.clabel(lines, fontsize=8, fmt=number, inline_spacing=3, zorder=6)
            for label in labels:
                label.set_path_effects([withStroke(linewidth=2.2, foreground="white")])
    axes.set_xlabel(across.label)
    axes.set_ylabel(up.label)
    face = scale.sample if scale is not None else to_rgb(VEIL)
    return axes, [swatch(look, veiled(look, face)) for look in looks]
