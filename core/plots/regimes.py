"""How regimes look: one hatch and one colour each, the same in every picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from core.plots.problem import PlotError
from core.plots.text import words
from core.quantities import REGIMES

RGB = tuple[float, float, float]

VEIL = "#ffffff"
VEIL_STRENGTH = 0.55
EDGE = "#000000"  # the border of what the closed forms describe
HATCH_WIDTH = 0.7

# Where the closed forms hold, regimes are told apart by sparse dots or none; elsewhere by lines.
LOOKS = {
    "not_assessed": ("", "#b0b0b0"),
    "contact": ("", "#4d9221"),
    "stick": ("...", "#2166ac"),
    "slip": ("", "#4d9221"),
    "roll": ("oo", "#01665e"),
    "flight": ("///", "#4a4a4a"),
    "wall_lost": ("\\\\\\", "#a63603"),
    "flight_and_wall_lost": ("xxx", "#54278f"),
    "no_motion": ("..", "#2166ac"),
    "stopped": ("..", "#5e3c99"),
    "outside_cone": ("---", "#4a4a4a"),
    "invalid_geometry": ("+++", "#4a4a4a"),
    "tipping": ("|||", "#a63603"),
    "faster_than_track": ("|||", "#54278f"),
    "unbounded": ("**", "#777777"),
}
PLAIN = ("", "#b0b0b0")


@dataclass(frozen=True)
class Look:
    """A regime and how it is drawn."""

    value: int
    name: str
    valid: bool
    hatch: str
    colour: str

    @property
    def label(self) -> str:
        """Its name in words, and whether the closed forms hold."""
        return words(self.name) if self.valid else f"{words(self.name)} (closed forms do not hold)"

    @property
    def tint(self) -> RGB:
        """A pale form of its colour, for backgrounds."""
        return mix(self.colour, VEIL, 0.88)


def mix(colour: str | RGB, other: str | RGB, share: float) -> RGB:
    """Return a colour with a share of another."""
    red, green, blue = (
        (1 - share) * a + share * b for a, b in zip(to_rgb(colour), to_rgb(other), strict=True)
    )
    return red, green, blue


def looks_of(regime: xarray.DataArray, present: NDArray[np.int64]) -> list[Look]:
    """Return the looks of the regimes that occur, by the flags of the variable `regime`.

    Raises
    ------
    PlotError
        If the variable does not say what its numbers mean.
    """
    numbers = np.atleast_1d(regime.attrs.get("flag_values", [])).tolist()
    names = str(regime.attrs.get("flag_meanings", "")).split()
    meanings = dict(zip(numbers, names, strict=False))
    found = []
    for value in np.unique(present).tolist():
        if value not in meanings:
            message = f"its regime {value} has no name"
            raise PlotError("dataset", message, "Draw a file that `vibrafeed run` wrote")
        name = meanings[value]
        valid = REGIMES[name].valid if name in REGIMES else True
        found.append(Look(value, name, valid, *LOOKS.get(name, PLAIN)))
    return found


def shade(
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    regimes: NDArray[np.int64],
    looks: Iterable[Look],
) -> None:
    """Veil and hatch the regimes of a plane, arrays (y, x), and draw their borders."""
    for look in looks:
        inside = (regimes == look.value).astype(float)
        if look.hatch or not look.valid:
            veil = (*to_rgb(VEIL), 0.0 if look.valid else VEIL_STRENGTH)
            area = axes.contourf(
                x, y, inside, levels=[0.5, 1.5], colors=[veil], hatches=[look.hatch], zorder=2
            )
            area.set_edgecolor((*to_rgb(look.colour), 0.45))
            area.set_linewidth(0.0)
            area.set_hatch_linewidth(HATCH_WIDTH)
        if inside.min() < inside.max():
            axes.contour(x, y, inside, levels=[0.5], colors=[EDGE], linewidths=[0.9], zorder=4)
    valid = np.isin(regimes, [look.value for look in looks if look.valid]).astype(float)
    if valid.min() < valid.max():
        border = axes.contour(x, y, valid, levels=[0.5], colors=[EDGE], linewidths=[2.4], zorder=5)
        border.set_path_effects([withStroke(linewidth=5.0, foreground=VEIL)])


def swatch(look: Look, face: RGB, *, hatched: bool = True) -> Patch:
    """Return the legend entry of a regime."""
    patch = Patch(facecolor=face, edgecolor=mix(look.colour, VEIL, 0.3), label=look.label)
    patch.set_linewidth(0.8)
    if hatched:
        patch.set_hatch(look.hatch)
        patch.set_hatch_linewidth(HATCH_WIDTH)
    return patch


def veiled(look: Look, face: RGB) -> RGB:
    """Return a colour as it is seen in a regime."""
    return face if look.valid else mix(face, VEIL, VEIL_STRENGTH)
