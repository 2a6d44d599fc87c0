"""Values of outputs that a study compares with: a number, or text in the output's unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError, core_schema

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.units import UnitError, read_number


def refusal(message: str, fix: str | Callable[[], str]) -> PydanticCustomError:
    """Return the validation error of a wrong value, with a message and a fix.

    `fix` may be a function; pydantic may find many errors, and it is called for the first few
    alone.
    """
    return PydanticCustomError("value", "{message}", {"message": message, "fix": fix})


@dataclass(frozen=True)
class Reader:
    """A field of a study for pydantic, read by one function.

    pydantic's own validators and serialisers inspect signatures and types, which takes long for
    hundreds of fields at every start.

    Attributes
    ----------
    read : callable
        Returns the value of what a user wrote; may raise `UnitError`.
    schema : callable
        Returns the JSON Schema of what may be written.
    """

    read: Callable[[object], Any]
    schema: Callable[[], dict[str, Any]]

    def __get_pydantic_core_schema__(self, source: object, handler: object) -> Any:
        """Return the functions that read the field, and write it as plain JSON."""
        del source, handler
        writes = core_schema.plain_serializer_function_ser_schema(_canonical)
        return core_schema.no_info_plain_validator_function(self._read, serialization=writes)

    def __get_pydantic_json_schema__(self, schema: object, handler: object) -> dict[str, Any]:
        """Return the JSON Schema of the field."""
        del schema, handler
        return self.schema()

    def _read(self, raw: object) -> Any:
        """Return the value; raise a refusal for a wrong one."""
        try:
            return self.read(raw)
        except UnitError as error:
            raise refusal(error.message, error.fix) from error


def optional(read: Callable[[object], Any], schema: Callable[[], dict[str, Any]]) -> Any:
    """Return type and default of a field that a function reads, and that is None if left out."""
    return Annotated[Any, Reader(read, schema)], None


def _canonical(value: Any) -> Any:
    """Return a value as plain JSON."""
    return value.canonical() if hasattr(value, "canonical") else value


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
