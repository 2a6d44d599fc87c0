"""How regimes look: one hatch and one colour each, the same in every picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from core.plots.islands import without_specks
from core.plots.problem import PlotError
from core.plots.text import words
from core.quantities import REGIMES

RGB = tuple[float, float, float]

VEIL = "#ffffff"
VEIL_STRENGTH = 0.55
EDGE = "#000000"  # the border of what the closed forms describe
HATCH_WIDTH = 0.7
HATCH_STRENGTH = 0.5
LINE_STRENGTH = 0.3  # beside contours, which are lines too

# Hatch, colour of hatches and borders, width of a line. Where values hold, regimes of closed forms
# are told apart by sparse dots or by nothing and those of motion by sparse lines, elsewhere by
# dense hatches.
LOOKS = {
    "not_assessed": ("", "#8a8a8a", 1.8),
    "contact": ("", "#4d9221", 1.8),
    "stick": ("..", "#2166ac", 0.9),
    "slip": ("", "#4d9221", 1.8),
    "roll": ("oo", "#01665e", 3.2),
    "flight": ("///", "#4a4a4a", 1.3),
    "wall_lost": ("\\\\\\", "#b3560f", 1.3),
    "flight_and_wall_lost": ("xxx", "#5e2d91", 1.3),
    "no_motion": ("..", "#2166ac", 0.9),
    "stopped": ("o", "#5e3c99", 0.9),
    "outside_cone": ("---", "#9b1b5a", 1.3),
    "invalid_geometry": ("++", "#6b5d00", 1.3),
    "tipping": ("|||", "#8b1a1a", 1.3),
    "faster_than_track": ("|||", "#00696b", 1.3),
    "unbounded": ("..", "#777777", 1.8),
    "separation": ("", "#8a7a1f", 1.8),
    "sliding": ("", "#4d9221", 1.8),
    "two_solutions": ("xxx", "#5e2d91", 1.3),
    "no_solution": ("---", "#9b1b5a", 1.3),
    "apart": ("", "#8a8a8a", 1.8),
    "overlap": ("xxx", "#6b5d00", 1.3),
    "no_impact": ("..", "#2166ac", 0.9),
    "impact_stick": ("..", "#01665e", 0.9),
    "impact_slip": ("", "#4d9221", 1.8),
    "simultaneous": ("|||", "#8b1a1a", 1.3),
    "impact": ("", "#b3560f", 1.8),
    "singular": ("---", "#9b1b5a", 1.3),
    # --- motion in time
    "stick_slip": (".", "#01806a", 1.8),
    "hopping": ("/", "#8a7a1f", 1.8),
    "hop_after_hop": ("//", "#b3560f", 1.8),
    "period_doubled": ("\\", "#a8325e", 1.8),
    "aperiodic": ("x", "#5a4580", 1.8),
    "runaway": ("xxx", "#8b1a1a", 1.3),
    "unresolved": ("---", "#4a4a4a", 1.3),
    "rests": ("", "#2166ac", 1.8),
    "tumbles": ("/", "#b3560f", 1.8),
}
PLAIN = ("", "#8a8a8a", 1.8)

# Fills of a map, near the light scheme of P. Tol: told apart in every kind of colour vision, and
# black text is read on all of them. Regimes that share one do not occur in one scene. Where values
# do not hold, a map is pale and hatched.
FILLS = {
    "stick": "#88ccee",
    "no_motion": "#9a86b8",
    "no_impact": "#88ccee",
    "slip": "#bbcc33",
    "sliding": "#bbcc33",
    "impact_slip": "#bbcc33",
    "roll": "#33a888",
    "stick_slip": "#33a888",
    "impact_stick": "#33a888",
    "hopping": "#eedd88",
    "separation": "#eedd88",
    "hop_after_hop": "#ee8866",
    "impact": "#ee8866",
    "period_doubled": "#ffb3c4",
    "stopped": "#ffb3c4",
    "aperiodic": "#9a86b8",
    "rests": "#88ccee",
    "tumbles": "#ee8866",
    "contact": "#f4f4f4",
    "apart": "#dddddd",
    "not_assessed": "#dddddd",
    "unbounded": "#e6e6fa",
}
MOTION = ("stick_slip", "hopping", "hop_after_hop", "period_doubled", "aperiodic")

# What is said of values that do not hold.
NOTES = {"runaway": "no mean velocity", "unresolved": "no answer"}
NOTE = "closed forms invalid"


@dataclass(frozen=True)
class Look:
    """A regime and how it is drawn."""

    value: int
    name: str
    valid: bool
    hatch: str
    colour: str
    width: float

    @property
    def label(self) -> str:
        """Its name in words, and why its values do not hold, if so."""
        note = NOTES.get(self.name, NOTE)
        return words(self.name) if self.valid else f"{words(self.name)} ({note})"

    @property
    def fill(self) -> RGB:
        """Its colour on a map."""
        return to_rgb(FILLS[self.name]) if self.name in FILLS else self.tint

    @property
    def tint(self) -> RGB:
        """A pale form of its colour, for backgrounds."""
        if self.name in MOTION:
            return mix(FILLS[self.name], VEIL, 0.6)
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
    faces: Mapping[Look, RGB],
) -> None:
    """Veil and hatch the regimes of a plane, arrays (y, x), and draw their borders.

    `faces` are the colours that lie below.
    """
    bordered = without_specks(regimes)
    for look, face in faces.items():
        inside = (regimes == look.value).astype(float)
        if look.hatch or not look.valid:
            veil = (*to_rgb(VEIL), 0.0 if look.valid else VEIL_STRENGTH)
            area = axes.contourf(
                x, y, inside, levels=[0.5, 1.5], colors=[veil], hatches=[look.hatch], zorder=2
            )
            strength = LINE_STRENGTH if look.name in MOTION else HATCH_STRENGTH
            area.set_edgecolor((*_ink(look, face), strength))
            area.set_linewidth(0.0)
            area.set_hatch_linewidth(HATCH_WIDTH)
        inside = (bordered == look.value).astype(float)
        if inside.min() < inside.max():
            axes.contour(x, y, inside, levels=[0.5], colors=[EDGE], linewidths=[0.9], zorder=4)
    valid = np.isin(regimes, [look.value for look in faces if look.valid]).astype(float)
    if valid.min() < valid.max():
        border = axes.contour(x, y, valid, levels=[0.5], colors=[EDGE], linewidths=[2.2], zorder=5)
        border.set_path_effects([withStroke(linewidth=4.0, foreground=VEIL)])


def swatch(look: Look, face: RGB, ink: RGB | None = None, *, hatched: bool = True) -> Patch:
    """Return the legend entry of a regime; `face` is the colour in which it is seen."""
    patch = Patch(facecolor=face, edgecolor=ink or mix(look.colour, VEIL, 0.3), label=look.label)
    patch.set_linewidth(0.8)
    if hatched:
        patch.set_hatch(look.hatch)
        patch.set_hatch_linewidth(HATCH_WIDTH)
    return patch


def veiled_swatch(look: Look, face: RGB) -> Patch:
    """Return the legend entry of a regime over a colour, as `shade` draws it."""
    seen = face if look.valid else mix(face, VEIL, VEIL_STRENGTH)
    return swatch(look, seen, mix(seen, _ink(look, face), 0.7))


def luminance(colours: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how bright colours are, 0 to 1, shape (n,) for (n, 3)."""
    return colours @ np.array([0.299, 0.587, 0.114])


def _ink(look: Look, face: RGB) -> RGB:
    """Return the colour of a hatch: the regime's on a veil, else what stands out."""
    if not look.valid:
        return to_rgb(look.colour)
    return to_rgb("#ffffff" if luminance(np.array(face)) < 0.5 else "#000000")
