"""What the catalogue says that an output requires is enough to ask for it."""

import pytest

from vibrafeed.core.catalogue import describe, describe_all
from vibrafeed.core.intake import prepare_content

SCENES = {scene["name"]: scene["methods"] for scene in describe_all()}
KINDS = [(name, "sweep") for name in SCENES]
KINDS += [(name, "simulate") for name, methods in SCENES.items() if methods]


@pytest.mark.parametrize(("name", "kind"), KINDS)
def test_what_an_output_requires_is_enough(name, kind):
    method = SCENES[name][0] if kind == "simulate" else None
    scene = describe(name, method=method)
    examples = {one["name"]: one["example"] for one in scene["parameters"]}
    for output in scene["outputs"]:
        # Some quantities have no example, and none of them is bounded away from 1.
        given = {n: 1 if examples[n] is None else examples[n] for n in output["required"]}
        study = {"kind": kind, "scene": name, "outputs": [output["name"]], "parameters": given}
        assert prepare_content(study).cells == 1
        assert set(output["required"]) <= set(output["asks"])
