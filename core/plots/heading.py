"""The heading and the foot of a picture: its name, what is held fixed, its legend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.transforms import BboxBase

from vibrafeed.core.plots.style import Style

DOT = " \N{MIDDLE DOT} "
# Sizes of the title, of the facts below it and of the legend [points].
NAME = 13.0
FACTS = 8.5
LEGEND = 9.0
HANDLE = 5.0  # widths of a letter: a swatch of the legend, and the gap behind it
MARGIN = 0.02  # of the width, on either side
GIVES_WAY = "gives way"
AIR = 2.0  # dots between texts


def finish(
    figure: Figure,
    top: Axes,
    style: Style,
    *,
    name: str,
    facts: Sequence[str] = (),
    source: str = "",
    entries: Sequence[Artist] = (),
    note: str = "",
) -> Figure:
    """Add title, facts, source and legend to a drawn figure, and return it.

    Parameters
    ----------
    figure : Figure
        The figure, whose axes are drawn.
    top : Axes
        The uppermost axes, above which the facts stand.
    style : Style
        Colours and sizes.
    name, source : str
        Title of the picture, and where its values are from.
    facts : sequence of str
        What is held fixed; facts that do not fit their line are only counted.
    entries : sequence of Artist
        Entries of the legend.
    note : str
        A sentence above the legend.
    """
    style.dress(figure)
    _add_legend(figure, entries, note, style)
    heading = _add_name(figure, name, style)
    # Where the axes begin is known only after a layout, with a text of as many lines.
    top.set_title("\n" if source and facts else " ", loc="left", fontsize=style.text(FACTS),
                  linespacing=1.4, color=style.quiet)  # fmt: skip
    figure.draw_without_rendering()
    start, end = top.get_window_extent().intervalx
    beside = [legend.get_window_extent() for legend in figure.legends]
    ends = [box.x0 - MARGIN * figure.bbox.width for box in beside if box.x0 > end]
    room = min([(1 - MARGIN) * figure.bbox.width, *ends]) - start
    size = style.text(FACTS)
    lines = [_packed(figure, facts, room, size), _cut(figure, source, room, size)]
    title = top.set_title("\n".join(filter(None, lines)), loc="left", fontsize=size,
                          linespacing=1.4, color=style.quiet)  # fmt: skip
    start = title.get_window_extent().x0 if title.get_text() else MARGIN * figure.bbox.width
    if start + heading.get_window_extent().width < (1 - MARGIN) * figure.bbox.width:
        heading.set_x(start / figure.bbox.width)
    leave_out_what_meets(figure)
    return figure


def source_of(dataset: xarray.Dataset, shown: str = "") -> str:
    """Return the source of a picture's values: title, scene, variant and method.

    It is a line below the title. `shown` is a text that the picture has already, such as a
    criterion; the title leaves it out.
    """
    parts = (dataset.attrs.get(name) for name in ("scene", "variant", "method"))
    origin = ", ".join(str(part) for part in parts if part)
    title = str(dataset.attrs.get("title", "")).removesuffix(f": {shown}")
    return f"{title} ({origin})" if title else origin


def text_width(figure: Figure, text: str, size: float, weight: str = "normal") -> float:
    """Return the width of a text in dots; `size` is that of its letters [points].

    `weight` is ``"normal"`` or ``"bold"``. Texts are laid out by it.
    """
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    font = FontProperties(size=size, weight=weight)
    width, _, _ = renderer.get_text_width_height_descent(text, font, ismath="$" in text)
    return float(width)


def _packed(figure: Figure, facts: Sequence[str], width: float, size: float) -> str:
    """Return as many texts as fit one line below a title, and the number of those left out.

    `facts` are the texts, `width` is that of the line in dots, `size` that of its letters [points].
    The line is empty if not even one fits.
    """
    for count in range(len(facts), 0, -1):
        left = len(facts) - count
        more = [f"{left}\N{NO-BREAK SPACE}more"] if left else []
        line = DOT.join([*facts[:count], *more])
        if text_width(figure, line, size) <= width:
            return line
    return ""


def _cut(figure: Figure, text: str, width: float, size: float, weight: str = "normal") -> str:
    """Return a text shortened to a width by leaving out its last words; empty if none fits.

    `width` is in dots, `size` that of the letters [points]. `weight` is ``"normal"`` or ``"bold"``.
    """
    parts = text.split(" ")
    for count in range(len(parts), 0, -1):
        shown = " ".join(parts[:count])
        shown = shown if count == len(parts) else shown.rstrip(" ,(") + " …"
        if text_width(figure, shown, size, weight) <= width:
            return shown
    return ""


def _add_name(figure: Figure, name: str, style: Style) -> Text:
    """Add the title of a picture, in two lines if need be; what is longer is cut."""
    size, width = style.text(NAME), (1 - 2 * MARGIN) * figure.bbox.width
    words, count = name.split(), 1
    while (
        count < len(words)
        and text_width(figure, " ".join(words[: count + 1]), size, "bold") <= width
    ):
        count += 1
    rest = _cut(figure, " ".join(words[count:]), width, size, "bold")
    shown = "\n".join(filter(None, [" ".join(words[:count]), rest]))
    return figure.suptitle(
        shown, x=MARGIN, ha="left", fontsize=size, fontweight="bold", color=style.ink
    )


def _add_legend(figure: Figure, entries: Sequence[Artist], note: str, style: Style) -> None:
    """Add the legend below the axes of a picture; nothing is added without entries.

    It has as many columns as fit. `note` is a sentence that becomes its title, cut if it is longer
    than the picture is wide; it may be empty. `style` has colours and sizes of text.
    """
    if not entries:
        return
    size = style.text(LEGEND)
    letter = text_width(figure, "n", size)
    widest = max(text_width(figure, str(entry.get_label()), size) for entry in entries)
    width = (1 - 2 * MARGIN) * figure.bbox.width
    columns = int(width // (widest + HANDLE * letter + 2 * letter))
    legend = figure.legend(
        handles=list(entries),
        loc="outside lower left",
        ncols=max(1, min(len(entries), columns)),
        frameon=False,
        fontsize=size,
        handlelength=3.0,
        handleheight=1.4,
        columnspacing=1.4,
        labelcolor=style.ink,
        title=_cut(figure, note, width, size) or None,
        title_fontsize=size,
        alignment="left",
    )
    legend.get_title().set_color(style.quiet)


def gives_way(text: Text) -> None:
    """Mark a text to be hidden if it would touch others or leave its axes."""
    text.set_gid(GIVES_WAY)


def number_lines(axes: Axes, lines: ContourSet, style: Style, size: float, **look: Any) -> None:
    """Write its value on each line of equal value; a number gives way to what stands there."""
    for label in axes.clabel(lines, fontsize=style.text(size), inline=False, **look):
        gives_way(label)
        label.set_path_effects([withStroke(linewidth=3.0, foreground=style.ground)])


def leave_out_what_meets(figure: Figure) -> None:
    """Hide less important texts of a figure that touch other texts or leave their axes.

    Less important texts, such as numbers on contour lines, are marked by the group id `GIVES_WAY`.
    Of two that touch, the one drawn on top (the larger z-order) stays. The figure has to be laid
    out.
    """
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    kept = [text.get_window_extent(renderer) for text in shown if text.get_gid() != GIVES_WAY]
    loose = [text for text in shown if text.get_gid() == GIVES_WAY]
    for text in sorted(loose, key=lambda text: -text.get_zorder()):
        box = text.get_window_extent(renderer)
        frame = text.axes.get_window_extent() if text.axes else figure.bbox
        if _lies_within(box, frame) and not any(box.padded(AIR).overlaps(other) for other in kept):
            kept.append(box)
        else:
            text.set_visible(False)


def _lies_within(box: BboxBase, frame: BboxBase) -> bool:
    """True if a box lies within a frame."""
    return bool(frame.x0 < box.x0 and frame.y0 < box.y0 and box.x1 < frame.x1 and box.y1 < frame.y1)
