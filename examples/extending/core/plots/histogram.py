"""How often each value of an output occurs over all cells of a dataset."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.figure import Figure

from vibrafeed.core.plots.parts import finish, source_of
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import check_result
from vibrafeed.core.plots.style import Options, axis_label, long_name, scaled, shown_in


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """Return False: it is drawn only on request."""
    return False


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the histogram of an output; raise `PlotError` without such an output."""
    check_result(dataset)
    outputs = [str(name) for name in dataset.data_vars if name != "regime"]
    name = options.variable or outputs[0]
    if name not in outputs:
        raise PlotError("variable", f"'{name}' is unknown", "Choose among " + ", ".join(outputs))
    shown = shown_in(dataset[name], options.units)
    values = np.ravel(scaled(dataset[name], shown.factor))
    figure = options.style.sheet()
    axes = figure.add_subplot()
    axes.hist(values[np.isfinite(values)], bins=30, color=options.style.curve)
    axes.set_xlabel(axis_label(dataset[name], shown.unit))
    axes.set_ylabel("Cells")
    return finish(
        figure, axes, options.style, name=options.title or f"Values of: {long_name(dataset[name])}",
        facts=[], source=source_of(dataset), entries=[],
    )  # fmt: skip
