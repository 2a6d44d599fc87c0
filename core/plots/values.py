"""One design: its values in words and numbers; of an impact, with a sketch of what hits what."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibrafeed.core.plots.bodies import arrows_in_words, draw_bodies, is_pair, read_bodies, views
from vibrafeed.core.plots.categories import categories_of
from vibrafeed.core.plots.fixed import fixed_positions
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.options import Options
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.plots.selection import held_at, held_fixed
from vibrafeed.core.plots.sliced import check_result
from vibrafeed.core.plots.style import Style
from vibrafeed.core.plots.text import axis_label, number, scaled, shown_in, with_unit, words
from vibrafeed.core.study.shown import ShownUnits

MAX_ROWS = 18  # of the table; the file has all
SKETCH = 0.8  # width of the sketch over that of the values
DIGITS = 4  # significant digits
NO_VALUE = "no value"
LEFT_OUT = ("_error", "_residual", "evaluations", "optimum_gap")
"""Ends of the names of variables that describe the computation, not the design."""

Row = tuple[str, str]


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset has one design and no axes are named."""
    check_result(dataset)
    return not options.axes and all(one.size == 1 for one in dataset.data_vars.values())


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the outputs of one cell of a dataset as a table, with a sketch of an impact.

    Ranged parameters are held at `options.at`, by default at their middle values.

    Raises
    ------
    PlotError
        If an output is asked for that the dataset does not have.
    """
    check_result(dataset)
    style, units = options.style, options.units
    loose = [str(name) for name in dataset.dims]
    positions = fixed_positions(dataset, options.at, loose, (), nearest=options.nearest)
    design = dataset.isel(positions)
    rows = rows_of(design, units, options.variable)
    note = ""
    figure = style.sheet(height=max(3.2, 0.27 * min(len(rows), MAX_ROWS) + 1.4))
    if is_pair(dataset):
        bodies, seen = read_bodies(dataset, positions), views(dataset)
        grid = figure.add_gridspec(1, 2, width_ratios=(SKETCH, 1.0))
        panels = grid[0].subgridspec(len(seen), 1).subplots()
        for panel, view in zip(np.ravel(np.asarray(panels)), seen, strict=True):
            draw_bodies(panel, bodies, view, style)
            panel.set_anchor("NW")
        sheet = figure.add_subplot(grid[1])
        note, top = arrows_in_words(bodies), figure.axes[0]
    else:
        top = sheet = figure.add_subplot()
    _write(sheet, rows, style)
    held = [held_at(dataset[name], units, position) for name, position in positions.items()]
    finish(
        figure, top, style, name=options.title or "Values of one design",
        facts=[*held, *held_fixed(design.drop_vars(positions), units)], source=source_of(dataset),
    )  # fmt: skip
    for side in (*sheet.spines.values(), sheet.xaxis, sheet.yaxis):
        side.set_visible(False)
    if note:
        figure.supxlabel(note, fontsize=style.text(8.5), color=style.quiet, x=0.02, ha="left")
    return figure


def rows_of(design: xarray.Dataset, units: ShownUnits, variable: str | None = None) -> list[Row]:
    """Return label and value of each output of one design as texts, the rows of a table.

    `design` has a single value of each; `variable` is an output that comes first. `units` are those
    that the reader wants.

    Raises
    ------
    PlotError
        If the design does not have that output.
    """
    names = [str(name) for name, one in design.data_vars.items() if one.size == 1]
    if variable is not None and variable not in names:
        fix = "Choose among " + ", ".join(names)
        raise PlotError("variable", f"'{variable[:40]}' is unknown", fix)
    told = [name for name in names if not name.endswith(LEFT_OUT)]
    if variable is not None:
        told = [variable, *(name for name in told if name != variable)]
    return [_row(design[name].squeeze(), units) for name in told]


def _row(array: xarray.DataArray, units: ShownUnits) -> Row:
    """Return label and value of an output as texts, in the unit that the reader wants.

    `array` has a single value. A category is shown by its name, "no value" stands for a number that
    is not finite.
    """
    categories = categories_of(array)
    label = axis_label(array, "")
    if categories:
        return label, words(next(iter(categories.values())))
    shown = shown_in(array, units)
    value = float(scaled(array, shown.factor))
    return label, with_unit(number(value, DIGITS), shown.unit) if np.isfinite(value) else NO_VALUE


def _write(axes: Axes, rows: list[Row], style: Style) -> None:
    """Write a table of labels and values into axes, a line a row, the first value in bold.

    Labels stand at the left, values at the right. If there are more than `MAX_ROWS` rows, the last
    line says how many are left out.
    """
    if len(rows) > MAX_ROWS:
        rows = [*rows[: MAX_ROWS - 1], (f"{len(rows) - MAX_ROWS + 1} more in the file", "")]
    axes.set(xlim=(0, 1), ylim=(len(rows) - 0.4, -0.6))
    for row, (label, value) in enumerate(rows):
        axes.axhline(row + 0.5, color=style.grid, linewidth=0.6)
        axes.text(0, row, label, va="center", color=style.quiet, fontsize=style.text(9.5))
        axes.text(
            1, row, value, va="center", ha="right", color=style.ink, fontsize=style.text(10.5),
            fontweight="normal" if row else "bold",
        )  # fmt: skip
