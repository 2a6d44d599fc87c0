"""Bands of speeds in a result, in words and digits: those that the band leaves, and no others."""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from vibrafeed.core.dataset.table import Table, TableVariable, percent
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.flags import SIGNS

BAND: Final = "band"
"""The attribute of a fixed parameter with the ends between which it is known."""
ENDS: Final = ("least", "most")
"""The ends of the names of variables with the least and the largest value of an output."""
UNSETTLED: Final = "sign_unsettled"
"""The variable that tells where a speed changes its direction within the band."""


def band_in_words(name: str, low: float, high: float) -> str:
    """Return a parameter and its ends: ``friction 0.2 to 0.4``."""
    return f"{name.replace('_', ' ')} {low:g} to {high:g}{QUANTITIES[name].suffix}"


def known_between(coordinates: Mapping[str, TableVariable]) -> str:
    """Return the parameter of a result that has a band, with its ends; empty without one."""
    for name, variable in coordinates.items():
        if BAND in variable.attributes:
            low, high = (float(end) for end in variable.attributes[BAND])
            return band_in_words(name, low, high)
    return ""


def band_widths(table: Table) -> dict[str, float]:
    """Return the median width of the band of each output, for it and for both ends."""
    widths: dict[str, float] = {}
    for name in table.variables:
        names = [name, *(f"{name}_{end}" for end in ENDS)]
        if all(each in table.variables for each in names):
            lower, upper = (table.variables[each].values for each in names[1:])
            finite_widths = (upper - lower)[np.isfinite(upper - lower)]
            widths |= dict.fromkeys(
                names, float(np.median(finite_widths)) if finite_widths.size else math.nan
            )
    return widths


def rounded(value: float, width: float) -> str:
    """Return a number with the digits that a band leaves: two of its width."""
    if not math.isfinite(value):
        return "-"
    places = 1 - math.floor(math.log10(width)) if math.isfinite(width) and width > 0 else 3
    return f"{round(value, places) + 0.0:.{max(places, 0)}f}"


def sentences_on_bands(table: Table) -> list[str]:
    """Return sentences on the direction of travel over the band of a result; none without one."""
    band_in_text = known_between(table.coordinates)
    if UNSETTLED not in table.variables or not band_in_text:
        return []
    signs, sentences = table.variables[UNSETTLED].values, list[str]()
    for state, text in (
        ("unsettled", "the direction of travel is not settled"),
        ("open", "parts have no mean speed at some values, such as where they run down"),
    ):
        if share := float(np.mean(signs == SIGNS[state].value)):
            in_cells = "" if share == 1 else f", in {percent(share)} of the cells,"
            sentences.append(f"For {band_in_text}{in_cells} {text}.")
    gap = table.coordinates.get("part_gap")
    if "feed_rate" in table.variables and gap is not None and not np.any(gap.values):
        sentences.append("The feed rate is an upper bound: its parts touch, with a part_gap of 0.")
    return sentences
