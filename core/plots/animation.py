"""Motions as GIF files: of one part seen from the side, of a row of parts seen from above."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Never

import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from matplotlib.text import Text
from numpy.typing import NDArray
from PIL import Image

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.plots.film import (
    FIRST,
    FRAMES_PER_SECOND,
    PALE,
    PERIOD_SHOWN,
    TURN,
    Film,
    amplitude_of,
    frames_in,
    nice_number,
    read_film,
    read_row,
)
from vibrafeed.core.plots.parts import DOT, finish
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import held_fixed, units_of
from vibrafeed.core.plots.style import RGB, Options, Style, mix, number, with_unit
from vibrafeed.core.quantities.pictures import FILLS
from vibrafeed.core.study.shown import ShownUnits

DOTS = 100  # dots per inch
SAMPLED = 8  # frames from which the colours are taken
SIZE = (6.4, 4.0)  # inches
MARGIN = 0.06  # of the view's width, left and right
DEPTH = 0.18  # of the view's height that shows the track below its lowest position
SEEN = 0.74  # of the view's height that all motion takes at most
MARKS = 12  # marks of the track on the width of the view, or a few more
ROW_MARKS = 24
WIDTH = 0.5  # of the lane, that the parts of a row take
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


def draw(dataset: xarray.Dataset, options: Options) -> Never:
    """Raise `PlotError`, since animations are files written by `animate`, not figures."""
    raise PlotError(
        "kind",
        "an animation can only be written to a file, not returned as a figure",
        "Call vibrafeed.animate, or end the name in .gif",
    )


def animate(
    dataset: xarray.Dataset,
    target: Path,
    *,
    slow: float | None = None,
    title: str | None = None,
    units: Sequence[str] | str | None = None,
    dark: bool = False,
    small: bool = False,
) -> None:
    """Save the motion of a part or of a row of parts as a GIF file: see `vibrafeed.animate`.

    Raises
    ------
    PlotError
        If the dataset holds no trajectory, or the file cannot be made.
    OSError
        If the file cannot be written; no part of it is left behind.
    """
    if target.suffix.lower() != ".gif":
        raise PlotError(
            "output",
            f"'{target.suffix}': unknown animation format",
            "End the name of the animation in .gif",
        )
    style, shown = Style(dark=dark, small=small), units_of(dataset, units)
    if FIRST in dataset:
        frames = draw_lane(dataset, shown, style, DOTS, slow=slow, title=title)
    else:
        frames = draw_frames(read_film(dataset, shown, slow), style, DOTS, title)
    with whole(target) as temporary:
        _write_gif(frames, temporary)


def _write_gif(frames: Iterable[Frame], target: Path) -> None:
    # One palette for all frames, so that nothing flickers.
    pictures = [Image.fromarray(frame) for frame in frames]
    sampled = pictures[:: max(1, len(pictures) // SAMPLED)]
    sheet = Image.fromarray(np.concatenate([np.asarray(picture) for picture in sampled]))
    palette = sheet.quantize(32, dither=Image.Dither.NONE)
    first, *others = (
        picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures
    )
    first.save(
        target, format="GIF", save_all=True, append_images=others, loop=0, optimize=False,
        duration=1000 // FRAMES_PER_SECOND,
    )  # fmt: skip


def draw_frames(film: Film, style: Style, dots: int, title: str | None = None) -> Iterator[Frame]:
    """Yield the frames of an animation of one part, uint8 of shape (rows, columns, 3).

    `dots` is the resolution [dots per inch]; the title says by default how slow it is.
    """
    figure = style.sheet(*SIZE)
    figure.set_dpi(dots)
    view, strip = figure.subplots(2, 1, height_ratios=(1.0, 0.07))
    view.set(xticks=[], yticks=[])
    for mode, start, stop in film.intervals:
        strip.axvspan(1000 * start, 1000 * stop, facecolor=_colour(mode, style), linewidth=0)
    first, last = 1000 * film.intervals[0][1], 1000 * film.intervals[-1][2]
    strip.set(xlim=(first, last), yticks=[], xlabel="Time (ms)")
    clock, caption = _add_clock(strip, ([first] * 2, [0, 1]), 1.35, style)
    notes = DOT.join(film.notes)
    finish(
        figure, view, style, name=title or f"Motion of the part{_slower(film.slow)}",
        facts=film.facts, source=notes[:1].upper() + notes[1:],
    )  # fmt: skip
    figure.set_layout_engine("none")
    left, right, bottom = _frame_view(view, film, style)
    spacing = nice_number((right - left) / MARKS, below=True)
    margin = float(np.abs(film.track[0]).max()) + spacing
    first_mark, last_mark = (
        np.floor((left - margin) / spacing),
        np.ceil((right + margin) / spacing) + 1,
    )
    steps = np.arange(first_mark, last_mark) * spacing
    mark_length = 0.018 * (right - left)
    fill = mix(style.other, style.ground, 0.5)
    ground = Polygon(np.zeros((4, 2)), linewidth=1.4, facecolor=fill, edgecolor=style.other)
    ticks = Line2D([], [], color=style.other, linewidth=1.0)
    path = Line2D([], [], color=style.curve, linewidth=1.0, alpha=0.55)
    part = Polygon(np.zeros((4, 2)), linewidth=1.8, joinstyle="round", edgecolor=style.curve)
    moving: tuple[Artist, ...] = (ground, ticks, path, part)
    for artist in moving:
        artist.set_animated(True)
        view.add_artist(artist)

    def move_to_frame(frame: int) -> None:
        # The ground and its marks move with the track; the path shows where the part has been.
        along, up = film.track[:, frame]
        lowest = bottom - 1.0
        ends = (left - margin, right + margin)
        ground.set_xy([(ends[0], up), (ends[1], up), (ends[1], lowest), (ends[0], lowest)])
        marks = steps + along
        x = np.stack([marks, marks, np.full_like(marks, np.nan)], axis=1).ravel()
        ticks.set_data(x, np.tile([up, up - mark_length, np.nan], marks.size))
        path.set_data(film.part[0, : frame + 1], film.part[1, : frame + 1])
        cos, sin = np.cos(film.pitch[frame]), np.sin(film.pitch[frame])  # clockwise
        part.set_xy((np.array([[cos, sin], [-sin, cos]]) @ film.outline).T + film.part[:, frame])
        part.set_facecolor(_colour(film.modes[frame], style))
        time = 1000 * film.times[frame]
        clock.set_xdata([time, time])
        caption.set_text(f"{with_unit(f'{time:.1f}', 'ms')}: {film.mode_names[film.modes[frame]]}")

    artists = [(view, artist) for artist in moving] + [
        (strip, artist) for artist in (clock, caption)
    ]
    yield from _frames_of(figure, film.times.size, move_to_frame, artists)


def draw_lane(
    dataset: xarray.Dataset, units: ShownUnits, style: Style, dots: int, *,
    slow: float | None = None, title: str | None = None,
) -> Iterator[Frame]:  # fmt: skip
    """Yield the frames of an animation of a row of parts; parts that touch are filled.

    As for `draw_frames`, of a simulation of one row with `trajectory`. `PlotError` tells that the
    dataset holds no row in time, or not the length of its parts.
    """
    row = read_row(dataset, units)
    if row.length == 0.0:
        raise PlotError(
            "dataset",
            "the dataset does not give the length of the parts",
            "Set the parameter length in the study, and run the study again",
        )
    slow = slow or nice_number(PERIOD_SHOWN * float(dataset["frequency"]))
    times = 1000.0 * row.times / row.time.factor
    moments = np.linspace(times[0], times[-1], frames_in(np.ptp(times) / 1000.0 * slow))
    time_indices = np.searchsorted(times, moments, side="right") - 1
    displacement = np.zeros(moments.size)
    notes = ["seen from above, breadth not to scale"]
    amplitude = amplitude_of(dataset)
    if amplitude is not None and "beta" in dataset.coords:
        # The track moves along by A cos(beta) sin(w t), and the parts with it.
        along = amplitude * np.cos(np.deg2rad(float(dataset["beta"])))
        phase = TURN * float(dataset["frequency"]) * moments / 1000.0
        displacement = row.along.factor * along * np.sin(phase)
    else:
        notes.append("as the track sees it")
    centres = np.array([np.interp(moments, times, centre) for centre in row.centres]) + displacement

    figure = style.sheet(*SIZE)
    figure.set_dpi(dots)
    view, strip = figure.subplots(2, 1, height_ratios=(1.0, 0.5))
    left, right = centres.min() - row.length, centres.max() + row.length
    view.set(xlim=(left, right), ylim=(0.0, 1.0), yticks=[], xlabel=f"Position ({row.along.unit})")
    pale = mix(style.ground, style.curve, PALE)
    for contact, touches in enumerate(row.closed, start=1):
        strip.fill_between(times, contact - 0.4, contact + 0.4, where=touches, color=pale)
    strip.set(xlim=(times[0], times[-1]), ylim=(0.4, len(row.closed) + 0.6))
    pairs = [f"{n}\N{EN DASH}{n + 1}" for n in range(1, len(centres))]
    strip.set_yticks(range(1, len(centres)), pairs, fontsize=style.text(8))
    strip.set(xlabel="Time (ms)", ylabel="Contact of")
    clock, caption = _add_clock(strip, ([], []), 1.05, style)
    finish(
        figure, view, style, name=title or f"A row of {len(centres)} parts{_slower(slow)}",
        facts=held_fixed(dataset, units), source=DOT.join(notes).capitalize(),
    )  # fmt: skip
    figure.canvas.draw()  # lays out what stands still
    figure.set_layout_engine("none")

    # Marks of the track, also where it comes into view.
    marks = np.linspace(left - displacement.max(), right - displacement.min(), ROW_MARKS)
    (track,) = view.plot([], [], color=style.other, linewidth=1.0, animated=True)
    parts = [
        Rectangle(
            (0.0, (1.0 - WIDTH) / 2), row.length, WIDTH, linewidth=1.4, edgecolor=style.curve,
            animated=True,
        )
        for _ in centres
    ]  # fmt: skip
    for part in parts:
        view.add_patch(part)

    def move_to_frame(frame: int) -> None:
        x = np.stack(
            [marks + displacement[frame]] * 2 + [np.full(ROW_MARKS, np.nan)], axis=1
        ).ravel()
        track.set_data(x, np.tile([0.0, 1.0, np.nan], ROW_MARKS))
        closed = row.closed[:, time_indices[frame]]
        touches_neighbour = np.r_[False, closed] | np.r_[closed, False]
        for part, centre, touches in zip(parts, centres[:, frame], touches_neighbour, strict=True):
            part.set_x(centre - row.length / 2)
            part.set_facecolor(pale if touches else style.ground)
        clock.set_data([moments[frame]] * 2, [0.0, len(row.closed) + 1.0])
        time_text = with_unit(f"{moments[frame]:.1f}", "ms")
        caption.set_text(f"{time_text}: {int(closed.sum())} of {closed.size} contacts closed")

    artists = [(view, artist) for artist in (track, *parts)] + [
        (strip, artist) for artist in (clock, caption)
    ]
    yield from _frames_of(figure, moments.size, move_to_frame, artists)


def _slower(slow: float) -> str:
    return f", {number(slow)} times slower" if slow != 1 else ""


def _add_clock(strip: Axes, points: Any, height: float, style: Style) -> tuple[Line2D, Text]:
    """Add what moves in the strip below an animation: the line of the time, and words above."""
    strip.set_title(" ", fontsize=style.text(10))  # room for what is written in each frame
    (clock,) = strip.plot(*points, color=style.ink, linewidth=2.0, animated=True)
    return clock, strip.text(
        0.0, height, "", transform=strip.transAxes, fontsize=style.text(9), color=style.ink,
        animated=True,
    )  # fmt: skip


def _frames_of(
    figure: Figure,
    count: int,
    move_to_frame: Callable[[int], None],
    artists: Sequence[tuple[Axes, Artist]],
) -> Iterator[Frame]:
    # What stands still is drawn once; `move_to_frame` moves the artists to their places in a frame.
    canvas: Any = figure.canvas
    canvas.draw()
    empty = canvas.copy_from_bbox(figure.bbox)
    for frame in range(count):
        canvas.restore_region(empty)
        move_to_frame(frame)
        for axes, artist in artists:
            axes.draw_artist(artist)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _frame_view(axes: Axes, film: Film, style: Style) -> tuple[float, float, float]:
    """Set the limits of an animation's view, to scale, and add a scale bar; return these limits.

    They are left, right and bottom, and leave room for all positions of track and part.
    """
    if film.pitch.any():
        reach = above = float(np.hypot(*film.outline).max())
    else:
        reach, above = (float(side.max()) for side in film.outline)
    left, right = film.part[0].min() - reach, film.part[0].max() + reach
    bottom, top = film.track[1].min(), film.part[1].max() + above
    for spine in axes.spines.values():
        spine.set_visible(False)
    box = axes.get_window_extent()
    scale = max((right - left) / (1 - 2 * MARGIN) / box.width, (top - bottom) / SEEN / box.height)
    middle, width, height = (left + right) / 2, scale * box.width, scale * box.height
    left, right = middle - width / 2, middle + width / 2
    bottom -= DEPTH * height
    top = bottom + height
    axes.set(xlim=(left, right), ylim=(bottom, top))
    bar = nice_number(width / 6, below=True)
    x, y = right - 0.03 * width - bar, top - 0.06 * height
    axes.plot([x, x + bar], [y, y], color=style.ink, linewidth=2.0, solid_capstyle="butt")
    axes.annotate(
        with_unit(number(bar), film.unit), (x + bar / 2, y), (0, -3), ha="center", va="top",
        textcoords="offset points", fontsize=style.text(8), color=style.ink,
    )  # fmt: skip
    return left, right, bottom


def _colour(mode: str, style: Style) -> RGB | str:
    # Paler than in the legend; flight has the colour of the ground.
    return mix(COLOURS[mode], style.ground, PALE) if mode in COLOURS else style.ground
