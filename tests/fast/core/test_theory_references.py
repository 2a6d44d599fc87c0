"""Whatever cites the theory pages finds the section there."""

import re
from pathlib import Path

from vibrafeed.core.scenes import ALIASES, SCENES

ROOT = Path(__file__).parents[3]
NUMBER = re.compile(r"\d+(?:\.\d+)*")
# "theory 2.1", "Theory 2, 6", "theory 13.2 to 13.8", also where a line of a comment ends in
# between, and "[theory](theory.md), section 13". What follows a comma is a section if it has a
# dot, or ends the list.
REFERENCE = re.compile(
    r"\btheory(?:\]\(\S+\),?)?\s+(?:#\s+)?(?:sections? )?"
    r"(\d+(?:\.\d+)*(?:(?:, | and | to |-)\d+(?:\.\d+)+|, \d+(?=\)|\.\s|\"))*)",
    re.IGNORECASE,
)
HEADING = re.compile(r"^#{2,4} (\d+(?:\.\d+)*)\.? \S", re.MULTILINE)
FOLDERS = ("core", "app", "vibrafeed", "tests", "benchmarks", "examples", "configs", "docs")


def cited(text: str) -> list[str]:
    """Return the numbers of the sections that a text cites."""
    return [number for found in REFERENCE.findall(text) for number in NUMBER.findall(found)]


def test_sections_that_are_cited_exist():
    pages = [ROOT / "docs" / "theory.md", *(ROOT / "docs" / "theory").glob("*.md")]
    headings = [HEADING.findall(page.read_text(encoding="utf-8")) for page in pages]
    orders = [[tuple(map(int, number.split("."))) for number in numbers] for numbers in headings]
    assert orders == [sorted(order) for order in orders], "sections of a page ascend"
    sections = [number for numbers in headings for number in numbers]
    assert len(sections) == len(set(sections)), "every section has a number of its own"
    texts = {
        path: path.read_text(encoding="utf-8")
        for folder in FOLDERS for path in (ROOT / folder).rglob("*")
        if path.suffix in (".py", ".toml", ".md") and path != Path(__file__)
    }  # fmt: skip
    found = {(path, number) for path, text in texts.items() for number in cited(text)}
    assert len({path for path, _ in found}) > 50  # all of them were read
    assert {(path, number) for path, number in found if number not in sections} == set()
    for equations in (ALIASES, *(v for s in SCENES.values() for v in s.variants.values())):
        for equation in equations:
            if "theory" in equation.source:
                assert set(cited(equation.source)) & set(sections), equation.source
