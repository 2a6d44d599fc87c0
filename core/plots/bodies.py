"""Two bodies that hit each other, as they lie and move: a sketch beside what is drawn of them."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.patches import FancyArrowPatch, Polygon

from vibrafeed.core.plots.parts import finish, source_of
from vibrafeed.core.plots.pictures import PlotError, is_pair
from vibrafeed.core.plots.selection import check_result, fixed_positions, held_fixed
from vibrafeed.core.plots.style import Array, Options, Style, mix, number

BODIES = (1, 2)
MARGIN = 0.12  # of the width of the bodies, left free around them
AXES = "xyz"
MILLI = 1000.0  # millimetres in a metre


class Outline(NamedTuple):
    """The corners of a body, or points of its rims, and its centre and velocity, by axes."""

    points: Array
    centre: Array
    velocity: Array


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if nothing else is asked for of an impact."""
    return not options.asks


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of two bodies as they lie and move before their impact, from each side.

    Ranged parameters are held at `options.at`, by default at their middle values.
    """
    check_result(dataset)
    if not is_pair(dataset):
        raise PlotError("dataset", "the result is not an impact of two bodies", "Draw another kind")
    style, units = options.style, options.units
    dimensions = [str(name) for name in dataset.dims]
    positions = fixed_positions(dataset, options.at, dimensions, (), nearest=options.nearest)
    figure = style.sheet(height=4.4)
    panels, bodies = draw_views(figure, dataset, positions, style)
    finish(
        figure, panels[0], style, name=options.title or "Two bodies before their impact",
        facts=held_fixed(dataset, units, positions), source=source_of(dataset),
    )  # fmt: skip
    speeds = " and ".join(
        f"{number(float(np.linalg.norm(body.velocity)), 3)}\N{NO-BREAK SPACE}m/s" for body in bodies
    )
    note = f"Arrows: velocities of bodies 1 and 2 before the impact, {speeds}"
    figure.supxlabel(note, fontsize=style.text(8.5), color=style.quiet, x=0.02, ha="left")
    return figure


def draw_views(
    sheet: FigureBase,
    dataset: xarray.Dataset,
    positions: Mapping[str, int],
    style: Style,
    *,
    below: bool = False,
) -> tuple[list[Axes], list[Outline]]:
    """Draw two bodies as they lie, from each side, views beside or below each other.

    Bodies in space are seen from the side and from above, bodies in a plane from above only.
    """
    views = ((0, 2), (0, 1)) if "position_z_1" in dataset.coords else ((0, 1),)
    shape = (len(views), 1) if below else (1, len(views))
    bodies = _read_bodies(dataset, positions)
    panels: list[Axes] = np.ravel(sheet.subplots(*shape, squeeze=False)).tolist()
    for panel, view in zip(panels, views, strict=True):
        _draw_bodies(panel, bodies, view, style)
    return panels, bodies


def _read_bodies(dataset: xarray.Dataset, positions: Mapping[str, int]) -> list[Outline]:
    """Return both bodies of an impact, to be drawn: corners and centres in mm, velocities in m/s.

    Each is a rectangle or a cylinder in space, with points of shape (n, 3). `positions` has the
    index at which each ranged parameter is taken; the middle is the default.
    """

    def value(name: str, body: int) -> float:
        array = dataset.coords.get(f"{name}_{body}")
        if array is None:
            return 0.0
        position = {dim: positions.get(str(dim), array.size // 2) for dim in array.dims}
        return float(array.isel(position))

    def vector(name: str, body: int) -> Array:
        return np.array([value(f"{name}_{axis}", body) for axis in AXES])

    bodies = []
    for body in BODIES:
        length = value("length", body)
        if f"width_{body}" in dataset.coords:
            angle = np.radians(value("angle", body))
            along = np.array([np.cos(angle), np.sin(angle), 0.0]) * length / 2
            across = np.array([-np.sin(angle), np.cos(angle), 0.0]) * value("width", body) / 2
            points = np.array([along + across, across - along, -along - across, along - across])
        else:
            angles = (np.radians(value(name, body)) for name in ("azimuth", "elevation"))
            points = _cylinder(length, value("diameter", body), *angles)
        centre = vector("position", body)
        bodies.append(Outline(MILLI * (centre + points), MILLI * centre, vector("velocity", body)))
    return bodies


def _cylinder(length: float, diameter: float, azimuth: float, elevation: float) -> Array:
    level = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    flat = np.cos(elevation)
    axis = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
    turns = np.linspace(0, 2 * np.pi, 48, endpoint=False)[:, None]
    rim = (np.cos(turns) * level + np.sin(turns) * np.cross(axis, level)) * diameter / 2
    return np.concatenate([rim + axis * length / 2, rim - axis * length / 2])


def _draw_bodies(
    axes: Axes, bodies: Sequence[Outline], view: tuple[int, int], style: Style
) -> None:
    # The fastest body has the longest arrow; `view` are the axes across and up.
    from scipy.spatial import ConvexHull  # takes a tenth of a second

    outlines = [body.points[:, view] for body in bodies]
    corners = np.concatenate(outlines)
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float((high - low).max())
    fastest = max(float(np.linalg.norm(body.velocity)) for body in bodies)
    for label, points, body, colour in zip(BODIES, outlines, bodies, style.series, strict=False):
        hull = points[ConvexHull(points).vertices]
        fill = mix(colour, style.ground, 0.75)
        axes.add_patch(Polygon(hull, closed=True, facecolor=fill, edgecolor=colour, linewidth=1.2))
        centre = body.centre[list(view)]
        axes.annotate(
            str(label), tuple(centre), ha="center", va="center", color=style.ink,
            fontsize=style.text(9), zorder=5,
        )  # fmt: skip
        velocity = body.velocity[list(view)]
        if fastest and np.linalg.norm(velocity) > 0:
            # The arrow of the faster one: so long, of the width of the bodies.
            tip = centre + 0.45 * size * velocity / fastest
            low, high = np.minimum(low, tip), np.maximum(high, tip)
            axes.add_patch(
                FancyArrowPatch(
                    tuple(centre), tuple(tip), arrowstyle="-|>", mutation_scale=11,
                    color=style.accent, linewidth=style.width(1.4), zorder=4,
                )
            )  # fmt: skip
    margin = MARGIN * size
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
    axes.set_aspect("equal", adjustable="box")
    axes.set(xlabel=f"{AXES[view[0]]} (mm)", ylabel=f"{AXES[view[1]]} (mm)")
