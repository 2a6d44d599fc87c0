"""The colour scale: levels, colours, and the range of values that is worth showing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.colors import Colormap, Normalize
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from vibrafeed.core.plots.style import RGB, Style

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
