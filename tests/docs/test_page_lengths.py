"""Guides stay short: what is longer belongs to a reference, to theory, or to a page of its own."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
MAX_WORDS = 1200  # of running text: what one reads in six minutes
REFERENCE = {"api-reference.md", "theory.md", "thesis.md", "validation.md"}
GUIDES = sorted(page for page in DOCS.glob("*.md") if page.name not in REFERENCE)


def running_words(text: str) -> int:
    """Return the number of words outside of code blocks and tables."""
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return sum(len(line.split()) for line in text.splitlines() if not line.startswith("|"))


@pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.name)
def test_a_guide_is_read_in_six_minutes(page):
    assert running_words(page.read_text(encoding="utf-8")) <= MAX_WORDS


@pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.name)
def test_a_guide_begins_with_a_paragraph(page):
    title, blank, first = page.read_text(encoding="utf-8").splitlines()[:3]
    assert title.startswith("# ")
    assert not blank
    assert not re.match(r"[#|>*-]|```|\d+\.", first), first


def test_planted_words_are_counted():
    assert running_words("# A page\n\n```\nno word\n```\n| no | word |\nthree more words\n") == 6
