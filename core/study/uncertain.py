"""The section `uncertain` of studies: parameters and their distributions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from pydantic import create_model

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.distributions import (
    FORMS,
    MAX_TABULATED,
    Distribution,
    read_distribution,
)
from vibrafeed.core.study.grid_study import PARAMETERS, Frozen
from vibrafeed.core.study.levels import optional


def _schema(quantity: Quantity) -> dict[str, Any]:
    """Return the JSON Schema of a parameter's distribution: an object with keys of any kind.

    `quantity` is the declaration of the parameter.
    """
    # Short, since there is one for each of many parameters: docs/sensitivity.md says the rest.
    value: dict[str, Any] = {"type": ["number", "string"]}
    many = {"type": "array", "items": value, "minItems": 2, "maxItems": MAX_TABULATED}
    kinds = {"values": many, "densities": many, "factor": {"type": "number"}}
    return {
        "title": quantity.label,
        "type": "object",
        "properties": {key: kinds.get(key, value) for keys in FORMS.values() for key in keys},
        "additionalProperties": False,
        "minProperties": 2,
    }


if TYPE_CHECKING:

    class Uncertain(Frozen):
        """One optional field a parameter quantity."""

else:
    Uncertain = create_model(
        "Uncertain",
        __base__=Frozen,
        __doc__="Uncertain parameters and their distributions.",
        **{
            name: optional(partial(read_distribution, name), partial(_schema, QUANTITIES[name]))
            for name in PARAMETERS
        },
    )


def distributions_of(uncertain: Uncertain | None) -> dict[str, Distribution]:
    """Return the uncertain parameters of a study: names and the distributions of their values.

    `uncertain` is the section of that name in the study, one optional field per parameter. The
    mapping has only the parameters that the study gives, in the order of all parameters, and is
    empty if the study has no such section.
    """
    if uncertain is None:
        return {}
    given = uncertain.model_fields_set
    return {name: getattr(uncertain, name) for name in PARAMETERS if name in given}
