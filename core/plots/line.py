"""A line over one axis, or a family of lines over a second one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibrafeed.core.plots.parts import (
    cell_edges,
    padded,
    say_nothing_is_finite,
    set_log,
    value_range,
)
from vibrafeed.core.plots.regimes import HATCH_WIDTH, MOTION, PLAIN, Look, swatch
from vibrafeed.core.plots.selection import FEW, PlotAxis, Selection, thin
from vibrafeed.core.plots.sliced import fits, render
from vibrafeed.core.plots.style import Options, Style, mix
from vibrafeed.core.plots.text import axis_label, number, short_label, with_unit
from vibrafeed.core.quantities.pictures import LEVELS

__all__ = ["draw", "fits"]

MAX_CURVES = FEW
MAX_MARKED = 12  # points of a curve that are marked: between them nothing was computed
MAX_RUNS = 20  # of a regime; the borders of more would hide the curve
STRIP = 0.055  # of the height of the curves: the strip of regimes of one curve
BAND = 0.4  # opacity of the band of a spread
DASHES = ((4.0, 2.0), (1.0, 1.5), (7.0, 2.0, 1.0, 2.0), (3.0, 1.5, 1.0, 1.5, 1.0, 1.5))

Dashes = tuple[float, tuple[float, ...]] | Literal["solid"]
Colour = tuple[float, float, float] | str


def draw_line(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw curves of an output over one axis; return its axes and the legend entries of regimes.

    `selection` has the values, regimes and axes in the units of the picture; a second axis makes a
    family of at most seven curves. `looks` are the regimes that occur with their colours. Outputs
    that have a name in each cell are drawn as strips.
    """
    across = selection.axes[0]
    chosen = thin(selection.axes[1].values.size, MAX_CURVES) if len(selection.axes) > 1 else [0]
    regimes = selection.regimes.reshape(across.values.size, -1)[:, chosen]
    if selection.categories:
        return _draw_categories(figure, selection, regimes, looks, style, chosen)
    values = selection.values.reshape(across.values.size, -1)[:, chosen]
    colours: list[Colour] = [*style.series_over(len(chosen))] if len(chosen) > 1 else [style.curve]
    axes, entries, alike = _draw_regimes(figure, selection, regimes, looks, style, chosen)
    for colour, curve, states in zip(colours, values.T, regimes.T, strict=True):
        for look in looks:
            stroke = _style(look, looks, alike)
            _part(axes, across.values, curve, states, look, stroke, colour)
        if across.values.size <= MAX_MARKED:
            axes.plot(across.values, curve, "o", color=colour, markersize=style.width(4), zorder=4)
        _mark_edges(axes, across.values, curve, states, looks, style)
    if selection.spread is not None and selection.spread.any():
        spread = selection.spread.reshape(across.values.size, -1)[:, chosen]
        entries.append(_add_bands(axes, across.values, values, spread, colours, style))
        values = np.concatenate([values - spread, values + spread])
    if len(selection.axes) > 1:
        _name_curves(figure, selection, selection.axes[1].values[chosen], colours)
    _limit(axes, across, values, style)
    if value_range(values) is None:
        say_nothing_is_finite(axes, selection, style)
        axes.set_yticks([])
    _mark_level(axes, selection, style)
    axes.set_ylabel(short_label(selection.variable, selection.unit))
    style.add_grid(axes)
    return axes, entries


def _draw_regimes(
    figure: FigureBase,
    selection: Selection,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    style: Style,
    chosen: Sequence[int] | NDArray[np.int64],
) -> tuple[Axes, list[Artist], bool]:
    """Draw the regimes of curves, and return the axes for the curves, legend entries, and a flag.

    Curves that all have the same regimes stand on coloured backgrounds. Else each curve shows them
    by its dashes, or if these are too few for all regimes by a strip below. The flag is true if the
    dashes need not show them.

    Parameters
    ----------
    regimes : ndarray, shape (points, curves)
        The number of the regime at each point.
    looks : sequence of Look
        Names and colours of the regimes that occur.
    chosen : sequence of int
        Positions of the curves on the second axis of `selection`.
    """
    across = selection.axes[0]
    alike = bool((regimes == regimes[:, :1]).all())
    striped = not alike and len({_style(look, looks, alike) for look in looks}) < len(looks)
    if striped:
        heights = (1.0, STRIP * len(chosen))
        axes, lowest = figure.subplots(2, 1, sharex=True, height_ratios=heights)
        _add_strips(lowest, across, regimes, looks, _labels(selection, chosen))
        entries: list[Artist] = [swatch(look, look.fill, hatched=not look.valid) for look in looks]
    else:
        axes = lowest = figure.add_subplot()
    if across.is_log:
        set_log(axes.xaxis, across.values)
    if alike:
        _spans(axes, across, regimes[:, 0], looks, style)
        entries = [swatch(look, look.tint, hatched=look.name not in MOTION) for look in looks]
    elif not striped:
        entries = [_handle(look, looks, style) for look in looks]
    lowest.set_xlabel(across.label)
    return axes, entries, alike or striped


def _draw_categories(
    figure: FigureBase,
    selection: Selection,
    codes: NDArray[np.int64],
    looks: Sequence[Look],
    style: Style,
    chosen: Sequence[int] | NDArray[np.int64],
) -> tuple[Axes, list[Artist]]:
    """Draw an output that has a name in each cell as strips; return axes and legend entries.

    There is one strip for each value of the second axis of `selection`, or one if there is none.

    Parameters
    ----------
    codes : ndarray, shape (points, strips)
        The number of the name at each point.
    looks : sequence of Look
        Colour and name for each number.
    chosen : sequence of int
        Positions of the strips on the second axis.
    """
    axes = figure.add_subplot()
    across = selection.axes[0]
    if across.is_log:
        set_log(axes.xaxis, across.values)
    several = len(selection.axes) > 1
    labels = _labels(selection, chosen) if several else [""]
    _add_strips(axes, across, codes, looks, labels)
    axes.set_xlim(across.values[0], across.values[-1])
    axes.set_xlabel(across.label)
    if not several:
        axes.set(ylim=(-0.4, 0.4), yticks=[])
    else:
        axes.set_ylabel(axis_label(selection.variable[selection.axes[1].name], ""))
    return axes, [swatch(look, look.fill, hatched=False) for look in looks]


def _labels(selection: Selection, chosen: Sequence[int] | NDArray[np.int64]) -> list[str]:
    """Return the chosen values of the second axis as texts with units."""
    second = selection.axes[1]
    return [with_unit(number(value, 4), second.unit) for value in second.values[chosen]]


def _mark_level(axes: Axes, selection: Selection, style: Style) -> None:
    """Draw a threshold of the output, such as throw number 1, as a line across a picture of curves.

    Thresholds are those of `LEVELS`; the line is drawn if it is in the visible range. `selection`
    tells which output the curves show.
    """
    level, begins = LEVELS.get(str(selection.variable.name), (np.nan, ""))
    low, high = axes.get_ylim()
    if low < level < high:
        axes.axhline(level, color=style.accent, linewidth=style.width(1.6), zorder=1.8)
        axes.annotate(
            f"{number(level)}: {begins}", (0.01, level), xycoords=axes.get_yaxis_transform(),
            xytext=(0, 3), textcoords="offset points", color=style.accent,
            fontsize=style.text(9), zorder=6,
            path_effects=[withStroke(linewidth=3.0, foreground=style.ground)],
        )  # fmt: skip


def _add_bands(
    axes: Axes,
    x: NDArray[np.float64],
    values: NDArray[np.float64],
    spread: NDArray[np.float64],
    colours: list[Colour],
    style: Style,
) -> Artist:
    """Add a light band of plus and minus the spread around each curve; return its legend entry.

    `x` has the shape (points,), `values` and `spread` (points, curves), all in the units of the
    picture. The spread is the scatter of a speed that does not repeat. `colours` are those of the
    curves.
    """
    for curve, width, colour in zip(values.T, spread.T, colours, strict=True):
        if width.any():
            axes.fill_between(
                x, curve - width, curve + width, color=colour, alpha=BAND, linewidth=0, zorder=1.5
            )
    shown = colours[0] if len(colours) == 1 else style.quiet
    return Patch(facecolor=mix(shown, style.ground, 1 - BAND), label="\N{PLUS-MINUS SIGN} spread")


def _add_strips(
    axes: Axes,
    across: PlotAxis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    labels: list[str],
) -> None:
    """Draw the regimes, or categories, of each curve as a strip along the horizontal axis.

    Parameters
    ----------
    across : PlotAxis
        The horizontal axis.
    regimes : ndarray, shape (points, strips)
        The number of the regime at each point of each strip.
    looks : sequence of Look
        Number, colour and hatching of each regime.
    labels : list of str
        The name of each strip, on the vertical axis.
    """
    edges = cell_edges(across)
    by_value = {look.value: look for look in looks}
    for row, states in enumerate(regimes.T):
        for value, start, stop in _runs(states):
            look = by_value[value]
            bar = axes.broken_barh(
                [(edges[start], edges[stop] - edges[start])], (row - 0.4, 0.8), facecolor=look.fill
            )
            bar.set_linewidth(0)
            if not look.valid:
                bar.set(hatch=look.hatch, edgecolor=look.hatch_ink, hatch_linewidth=HATCH_WIDTH)
    axes.set_ylim(-0.6, len(labels) - 0.4)
    axes.set_yticks(range(len(labels)), labels)
    axes.tick_params(axis="y", length=0)


def _runs(states: NDArray[np.int64]) -> list[tuple[int, int, int]]:
    """Return value, first index and end index of each run of equal values."""
    changes = [0, *(np.flatnonzero(np.diff(states)) + 1).tolist(), states.size]
    return [(int(states[start]), start, stop) for start, stop in pairwise(changes)]


def _style(look: Look, looks: Sequence[Look], alike: bool) -> tuple[float, tuple[float, ...]]:
    """Return the line width and the dash pattern of a curve in a regime, in units of matplotlib.

    Curves are solid, an empty pattern, where the formulas hold, and dashed in regimes where they do
    not, each with a pattern of its own. `look` is the regime, `looks` are all that occur; with
    `alike` the background tells the regimes apart, and strokes need not.
    """
    if look.valid:
        return PLAIN[-1] if alike else look.width, ()
    rank = 0 if alike else [other for other in looks if not other.valid].index(look)
    return look.width, DASHES[rank % len(DASHES)]


def _draw_style(dashes: tuple[float, ...]) -> Dashes:
    """Return the line style of dashes."""
    return (0.0, dashes) if dashes else "solid"


def _handle(look: Look, looks: Sequence[Look], style: Style) -> Line2D:
    """Return the legend entry of a regime `look` among those that occur, with its stroke.

    The stroke is the width and the dashes of curves in that regime.
    """
    width, dashes = _style(look, looks, alike=False)
    return Line2D(
        [], [], color=style.ink, linewidth=width, linestyle=_draw_style(dashes), label=look.label
    )


def _part(
    axes: Axes,
    x: NDArray[np.float64],
    curve: NDArray[np.float64],
    states: NDArray[np.int64],
    look: Look,
    style: tuple[float, tuple[float, ...]],
    colour: Colour,
) -> None:
    """Draw a curve where it is in one regime, up to the first point of the next regime.

    `x`, `curve` and `states`, the numbers of the regimes, have the shape (points,); `look` is the
    regime to draw, and `style` the line's width and dashes. `colour` is that of the curve.
    """
    here = states == look.value
    if not here.any():
        return
    here[1:] |= here[:-1]
    width, dashes = style
    axes.plot(
        x,
        np.where(here, curve, np.nan),
        color=colour if look.valid else mix(colour, "#9a9a9a", 0.35),
        linewidth=width,
        linestyle=_draw_style(dashes),
        solid_capstyle="butt",
        marker="o" if here.sum() == 1 else "",
        markersize=3,
    )


def _mark_edges(
    axes: Axes,
    x: NDArray[np.float64],
    curve: NDArray[np.float64],
    states: NDArray[np.int64],
    looks: Sequence[Look],
    style: Style,
) -> None:
    """Mark the points of a curve at which it leaves a regime where the formulas hold.

    `x` and `curve` are its points and `states` the numbers of their regimes, all of shape (n,);
    `looks` tell which regimes are valid. The mark is at the last valid point.
    """
    valid = np.isin(states, [look.value for look in looks if look.valid])
    last = np.flatnonzero(valid[:-1] != valid[1:])
    last = np.where(valid[last], last, last + 1)
    axes.plot(x[last], curve[last], "o", color=style.ink, markersize=style.width(4.5), zorder=5)


def _spans(
    axes: Axes, across: PlotAxis, states: NDArray[np.int64], looks: Sequence[Look], style: Style
) -> None:
    """Colour the background of a curve by regime, with borders half-way between two points.

    Parameters
    ----------
    across : PlotAxis
        The horizontal axis, with n values.
    states : ndarray, shape (n,)
        The number of the regime at each of them.
    looks : sequence of Look
        Name, colour and hatching of each regime. Borders at which formulas begin or cease to hold
        are drawn heavily, the others only if they are few.
    """
    edges = cell_edges(across)
    by_value = {look.value: look for look in looks}
    runs = _runs(states)
    for value, start, stop in runs:
        look = by_value[value]
        area = axes.axvspan(edges[start], edges[stop], facecolor=look.tint, linewidth=0, zorder=0)
        if look.hatch and look.name not in MOTION:
            ink = mix(look.hatch_ink, style.ground, 0.55)
            area.set(hatch=look.hatch, edgecolor=ink, hatch_linewidth=HATCH_WIDTH)
    for (before, _, _), (after, start, _) in pairwise(runs):
        leaves = by_value[before].valid != by_value[after].valid
        if leaves or len(runs) <= MAX_RUNS:
            axes.axvline(
                edges[start], color=style.ink if leaves else style.quiet,
                linewidth=style.width(2.0 if leaves else 0.8),
            )  # fmt: skip


def _name_curves(
    figure: FigureBase, selection: Selection, values: NDArray[np.float64], colours: list[Colour]
) -> None:
    """Add a legend that tells curves apart by their values on the second axis of `selection`.

    `values` and `colours` are those of the curves.
    """
    second = selection.axes[1]
    handles = [
        Line2D([], [], color=colour, linewidth=1.8, label=with_unit(number(value, 4), second.unit))
        for value, colour in zip(values, colours, strict=True)
    ]
    whole = figure.get_figure(root=True) or figure
    title = axis_label(selection.variable[second.name], "")
    if values.size < second.values.size:
        title += f"\n{values.size} of {second.values.size} values"
    whole.legend(
        handles=handles[::-1],
        title=title,
        loc="outside right upper",
        frameon=False,
        alignment="left",
    )


def _limit(axes: Axes, across: PlotAxis, values: NDArray[np.float64], style: Style) -> None:
    """Set the limits of both axes of a picture of curves, and draw a line at 0 between two signs.

    `across` is the horizontal axis; `values` are all values drawn, of any shape, NaN where there
    are none. Outliers, as at a pole, do not count.
    """
    axes.set_xlim(across.values[0], across.values[-1])
    ends = value_range(values)
    if ends is None:
        return
    axes.set_ylim(*padded(*ends))
    if ends[0] < 0 < ends[1]:
        axes.axhline(0.0, color=style.quiet, linewidth=0.7, zorder=1)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a slice over one axis, or a family of curves.

    Raises
    ------
    PlotError
        If the dataset does not have what is asked for.
    """
    return render(dataset, options, draw_line, "Hatched or dashed")
