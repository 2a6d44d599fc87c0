"""Outputs whose numbers stand for words: they are drawn as colours with names, not as heights."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import flags_of
from vibrafeed.core.plots.regimes import Look
from vibrafeed.core.plots.style import Style
from vibrafeed.core.plots.text import words
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.pictures import FILLS

MOST = 8  # categories of a picture; more are drawn as numbers
NO_VALUE = -1

COLOURS = (
    "stick", "hopping", "hop_after_hop", "stick_slip", "period_doubled", "slip", "no_motion",
    "apart",
)  # fmt: skip
PALE = "#f2f2f2"


def categories_of(array: xarray.DataArray) -> dict[int, str] | None:
    """Return the names that an output's numbers stand for; None if its values are plain numbers.

    Values that are not finite have the number `NO_VALUE`. None, too, if more than eight occur,
    which cannot be told apart in a picture.
    """
    name = str(array.name)
    if "flag_values" in array.attrs:
        named = {value: words(name) for value, name in flags_of(array.attrs).items()}
        other = "{}"
    elif name in QUANTITIES and QUANTITIES[name].other_words:
        named, other = dict(QUANTITIES[name].words), QUANTITIES[name].other_words
    else:
        return None
    present = np.unique(codes_of(array.values)).tolist()
    if len(present) > MOST:
        return None
    named[NO_VALUE] = "no value"
    return {value: named.get(value, other.format(value)) for value in present}


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
        paint = PALE if value == NO_VALUE else FILLS[COLOURS[value % len(COLOURS)]]
        looks.append(Look(value, name, True, "", paint, 1.8, style, paint))
    return looks
