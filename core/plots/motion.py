"""The picture of one motion: of a part on the moving track, or of one that tumbles."""

from __future__ import annotations

import xarray
from matplotlib.figure import Figure

from core.plots.heading import finish, source_of
from core.plots.options import Options
from core.plots.sliced import check_result
from core.plots.trajectory import TIME, check_trajectory, draw_trajectory, read_trajectory
from core.plots.tumbling import draw_tumbling, read_tumbling


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True of a dataset that holds a motion over a cycle, if no output of it is asked for."""
    return (options.variable, options.axes) == (None, None) and TIME in dataset.dims


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of the one motion that a dataset holds.

    Raises
    ------
    PlotError
        If there is none, or something is asked for that it cannot show.
    """
    check_result(dataset)
    style = options.style
    figure = style.sheet()
    check_trajectory(dataset, options.variable, options.axes, options.at)
    if "path_gap" in dataset:
        course = read_tumbling(dataset, options.units)
        top, entries = draw_tumbling(figure, course, style)
        name, facts = "Course of the part as it falls and tumbles", course.facts
    else:
        trajectory = read_trajectory(dataset, options.units)
        top, entries = draw_trajectory(figure, trajectory, style)
        name, facts = "Motion of the part on the moving track", trajectory.facts
    return finish(
        figure, top, style, name=options.title or name, facts=facts, source=source_of(dataset),
        entries=entries,
    )  # fmt: skip
