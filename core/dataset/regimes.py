"""Words of flags, the share of cells in each regime, and its text for console and pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.quantities import REGIMES


def regime_shares(regimes: NDArray[np.integer]) -> dict[str, float]:
    """Return the share of cells in each regime that occurs, 0 to 1, in the order of flag values.

    Every cell counts equally, whatever the spacing of the axes.

    Parameters
    ----------
    regimes : ndarray of int
        Values of a variable `regime`, any shape.
    """
    numbers, counts = np.unique(regimes, return_counts=True)
    return shares_of(dict(zip(numbers.tolist(), counts.tolist(), strict=True)))


def shares_of(counts: Mapping[int, int]) -> dict[str, float]:
    """Return the share of cells in each regime that occurs, 0 to 1, by name of the regime.

    `counts` holds the number of cells by the integer value of a regime in results, its flag. The
    order of the result is that of these integers.
    """
    whole = sum(counts.values())
    return {
        name: counts[regime.value] / whole
        for name, regime in sorted(REGIMES.items(), key=lambda entry: entry[1].value)
        if counts.get(regime.value)
    }


def flags_of(attributes: Mapping[Any, Any]) -> dict[int, str]:
    """Return the word of each value of a flag variable, such as {1: "stick"}, by its CF attributes.

    The attributes are `flag_values` and `flag_meanings`; a variable without them has no words.
    """
    numbers = np.atleast_1d(attributes.get("flag_values", [])).tolist()
    return dict(zip(numbers, str(attributes.get("flag_meanings", "")).split(), strict=False))


def percent_with_error(share: float, error: float | None) -> str:
    """Return a sampled share in per cent with its error, rounded to the error.

    Both are from 0 to 1. An error of 0.27 % leaves one decimal, `92.2 % ± 0.3 %`; without an error
    there is one, too. A share that is NaN becomes a dash.
    """
    if not math.isfinite(share):
        return "-"
    decimals = 1
    if error is not None and math.isfinite(error) and error > 0:
        decimals = min(max(-math.floor(math.log10(100 * error)), 0), 3)
    text = f"{100 * share + 0.0:.{decimals}f}"
    text = text.removeprefix("-") if not float(text) else text
    return f"{text} %" if error is None else f"{text} % ± {100 * error:.{decimals}f} %"


def percent(share: float) -> str:
    """Return a share in per cent as text, with one more digit if it is small."""
    if share < 0.0005:
        return "< 0.1\N{NO-BREAK SPACE}%"
    return f"{100 * share:.{1 if share < 0.0995 else 0}f}\N{NO-BREAK SPACE}%"
