"""Parts that pictures share: heading, legend and foot, axes, and the scale of colours."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import matplotlib
import numpy as np
import xarray
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator, NullFormatter, NullLocator
from numpy.typing import NDArray

from vibrafeed.core.plots.selection import PlotAxis, Selection, thin
from vibrafeed.core.plots.style import RGB, Array, Style, long_name, number

DOT = " \N{MIDDLE DOT} "
# Sizes of the title, of the facts below it and of the legend [points].
FACTS = 8.5
MARGIN = 0.02  # of the width, on either side
GIVES_WAY = "gives way"
AIR = 2.0  # dots between texts

OUTLIERS = 1.0  # per cent on either side that may be cut off ...
SPREAD = 4.0  # ... where the range shrinks by more than this
FLAT = 1e-9  # of the largest value: a smaller range is drawn as one value


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

    `top` are the uppermost axes, below the facts: the fixed values, on as many lines as they need,
    and the source of the values. `note` is a sentence above the legend, which has `entries`.
    """
    style.dress(figure)
    _add_legend(figure, entries, note, style)
    heading = _add_title(figure, name, style)
    # Where the axes begin is known only after a layout, with a text of as many lines.
    top.set_title("\n" if source and facts else " ", loc="left", fontsize=style.text(FACTS),
                  linespacing=1.4, color=style.quiet)  # fmt: skip
    figure.draw_without_rendering()
    left, right = top.get_window_extent().intervalx
    # Their width reaches to a legend on the right, else to the margin.
    legends = [legend.get_window_extent() for legend in figure.legends]
    legend_starts = [box.x0 - MARGIN * figure.bbox.width for box in legends if box.x0 > right]
    width = min([(1 - MARGIN) * figure.bbox.width, *legend_starts]) - left
    size = style.text(FACTS)
    lines = [
        *_wrap(figure, facts, width, size),
        _first_that_fits(figure, _shortenings(source), width, size),
    ]
    title = top.set_title("\n".join(filter(None, lines)), loc="left", fontsize=size,
                          linespacing=1.4, color=style.quiet)  # fmt: skip
    left = title.get_window_extent().x0 if title.get_text() else MARGIN * figure.bbox.width
    if left + heading.get_window_extent().width < (1 - MARGIN) * figure.bbox.width:
        heading.set_x(left / figure.bbox.width)
    _leave_out_what_meets(figure)
    return figure


def source_of(dataset: xarray.Dataset, shown: str = "") -> str:
    """Return the line below a title that says where values are from: title, scene and method.

    `shown` is a text that the picture has already, such as a criterion; the title leaves it out.
    """
    parts = (dataset.attrs.get(name) for name in ("scene", "variant", "method"))
    origin = ", ".join(str(part) for part in parts if part)
    title = str(dataset.attrs.get("title", "")).removesuffix(f": {shown}")
    return f"{title} ({origin})" if title else origin


def _text_width(figure: Figure, text: str, size: float, weight: str = "normal") -> float:
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    font = FontProperties(size=size, weight=weight)
    width, *_ = renderer.get_text_width_height_descent(text, font, ismath="$" in text)
    return float(width)


def _first_that_fits(
    figure: Figure, texts: Iterable[str], width: float, size: float, weight: str = "normal"
) -> str:
    return next((text for text in texts if _text_width(figure, text, size, weight) <= width), "")


def _wrap(figure: Figure, facts: Sequence[str], width: float, size: float) -> list[str]:
    """Return facts, joined by dots, as lines that fit a width."""
    lines: list[str] = []
    for fact in facts:
        longer = DOT.join([*lines[-1:], fact])
        if lines and _text_width(figure, longer, size) <= width:
            lines[-1] = longer
        else:
            lines.append(fact)
    return lines


def _shortenings(text: str) -> Iterator[str]:
    """Yield a text, and the text without its last word, its last two words, and so on."""
    yield text
    for cut in range(text.count(" "), 0, -1):
        yield " ".join(text.split(" ")[:cut]).rstrip(" ,(") + " …"


def _add_title(figure: Figure, name: str, style: Style) -> Text:
    """Write the title on one line, or two, the second cut if it is too long."""
    size, width = style.text(13.0), (1 - 2 * MARGIN) * figure.bbox.width
    words, count = name.split(), 1
    while (
        count < len(words)
        and _text_width(figure, " ".join(words[: count + 1]), size, "bold") <= width
    ):
        count += 1
    rest = _first_that_fits(figure, _shortenings(" ".join(words[count:])), width, size, "bold")
    title = "\n".join(filter(None, [" ".join(words[:count]), rest]))
    return figure.suptitle(
        title, x=MARGIN, ha="left", fontsize=size, fontweight="bold", color=style.ink
    )


def _add_legend(figure: Figure, entries: Sequence[Artist], note: str, style: Style) -> None:
    if not entries:
        return
    size = style.text(9.0)
    letter = _text_width(figure, "n", size)
    widest = max(_text_width(figure, str(entry.get_label()), size) for entry in entries)
    width = (1 - 2 * MARGIN) * figure.bbox.width
    # A swatch of the legend, and the gap behind it, take five letters.
    columns = int(width // (widest + 5.0 * letter + 2 * letter))
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
        title=_first_that_fits(figure, _shortenings(note), width, size) or None,
        title_fontsize=size,
        alignment="left",
    )
    legend.get_title().set_color(style.quiet)


def number_lines(axes: Axes, lines: ContourSet, style: Style, size: float, **look: Any) -> None:
    """Write its value on each line of equal value; a number gives way to what stands there."""
    for label in axes.clabel(lines, fontsize=style.text(size), inline=False, **look):
        label.set_gid(GIVES_WAY)
        label.set_path_effects([withStroke(linewidth=3.0, foreground=style.ground)])


def _leave_out_what_meets(figure: Figure) -> None:
    # Texts marked by `GIVES_WAY` are hidden if they touch others or leave their axes; of two such
    # the one drawn on top (the larger z-order) stays. The figure has to be laid out.
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    boxes = [text.get_window_extent(renderer) for text in shown if text.get_gid() != GIVES_WAY]
    yielding = [text for text in shown if text.get_gid() == GIVES_WAY]
    for text in sorted(yielding, key=lambda text: -text.get_zorder()):
        box = text.get_window_extent(renderer)
        frame = text.axes.get_window_extent() if text.axes else figure.bbox
        inside = frame.x0 < box.x0 < box.x1 < frame.x1 and frame.y0 < box.y0 < box.y1 < frame.y1
        if inside and not any(box.padded(AIR).overlaps(other) for other in boxes):
            boxes.append(box)
        else:
            text.set_visible(False)


Plane = tuple[PlotAxis, PlotAxis, Array, NDArray[np.int64]]


@dataclass(frozen=True)
class Scale:
    """Levels of contours and the colours between them."""

    levels: Array
    colours: Colormap
    norm: Normalize
    extend: Literal["neither", "min", "max", "both"]

    def typical(self, values: Array) -> RGB:
        """Return the colour of the 85th percentile of values, to stand for all; white without."""
        finite = values[np.isfinite(values)]
        if not finite.size:
            return 1.0, 1.0, 1.0
        # The middle one is often as pale as a veil.
        return self.colour(float(np.percentile(finite, 85.0)))

    def colour(self, value: float) -> RGB:
        """Return the colour of a value."""
        red, green, blue, _ = self.colours(self.norm(value))
        return red, green, blue


def value_range(values: Array) -> tuple[float, float] | None:
    """Return the smallest and largest value to show; None if nothing is finite.

    Outliers are cut off, as at a pole, which would leave one colour to the rest of the picture: 1 %
    on either side, if that shrinks the range more than fourfold. A flat range is widened.
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return None
    low, high = float(finite.min()), float(finite.max())
    inner = np.percentile(finite, [OUTLIERS, 100 - OUTLIERS])
    if 0 < SPREAD * (inner[1] - inner[0]) < high - low:
        low, high = float(inner[0]), float(inner[1])
    if high - low <= FLAT * max(abs(low), abs(high)):
        room = 0.05 * max(abs(low), abs(high)) or 1.0
        low, high = low - room, high + room
    return low, high


def scale_of(values: Array, style: Style) -> Scale | None:
    """Return levels and colours for the values of a picture; None if no value is finite.

    If both signs occur to some extent, the colours have two branches with zero in the middle.
    """
    limits = value_range(values)
    if limits is None:
        return None
    locator = MaxNLocator(12, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(*limits), dtype=np.float64)
    is_below, is_above = np.nanmin(values) < levels[0], np.nanmax(values) > levels[-1]
    extend: Literal["neither", "min", "max", "both"] = (
        "both" if is_below and is_above else "min" if is_below else "max" if is_above else "neither"
    )
    # A sign that reaches less of the other leaves the colours to that one.
    if min(-limits[0], limits[1]) > 0.1 * max(-limits[0], limits[1]):
        largest = float(np.abs(levels).max())
        colours = matplotlib.colormaps["berlin" if style.dark else "RdYlBu_r"]
        return Scale(levels, colours, Normalize(-largest, largest), extend)
    norm = Normalize(float(levels[0]), float(levels[-1]))
    return Scale(levels, style.single_sign, norm, extend)


def plain(value: float, _: object = None) -> str:
    """Return the number of a tick."""
    return number(value)


def set_log(spine: Axis, values: Array) -> None:
    """Make an axis logarithmic, with plain numbers at the ticks.

    If its values, ascending, span less than a decade, ticks lie between powers of ten.
    """
    spine.axes.set(**{f"{spine.axis_name}scale": "log"})  # type: ignore[attr-defined]
    spine.set_major_formatter(plain)
    spine.set_minor_formatter(NullFormatter())
    if values[-1] < 10.0 * values[0]:
        spine.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        spine.set_minor_locator(NullLocator())


def cell_edges(axis: PlotAxis) -> Array:
    """Return the borders of the cells about the points of an axis, shape (n + 1,).

    They lie halfway between two points, as the axis is drawn, and at both ends.
    """
    points = np.log(axis.values) if axis.is_log else axis.values
    borders = (points[:-1] + points[1:]) / 2
    inner = np.exp(borders) if axis.is_log else borders
    return np.concatenate([axis.values[:1], inner, axis.values[-1:]])


def limit_to_cells(axes: Axes, across: PlotAxis, up: PlotAxis) -> None:
    """End axes where the outermost cells do."""
    x, y = cell_edges(across), cell_edges(up)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))


def set_plane(axes: Axes, selection: Selection, max_points: int) -> Plane:
    """Set labels and spacing of axes for a picture over two axes; return what to draw there.

    Of an axis with more points `max_points` are taken, both ends included. The result has the axes
    across and up, and arrays of values and regimes, shape (up, across).
    """
    columns, rows = (thin(axis.values.size, max_points) for axis in selection.axes)
    across, up = (
        replace(axis, values=axis.values[indices])
        for axis, indices in zip(selection.axes, (columns, rows), strict=True)
    )
    for axis, drawn_axis in ((across, axes.xaxis), (up, axes.yaxis)):
        if axis.is_log:
            set_log(drawn_axis, axis.values)
        drawn_axis.set_label_text(axis.label)
    cells = np.ix_(columns, rows)
    return across, up, selection.values[cells].T, selection.regimes[cells].T


def add_colour_bar(
    axes: Axes, colours: ScalarMappable, scale: Scale, label: str, style: Style
) -> None:
    """Add a colour bar beside axes, with ticks at the levels and a label."""
    ticks = scale.levels[:: 2 if style.small else 1].tolist()
    bar = axes.figure.colorbar(colours, ax=axes, ticks=ticks, pad=0.02, aspect=28)
    bar.ax.yaxis.set_major_formatter(plain)
    bar.set_label(label)


def padded(low: float, high: float) -> tuple[float, float]:
    """Return axis limits with some room around two values."""
    room = 0.06 * (high - low) or 0.05 * abs(low) or 1.0
    return low - room, high + room


def say_nothing_is_finite(axes: Axes, selection: Selection, style: Style) -> None:
    """Write into empty axes that no value of the selected output is finite."""
    name = long_name(selection.variable)
    axes.annotate(
        f"{name}:\nno value here is finite.", (0.5, 0.5), xycoords="axes fraction", ha="center",
        va="center", fontsize=style.text(11), color=style.ink, zorder=6,
        bbox={"facecolor": style.ground, "edgecolor": "none", "boxstyle": "round,pad=0.6"},
    )  # fmt: skip
