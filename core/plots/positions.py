"""The positions of the parts of a row over time, and the times at which they touch."""

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
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.motion import followed
from vibrafeed.core.plots.options import Options
from vibrafeed.core.plots.parts import padded
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.plots.selection import held_fixed
from vibrafeed.core.plots.sliced import check_result
from vibrafeed.core.plots.style import mix
from vibrafeed.core.plots.text import scaled, shown_in
from vibrafeed.core.plots.trajectory import TIME
from vibrafeed.core.study.shown import Shown, ShownUnits

FIRST = "part_position_1"
TOUCHES = 1e-9
"""Of the way that is shown: gaps that are no larger are those of parts that touch."""
PALE = 0.25


class RowPositions(NamedTuple):
    """The parts of a row over time, from the rear on, in the units in which they are drawn.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Times, in `time`.
    places : ndarray, shape (parts, n)
        Centres of the parts on the track, in `along`.
    length : float
        Length of a part, in `along`; 0 if the study does not have it.
    closed : ndarray of bool, shape (parts - 1, n)
        Where a part touches the one in front of it.
    time, place : Shown
        The units.
    """

    times: NDArray[np.float64]
    centres: NDArray[np.float64]
    length: float
    closed: NDArray[np.bool_]
    time: Shown
    along: Shown


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is drawn as positions of a row of parts by default: it is one such row.

    `options` are those of the picture; an output or axes that are asked for ask for another
    picture.
    """
    asked = (options.variable, options.axes) != (None, None)
    if asked or dataset.attrs.get("scene") != ROW:
        return False
    return FIRST in dataset or followed(dataset) is not None


def read_row(dataset: xarray.Dataset, units: ShownUnits) -> RowPositions:
    """Return the positions of a row of parts over time, in the units that are drawn.

    The dataset has a position over time for each part; the result tells, too, which neighbours
    touch when. `units` are those that the reader wants.

    Raises
    ------
    PlotError
        If the dataset has no row in time.
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
    closed = np.diff(centres, axis=0) - length <= TOUCHES * np.ptp(centres)
    return RowPositions(scaled(dataset[TIME], time.factor), centres, length, closed, time, along)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a row of parts: positions over time, shaded where parts touch.

    The dataset is the result of a study of a row; if it has no positions over time, its single cell
    is followed again to get them.

    Raises
    ------
    PlotError
        If the dataset has no row in time.
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
    axes.set_xlabel(f"Time since the start ({row.time.unit})")
    axes.set_ylabel(f"Position on the track ({row.along.unit})")
    axes.set_xlim(row.times[0], row.times[-1])
    axes.set_ylim(*padded(float(row.centres.min()), float(row.centres.max())))
    entries = [
        Line2D([], [], color=style.curve, linewidth=style.width(1.4), label="centre of a part"),
        Patch(color=pale, label="neighbours that touch"),
    ]
    name = options.title or f"A row of {len(row.centres)} parts, from its start"
    return finish(
        figure, axes, style, name=name,
        facts=held_fixed(dataset, units), source=source_of(dataset), entries=entries,
    )  # fmt: skip
