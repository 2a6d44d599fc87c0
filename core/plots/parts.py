"""Parts that several kinds of picture share: axes, and the scale of colours with its levels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import FigureBase
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter, NullLocator
from numpy.typing import NDArray

from vibrafeed.core.plots.selection import PlotAxis, Selection, thin
from vibrafeed.core.plots.style import RGB, Style
from vibrafeed.core.plots.text import long_name, number, short_label

DECADE = 10.0
BANDS = 12  # levels of a scale, roughly
OUTLIERS = 1.0  # per cent on either side that may be cut off ...
SPREAD = 4.0  # ... where the range shrinks by more than this
FLAT = 1e-9  # of the largest value: a smaller range is drawn as one value
MINOR_SIGN = 0.1  # a sign that reaches less of the other leaves the colours to that one
STRONG = 85.0  # per cent: the middle one is often as pale as a veil


@dataclass(frozen=True)
class Scale:
    """Levels of contours and the colours between them."""

    levels: NDArray[np.float64]
    colours: Colormap
    norm: Normalize
    extend: Literal["neither", "min", "max", "both"]

    def typical(self, values: NDArray[np.float64]) -> RGB:
        """Return the colour of a large one of some values, their 85th percentile, to stand for all.

        It is the colour of an area in a legend; white if no value is finite.
        """
        finite = values[np.isfinite(values)]
        if not finite.size:
            return 1.0, 1.0, 1.0
        return self.colour(float(np.percentile(finite, STRONG)))

    def colour(self, value: float) -> RGB:
        """Return the colour of a value."""
        red, green, blue, _ = self.colours(self.norm(value))
        return red, green, blue


def value_range(values: NDArray[np.float64]) -> tuple[float, float] | None:
    """Return the smallest and largest value to show; None if nothing is finite.

    Outliers are cut off, as at a pole, which would leave one colour to the rest of the picture: 1 %
    on either side, if that shrinks the range more than fourfold. A flat range is widened. `values`
    may have any shape, in the unit of the picture.
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return None
    low, high = float(finite.min()), float(finite.max())
    most = np.percentile(finite, [OUTLIERS, 100 - OUTLIERS])
    if 0 < SPREAD * (most[1] - most[0]) < high - low:
        low, high = float(most[0]), float(most[1])
    if high - low <= FLAT * max(abs(low), abs(high)):
        room = 0.05 * max(abs(low), abs(high)) or 1.0
        low, high = low - room, high + room
    return low, high


def scale_of(values: NDArray[np.float64], style: Style) -> Scale | None:
    """Return levels and colours for the values of a picture; None if no value is finite.

    If both signs occur to some extent, the colours have two branches with zero in the middle.
    `values` may have any shape.
    """
    ends = value_range(values)
    if ends is None:
        return None
    locator = MaxNLocator(BANDS, steps=[1, 2, 2.5, 5, 10])
    levels = np.asarray(locator.tick_values(*ends), dtype=np.float64)
    under, over = np.nanmin(values) < levels[0], np.nanmax(values) > levels[-1]
    extend: Literal["neither", "min", "max", "both"] = (
        "both" if under and over else "min" if under else "max" if over else "neither"
    )
    if min(-ends[0], ends[1]) > MINOR_SIGN * max(-ends[0], ends[1]):
        most = float(np.abs(levels).max())
        return Scale(levels, style.two_signs, Normalize(-most, most), extend)
    norm = Normalize(float(levels[0]), float(levels[-1]))
    return Scale(levels, style.single_sign, norm, extend)


class Plane(NamedTuple):
    """Values and regimes over two axes, as arrays (up, across), and the axes."""

    across: PlotAxis
    up: PlotAxis
    values: NDArray[np.float64]
    regimes: NDArray[np.int64]


def plain(value: float, _: object = None) -> str:
    """Return the number of a tick."""
    return number(value)


def set_log(spine: Axis, values: NDArray[np.float64]) -> None:
    """Make an axis logarithmic, with plain numbers at the ticks.

    `spine` is the axis of matplotlib; `values` are those on it, ascending: if they span less than a
    decade, ticks lie between powers of ten.
    """
    if spine.axis_name == "x":  # type: ignore[attr-defined]
        spine.axes.set_xscale("log")
    else:
        spine.axes.set_yscale("log")
    spine.set_major_formatter(FuncFormatter(plain))
    spine.set_minor_formatter(NullFormatter())
    if values[-1] < DECADE * values[0]:
        spine.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        spine.set_minor_locator(NullLocator())


def cell_edges(axis: PlotAxis) -> NDArray[np.float64]:
    """Return the borders of the cells about the points of an axis, shape (n + 1,).

    They lie halfway between two points, as the axis is drawn, and at both ends.
    """
    drawn = np.log(axis.values) if axis.is_log else axis.values
    between = (drawn[:-1] + drawn[1:]) / 2
    middle = np.exp(between) if axis.is_log else between
    return np.concatenate([axis.values[:1], middle, axis.values[-1:]])


def limit_to_cells(axes: Axes, across: PlotAxis, up: PlotAxis) -> None:
    """End axes where the outermost cells do."""
    x, y = cell_edges(across), cell_edges(up)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))


def set_plane(axes: Axes, selection: Selection, most: int) -> Plane:
    """Set labels and spacing of axes for a picture over two axes; return the values to draw there.

    `selection` has an output over two axes. Of more than `most` points of an axis as many are
    taken, both ends included. The result has the axes and arrays of values and regimes, shape (up,
    across).
    """
    across, up = selection.axes
    columns, rows = (thin(axis.values.size, most) for axis in selection.axes)
    across, up = (
        replace(axis, values=axis.values[some]) for axis, some in ((across, columns), (up, rows))
    )
    for axis, spine in ((across, axes.xaxis), (up, axes.yaxis)):
        if axis.is_log:
            set_log(spine, axis.values)
        spine.set_label_text(axis.label)
    part = np.ix_(columns, rows)
    return Plane(across, up, selection.values[part].T, selection.regimes[part].T)


def add_colour_bar(
    figure: FigureBase,
    axes: Axes,
    colours: ScalarMappable,
    scale: Scale,
    selection: Selection,
    style: Style,
    **layout: Any,
) -> None:
    """Add a colour bar beside axes, with ticks at the levels and the label of the output.

    `colours` is what is coloured, `scale` has the levels, `selection` the output and its unit, and
    `layout` further options of matplotlib.
    """
    ticks = scale.levels[:: 2 if style.small else 1]
    bar = figure.colorbar(colours, ax=axes, ticks=ticks.tolist(), **layout)
    bar.ax.yaxis.set_major_formatter(FuncFormatter(plain))
    bar.set_label(short_label(selection.variable, selection.unit))


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
