"""Animations as GIF files, by pillow."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import xarray
from matplotlib.figure import Figure
from PIL import Image

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.plots.animation import Frame, draw_frames
from vibrafeed.core.plots.film import FRAMES_PER_SECOND, read_film
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.positions import FIRST, draw_lane
from vibrafeed.core.plots.style import Options, Style
from vibrafeed.core.plots.text import units_of

DOTS = 100  # dots per inch
COLOURS = 32  # enough for smooth text
SAMPLED = 8  # frames from which the colours are taken


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Raise `PlotError`, since animations are files written by `animate`, not figures."""
    fix = "Call vibrafeed.animate, or end the name in .gif"
    raise PlotError(
        "kind", "an animation can only be written to a file, not returned as a figure", fix
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
    """Save the motion of a part or of a row of parts as an animation, a GIF file.

    Parameters
    ----------
    dataset : xarray.Dataset
        A simulation of one part with `trajectory`, of a drive or of a fall, or of one row.
    target : Path
        The file; an existing one is replaced.
    slow : float, optional
        Slow-motion factor. By default a period takes about a second, a fall six.
    title, units, dark, small
        Title, units for the reader, dark background, small format, as for `draw`.

    Raises
    ------
    PlotError
        If the dataset holds no trajectory, or the file cannot be made.
    OSError
        If the file cannot be written; no part of it is left behind.
    """
    if target.suffix.lower() != ".gif":
        message = f"'{target.suffix}': unknown animation format"
        raise PlotError("output", message, "End the name of the animation in .gif")
    style, shown = Style(dark=dark, small=small), units_of(dataset, units)
    if FIRST in dataset:
        frames = draw_lane(dataset, shown, style, DOTS, slow=slow, title=title)
    else:
        frames = draw_frames(read_film(dataset, shown, slow), style, DOTS, title)
    with whole(target) as temporary:
        _write_gif(frames, temporary)


def _write_gif(frames: Iterable[Frame], target: Path) -> None:
    """Write frames as an endless GIF with one palette of colours, so that nothing flickers.

    `frames` are images in the order of time, uint8 arrays of shape (rows, columns, 3); `target` is
    the file.
    """
    pictures = [Image.fromarray(frame) for frame in frames]
    some = pictures[:: max(1, len(pictures) // SAMPLED)]
    sheet = Image.fromarray(np.concatenate([np.asarray(picture) for picture in some]))
    palette = sheet.quantize(COLOURS, dither=Image.Dither.NONE)
    first, *others = (
        picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures
    )
    first.save(
        target, format="GIF", save_all=True, append_images=others, loop=0, optimize=False,
        duration=1000 // FRAMES_PER_SECOND,
    )  # fmt: skip
