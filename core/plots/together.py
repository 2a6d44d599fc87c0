"""Several datasets in one picture: the same output over the same axis, a line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibrafeed.core.plots.heading import finish
from vibrafeed.core.plots.parts import padded, set_log, value_range
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.regimes import looks_of
from vibrafeed.core.plots.selection import Selection, outputs_of, select
from vibrafeed.core.plots.style import Options, Style
from vibrafeed.core.plots.text import long_name, short_label
from vibrafeed.core.study.shown import ShownUnits

MOST = 7  # datasets of a picture
Dashes = Literal["solid"] | tuple[float, tuple[float, ...]]
DASHES: tuple[Dashes, ...] = (
    "solid", (0, (6, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)), (0, (10, 3)),
    (0, (3, 1, 1, 1, 1, 1)), (0, (1, 3)),
)  # fmt: skip
ORIGIN = ("scene", "variant", "method")
BEYOND = "Pale: values there do not describe a real part"


def draw_together(datasets: Sequence[xarray.Dataset], options: Options) -> Figure:
    """Return the picture of one output of several datasets over one axis, a curve each.

    Each curve is named by the parameters in which its dataset differs from the others, or by its
    file.

    Raises
    ------
    PlotError
        If the datasets share no output or no axis, or there are too many.
    """
    style = options.style
    if len(datasets) > MOST:
        message = f"{len(datasets)} datasets are too many for one picture, {MOST} are drawn"
        raise PlotError("dataset", message, "Leave some out")
    for dataset in datasets:
        if "regime" not in dataset.data_vars or "scene" not in dataset.attrs:
            fix = "Draw files that `vibrafeed run` wrote"
            raise PlotError("dataset", f"{_name(dataset)} is not a result of vibrafeed", fix)
    selections, units = _selections(datasets, options)
    labels, common = _labels(datasets, selections, units)
    figure = style.sheet()
    sheet = figure.add_subplot()
    beyond = _add_lines(sheet, selections, style)
    first = selections[0]
    ends = value_range(np.concatenate([selection.values for selection in selections]))
    if ends is not None:
        sheet.set_ylim(*padded(*ends))
        if ends[0] < 0 < ends[1]:
            sheet.axhline(0.0, color=style.ink, linewidth=0.7, zorder=1)
    places = np.concatenate([selection.axes[0].values for selection in selections])
    sheet.set_xlim(places.min(), places.max())
    if all(selection.axes[0].is_log for selection in selections):
        set_log(sheet.xaxis, first.axes[0].values)
    sheet.set_xlabel(first.axes[0].label)
    sheet.set_ylabel(short_label(first.variable, first.unit))
    style.add_grid(sheet)
    entries = [
        Line2D([], [], color=colour, linestyle=dashes, linewidth=2.0, label=label)
        for colour, dashes, label in zip(style.series, DASHES, labels, strict=False)
    ]
    return finish(
        figure, sheet, style, name=options.title or long_name(first.variable), facts=common,
        source=_source(datasets), entries=entries, note=BEYOND if beyond else "",
    )  # fmt: skip


def _selections(
    datasets: Sequence[xarray.Dataset], options: Options
) -> tuple[list[Selection], ShownUnits]:
    """Return the curve of each dataset, over one axis and in common units, and these units.

    Output, axis and held values are those of `options`, or what the datasets share. Raises
    `PlotError` if they share no output or axis.
    """
    output = _output(datasets, options.variable)
    axis = _axis(datasets, output, options.axes)
    held = _held(datasets, options.at, axis)

    def selected(units: ShownUnits) -> list[Selection]:
        """Return the curve of each dataset in some units."""
        return [
            select(dataset, output, (axis,), kept, "line", units, nearest=options.nearest)
            for dataset, kept in zip(datasets, held, strict=True)
        ]

    units = options.units
    selections = selected(units)
    if len({selection.unit for selection in selections}) > 1:
        largest = max(float(np.nanmax(np.abs(s.variable))) for s in selections)
        raw = str(selections[0].variable.attrs.get("units", "1"))
        units = ShownUnits(units.system, {**units.wanted, raw: units.of(raw, largest)})
        selections = selected(units)
    return selections, units


def _add_lines(
    sheet: Axes,
    selections: Sequence[Selection],
    style: Style,
) -> bool:
    """Draw a curve of each dataset into one picture; True if some values are not valid.

    Values where the formulas do not hold are pale. `selections` has the values of each dataset and
    their axis, in the units of the picture.
    """
    beyond = False
    rows = zip(selections, style.series, DASHES, strict=False)
    for selection, colour, dashes in rows:
        valid = np.ones(selection.values.shape, dtype=bool)
        if not selection.categories:
            looks = looks_of(selection.regime, selection.regimes, style, exact=selection.exact)
            valid = np.isin(selection.regimes, [look.value for look in looks if look.valid])
        x, values = selection.axes[0].values, selection.values
        if not valid.all():
            beyond = True
            sheet.plot(x, values, color=colour, linestyle=dashes, linewidth=1.6, alpha=0.35)
        sheet.plot(
            x, np.where(valid, values, np.nan), color=colour, linestyle=dashes,
            linewidth=style.width(2.0), marker="o" if x.size < 3 else "", zorder=3,
        )  # fmt: skip
    return beyond


def _output(datasets: Sequence[xarray.Dataset], asked: str | None) -> str:
    """Return the name of the output that curves of several datasets show.

    It is the one `asked` for, or the first that varies in all datasets. Raises `PlotError` if a
    dataset does not have it.
    """
    if asked is not None:
        for dataset in datasets:
            if asked not in dataset.data_vars:
                message = f"{_name(dataset)} has no '{asked[:40]}'"
                raise PlotError("variable", message, "They share " + _listed(_shared(datasets)))
        return asked
    shared = _shared(datasets)
    if not shared:
        told = "; ".join(f"{_name(d)} has {_listed(outputs_of(d))}" for d in datasets)
        raise PlotError(
            "variable", f"the result files have no output in common: {told}", "Draw each by itself"
        )
    return shared[0]


def _axis(datasets: Sequence[xarray.Dataset], output: str, asked: tuple[str, ...] | None) -> str:
    """Return the axis over which curves of several datasets are drawn.

    It is the one `asked` for, or the longest that the output has in all datasets. Raises
    `PlotError` if there is none.
    """
    if asked is not None and len(asked) != 1:
        raise PlotError(
            "axes",
            "several result files in one picture are drawn over exactly one axis",
            "Name one axis, such as amplitude",
        )
    ranged = [
        [str(dim) for dim in d[output].dims if d.sizes[dim] > 1 and dim in d.coords]
        for d in datasets
    ]
    shared = [name for name in ranged[0] if all(name in other for other in ranged)]
    if asked is not None and asked[0] not in shared:
        message = f"{output} is not ranged over '{asked[0][:40]}' in all files"
        raise PlotError("axes", message, "They share " + _listed(shared))
    if not shared:
        told = "; ".join(
            f"{_name(d)} has {_listed(names)}" for d, names in zip(datasets, ranged, strict=True)
        )
        message = f"{output} has no axis in common: {told}"
        raise PlotError("axes", message, "Draw each by itself")
    return asked[0] if asked else max(shared, key=lambda name: datasets[0].sizes[name])


def _held(
    datasets: Sequence[xarray.Dataset], at: Mapping[str, float], axis: str
) -> list[dict[str, float]]:
    """Return the values of `at` that apply to each of several datasets: those of its dimensions.

    `at` has values of parameters by name, as the user asked for; `axis` is the one over which
    curves are drawn. Unknown names, and the axis itself, are kept, so that they are refused later.
    """
    known = {str(name) for dataset in datasets for name in dataset.dims}
    unknown = {name for name in at if name not in known or name == axis}
    return [
        {name: value for name, value in at.items() if name in dataset.dims or name in unknown}
        for dataset in datasets
    ]


def _labels(
    datasets: Sequence[xarray.Dataset], selections: Sequence[Selection], units: ShownUnits
) -> tuple[list[str], list[str]]:
    """Return labels that tell the datasets of a picture apart, and the facts that they share.

    A label is made of parameters, or of the scene or file if these differ. `selections` has the
    facts of each dataset.
    """
    facts = [list(dict.fromkeys(selection.fixed)) for selection in selections]
    common = [fact for fact in facts[0] if all(fact in other for other in facts)]
    labels = [[fact for fact in own if fact not in common] for own in facts]
    for key in ORIGIN:
        values = [str(dataset.attrs.get(key, "")) for dataset in datasets]
        if len(set(values)) > 1:
            labels = [
                [value, *own] if value else own for value, own in zip(values, labels, strict=True)
            ]
    return _distinct([", ".join(own) for own in labels], datasets), common


def _distinct(labels: list[str], datasets: Sequence[xarray.Dataset]) -> list[str]:
    """Return labels of datasets, made different by file names or numbers where they are equal.

    Legends tell curves apart by them; the result has a label for each dataset, in order.
    """
    if len(set(labels)) < len(labels) or not all(labels):
        names = [_name(dataset) for dataset in datasets]
        labels = [": ".join(filter(None, pair)) for pair in zip(names, labels, strict=True)]
    if len(set(labels)) < len(labels):
        labels = [f"{label} ({i})" for i, label in enumerate(labels, 1)]
    return labels


def _source(datasets: Sequence[xarray.Dataset]) -> str:
    """Return the titles of the datasets."""
    titles = dict.fromkeys(str(dataset.attrs.get("title", "")) for dataset in datasets)
    return "; ".join(title for title in titles if title)


def _name(dataset: xarray.Dataset) -> str:
    """Return the name of a dataset: its file, else its title."""
    source = dataset.encoding.get("source")
    return Path(source).name if source else str(dataset.attrs.get("title", "dataset"))


def _shared(datasets: Sequence[xarray.Dataset]) -> list[str]:
    """Return the names of outputs that have several values in every dataset, to compare them by."""
    return [
        name
        for name in outputs_of(datasets[0])
        if all(name in d.data_vars and d[name].size > 1 for d in datasets)
    ]


def _listed(names: Sequence[str]) -> str:
    """Return names separated by commas, or `nothing`."""
    return ", ".join(names) if names else "nothing"
