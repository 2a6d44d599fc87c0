"""The picture of one motion: of a part on the moving track, or of one that tumbles."""

from __future__ import annotations

import xarray
from matplotlib.figure import Figure

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import parse_json
from vibrafeed.core.kinds.results import prepare, tabulate
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.options import Options
from vibrafeed.core.plots.sliced import check_result
from vibrafeed.core.plots.trajectory import TIME, check_trajectory, draw_trajectory, read_trajectory
from vibrafeed.core.plots.tumbling import draw_tumbling, read_tumbling
from vibrafeed.core.study import SimulateStudy

TIMES = 400  # points of a trajectory that is computed for a picture


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is one simulated part, or a motion over a cycle."""
    asked = (options.variable, options.axes) != (None, None)
    return not asked and (TIME in dataset.dims or followed(dataset) is not None)


def followed(dataset: xarray.Dataset) -> Prepared | None:
    """Return the study of a dataset's single cell, prepared to be followed over a cycle, or None.

    So a result without a trajectory can be drawn as a motion. None if there are several cells, no
    study of a motion, or a method that gives no trajectory.
    """
    text = str(dataset.attrs.get("study", ""))
    if "motion_status" not in dataset or any(one.size > 1 for one in dataset.values()) or not text:
        return None
    try:
        study = parse_json(text)
        if not isinstance(study, SimulateStudy):
            return None
        return prepare(study.model_copy(update={"trajectory": TIMES}))
    except VibrafeedError:
        return None


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of the motion of a dataset's single part over time.

    A dataset without a time axis but with one cell is followed in time first. The picture of a
    tumbling part shows its path, that of any other how it moves on the track.

    Raises
    ------
    PlotError
        If the dataset has no single motion, or an option does not apply to it.
    """
    check_result(dataset)
    style = options.style
    if TIME not in dataset.dims and options.is_natural and (one := followed(dataset)) is not None:
        dataset = tabulate(one).to_xarray()
    figure = style.sheet()
    check_trajectory(dataset)
    if "path_gap" in dataset:
        course = read_tumbling(dataset, options.units)
        top, entries = draw_tumbling(figure, course, style)
        name, facts = "Trajectory of the part as it falls and tumbles", course.facts
    else:
        trajectory = read_trajectory(dataset, options.units)
        top, entries = draw_trajectory(figure, trajectory, style)
        name, facts = "Motion of the part on the moving track", trajectory.facts
    return finish(
        figure, top, style, name=options.title or name, facts=facts, source=source_of(dataset),
        entries=entries,
    )  # fmt: skip
