"""The picture of a report: error over run time, both logarithmic."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.figure import Figure

from vibrafeed.core.dataset.regimes import flags_of
from vibrafeed.core.plots.heading import finish
from vibrafeed.core.plots.style import LIGHT, Style
from vibrafeed.core.plots.text import words

MARKERS = "osD^vPX*ph<"
NOTHING = 1e-18  # drawn in place of an error of 0, which a logarithmic axis cannot show


def draw_report(dataset: xarray.Dataset, style: Style = LIGHT) -> Figure | None:
    """Return the picture of a report; None if nothing was measured.

    Parameters
    ----------
    dataset : xarray.Dataset
        The table of `vibrafeed.core.report.Report`, as it is or as its file is read.
    style : Style
        Colours and sizes.
    """
    if not np.isfinite(dataset["error"].values).any():
        return None
    figure = style.sheet(7.0, 5.6)
    axes = figure.subplots()
    for number, curve in enumerate(flags_of(dataset["curve"].attrs).values()):
        here = dataset.isel(curve=number)
        seconds = here["time_per_cell"].values * 1e6
        low, high = (np.fmax(here[name].values, NOTHING) for name in ("error", "error_largest"))
        colour, marker = (set_[number % len(set_)] for set_ in (style.series, MARKERS))
        axes.vlines(seconds, low, high, color=colour, lw=1.2)
        axes.plot(seconds, high, "_", color=colour, ms=8)
        axes.plot(seconds, low, f"{marker}-", color=colour, ms=6.5, lw=1.4, label=words(curve))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("Time of a cell (us)")
    axes.set_ylabel("Error: median (mark) to largest (bar)")
    style.add_grid(axes)
    entries, _ = axes.get_legend_handles_labels()
    name = f"Error against run time: {dataset.attrs.get('title', '')}"
    return finish(figure, axes, style, name=name, entries=entries)
