"""What cites the theory page finds the section there."""

import re
from pathlib import Path

import pytest

from core.scenes import ALIASES, SCENES

ROOT = Path(__file__).parents[2]
THEORY = ROOT / "docs" / "theory.md"
REFERENCE = re.compile(r"\btheory (\d+(?:\.\d+)*)")
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
TEXTS = sorted([*(ROOT / "core").rglob("*.py"), *(ROOT / "configs").rglob("*.toml")])


def test_every_section_has_a_number_of_its_own_and_they_ascend() -> None:
    numbers = [tuple(int(part) for part in heading.split(".")) for heading in HEADINGS]
    assert numbers
    assert numbers == sorted(set(numbers))


@pytest.mark.parametrize("source", SOURCES)
def test_the_source_of_an_equation_is_a_section(source: str) -> None:
    references = REFERENCE.findall(source)
    assert references, source
    assert set(references) <= set(HEADINGS)


def test_docstrings_comments_and_notes_cite_sections_that_exist() -> None:
    cited = {
        (str(path.relative_to(ROOT)), number)
        for path in TEXTS
        for number in REFERENCE.findall(path.read_text(encoding="utf-8"))
    }
    assert {(path, number) for path, number in cited if number not in HEADINGS} == set()
