"""Pictures of a study of uncertain parameters: distribution, indices, tolerances."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from vibrafeed.core.dataset.regimes import percent_with_error
from vibrafeed.core.plots.fixed import fixed_positions
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import held_at, held_fixed
from vibrafeed.core.plots.style import Options, Style, mix
from vibrafeed.core.plots.text import in_brackets, number, with_unit, words
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.sensitivity.prepare import LEVEL, QUANTILE, UNCERTAIN
from vibrafeed.core.study.distributions import read_distribution, tolerance
from vibrafeed.core.study.shown import Shown, ShownUnits
from vibrafeed.core.suggestions import suggestion

NEEDED = {
    "distribution": "distribution",
    "indices": "total",
    "tornado": "at_upper",
}
"""The variable, by the last part of its name, that a kind of picture is of."""
ANALYSIS = {
    "distribution": "distribution",
    "indices": "sobol",
    "tornado": "budget",
}
LEFT_OUT = "_left_out"
BINS = 32  # bars of a distribution
HEIGHT = 0.36  # of a bar, as a share of its parameter's room
ABOVE = 1.2  # height of the axes over that of the bars
SMOOTH = 4  # quantiles from which on a smooth curve is laid through them
PADDING = 0.08  # share of the largest value that is left free beyond it


@dataclass(frozen=True)
class UncertainOutput:
    """The values of one output at one design, in the unit in which it is read.

    Attributes
    ----------
    output : str
        Its name.
    shown : Shown
        How its values are read.
    design : xarray.Dataset
        The result at that design.
    facts : tuple of str
        What is held fixed, in words.
    units : ShownUnits
        Units in which parameters are read.
    """

    output: str
    shown: Shown
    design: xarray.Dataset
    facts: tuple[str, ...]
    units: ShownUnits

    @property
    def names(self) -> list[str]:
        """The names of the uncertain parameters."""
        return str(self.design[UNCERTAIN].attrs["flag_meanings"]).split()

    @property
    def label(self) -> str:
        """The name of the output."""
        return QUANTITIES[self.output].label

    @property
    def axis(self) -> str:
        """The label of an axis of the output."""
        return " ".join(filter(None, (self.label, in_brackets(self.shown.unit))))

    def values(self, part: str) -> NDArray[np.float64]:
        """Return the values of a statistic, in shown units."""
        return np.asarray(self.shown.factor * self.shares(part))

    def shares(self, part: str) -> NDArray[np.float64]:
        """Return the values of a dimensionless statistic."""
        return np.asarray(self.design[f"{self.output}_{part}"].values, dtype=np.float64)

    def has(self, part: str) -> bool:
        """True if the result has a statistic."""
        return f"{self.output}_{part}" in self.design

    def end_in_words(self, name: str, end: str) -> str:
        """Return the lower or upper end of a parameter's tolerance as a text with its unit.

        `name` is the parameter and `end` ``"lower"`` or ``"upper"``.
        """
        known = json.loads(str(self.design.attrs["uncertain_parameters"]))
        quantity = QUANTITIES[name]
        lower, upper = tolerance(name, read_distribution(name, known[name], quantity))
        shown = self.units.of(quantity.unit, max(abs(lower), abs(upper)))
        return with_unit(number(shown.factor * (lower if end == "lower" else upper), 4), shown.unit)

    def read(self, value: float) -> str:
        """Return a value of the output as text."""
        return with_unit(number(value, 4), self.shown.unit)


def kind_of(dataset: xarray.Dataset) -> str | None:
    """Return the kind of picture to draw by default of a study with uncertain parameters, or None.

    It is the first of ``"distribution"``, ``"indices"`` and others whose variables the dataset has;
    None for results of other kinds of study.
    """
    if "uncertain_parameters" not in dataset.attrs:
        return None
    names = [str(name) for name in dataset.data_vars]
    for kind, part in NEEDED.items():
        if any(name.endswith(f"_{part}") for name in names):
            return kind
    return None


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a kind of picture is the one to draw of a study with uncertain parameters by default.

    It is the first kind for which the dataset has values; `options` has the kind and what the user
    asked for.
    """
    asked = (options.variable, options.axes) != (None, None)
    if asked or options.kind != kind_of(dataset):
        return False
    try:
        _result(
            str(options.kind), dataset, None, options.at, options.units, nearest=options.nearest
        )
    except PlotError:  # not one sound value
        return False
    return True


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return a picture of a study with uncertain parameters, for one output at one design.

    The kind of picture is `options.kind`: distribution, indices or tornado.

    Raises
    ------
    PlotError
        If the dataset does not have what is asked for.
    """
    style, kind = options.style, str(options.kind)
    result = _result(
        kind, dataset, options.variable, options.at, options.units, nearest=options.nearest
    )
    figure = style.sheet(height=5.0)
    axes = figure.add_subplot()
    name, entries, note = PAINTERS[kind](axes, result, style)
    return finish(
        figure, axes, style, name=options.title or name, facts=result.facts,
        source=source_of(dataset), entries=entries, note=note,
    )  # fmt: skip


def _result(
    kind: str,
    dataset: xarray.Dataset,
    variable: str | None,
    at: Mapping[str, float],
    units: ShownUnits,
    *,
    nearest: bool,
) -> UncertainOutput:
    """Return the values of one output of a study with uncertain parameters, to be drawn.

    Parameters
    ----------
    kind : str
        The kind of picture, which needs one of the study's analyses.
    variable : str or None
        The output; by default the first.
    at : mapping of str to float
        Values of ranged parameters, which choose the design; by default their middle.
    units : ShownUnits
        The units that the reader wants.
    nearest : bool
        True if a value of `at` that the dataset does not have stands for the nearest one.

    Raises
    ------
    PlotError
        If the dataset lacks the analysis, or the design has no valid value.
    """
    output = _output(kind, dataset, variable)
    loose = [str(d) for d in dataset.dims if d not in (UNCERTAIN, QUANTILE, LEVEL)]
    positions = fixed_positions(dataset, at, loose, (), nearest=nearest)
    facts = [held_at(dataset[name], units, position) for name, position in positions.items()]
    parameters = dataset.drop_vars([d for d in (UNCERTAIN, QUANTILE, LEVEL) if d in dataset.coords])
    facts += held_fixed(parameters, units)
    unit = QUANTITIES[output].unit
    design = dataset.isel(positions)
    own = [
        np.abs(np.asarray(one.values, dtype=np.float64)).ravel()
        for name, one in design.data_vars.items()
        if str(name).startswith(f"{output}_") and one.attrs.get("units") == unit
    ]
    sizes = np.concatenate([*own, [0.0]])
    shown = units.of(unit, float(sizes[np.isfinite(sizes)].max()))
    result = UncertainOutput(output, shown, design, tuple(facts), units)
    if not np.isfinite(result.shares(NEEDED[kind])).any():
        message = f"no point of {words(output)} has a valid value here"
        raise PlotError("dataset", message, "Draw another design by giving at, or another output")
    return result


def _output(kind: str, dataset: xarray.Dataset, variable: str | None) -> str:
    """Return the output to draw in a picture of a study with uncertain parameters.

    Parameters
    ----------
    kind : str
        The picture, such as ``"tornado"``; each needs variables of its own.
    variable : str or None
        The output that the user asked for; by default the first.

    Raises
    ------
    PlotError
        If the dataset is no such study, or does not have the output or the values for that picture.
    """
    names = [str(name) for name in dataset.data_vars]
    outputs = [name.removesuffix(LEFT_OUT) for name in names if name.endswith(LEFT_OUT)]
    if not outputs or "uncertain_parameters" not in dataset.attrs:
        fix = "Draw what `vibrafeed run` wrote of a study of kind 'sensitivity'"
        raise PlotError("dataset", "the dataset has no uncertain parameters", fix)
    output = variable or outputs[0]
    if output not in outputs:
        raise PlotError(
            "variable", f"'{output[:60]}' is not an output", suggestion(output, outputs)
        )
    whole = f"{output}_{NEEDED[kind]}"
    if whole not in dataset:
        fix = f'Add "{ANALYSIS[kind]}" to the analyses of the study'
        raise PlotError("dataset", f"it holds no {words(whole)}", fix)
    return output


Drawing = tuple[str, Sequence[Artist], str]
"""The name of a picture, the entries of its legend, and a note."""


def _draw_distribution(axes: Axes, result: UncertainOutput, style: Style) -> Drawing:
    """Draw the distribution of an output as a histogram, with quantiles and bounds of demands.

    `result` has the values at one design.

    Returns
    -------
    tuple
        Title of the picture, entries of its legend, and a note below it on points without a value.
    """
    levels = np.asarray(result.design[LEVEL].values, dtype=np.float64)
    values = result.values("distribution")
    low, high = float(values[0]), float(values[-1])
    edges = np.linspace(low, high if high > low else low + 1.0, BINS + 1)
    # The share below each edge, by the quantiles: where many are equal it jumps.
    below = np.ones(BINS + 1)
    if high > low:
        below = _share_below(*_rising(values, levels), edges)
    below[0], below[-1] = 0.0, 1.0
    axes.bar(
        edges[:-1], 100 * np.diff(below), np.diff(edges), align="edge",
        color=mix(style.ground, style.curve, 0.45), edgecolor=style.ground, linewidth=0.6,
    )  # fmt: skip
    entries: list[Artist] = [
        Patch(color=mix(style.ground, style.curve, 0.45), label="Share of the parts")
    ]
    for share, value in zip(result.design[QUANTILE].values, result.values(QUANTILE), strict=True):
        axes.axvline(value, color=style.ink, linewidth=style.width(1.0), linestyle="--")
        axes.annotate(
            with_unit(number(100 * share, 3), "%"), (value, 1.0), (-2, -3), va="top", ha="right",
            xycoords=("data", "axes fraction"), textcoords="offset points", color=style.ink,
            fontsize=style.text(8.5), rotation=90,
        )  # fmt: skip
    entries.append(Line2D([], [], color=style.ink, linestyle="--", label="Quantiles"))
    facts = []
    for name, variable in result.design.data_vars.items():
        if variable.attrs.get("output") != result.output or str(name).endswith("_error"):
            continue
        error = float(result.design[f"{name}_error"])
        ends = [variable.attrs[key] for key in ("at_least", "at_most") if key in variable.attrs]
        bounds = [float(end) * result.shown.factor for end in ends]
        for bound in bounds:
            axes.axvline(bound, color=style.accent, linewidth=style.width(2.0))
        words_ = [
            f"{key.replace('_', ' ')} {result.read(bound)}"
            for key, bound in zip(
                [k for k in ("at_least", "at_most") if k in variable.attrs], bounds, strict=True
            )
        ]
        facts.append(f"{' and '.join(words_)}: {percent_with_error(float(variable), error)}")
        entries.append(Line2D([], [], color=style.accent, linewidth=2.0, label=facts[-1]))
    axes.set(xlabel=result.axis, ylabel="Share of the parts (%)")
    axes.margins(x=0.03)
    axes.set_ylim(top=axes.get_ylim()[1] * ABOVE)  # room for the names of quantiles
    style.add_grid(axes)
    left = float(result.design[f"{result.output}{LEFT_OUT}"])
    note = f"{_percent(left)} of the points have no valid value" if left > 0 else ""
    return f"Distribution of the {in_sentence(result.label)}", entries, note


def _share_below(
    values: NDArray[np.float64], levels: NDArray[np.float64], edges: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the share of the distribution below each edge, 0 to 1.

    It comes from a smooth monotone curve through the quantiles: `levels` are their shares, `values`
    their values. Straight lines would make steps of the tails.
    """
    if values.size < SMOOTH:
        return np.interp(edges, values, levels)
    return np.asarray(np.clip(PchipInterpolator(values, levels)(edges), 0.0, 1.0))


def _rising(
    values: NDArray[np.float64], levels: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return distinct values of quantiles, each with its largest level; both arrays ascend."""
    last = np.append(np.diff(values) > 0, True)
    return values[last], levels[last]


def _draw_indices(axes: Axes, result: UncertainOutput, style: Style) -> Drawing:
    """Draw Sobol indices as bars: each uncertain parameter's share of an output's variance.

    The first index is that of a parameter alone, the total one with all its interactions; bars have
    95 % intervals, and the parameter of the largest total stands on top. `result` has the values at
    one design.

    Returns
    -------
    tuple
        Title of the picture, entries of its legend, and a note below it.
    """
    total = result.shares("total")
    order = np.argsort(total)
    names = [result.names[k] for k in order]
    rows = np.arange(len(names), dtype=float)
    colours = {"first": style.curve, "total": style.other}
    entries: list[Artist] = []
    for away, part in ((HEIGHT / 2, "first"), (-HEIGHT / 2, "total")):
        axes.barh(
            rows + away, 100 * result.shares(part)[order], HEIGHT, color=colours[part],
            xerr=100 * result.shares(f"{part}_error")[order], ecolor=style.ink, capsize=3,
        )  # fmt: skip
        label = f"{part.capitalize()} index"
        entries.append(Patch(color=colours[part], label=label))
    _set_rows(axes, names, style)
    axes.set(xlabel=f"Share of the variance of the {in_sentence(result.label)} (%)")
    axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    note = "Lines across the ends are 95 % intervals of the sampling"
    return f"Where the variance of the {in_sentence(result.label)} comes from", entries, note


def _draw_tornado(axes: Axes, result: UncertainOutput, style: Style) -> Drawing:
    """Draw a tornado diagram: how far each tolerance alone moves an output from its nominal value.

    For each uncertain parameter there are two bars, with the parameter at its lower and at its
    upper end. Dashed lines show the least and the largest output with all parameters together.
    `result` has the values at one design, in the unit of the picture.

    Returns
    -------
    tuple
        Title of the picture, entries of its legend, and a note below it, which is empty.
    """
    lower, upper = result.values("at_lower"), result.values("at_upper")
    middle = float(result.values("nominal"))
    reach = np.nan_to_num(np.maximum(np.abs(lower - middle), np.abs(upper - middle)))
    decides = next((part for part in ("total", "variance_share") if result.has(part)), None)
    shares = result.shares(decides) if decides else reach
    # In the order of what matters, as the sentence says it; of equal ones the widest on top.
    order = np.lexsort((reach, np.nan_to_num(shares)))
    names = [result.names[k] for k in order]
    rows = np.arange(len(names), dtype=float)
    ends = (("lower", lower, style.other), ("upper", upper, style.curve))
    entries: list[Artist] = []
    for end, values, colour in ends:
        axes.barh(rows, values[order] - middle, 2 * HEIGHT, left=middle, color=colour)
        entries.append(Patch(color=colour, label=f"At the {end} end"))
        for row, k in enumerate(order):
            if np.isfinite(values[k]):
                other = upper[k] if end == "lower" else lower[k]
                right = values[k] > other if np.isfinite(other) else values[k] >= middle
                axes.annotate(
                    result.end_in_words(names[row], end), (values[k], row), (3 if right else -3, 0),
                    textcoords="offset points", ha="left" if right else "right", va="center",
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
    return f"What each tolerance does to the {in_sentence(result.label)}", entries, ""


def _set_rows(axes: Axes, names: Sequence[str], style: Style) -> None:
    """Label the rows of a diagram of uncertain parameters: row k, at height k, with the k-th name.

    `names` are names of parameters, which are shown in words. The grid is drawn for the horizontal
    axis alone.
    """
    axes.set_yticks(range(len(names)), [words(name) for name in names])
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.tick_params(axis="y", length=0)
    style.add_grid(axes)
    axes.grid(visible=False, axis="y")


def _percent(share: float) -> str:
    """Return a share in per cent."""
    return with_unit(number(100 * share, 3), "%")


PAINTERS: dict[str, Callable[[Axes, UncertainOutput, Style], Drawing]] = {
    "distribution": _draw_distribution,
    "indices": _draw_indices,
    "tornado": _draw_tornado,
}
"""The pictures, by their kind."""
