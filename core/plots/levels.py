"""Lines of equal value, with their numbers, over the pale areas of the regimes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from vibrafeed.core.plots.names import add_names, number_lines
from vibrafeed.core.plots.parts import limit_to_cells, set_plane
from vibrafeed.core.plots.regime_map import MAX_POINTS, add_borders, fill_cells, share_entries
from vibrafeed.core.plots.regimes import HATCH_WIDTH, Look
from vibrafeed.core.plots.scale import value_range
from vibrafeed.core.plots.selection import Selection
from vibrafeed.core.plots.sliced import fits_as, renderer_of
from vibrafeed.core.plots.style import Style, mix
from vibrafeed.core.plots.text import number, with_unit

LINES = 10  # level lines, roughly
PALE = 0.5  # share of the ground colour in the colour of a regime
SPEED = "m s-1"
NOTHING = 1e-6  # of the largest value: smaller ones count as 0
HATCH = "\\\\"
FORWARD, ZERO, BACKWARD = 1.3, 2.2, 1.5  # points


def draw_levels(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw level lines of an output over two axes; return axes and legend entries.

    Positive values have solid lines; negative ones dashed lines in another colour and hatching, so
    that parts travelling backwards can be seen without colours, too. Backgrounds show regimes.
    `selection` has the values and the axes, `looks` the regimes that occur.
    """
    axes = figure.add_subplot()
    across, up, values, regimes = set_plane(axes, selection, MAX_POINTS)
    faces = [mix(look.fill, style.ground, PALE) for look in looks]
    fill_cells(axes, across, up, regimes, looks, faces)
    plain = add_borders(axes, across, up, regimes, looks, colour=mix(style.ground, style.ink, 0.45))
    signs = _add_lines(axes, across.values, up.values, values, style)
    below = _hatch_below(axes, across.values, up.values, values, style)
    add_names(axes, across, up, plain, looks, style)
    limit_to_cells(axes, across, up)
    entries = share_entries(selection.regimes, looks, faces)
    backward = str(selection.variable.attrs.get("units")) == SPEED
    what = "speed" if backward else "value"
    signed = _line_entries(signs, what, selection.unit, style)
    if below:
        signed.append(_below_entry("backward" if backward else "below zero", style))
    return axes, [*signed, *entries]


def _hatch_below(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    values: NDArray[np.float64],
    style: Style,
) -> bool:
    """Hatch the area of a map where values are negative; True if there is any.

    So parts that travel backwards can be seen without colours. `x` and `y` are the axes' values,
    shape (n,) and (m,); `values` has the shape (m, n).
    """
    negative = np.nan_to_num(values) < -NOTHING * np.nanmax(np.abs(values), initial=0.0)
    if not negative.any():
        return False
    shown = np.ones_like(values) if negative.all() else np.ma.masked_invalid(-values)
    area = axes.contourf(
        x, y, shown, levels=[0.0, np.inf], colors=["none"], hatches=[HATCH], zorder=3
    )
    area.set(edgecolor=style.accent, linewidth=0.0, hatch_linewidth=HATCH_WIDTH)
    return True


def _below_entry(label: str, style: Style) -> Artist:
    """Return the legend entry of the hatched area."""
    entry = Patch(facecolor="none", edgecolor=style.accent, hatch=HATCH, label=label)
    entry.set_hatch_linewidth(HATCH_WIDTH)
    return entry


def _add_lines(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    values: NDArray[np.float64],
    style: Style,
) -> set[int]:
    """Add level lines with numbers to a map; return the signs that occur: 1, 0, -1.

    `x` and `y` are the axes' values, shape (n,) and (m,); `values` has the shape (m, n). Lines
    below 0 are dashed and of another colour.
    """
    ends = value_range(values)
    if ends is None:
        return set()
    locator = MaxNLocator(LINES, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(*ends))
    levels = levels[(levels > ends[0]) & (levels < ends[1])]
    masked = np.ma.masked_invalid(values)
    looks = {
        1: (style.ink, FORWARD, "solid"),
        0: (style.ink, ZERO, "solid"),
        -1: (style.accent, BACKWARD, "dashed"),
    }
    signs = set()
    for sign, (colour, width, dashes) in looks.items():
        own = levels[np.sign(levels) == sign]
        if not own.size:
            continue
        signs.add(sign)
        lines = axes.contour(
            x, y, masked, levels=own, colors=[colour], linewidths=[style.width(width)],
            linestyles=[dashes], zorder=4,
        )  # fmt: skip
        number_lines(axes, lines, style, 8.5, fmt=number, zorder=6)
    return signs


def _line_entries(signs: set[int], what: str, unit: str, style: Style) -> list[Artist]:
    """Return the legend entries of level lines: positive, zero and negative values, if they occur.

    `signs` are 1, 0 and -1; `what` is the word for the values, such as speed, and `unit` their
    unit.
    """
    said: dict[int, tuple[str, str, float, Literal["solid", "dashed"]]] = {
        1: (what, style.ink, FORWARD, "solid"),
        0: ("zero", style.ink, ZERO, "solid"),
        -1: (f"{what} below zero", style.accent, BACKWARD, "dashed"),
    }
    entries: list[Artist] = []
    for sign in (1, 0, -1):
        if sign in signs:
            text, colour, width, dashes = said[sign]
            label = with_unit(text, f"({unit})" if unit and sign else "")
            entries.append(
                Line2D([], [], color=colour, linewidth=width, linestyle=dashes, label=label)
            )
    return entries


fits = fits_as("levels")
draw = renderer_of(draw_levels, "levels", beyond="Hatched")
