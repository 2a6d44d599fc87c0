"""A line over one axis, or a family of lines over a second one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from core.plots.parts import add_room, cell_edges, set_log
from core.plots.regimes import EDGE, HATCH_WIDTH, MOTION, PLAIN, VEIL, Look, mix, swatch
from core.plots.scale import value_range
from core.plots.selection import Axis, Selection, thin
from core.plots.text import axis_label, number, short_label, with_unit

MOST_CURVES = 7
MOST_RUNS = 20  # of a regime; the borders of more would hide the curve
STRIP = 0.055  # of the height of the curves
BAND = 0.4  # strength of the colour of a spread
CURVE = "#1f3b73"
DASHES = ((4.0, 2.0), (1.0, 1.5), (7.0, 2.0, 1.0, 2.0), (3.0, 1.5, 1.0, 1.5, 1.0, 1.5))

Dashes = tuple[float, tuple[float, ...]] | Literal["solid"]
Colour = tuple[float, float, float] | str


def draw_line(
    figure: Figure, selection: Selection, looks: Sequence[Look]
) -> tuple[Axes, list[Artist]]:
    """Draw the lines; return the axes and the legend's entries for the regimes."""
    across = selection.axes[0]
    chosen = thin(selection.axes[1].values.size, MOST_CURVES) if len(selection.axes) > 1 else [0]
    values = selection.values.reshape(across.values.size, -1)[:, chosen]
    regimes = selection.regimes.reshape(across.values.size, -1)[:, chosen]
    alike = bool((regimes == regimes[:, :1]).all())
    colours = _colours(len(chosen))
    entries: list[Artist] = []
    # Where the strokes of a curve cannot tell all regimes apart, a strip below the curves does.
    striped = not alike and len({_style(look, looks, alike) for look in looks}) < len(looks)
    if striped:
        heights = (1.0, STRIP * len(chosen))
        axes, strips = figure.subplots(2, 1, sharex=True, height_ratios=heights)
        second = selection.axes[1]
        labels = [with_unit(number(value, 4), second.unit) for value in second.values[chosen]]
        _add_strips(strips, across, regimes, looks, labels)
        lowest = strips
        entries += [swatch(look, look.fill, hatched=not look.valid) for look in looks]
    else:
        lowest = axes = figure.add_subplot()
    if across.is_log:
        set_log(axes.xaxis, across.values)
    if alike:
        _spans(axes, across, regimes[:, 0], looks)
        entries += [swatch(look, look.tint, hatched=look.name not in MOTION) for look in looks]
    elif not striped:
        entries += [_handle(look, looks) for look in looks]
    for colour, curve, states in zip(colours, values.T, regimes.T, strict=True):
        for look in looks:
            style = _style(look, looks, alike or striped)
            _part(axes, across.values, curve, states, look, style, colour)
        _mark_edges(axes, across.values, curve, states, looks)
    if selection.spread is not None and selection.spread.any():
        spread = selection.spread.reshape(across.values.size, -1)[:, chosen]
        entries.append(_add_bands(axes, across.values, values, spread, colours))
        values = np.concatenate([values - spread, values + spread])
    if len(selection.axes) > 1:
        _name_curves(figure, selection, selection.axes[1].values[chosen], colours)
    _limit(axes, across, values)
    lowest.set_xlabel(across.label)
    axes.set_ylabel(short_label(selection.variable, selection.unit))
    axes.grid(visible=True, color="#000000", alpha=0.12, linewidth=0.6)
    axes.set_axisbelow(True)
    return axes, entries


def _add_bands(
    axes: Axes,
    x: NDArray[np.float64],
    values: NDArray[np.float64],
    spread: NDArray[np.float64],
    colours: list[Colour],
) -> Artist:
    """Add a light band about each curve; return the legend's entry."""
    for curve, width, colour in zip(values.T, spread.T, colours, strict=True):
        if width.any():
            axes.fill_between(
                x, curve - width, curve + width, color=colour, alpha=BAND, linewidth=0, zorder=1.5
            )
    shown = colours[0] if len(colours) == 1 else "#555555"
    return Patch(facecolor=mix(shown, VEIL, 1 - BAND), label="\N{PLUS-MINUS SIGN} spread")


def _add_strips(
    axes: Axes,
    across: Axis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    labels: list[str],
) -> None:
    """Show the regimes of each curve in a strip."""
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
                bar.set(hatch=look.hatch, edgecolor=mix(look.colour, VEIL, 0.35))
                bar.set_hatch_linewidth(HATCH_WIDTH)
    axes.set_ylim(-0.6, len(labels) - 0.4)
    axes.set_yticks(range(len(labels)), labels)
    axes.tick_params(axis="y", length=0, labelsize=8)


def _runs(states: NDArray[np.int64]) -> list[tuple[int, int, int]]:
    """Return value, first position and end of each run of equal states."""
    changes = [0, *(np.flatnonzero(np.diff(states)) + 1).tolist(), states.size]
    return [(int(states[start]), start, stop) for start, stop in pairwise(changes)]


def _colours(count: int) -> list[Colour]:
    if count == 1:
        return [CURVE]
    shades = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, count))
    return [(float(r), float(g), float(b)) for r, g, b, _ in shades]


def _style(look: Look, looks: Sequence[Look], alike: bool) -> tuple[float, tuple[float, ...]]:
    """Return width and dashes of a curve in a regime; backgrounds, if any, name the regime."""
    if look.valid:
        return PLAIN[-1] if alike else look.width, ()
    rank = 0 if alike else [other for other in looks if not other.valid].index(look)
    return look.width, DASHES[rank % len(DASHES)]


def _draw_style(dashes: tuple[float, ...]) -> Dashes:
    return (0.0, dashes) if dashes else "solid"


def _handle(look: Look, looks: Sequence[Look]) -> Line2D:
    width, dashes = _style(look, looks, alike=False)
    return Line2D(
        [], [], color="#222222", linewidth=width, linestyle=_draw_style(dashes), label=look.label
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
    """Draw a curve where it is in one regime, up to the first point of the next."""
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
) -> None:
    """Put a dot where a curve leaves what the closed forms describe."""
    valid = np.isin(states, [look.value for look in looks if look.valid])
    last = np.flatnonzero(valid[:-1] != valid[1:])
    last = np.where(valid[last], last, last + 1)
    axes.plot(x[last], curve[last], "o", color=EDGE, markersize=4.5, zorder=5)


def _spans(axes: Axes, across: Axis, states: NDArray[np.int64], looks: Sequence[Look]) -> None:
    """Colour the background by regime; borders lie halfway between two points."""
    edges = cell_edges(across)
    by_value = {look.value: look for look in looks}
    runs = _runs(states)
    for value, start, stop in runs:
        look = by_value[value]
        area = axes.axvspan(edges[start], edges[stop], facecolor=look.tint, linewidth=0, zorder=0)
        if look.hatch and look.name not in MOTION:
            area.set(hatch=look.hatch, edgecolor=mix(look.colour, VEIL, 0.72))
            area.set_hatch_linewidth(HATCH_WIDTH)
    for (before, _, _), (after, start, _) in pairwise(runs):
        leaves = by_value[before].valid != by_value[after].valid
        if leaves or len(runs) <= MOST_RUNS:
            axes.axvline(
                edges[start], color=EDGE if leaves else "#333333", linewidth=2.0 if leaves else 0.8
            )


def _name_curves(
    figure: Figure, selection: Selection, values: NDArray[np.float64], colours: list[Colour]
) -> None:
    second = selection.axes[1]
    handles = [
        Line2D([], [], color=colour, linewidth=1.8, label=with_unit(number(value, 4), second.unit))
        for value, colour in zip(values, colours, strict=True)
    ]
    figure.legend(
        handles=handles[::-1],
        title=axis_label(selection.variable[second.name], ""),
        loc="outside right upper",
        frameon=False,
        fontsize=9,
        title_fontsize=9,
        alignment="left",
    )


def _limit(axes: Axes, across: Axis, values: NDArray[np.float64]) -> None:
    axes.set_xlim(across.values[0], across.values[-1])
    ends = value_range(values)
    if ends is None:
        return
    axes.set_ylim(*add_room(*ends))
    if ends[0] < 0 < ends[1]:
        axes.axhline(0.0, color="#333333", linewidth=0.7, zorder=1)
