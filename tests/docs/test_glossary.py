"""The glossary's names are those of the code."""

from __future__ import annotations

import ast
import re
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").splitlines()
    if line.startswith("| **")
]
CODE = sorted({name for row in ROWS for name in re.findall(r"`([^`]+)`", row[3])})


@pytest.fixture(scope="module")
def classes() -> set[str]:
    return {
        node.name
        for package in ("core", "app")
        for path in (ROOT / package).rglob("*.py")
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef)
    }


@pytest.mark.parametrize("name", CODE)
def test_code_has_what_the_glossary_names(name, classes):
    if "." in name:
        assert find_spec(name) is not None
    else:
        assert name in classes


@pytest.mark.parametrize(
    "term", ["trajectory", "quota", "outlier", "nominal", "mode", "a posteriori", "executor"]
)
def test_terms_of_the_field_stand_in_the_glossary(term):
    text = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").lower()
    assert re.search(rf"\b{term}\b", text)


def test_every_row_has_four_columns():
    assert ROWS
    assert {len(row) for row in ROWS} == {4}
