"""The picture of a trade-off: two outputs along a front, with its knee, or the one best choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibrafeed.core.optimise.optimisation import criterion_in_words
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.plots.fixed import fixed_positions
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.landscape import prepared_of
from vibrafeed.core.plots.parts import plain, set_log
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import FEW, axis_of, held_at, held_fixed, thin
from vibrafeed.core.plots.style import RGB, Options, Style
from vibrafeed.core.plots.text import (
    axis_label,
    long_name,
    name_in_words,
    number,
    scaled,
    shown_in,
    with_unit,
)
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.optimise_study import Pareto
from vibrafeed.core.study.shown import ShownUnits

FRONT = "front"
WIDTH, PANEL = 8.0, 4.0  # inches: of a sheet, and of each panel of more than one


@dataclass(frozen=True)
class Fronts:
    """The trade-off fronts of a dataset that are drawn.

    Attributes
    ----------
    dataset : xarray.Dataset
        The result, at what is held.
    criterion : Pareto
        Its criterion.
    others : tuple of str
        The dimensions besides that of the front.
    style, units : Style, ShownUnits
        Looks, and the units for reading.
    """

    dataset: xarray.Dataset
    criterion: Pareto
    others: tuple[str, ...]
    style: Style
    units: ShownUnits

    def of_designs(self) -> xarray.Dataset:
        """Return the fronts with one dimension `design` for all others."""
        if not self.others:
            return self.dataset.expand_dims("design")
        return self.dataset.stack(design=self.others)

    def name(self, design: xarray.Dataset, names: Sequence[str]) -> str:
        """Return names and values of some parameters of a design, as one text."""
        return ", ".join(_value(design[name], self.units) for name in names)


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset holds a trade-off front, and no output or axes are named."""
    return (options.variable, options.axes) == (None, None) and "knee" in dataset


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of trade-off fronts: one output over the other, with the knee marked.

    The front is the result of a study that optimises two outputs at once. Ranged parameters are
    held at `options.at`; of more than seven fronts seven are drawn, evenly chosen, and a note says
    so. Designs in which one choice is best in both outputs have no front: if none has one, the
    picture shows that choice over the ranged parameters.

    Raises
    ------
    PlotError
        If the dataset has no front, or not the value of a parameter that is asked for.
    """
    problem = prepared_of(dataset).problem
    criterion = problem.criterion
    if not isinstance(criterion, Pareto):
        fix = "Draw the result of a study with criterion kind 'pareto'"
        raise PlotError("dataset", "it holds no front", fix)
    units, style = options.units, options.style
    asked = [name for name in options.at if name in dataset.dims]
    positions = fixed_positions(dataset, options.at, asked, (FRONT,), nearest=options.nearest)
    facts = [held_at(dataset[name], units, position) for name, position in positions.items()]
    facts = [criterion_in_words(problem), *facts, *held_fixed(dataset, units)]
    held = dataset.isel(positions)
    others = tuple(str(name) for name in held["optimum_status"].dims if name != FRONT)
    fronts = Fronts(held.drop_vars(positions), criterion, others, style, units)
    designs = fronts.of_designs()
    ends = designs.isel(front=0)
    single = ends["front_points"].values == 1 if "front_points" in ends else np.zeros(0, bool)
    is_single = bool(single.size) and bool(single.all())
    if others and is_single:
        figure, top, entries, note = _draw_choices(fronts)
    else:
        figure = style.sheet()
        top = figure.add_subplot()
        entries, note = _draw_fronts(top, fronts, designs, single)
    name = _no_trade_off(fronts) if is_single else "Trade-off along a front"
    return finish(
        figure, top, style, name=options.title or name, facts=facts,
        source=source_of(dataset, criterion_in_words(problem)), entries=entries, note=note,
    )  # fmt: skip


def _draw_fronts(
    axes: Axes, fronts: Fronts, designs: xarray.Dataset, single: np.ndarray
) -> tuple[list[Artist], str]:
    """Draw the fronts of some designs; return the entries of the legend, and a note.

    `single` is True for a design without a trade-off; such designs are left out where others have a
    front.
    """
    style, units, criterion = fronts.style, fronts.units, fronts.criterion
    count = designs.sizes["design"]
    kept = np.flatnonzero(~single) if single.size and not single.all() else np.arange(count)
    chosen = kept[thin(kept.size, FEW)]
    colours: list[RGB | str] = [style.curve]
    if len(chosen) > 1:
        colours = [*style.series_over(len(chosen))]
    against, output = fronts.dataset[criterion.against], fronts.dataset[criterion.output]
    side, height = shown_in(against, units), shown_in(output, units)
    entries: list[Artist] = []
    for colour, place in zip(colours, chosen, strict=True):
        front = designs.isel(design=int(place))
        across = np.abs(scaled(front[criterion.against], side.factor))
        along = scaled(front[criterion.output], height.factor)
        axes.plot(across, along, color=colour, lw=style.width(1.8))
        knee = np.flatnonzero(front["knee"].values)
        axes.plot(across[knee], along[knee], "o", color=colour, ms=style.width(8),
                  mec=style.ground, zorder=5)  # fmt: skip
        named = fronts.name(front, fronts.others)
        entries.append(Line2D([], [], color=colour, lw=style.width(1.8), label=named or "front"))
    dot = "knee: where the front bends most"
    if single.size and single.all():
        front = designs.isel(design=0, front=0)
        names = [str(name) for name in front.data_vars if str(name).startswith("best_")]
        dot = f"best in both: {fronts.name(front, names)}"
        entries.clear()
    entries.append(
        Line2D([], [], ls="", marker="o", color=style.quiet, ms=style.width(8),
               mec=style.ground, label=dot)
    )  # fmt: skip
    if not np.isfinite(output.values).any():
        axes.annotate(
            "No choice within the bounds keeps all limits", (0.5, 0.5), xycoords="axes fraction",
            ha="center", va="center", color=style.ink, fontsize=style.text(11),
        )  # fmt: skip
    axes.set_xlabel(f"Magnitude of the {in_sentence(axis_label(against, side.unit))}")
    axes.set_ylabel(axis_label(output, height.unit))
    style.add_grid(axes)
    notes = [f"{len(chosen)} of {count} designs"] if len(chosen) < count else []
    if kept.size < count:
        notes.append(f"{count - kept.size} without a trade-off")
    return entries, ", ".join(notes)


def _draw_choices(fronts: Fronts) -> tuple[Figure, Axes, list[Artist], str]:
    """Draw the best choice of designs without a trade-off over their ranged parameters.

    Each variable has a panel over the parameter with most values; the others make a family of at
    most seven curves. Designs in which nothing moves are left out. The result are figure, uppermost
    axes, entries of the legend, and a note.
    """
    style, units = fronts.style, fronts.units
    best = fronts.dataset.isel({FRONT: 0})
    across = max(fronts.others, key=lambda name: best.sizes[name])
    rest = tuple(name for name in fronts.others if name != across)
    axis = axis_of(best[across], units)
    family = best.stack(design=rest) if rest else best.expand_dims("design")
    count = family.sizes["design"]
    chosen = thin(count, FEW)
    colours: list[RGB | str] = [style.curve]
    if len(chosen) > 1:
        colours = [*style.series_over(len(chosen))]
    names = [str(name) for name in best.data_vars if str(name).startswith("best_")]
    figure = style.sheet(WIDTH, 6.4 if len(names) == 1 else PANEL * len(names))
    panels = np.ravel(figure.subplots(len(names), 1, sharex=True, squeeze=False))
    for panel, name in zip(panels, names, strict=True):
        shown = shown_in(best[name], units)
        for colour, place in zip(colours, chosen, strict=True):
            curve = family.isel(design=int(place))
            values = curve[name].where(curve["optimum_status"] != STATUS["no_motion"])
            panel.plot(axis.values, scaled(values, shown.factor), "o-", color=colour,
                       lw=style.width(1.8), ms=style.width(4))  # fmt: skip
        panel.set_ylabel(axis_label(best[name], shown.unit))
        panel.yaxis.set_major_formatter(plain)
        style.add_grid(panel)
    if axis.is_log:
        set_log(panels[-1].xaxis, axis.values)
    panels[-1].set_xlabel(axis.label)
    entries: list[Artist] = [
        Line2D([], [], color=colour, lw=style.width(1.8),
               label=fronts.name(family.isel(design=int(place)), rest) or "best choice")
        for colour, place in zip(colours, chosen, strict=True)
    ]  # fmt: skip
    notes = [f"{len(chosen)} of {count} curves"] if len(chosen) < count else []
    if still := int((best["optimum_status"] == STATUS["no_motion"]).sum()):
        notes.append(f"nothing moves in {still} of {best['optimum_status'].size} designs")
    return figure, panels[0], entries, ", ".join(notes)


def _no_trade_off(fronts: Fronts) -> str:
    """Return a sentence that says that one choice is best in both outputs."""
    criterion = fronts.criterion
    output, against = (long_name(fronts.dataset[n]) for n in (criterion.output, criterion.against))
    return f"No trade-off: {in_sentence(against)} least where {in_sentence(output)} is largest"


def _value(array: xarray.DataArray, units: ShownUnits) -> str:
    """Return name and value of a variable with its unit."""
    shown = shown_in(array, units)
    value = number(float(scaled(array, shown.factor)), 4)
    return f"{name_in_words(str(array.name).removeprefix('best_'))} {with_unit(value, shown.unit)}"
