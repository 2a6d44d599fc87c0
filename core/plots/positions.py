"""A row of parts: positions over time, and the same moving, as it is seen from above."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from vibrafeed.core.kinds.results import tabulate
from vibrafeed.core.motion.row_scene import ROW
from vibrafeed.core.plots.animation import DOT, Frame, frames_of
from vibrafeed.core.plots.film import PERIOD_SHOWN, TURN, amplitude_of, frames_in, nice
from vibrafeed.core.plots.heading import finish, source_of
from vibrafeed.core.plots.motion import followed
from vibrafeed.core.plots.parts import padded
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import check_result, held_fixed
from vibrafeed.core.plots.style import Options, Style, mix
from vibrafeed.core.plots.text import number, scaled, shown_in, with_unit
from vibrafeed.core.plots.trajectory import TIME
from vibrafeed.core.study.shown import Shown, ShownUnits

FIRST = "part_position_1"
TOUCHES = 1e-9
"""Of the way that is shown: gaps that are no larger are those of parts that touch."""
PALE = 0.25
SIZE = (6.4, 4.0)  # inches
MARKS = 24
"""On the width of the view, by which the track is seen to move."""
WIDTH = 0.5
"""Of the lane, that the parts take."""


class RowPositions(NamedTuple):
    """The parts of a row over time, from the rear on, in the units in which they are drawn.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Times, in `time`.
    places : ndarray, shape (parts, n)
        Centres of the parts on the track, in `along`.
    length : float
        Length of a part, in `along`; 0 if the study does not have it.
    closed : ndarray of bool, shape (parts - 1, n)
        Where a part touches the one in front of it.
    time, place : Shown
        The units.
    """

    times: NDArray[np.float64]
    centres: NDArray[np.float64]
    length: float
    closed: NDArray[np.bool_]
    time: Shown
    along: Shown


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """True if a dataset is drawn as positions of a row of parts by default: it is one such row.

    `options` are those of the picture; an output or axes that are asked for ask for another
    picture.
    """
    asked = (options.variable, options.axes) != (None, None)
    if asked or dataset.attrs.get("scene") != ROW:
        return False
    return FIRST in dataset or followed(dataset) is not None


def read_row(dataset: xarray.Dataset, units: ShownUnits) -> RowPositions:
    """Return the positions of a row of parts over time, in the units that are drawn.

    The dataset has a position over time for each part; the result tells, too, which neighbours
    touch when. `units` are those that the reader wants.

    Raises
    ------
    PlotError
        If the dataset has no row in time.
    """
    if FIRST not in dataset:
        raise PlotError(
            "dataset",
            "the dataset has no positions of a row of parts over time",
            "Set trajectory = 400 in the study, and run the study again",
        )
    names = [
        f"part_position_{n + 1}" for n in range(len(dataset)) if f"part_position_{n + 1}" in dataset
    ]
    time, along = shown_in(dataset[TIME], units), shown_in(dataset[FIRST], units)
    centres = np.array([scaled(dataset[name], along.factor) for name in names])
    length = scaled(dataset["length"], along.factor).item() if "length" in dataset else 0.0
    closed = np.diff(centres, axis=0) - length <= TOUCHES * np.ptp(centres)
    return RowPositions(scaled(dataset[TIME], time.factor), centres, length, closed, time, along)


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Return the picture of a row of parts: positions over time, shaded where parts touch.

    The dataset is the result of a study of a row; if it has no positions over time, its single cell
    is followed again to get them.

    Raises
    ------
    PlotError
        If the dataset has no row in time.
    """
    check_result(dataset)
    if FIRST not in dataset and (one := followed(dataset)) is not None:
        dataset = tabulate(one).to_xarray()
    style, units = options.style, options.units
    row = read_row(dataset, units)
    figure = style.sheet()
    axes = figure.add_subplot()
    pale = mix(style.ground, style.curve, PALE)
    for below, above, touch in zip(row.centres, row.centres[1:], row.closed, strict=False):
        axes.fill_between(row.times, below, above, where=touch, color=pale, linewidth=0.0)
    for line in row.centres:
        axes.plot(row.times, line, color=style.curve, linewidth=style.width(1.4))
    axes.set_xlabel(f"Time since the start ({row.time.unit})")
    axes.set_ylabel(f"Position on the track ({row.along.unit})")
    axes.set_xlim(row.times[0], row.times[-1])
    axes.set_ylim(*padded(float(row.centres.min()), float(row.centres.max())))
    entries = [
        Line2D([], [], color=style.curve, linewidth=style.width(1.4), label="centre of a part"),
        Patch(color=pale, label="neighbours that touch"),
    ]
    name = options.title or f"A row of {len(row.centres)} parts, from its start"
    return finish(
        figure, axes, style, name=name,
        facts=held_fixed(dataset, units), source=source_of(dataset), entries=entries,
    )  # fmt: skip


def draw_lane(
    dataset: xarray.Dataset, units: ShownUnits, style: Style, dots: int, *,
    slow: float | None = None, title: str | None = None,
) -> Iterator[Frame]:  # fmt: skip
    """Yield the frames of an animation of a row of parts; parts that touch are filled.

    Each frame is an array of red, green and blue, uint8 of shape (rows, columns, 3).

    Parameters
    ----------
    dataset : xarray.Dataset
        A simulation of one row with `trajectory`.
    units, style : ShownUnits, Style
        Units for reading; colours and sizes.
    dots : int
        Resolution [dots per inch].
    slow : float, optional
        Slow-motion factor; by default a period takes about a second.
    title : str, optional
        Title of the picture.

    Raises
    ------
    PlotError
        If the dataset holds no row in time, or not the length of its parts.
    """
    row = read_row(dataset, units)
    if row.length == 0.0:
        raise PlotError(
            "dataset",
            "the dataset does not give the length of the parts",
            "Set the parameter length in the study, and run the study again",
        )
    slow = slow or nice(PERIOD_SHOWN * float(dataset["frequency"]))
    times = 1000.0 * row.times / row.time.factor
    moments = np.linspace(times[0], times[-1], frames_in(np.ptp(times) / 1000.0 * slow))
    nearest = np.searchsorted(times, moments, side="right") - 1
    swing = np.zeros(moments.size)
    notes = ["seen from above, breadth not to scale"]
    amplitude = amplitude_of(dataset)
    if amplitude is not None and "beta" in dataset.coords:
        along = amplitude * np.cos(np.deg2rad(float(dataset["beta"])))
        phase = TURN * float(dataset["frequency"]) * moments / 1000.0
        swing = row.along.factor * along * np.sin(phase)
    else:
        notes.append("as the track sees it")
    centres = np.array([np.interp(moments, times, path) for path in row.centres]) + swing

    figure = style.sheet(*SIZE)
    figure.set_dpi(dots)
    view, strip = figure.subplots(2, 1, height_ratios=(1.0, 0.5))
    slower = f", {number(slow)} times slower" if slow != 1 else ""
    left, right = centres.min() - row.length, centres.max() + row.length
    view.set(xlim=(left, right), ylim=(0.0, 1.0), yticks=[])
    view.set_xlabel(f"Position ({row.along.unit})")
    pale = mix(style.ground, style.curve, PALE)
    for contact, touch in enumerate(row.closed, start=1):
        strip.fill_between(times, contact - 0.4, contact + 0.4, where=touch, color=pale)
    strip.set(xlim=(times[0], times[-1]), ylim=(0.4, len(row.closed) + 0.6))
    pairs = [f"{n}\N{EN DASH}{n + 1}" for n in range(1, len(centres))]
    strip.set_yticks(range(1, len(centres)), pairs, fontsize=style.text(8))
    strip.set(xlabel="Time (ms)", ylabel="Contact of")
    strip.set_title(" ", fontsize=style.text(10))  # room for what is written in each frame
    finish(
        figure, view, style, name=title or f"A row of {len(centres)} parts{slower}",
        facts=held_fixed(dataset, units), source=DOT.join(notes).capitalize(),
    )  # fmt: skip
    figure.canvas.draw()  # lays out what stands still
    figure.set_layout_engine("none")

    marks = np.linspace(left - swing.max(), right - swing.min(), MARKS)
    (track,) = view.plot([], [], color=style.other, linewidth=1.0, animated=True)
    parts = [
        Rectangle((0.0, (1.0 - WIDTH) / 2), row.length, WIDTH, linewidth=1.4, animated=True)
        for _ in centres
    ]
    for part in parts:
        part.set_edgecolor(style.curve)
        view.add_patch(part)
    (clock,) = strip.plot([], [], color=style.ink, linewidth=2.0, animated=True)
    says = strip.text(
        0.0, 1.05, "", transform=strip.transAxes, fontsize=style.text(9), color=style.ink,
        animated=True,
    )  # fmt: skip

    def put(i: int) -> None:
        """Move the parts and the track to their positions in frame i."""
        x = np.stack([marks + swing[i]] * 2 + [np.full(MARKS, np.nan)], axis=1).ravel()
        track.set_data(x, np.tile([0.0, 1.0, np.nan], MARKS))
        closed = row.closed[:, nearest[i]]
        touched = np.r_[False, closed] | np.r_[closed, False]
        for part, place, touches in zip(parts, centres[:, i], touched, strict=True):
            part.set_x(place - row.length / 2)
            part.set_facecolor(pale if touches else style.ground)
        clock.set_data([moments[i]] * 2, [0.0, len(row.closed) + 1.0])
        count = int(closed.sum())
        shown = with_unit(f"{moments[i]:.1f}", "ms")
        says.set_text(f"{shown}: {count} of {closed.size} contacts closed")

    artists = [(view, path) for path in (track, *parts)] + [(strip, path) for path in (clock, says)]
    yield from frames_of(figure, moments.size, put, artists)
