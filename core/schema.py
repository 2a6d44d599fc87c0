"""The JSON Schema of studies, for editors and for programs that write them."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

from pydantic.json_schema import models_json_schema

from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.pieces import Kind
from vibrafeed.core.quantities import QUANTITIES

DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"
NOTES: Final = ("title", "description", "default", "examples")
"""Keys of a schema that describe a value without restricting it; they may stand beside a $ref."""
BY_NAME: Final = ("properties", "$defs")
BELOW: Final = ("items", "anyOf", "oneOf", "allOf", "additionalProperties")
SHORT: Final = 70
"""Largest length of a schema that is repeated [characters]: a reference is hardly shorter."""

Schema = dict[str, Any]


def study_schema() -> Schema:
    """Return the JSON Schema of studies of all kinds, by which editors check and complete them."""
    models = {kind.model: kind for kind in KINDS.values()}
    references, all_schemas = models_json_schema([(model, "validation") for model in models])
    definitions = all_schemas["$defs"]
    schemas = []
    for model, kind in models.items():
        schema = definitions.pop(references[model, "validation"]["$ref"].rpartition("/")[2])
        schemas.append(_with_names(schema, kind))
    return by_reference(schemas, definitions)


def _with_names(schema: Schema, kind: Kind) -> Schema:
    # The schema of a kind with the names of its scenes, outputs and variants. `kind.scenes` has
    # mappings from the name of a scene to the scene: the first has those that a study may name, the
    # others add outputs. All scenes of a kind name their variants by one key, `choice`;
    # `kind.choices` has the values of further keys.
    first_scenes, properties = kind.scenes[0], {**schema["properties"]}
    scenes_with_outputs = [scene for scenes in kind.scenes for scene in scenes.values()]
    outputs = {
        name
        for scene in scenes_with_outputs
        for variant in scene.variants
        for name in scene.outputs(variant)
    }
    variants = sorted({variant for scene in first_scenes.values() for variant in scene.variants})
    choice = next(iter(first_scenes.values())).choice
    properties["scene"] |= {"enum": list(first_scenes)}
    if "outputs" in properties:
        properties["outputs"]["items"] = {"enum": [name for name in QUANTITIES if name in outputs]}
    for key, values in {choice: variants, **kind.choices}.items():
        description = properties[key]["description"]
        properties[key] = {"enum": [*values, None], "default": None, "description": description}
    return {**schema, "properties": properties}


def by_reference(kinds: Sequence[Schema], named: Mapping[str, Schema]) -> Schema:
    """Return a schema of the alternatives `kinds` in which every repeated part is written once.

    A part that occurs twice or more, such as the values that an angle may have, becomes a
    definition of its own, beside those `named`; its title and description stay where it is referred
    to.
    """
    counts: Counter[str] = Counter()
    names: dict[str, str] = {}
    shared: dict[str, Schema] = {}

    def count_parts(schema: Any) -> Any:
        if isinstance(schema, dict):
            counts[_text(schema)] += 1
        return _map_children(schema, count_parts)

    def shortened(schema: Any) -> Any:
        if not isinstance(schema, dict) or len(text := _text(schema)) <= SHORT or counts[text] < 2:
            return _map_children(schema, shortened)
        if text not in names:
            names[text] = f"shared-{len(names) + 1}"
            shared[names[text]] = _map_children(_plain(schema), shortened)
        notes = {key: schema[key] for key in NOTES if key in schema}
        return {"$ref": f"#/$defs/{names[text]}", **notes}

    for schema in (*kinds, *named.values()):
        count_parts(schema)
    alternatives = [shortened(kind) for kind in kinds]
    definitions = {name: shortened(schema) for name, schema in named.items()}
    return {"$schema": DIALECT, "oneOf": alternatives, "$defs": definitions | shared}


def _plain(schema: Mapping[str, Any]) -> Schema:
    return {key: value for key, value in schema.items() if key not in NOTES}


def _text(schema: Mapping[str, Any]) -> str:
    return json.dumps(_plain(schema), sort_keys=True)


def _map_children(schema: Any, change: Any) -> Any:
    # Applies a function to each schema that stands directly within another one.
    if not isinstance(schema, dict):
        return schema
    changed: Schema = {**schema}
    for key, value in schema.items():
        if key in BY_NAME:
            changed[key] = {name: change(child) for name, child in value.items()}
        elif key in BELOW:
            is_list = isinstance(value, list)
            changed[key] = [change(child) for child in value] if is_list else change(value)
    return changed
