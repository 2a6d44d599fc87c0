"""What cites the theory page finds the section there."""

import re
from pathlib import Path

import pytest

from vibrafeed.core.scenes import ALIASES, SCENES

ROOT = Path(__file__).parents[3]
THEORY = ROOT / "docs" / "theory.md"
NUMBER = re.compile(r"\d+(?:\.\d+)*")
# "theory 2.1", "Theory 2, 6", "theory 13.2 to 13.8", also where a line of a comment ends in
# between, and "[theory.md](theory.md), section 13". What follows a comma is a section if it has a
# dot, or ends the list.
REFERENCE = re.compile(
    r"\btheory(?:\.md\),?)?\s+(?:#\s+)?(?:sections? )?"
    r"(\d+(?:\.\d+)*(?:(?:, | and | to |-)\d+(?:\.\d+)+|, \d+(?=\)|\.\s|\"))*)",
    re.IGNORECASE,
)
HEADING = re.compile(r"^#{2,4} (\d+(?:\.\d+)*)\.? \S", re.MULTILINE)

HEADINGS = HEADING.findall(THEORY.read_text(encoding="utf-8"))
SOURCES = sorted(
    {
        equation.source
        for equations in (ALIASES, *(v for s in SCENES.values() for v in s.variants.values()))
        for equation in equations
        if "theory" in equation.source
    }
)
FOLDERS = ("core", "app", "vibrafeed", "tests", "benchmarks", "examples", "configs", "docs")
TEXTS = sorted(
    path
    for folder in FOLDERS
    for path in (ROOT / folder).rglob("*")
    if path.suffix in (".py", ".toml", ".md", ".html", ".js") and path != Path(__file__)
)


def cited(text: str) -> list[str]:
    """Return the numbers of the sections that a text cites."""
    return [number for found in REFERENCE.findall(text) for number in NUMBER.findall(found)]


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("see theory 2.1.", ["2.1"]),
        ("Theory 15: a value", ["15"]),
        ("(theory 1.4, 5.2, 5.3, 8.1)", ["1.4", "5.2", "5.3", "8.1"]),
        ("theory 13.2 to 13.8, 100 cells", ["13.2", "13.8"]),
        ("(theory 2, 6)", ["2", "6"]),
        ("the worked means of\ntheory\n    # 11.3", ["11.3"]),
        ("[theory.md](theory.md), section 13", ["13"]),
        ("[theory.md](theory.md), 13.7 and 13.8).", ["13.7", "13.8"]),
    ],
)
def test_a_citation_is_read(text: str, numbers: list[str]) -> None:
    assert cited(text) == numbers


def test_every_section_has_a_number_of_its_own_and_they_ascend() -> None:
    numbers = [tuple(int(part) for part in heading.split(".")) for heading in HEADINGS]
    assert numbers
    assert numbers == sorted(set(numbers))


@pytest.mark.parametrize("source", SOURCES)
def test_the_source_of_an_equation_is_a_section(source: str) -> None:
    references = cited(source)
    assert references, source
    assert set(references) <= set(HEADINGS)


def test_code_tests_notes_and_pages_cite_sections_that_exist() -> None:
    found = {
        (str(path.relative_to(ROOT)), number)
        for path in TEXTS
        for number in cited(path.read_text(encoding="utf-8"))
    }
    assert len({path for path, _ in found}) > 50  # all of them were read
    assert {(path, number) for path, number in found if number not in HEADINGS} == set()
