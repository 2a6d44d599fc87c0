"""The JSON Schema of studies, made once a run of tests, and schemas without references."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from once import made_once
from vibrafeed.core.schema import study_schema


def whole_schema(factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return the JSON Schema of studies as it is written; to make it takes seconds."""

    def make(folder: Path) -> None:
        text = json.dumps(study_schema(), allow_nan=False)
        (folder / "schema.json").write_text(text, encoding="utf-8")

    file = made_once(factory, "schema-of-studies", make) / "schema.json"
    return json.loads(file.read_text(encoding="utf-8"))


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
