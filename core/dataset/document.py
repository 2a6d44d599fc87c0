"""A table as plain values and arrays, for replies in JSON."""

from typing import Any

import numpy as np

from vibrafeed.core.dataset.table import Table, TableVariable


def to_document(table: Table) -> dict[str, Any]:
    """Return a table as nested dictionaries, the form in which the service sends it as JSON.

    The keys are `attributes`, `coordinates` and `variables`. Each variable has its `dims`, its
    attributes (units, long_name, ...) and its `data`, an array. A flag variable has `flags`, the
    name of each of its integer values, in place of two CF attributes.
    """
    return {
        "attributes": {**table.attributes, **table.price},
        "coordinates": {name: _document(variable) for name, variable in table.coordinates.items()},
        "variables": {name: _document(variable) for name, variable in table.variables.items()},
    }


def _document(variable: TableVariable) -> dict[str, Any]:
    """Return a variable as a dictionary for JSON: dimensions, attributes, flags and data.

    `flags` are the numbers of a flag variable by name; `data` is an array, or a number without
    dimensions.
    """
    attributes = dict(variable.attributes)
    values, meanings = attributes.pop("flag_values", None), attributes.pop("flag_meanings", "")
    if values is not None:
        attributes["flags"] = dict(zip(meanings.split(), map(int, values), strict=True))
    data = np.ascontiguousarray(variable.values) if variable.dims else variable.values.item()
    return {"dims": list(variable.dims), **attributes, "data": data}
