"""Values of outputs that a study compares with: a number, or text in the output's unit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.units import UnitError, read_number


def refusal(message: str, fix: str | Callable[[], str]) -> PydanticCustomError:
    """Return the validation error of a wrong value, with a message and a fix.

    `fix` may be a function; pydantic may find many errors, and it is called for the first few
    alone.
    """
    return PydanticCustomError("value", "{message}", {"message": message, "fix": fix})


def at_most(count: int) -> BeforeValidator:
    """Return a pydantic validator that refuses lists of more than `count` entries.

    It runs before pydantic checks each entry, which takes long for a list of millions.
    """

    def check(raw: object) -> object:
        """Return the list unless it is too long."""
        if isinstance(raw, list | tuple) and len(raw) > count:
            raise refusal(f"it has {len(raw):,} entries", f"Give at most {count:,}")
        return raw

    return BeforeValidator(check)


def read_level(name: str, raw: object) -> float:
    """Return a level of a quantity as a number in its unit, from a number or a text with a unit.

    It may lie outside the bounds of the quantity. Raises `UnitError` if it is no value of that
    kind. `name` is the quantity, `raw` what the user wrote. A level is a value to compare an output
    with.
    """
    quantity = QUANTITIES[name]
    # What is compared with a parameter may lie outside the parameter's own bounds.
    shown = quantity.examples or ("1" if quantity.unit == "1" else f"1 {quantity.unit}",)
    free = Quantity(
        quantity.unit, quantity.symbol, quantity.label, quantity.description, examples=shown
    )
    return read_number(name, free, raw)


def _read_level(raw: object, info: ValidationInfo) -> object:
    """Return a field of a study, a value of the output that an earlier field names, in its unit.

    `raw` is what the user wrote, a number or a text with a unit, and may be None; `info` has the
    fields before it. Raises a refusal for a text that is no such value. Where the output is not
    known the number is kept as it is, or 0 for a text: the unknown name is reported elsewhere.
    """
    output = info.data.get("against") or info.data.get("output")
    if raw is None or str(output) not in QUANTITIES:  # an unknown output is told of elsewhere
        return raw if raw is None or isinstance(raw, int | float) else 0.0
    try:
        return read_level(str(output), raw)
    except UnitError as error:
        raise refusal(error.message, error.fix) from error


_LEVEL_SCHEMA: dict[str, Any] = {
    "anyOf": [{"type": "number"}, {"type": "string", "maxLength": 200}]
}
Level = Annotated[float, BeforeValidator(_read_level), WithJsonSchema(_LEVEL_SCHEMA)]
"""A value of the output that an earlier field names."""
OpenLevel = Annotated[float | None, BeforeValidator(_read_level), WithJsonSchema(_LEVEL_SCHEMA)]
"""The same, or none."""
