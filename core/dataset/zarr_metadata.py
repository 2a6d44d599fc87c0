"""The documents of a Zarr v3 group: what its ``zarr.json`` say of arrays and attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from vibrafeed.core.dataset.table import Table

FILL: dict[str, tuple[float, str | int]] = {
    "float64": (np.nan, "NaN"), "float32": (np.nan, "NaN"), "int8": (0, 0), "int64": (0, 0)
}  # fmt: skip
"""What pads the chunks at the end of an axis, by type: the value, and its word in JSON.

Readers of version 3 take it for no mask: only an attribute `_FillValue` would be one, and there is
none, so that flags stay integers.
"""


LITTLE: dict[str, Any] = {"name": "bytes", "configuration": {"endian": "little"}}
CHECKSUM: dict[str, Any] = {"name": "crc32c"}


def _sharding(chunk_shape: tuple[int, ...], width: int) -> dict[str, Any]:
    """Return the Zarr codec of shards: compressed chunks, an index at the end, and checksums.

    It is an entry of an array's metadata. `chunk_shape` is the number of values of a chunk along
    each axis; `width` is the size of a value [bytes].
    """
    # lz4 is the fastest of those that every reader of version 3 has; with a shuffle it packs floats
    # better than zstd does without.
    blosc = {
        "cname": "lz4",
        "clevel": 5,
        "shuffle": "shuffle" if width > 1 else "noshuffle",
        "typesize": width,
        "blocksize": 0,
    }
    return {
        "name": "sharding_indexed",
        "configuration": {
            "chunk_shape": list(chunk_shape),
            "codecs": [LITTLE, {"name": "blosc", "configuration": blosc}, CHECKSUM],
            "index_codecs": [LITTLE, CHECKSUM],
            "index_location": "end",
        },
    }


def group_document(table: Table, arrays: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    """Return the metadata of a Zarr group (its `zarr.json`), which also holds that of its arrays.

    Readers then open the group with one request. `table` has the global attributes, `arrays` the
    metadata documents of the arrays by name.
    """
    return {
        "zarr_format": 3,
        "node_type": "group",
        "attributes": _plain(table.attributes),
        "consolidated_metadata": {
            "kind": "inline",
            "must_understand": False,
            "metadata": dict(arrays),
        },
    }


def array_document(
    table: Table,
    name: str,
    shape: tuple[int, ...],
    chunk_shape: tuple[int, ...],
    shard_shape: tuple[int, ...] | None = None,
) -> dict[str, Any]:
    """Return the JSON metadata of an array of a Zarr group, the file zarr.json of the array.

    Parameters
    ----------
    table : Table
        Holds the array as a coordinate or variable; its type, dimension names and attributes count,
        its values and shape do not.
    name : str
        Name of that coordinate or variable.
    shape, chunk_shape : tuple of int
        The number of values of the array and of a chunk along each dimension.
    shard_shape : tuple of int, optional
        The number of values of a shard, a file of several compressed chunks; by default, each chunk
        is a file.
    """
    is_output = name in table.variables
    variable = table.variables[name] if is_output else table.coordinates[name]
    is_text = variable.values.dtype == object
    data_type = "string" if is_text else variable.values.dtype.name
    links = _links(table) if is_output else {}
    codecs = [{"name": "vlen-utf8"}] if is_text else [LITTLE]
    if shard_shape is not None:
        codecs = [_sharding(chunk_shape, variable.values.dtype.itemsize)]
    return {
        "zarr_format": 3,
        "node_type": "array",
        "shape": list(shape),
        "data_type": data_type,
        "chunk_grid": {
            "name": "regular",
            "configuration": {"chunk_shape": list(shard_shape or chunk_shape)},
        },
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "fill_value": "" if is_text else FILL[data_type][1],
        "codecs": codecs,
        "dimension_names": list(variable.dims),
        "attributes": {**_plain(variable.attributes), **links},
    }


def _links(table: Table) -> dict[str, str]:
    """Return the CF attribute that links an output to the fixed parameters, names in a text."""
    scalars = " ".join(n for n, coordinate in table.coordinates.items() if not coordinate.dims)
    return {"coordinates": scalars} if scalars else {}


def _plain(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes as values that JSON holds: arrays as lists, all but numbers as texts."""
    return {
        name: value.tolist()
        if isinstance(value, np.ndarray)
        else value
        if isinstance(value, int | float)
        else str(value)
        for name, value in attributes.items()
    }
