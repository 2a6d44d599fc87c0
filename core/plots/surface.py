"""A surface over two axes; grey where the closed forms do not hold."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import FigureBase
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
    Line3DCollection,
    Poly3DCollection,
)
from numpy.typing import NDArray

from vibrafeed.core.plots.contour import draw_contour
from vibrafeed.core.plots.parts import add_colour_bar
from vibrafeed.core.plots.regimes import Look, luminance, swatch
from vibrafeed.core.plots.scale import Scale, scale_of
from vibrafeed.core.plots.selection import Selection, thin
from vibrafeed.core.plots.sliced import fits_as, renderer_of
from vibrafeed.core.plots.style import RGB, Style, mix
from vibrafeed.core.plots.text import short_label

MAX_POINTS = 91  # of an axis: every face is a shape in an SVG
GREYED = 0.8  # share of grey in the colour of a face that is not valid
TINT = 0.3  # share of the regime's colour in that grey
ELEVATION = 28.0  # degrees, from which the surface is seen
RELIEF = 2.0  # of the heights, in the light: no face is in the dark
LIGHT_FROM = (-0.6, -0.3, 1.0)
SHADE = 0.55  # brightness of a face that the light does not reach
AZIMUTHS = (-50.0, -130.0, 130.0, 50.0)  # from where the corner in front may be seen


def draw_surface(
    figure: FigureBase, selection: Selection, looks: Sequence[Look], style: Style
) -> tuple[Axes, list[Artist]]:
    """Draw an output over two axes as a surface in space; return its axes and the legend entries.

    Colours show the value, or the regimes if formulas hold in more than one that occurs.
    `selection` has the values and their axes, of which at most `MAX_POINTS` points are drawn,
    `looks` the regimes that occur. If no value is finite, a flat picture that says so is drawn
    instead.
    """
    first, second = selection.axes
    rows, columns = thin(first.values.size, MAX_POINTS), thin(second.values.size, MAX_POINTS)
    part = np.ix_(rows, columns)
    x, y = np.meshgrid(first.values[rows], second.values[columns], indexing="ij")
    z, regimes = selection.values[part], selection.regimes[part]
    scale = scale_of(z, style)
    if scale is None:
        return draw_contour(figure, selection, looks, style)  # which says so
    axes = figure.add_subplot(projection="3d")
    # Where several regimes hold, colours tell them apart: the height tells the value.
    by_regime = sum(look.valid for look in looks) > 1
    points = np.stack([x, y, z], axis=-1)
    _add_faces(axes, points, regimes, looks, scale, by_regime=by_regime)
    _add_borders(axes, points, regimes, looks, scale, style)
    axes.set_zlim(scale.levels[0], scale.levels[-1])
    if not by_regime:
        add_colour_bar(
            figure, axes, ScalarMappable(scale.norm, scale.colours), scale, selection, style,
            boundaries=np.linspace(scale.levels[0], scale.levels[-1], 257).tolist(),
            extend=scale.extend, shrink=0.7, aspect=24, pad=0.1,
        )  # fmt: skip
    axes.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()))
    axes.set_xlabel(first.label, labelpad=0 if style.small else 8)
    axes.set_ylabel(second.label, labelpad=0 if style.small else 8)
    axes.set_zlabel(
        short_label(selection.variable, selection.unit), labelpad=2 if style.small else 10
    )
    if style.small:
        axes.tick_params(pad=0)
        for spine in (axes.xaxis, axes.yaxis, axes.zaxis):
            spine.set_major_locator(MaxNLocator(4))
    axes.view_init(elev=ELEVATION, azim=_azimuth(z))
    axes.set_box_aspect((4, 4, 2.8), zoom=0.95 if by_regime else 1.05)
    axes.computed_zorder = False
    entries = []
    for look in looks:
        face = look.fill if by_regime else scale.typical(z[regimes == look.value])
        entries.append(_entry(look, face))
    return axes, entries


def _add_faces(
    axes: Axes,
    points: NDArray[np.float64],
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    scale: Scale,
    *,
    by_regime: bool,
) -> None:
    """Add a face for each cell of a surface in space, coloured by value or by regime.

    Parameters
    ----------
    points : ndarray, shape (m, n, 3)
        x, y and z of the grid.
    regimes : ndarray, shape (m, n)
        Numbers of the regimes.
    looks : sequence of Look
        The regimes that occur; those where formulas do not hold are greyed.
    scale : Scale
        Colours of values, and the heights that are shown: other faces are left out.
    by_regime : bool
        True to colour by regime, with light and shade.
    """
    corners = [points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]]
    faces = np.stack(corners, axis=-2).reshape(-1, 4, 3)
    states = regimes[:-1, :-1].ravel()
    shown = _shown(faces[:, :, 2], scale).all(axis=1)
    faces, states = faces[shown], states[shown]
    colours = np.asarray(scale.colours(scale.norm(faces[:, :, 2].mean(axis=1))))[:, :3]
    for look in looks:
        here = states == look.value
        if by_regime:
            colours[here] = look.fill
        colours[here] = _greyed(colours[here], look)
    if by_regime:
        colours = colours * _light(faces, scale)[:, np.newaxis]
    axes.add_collection3d(  # type: ignore[attr-defined]
        Poly3DCollection(
            faces, facecolors=colours, edgecolors=colours * 0.88, linewidths=0.25, zorder=1
        )
    )


def _light(faces: NDArray[np.float64], scale: Scale) -> NDArray[np.float64]:
    """Return the brightness of a surface's faces, shape (n,), 0.55 to 1, by the angle of light.

    `faces` are the four corners of each, shape (n, 4, 3), in the units of the axes; heights are
    taken over the range of `scale`, so that the light falls on the surface as it is seen.
    """
    ends = faces.reshape(-1, 3)
    across, up = np.ptp(ends[:, 0]) or 1.0, np.ptp(ends[:, 1]) or 1.0
    size = np.array([across, up, (scale.levels[-1] - scale.levels[0]) * RELIEF])
    one, other = ((faces[:, k] - faces[:, 0]) / size for k in (2, 1))
    normal = np.cross(other, one)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    light = np.array(LIGHT_FROM) / np.linalg.norm(LIGHT_FROM)
    return np.asarray(SHADE + (1 - SHADE) * np.clip(normal @ light, 0.0, 1.0))


def _add_borders(
    axes: Axes,
    points: NDArray[np.float64],
    regimes: NDArray[np.int64],
    looks: Sequence[Look],
    scale: Scale,
    style: Style,
) -> None:
    """Add borders between the regimes on a surface in space, heavier where formulas cease to hold.

    `points` are x, y, z of the grid, shape (m, n, 3); `regimes` has the numbers, shape (m, n), and
    `looks` which of them are valid. Borders outside of the heights of `scale` are left out.
    """
    valid = np.isin(regimes, [look.value for look in looks if look.valid])
    for states, width in ((regimes, 0.8), (valid, 2.0)):
        across = states[1:-1, :-1] != states[:-2, :-1]
        along = states[:-1, 1:-1] != states[:-1, :-2]
        edges = np.concatenate(
            [
                np.stack([points[1:-1, :-1], points[1:-1, 1:]], axis=-2)[across],
                np.stack([points[:-1, 1:-1], points[1:, 1:-1]], axis=-2)[along],
            ]
        )
        edges = edges[_shown(edges[:, :, 2], scale).all(axis=1)]
        if edges.size:
            axes.add_collection3d(  # type: ignore[attr-defined]
                Line3DCollection(edges, colors=style.ink, linewidths=style.width(width), zorder=2)
            )


def _shown(z: NDArray[np.float64], scale: Scale) -> NDArray[np.bool_]:
    """Return a mask of values within the scale."""
    return np.isfinite(z) & (z >= scale.levels[0]) & (z <= scale.levels[-1])


def _entry(look: Look, face: RGB) -> Artist:
    """Return the legend entry of a regime."""
    red, green, blue = _greyed(np.array([face]), look)[0].tolist()
    return swatch(look, (red, green, blue), hatched=False)


def _greyed(colours: NDArray[np.float64], look: Look) -> NDArray[np.float64]:
    """Return the colours of a surface, greyed in a regime where formulas do not hold.

    Parameters
    ----------
    colours : ndarray, shape (n, 3)
        Red, green and blue of n faces, 0 to 1; the result has the same form.
    look : Look
        The regime and its colour. Where it is valid the colours are returned as they are; else most
        of each turns to grey of its own lightness, with a tint of the regime's colour.
    """
    if look.valid:
        return colours
    grey = 0.6 + 0.36 * (luminance(colours))[:, np.newaxis]
    return (1 - GREYED) * colours + GREYED * (
        (1 - TINT) * grey + TINT * np.array(mix(look.colour, "#ffffff", 0.35))
    )


def _azimuth(z: NDArray[np.float64]) -> float:
    """Return the azimuth of the view [degrees] that puts the lowest corner of the surface in front.

    `z` are the heights, shape (m, n).
    """
    rows, columns = z.shape[0] // 2, z.shape[1] // 2
    filled = np.nan_to_num(z, nan=float(np.nanmean(z)) if np.isfinite(z).any() else 0.0)
    near = {
        -50.0: filled[rows:, :columns],
        -130.0: filled[:rows, :columns],
        130.0: filled[:rows, columns:],
        50.0: filled[rows:, columns:],
    }
    return min(AZIMUTHS, key=lambda azimuth: float(near[azimuth].mean()))


fits = fits_as("surface")
draw = renderer_of(draw_surface, "surface", beyond="Grey")
