"""Units, read once: text such as ``"0.5 mm"`` becomes a number in the quantity's own unit."""

from __future__ import annotations

import functools
import math
import re
import reprlib
from collections.abc import Sequence
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import TYPE_CHECKING

from core.errors import Problem

if TYPE_CHECKING:
    import pint

    from core.quantities import Quantity

# "per minute" for a frequency means turns or vibrations; pint reads rpm as an angular velocity.
PER_MINUTE = frozenset(
    ("rpm", "vpm", "cpm", "rev/min", "vib/min", "cycles/min", "1/min", "min^-1", "min-1", "/min")
)
PERCENT = "%"
MAX_UNITS = 10  # units in the values of one list: looking one up takes long
_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*(.*?)\s*")
_UNIT = re.compile(r"(?:1/)?[A-Za-zµμ°'\"_][A-Za-z0-9_²³ µμ°*/^().'\"-]{0,40}")
# Powers are exact, and as long as their exponents are high: "mm**99999999" would take hours.
_POWER = re.compile(r"(?<![)\s])\s?(?:(?:\*\*|\^)\s?-?\d|[²³])(?![\w.]|\s?(?:\*\*|\^))")
_HIGH_POWER = re.compile(r"\*\*|\^|[\d.][eE]|[²³]")
_COMMA = re.compile(r",\d")
_FACTOR = re.compile(r"([A-Za-z]+)(-?\d*)")  # of the unit of a quantity, as in "kg m2 s-1"


class UnitError(ValueError):
    """A text is not a value of the quantity; `message` and `fix` say why and what would be."""

    def __init__(self, message: str, fix: str):
        self.message, self.fix = message, fix
        super().__init__(f"{message}. {fix}")


def read_number(name: str, quantity: Quantity, raw: object) -> float:
    """Return a number, or a text with a unit, as a number in the unit of a quantity.

    `name` is the parameter's, for messages.

    Raises
    ------
    UnitError
        If it is no finite number of that kind, or lies outside the quantity's bounds.
    """
    return _read_value(name, quantity, raw, {})


def _read_value(name: str, quantity: Quantity, raw: object, factors: dict[str, Fraction]) -> float:
    """Return a number or a text with a unit, as a user wrote it, as a number in a quantity's unit.

    `name` is the parameter, for messages, and `factors` caches the factors of units between the
    values of a list. Raises `UnitError` for anything else, and for a value beyond the bounds of the
    quantity.
    """
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
    _check_bounds(name, quantity, number)
    return number + 0.0  # -0.0 and 0.0 are one value


def read_numbers(name: str, quantity: Quantity, raw: Sequence[object]) -> tuple[float, ...]:
    """Return values that a user wrote as numbers in the unit of a quantity.

    It is fast if none has a unit. `name` is the parameter, for messages.

    Raises
    ------
    UnitError
        For the first that is wrong, or if they are written in very many units.
    """
    if {*map(type, raw)} <= {int, float}:
        try:
            numbers = [float(number) + 0.0 for number in raw]  # type: ignore[arg-type]
        except OverflowError:
            numbers = [math.inf]
        low, high = quantity.lower, quantity.upper
        inside = low < min(numbers) if quantity.strict else low <= min(numbers)
        if inside and max(numbers) <= high and all(map(math.isfinite, numbers)):
            return tuple(numbers)
    factors: dict[str, Fraction] = {}
    return tuple(_read_value(name, quantity, item, factors) for item in raw)


def share_of(value: float, raw: object, example: str) -> float | None:
    """Return a share of a value that a user wrote as text, such as ``"5 %"``; else None.

    It serves errors and deviations, and is in the unit of the value, above 0.

    Raises
    ------
    UnitError
        If it ends in a percent sign, and no number stands before that; `example` is the fix.
    """
    if not (isinstance(raw, str) and raw.strip().endswith(PERCENT)):
        return None
    text = raw.strip().removesuffix(PERCENT).strip()
    try:
        return abs(value) * float(text) / 100
    except ValueError:
        fix = f"Write {example}, or a value with its unit"
        raise UnitError(f"{raw[:40]!r} is not a percentage", fix) from None


def problem(path: str, error: UnitError) -> Problem:
    """Return a unit error as a problem at a path."""
    return Problem(path, error.message, error.fix)


def _read_text(name: str, quantity: Quantity, text: str, factors: dict[str, Fraction]) -> float:
    """Return the value of a text with a number and perhaps a unit, in a quantity's unit.

    It is rounded once. `name` is the parameter, for messages; `factors` caches the factors of
    units. Raises `UnitError` for a text that is none.
    """
    match = _TEXT.fullmatch(text[:200])
    if match is None:
        raise UnitError(
            f"{_shown(text)} is not a number with a unit", _how_to_write(name, quantity)
        )
    try:
        numerator, denominator = Decimal(match[1]).as_integer_ratio()
    except InvalidOperation as error:  # pragma: no cover (the pattern admits decimals only)
        raise UnitError(f"{_shown(text)} is not a number", _how_to_write(name, quantity)) from error
    unit = match[2]
    if _COMMA.match(unit):
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


def unit_factor(name: str, quantity: Quantity, unit: str) -> Fraction:
    """Return the exact factor from a unit to that of a quantity.

    Raises `UnitError` for a text that is no unit, or one of another kind; `name` is the
    parameter's, for messages.
    """
    if quantity.unit == "Hz" and unit.replace(" ", "").lower() in PER_MINUTE:
        return Fraction(1, 60)
    if quantity.unit == "1" and unit == PERCENT:
        return Fraction(1, 100)
    fix = _how_to_write(name, quantity)
    if not _UNIT.fullmatch(unit) or _HIGH_POWER.search(_POWER.sub("", unit)):
        raise UnitError(f"'{unit[:40]}' is not a unit", fix)
    try:
        base = _registry().Quantity(Fraction(1), unit)
        is_angular = "radian" in dict(base.to_root_units().unit_items())
    except Exception as error:  # pint raises of many kinds for a malformed unit
        raise UnitError(f"'{unit}' is not a unit", fix) from error
    if quantity.unit == "Hz" and is_angular:
        raise UnitError(
            f"'{unit}' is an angular velocity, not a frequency", f"Divide the number by 2 pi. {fix}"
        )
    if (quantity.is_angle or quantity.unit.startswith("rad")) != is_angular:
        raise UnitError(f"'{unit}' does not measure {quantity.label.lower()}", fix)
    try:
        converted = base.to(_pint_name(quantity.unit)).magnitude
    except Exception as error:
        raise UnitError(f"'{unit}' does not measure {quantity.label.lower()}", fix) from error
    return Fraction(converted)


def _pint_name(unit: str) -> str:
    """Return a unit in pint's notation: "m s-2" as "m**1*s**-2"."""
    factors = (f"{name}**{power or 1}" for name, power in _FACTOR.findall(unit))
    return "*".join(factors) or "dimensionless"


@functools.cache
def _registry() -> pint.UnitRegistry[Fraction]:
    """Return pint's unit registry with exact fractions."""
    import pint  # costs a third of a second, and a study without unit texts does not need it

    return pint.UnitRegistry(non_int_type=Fraction)


def _check_bounds(name: str, quantity: Quantity, number: float) -> None:
    """Raise `UnitError` if a number is outside the bounds of its quantity.

    `name` is the parameter, for the message, and `number` is in the unit of the quantity.
    """
    low, high = quantity.lower, quantity.upper
    if number < low or (quantity.strict and number == low):
        least = f"greater than {low:g}" if quantity.strict else f"at least {low:g}"
        raise UnitError(f"{name} is {number:g}{quantity.suffix}", f"It must be {least}")
    if number > high:
        raise UnitError(f"{name} is {number:g}{quantity.suffix}", f"It must be at most {high:g}")


def _how_to_write(name: str, quantity: Quantity) -> str:
    """Return a sentence on how to write a value of a quantity in a study, with examples.

    It is the fix in messages about a wrong value. `name` is the parameter, `quantity` its
    declaration.
    """
    bare = "a plain number" if quantity.unit == "1" else f"a bare number is in {quantity.unit}"
    if quantity.unit == "1":
        return f"Write {name} = {quantity.examples[0]} ({bare})"
    shown = " or ".join(f'"{example}"' for example in quantity.examples)
    return f"Write {name} = {shown} ({bare})"


def _shown(raw: object) -> str:
    """Return a value as shown in messages, cut to 60 characters.

    `raw` is what a user wrote, of any type.
    """
    if isinstance(raw, bool):
        return str(raw).lower()  # as TOML and JSON have it
    text = reprlib.repr(raw) if isinstance(raw, list | tuple | dict) else repr(raw)
    return text if len(text) <= 60 else text[:57] + "..."
