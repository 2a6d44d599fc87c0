"""The velocity over a plate: an arrow for each cell over two axes, its colour the speed."""

import numpy as np
import xarray
from matplotlib.figure import Figure

from vibrafeed.core.dataset.table import quantity_attributes
from vibrafeed.core.plots.parts import (
    add_colour_bar,
    finish,
    say_nothing_is_finite,
    scale_of,
    set_plane,
    source_of,
)
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import Selection, check_result, select
from vibrafeed.core.plots.style import Array, Options, axis_label, number

COMPONENTS = ("velocity_x", "velocity_y")
POSITIONS = ("position_x", "position_y")
MOST = 25
"""Arrows along an axis."""


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset has the velocity of a plate over its places, and no output is asked for."""
    return options.variable is None and set(POSITIONS) <= set(dataset.dims)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the field of arrows of the mean velocity.

    Over the places of a plate it says whether parts are centred or spread: the mean divergence.

    Raises
    ------
    PlotError
        If the dataset lacks a component of the velocity, or a second axis.
    """
    check_result(dataset)
    missing = [name for name in COMPONENTS if name not in dataset]
    if missing:
        raise PlotError(
            "dataset",
            f"a field of arrows needs {' and '.join(COMPONENTS)}; {missing[0]} is missing",
            "Ask for both in the outputs of the study",
        )
    x, y = xarray.broadcast(*(dataset[name] for name in COMPONENTS))
    attributes = quantity_attributes("travel_speed")
    fields = dataset.assign(
        velocity_x=x.assign_attrs(dataset[COMPONENTS[0]].attrs),
        velocity_y=y.assign_attrs(dataset[COMPONENTS[1]].attrs),
        travel_speed=x.copy(data=np.hypot(x.values, y.values)).assign_attrs(attributes),
    )
    axes = options.axes
    if axes is None and set(POSITIONS) <= set(x.dims):
        axes = POSITIONS
    speed, *components = (
        select(fields, name, axes, options.at, "field", options.units, nearest=options.nearest)
        for name in ("travel_speed", *COMPONENTS)
    )
    style = options.style
    figure = style.sheet()
    panel = figure.add_subplot()
    across, up, values, _ = set_plane(panel, speed, MOST)
    scale = scale_of(values, style)
    if scale is None:
        say_nothing_is_finite(panel, speed, style)
    else:
        arrows = panel.quiver(
            across.values, up.values,
            *(set_plane(panel, component, MOST)[2] for component in components), values,
            cmap=scale.colours, norm=scale.norm, pivot="mid", zorder=3,
        )  # fmt: skip
        add_colour_bar(panel, arrows, scale, axis_label(speed.variable, speed.unit), style)
        panel.margins(0.08)
    facts = list(speed.fixed)
    if {axis.name for axis in speed.axes} == set(POSITIONS):
        panel.set_aspect("equal")
        mean = float(np.nanmean(divergence(components)))
        verb = "spreads" if mean > 0 else "centres"
        facts = [f"{verb} parts: divergence {number(mean, 2)} 1/s", *facts]
    return finish(
        figure, panel, style, name=options.title or "Velocity over the plate",
        facts=facts, source=source_of(dataset), entries=[],
    )  # fmt: skip


def divergence(components: list[Selection]) -> Array:
    """Return dv_x/dX + dv_y/dY of a field over the places of a plate [s-1]."""
    total = np.zeros(())
    for position, component in zip(POSITIONS, components, strict=True):
        axis = component.variable.get_axis_num(position)
        total = total + np.gradient(
            component.variable.values, component.variable[position].values, axis=axis
        )
    return np.asarray(total)
