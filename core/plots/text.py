"""Numbers, units and names as a person reads them."""

from __future__ import annotations

import re

import numpy as np
import xarray
from numpy.typing import NDArray

UNITS = {
    "1": "",
    "degree": "°",
    "m s-1": "m/s",
    "m s-2": "m/s²",
    "rad s-1": "rad/s",
    "rad s-2": "rad/s²",
}
SMALL_UNITS = {"m": "mm", "s": "ms", "kg": "g", "N": "mN"}
SMALL = 0.1  # values all below this are read in the thousandth
GREEK = (
    "Gamma", "Lambda", "alpha", "beta", "gamma", "delta", "zeta", "theta", "kappa", "lambda", "mu",
    "xi", "rho", "sigma", "tau", "chi", "psi",
)  # fmt: skip
SUBSCRIPTS = {"inf": r"\infty"}


def words(name: str) -> str:
    """Return a name of the code in words."""
    return name.replace("_", " ")


def read_unit(array: xarray.DataArray) -> tuple[float, str]:
    """Return the factor to the unit in which a person reads the values, and that unit."""
    unit = str(array.attrs.get("units", "1"))
    values = np.abs(np.asarray(array.values, dtype=np.float64))
    finite = values[np.isfinite(values)]
    if unit in SMALL_UNITS and 0 < finite.max(initial=0) < SMALL:
        return 1000.0, SMALL_UNITS[unit]
    return 1.0, UNITS.get(unit, unit)


def number(value: float, digits: int = 6) -> str:
    """Return a number with the significant digits it needs, at most `digits`."""
    return f"{value + 0.0:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def with_unit(text: str, unit: str) -> str:
    """Return a number and its unit, which a line break does not part."""
    return text + unit if unit in ("", "°") else f"{text}\N{NO-BREAK SPACE}{unit}"


def math_symbol(symbol: str) -> str:
    """Return a symbol as mathematical text; empty if it is an expression or unknown."""
    match = re.fullmatch("(" + "|".join(GREEK) + r"|[A-Za-z])_?(\d|[a-z]+)?", symbol)
    if not match:
        return ""
    base, below = match.groups()
    base = f"\\{base}" if base in GREEK else base
    below = SUBSCRIPTS.get(below, rf"\mathrm{{{below}}}") if below else ""
    return f"${base}_{{{below}}}$" if below else f"${base}$"


def long_name(array: xarray.DataArray) -> str:
    """Return the long name of a variable, or its name in words."""
    return str(array.attrs.get("long_name", words(str(array.name))))


def axis_label(array: xarray.DataArray, unit: str) -> str:
    """Return the label of an axis: long name, symbol, unit."""
    parts = (long_name(array), math_symbol(str(array.attrs.get("symbol", ""))), in_brackets(unit))
    return " ".join(part for part in parts if part)


def short_label(array: xarray.DataArray, unit: str) -> str:
    """Return symbol and unit, where the long name stands elsewhere."""
    symbol = math_symbol(str(array.attrs.get("symbol", "")))
    return " ".join(part for part in (symbol, in_brackets(unit) if symbol else unit) if part)


def in_brackets(unit: str) -> str:
    """Return a unit in brackets; empty without a unit."""
    return f"({unit})" if unit else ""


def scaled(array: xarray.DataArray, factor: float) -> NDArray[np.float64]:
    """Return values times the factor of `read_unit`."""
    return np.asarray(array.values, dtype=np.float64) * factor
