"""Pictures of one output over one or two axes: what they share.

A painter draws a `Selection` on a figure; the name over it, what is held and the legend are the
same for all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase, SubFigure

from vibrafeed.core.dataset.regimes import flags_of
from vibrafeed.core.plots.bodies import draw_bodies, read_bodies, views
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.pictures import is_pair
from vibrafeed.core.plots.regimes import PLAIN, Look, looks_of, looks_of_categories
from vibrafeed.core.plots.selection import (
    ANY_REGIME,
    Selection,
    check_result,
    natural,
    select,
)
from vibrafeed.core.plots.style import Options, Style
from vibrafeed.core.plots.text import long_name
from vibrafeed.core.quantities import STATUSES
from vibrafeed.core.quantities.flags import is_regime

NO_REGIMES = "no regimes"
NOT_DESCRIBED = "the closed forms do not describe a part there"
BESIDE = (2.6, 1.0)  # widths of a picture, and of the sketch of what hits what
Painter = Callable[[FigureBase, Selection, Sequence[Look], Style], tuple[Axes, list[Artist]]]


def _said(look: Look, dataset: xarray.Dataset, regime: xarray.DataArray) -> Look:
    """Return a regime's look for the legend, named by the reason if its cells have no regime.

    The reason is the status of these cells, such as an invalid geometry, if the dataset has one.
    """
    if look.name != "not_assessed":
        return look
    nowhere = regime == look.value
    for name in STATUSES:
        if name in dataset and dataset[name].dims == nowhere.dims:
            meanings = flags_of(dataset[name].attrs)
            present = np.unique(dataset[name].values[nowhere.values]).tolist()
            why = [meanings[one] for one in present if one in meanings]
            if why:
                return replace(look, name=" or ".join(why))
    return look


def _add_sketch(sheet: SubFigure, dataset: xarray.Dataset, options: Options) -> None:
    """Draw two colliding bodies as they lie, from each side, beside a picture of their impact.

    `sheet` is the space for the views. Ranged parameters are taken at the values of `options.at`,
    the nearest that the dataset has.
    """
    positions = {
        str(name): int(np.abs(dataset[name].values - value).argmin())
        for name, value in options.at.items()
        if name in dataset.dims
    }
    bodies = read_bodies(dataset, positions)
    seen = views(dataset)
    panels = np.ravel(sheet.subplots(len(seen), 1, squeeze=False))
    for panel, view in zip(panels, seen, strict=True):
        draw_bodies(panel, bodies, view, options.style)


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a kind of picture suits the axes and values of a dataset best."""
    check_result(dataset)
    return natural(dataset, options.variable, options.axes)[0] == options.kind


def render(dataset: xarray.Dataset, options: Options, painter: Painter, beyond: str) -> Figure:
    """Return the picture of a slice of a dataset.

    Parameters
    ----------
    dataset, options : xarray.Dataset, Options
        The result, and what is asked for.
    painter : callable
        Draws the selected values into a figure; returns axes and legend entries.
    beyond : str
        Says in a note how regimes look in which formulas do not hold, with ``{pale}`` in place of
        the style's word for pale.
    """
    check_result(dataset)
    style = options.style
    figure = style.sheet()
    variable, axes = options.variable, options.axes
    if options.is_natural:
        _, variable, axes = natural(dataset, variable, axes)
    selection = select(
        dataset,
        variable,
        axes,
        options.at,
        str(options.kind),
        options.units,
        nearest=options.nearest,
    )
    if selection.categories:
        looks = looks_of_categories(selection.categories, style)
    elif "regime" in dataset:
        looks = looks_of(selection.regime, selection.regimes, style, exact=selection.exact)
        looks = [_said(look, dataset, selection.regime) for look in looks]
    else:
        looks = [Look(ANY_REGIME, NO_REGIMES, True, *PLAIN, style)]
    sheet: FigureBase = figure
    beside: SubFigure | None = None
    if is_pair(dataset):
        sheet, beside = np.ravel(figure.subfigures(1, 2, squeeze=False, width_ratios=BESIDE))
    top, entries = painter(sheet, selection, looks, style)
    entries = [one for one in entries if not str(one.get_label()).startswith(NO_REGIMES)]
    if beside is not None:
        _add_sketch(beside, dataset, options)
    bare = is_regime(str(selection.variable.name))
    name = long_name(selection.variable)
    if bare:
        name = f"Regimes{name.removeprefix('Regime')}"
    how = beyond.format(pale="Dim" if style.dark else "Pale")
    note = f"{how}: {NOT_DESCRIBED}" if any(look.beyond for look in looks) else ""
    return finish(
        figure, top, style, name=options.title or name, facts=list(selection.fixed),
        source=source_of(dataset), entries=entries, note=note,
    )  # fmt: skip
