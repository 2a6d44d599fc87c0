"""Where the parts of a row are, over time, and which of them touch."""

from __future__ import annotations

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from core.kinds.results import tabulate
from core.motion.row_scene import ROW
from core.plots.heading import finish, source_of
from core.plots.motion import followed
from core.plots.options import Options
from core.plots.parts import add_room
from core.plots.problem import PlotError
from core.plots.selection import held_fixed
from core.plots.sliced import check_result
from core.plots.style import mix
from core.plots.text import scaled, shown_in
from core.plots.trajectory import TIME

FIRST = "part_position_1"
TOUCHES = 1e-9
"""Of the way that is shown: gaps that are no larger are those of parts that touch."""


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True of one row of parts, if no output is asked for."""
    asked = (options.variable, options.axes) != (None, None)
    if asked or dataset.attrs.get("scene") != ROW:
        return False
    return FIRST in dataset or followed(dataset) is not None


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the places of all parts over time, shaded between those that touch.

    Raises
    ------
    PlotError
        If the dataset holds no row in time.
    """
    check_result(dataset)
    if FIRST not in dataset and (one := followed(dataset)) is not None:
        dataset = tabulate(one).to_xarray()
    if FIRST not in dataset:
        raise PlotError("dataset", "it has no row of parts in time", "Add trajectory = 400")
    style, units = options.style, options.units
    names = [
        f"part_position_{n + 1}" for n in range(len(dataset)) if f"part_position_{n + 1}" in dataset
    ]
    time, place = shown_in(dataset[TIME], units), shown_in(dataset[FIRST], units)
    times = scaled(dataset[TIME], time.factor)
    places = np.array([scaled(dataset[name], place.factor) for name in names])
    figure = style.sheet()
    axes = figure.add_subplot()
    pale = mix(style.ground, style.curve, 0.25)
    # A study without the length of its parts has them as points.
    length = scaled(dataset["length"], place.factor).item() if "length" in dataset else 0.0
    closed = np.diff(places, axis=0) - length <= TOUCHES * np.ptp(places)
    for below, above, touch in zip(places, places[1:], closed, strict=False):
        axes.fill_between(times, below, above, where=touch, color=pale, linewidth=0.0)
    for line in places:
        axes.plot(times, line, color=style.curve, linewidth=style.width(1.4))
    axes.set_xlabel(f"Time since the start ({time.unit})")
    axes.set_ylabel(f"Position on the track ({place.unit})")
    axes.set_xlim(times[0], times[-1])
    axes.set_ylim(*add_room(float(places.min()), float(places.max())))
    entries = [
        Line2D([], [], color=style.curve, linewidth=style.width(1.4), label="centre of a part"),
        Patch(color=pale, label="neighbours that touch"),
    ]
    return finish(
        figure, axes, style, name=options.title or f"A row of {len(names)} parts, from its start",
        facts=held_fixed(dataset, units), source=source_of(dataset), entries=entries,
    )  # fmt: skip
