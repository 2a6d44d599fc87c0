"""One style for all pictures: light or dark, of a page's or of a column's width."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from numpy import linspace

from vibrafeed.core.study.shown import ShownUnits

RGB = tuple[float, float, float]
SMALL = 0.8  # text of a small picture over that of a normal one
NARROW = 0.55  # width of a small picture over that of a normal one
LOW = 0.68  # its height: the text below and above takes more of it
HALF = 0.55  # how bright a colour is on which dark lines are seen better than light ones
DARKEST = 0.8  # of a scale that ends in a colour on which lines are still seen


class NotebookFigure(Figure):
    """A figure that a notebook shows by itself: matplotlib teaches it that with pyplot only."""

    def _repr_png_(self) -> bytes:
        """Return the figure as PNG, for notebooks."""
        buffer = BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()


@dataclass(frozen=True)
class Style:
    """Colours and sizes that all kinds of picture share.

    Attributes
    ----------
    dark : bool
        Use light colours on a dark background.
    small : bool
        For a column of a document.
    """

    dark: bool = False
    small: bool = False

    @property
    def ground(self) -> str:
        """The background colour."""
        return "#15181d" if self.dark else "#ffffff"

    @property
    def ink(self) -> str:
        """The colour of text, frames and borders."""
        return "#eceef1" if self.dark else "#16181c"

    @property
    def quiet(self) -> str:
        """The colour of secondary but readable elements."""
        return "#b4b9c2" if self.dark else "#4a4d55"

    @property
    def grid(self) -> RGB:
        """The colour of grid lines."""
        return mix(self.ground, self.ink, 0.13)

    @property
    def curve(self) -> str:
        """The colour of a picture's main curve."""
        return "#8fb8ff" if self.dark else "#1f3b73"

    @property
    def other(self) -> str:
        """The colour of a second curve."""
        return "#d9b27c" if self.dark else "#8a6a3a"

    @property
    def accent(self) -> str:
        """The accent colour: optima and limits."""
        return "#ff7aa8" if self.dark else "#b3124f"

    @property
    def series(self) -> tuple[str, ...]:
        """The colours of curves that have no order, as texts ``#rrggbb``."""
        if self.dark:
            return (
                "#6fb1e8", "#f0925f", "#7cc576", "#b99be0", "#d9b44a", "#f07fb0", "#5fd0d0",
                "#b8bcc4", "#e58a8a", "#9fc0ff", "#c4c46a",
            )  # fmt: skip
        return (
            "#1f5a8a", "#c2572b", "#3f7d3a", "#7a4f9a", "#8a6d1f", "#b0366b", "#1f7f7f",
            "#555555", "#a33c3c", "#4a78bd", "#6d6d1f",
        )  # fmt: skip

    @property
    def single_sign(self) -> Colormap:
        """The colour map for values of one sign."""
        colours = matplotlib.colormaps["YlGnBu"](linspace(0.0, DARKEST, 256))
        return ListedColormap(colours[::-1] if self.dark else colours, "one sign")

    @property
    def two_signs(self) -> Colormap:
        """The colour map for values of both signs, with zero in the middle."""
        return matplotlib.colormaps["berlin" if self.dark else "RdYlBu_r"]

    def on(self, colour: RGB) -> str:
        """Return a readable text colour on a colour: light or dark."""
        red, green, blue = colour
        return "#16181c" if 0.299 * red + 0.587 * green + 0.114 * blue > HALF else "#eceef1"

    def text(self, size: float) -> float:
        """Return the size of a text of `size` points in a picture of normal size."""
        return size * (SMALL if self.small else 1.0)

    def width(self, size: float) -> float:
        """Return the width of a line of `size` points in a picture of normal size."""
        return size * (SMALL if self.small else 1.0)

    def sheet(self, width: float = 8.0, height: float = 6.4) -> Figure:
        """Return an empty figure of matplotlib, on which a picture is drawn.

        `width` and `height` are those of a normal picture [inch]; in the style of small pictures it
        is smaller.
        """
        if self.small:
            width, height = NARROW * width, LOW * height
        figure = NotebookFigure(
            figsize=(width, height), layout="constrained", facecolor=self.ground
        )
        FigureCanvasAgg(figure)
        return figure

    def series_over(self, count: int) -> list[RGB]:
        """Return colours of `count` curves that are ordered by a quantity, from dark to light."""
        ends = (0.32, 1.0) if self.dark else (0.0, 0.78)
        shades = matplotlib.colormaps["viridis"](linspace(*ends, count))
        return [(float(r), float(g), float(b)) for r, g, b, _ in shades]

    def dress(self, figure: Figure) -> None:
        """Apply the style's colours and text sizes to all axes and legends of a figure."""
        for axes in figure.findobj(Axes):
            self._dress_axes(axes)
        for legend in figure.findobj(Legend):
            for text in (legend.get_title(), *legend.get_texts()):
                text.set_color(self.ink)
                text.set_fontsize(self.text(9))

    def _dress_axes(self, axes: Axes) -> None:
        axes.set_facecolor(self.ground)
        for spine in axes.spines.values():
            spine.set_edgecolor(mix(self.ground, self.ink, 0.75))
            spine.set_linewidth(0.8)
        axes.tick_params(
            which="both", colors=mix(self.ground, self.ink, 0.75), labelcolor=self.ink,
            labelsize=self.text(9.5),
        )  # fmt: skip
        for side in (axes.xaxis, axes.yaxis):
            side.label.set_color(self.ink)
            side.label.set_fontsize(self.text(10))
            side.get_offset_text().set_color(self.ink)
            side.get_offset_text().set_fontsize(self.text(8.5))

    def add_grid(self, axes: Axes) -> None:
        """Draw grid lines behind the values."""
        axes.grid(visible=True, color=self.grid, linewidth=0.6)
        axes.set_axisbelow(True)


def mix(colour: str | RGB, other: str | RGB, share: float) -> RGB:
    """Return a mixture of two colours; `share` is that of the second one, 0 to 1.

    Colours are texts or red, green and blue, 0 to 1; so is the result, in the latter form.
    """
    red, green, blue = (
        (1 - share) * a + share * b for a, b in zip(to_rgb(colour), to_rgb(other), strict=True)
    )
    return red, green, blue


LIGHT = Style()


@dataclass(frozen=True)
class Options:
    """The options of a picture; every picture takes the same, and refuses those without effect.

    Attributes
    ----------
    kind : str or None
        The name of the picture; None where the first that fits is drawn.
    variable : str or None
        The output; the first that fits if None.
    axes : tuple of str or None
        One or two dimensions, the first across.
    at : mapping of str to float
        Values of other dimensions, in the unit of the dataset.
    nearest : bool
        Whether a value of `at` that the dataset does not have stands for the nearest one.
    title : str or None
        The name over the picture; that of what it shows if None.
    style : Style
        Colours and sizes.
    units : ShownUnits
        Units in which values are read.
    is_natural : bool
        Whether the kind is the first that fits, and nobody named it.
    """

    kind: str | None = None
    variable: str | None = None
    axes: tuple[str, ...] | None = None
    at: Mapping[str, float] = field(default_factory=dict)
    nearest: bool = False
    title: str | None = None
    style: Style = LIGHT
    units: ShownUnits = field(default_factory=ShownUnits)
    is_natural: bool = False
