"""Numbers, units and names as a person reads them."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import xarray
from numpy.typing import NDArray

from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.shown import Shown, ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError

GREEK = (
    "Gamma", "Lambda", "alpha", "beta", "gamma", "delta", "zeta", "theta", "kappa", "lambda", "mu",
    "xi", "rho", "sigma", "tau", "chi", "psi",
)  # fmt: skip
LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
SUBSCRIPTS = {"inf": r"\infty"}


def words(name: str) -> str:
    """Return an identifier as words."""
    return name.replace("_", " ")


def name_in_words(name: str) -> str:
    """Return an identifier as words, with its numbers as subscripts."""
    return re.sub(r" (\d+)\b", lambda found: found[1].translate(LOWERED), words(name))


def shown_in(array: xarray.DataArray, units: ShownUnits) -> Shown:
    """Return the unit in which an array's values are shown, and the factor to it.

    It depends on the largest finite size.
    """
    values = np.abs(np.asarray(array.values, dtype=np.float64))
    largest = float(values[np.isfinite(values)].max(initial=0.0))
    return units.of(str(array.attrs.get("units", "1")), largest)


def units_of(dataset: xarray.Dataset, asked: Sequence[str] | str | None) -> ShownUnits:
    """Return the units in which a picture shows values: those asked for, else those of the study.

    `asked` are names such as `m/min`, as a list or separated by commas, or None.

    Raises
    ------
    PlotError
        If a name is not a unit.
    """
    words = dataset.attrs.get("shown_units", "") if asked is None else asked
    listed = words.split(",") if isinstance(words, str) else list(words)
    try:
        return read_shown(word for word in listed if word.strip())
    except UnitError as error:
        raise PlotError("units", error.message, error.fix) from None


def number(value: float, digits: int = 6) -> str:
    """Return a number with the significant digits it needs, at most `digits`."""
    return f"{value + 0.0:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def with_unit(text: str, unit: str) -> str:
    """Return a number with its unit, separated by a non-breaking space."""
    return text + unit if unit in ("", "°") else f"{text}\N{NO-BREAK SPACE}{unit}"


def math_symbol(symbol: str) -> str:
    r"""Return a symbol of a quantity as mathematical text, as in `mu_s`; empty for an expression.

    The result is in matplotlib's notation, as in ``$\mu_{\mathrm{s}}$``, for labels of axes.
    """
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


def short_label(array: xarray.DataArray, unit: str) -> str:
    """Return symbol and unit of an output for a narrow axis, or its long name without a symbol.

    `array` has these as attributes; `unit` is that in which its values are shown.
    """
    symbol = math_symbol(str(array.attrs.get("symbol", "")))
    return (
        " ".join(part for part in (symbol, in_brackets(unit)) if part)
        if symbol
        else (axis_label(array, unit))
    )


def demand_in_words(array: xarray.DataArray, units: ShownUnits) -> str:
    """Return in words the demand whose probability an array has; empty for other arrays.

    An example is "Probability of conveying velocity at least 80 mm/s". Output and bounds stand in
    the attributes of the array; `units` are those that the reader wants.
    """
    name, attributes = str(array.name), array.attrs
    if not name.startswith("probability_") or "output" not in attributes:
        return ""
    output = QUANTITIES[str(attributes["output"])]
    ends = {key: float(attributes[key]) for key in ("at_least", "at_most") if key in attributes}
    shown = units.of(output.unit, max(map(abs, ends.values()), default=0.0))
    bounds = " and ".join(
        f"{words(key)} {with_unit(number(shown.factor * end, 4), shown.unit)}"
        for key, end in ends.items()
    )
    what = "Error of the probability" if name.endswith("_error") else "Probability"
    return f"{what} of {in_sentence(output.label)} {bounds}".rstrip()


def in_brackets(unit: str) -> str:
    """Return a unit in brackets; empty without a unit."""
    return f"({unit})" if unit else ""


def scaled(array: xarray.DataArray, factor: float) -> NDArray[np.float64]:
    """Return values multiplied by a unit's factor."""
    return np.asarray(array.values, dtype=np.float64) * factor
