"""Pictures of one output over one or two axes: what they share.

A painter draws a `Selection` on a figure; the name over it, what is held and the legend are the
same for all.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import flags_of
from vibrafeed.core.plots.bodies import draw_views
from vibrafeed.core.plots.looks import (
    HATCH_WIDTH,
    MOTION,
    PLAIN,
    Look,
    looks_of,
    looks_of_categories,
    swatch,
)
from vibrafeed.core.plots.parts import (
    cell_edges,
    finish,
    padded,
    say_nothing_is_finite,
    set_log,
    source_of,
    value_range,
)
from vibrafeed.core.plots.pictures import is_pair
from vibrafeed.core.plots.selection import (
    ANY_REGIME,
    FEW,
    PlotAxis,
    Selection,
    check_result,
    fixed_positions,
    natural,
    select,
    thin,
)
from vibrafeed.core.plots.style import (
    RGB,
    Array,
    Options,
    Style,
    axis_label,
    long_name,
    mix,
    number,
    with_unit,
)
from vibrafeed.core.quantities import STATUSES
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.quantities.pictures import LEVELS

NO_REGIMES = "no regimes"
BESIDE = (2.6, 1.0)  # widths of a picture, and of the sketch of what hits what
Painter = Callable[[FigureBase, Selection, Sequence[Look], Style], tuple[Axes, list[Artist]]]


MAX_RUNS = 20  # of a regime; the borders of more would hide the curve
BAND = 0.4  # opacity of the band of a spread
DASHES = ((4.0, 2.0), (1.0, 1.5), (7.0, 2.0, 1.0, 2.0), (3.0, 1.5, 1.0, 1.5, 1.0, 1.5))

Dashes = tuple[float, tuple[float, ...]] | Literal["solid"]


def _name_status(look: Look, dataset: xarray.Dataset, regime: xarray.DataArray) -> Look:
    """Return a look; that of cells whose regime is not assessed is named by their status."""
    if look.name != "not_assessed":
        return look
    is_not_assessed = regime == look.value
    for name in STATUSES:
        if name in dataset and dataset[name].dims == is_not_assessed.dims:
            meanings = flags_of(dataset[name].attrs)
            codes = np.unique(dataset[name].values[is_not_assessed.values]).tolist()
            causes = [meanings[code] for code in codes if code in meanings]
            if causes:
                return replace(look, name=" or ".join(causes))
    return look


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a kind of picture suits the axes and values of a dataset best."""
    check_result(dataset)
    return natural(dataset, options.variable, options.axes)[0] == options.kind


def render(
    dataset: xarray.Dataset, options: Options, painter: Painter, invalid_look: str
) -> Figure:
    """Return the picture of a slice of a dataset.

    `painter` draws the selected values into a figure, and returns axes and legend entries.
    `invalid_look` is how regimes look in which formulas do not hold, with ``{pale}`` in place of
    the style's word for pale.
    """
    check_result(dataset)
    style = options.style
    figure = style.sheet()
    variable, axes = options.variable, options.axes
    if options.is_natural:
        _, variable, axes = natural(dataset, variable, axes)
    selection = select(
        dataset, variable, axes, options.at, str(options.kind), options.units,
        nearest=options.nearest,
    )  # fmt: skip
    if selection.categories:
        looks = looks_of_categories(selection.categories, style)
    elif "regime" in dataset:
        looks = looks_of(selection.regime, selection.regimes, style, exact=selection.exact)
        looks = [_name_status(look, dataset, selection.regime) for look in looks]
    else:
        looks = [Look(ANY_REGIME, NO_REGIMES, True, *PLAIN, style)]
    has_bodies = is_pair(dataset)
    subfigures: Any = (figure,)
    if has_bodies:
        subfigures = np.ravel(figure.subfigures(1, 2, squeeze=False, width_ratios=BESIDE))
    top, entries = painter(subfigures[0], selection, looks, style)
    entries = [entry for entry in entries if not str(entry.get_label()).startswith(NO_REGIMES)]
    if has_bodies:  # what hits what
        dims = [str(name) for name in dataset.dims]
        positions = fixed_positions(dataset, options.at, dims, (), nearest=True)
        draw_views(subfigures[1], dataset, positions, style, below=True)
    name = long_name(selection.variable)
    if is_regime(str(selection.variable.name)):
        name = f"Regimes{name.removeprefix('Regime')}"
    wording = invalid_look.format(pale="Dim" if style.dark else "Pale")
    note = (
        f"{wording}: the closed forms do not describe a part there"
        if any(look.beyond for look in looks)
        else ""
    )
    return finish(
        figure, top, style, name=options.title or name, facts=list(selection.fixed),
        source=source_of(dataset), entries=entries, note=note,
    )  # fmt: skip


def _draw_line(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw a curve, or some for values of a second axis, with their regimes."""
    # Outputs that have a name in each cell are drawn as strips.
    across = selection.axes[0]
    chosen = thin(selection.axes[1].values.size, FEW) if len(selection.axes) > 1 else [0]
    regimes = selection.regimes.reshape(across.values.size, -1)[:, chosen]
    if selection.categories:
        return _draw_categories(figure, selection, regimes, looks, style, chosen)
    values = selection.values.reshape(across.values.size, -1)[:, chosen]
    colours = style.series_over(len(chosen))
    axes, entries, is_shaded = _draw_regimes(figure, selection, regimes, looks, style, chosen)
    for colour, curve, states in zip(colours, values.T, regimes.T, strict=True):
        strokes = [_stroke(look, looks, is_shaded) for look in looks]
        _draw_curve(axes, across.values, curve, states, looks, strokes, colour, style)
    if selection.band is not None:
        low, high = (end.reshape(across.values.size, -1)[:, chosen] for end in selection.band)
        entries.append(_add_bands(axes, across.values, low, high, colours, style))
        entries[-1].set_label(selection.band_label)
        values = np.concatenate([low, high])
    if len(selection.axes) > 1:
        _name_curves(figure, selection, selection.axes[1].values[chosen], colours)
    axes.set_xlim(across.values[0], across.values[-1])
    limits = value_range(values)
    if limits is None:
        say_nothing_is_finite(axes, selection, style)
        axes.set_yticks([])
    else:
        axes.set_ylim(*padded(*limits))
        if limits[0] < 0 < limits[1]:
            axes.axhline(0.0, color=style.quiet, linewidth=0.7, zorder=1)
    _mark_level(axes, selection, style)
    axes.set_ylabel(axis_label(selection.variable, selection.unit))
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
    """Set up axes and show regimes: by the background, by strips below, or else by dashes.

    Return the axes, the legend entries, and False where dashes alone tell regimes apart.
    """
    across = selection.axes[0]
    # The background shows them if they are the same for all curves.
    are_equal = bool((regimes == regimes[:, :1]).all())
    strokes = [_stroke(look, looks, is_shaded=False) for look in looks]
    has_strips = not are_equal and len({*strokes}) < len(looks)
    if has_strips:
        heights = (1.0, 0.055 * len(chosen))
        axes, lowest = figure.subplots(2, 1, sharex=True, height_ratios=heights)
        _add_strips(lowest, across, regimes, looks, _labels(selection, chosen))
        entries: list[Artist] = [swatch(look, look.fill, hatched=not look.valid) for look in looks]
    else:
        axes = lowest = figure.add_subplot()
    if across.is_log:
        set_log(axes.xaxis, across.values)
    if are_equal:
        _shade_spans(axes, across, regimes[:, 0], looks, style)
        entries = [swatch(look, look.tint, hatched=look.name not in MOTION) for look in looks]
    elif not has_strips:
        entries = [
            Line2D([], [], color=style.ink, linewidth=width, linestyle=dashes, label=look.label)
            for look, (width, dashes) in zip(looks, strokes, strict=True)
        ]
    lowest.set_xlabel(across.label)
    return axes, entries, are_equal or has_strips


def _draw_categories(
    figure: FigureBase,
    selection: Selection,
    codes: NDArray[np.int64],
    looks: Sequence[Look],
    style: Style,
    chosen: Sequence[int] | NDArray[np.int64],
) -> tuple[Axes, list[Artist]]:
    """Draw the names in cells as strips, one for each value of a second axis."""
    axes = figure.add_subplot()
    across = selection.axes[0]
    if across.is_log:
        set_log(axes.xaxis, across.values)
    several = len(selection.axes) > 1
    labels = _labels(selection, chosen) if several else [""]
    _add_strips(axes, across, codes, looks, labels)
    axes.set(xlim=(across.values[0], across.values[-1]), xlabel=across.label)
    if not several:
        axes.set(ylim=(-0.4, 0.4), yticks=[])
    else:
        axes.set_ylabel(axis_label(selection.variable[selection.axes[1].name], ""))
    return axes, [swatch(look, look.fill, hatched=False) for look in looks]


def _labels(selection: Selection, chosen: Sequence[int] | NDArray[np.int64]) -> list[str]:
    second = selection.axes[1]
    return [with_unit(number(value, 4), second.unit) for value in second.values[chosen]]


def _mark_level(axes: Axes, selection: Selection, style: Style) -> None:
    """Draw the line of an output's threshold, such as throw number 1."""
    level, meaning = LEVELS.get(str(selection.variable.name), (np.nan, ""))
    low, high = axes.get_ylim()
    if low < level < high:
        axes.axhline(level, color=style.accent, linewidth=style.width(1.6), zorder=1.8)
        axes.annotate(
            f"{number(level)}: {meaning}", (0.01, level), xycoords=axes.get_yaxis_transform(),
            xytext=(0, 3), textcoords="offset points", color=style.accent,
            fontsize=style.text(9), zorder=6,
            path_effects=[withStroke(linewidth=3.0, foreground=style.ground)],
        )  # fmt: skip


def _add_bands(
    axes: Axes,
    x: Array,
    lower: Array,
    upper: Array,
    colours: list[RGB],
    style: Style,
) -> Artist:
    """Shade the band of each curve; return the legend entry."""
    for low, high, colour in zip(lower.T, upper.T, colours, strict=True):
        if (low < high).any():
            axes.fill_between(x, low, high, color=colour, alpha=BAND, linewidth=0, zorder=1.5)
    shown = colours[0] if len(colours) == 1 else style.quiet
    return Patch(facecolor=mix(shown, style.ground, 1 - BAND))


def _add_strips(
    axes: Axes,
    across: PlotAxis,
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    labels: list[str],
) -> None:
    """Draw the regimes of each curve as a row of coloured bars."""
    edges = cell_edges(across)
    by_value = {look.value: look for look in looks}
    for row, states in enumerate(regimes.T):
        for value, start, stop in _runs(states):
            look = by_value[value]
            bar = axes.broken_barh(
                [(edges[start], edges[stop] - edges[start])], (row - 0.4, 0.8),
                facecolor=look.fill, linewidth=0,
            )  # fmt: skip
            if not look.valid:
                bar.set(hatch=look.hatch, edgecolor=look.hatch_ink, hatch_linewidth=HATCH_WIDTH)
    axes.set_ylim(-0.6, len(labels) - 0.4)
    axes.set_yticks(range(len(labels)), labels)
    axes.tick_params(axis="y", length=0)


def _runs(states: NDArray[np.int64]) -> list[tuple[int, int, int]]:
    changes = [0, *(np.flatnonzero(np.diff(states)) + 1).tolist(), states.size]
    return [(int(states[start]), start, stop) for start, stop in pairwise(changes)]


def _stroke(look: Look, looks: Sequence[Look], is_shaded: bool) -> tuple[float, Dashes]:
    """Return the line width and the dashes of a curve in a regime.

    Curves are solid where the formulas hold, and dashed in regimes where they do not, each with a
    pattern of its own, unless the background tells the regimes apart: `is_shaded`.
    """
    if look.valid:
        return PLAIN[-1] if is_shaded else look.width, "solid"
    invalid = [other for other in looks if not other.valid]
    pattern = 0 if is_shaded else invalid.index(look)
    return look.width, (0.0, DASHES[pattern % len(DASHES)])


def _draw_curve(
    axes: Axes,
    x: Array,
    curve: Array,
    states: NDArray[np.int64],
    looks: Sequence[Look],
    strokes: Sequence[tuple[float, Dashes]],
    colour: RGB,
    style: Style,
) -> None:
    """Draw a curve with the stroke of each regime, marked where it leaves what formulas describe.

    A part of it goes up to the first point of the next regime.
    """
    for look, (width, dashes) in zip(looks, strokes, strict=True):
        in_regime = states == look.value
        in_regime[1:] |= in_regime[:-1]  # and the first point of the next one
        if in_regime.any():
            axes.plot(
                x, np.where(in_regime, curve, np.nan), linewidth=width, linestyle=dashes,
                color=colour if look.valid else mix(colour, "#9a9a9a", 0.35),
                solid_capstyle="butt", marker="o" if in_regime.sum() == 1 else "", markersize=3,
            )  # fmt: skip
    # Few points are marked: between them nothing was computed.
    if x.size <= 12:
        axes.plot(x, curve, "o", color=colour, markersize=style.width(4), zorder=4)
    valid = np.isin(states, [look.value for look in looks if look.valid])
    # The last valid point on either side of a change.
    last_valid = np.flatnonzero(valid[:-1] != valid[1:])
    last_valid = np.where(valid[last_valid], last_valid, last_valid + 1)
    axes.plot(
        x[last_valid],
        curve[last_valid],
        "o",
        color=style.ink,
        markersize=style.width(4.5),
        zorder=5,
    )


def _shade_spans(
    axes: Axes, across: PlotAxis, states: NDArray[np.int64], looks: Sequence[Look], style: Style
) -> None:
    """Shade the background by regime, with a line where the regime changes."""
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
    figure: FigureBase, selection: Selection, values: Array, colours: list[RGB]
) -> None:
    """Add the legend that names curves by their value of the second axis."""
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
        handles=handles[::-1], title=title, loc="outside right upper", frameon=False,
        alignment="left",
    )  # fmt: skip


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a slice over one axis, or a family of curves."""
    return render(dataset, options, _draw_line, "Hatched or dashed")
