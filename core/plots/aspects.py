"""A part from a file as it lies: a drawing of each aspect, with its shares, height and lane."""

import json
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vibrafeed.core.plots.parts import finish
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.style import Array, Options, Style, mix, number
from vibrafeed.core.study.shown import Shown

COLUMNS = 3
PIECES = 4_000  # triangles that a drawing has at most, after they are halved to be sorted by depth
SHARP = np.cos(np.radians(25))  # of the angle between triangles from which on their edge is drawn
LIFT = 0.015  # of the depth: edges are drawn so much nearer, or triangles beside them cover them
FROM_LEFT, FROM_ABOVE = np.radians(35), np.radians(25)  # the view, off the side of the lane


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if nothing else is asked for of the aspects of a part."""
    return not options.asks and set(dataset.dims) == {"aspect"}


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return a drawing of each aspect of the part from a file that a result is of."""
    part = json.loads(dataset.attrs.get("study", "{}")).get("part")
    if part is None:
        raise PlotError(
            "dataset", "the result is not that of a part from a file", "Draw another kind"
        )
    style, aspects = options.style, part["aspects"]
    columns = min(COLUMNS, len(aspects))
    rows = -(-len(aspects) // columns)
    figure = style.sheet(2.9 * columns + 0.6, 2.9 * rows + 0.9)
    panels = np.ravel(figure.subplots(rows, columns, squeeze=False))
    pieces, edges = _divide(np.array(part["corners"]), np.array(part["triangles"]))
    unit = options.units.of("m", float(np.ptp(pieces, axis=(0, 1)).max()))
    for order, (panel, aspect) in enumerate(zip(panels, aspects, strict=False), 1):
        _draw_aspect(panel, pieces, edges, aspect, style)
        _label(panel, order, aspect, unit, style)
    reach = max(float(np.abs(panel.dataLim.get_points()).max()) for panel in panels[: len(aspects)])
    for panel in panels:
        panel.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
        panel.axis("off")
    name = "the part" if part["name"] == "data" else part["name"]
    finish(figure, panels[0], style, name=options.title or f"How {name} comes to rest")
    note = "Shares of parts that are let down, and thrown; the true share is between them"
    figure.supxlabel(note, fontsize=style.text(8.5), color=style.quiet, x=0.02, ha="left")
    return figure


def _divide(corners: Array, triangles: NDArray[np.int64]) -> tuple[Array, NDArray[np.bool_]]:
    """Return small triangles of a surface, (n, 3, 3), and True at sides, (n, 3), that are edges."""
    pieces = corners[triangles]
    normals = np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    # A side from corner a to b is, from b to a, one of the neighbour: it is an edge if both turn
    # from one another by enough.
    owners = {side: k for k, each in enumerate(triangles.tolist()) for side in _sides(each)}
    edges = np.array([
        [normals[k] @ normals[owners.get((b, a), k)] < SHARP for a, b in _sides(each)]
        for k, each in enumerate(triangles.tolist())
    ])  # fmt: skip
    while 4 * len(pieces) <= PIECES:
        # Four triangles of each, by the middles p, q, r of its sides; inner sides are no edges.
        a, b, c = np.moveaxis(pieces, 1, 0)
        p, q, r = (a + b) / 2, (b + c) / 2, (c + a) / 2
        ab, bc, ca = edges.T
        no = np.zeros_like(ab)
        corners_of_four = ((a, p, r), (p, b, q), (r, q, c), (p, q, r))
        edges_of_four = ((ab, no, ca), (ab, bc, no), (no, bc, ca), (no, no, no))
        pieces = np.concatenate([np.stack(each, axis=1) for each in corners_of_four])
        edges = np.concatenate([np.stack(each, axis=1) for each in edges_of_four])
    return pieces, edges


def _sides(triangle: list[int]) -> Iterator[tuple[int, int]]:
    return pairwise((*triangle, triangle[0]))


def _draw_aspect(
    panel: Axes, pieces: Array, edges: NDArray[np.bool_], aspect: dict[str, Any], style: Style
) -> None:
    """Draw a part as it lies, seen from the left of the lane and from above."""
    up, along = -np.array(aspect["down"]), np.array(aspect["along"])
    across = np.cross(up, along)
    # The lane leads from the viewer's left to the right.
    right = along * np.cos(FROM_LEFT) + across * np.sin(FROM_LEFT)
    away = across * np.cos(FROM_LEFT) - along * np.sin(FROM_LEFT)
    towards = up * np.sin(FROM_ABOVE) - away * np.cos(FROM_ABOVE)
    upward = up * np.cos(FROM_ABOVE) + away * np.sin(FROM_ABOVE)
    normals = np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])
    facing = normals @ towards > 0
    pieces, edges, normals = pieces[facing], edges[facing], normals[facing]
    light = normals @ (up + 0.6 * towards - 0.3 * right)
    light /= np.maximum(1.7 * np.linalg.norm(normals, axis=1), 1e-300)
    projected = np.stack([pieces @ right, pieces @ upward], axis=-1)
    depths = pieces @ towards
    owners, sides = np.nonzero(edges)
    # What is nearer is drawn later, and the edges of a triangle after those that lie beside it.
    shapes = [
        *projected,
        *(
            projected[index][[side, (side + 1) % 3]]
            for index, side in zip(owners, sides, strict=True)
        ),
    ]
    nearer = depths[owners].max(1) + LIFT * np.ptp(depths)
    order = np.argsort(np.concatenate([depths.mean(1), nearer]), kind="stable")
    colours = [
        mix(style.ground, style.curve, 0.65 - 0.45 * float(brightness))
        for brightness in np.clip(light, 0, 1)
    ]
    faces = [*colours, *["none"] * len(owners)]
    lines = [*colours, *[style.ink] * len(owners)]
    panel.add_collection(
        PolyCollection(
            [shapes[index] for index in order],
            facecolors=[faces[index] for index in order],
            edgecolors=[lines[index] for index in order],
            linewidths=style.width(0.8),
        )
    )
    panel.update_datalim(projected.reshape(-1, 2))


def _label(panel: Axes, order: int, aspect: dict[str, Any], unit: Shown, style: Style) -> None:
    """Write number, shares, height and lane of an aspect below its drawing."""
    shares = sorted(100 * aspect[f"{key}_share"] for key in ("let_down", "thrown"))
    low, high = (f"{key:.0f}" for key in shares)
    bracket = low if low == high else f"{low} to {high}"
    height, lane = (number(aspect[key] * unit.factor, 3) for key in ("height", "width"))
    panel.text(
        0.5, 0.0,
        f"{order}: {bracket} %\n{height} {unit.unit} high, lane {lane} {unit.unit}",
        transform=panel.transAxes, ha="center", va="top", fontsize=style.text(9.5),
        color=style.ink, linespacing=1.4,
    )  # fmt: skip
