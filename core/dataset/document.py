"""A table as plain values and arrays, for replies in JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.dataset.table import Table, TableVariable


def to_document(table: Table) -> dict[str, Any]:
    """Return a table as nested dictionaries: attributes, coordinates, variables.

    Each variable has its `dims`, its attributes (units, long_name, ...) and its `data`, an array;
    a flag variable has `flags`, the name of each value, in place of the CF pair of attributes.
    """
    return {
        "attributes": {**table.attributes, **table.price},
        "coordinates": {name: _document(v) for name, v in table.coordinates.items()},
        "variables": {name: _document(v) for name, v in table.variables.items()},
    }


def _document(variable: TableVariable) -> dict[str, Any]:
    """Return a variable as a dictionary: dimensions, attributes, flags, data."""
    attributes = dict(variable.attributes)
    values, meanings = attributes.pop("flag_values", None), attributes.pop("flag_meanings", "")
    if values is not None:
        attributes["flags"] = dict(zip(meanings.split(), map(int, values), strict=True))
    data = np.ascontiguousarray(variable.values) if variable.dims else variable.values.item()
    return {"dims": list(variable.dims), **attributes, "data": data}
