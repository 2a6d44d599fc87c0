"""Spreads of outputs under uncertain parameters, and the posterior of a calibration."""

import json
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import PchipInterpolator

from vibrafeed.core.dataset.table import percent_with_error
from vibrafeed.core.plots.parts import finish, source_of
from vibrafeed.core.plots.pictures import PlotError, is_calibration
from vibrafeed.core.plots.selection import fixed_positions, held_fixed
from vibrafeed.core.plots.style import (
    Array,
    Options,
    Style,
    axis_label,
    in_brackets,
    mix,
    number,
    scaled,
    shown_in,
    with_unit,
    words,
)
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.sensitivity.prepare import LEVEL, QUANTILE, UNCERTAIN
from vibrafeed.core.study.distributions import read_distribution, tolerance
from vibrafeed.core.study.shown import Shown, ShownUnits
from vibrafeed.core.suggestions import suggestion

NEEDED = {"distribution": "distribution", "indices": "total", "tornado": "at_upper"}
"""The variable, by the last part of its name, that a kind of picture is of."""
ANALYSIS = {"distribution": "distribution", "indices": "sobol", "tornado": "budget"}
LEFT_OUT = "_left_out"
BINS = 32  # bars of a distribution
HEIGHT = 0.36  # of a bar, as a share of its parameter's room
PADDING = 0.08  # share of the largest value that is left free beyond it
SHARES = (0.95, 0.68)  # of the posterior, that are drawn as areas
PALE, DEEP = 0.2, 0.5  # share of the curve's colour in the areas of 95 % and 68 %
SIDE = {1: (8.0, 5.6), 2: (8.0, 7.2), 3: (9.0, 8.4), 4: (10.0, 9.6)}  # inches

Drawing = tuple[str, Sequence[Artist], str]
"""The name of a picture, the entries of its legend, and a note."""


class UncertainOutput(NamedTuple):
    """One output at one design, how its values are read, and what is held fixed, in words."""

    output: str
    shown: Shown
    design: xarray.Dataset
    facts: list[str]
    units: ShownUnits

    @property
    def names(self) -> list[str]:
        """The names of the uncertain parameters."""
        return str(self.design[UNCERTAIN].attrs["flag_meanings"]).split()

    @property
    def label(self) -> str:
        """The name of the output within a sentence."""
        return in_sentence(QUANTITIES[self.output].label)

    @property
    def axis(self) -> str:
        """The label of an axis of the output."""
        unit = in_brackets(self.shown.unit)
        return f"{QUANTITIES[self.output].label} {unit}".rstrip()

    def values(self, part: str) -> Array:
        """Return the values of a statistic, in shown units."""
        return np.asarray(self.shown.factor * self.shares(part))

    def shares(self, part: str) -> Array:
        """Return the values of a dimensionless statistic."""
        return np.asarray(self.design[f"{self.output}_{part}"].values, dtype=np.float64)

    def read(self, value: float) -> str:
        """Return a value of the output as text."""
        return with_unit(number(value, 4), self.shown.unit)


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if the kind in `options` is the default: the first whose variables the dataset has."""
    if options.kind == "posterior":
        return True
    variables = {str(name) for name in dataset.data_vars}
    kinds = [
        kind for kind, end in NEEDED.items() if any(name.endswith(f"_{end}") for name in variables)
    ]
    if options.asks or options.kind not in kinds[:1]:
        return False
    try:
        _result(dataset, options)
    except PlotError:  # not one sound value
        return False
    return True


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return a picture of a study with uncertain parameters, or of a calibration.

    The kind is `options.kind`: posterior, or distribution, indices or tornado of one output at one
    design. `PlotError` tells that the dataset does not have what is asked for.
    """
    style, kind = options.style, str(options.kind)
    if kind == "posterior" or is_calibration(dataset):
        return _draw_posterior(dataset, options)
    result = _result(dataset, options)
    figure = style.sheet(height=5.0)
    axes = figure.add_subplot()
    name, entries, note = PAINTERS[kind](axes, result, style)
    return finish(
        figure, axes, style, name=options.title or name, facts=result.facts,
        source=source_of(dataset), entries=entries, note=note,
    )  # fmt: skip


def _result(dataset: xarray.Dataset, options: Options) -> UncertainOutput:
    """Return the output that is asked for, by default the first, at the design that is held."""
    kind, units = str(options.kind), options.units
    names = [str(name) for name in dataset.data_vars]
    outputs = [name.removesuffix(LEFT_OUT) for name in names if name.endswith(LEFT_OUT)]
    if not outputs or "uncertain_parameters" not in dataset.attrs:
        raise PlotError(
            "dataset",
            "the dataset has no uncertain parameters",
            "Draw the result of a study of kind 'sensitivity'",
        )
    output = options.variable or outputs[0]
    if output not in outputs:
        raise PlotError(
            "variable", f"'{output[:60]}' is not an output", suggestion(output, outputs)
        )
    variable = f"{output}_{NEEDED[kind]}"
    if variable not in dataset:
        raise PlotError(
            "dataset",
            f"the result has no {words(variable)}",
            f'Add "{ANALYSIS[kind]}" to the analyses of the study',
        )
    own_dimensions = (UNCERTAIN, QUANTILE, LEVEL)
    dimensions = [str(dim) for dim in dataset.dims if dim not in own_dimensions]
    positions = fixed_positions(dataset, options.at, dimensions, (), nearest=options.nearest)
    facts = held_fixed(
        dataset.drop_vars([dim for dim in own_dimensions if dim in dataset.coords]),
        units,
        positions,
    )
    unit, design = QUANTITIES[output].unit, dataset.isel(positions)
    magnitudes = [
        np.abs(np.asarray(array.values, dtype=np.float64)).ravel()
        for name, array in design.data_vars.items()
        if str(name).startswith(f"{output}_") and array.attrs.get("units") == unit
    ]
    all_magnitudes = np.concatenate([*magnitudes, [0.0]])
    shown = units.of(unit, float(all_magnitudes[np.isfinite(all_magnitudes)].max()))
    result = UncertainOutput(output, shown, design, facts, units)
    if not np.isfinite(result.shares(NEEDED[kind])).any():
        raise PlotError(
            "dataset",
            f"no point of {words(output)} has a valid value here",
            "Draw another design by giving at, or another output",
        )
    return result


def _draw_distribution(axes: Axes, result: UncertainOutput, style: Style) -> Drawing:
    """Draw the distribution of an output as a histogram, with quantiles and bounds of demands."""
    levels = np.asarray(result.design[LEVEL].values, dtype=np.float64)
    values = result.values("distribution")
    low, high = float(values[0]), float(values[-1])
    edges = np.linspace(low, high if high > low else low + 1.0, BINS + 1)
    fraction_below = np.ones(BINS + 1)
    if high > low:
        fraction_below = _share_below(values, levels, edges)
    fraction_below[0], fraction_below[-1] = 0.0, 1.0
    pale = mix(style.ground, style.curve, 0.45)
    axes.bar(
        edges[:-1], 100 * np.diff(fraction_below), np.diff(edges), align="edge", color=pale,
        edgecolor=style.ground, linewidth=0.6,
    )  # fmt: skip
    entries: list[Artist] = [Patch(color=pale, label="Share of the parts")]
    for level, value in zip(result.design[QUANTILE].values, result.values(QUANTILE), strict=True):
        axes.axvline(value, color=style.ink, linewidth=style.width(1.0), linestyle="--")
        axes.annotate(
            _percent(level), (value, 1.0), (-2, -3), va="top", ha="right",
            xycoords=("data", "axes fraction"), textcoords="offset points", color=style.ink,
            fontsize=style.text(8.5), rotation=90,
        )  # fmt: skip
    entries.append(Line2D([], [], color=style.ink, linestyle="--", label="Quantiles"))
    for name, demand in result.design.data_vars.items():
        if demand.attrs.get("output") != result.output or str(name).endswith("_error"):
            continue
        bounds = []
        for key in ("at_least", "at_most"):
            if key in demand.attrs:
                bound = float(demand.attrs[key]) * result.shown.factor
                axes.axvline(bound, color=style.accent, linewidth=style.width(2.0))
                bounds.append(f"{words(key)} {result.read(bound)}")
        probability = percent_with_error(float(demand), float(result.design[f"{name}_error"]))
        label = f"{' and '.join(bounds)}: {probability}"
        entries.append(Line2D([], [], color=style.accent, linewidth=2.0, label=label))
    axes.set(xlabel=result.axis, ylabel="Share of the parts (%)")
    axes.margins(x=0.03)
    axes.set_ylim(top=axes.get_ylim()[1] * 1.2)  # room for the names of quantiles
    style.add_grid(axes)
    left_out = float(result.design[f"{result.output}{LEFT_OUT}"])
    note = f"{_percent(left_out)} of the points have no valid value" if left_out > 0 else ""
    return f"Distribution of the {result.label}", entries, note


def _share_below(values: Array, levels: Array, edges: Array) -> Array:
    """Return the share of the distribution below each edge, 0 to 1.

    `levels` are the shares of its quantiles `values`. A smooth monotone curve goes through them:
    straight lines would make steps of the tails. Where many are equal it jumps.
    """
    is_last = np.append(np.diff(values) > 0, True)
    values, levels = values[is_last], levels[is_last]
    if values.size < 4:
        return np.interp(edges, values, levels)
    return np.asarray(np.clip(PchipInterpolator(values, levels)(edges), 0.0, 1.0))


def _draw_indices(axes: Axes, result: UncertainOutput, style: Style) -> Drawing:
    """Draw Sobol indices as bars with 95 % intervals, the parameter of the largest total on top."""
    order = np.argsort(result.shares("total"))
    rows = np.arange(len(order), dtype=float)
    entries: list[Artist] = []
    bars = ((HEIGHT / 2, "first", style.curve), (-HEIGHT / 2, "total", style.other))
    for offset, part, colour in bars:
        axes.barh(
            rows + offset, 100 * result.shares(part)[order], HEIGHT, color=colour,
            xerr=100 * result.shares(f"{part}_error")[order], ecolor=style.ink, capsize=3,
        )  # fmt: skip
        entries.append(Patch(color=colour, label=f"{part.capitalize()} index"))
    _set_rows(axes, [result.names[index] for index in order], style)
    axes.set(xlabel=f"Share of the variance of the {result.label} (%)")
    axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    note = "Lines across the ends are 95 % intervals of the sampling"
    return f"Where the variance of the {result.label} comes from", entries, note


def _draw_tornado(axes: Axes, result: UncertainOutput, style: Style) -> Drawing:
    """Draw a tornado diagram: how far each tolerance alone moves an output from its nominal value.

    Dashed lines show the least and the largest output with all parameters together.
    """
    lower, upper = result.values("at_lower"), result.values("at_upper")
    middle = float(result.values("nominal"))
    largest_change = np.nan_to_num(np.maximum(np.abs(lower - middle), np.abs(upper - middle)))
    candidates = (
        part for part in ("total", "variance_share") if f"{result.output}_{part}" in result.design
    )
    statistic = next(candidates, None)
    shares = result.shares(statistic) if statistic else largest_change
    # In the order of what matters, as the sentence says it; of equal ones the widest on top.
    order = np.lexsort((largest_change, np.nan_to_num(shares)))
    names = [result.names[index] for index in order]
    rows = np.arange(len(names), dtype=float)
    distributions = json.loads(str(result.design.attrs["uncertain_parameters"]))
    ends = (("lower", lower, upper, style.other), ("upper", upper, lower, style.curve))
    entries: list[Artist] = []
    for side, (end, values, others, colour) in enumerate(ends):
        axes.barh(rows, values[order] - middle, 2 * HEIGHT, left=middle, color=colour)
        entries.append(Patch(color=colour, label=f"At the {end} end"))
        for row, index in enumerate(order):
            if np.isfinite(values[index]):
                is_right = (
                    values[index] > others[index]
                    if np.isfinite(others[index])
                    else values[index] >= middle
                )
                quantity = QUANTITIES[names[row]]
                limits = tolerance(
                    names[row], read_distribution(names[row], distributions[names[row]], quantity)
                )
                shown = result.units.of(quantity.unit, max(map(abs, limits)))
                axes.annotate(
                    with_unit(number(shown.factor * limits[side], 4), shown.unit),
                    (values[index], row), (3 if is_right else -3, 0),
                    textcoords="offset points", ha="left" if is_right else "right", va="center",
                    fontsize=style.text(8.5), color=style.ink,
                )  # fmt: skip
    axes.axvline(middle, color=style.ink, linewidth=style.width(1.2))
    entries.append(Line2D([], [], color=style.ink, label=f"Nominal: {result.read(middle)}"))
    worst = [float(result.values(part)) for part in ("least", "largest")]
    for value in worst:
        axes.axvline(value, color=style.accent, linewidth=style.width(1.6), linestyle="--")
    label = f"All together: {result.read(worst[0])} to {result.read(worst[1])}"
    entries.append(Line2D([], [], color=style.accent, linestyle="--", label=label))
    _set_rows(axes, names, style)
    axes.margins(x=2 * PADDING)  # the ends of tolerances stand beside their bars
    axes.set(xlabel=result.axis)
    return f"Effect of each tolerance on the {result.label}", entries, ""


def _set_rows(axes: Axes, names: Sequence[str], style: Style) -> None:
    axes.set_yticks(range(len(names)), [words(name) for name in names])
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.tick_params(axis="y", length=0)
    style.add_grid(axes)
    axes.grid(visible=False, axis="y")


def _percent(share: float) -> str:
    return with_unit(number(100 * share, 3), "%")


PAINTERS: dict[str, Callable[[Axes, UncertainOutput, Style], Drawing]] = {
    "distribution": _draw_distribution,
    "indices": _draw_indices,
    "tornado": _draw_tornado,
}


def _draw_posterior(dataset: xarray.Dataset, options: Options) -> Figure:
    """Draw the density of each unknown on the diagonal, and that of each pair below.

    Regions hold 95 and 68 %, and there is a cross at each mode.
    """
    kind, style, units = options.kind, options.style, options.units
    if not is_calibration(dataset):
        raise PlotError(
            "kind",
            f"the dataset has no {kind}",
            "Draw the result of a study of kind 'calibrate'",
        )
    if kind != "posterior":
        raise PlotError(
            "kind",
            f"the result of a calibration cannot be drawn as kind {kind}",
            "Draw kind posterior",
        )
    names = str(dataset.attrs["unknowns"]).split()
    count = len(names)
    figure = style.sheet(*SIDE[count])
    panels = figure.subplots(count, count, squeeze=False, sharex="col")
    shown = {name: shown_in(dataset[name], units) for name in names}
    for row, below in enumerate(names):
        for column, across in enumerate(names):
            panel = panels[row, column]
            if column > row:
                panel.set_visible(False)
                continue
            x = scaled(dataset[across], shown[across].factor)
            if row == column:
                _draw_marginal(panel, dataset, across, x, shown[across].factor, style)
            else:
                y = scaled(dataset[below], shown[below].factor)
                _draw_pair(panel, x, y, _pair_density(dataset, across, below), style)
                modes = (
                    np.atleast_1d(dataset[f"mode_{name}"].values) * shown[name].factor
                    for name in (across, below)
                )
                look = {"color": style.ink, "ms": style.width(9), "mew": style.width(1.4)}
                panel.plot(*modes, "+", zorder=4, **look)
                if column == 0:
                    panel.set_ylabel(axis_label(dataset[below], shown[below].unit))
                else:
                    panel.tick_params(labelleft=False)
            panel.set_xlim(x[0], x[-1])
            panel.xaxis.set_major_locator(MaxNLocator(5))
            if count == 1:
                panel.set_ylabel("Density")
            if row == count - 1:
                panel.set_xlabel(axis_label(dataset[across], shown[across].unit))
    entries: list[Artist] = [
        Patch(color=mix(style.ground, style.curve, depth), label=f"{100 * share:.0f} %")
        for share, depth in zip(SHARES, (PALE, DEEP), strict=True)
    ]
    entries.append(Line2D([], [], color=style.ink, lw=style.width(1.2), label="best"))
    return finish(
        figure, panels[0, 0], style, name=options.title or "What the runs say",
        facts=[_interval(dataset, name, units) for name in names], source=source_of(dataset),
        entries=entries,
    )  # fmt: skip


def _draw_marginal(
    panel: Axes, dataset: xarray.Dataset, name: str, x: Array, factor: float, style: Style
) -> None:
    """Draw the density of an unknown, its intervals of 95 and 68 %, and its modes."""
    density = np.asarray(dataset[f"density_{name}"].values, dtype=np.float64)
    panel.plot(x, density, color=style.curve, lw=style.width(1.8))
    for share, depth in zip((95, 68), (PALE, DEEP), strict=True):
        low, high = (float(dataset[f"{end}_{share}_{name}"]) * factor for end in ("lower", "upper"))
        fine = np.linspace(max(low, x[0]), min(high, x[-1]), 200)
        panel.fill_between(
            fine, np.interp(fine, x, density), color=mix(style.ground, style.curve, depth), lw=0
        )
    for mode in np.atleast_1d(dataset[f"mode_{name}"].values):
        panel.axvline(float(mode) * factor, color=style.ink, lw=style.width(1.2), zorder=3)
    panel.set_ylim(bottom=0.0)
    panel.set_yticks([])


def _draw_pair(panel: Axes, x: Array, y: Array, density: Array, style: Style) -> None:
    """Fill the regions of highest density, shape (y, x), that hold 95 and 68 % of it."""
    ordered = np.sort(density.ravel())[::-1]
    mass_above = np.cumsum(ordered) / ordered.sum()
    levels = [
        float(ordered[min(np.searchsorted(mass_above, share), mass_above.size - 1)])
        for share in SHARES
    ]
    edges = np.array([*levels, float(ordered[0]) * 1.001])
    if np.all(np.diff(edges) > 0):
        colours = [mix(style.ground, style.curve, depth) for depth in (PALE, DEEP)]
        panel.contourf(x, y, density, levels=edges, colors=colours)
    style.add_grid(panel)


def _pair_density(dataset: xarray.Dataset, across: str, below: str) -> Array:
    for name in (f"density_{across}_{below}", f"density_{below}_{across}"):
        if name in dataset:
            return np.asarray(dataset[name].transpose(below, across).values, dtype=np.float64)
    log = dataset["log_density"].transpose(below, across)
    return np.asarray(np.exp(log.values), dtype=np.float64)


def _interval(dataset: xarray.Dataset, name: str, units: ShownUnits) -> str:
    ends = [dataset[f"{end}_95_{name}"] for end in ("lower", "upper")]
    shown = shown_in(xarray.concat(ends, "end", combine_attrs="override"), units)
    low, high = (number(float(end) * shown.factor, 3) for end in ends)
    return f"{dataset[name].attrs['long_name']} {low} to {with_unit(high, shown.unit)}"
