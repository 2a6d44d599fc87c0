"""The look of regimes: one hatch and one colour each, the same in every picture.

Outputs whose numbers stand for words have colours with names, too, and are not drawn as heights.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import flags_of
from vibrafeed.core.plots.pictures import unreadable
from vibrafeed.core.plots.style import LIGHT, RGB, Array, Style, mix, words
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.pictures import FILLS, INKS

VEIL_STRENGTH = 0.45  # opacity of the veil over values that are not valid
HATCH_WIDTH = 0.7  # points
HATCH_STRENGTH = 0.3  # opacity of hatches, below which values have to be readable

# Hatch, width of a line, and the colour of both. Where values hold, regimes of closed forms
# are told apart by sparse dots or by nothing and those of motion by sparse lines, elsewhere by
# dense hatches.
LOOKS = {
    name: (hatch, INKS[name], width)
    for hatch, width, names in (
        (
            "", 1.8,
            "not_assessed contact slip separation sliding apart impact_slip impact rests "
            "resonance several_amplitudes stands no_pass passes blocked neutral"
        ),
        (
            "..", 0.9,
            "stick no_motion no_impact impact_stick tuned_stiff may_topple separating "
            "soft_contact"
        ),
        ("oo", 3.2, "roll"),
        ("///", 1.3, "flight rolls_and_slips"),
        ("\\\\\\", 1.3, "wall_lost"),
        (
            "xxx", 1.3,
            "flight_and_wall_lost two_solutions overlap runaway stalls not_supported"
        ),
        ("o", 0.9, "stopped"),
        ("---", 1.3, "outside_cone no_solution singular unresolved"),
        ("++", 1.3, "invalid_geometry"),
        ("|||", 1.3, "tipping faster_than_track simultaneous"),
        ("..", 1.8, "unbounded overstressed"),
        (".", 1.8, "stick_slip"),
        ("/", 1.8, "hopping tumbles tuned_soft thrown_load unstable_side"),
        ("//", 1.8, "hop_after_hop"),
        ("\\", 1.8, "period_doubled isolation_poor crowded out_of_phase_possible"),
        ("x", 1.8, "aperiodic hits_magnet hunting indeterminate_force"),
    )
    for name in names.split()
}  # fmt: skip
PLAIN = ("", "#8a8a8a", 1.8)

ON_FILL = "#000000"  # what is written on a fill
MOTION = ("stick_slip", "hopping", "hop_after_hop", "period_doubled", "aperiodic")

# What is said of values that do not hold.
NOTES = {
    "runaway": "no mean velocity", "unresolved": "no answer", "rolls_and_slips": "not known",
}  # fmt: skip


NO_VALUE = -1

CATEGORY_FILLS = (
    "stick", "hopping", "hop_after_hop", "stick_slip", "period_doubled", "slip", "no_motion",
    "apart",
)  # fmt: skip
PALE = "#f2f2f2"
LUMINANCE = np.array([0.299, 0.587, 0.114])


@dataclass(frozen=True)
class Look:
    """A regime, or a category of an output, and how it is drawn; `paint` is its fill, if any."""

    value: int
    name: str
    valid: bool
    hatch: str
    colour: str
    width: float
    style: Style = LIGHT
    paint: str = ""

    @property
    def label(self) -> str:
        """The name in words, with what is missing there."""
        note = NOTES.get(self.name)
        return words(self.name) if self.valid or not note else f"{words(self.name)} ({note})"

    @property
    def beyond(self) -> bool:
        """True if closed forms do not describe a part in this regime."""
        return not self.valid and self.name not in NOTES

    @property
    def fill(self) -> RGB:
        """The fill colour on a map."""
        return to_rgb(self.paint) if self.paint else self.tint

    @property
    def tint(self) -> RGB:
        """A pale tint for backgrounds."""
        if self.paint:
            return mix(self.paint, self.style.ground, 0.68)
        return mix(self.colour, self.style.ground, 0.88)

    @property
    def hatch_ink(self) -> RGB:
        """The colour of the hatching on a map."""
        return mix(self.colour, self.style.ink if self.style.dark else self.style.ground, 0.35)


def looks_of(
    regime: xarray.DataArray,
    present: NDArray[np.int64],
    style: Style = LIGHT,
    *,
    exact: bool = False,
) -> list[Look]:
    """Return colours and names of the regimes that occur, ascending by number, to draw them.

    `regime` is the variable that gives each number its name, `present` are the numbers that occur,
    of any shape; with `exact` the output is valid in every regime, and none is hatched.

    Raises
    ------
    PlotError
        If the variable does not say what its numbers mean.
    """
    meanings = flags_of(regime.attrs)
    looks = []
    for value in np.unique(present).tolist():
        if value not in meanings:
            raise unreadable(f"its regime {value} has no name")
        name = meanings[value]
        valid = REGIMES[name].valid if name in REGIMES else True
        hatch, colour, width = LOOKS.get(name, PLAIN)
        if exact and not valid:
            hatch = ""
        paint = FILLS.get(name, "")
        looks.append(Look(value, name, valid or exact, hatch, colour, width, style, paint))
    return looks


def shade(
    axes: Axes,
    x: Array,
    y: Array,
    regimes: NDArray[np.int64],
    faces: Mapping[Look, RGB],
    style: Style,
) -> None:
    """Shade and hatch the regimes in a picture over two axes, and draw the borders between them.

    Where formulas do not hold there is a veil and a dense hatch, and the border is heavy.

    Parameters
    ----------
    x, y : ndarray, shape (n,) and (m,)
        Values of the axes.
    regimes : ndarray, shape (m, n)
        The number of the regime of each cell.
    faces : mapping of Look to RGB
        The colour that each regime has below the shading.
    """
    borders = []
    for look, face in faces.items():
        inside = (regimes == look.value).astype(float)
        borders.append((inside, 1.1, 2.2, 4))
        if look.hatch or not look.valid:
            veil = (*to_rgb(style.ground), 0.0 if look.valid else VEIL_STRENGTH)
            area = axes.contourf(
                x, y, inside, levels=[0.5, 1.5], colors=[veil], hatches=[look.hatch], zorder=2
            )
            ink = (*_ink(look, face), HATCH_STRENGTH)
            area.set(edgecolor=ink, linewidth=0.0, hatch_linewidth=HATCH_WIDTH)
    valid = np.isin(regimes, [look.value for look in faces if look.valid]).astype(float)
    for inside, width, halo, zorder in (*borders, (valid, 2.2, 4.0, 5)):
        if inside.min() < inside.max():
            border = axes.contour(
                x, y, inside, levels=[0.5], colors=[style.ink], linewidths=[style.width(width)],
                zorder=zorder,
            )  # fmt: skip
            around = withStroke(linewidth=style.width(halo), foreground=style.ground)
            border.set_path_effects([around])


def swatch(look: Look, face: RGB, ink: RGB | None = None, *, hatched: bool = True) -> Patch:
    """Return the legend entry of a regime: a patch of the colour `face` with its hatching.

    `ink` is the colour of the hatching, by default that of the look; with `hatched` False there is
    none.
    """
    return Patch(
        facecolor=face, edgecolor=ink or look.hatch_ink, label=look.label, linewidth=0.8,
        hatch=look.hatch if hatched else None, hatch_linewidth=HATCH_WIDTH,
    )  # fmt: skip


def veiled_swatch(look: Look, face: RGB) -> Patch:
    """Return the legend entry of a regime over a face colour, with the veil of invalid values."""
    ground = look.style.ground
    veiled = face if look.valid else mix(face, ground, VEIL_STRENGTH)
    return swatch(look, veiled, mix(veiled, _ink(look, face), 0.6))


def _ink(look: Look, face: RGB) -> RGB:
    if not look.valid:
        return look.hatch_ink if look.style.dark else to_rgb(look.colour)
    return to_rgb("#ffffff" if np.array(face) @ LUMINANCE < 0.5 else "#000000")


def categories_of(array: xarray.DataArray) -> dict[int, str] | None:
    """Return the names that an output's numbers stand for; None if its values are plain numbers.

    Values that are not finite have the number `NO_VALUE`. None, too, if more than eight occur,
    which cannot be told apart in a picture.
    """
    name = str(array.name)
    if "flag_values" in array.attrs:
        names = {value: words(name) for value, name in flags_of(array.attrs).items()}
        other_name = "{}"
    elif name in QUANTITIES and QUANTITIES[name].other_words:
        names, other_name = dict(QUANTITIES[name].words), QUANTITIES[name].other_words
    else:
        return None
    present = np.unique(codes_of(array.values)).tolist()
    if len(present) > 8:
        return None
    names[NO_VALUE] = "no value"
    return {value: names.get(value, other_name.format(value)) for value in present}


def codes_of(values: NDArray[np.generic]) -> NDArray[np.int64]:
    """Return numbers rounded to integers; those that are not finite become `NO_VALUE`."""
    numbers = np.asarray(values, dtype=np.float64)
    finite = np.isfinite(numbers)
    return np.where(finite, np.where(finite, numbers, 0).round(), NO_VALUE).astype(np.int64)


def looks_of_categories(named: Mapping[int, str], style: Style) -> list[Look]:
    """Return the colour and the name of each category of an output, to fill its cells in a map.

    Some outputs have a name in each cell instead of a number, which files hold as numbers. `named`
    has the names by number, ascending. "No value" is pale.
    """
    looks = []
    for value, name in named.items():
        paint = PALE if value == NO_VALUE else FILLS[CATEGORY_FILLS[value % len(CATEGORY_FILLS)]]
        looks.append(Look(value, name, True, "", paint, 1.8, style, paint))
    return looks
