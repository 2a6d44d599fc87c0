"""Pictures of one output over one or two axes: what they share.

A painter draws a `Selection` on a figure; the name over it, what is held and the legend are the
same for all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from core.plots.categories import looks_of_categories
from core.plots.heading import finish, source_of
from core.plots.options import Options
from core.plots.problem import PlotError
from core.plots.regimes import Look, looks_of
from core.plots.selection import Selection, natural, select
from core.plots.style import Style
from core.plots.text import long_name

NOT_DESCRIBED = "the closed forms do not describe a part there"
Painter = Callable[[Figure, Selection, Sequence[Look], Style], tuple[Axes, list[Artist]]]


def check_result(dataset: xarray.Dataset) -> None:
    """Raise `PlotError` if a dataset is no result of vibrafeed."""
    if "regime" not in dataset.data_vars or "scene" not in dataset.attrs:
        fix = "Draw a file that `vibrafeed run` wrote"
        raise PlotError("dataset", "it is no result of vibrafeed: no regime or no scene", fix)


def fits_as(kind: str) -> Callable[[xarray.Dataset, Options], bool]:
    """Return what tells whether a dataset is drawn as this kind by nature."""

    def fits(dataset: xarray.Dataset, options: Options) -> bool:
        check_result(dataset)
        return natural(dataset, options.variable, options.axes)[0] == kind

    return fits


def drawn_by(
    painter: Painter, kind: str, beyond: str
) -> Callable[[xarray.Dataset, Options], Figure]:
    """Return what draws a dataset by a painter; `beyond` says how values that do not hold look."""

    def draw(dataset: xarray.Dataset, options: Options) -> Figure:
        check_result(dataset)
        style = options.style
        figure = style.sheet()
        variable, axes = options.variable, options.axes
        if options.is_natural:
            _, variable, axes = natural(dataset, variable, axes)
        selection = select(
            dataset, variable, axes, options.at, kind, options.units, nearest=options.nearest
        )
        if selection.categories:
            looks = looks_of_categories(selection.categories, style)
        else:
            looks = looks_of(dataset["regime"], selection.regimes, style, exact=selection.exact)
        top, entries = painter(figure, selection, looks, style)
        bare = selection.variable.name == "regime"
        name = "Regimes" if bare else long_name(selection.variable)
        how = beyond.format(pale="Dim" if style.dark else "Pale")
        note = f"{how}: {NOT_DESCRIBED}" if any(look.beyond for look in looks) else ""
        return finish(
            figure, top, style, name=options.title or name, facts=list(selection.fixed),
            source=source_of(dataset), entries=entries, note=note,
        )  # fmt: skip

    return draw
