"""Regimes of a result: which one judges an output, where they are valid, shares of cells, words."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.flags import is_regime

_VALID = np.zeros(256, dtype=np.bool_)
_VALID[[flag.value for flag in REGIMES.values() if flag.valid]] = True


def judge_of(attributes: Mapping[Any, Any], names: Container[Any]) -> str | None:
    """Return the name of the variable whose regimes judge an output; None if it always holds.

    It is the one that `ancillary_variables` of the output names.

    Parameters
    ----------
    attributes : mapping
        The attributes of the output.
    names : container of str
        The variables of the result.
    """
    linked = str(attributes.get("ancillary_variables", "")).split()
    found = [name for name in linked if is_regime(name) and name in names]
    return found[0] if found else None


def is_valid(regimes: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Return a mask of the cells whose regime describes a real part, of the same shape."""
    return _VALID[regimes]


def regime_shares(regimes: NDArray[np.integer]) -> dict[str, float]:
    """Return the share of cells in each regime that occurs, 0 to 1, in the order of flag values.

    Every cell counts equally, whatever the spacing of the axes.

    Parameters
    ----------
    regimes : ndarray of int
        Values of a variable `regime`, any shape.
    """
    return shares_of(regime_counts(regimes))


def regime_counts(regimes: NDArray[np.integer]) -> dict[str, int]:
    """Return the number of cells in each regime that occurs, by name, in the order of the flags."""
    numbers, counts = np.unique(regimes, return_counts=True)
    names = {flag.value: name for name, flag in REGIMES.items()}
    return {names[n]: c for n, c in zip(numbers.tolist(), counts.tolist(), strict=True)}


def shares_of(counts: Mapping[str, int]) -> dict[str, float]:
    """Return the share of cells in each regime that occurs, by name, from their numbers."""
    whole = sum(counts.values())
    return {name: count / whole for name, count in counts.items() if count}


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
    """Return a share in per cent as text, with one more digit if it is small or nearly all."""
    if share < 0.0005:
        return "< 0.1\N{NO-BREAK SPACE}%"
    if 0.9945 <= share < 1:
        return f"{min(100 * share, 99.9):.1f}\N{NO-BREAK SPACE}%"
    return f"{100 * share:.{1 if share < 0.0995 else 0}f}\N{NO-BREAK SPACE}%"
