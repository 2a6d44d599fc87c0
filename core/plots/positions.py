"""A row of parts: positions over time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vibrafeed.core.kinds.results import tabulate
from vibrafeed.core.motion.row_scene import ROW
from vibrafeed.core.plots.parts import finish, padded, source_of
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import check_result, held_fixed
from vibrafeed.core.plots.style import Options, mix, scaled, shown_in
from vibrafeed.core.plots.trajectory import TIME, followed
from vibrafeed.core.study.shown import Shown, ShownUnits

FIRST = "part_position_1"
PALE = 0.25


class RowPositions(NamedTuple):
    """The parts of a row over time, from the rear on, in the units in which they are drawn.

    `times` have the shape (n,), `centres` of the parts on the track (parts, n); `closed` tells
    where a part touches the one in front, shape (parts - 1, n). The length of a part is 0 if the
    study does not have it.
    """

    times: NDArray[np.float64]
    centres: NDArray[np.float64]
    length: float
    closed: NDArray[np.bool_]
    time: Shown
    along: Shown


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one row of parts in time, and no output or axes are asked for."""
    if options.asks or dataset.attrs.get("scene") != ROW:
        return False
    return FIRST in dataset or followed(dataset) is not None


def read_row(dataset: xarray.Dataset, units: ShownUnits) -> RowPositions:
    """Return the positions of a row of parts over time, in the units that are drawn.

    `PlotError` tells that the dataset has no row in time.
    """
    if FIRST not in dataset:
        raise PlotError(
            "dataset",
            "the dataset has no positions of a row of parts over time",
            "Set trajectory = 400 in the study, and run the study again",
        )
    names = [
        f"part_position_{n + 1}" for n in range(len(dataset)) if f"part_position_{n + 1}" in dataset
    ]
    time, along = shown_in(dataset[TIME], units), shown_in(dataset[FIRST], units)
    centres = np.array([scaled(dataset[name], along.factor) for name in names])
    length = scaled(dataset["length"], along.factor).item() if "length" in dataset else 0.0
    # Of the way that is shown: a smaller gap is none.
    closed = np.diff(centres, axis=0) - length <= 1e-9 * np.ptp(centres)
    return RowPositions(scaled(dataset[TIME], time.factor), centres, length, closed, time, along)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a row of parts: positions over time, shaded where parts touch.

    A row without positions over time is followed again to get them. `PlotError` tells that the
    dataset has no row in time.
    """
    check_result(dataset)
    if FIRST not in dataset and (one := followed(dataset)) is not None:
        dataset = tabulate(one).to_xarray()
    style, units = options.style, options.units
    row = read_row(dataset, units)
    figure = style.sheet()
    axes = figure.add_subplot()
    pale = mix(style.ground, style.curve, PALE)
    for below, above, touch in zip(row.centres, row.centres[1:], row.closed, strict=False):
        axes.fill_between(row.times, below, above, where=touch, color=pale, linewidth=0.0)
    for line in row.centres:
        axes.plot(row.times, line, color=style.curve, linewidth=style.width(1.4))
    axes.set(
        xlabel=f"Time since the start ({row.time.unit})",
        ylabel=f"Position on the track ({row.along.unit})",
        xlim=(row.times[0], row.times[-1]),
        ylim=padded(float(row.centres.min()), float(row.centres.max())),
    )
    entries = [
        Line2D([], [], color=style.curve, linewidth=style.width(1.4), label="centre of a part"),
        Patch(color=pale, label="neighbours that touch"),
    ]
    name = options.title or f"A row of {len(row.centres)} parts, from its start"
    return finish(
        figure, axes, style, name=name,
        facts=held_fixed(dataset, units), source=source_of(dataset), entries=entries,
    )  # fmt: skip
