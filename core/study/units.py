"""Units, read once: text such as ``"0.5 mm"`` becomes a number in the quantity's own unit."""

import functools
import math
import re
import reprlib
import sys
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Final

from vibrafeed.core.errors import Problem
from vibrafeed.core.quantities import Quantity

# --- Words for units that studies are usually written in: one table, read without pint.
#
# pint knows thousands more, and takes half a second to load; it agrees with this table (a test).

Dimensions = tuple[int, ...]
"""Exponents of metre, kilogram, second, ampere and radian."""

PI: Final = Fraction("3.1415926535897932384626433832795028841971693993751")
"""pi to the digits of pint."""

_NONE = (0, 0, 0, 0, 0)
_SIZES: Final[tuple[tuple[Dimensions, dict[str, Fraction | str | int]], ...]] = (
    ((1, 0, 0, 0, 0), {"m": 1, "mm": "1e-3", "cm": "1e-2", "km": 1000, "um": "1e-6",
                       "μm": "1e-6", "in": "0.0254", "inch": "0.0254"}),
    ((0, 1, 0, 0, 0), {"kg": 1, "g": "1e-3", "mg": "1e-6"}),
    ((0, 0, 1, 0, 0), {"s": 1, "ms": "1e-3", "us": "1e-6", "μs": "1e-6", "min": 60,
                       "h": 3600}),
    ((0, 0, -1, 0, 0), {"Hz": 1, "kHz": 1000, "MHz": 10**6}),
    (_NONE, {"count": 1}),
    ((0, 0, 0, 0, 1), {"rad": 1, "mrad": "1e-3", "deg": PI / 180, "degree": PI / 180,
                       "°": PI / 180}),
    ((0, 0, -1, 0, 1), {"rpm": PI / 30}),
    ((1, 0, -2, 0, 0), {"standard_gravity": "9.80665",
                        "millistandard_gravity": "9.80665e-3"}),
    ((1, 1, -2, 0, 0), {"N": 1, "mN": "1e-3", "kN": 1000}),
    ((-1, 1, -2, 0, 0), {"Pa": 1, "kPa": 1000, "MPa": 10**6, "GPa": 10**9}),
    ((2, 1, -2, 0, 0), {"J": 1, "mJ": "1e-3"}),
    ((2, 1, -3, 0, 0), {"W": 1, "mW": "1e-3"}),
    ((0, 1, -2, -1, 0), {"T": 1, "mT": "1e-3"}),
    ((2, 1, -3, -1, 0), {"V": 1, "mV": "1e-3"}),
)  # fmt: skip
WORDS: Final = MappingProxyType(
    {word: (Fraction(size), kind) for kind, words in _SIZES for word, size in words.items()}
)
"""Each word with its size in SI and its dimensions."""

_FACTOR = re.compile(r"(\s?[*/]\s?|\s)?([A-Za-zμ°_]+)(?:(?:\*\*|\^)(-?[1-9]))?")


def factor_between(text: str, own: str) -> Fraction | None:
    """Return the exact factor from one unit to another of the same dimensions, by `WORDS` alone.

    Both are in pint's notation, as in ``kg m**2/s``. None if a word is unknown, the notation is
    another (brackets), or the dimensions differ.
    """
    unit, goal = _read(text), _read(own)
    return unit[0] / goal[0] if unit and goal and unit[1] == goal[1] else None


@lru_cache(512)
def _read(text: str) -> tuple[Fraction, Dimensions] | None:
    # The size in SI units and the exponents of the dimensions; None if a word is unknown.
    size, dimensions = Fraction(1), list(_NONE)
    start = 1 if re.match(r"1(?=\s?/|$)", text) else 0
    while start < len(text):
        match = _FACTOR.match(text, start)
        if match is None or match[2] not in WORDS or (not match[1]) != (start == 0):
            return None
        power = int(match[3] or 1) * (-1 if "/" in (match[1] or "") else 1)
        factor, exponents = WORDS[match[2]]
        size *= factor**power
        dimensions = [
            total + power * exponent for total, exponent in zip(dimensions, exponents, strict=True)
        ]
        start = match.end()
    return size, tuple(dimensions)


PERCENT = "%"
MAX_LETTERS = 200  # characters of a value with its unit
MAX_UNITS = 10  # units in the values of one list: looking one up takes long

_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*(.*?)\s*")
BARE_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(?![\d.])")

# Signs of word processors, PDF files and keyboards, and the ones that are meant: the minus sign,
# hyphens and the en dash; dots and the cross of a product; the ordinal and the ring for a degree;
# the slash of a division; the micro sign for the Greek letter.
_SIGNS = str.maketrans(
    {**dict.fromkeys("\u2212\u2010\u2011\u2013\ufe63\uff0d", "-"),
     **dict.fromkeys("\u00b7\u22c5\u2219\u2022\u00d7", "*"),
     **dict.fromkeys("\u00ba\u02da", "°"), "\u2215": "/", "\u00b5": "μ"}
)  # fmt: skip
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻", "0123456789+-")
_UNIT = re.compile(r"(?:1\s?/\s?)?[A-Za-zμ°(][A-Za-z0-9_ μ°*/^().-]{0,60}")
# Powers are exact, and as long as their exponents are high: "mm**99999999" would take hours.
_POWER = re.compile(r"(?<![)\s])\s?(?:\*\*|\^)\s?-?\d(?![\w.]|\s?(?:\*\*|\^))")
_HIGH_POWER = re.compile(r"\*\*|\^|[\d.][eE]")

# What a rate counts is no unit. pint has a revolution for 2 pi radians, and so rpm and rps.
_COUNTED = {
    "Hz": re.compile(
        r"\b(r|revs?|revolutions?|turns?|cycles?|vibs?|vibrations?|strokes?|samples?)\b"
    ),
    "min-1": re.compile(r"\b(parts?|pcs?|pieces?)\b"),
}
_RATES = {
    "Hz": dict.fromkeys(("rpm", "vpm", "cpm", "spm", "revolutions_per_minute"), "count/min")
    | dict.fromkeys(("rps", "cps", "sps"), "count/s"),
    "min-1": {"ppm": "count/min"},
}
# "g" is the gram of a mass and the standard gravity of an acceleration; loggers also write "G".
_GRAVITY = re.compile(r"([mμu]?)(?:[gG]s?|g_?n|g's)")
_PREFIXES = {"": "", "m": "milli", "μ": "micro", "u": "micro"}
_JOINED = re.compile(r"([mc]?m)s(?:\*\*|\^)?(-[1-3])")  # "ms-2", as m s-2 is often written


class UnitError(ValueError):
    """A text is not a value of the quantity; `message` and `fix` say why and what would be."""

    def __init__(self, message: str, fix: str):
        self.message, self.fix = message, fix
        super().__init__(f"{message}. {fix}")


def read_number(name: str, quantity: Quantity, raw: object) -> float:
    """Return a number, or a text with a unit, as a number in the unit of a quantity.

    `name` is the parameter's, for messages. Raises `UnitError` if it is no finite number of that
    kind, or lies outside the quantity's bounds.
    """
    return _read_value(name, quantity, raw, {})


def _read_value(name: str, quantity: Quantity, raw: object, factors: dict[str, Fraction]) -> float:
    if not isinstance(raw, int | float | str):  # a scalar of another library
        scalar, unit = split_unit(raw)
        scalar = scalar.item() if getattr(scalar, "ndim", None) == 0 else scalar
        raw = with_own_unit(scalar, unit)
    if isinstance(raw, bool) or not isinstance(raw, (int, float, str)):
        raise UnitError(f"{_shown(raw)} is not a number", _how_to_write(name, quantity))
    if isinstance(raw, str):
        number = _read_text(name, quantity, raw, factors)
    else:
        try:
            number = float(raw)
        except OverflowError:
            number = math.inf
    if not math.isfinite(number):
        raise UnitError(f"{_shown(raw)} is not a finite number", _how_to_write(name, quantity))
    value_in_words, is_strict = f"{name} is {number:g}{quantity.suffix}", quantity.strict
    if number < quantity.lower or (is_strict and number == quantity.lower):
        lower_bound = f"{'greater than' if is_strict else 'at least'} {quantity.lower:g}"
        raise UnitError(value_in_words, f"It must be {lower_bound}")
    if number > quantity.upper:
        raise UnitError(value_in_words, f"It must be at most {quantity.upper:g}")
    return number + 0.0  # -0.0 and 0.0 are one value


def read_numbers(name: str, quantity: Quantity, raw: Sequence[object]) -> tuple[float, ...]:
    """Return values that a user wrote as numbers in the unit of a quantity; fast without units.

    `name` is the parameter, for messages. Raises `UnitError` for the first that is wrong, or if
    they are written in very many units.
    """
    if {*map(type, raw)} <= {int, float}:
        try:
            numbers = [float(number) + 0.0 for number in raw]  # type: ignore[arg-type]
        except OverflowError:
            numbers = [math.inf]
        low, high = quantity.lower, quantity.upper
        is_above_lower = low < min(numbers) if quantity.strict else low <= min(numbers)
        if is_above_lower and max(numbers) <= high and all(map(math.isfinite, numbers)):
            return tuple(numbers)
    factors: dict[str, Fraction] = {}
    return tuple(_read_value(name, quantity, item, factors) for item in raw)


def share_of(value: float, raw: object, example: str) -> float | None:
    """Return a share of a value that a user wrote as text, such as ``"5 %"``; else None.

    It is in the unit of the value, above 0. Raises `UnitError` if it ends in a percent sign, and no
    number stands before that; `example` is the fix.
    """
    if not (isinstance(raw, str) and raw.strip().endswith(PERCENT)):
        return None
    _check_length(raw)
    text = raw.strip().removesuffix(PERCENT).strip().translate(_SIGNS)
    try:
        return abs(value) * float(text) / 100
    except ValueError:
        raise UnitError(
            f"{raw[:40]!r} is not a percentage", f"Write {example}, or a value with its unit"
        ) from None


def _check_length(text: str) -> None:
    if len(text) > MAX_LETTERS:
        raise UnitError(
            f"{_shown(text)} has {len(text):,} characters",
            f"A value has at most {MAX_LETTERS} characters",
        )


def problem(path: str, error: UnitError) -> Problem:
    """Return a unit error as a problem at a path."""
    return Problem(path, error.message, error.fix)


def _read_text(name: str, quantity: Quantity, text: str, factors: dict[str, Fraction]) -> float:
    _check_length(text)
    match = _TEXT.fullmatch(text.translate(_SIGNS))
    if match is None:
        raise UnitError(
            f"{_shown(text)} is not a number with a unit", _how_to_write(name, quantity)
        )
    numerator, denominator = Decimal(match[1]).as_integer_ratio()
    unit = match[2]
    if _THOUSANDS.match(text.strip()):
        raise UnitError(
            f"{_shown(text)} may mean two numbers", "Remove the comma, or write a decimal point"
        )
    if re.match(r",\d", unit):
        raise UnitError(
            f"{_shown(text)} has a decimal comma", "Write the number with a point, as in 0.5"
        )
    if unit and unit not in factors:
        if len(factors) >= MAX_UNITS:
            raise UnitError(
                f"the values of {name} have different units", "Write all values in one unit"
            )
        factors[unit] = unit_factor(name, quantity, unit)
    if unit:
        numerator *= factors[unit].numerator
        denominator *= factors[unit].denominator
    try:
        return numerator / denominator  # of whole numbers: rounded once
    except OverflowError:
        return math.inf


def with_unit(text: str, unit: str) -> str:
    """Return the text of a cell, with the unit of its heading if it is a bare number.

    `unit` is empty where the heading has none. This is where tables of all sorts get their units.
    """
    text = text.strip().translate(_SIGNS)
    return f"{text} {unit}" if unit and BARE_NUMBER.fullmatch(text) else text


def unit_factor(name: str, quantity: Quantity, unit: str) -> Fraction:
    """Return the exact factor from a unit to that of a quantity.

    Units are read in the notation of pint (``m/s^2``), of CF and UDUNITS (``m s-2``), with
    superscripts, and in the words of the trade (``parts/min``, ``rpm``, ``g`` of an acceleration).
    Raises `UnitError` for a unit of another kind, or for none; `name` is the parameter's, for
    messages.
    """
    fix = _how_to_write(name, quantity)
    try:
        # The quantity gravity itself is not given in g: there "g" is a mistake for m/s^2.
        return _factor(quantity.unit, " ".join(unit.split()), with_g=quantity.symbol != "g")
    except _AngularError as error:
        raise UnitError(
            f"'{unit}' is an angular velocity, not a frequency", f"Divide the number by 2 pi. {fix}"
        ) from error
    except _OtherKindError as error:
        raise UnitError(f"'{unit}' does not measure {quantity.label.lower()}", fix) from error
    except ValueError as error:
        raise UnitError(f"'{unit[:40]}' is not a unit", fix) from error


def in_own_unit(name: str, quantity: Quantity, value: Any) -> Any:
    """Return an array in the unit of a quantity: converted if it carries another one.

    A data array of xarray keeps its labels; what carries no unit is returned as it is. Raises
    `UnitError` if its unit is none of the quantity; `name` is for messages.
    """
    numbers, unit = split_unit(value)
    if not unit:
        return value
    converted = numbers * float(unit_factor(name, quantity, unit))
    return value.copy(data=converted).drop_attrs() if hasattr(value, "dims") else converted


class _OtherKindError(Exception):
    """A unit is one of another kind of quantity."""


class _AngularError(Exception):
    """A unit of an angular velocity stands where a frequency is asked for."""


@functools.lru_cache(512)  # of tables, whose columns repeat theirs
def _factor(own: str, unit: str, *, with_g: bool) -> Fraction:
    if unit == own or (own == "1" and unit == "-"):
        return Fraction(1)
    if own == "1" and unit == PERCENT:
        return Fraction(1, 100)
    text = _in_pint(_spelled_for_pint(own, _plain(unit), with_g=with_g))
    if not _UNIT.fullmatch(text) or _HIGH_POWER.search(_POWER.sub("", text)):
        raise ValueError(unit)
    in_words = factor_between(text, _in_pint(own))
    if in_words is not None:
        return in_words
    base = _quantity(text)
    is_angular = "radian" in dict(base.to_root_units().unit_items())
    if own == "Hz" and is_angular:
        raise _AngularError
    if own.startswith(("degree", "rad")) != is_angular:
        raise _OtherKindError
    try:
        return Fraction(base.to(_in_pint(own) if own != "1" else "dimensionless").magnitude)
    except Exception as error:  # pint raises of many kinds
        raise _OtherKindError from error


def _quantity(text: str) -> Any:
    for spelling in dict.fromkeys(
        (text, re.sub(r"\b[A-Z](?=[a-z]{2,})", lambda match: match[0].lower(), text))
    ):
        try:
            return _registry().Quantity(Fraction(1), spelling)
        except Exception:  # pint raises of many kinds for a malformed unit
            continue
    raise ValueError(text)


def _plain(unit: str) -> str:
    text = re.sub("[⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻]+", lambda power: f"**{power[0].translate(_SUPERSCRIPTS)}", unit)
    text = text.translate(_SIGNS)
    return re.sub(r"^(per\b|/)\s?", "1/", text)


def _spelled_for_pint(own: str, unit: str, *, with_g: bool) -> str:
    # Spellings that pint would misread: "ms-2", "rpm", "g". `own` is the unit of the quantity.
    compact = unit.replace(" ", "")
    if own == "m s-2" and with_g and (gravity := _GRAVITY.fullmatch(compact)):
        return f"{_PREFIXES[gravity[1]]}standard_gravity"
    if own in ("m s-1", "m s-2", "m s-3") and (without_space := _JOINED.fullmatch(compact)):
        return f"{without_space[1]}*s**{without_space[2]}"
    if own in _RATES and "hz" not in compact.lower():
        return _RATES[own].get(compact.lower()) or _COUNTED[own].sub("count", unit.lower())
    return unit


def _in_pint(unit: str) -> str:
    # CF and UDUNITS write "m s-2" and "kg.m2" for m*s**-2 and kg*m**2; g0 is no power.
    return re.sub(
        r"(?<=[A-Za-zμ])(-?[1-9])(?![\w.^]|\*\*)",
        r"**\1",
        re.sub(r"(?<=[\w°])\.(?=[A-Za-zμ°])", "*", unit),
    )


@functools.cache
def _registry() -> Any:
    import pint  # costs half a second, and most studies need none but the words of `unit_words`

    return pint.UnitRegistry(non_int_type=Fraction)


def _how_to_write(name: str, quantity: Quantity) -> str:
    if quantity.unit == "1":
        return f"Write {name} = {(*quantity.examples, '1')[0]} (a plain number)"
    shown = " or ".join(
        f'"{example}"' for example in (quantity.examples or (f"1 {quantity.unit}",))
    )
    return f"Write {name} = {shown} (a bare number is in {quantity.unit})"


def _shown(raw: object) -> str:
    if isinstance(raw, bool):
        return str(raw).lower()  # as TOML and JSON have it
    if isinstance(raw, int) and abs(raw) > sys.float_info.max:  # Python may refuse to write it
        return "a number larger than 1.8e308"
    text = reprlib.repr(raw) if isinstance(raw, list | tuple | dict) else repr(raw)
    return text if len(text) <= 60 else text[:57] + "..."


# --- Arrays and quantities of other libraries, taken apart: numbers, units and dimensions.


_PLAIN_NUMBER = re.compile(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*")
_NAMELESS = re.compile(r"dim_\d+")


def split_unit(value: Any) -> tuple[Any, str]:
    """Return the numbers of an array or quantity, and the unit that it carries, or "".

    The value may be a data array of xarray with the attribute `units` or a quantity of pint inside,
    a column of pandas, an array of numpy, a quantity of pint, astropy or unyt; anything else is
    returned as it is.
    """
    unit = ""
    if hasattr(value, "to_numpy"):
        unit = _labelled_unit(value)
        data = getattr(value, "data", None)  # before to_numpy, which would lose the unit
        value = data if _unit_of(data) is not None else value.to_numpy()
    if (carried_unit := _unit_of(value)) is not None:
        unit = _unit_text(carried_unit)
        value = value.magnitude if hasattr(value, "magnitude") else value.value
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if kind == "m":
        return value.astype("m8[ns]").astype(float) / 1e9, "s"
    if kind == "M":  # else a list of it holds plain numbers
        return value.astype(str), ""
    return value, unit


def with_own_unit(number: Any, unit: str) -> Any:
    """Return a number, or the text of one, with its unit as text; as it is if the unit is empty."""
    if isinstance(number, str) and _PLAIN_NUMBER.fullmatch(number):
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


def _labelled_unit(value: Any) -> str:
    written = getattr(value, "attrs", None) or {}
    attributes = {str(name).casefold(): unit for name, unit in written.items()}
    indexes = getattr(value, "xindexes", None) or {}  # of pint-xarray: coordinates keep it there
    in_index = [getattr(index, "units", None) or {} for index in indexes.values()]
    candidates = [
        *(attributes.get(name) for name in ("units", "unit")),
        *(units.get(value.name) for units in in_index if isinstance(units, dict)),
        getattr(getattr(value, "dtype", None), "units", None),  # of pint-pandas
    ]
    return next((text for unit in candidates if (text := _unit_text(unit))), "")


def _unit_of(value: Any) -> Any:
    if not (hasattr(value, "magnitude") or hasattr(value, "value")):
        return None
    unit = getattr(value, "units", getattr(value, "unit", None))
    return None if isinstance(unit, str) else unit


def _unit_text(unit: Any) -> str:
    # pint's short names mean two things: "g" is standard gravity where accelerations are asked for.
    quantity: Any = 1 * unit if hasattr(unit, "dimensionality") else None
    if not hasattr(quantity, "unit_items"):
        return "" if unit is None else str(unit).strip()
    powers = dict(quantity.unit_items()).items()
    factors = [name if power == 1 else f"{name}**{power:g}" for name, power in powers]
    return "*".join(factors) or "dimensionless"
