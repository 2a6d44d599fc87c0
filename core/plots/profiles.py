"""The objective of an optimisation along each variable, the others held at the optimum."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.figure import Figure

from vibrafeed.core.optimise.optimisation import criterion_in_words
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.landscape import (
    SOLVED,
    curves_of,
    design_positions,
    draw_curve,
    held_of,
    name_of,
)
from vibrafeed.core.plots.optimum import is_optimum, prepared_of
from vibrafeed.core.plots.options import Options

COLUMNS = 3  # curves side by side, at most
HEIGHT = 2.6  # inches of a row


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one design with more than two variables."""
    asked = (options.variable, options.axes) != (None, None)
    return not asked and is_optimum(dataset) and dataset["optimum_status"].size == 1


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return curves of an optimisation's objective along each variable, through the optimum.

    In each curve the other variables are at the optimum, or in the middle of their bounds if there
    is none; ranges that constraints exclude are shaded. Ranged parameters are held at `options.at`,
    at their middle values if left out.

    Raises
    ------
    PlotError
        If the dataset is no optimisation, or does not have a value that is asked for.
    """
    style, units = options.style, options.units
    prepared = prepared_of(dataset)
    positions = design_positions(dataset, prepared, options)
    shown = curves_of(dataset, prepared, positions, units)
    rows = -(-len(shown) // COLUMNS)
    columns = -(-len(shown) // rows)
    figure = style.sheet(height=max(4.2, HEIGHT * rows + 1.6))
    panels = np.ravel(figure.subplots(rows, columns, squeeze=False))
    entries = {}
    for panel, curve in zip(panels, shown, strict=False):
        for entry in draw_curve(panel, curve, style):
            entries[str(entry.get_label())] = entry
    for k, panel in enumerate(panels):
        if k >= len(shown):
            panel.remove()
        elif k % columns:
            panel.set_ylabel("")
    solved = bool(np.all(np.isin(dataset.isel(positions)["optimum_status"], SOLVED)))
    through = "the optimum" if solved else "the middle of the bounds: there is no optimum"
    return finish(
        figure, panels[0], style, name=options.title or f"Objective: {name_of(prepared.problem)}",
        facts=held_of(dataset, prepared, positions, units),
        source=source_of(dataset, criterion_in_words(prepared.problem)),
        entries=list(entries.values()), note=f"Each curve passes through {through}",
    )  # fmt: skip
