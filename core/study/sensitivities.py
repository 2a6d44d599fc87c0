"""The key `sensitivities` of sweeps and simulations: what outputs are derived by."""

from __future__ import annotations

import reprlib
from typing import Annotated

from pydantic import Field, PlainValidator, WithJsonSchema

from vibrafeed.core.study.levels import refusal

MAX_PARAMETERS = 30


def _read(raw: object) -> bool | tuple[str, ...] | None:
    """Return the parameters by which a user wants derivatives: names, True for all, None for none.

    Raises a refusal for anything else, and for more than 30 names.
    """
    if raw is None or isinstance(raw, bool):
        return raw or None
    names = tuple(raw) if isinstance(raw, list | tuple) else ()
    if 0 < len(names) <= MAX_PARAMETERS and all(isinstance(name, str) for name in names):
        return tuple(dict.fromkeys(names))
    raise refusal(
        f"{reprlib.repr(raw)[:40]} is neither true nor a list of parameter names",
        'Write true for all parameters that the study gives, or a list such as ["friction"]',
    )


Sensitivities = Annotated[
    bool | tuple[str, ...] | None,
    PlainValidator(_read),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "boolean"},
                {
                    "type": "array",
                    "items": {"type": "string", "maxLength": 100},
                    "minItems": 1,
                    "maxItems": MAX_PARAMETERS,
                },
                {"type": "null"},
            ]
        }
    ),
    Field(
        description="Also give the derivative of each output by these parameters, and its "
        "elasticity d ln(output)/d ln(parameter): true for all that the study gives, or a list of "
        "names."
    ),
]
