"""The JSON Schema of studies says what the models say, once."""

import json
from typing import Any

import pytest

from night import spread
from schemas import expanded, whole_schema
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.quantities import QUANTITIES, WORDS

MOST = 330_000  # bytes as `vibrafeed scenes --schema` prints it; it was 4.8 million
NAMED = ("scene", "outputs", "variant", "method")
"""Keys whose values are names that the models do not list."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return whole_schema(tmp_path_factory)


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
