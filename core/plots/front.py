"""The picture of a trade-off: two outputs along a front, with its knee."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from core.optimise.sentences import criterion_in_words
from core.plots.heading import finish, source_of
from core.plots.optimum import prepared_of
from core.plots.options import Options
from core.plots.problem import PlotError
from core.plots.selection import FEW, held_fixed
from core.plots.style import RGB
from core.plots.text import axis_label, name_in_words, number, scaled, shown_in, with_unit
from core.quantities.quantity import in_sentence
from core.study.optimise_study import Pareto
from core.study.shown import ShownUnits


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset holds a trade-off front and no axes are named."""
    return not options.axes and "knee" in dataset


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a trade-off front: one output over the other, with the knee marked.

    The front is the result of a study that optimises two outputs at once. Of a dataset with more
    than seven designs, seven fronts are drawn, evenly chosen.

    Raises
    ------
    PlotError
        If the dataset has no front.
    """
    style, units = options.style, options.units
    problem = prepared_of(dataset).problem
    criterion = problem.criterion
    if not isinstance(criterion, Pareto):
        fix = "Draw the result of a study with criterion kind 'pareto'"
        raise PlotError("dataset", "it holds no front", fix)
    figure = style.sheet()
    axes = figure.add_subplot()
    others = [str(name) for name in dataset["optimum_status"].dims if name != "front"]
    fronts = dataset.stack(design=others) if others else dataset.expand_dims("design")
    count = fronts.sizes["design"]
    chosen = np.unique(np.linspace(0, count - 1, min(count, FEW)).astype(int))
    colours: list[RGB | str] = [style.curve]
    if len(chosen) > 1:
        colours = [*style.series_over(len(chosen))]
    against, output = dataset[criterion.against], dataset[criterion.output]
    side, height = shown_in(against, units), shown_in(output, units)
    entries = []
    for colour, place in zip(colours, chosen, strict=True):
        front = fronts.isel(design=int(place))
        across = np.abs(scaled(front[criterion.against], side.factor))
        along = scaled(front[criterion.output], height.factor)
        axes.plot(across, along, color=colour, lw=style.width(1.8))
        knee = np.flatnonzero(front["knee"].values)
        axes.plot(across[knee], along[knee], "o", color=colour, ms=style.width(8),
                  mec=style.ground, zorder=5)  # fmt: skip
        named = ", ".join(_value(front[name], units) for name in others)
        entries.append(Line2D([], [], color=colour, lw=style.width(1.8), label=named or "front"))
    entries.append(
        Line2D([], [], ls="", marker="o", color=style.quiet, ms=style.width(8),
               mec=style.ground, label="knee: where the front bends most")
    )  # fmt: skip
    if not np.isfinite(dataset[criterion.output].values).any():
        axes.annotate(
            "No choice within the bounds keeps all limits", (0.5, 0.5), xycoords="axes fraction",
            ha="center", va="center", color=style.ink, fontsize=style.text(11),
        )  # fmt: skip
    label = axis_label(against, side.unit)
    axes.set_xlabel(f"Magnitude of the {in_sentence(label)}")
    axes.set_ylabel(axis_label(output, height.unit))
    style.add_grid(axes)
    return finish(
        figure, axes, style, name=options.title or "Trade-off along a front",
        facts=[criterion_in_words(problem), *held_fixed(dataset, units)],
        source=source_of(dataset, criterion_in_words(problem)), entries=entries,
    )  # fmt: skip


def _value(array: xarray.DataArray, units: ShownUnits) -> str:
    """Return name and value of a variable with its unit."""
    shown = shown_in(array, units)
    value = number(float(scaled(array, shown.factor)), 4)
    return f"{name_in_words(str(array.name))} {with_unit(value, shown.unit)}"
