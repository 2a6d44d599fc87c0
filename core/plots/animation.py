"""The motion of one part as an animation: seen from the side, on its moving track."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from vibrafeed.core.plots.film import Film
from vibrafeed.core.plots.heading import finish
from vibrafeed.core.plots.style import RGB, Style, mix
from vibrafeed.core.plots.text import number, with_unit
from vibrafeed.core.quantities.pictures import FILLS

SIZE = (6.4, 4.0)  # inches
MARGIN = 0.06  # of the view's width, left and right
DEPTH = 0.18  # of the view's height that shows the track below its lowest position
SEEN = 0.74  # of the view's height that all motion takes at most
MARKS = 12  # marks of the track on the width of the view, or a few more
PALE = 0.25  # share of the ground colour in the colour of a mode
DOT = " \N{MIDDLE DOT} "
NICE = (1.0, 2.0, 5.0)

COLOURS = {
    "stick": FILLS["stick"],
    "forward": FILLS["slip"],
    "backward": FILLS["hop_after_hop"],
    "corner": FILLS["hop_after_hop"],
    "side": FILLS["stick"],
    "unknown": "#dddddd",
}
"""What the part does. In flight it has the colour of the ground; words say it too."""

Frame = NDArray[np.uint8]


def draw_frames(film: Film, style: Style, dots: int, title: str | None = None) -> Iterator[Frame]:
    """Yield the frames of an animation of one part, drawn one after another.

    Parameters
    ----------
    film : Film
        Positions of track and part in each frame.
    style : Style
        Colours and sizes.
    dots : int
        Resolution [dots per inch].
    title : str, optional
        Title of the picture; by default one that says how slow it is.

    Yields
    ------
    ndarray of uint8, shape (rows, columns, 3)
        Red, green and blue.
    """
    figure = style.sheet(*SIZE)
    figure.set_dpi(dots)
    view, strip = figure.subplots(2, 1, height_ratios=(1.0, 0.07))
    view.set(xticks=[], yticks=[])
    clock = _add_strip(strip, film, style)
    slower = f", {number(film.slow)} times slower" if film.slow != 1 else ""
    notes = DOT.join(film.notes)
    finish(
        figure, view, style, name=title or f"Motion of the part{slower}", facts=film.facts,
        source=notes[:1].upper() + notes[1:],
    )  # fmt: skip
    figure.set_layout_engine("none")
    left, right, bottom = _frame_view(view, film, style)
    moving = _Moving(view, film, style, left, right, bottom)
    mode = strip.text(
        0.0, 1.35, "", transform=strip.transAxes, fontsize=style.text(9), color=style.ink,
        animated=True,
    )  # fmt: skip

    def put(i: int) -> None:
        """Move all artists to their positions in the frame of number i, from 0."""
        time = 1000 * film.times[i]
        moving.put(i)
        clock.set_xdata([time, time])
        mode.set_text(f"{with_unit(f'{time:.1f}', 'ms')}: {film.says[film.modes[i]]}")

    artists = [(view, one) for one in moving.artists] + [(strip, one) for one in (clock, mode)]
    yield from frames_of(figure, film.times.size, put, artists)


def frames_of(
    figure: Figure, count: int, put: Callable[[int], None], artists: Sequence[tuple[Axes, Artist]]
) -> Iterator[Frame]:
    """Yield frames of a figure as arrays of red, green and blue, shape (rows, columns, 3).

    What stands still is drawn once.

    Parameters
    ----------
    figure : Figure
        The figure.
    count : int
        Number of frames.
    put : callable
        Moves the artists to their positions in the frame of a number, from 0.
    artists : sequence of (Axes, Artist)
        The moving artists, drawn in each frame.
    """
    canvas: Any = figure.canvas
    canvas.draw()
    empty = canvas.copy_from_bbox(figure.bbox)
    for i in range(count):
        canvas.restore_region(empty)
        put(i)
        for axes, artist in artists:
            axes.draw_artist(artist)
        frame = np.asarray(canvas.buffer_rgba())[..., :3]
        yield frame.copy()


class _Moving:
    """The moving artists: the track with its marks, the part, and the path of its middle."""

    def __init__(
        self, axes: Axes, film: Film, style: Style, left: float, right: float, bottom: float
    ):
        self._film, self._style = film, style
        spacing = _nice_below((right - left) / MARKS)
        reach = float(np.abs(film.track[0]).max()) + spacing
        self._marks = np.arange(
            np.floor((left - reach) / spacing), np.ceil((right + reach) / spacing) + 1
        )
        self._marks *= spacing
        self._mark_length = 0.018 * (right - left)
        self._ends, self._bottom = (left - reach, right + reach), bottom
        self._ground = Polygon(np.zeros((4, 2)), linewidth=1.4)
        self._ground.set(facecolor=mix(style.other, style.ground, 0.5), edgecolor=style.other)
        self._ticks = Line2D([], [], color=style.other, linewidth=1.0)
        self._way = Line2D([], [], color=style.curve, linewidth=1.0, alpha=0.55)
        self._part = Polygon(np.zeros((4, 2)), linewidth=1.8, joinstyle="round")
        self._part.set_edgecolor(style.curve)
        self.artists: tuple[Artist, ...] = (self._ground, self._ticks, self._way, self._part)
        for artist in self.artists:
            artist.set_animated(True)
            axes.add_artist(artist)

    def put(self, i: int) -> None:
        """Move ground, marks, path and part of an animation to their positions in frame `i`.

        The ground and its marks move with the track; the path shows where the part has been, and
        its colour tells what it does, such as sticking or sliding.
        """
        film = self._film
        along, up = film.track[:, i]
        left, right = self._ends
        low = self._bottom - 1.0
        self._ground.set_xy([(left, up), (right, up), (right, low), (left, low)])
        marks = self._marks + along
        x = np.stack([marks, marks, np.full_like(marks, np.nan)], axis=1).ravel()
        y = np.tile([up, up - self._mark_length, np.nan], marks.size)
        self._ticks.set_data(x, y)
        self._way.set_data(film.part[0, : i + 1], film.part[1, : i + 1])
        self._part.set_xy(_turned(film.outline, film.pitch[i]).T + film.part[:, i])
        self._part.set_facecolor(_colour(film.modes[i], self._style))


def _frame_view(axes: Axes, film: Film, style: Style) -> tuple[float, float, float]:
    """Set the limits of an animation's view, to scale, and add a scale bar; return these limits.

    They are left, right and bottom, in the unit of lengths of `film`, and leave room for all
    positions of track and part.
    """
    if film.pitch.any():
        reach = above = float(np.hypot(*film.outline).max())
    else:
        reach, above = (float(side.max()) for side in film.outline)
    ends = [
        [film.part[0].min() - reach, film.part[0].max() + reach],
        [film.track[1].min(), film.part[1].max() + above],
    ]
    (left, right), (bottom, top) = np.array(ends)
    for spine in axes.spines.values():
        spine.set_visible(False)
    box = axes.get_window_extent()
    scale = max((right - left) / (1 - 2 * MARGIN) / box.width, (top - bottom) / SEEN / box.height)
    middle, width, height = (left + right) / 2, scale * box.width, scale * box.height
    left, right = middle - width / 2, middle + width / 2
    bottom -= DEPTH * height
    top = bottom + height
    axes.set(xlim=(left, right), ylim=(bottom, top))
    bar = _nice_below(width / 6)
    x, y = right - 0.03 * width - bar, top - 0.06 * height
    axes.plot([x, x + bar], [y, y], color=style.ink, linewidth=2.0, solid_capstyle="butt")
    axes.annotate(
        with_unit(number(bar), film.unit), (x + bar / 2, y), (0, -3), ha="center", va="top",
        textcoords="offset points", fontsize=style.text(8), color=style.ink,
    )  # fmt: skip
    return left, right, bottom


def _add_strip(axes: Axes, film: Film, style: Style) -> Line2D:
    """Draw a strip over time of what the part does, below an animation; return its clock.

    Each spell of the motion, such as sliding, has a colour; `film` has their starts and ends [s],
    the axis is in ms. The clock is the vertical line that is moved to the time of each frame.
    """
    for mode, start, stop in film.spells:
        axes.axvspan(1000 * start, 1000 * stop, facecolor=_colour(mode, style), linewidth=0)
    first, last = 1000 * film.spells[0][1], 1000 * film.spells[-1][2]
    axes.set(xlim=(first, last), yticks=[])
    axes.set_xlabel("Time (ms)")
    axes.set_title(" ", fontsize=style.text(10))  # room for what is written in each frame
    (clock,) = axes.plot([first] * 2, [0, 1], color=style.ink, linewidth=2.0, animated=True)
    return clock


def _colour(mode: str, style: Style) -> RGB | str:
    """Return the colour of a mode of the part, paler than in the legend.

    Flight has the ground's.
    """
    return mix(COLOURS[mode], style.ground, PALE) if mode in COLOURS else style.ground


def _turned(outline: NDArray[np.float64], pitch: float) -> NDArray[np.float64]:
    """Return an outline, shape (2, k), rotated clockwise by an angle [rad]."""
    c, s = np.cos(pitch), np.sin(pitch)
    return np.array([[c, s], [-s, c]]) @ outline


def _nice_below(value: float) -> float:
    """Return the largest number of the form 1, 2 or 5 times a power of ten below a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step * power for step in NICE if step * power <= value * (1 + 1e-9)))
