"""Animations as files: GIF by pillow, MP4 by the ffmpeg of imageio-ffmpeg."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path
from types import ModuleType

import numpy as np
import xarray
from matplotlib.figure import Figure
from PIL import Image

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.extras import installing
from vibrafeed.core.plots.animation import Frame, draw_frames
from vibrafeed.core.plots.film import FRAMES_PER_SECOND, read_film
from vibrafeed.core.plots.lane import draw_lane
from vibrafeed.core.plots.options import Options
from vibrafeed.core.plots.pictures import MOVING
from vibrafeed.core.plots.positions import FIRST
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.plots.style import Style
from vibrafeed.core.plots.text import units_of

DOTS = {".gif": 100, ".mp4": 150}  # dots per inch
COLOURS = 32  # colours of a GIF: enough for smooth text
SAMPLED = 8  # frames from which the colours of a GIF are taken
QUALITY = 7.0  # of MP4, from 0 to 10, as imageio-ffmpeg takes it


def fits(dataset: xarray.Dataset, options: Options) -> bool:
    """Return False: animations are not figures, and are only drawn on request."""
    return False


def draw(dataset: xarray.Dataset, options: Options) -> Figure:
    """Raise `PlotError`, since animations are files written by `animate`, not figures."""
    fix = "Call vibrafeed.animate, or end the name in .gif or .mp4"
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
    """Save the motion of a part or of a row of parts as an animation, GIF or MP4 by the suffix.

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
    suffix = target.suffix.lower()
    if suffix not in MOVING:
        message = f"'{target.suffix}': unknown animation format"
        raise PlotError("output", message, "End the name of the animation in .gif or .mp4")
    style, shown = Style(dark=dark, small=small), units_of(dataset, units)
    if FIRST in dataset:
        frames = draw_lane(dataset, shown, style, DOTS[suffix], slow=slow, title=title)
    else:
        frames = draw_frames(read_film(dataset, shown, slow), style, DOTS[suffix], title)
    write = _write_gif if suffix == ".gif" else _write_mp4
    if suffix == ".mp4":
        _ffmpeg()  # before anything is drawn
    with whole(target) as temporary:
        write(frames, temporary)


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


def _write_mp4(frames: Iterable[Frame], target: Path) -> None:
    """Write frames as an MP4 file that all browsers can play.

    `frames` are images in the order of time, uint8 arrays of shape (rows, columns, 3), at least
    one; they are drawn one by one as they are written. `target` is the file. Needs the package
    imageio-ffmpeg, else `PlotError` is raised.
    """
    imageio_ffmpeg = _ffmpeg()
    shown = iter(frames)
    first = next(shown)
    rows, columns, _ = first.shape
    writer = imageio_ffmpeg.write_frames(
        str(target), (columns, rows), fps=FRAMES_PER_SECOND, codec="libx264",
        pix_fmt_out="yuv420p", quality=QUALITY, macro_block_size=2,
        output_params=["-f", "mp4", "-movflags", "+faststart"],
    )  # fmt: skip
    writer.send(None)
    try:
        for frame in chain([first], shown):
            writer.send(np.ascontiguousarray(frame))
    finally:
        writer.close()


def _ffmpeg() -> ModuleType:
    """Return the writer of MP4; raise `PlotError` if ffmpeg is missing.

    It is the module imageio_ffmpeg, which is installed with the extra `video`.
    """
    try:
        import imageio_ffmpeg
    except ModuleNotFoundError:
        fix = f"Install it: {installing('imageio-ffmpeg', 'video')}. Or end the name in .gif"
        raise PlotError("output", "MP4 needs imageio-ffmpeg, which is missing", fix) from None
    return imageio_ffmpeg
