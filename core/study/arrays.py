"""Arrays and quantities of other libraries, taken apart: numbers, units and dimensions.

The libraries are not loaded here: who hands over their objects has loaded them.
"""

from __future__ import annotations

import re
from typing import Any

UNITS = ("units", "unit")  # attributes of labelled arrays; CF has the first
PACKED = ("scale_factor", "add_offset")  # attributes of arrays whose numbers are not decoded
_BARE = re.compile(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*")
_NAMELESS = re.compile(r"dim_\d+")


def apart(value: Any) -> tuple[Any, str]:
    """Return the numbers of an array or quantity, and the unit that it carries, if any.

    Parameters
    ----------
    value : object
        A data array of xarray with the attribute `units` or a quantity of pint inside, a column of
        pandas, an array of numpy, a quantity of pint, astropy or unyt; or anything else, which is
        returned as it is.

    Returns
    -------
    numbers : object
        An array or scalar of numpy where the value was one, or had a method `to_numpy`.
    unit : str
        In words that `vibrafeed.core.study.units` reads; empty where the value carries none.
    """
    unit = ""
    if hasattr(value, "to_numpy"):
        unit = _labelled_unit(value)
        inside = getattr(value, "data", None)  # before to_numpy, which would lose the unit
        value = inside if _unit_of(inside) is not None else value.to_numpy()
    if (own := _unit_of(value)) is not None:
        unit = _unit_text(own)
        value = value.magnitude if hasattr(value, "magnitude") else value.value
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if kind == "m":
        return value.astype("m8[ns]").astype(float) / 1e9, "s"
    if kind == "M":  # else a list of it holds plain numbers
        return value.astype(str), ""
    return value, unit


def as_typed(value: Any) -> Any:
    """Return a scalar of another library as a number, or as text with the unit that it carries.

    Anything else is returned as it is.
    """
    number, unit = apart(value)
    if getattr(number, "ndim", None) == 0:
        number = number.item()
    return with_own_unit(number, unit)


def with_own_unit(number: Any, unit: str) -> Any:
    """Return a number, or the text of one, with its unit as text; as it is if the unit is empty."""
    if isinstance(number, str) and _BARE.fullmatch(number):
        return f"{number} {unit}".strip()
    return f"{number!r} {unit}" if unit and isinstance(number, int | float) else number


def dimension_of(value: Any) -> str:
    """Return the name of the dimension of a labelled array; empty without one.

    It is that of a data array of xarray, or the name of the index of a pandas column.
    """
    dims = getattr(value, "dims", None)
    if isinstance(dims, tuple) and len(dims) == 1:
        return "" if _NAMELESS.fullmatch(str(dims[0])) else str(dims[0])
    return str(getattr(getattr(value, "index", None), "name", None) or "")


def is_packed(value: Any) -> bool:
    """True for a labelled array whose numbers have to be decoded: xarray read it without."""
    attributes = getattr(value, "attrs", None)
    return isinstance(attributes, dict) and any(name in attributes for name in PACKED)


def _labelled_unit(value: Any) -> str:
    """Return the unit that the attributes, the index or the type of a labelled array have."""
    written = getattr(value, "attrs", None) or {}
    attributes = {str(name).casefold(): unit for name, unit in written.items()}
    indexes = getattr(value, "xindexes", None) or {}  # of pint-xarray: coordinates keep it there
    in_index = [getattr(index, "units", None) or {} for index in indexes.values()]
    carried = [
        *(attributes.get(name) for name in UNITS),
        *(units.get(value.name) for units in in_index if isinstance(units, dict)),
        getattr(getattr(value, "dtype", None), "units", None),  # of pint-pandas
    ]
    return next((text for unit in carried if (text := _unit_text(unit))), "")


def _unit_of(value: Any) -> Any:
    """Return the unit of a quantity of pint, astropy or unyt, of any shape; else None."""
    if not (hasattr(value, "magnitude") or hasattr(value, "value")):
        return None
    unit = getattr(value, "units", getattr(value, "unit", None))
    return None if isinstance(unit, str) else unit


def _unit_text(unit: Any) -> str:
    """Return a unit of a library as text, of pint with full names: its short ones mean two things.

    pint has "g" for the gram, which is standard gravity where an acceleration is asked for.
    """
    one: Any = 1 * unit if hasattr(unit, "dimensionality") else None
    if not hasattr(one, "unit_items"):
        return "" if unit is None else str(unit).strip()
    powers = dict(one.unit_items()).items()
    factors = [name if power == 1 else f"{name}**{power:g}" for name, power in powers]
    return "*".join(factors) or "dimensionless"
