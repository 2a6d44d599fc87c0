"""One style for all pictures, and numbers, units and names as a person reads them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import matplotlib
import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from numpy import linspace
from numpy.typing import NDArray

from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.shown import Shown, ShownUnits

Array = NDArray[np.float64]
RGB = tuple[float, float, float]
SMALL = 0.8  # text of a small picture over that of a normal one
NARROW = 0.55  # width of a small picture over that of a normal one

GREEK = (
    "Gamma", "Lambda", "alpha", "beta", "gamma", "delta", "zeta", "theta", "kappa", "lambda", "mu",
    "xi", "rho", "sigma", "tau", "chi", "psi",
)  # fmt: skip
LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
SUBSCRIPTS = {"inf": r"\infty"}


class NotebookFigure(Figure):
    """A figure that a notebook shows by itself: matplotlib teaches it that with pyplot only."""

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()


def _either(light: Any, dark: Any) -> Any:
    return property(lambda style: dark if style.dark else light)


@dataclass(frozen=True)
class Style:
    """Colours and sizes that all kinds of picture share, on a dark ground or in a small format."""

    dark: bool = False
    small: bool = False

    ground = _either("#ffffff", "#15181d")
    ink = _either("#16181c", "#eceef1")  # of text, frames and borders
    quiet = _either("#4a4d55", "#b4b9c2")  # of what is secondary, but to be read
    curve = _either("#1f3b73", "#8fb8ff")  # the main one of a picture
    other = _either("#8a6a3a", "#d9b27c")  # of a second curve
    accent = _either("#b3124f", "#ff7aa8")  # optima and limits
    series = _either(  # of curves that have no order
        (
            "#1f5a8a", "#c2572b", "#3f7d3a", "#7a4f9a", "#8a6d1f", "#b0366b", "#1f7f7f",
            "#555555", "#a33c3c", "#4a78bd", "#6d6d1f",
        ),
        (
            "#6fb1e8", "#f0925f", "#7cc576", "#b99be0", "#d9b44a", "#f07fb0", "#5fd0d0",
            "#b8bcc4", "#e58a8a", "#9fc0ff", "#c4c46a",
        ),
    )  # fmt: skip

    @property
    def grid(self) -> RGB:
        """The colour of grid lines."""
        return mix(self.ground, self.ink, 0.13)

    @property
    def single_sign(self) -> Colormap:
        """The colour map for values of one sign."""
        # Up to a colour on which lines are still seen.
        colours = matplotlib.colormaps["YlGnBu"](linspace(0.0, 0.8, 256))
        return ListedColormap(colours[::-1] if self.dark else colours, "one sign")

    def on(self, colour: RGB) -> str:
        """Return a readable text colour on a colour: light or dark."""
        red, green, blue = colour
        return "#16181c" if 0.299 * red + 0.587 * green + 0.114 * blue > 0.55 else "#eceef1"

    def text(self, size: float) -> float:
        """Return the size of a text of `size` points in a picture of normal size."""
        return size * (SMALL if self.small else 1.0)

    width = text  # of a line

    def sheet(self, width: float = 8.0, height: float = 6.4) -> Figure:
        """Return an empty figure, whose size is that of a normal picture [inch]."""
        if self.small:
            width, height = NARROW * width, 0.68 * height
        figure = NotebookFigure(
            figsize=(width, height), layout="constrained", facecolor=self.ground
        )
        FigureCanvasAgg(figure)
        return figure

    def series_over(self, count: int) -> list[RGB]:
        """Return colours of some curves that are ordered by a quantity, from dark to light."""
        if count == 1:
            return [to_rgb(self.curve)]
        ends = (0.32, 1.0) if self.dark else (0.0, 0.78)
        shades = matplotlib.colormaps["viridis"](linspace(*ends, count))
        return [(float(red), float(green), float(blue)) for red, green, blue, _ in shades]

    def dress(self, figure: Figure) -> None:
        """Apply the style's colours and text sizes to all axes and legends of a figure."""
        frame = mix(self.ground, self.ink, 0.75)
        for axes in figure.findobj(Axes):
            axes.set_facecolor(self.ground)
            for spine in axes.spines.values():
                spine.set(edgecolor=frame, linewidth=0.8)
            axes.tick_params(
                which="both", colors=frame, labelcolor=self.ink, labelsize=self.text(9.5)
            )
            for side in (axes.xaxis, axes.yaxis):
                side.label.set(color=self.ink, fontsize=self.text(10))
                side.get_offset_text().set(color=self.ink, fontsize=self.text(8.5))
        for legend in figure.findobj(Legend):
            for text in (legend.get_title(), *legend.get_texts()):
                text.set(color=self.ink, fontsize=self.text(9))

    def add_grid(self, axes: Axes) -> None:
        """Draw grid lines behind the values."""
        axes.grid(visible=True, color=self.grid, linewidth=0.6)
        axes.set_axisbelow(True)


def mix(colour: str | RGB, other: str | RGB, share: float) -> RGB:
    """Return a mixture of two colours as red, green and blue, 0 to 1; `share` is of the second."""
    red, green, blue = (
        (1 - share) * first + share * second
        for first, second in zip(to_rgb(colour), to_rgb(other), strict=True)
    )
    return red, green, blue


LIGHT = Style()


@dataclass(frozen=True)
class Options:
    """The options of a picture, as for `vibrafeed.plot`; one that has no effect is refused.

    Values of `at` are in the unit of the dataset. `is_natural` says that the kind is the first that
    fits, and nobody named it.
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

    @property
    def asks(self) -> bool:
        """True if an output or axes are asked for."""
        return (self.variable, self.axes) != (None, None)


def words(name: str) -> str:
    """Return an identifier as words."""
    return name.replace("_", " ")


def name_in_words(name: str) -> str:
    """Return an identifier as words, with its numbers as subscripts."""
    return re.sub(r" (\d+)\b", lambda match: match[1].translate(LOWERED), words(name))


def shown_in(array: xarray.DataArray, units: ShownUnits) -> Shown:
    """Return the unit in which an array is shown, by its largest finite value, and the factor."""
    values = np.abs(np.asarray(array.values, dtype=np.float64))
    largest = float(values[np.isfinite(values)].max(initial=0.0))
    return units.of(str(array.attrs.get("units", "1")), largest)


def number(value: float, digits: int = 6) -> str:
    """Return a number with the significant digits it needs, at most `digits`."""
    return f"{value + 0.0:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def with_unit(text: str, unit: str) -> str:
    """Return a number with its unit, separated by a non-breaking space."""
    return text + unit if unit in ("", "°") else f"{text}\N{NO-BREAK SPACE}{unit}"


def math_symbol(symbol: str) -> str:
    r"""Return a symbol, such as `mu_inf`, as `$\mu_{\infty}$`; empty for an expression."""
    match = re.fullmatch("(" + "|".join(GREEK) + r"|[A-Za-z])_?(\d|[a-z]+)?", symbol)
    if not match:
        return ""
    base, below = match.groups()
    base = f"\\{base}" if base in GREEK else base
    below = SUBSCRIPTS.get(below, rf"\mathrm{{{below}}}") if below else ""
    return f"${base}_{{{below}}}$" if below else f"${base}$"


def long_name(array: xarray.DataArray) -> str:
    """Return the long name of a variable, or its identifier as words."""
    return str(array.attrs.get("long_name", words(str(array.name))))


def axis_label(array: xarray.DataArray, unit: str) -> str:
    """Return the label of an axis: long name, symbol, unit."""
    parts = (long_name(array), math_symbol(str(array.attrs.get("symbol", ""))), in_brackets(unit))
    return " ".join(part for part in parts if part)


def demand_in_words(array: xarray.DataArray, units: ShownUnits) -> str:
    """Return in words the demand whose probability an array has; empty for other arrays.

    An example is "Probability of conveying velocity at least 80 mm/s".
    """
    name, attributes = str(array.name), array.attrs
    if not name.startswith("probability_") or "output" not in attributes:
        return ""
    output = QUANTITIES[str(attributes["output"])]
    bounds = {key: float(attributes[key]) for key in ("at_least", "at_most") if key in attributes}
    shown = units.of(output.unit, max(map(abs, bounds.values()), default=0.0))
    demands = " and ".join(
        f"{words(key)} {with_unit(number(shown.factor * bound, 4), shown.unit)}"
        for key, bound in bounds.items()
    )
    noun = "Error of the probability" if name.endswith("_error") else "Probability"
    return f"{noun} of {in_sentence(output.label)} {demands}".rstrip()


def in_brackets(unit: str) -> str:
    """Return a unit in brackets; empty without a unit."""
    return f"({unit})" if unit else ""


def scaled(array: xarray.DataArray, factor: float) -> Array:
    """Return values multiplied by a unit's factor."""
    return np.asarray(array.values, dtype=np.float64) * factor
