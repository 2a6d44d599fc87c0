"""Filled and labelled contours over two axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import FigureBase
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibrafeed.core.plots.islands import without_specks
from vibrafeed.core.plots.names import add_names, number_lines
from vibrafeed.core.plots.parts import add_colour_bar, say_nothing_is_finite, set_plane
from vibrafeed.core.plots.regimes import Look, shade, veiled_swatch
from vibrafeed.core.plots.scale import Scale, scale_of
from vibrafeed.core.plots.selection import Selection
from vibrafeed.core.plots.sliced import fits_as, renderer_of
from vibrafeed.core.plots.style import Style
from vibrafeed.core.plots.text import number
from vibrafeed.core.quantities.pictures import LEVELS

MAX_POINTS = 1000  # of an axis; a picture shows no more

Array = NDArray[np.float64]
Masked = np.ma.MaskedArray[tuple[int, ...], np.dtype[np.float64]]


def draw_contour(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw an output over two axes as filled, labelled contours; return axes and legend entries.

    `selection` has the output's values and its two axes, in the units of the picture. `looks` are
    the regimes that occur with their colours; those where formulas do not hold are shaded.
    """
    axes = figure.add_subplot()
    across, up, values, regimes = set_plane(axes, selection, MAX_POINTS)
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
        add_colour_bar(figure, axes, filled, scale, selection, style, pad=0.02, aspect=28)
    shade(axes, x, y, regimes, faces, style)
    if scale is not None:
        shown = np.ma.masked_invalid(values)
        _add_lines(axes, x, y, shown, scale, style)
        _mark_level(axes, x, y, shown, selection, style)
    add_names(axes, across, up, without_specks(regimes), looks, style)
    return axes, [veiled_swatch(look, face) for look, face in faces.items()]


def _add_lines(axes: Axes, x: Array, y: Array, values: Masked, scale: Scale, style: Style) -> None:
    """Add contour lines to a filled picture, with numbers that avoid other texts.

    `x` and `y` are the values of the axes, `values` those of the output, shape (y, x), masked where
    not finite; `scale` has the levels and their colours. The line of 0 is heavier.
    """
    inner = scale.levels[(scale.levels > values.min()) & (scale.levels < values.max())]
    if not inner.size:
        return
    lines = axes.contour(
        x, y, values, levels=inner, colors=[style.on(scale.colour(level)) for level in inner],
        linewidths=[style.width(1.4 if level == 0 else 0.6) for level in inner], zorder=3,
    )  # fmt: skip
    number_lines(axes, lines, style, 8, fmt=number, zorder=6, colors=[style.ink])


def _mark_level(
    axes: Axes, x: Array, y: Array, values: Masked, selection: Selection, style: Style
) -> None:
    """Draw the line on which an output passes its threshold, such as throw number 1, and label it.

    `x` and `y` are the values of the axes, `values` those of the output, shape (y, x), masked where
    not finite. Thresholds of outputs are those of `LEVELS`; without one, or where the output does
    not pass it, nothing is drawn. `selection` tells which output it is.
    """
    level, begins = LEVELS.get(str(selection.variable.name), (np.nan, ""))
    if not values.min() < level < values.max():
        return
    line = axes.contour(
        x, y, values, levels=[level], colors=[style.accent], linewidths=[style.width(2.4)], zorder=7
    )
    for label in axes.clabel(
        line, fontsize=style.text(9), fmt=f"{number(level)}: {begins}", inline=False, zorder=8,
        colors=[style.accent],
    )[:1]:  # fmt: skip
        label.set_path_effects([withStroke(linewidth=3.0, foreground=style.ground)])


fits = fits_as("contour")
draw = renderer_of(draw_contour, "contour", beyond="{pale} and hatched")
