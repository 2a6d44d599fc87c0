"""JSON Schemas without references, to compare them."""

from __future__ import annotations

from typing import Any


def expanded(schema: Any, root: dict[str, Any]) -> Any:
    """Return a schema with what each reference leads to in its place."""
    if isinstance(schema, list):
        return [expanded(one, root) for one in schema]
    if not isinstance(schema, dict):
        return schema
    rest = {key: expanded(one, root) for key, one in schema.items() if key != "$ref"}
    if "$ref" not in schema:
        return rest
    return {**expanded(root["$defs"][schema["$ref"].rpartition("/")[2]], root), **rest}
