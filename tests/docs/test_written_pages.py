"""Pages that programs write say what is so today, and what they show is carried out."""

import re
from xml.etree import ElementTree

import pytest

from benchmarks import architecture_page, keywords, kinds_page
from vibrafeed.core.intake import prepare_content, read_toml
from vibrafeed.core.kinds import KINDS, tabulate

TOML = re.compile(r"^```toml\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = {
    "architecture_page": (architecture_page.DRAWING, architecture_page.drawing),
    "keywords": (keywords.FILE, keywords.module),
}


@pytest.mark.parametrize("program", PAGES)
def test_a_page_is_up_to_date(program):
    file, written = PAGES[program]
    assert written() == file.read_text(encoding="utf-8"), f"python -m benchmarks.{program}"


EXAMPLES = TOML.findall(kinds_page.page())


@pytest.mark.parametrize(("kind", "example"), [*zip(KINDS, EXAMPLES, strict=True)])
def test_examples_of_kinds_are_carried_out(kind, example):
    content = read_toml(example)
    assert content["kind"] == kind
    assert tabulate(prepare_content(content)).variables


def test_every_package_of_the_contracts_is_drawn_once():
    layers = architecture_page.layers(architecture_page.contracts())
    rules = {room.name: room.rules for layer in layers for room in layer}
    texts = ElementTree.fromstring(architecture_page.drawing()).iter()
    drawn = [text.text for text in texts if text.text in rules]
    assert drawn == list(rules)
    assert len(drawn) > 30
    assert set(architecture_page.WAY) <= set(drawn)
    assert "the physics knows arrays only" in rules["vibrafeed.core.mechanics"]
    assert rules["vibrafeed.core.plots"] == ()
