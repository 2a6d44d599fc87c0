"""A line over one axis, or a family of lines over a second one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from core.plots.parts import add_room, cell_edges, set_log
from core.plots.regimes import EDGE, HATCH_WIDTH, PLAIN, Look, mix, swatch
from core.plots.scale import value_range
from core.plots.selection import Axis, Selection, thin
from core.plots.text import axis_label, number, short_label, with_unit

MOST_CURVES = 7
CURVE = "#1f3b73"
DASHES = ((4.0, 2.0), (1.0, 1.5), (7.0, 2.0, 1.0, 2.0), (3.0, 1.5, 1.0, 1.5, 1.0, 1.5))

Dashes = tuple[float, tuple[float, ...]] | Literal["solid"]
Colour = tuple[float, float, float] | str


def draw_line(
    figure: Figure, selection: Selection, looks: Sequence[Look]
) -> tuple[Axes, list[Artist]]:
    """Draw the lines; return the axes and the legend's entries for the regimes."""
    axes = figure.add_subplot()
    across = selection.axes[0]
    chosen = thin(selection.axes[1].values.size, MOST_CURVES) if len(selection.axes) > 1 else [0]
    values = selection.values.reshape(across.values.size, -1)[:, chosen]
    regimes = selection.regimes.reshape(across.values.size, -1)[:, chosen]
    if across.is_log:
        set_log(axes.xaxis, across.values)
    spread = None
    if selection.spread is not None and selection.spread.any():
        spread = selection.spread.reshape(across.values.size, -1)[:, chosen]
    alike = bool((regimes == regimes[:, :1]).all())
    entries: list[Artist] = []
    if alike:
        _spans(axes, across, regimes[:, 0], looks)
        entries += [swatch(look, look.tint) for look in looks]
    else:
        entries += [_handle(look, looks) for look in looks]
    colours = _colours(len(chosen))
    for colour, curve, states in zip(colours, values.T, regimes.T, strict=True):
        for look in looks:
            _part(axes, across.values, curve, states, look, _style(look, looks, alike), colour)
        _mark_edges(axes, across.values, curve, states, looks)
    if len(selection.axes) > 1:
        _name_curves(figure, selection, selection.axes[1].values[chosen], colours)
    _limit(axes, across, values)
    axes.set_xlabel(across.label)
    axes.set_ylabel(short_label(selection.variable, selection.unit))
    axes.grid(visible=True, color="#000000", alpha=0.12, linewidth=0.6)
    axes.set_axisbelow(True)
    return axes, entries


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
    changes = np.flatnonzero(np.diff(states)) + 1
    by_value = {look.value: look for look in looks}
    starts, stops = [0, *changes], [*changes, states.size]
    for start, stop in zip(starts, stops, strict=True):
        look = by_value[int(states[start])]
        area = axes.axvspan(edges[start], edges[stop], facecolor=look.tint, linewidth=0, zorder=0)
        if look.hatch:
            area.set(hatch=look.hatch, edgecolor=mix(look.colour, "#ffffff", 0.72))
            area.set_hatch_linewidth(HATCH_WIDTH)
    for change in changes:
        pair = (by_value[int(states[change - 1])], by_value[int(states[change])])
        leaves = pair[0].valid != pair[1].valid
        axes.axvline(
            edges[change], color=EDGE if leaves else "#333333", linewidth=2.0 if leaves else 0.8
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
