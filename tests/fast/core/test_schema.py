"""The JSON Schema of studies says what the models say, once."""

import json
from typing import Any

import pytest

from night import spread
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.quantities import QUANTITIES, WORDS
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.schema import study_schema

MOST = 300_000  # bytes as `vibrafeed scenes --schema` prints it; it was 4.8 million
NAMED = ("scene", "outputs", "variant", "method")
"""Keys whose values are names that the models do not list."""


@pytest.fixture(scope="module")
def whole() -> dict[str, Any]:
    """Return the schema as it is written."""
    return json.loads(json.dumps(study_schema(), allow_nan=False))


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


def test_it_is_small_and_every_reference_leads_somewhere(whole):
    text = json.dumps(whole, indent=0, allow_nan=False)
    assert len(text) <= MOST
    assert len(text) > 100_000  # nothing was lost on the way
    references = {part.partition('"')[0] for part in text.split('"$ref": "#/$defs/')[1:]}
    assert references <= set(whole["$defs"])
    shared = {name for name in whole["$defs"] if name.startswith("shared-")}
    assert shared <= references, "of a definition that nobody uses there is no need"


@pytest.mark.parametrize("place", spread(range(len(KINDS)), 1))
def test_each_kind_is_that_of_its_model(whole, place):
    kind = list(KINDS.values())[place]
    schema = expanded(whole["oneOf"][place], whole)
    model = kind.model.model_json_schema()
    plain = expanded({key: part for key, part in model.items() if key != "$defs"}, model)
    for name in plain["properties"].keys() - NAMED - kind.choices.keys():
        assert schema["properties"][name] == plain["properties"][name], name
    assert {**schema, "properties": 0} == {**plain, "properties": 0}
    parameters = schema["properties"]["parameters"]["properties"]
    assert set(parameters) == {name for name, one in QUANTITIES.items() if one.parameter} | {*WORDS}


def test_it_knows_every_scene(whole):
    kinds = [expanded(kind, whole)["properties"] for kind in whole["oneOf"]]
    assert [kind["kind"]["const"] for kind in kinds] == list(KINDS)
    assert kinds[0]["scene"]["enum"] == list(SCENES)
    assert kinds[1]["scene"]["enum"] == list(SYSTEMS)
    assert all(quantity.examples for quantity in QUANTITIES.values() if quantity.parameter)
