"""A row of parts as an animation: seen from above, on its moving track."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray
from matplotlib.patches import Rectangle

from vibrafeed.core.plots.animation import DOT, Frame, frames_of
from vibrafeed.core.plots.film import PERIOD_SHOWN, TURN, amplitude_of, frames_in, nice
from vibrafeed.core.plots.heading import finish
from vibrafeed.core.plots.positions import PALE, read_row
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.plots.selection import held_fixed
from vibrafeed.core.plots.style import Style, mix
from vibrafeed.core.plots.text import number, with_unit
from vibrafeed.core.study.shown import ShownUnits

SIZE = (6.4, 4.0)  # inches
MARKS = 24
"""On the width of the view, by which the track is seen to move."""
WIDTH = 0.5
"""Of the lane, that the parts take."""


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
