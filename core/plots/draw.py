"""The picture of a dataset."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from core.plots.calibration import KINDS as CALIBRATION
from core.plots.calibration import draw_calibration, is_calibration
from core.plots.categories import looks_of_categories
from core.plots.contour import draw_contour
from core.plots.heading import finish, source_of
from core.plots.levels import draw_levels
from core.plots.line import draw_line
from core.plots.parallel import draw_parallel
from core.plots.problem import PlotError
from core.plots.regime_map import draw_map
from core.plots.regimes import Look, looks_of
from core.plots.selection import Selection, select
from core.plots.style import Style
from core.plots.surface import draw_surface
from core.plots.text import long_name, units_of
from core.plots.thresholds import draw_thresholds
from core.plots.together import draw_together
from core.plots.trajectory import TIME, check_trajectory, draw_trajectory, read_trajectory
from core.plots.tumbling import draw_tumbling, read_tumbling
from core.plots.uncertain import PAINTERS as UNCERTAIN
from core.plots.uncertain import draw_uncertain, kind_of

NOT_DESCRIBED = "the closed forms do not describe a part there"
Painter = Callable[[Figure, Selection, Sequence[Look], Style], tuple[Axes, list[Artist]]]
PAINTERS: dict[str, Painter] = {
    "contour": draw_contour,
    "surface": draw_surface,
    "line": draw_line,
    "map": draw_map,
    "levels": draw_levels,
}
WHOLE: dict[str, Callable[..., Figure]] = {
    "thresholds": draw_thresholds,
    "parallel": draw_parallel,
}
"""Kinds that choose for themselves what they show."""
BEYOND = {
    "contour": "{pale} and hatched",
    "surface": "Grey",
    "line": "Hatched or dashed",
    "map": "Hatched",
    "levels": "Hatched",
}
"""How kinds of picture show values that do not hold."""
MOTIONS = {
    "track": "Motion of the part on the moving track",
    "tumbling": "Course of the part as it falls and tumbles",
}


def draw(
    dataset: xarray.Dataset | Sequence[xarray.Dataset],
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, float] | None = None,
    kind: str | None = None,
    title: str | None = None,
    units: Sequence[str] | str | None = None,
    nearest: bool = False,
    dark: bool = False,
    small: bool = False,
) -> Figure:
    """Return the picture of an output with the regime shaded, of the regimes, or of one motion.

    Parameters
    ----------
    dataset : xarray.Dataset, or a sequence of them
        A sweep or simulation, as `core.sweep.sweep` or `core.motion.simulate` returns it or as its
        file is read. Of several, up to seven, the same output is drawn over the same axis.
    variable : str, optional
        The output; the first if left out.
    axes : tuple of str, optional
        One or two dimensions, the first across; the longest if left out.
    at : mapping of str to float, optional
        Values of other dimensions, in the unit of the dataset; the middle one if left out.
    kind : str, optional
        contour, surface, line, map, levels, thresholds, parallel, trajectory, front or landscape;
        of uncertain parameters distribution, indices, effects or tornado; of a calibration
        posterior, speeds or residuals. If left out: contour over two axes, line over one,
        trajectory where the dataset holds a motion over a cycle, distribution where it tells of
        uncertain parameters, posterior of a calibration. A line with
        two axes is a family of curves, at most seven, and what is drawn where an axis has no more
        values than that. A map shows the regimes, or an output whose numbers stand for words.
    title : str, optional
        The name of the picture; that of what it shows if left out.
    units : str or sequence of str, optional
        Units in which values are read: trade, si, or units such as m/min, each for its kind. If
        left out, those of the study.
    nearest : bool
        Whether a value of `at` that the dataset does not have stands for the nearest one.
    dark : bool
        Light on dark.
    small : bool
        For a column of a document, some 11 cm wide.

    Returns
    -------
    matplotlib.figure.Figure
        A figure with a canvas of its own; a notebook shows it.

    Raises
    ------
    PlotError
        If the dataset does not hold what is asked for.

    Examples
    --------
    >>> from pathlib import Path
    >>> from core.plots import draw
    >>> from core.study import load_study
    >>> from core.sweep import sweep
    >>> dataset = sweep(load_study(Path("configs/figures/fig-5-1.toml")))
    >>> figure = draw(dataset, axes=("beta", "alpha"), kind="surface")
    """
    datasets = [dataset] if isinstance(dataset, xarray.Dataset) else list(dataset)
    if not datasets:
        raise PlotError("dataset", "there is none", "Give one or more")
    dataset = datasets[0]
    style, shown = Style(dark=dark, small=small), units_of(dataset, units)
    if len(datasets) > 1:
        if kind not in (None, "line"):
            fix = "Leave the kind out, or draw each by itself"
            raise PlotError("kind", "several datasets are drawn as lines", fix)
        return draw_together(
            datasets, style, shown, variable=variable, axes=axes, at=at, nearest=nearest,
            title=title,
        )  # fmt: skip
    if kind == "animation":
        fix = "Call vibrafeed.animate, or end the name in .gif or .mp4"
        raise PlotError("kind", "an animation is a file, not a figure", fix)
    if kind in CALIBRATION or is_calibration(dataset):
        return draw_calibration(dataset, kind, style, shown, title=title)
    if kind is None and (variable, axes) == (None, None):
        kind = kind_of(dataset)
    if kind in UNCERTAIN:
        return draw_uncertain(
            kind, dataset, style, shown, variable=variable, at=at, nearest=nearest, title=title
        )
    if kind in ("front", "landscape") or (kind is None and not axes and "knee" in dataset):
        from core.plots.front import draw_front  # loads the optimiser
        from core.plots.landscape import draw_landscape

        if kind == "landscape":
            return draw_landscape(dataset, at, style, shown, title=title, nearest=nearest)
        return draw_front(dataset, style, shown, title=title)
    if "regime" not in dataset.data_vars or "scene" not in dataset.attrs:
        fix = "Draw a file that `vibrafeed run` wrote"
        raise PlotError("dataset", "it is no result of vibrafeed: no regime or no scene", fix)
    if kind in WHOLE:
        return WHOLE[kind](
            dataset, style, shown, variable=variable, axes=axes, at=at, nearest=nearest, title=title
        )
    figure = style.sheet()
    if kind == "trajectory" or (
        (kind, variable, axes) == (None, None, None) and TIME in dataset.dims
    ):
        check_trajectory(dataset, variable, axes, at or {})
        if "path_gap" in dataset:
            course = read_tumbling(dataset, shown)
            top, entries = draw_tumbling(figure, course, style)
            name, facts, note = MOTIONS["tumbling"], course.facts, ""
        else:
            trajectory = read_trajectory(dataset, shown)
            top, entries = draw_trajectory(figure, trajectory, style)
            name, facts, note = MOTIONS["track"], trajectory.facts, ""
    else:
        selection = select(dataset, variable, axes, at or {}, kind, shown, nearest=nearest)
        if selection.categories:
            looks = looks_of_categories(selection.categories, style)
        else:
            looks = looks_of(dataset["regime"], selection.regimes, style, exact=selection.exact)
        top, entries = PAINTERS[selection.kind](figure, selection, looks, style)
        bare = selection.variable.name == "regime"
        name = "Regimes" if bare else long_name(selection.variable)
        facts = list(selection.fixed)
        beyond = any(look.beyond for look in looks)
        how = BEYOND[selection.kind].format(pale="Dim" if dark else "Pale")
        note = f"{how}: {NOT_DESCRIBED}" if beyond else ""
    return finish(
        figure, top, style, name=title or name, facts=facts, source=source_of(dataset),
        entries=entries, note=note,
    )  # fmt: skip
