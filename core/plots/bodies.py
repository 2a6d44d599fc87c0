"""Two bodies that hit each other, as they lie and move: a sketch beside what is drawn of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from numpy.typing import NDArray

from vibrafeed.core.plots.fixed import fixed_positions
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.pictures import PlotError, is_pair
from vibrafeed.core.plots.selection import check_result, held_at, held_fixed
from vibrafeed.core.plots.style import Options, Style, mix
from vibrafeed.core.plots.text import number

BODIES = (1, 2)
RIM = 48  # points of a rim
ARROW = 0.45  # of the width of the bodies: the arrow of the faster one
MARGIN = 0.12  # of the width of the bodies, left free around them
AXES = "xyz"
MILLI = 1000.0  # millimetres in a metre

Array = NDArray[np.float64]


class Outline(NamedTuple):
    """The corners of a body, or points of its rims, and its centre and velocity, by axes."""

    points: Array
    centre: Array
    velocity: Array


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if nothing else is asked for of an impact."""
    return (options.variable, options.axes) == (None, None)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of two bodies as they lie and move before their impact, from each side.

    Ranged parameters are held at `options.at`, by default at their middle values.

    Raises
    ------
    PlotError
        If the dataset is no impact of two bodies, or does not have a value that is asked for.
    """
    check_result(dataset)
    if not is_pair(dataset):
        raise PlotError("dataset", "it holds no impact of two bodies", "Draw another kind")
    style, units = options.style, options.units
    loose = [str(name) for name in dataset.dims]
    positions = fixed_positions(dataset, options.at, loose, (), nearest=options.nearest)
    bodies, seen = read_bodies(dataset, positions), views(dataset)
    figure = style.sheet(height=4.4)
    panels = np.ravel(figure.subplots(1, len(seen), squeeze=False))
    for panel, view in zip(panels, seen, strict=True):
        draw_bodies(panel, bodies, view, style)
    held = [held_at(dataset[name], units, position) for name, position in positions.items()]
    finish(
        figure, panels[0], style, name=options.title or "Two bodies before their impact",
        facts=[*held, *held_fixed(dataset, units)], source=source_of(dataset),
    )  # fmt: skip
    note = arrows_in_words(bodies)
    figure.supxlabel(note, fontsize=style.text(8.5), color=style.quiet, x=0.02, ha="left")
    return figure


def views(dataset: xarray.Dataset) -> tuple[tuple[int, int], ...]:
    """Return the axes (across, up) of each view, as indices into x, y, z.

    Bodies in space are seen from the side and from above, bodies in a plane from above only.
    """
    return ((0, 2), (0, 1)) if "position_z_1" in dataset.coords else ((0, 1),)


def read_bodies(dataset: xarray.Dataset, positions: Mapping[str, int]) -> tuple[Outline, ...]:
    """Return both bodies of an impact, to be drawn: corners and centres in mm, velocities in m/s.

    Each is a rectangle or a cylinder in space, with points of shape (n, 3). `positions` has the
    index at which each ranged parameter is taken; the middle is the default.
    """

    def value(name: str, body: int) -> float:
        """Return a parameter of a body, in the unit of the dataset; 0 if it is not set."""
        array = dataset.coords.get(f"{name}_{body}")
        if array is None:
            return 0.0
        if not array.dims:
            return float(array)
        own = str(array.name)
        return float(array.values[positions.get(own, array.size // 2)])

    def vector(name: str, body: int) -> Array:
        """Return a vector of a body from its components."""
        return np.array([value(f"{name}_{axis}", body) for axis in AXES])

    bodies = []
    for body in BODIES:
        length = value("length", body)
        if f"width_{body}" in dataset.coords:
            points = _rectangle(length, value("width", body), np.radians(value("angle", body)))
        else:
            angles = (np.radians(value(name, body)) for name in ("azimuth", "elevation"))
            points = _cylinder(length, value("diameter", body), *angles)
        centre = vector("position", body)
        bodies.append(Outline(MILLI * (centre + points), MILLI * centre, vector("velocity", body)))
    return tuple(bodies)


def _rectangle(length: float, width: float, angle: float) -> Array:
    """Return the corners of a rectangle about its centre, shape (4, 3), in a level plane.

    `angle` [rad] turns its length from x towards y; lengths are in any unit.
    """
    along = np.array([np.cos(angle), np.sin(angle), 0.0]) * length / 2
    across = np.array([-np.sin(angle), np.cos(angle), 0.0]) * width / 2
    return np.array([along + across, across - along, -along - across, along - across])


def _cylinder(length: float, diameter: float, azimuth: float, elevation: float) -> Array:
    """Return points on both rims of a cylinder about its centre, shape (96, 3).

    The axis has an azimuth from x towards y and an elevation above the level plane [rad]. `length`
    and `diameter` are in the unit of the result.
    """
    axis = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    level = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    turns = np.linspace(0, 2 * np.pi, RIM, endpoint=False)[:, None]
    rim = (np.cos(turns) * level + np.sin(turns) * np.cross(axis, level)) * diameter / 2
    return np.concatenate([rim + axis * length / 2, rim - axis * length / 2])


def convex_hull(points: Array) -> Array:
    """Return the corners of the convex hull of points in a plane, counterclockwise.

    Andrew's monotone chain; scipy's takes a tenth of a second to import.

    Parameters
    ----------
    points : array (n, 2)
        Any length unit.

    Returns
    -------
    array (m, 2)
        The first is the leftmost, of those the lowest; no three lie on a line.
    """

    def chain(ordered: Array) -> list[Array]:
        """Return the lower or upper half of the hull, from points sorted upwards or downwards."""
        kept: list[Array] = []
        for point in ordered:
            while len(kept) > 1 and _turn(kept[-2], kept[-1], point) <= 0:
                kept.pop()
            kept.append(point)
        return kept[:-1]

    ordered = np.unique(points, axis=0)
    if len(ordered) < 2:
        return ordered
    return np.array(chain(ordered) + chain(ordered[::-1]))


def _turn(start: Array, corner: Array, end: Array) -> float:
    """Return twice the area of the triangle of three points, above 0 for a turn to the left."""
    (a, b), (c, d) = corner - start, end - start
    return float(a * d - b * c)


def draw_bodies(
    axes: Axes, bodies: tuple[Outline, ...], view: tuple[int, int], style: Style
) -> None:
    """Draw both bodies of an impact in one view: outlines, numbers, arrows for velocities.

    `bodies` have points [mm], centres [mm] and velocities in space; `view` has the indices of the
    axes that are drawn across and up. The fastest body has the longest arrow.
    """
    seen = [body.points[:, view] for body in bodies]
    every = np.concatenate(seen)
    low, high = every.min(axis=0), every.max(axis=0)
    size = float((high - low).max())
    fastest = max(float(np.linalg.norm(body.velocity)) for body in bodies)
    for number_, points, body, colour in zip(BODIES, seen, bodies, style.series, strict=False):
        hull = convex_hull(points)
        face = mix(colour, style.ground, 0.75)
        axes.add_patch(Polygon(hull, closed=True, facecolor=face, edgecolor=colour, linewidth=1.2))
        centre = body.centre[list(view)]
        axes.annotate(
            str(number_), tuple(centre), ha="center", va="center", color=style.ink,
            fontsize=style.text(9), zorder=5,
        )  # fmt: skip
        speed = body.velocity[list(view)]
        if fastest and np.linalg.norm(speed) > 0:
            tip = centre + ARROW * size * speed / fastest
            low, high = np.minimum(low, tip), np.maximum(high, tip)
            axes.add_patch(
                FancyArrowPatch(
                    tuple(centre), tuple(tip), arrowstyle="-|>", mutation_scale=11,
                    color=style.accent, linewidth=style.width(1.4), zorder=4,
                )
            )  # fmt: skip
    room = MARGIN * size
    axes.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel(f"{AXES[view[0]]} (mm)")
    axes.set_ylabel(f"{AXES[view[1]]} (mm)")


def arrows_in_words(bodies: tuple[Outline, ...]) -> str:
    """Return the explanation of the arrows in a sketch."""
    speeds = [float(np.linalg.norm(body.velocity)) for body in bodies]
    told = " and ".join(f"{number(speed, 3)}\N{NO-BREAK SPACE}m/s" for speed in speeds)
    return f"Arrows: velocities of bodies 1 and 2 before the impact, {told}"
