"""What pictures take of matplotlib without a public name is there, and does what it is for."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from vibrafeed.core.plots.matplotlib_parts import colour_grid, heading_of


def test_the_heading_is_what_suptitle_wrote():
    figure = Figure()
    assert heading_of(figure) is None
    written = figure.suptitle("Speed of a bowl")
    assert heading_of(figure) is written
    assert figure.get_suptitle() == "Speed of a bowl"


def drawn(colour):
    figure = Figure(figsize=(3, 3))
    axes = figure.add_subplot(projection="3d")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        colour_grid(axis, colour)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].reshape(-1, 3)


def test_the_grid_in_space_has_the_colour_that_it_is_given():
    for colour in ("#ff00ff", "#00ff00"):
        pixels = {tuple(pixel) for pixel in drawn(colour)}
        assert tuple(round(255 * part) for part in to_rgb(colour)) in pixels
