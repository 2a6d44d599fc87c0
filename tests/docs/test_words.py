"""The texts that users read keep to the field's words: no dialect of the authors' own.

The guide is Google's developer documentation style guide, as CONTRIBUTING.md says; this list has
what crept in here before.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
INSTEAD = {
    r"\btold\b": "reported, stated, shown",
    r"\btells?\b": "says, shows, states",
    r"\bhardly meant\b": "unusual",
    r"\bfalls? short\b": "is below; known limitations",
    r"\bnobody\b": "unknown; no client",
    r"\bwill do\b": "is acceptable, is enough",
    r"\bfloating numbers\b": "the range of double precision",
    r"(?:\bit|'|\}) is no (?!longer|more|less|larger|smaller)\w+": "is not a",
    r"\bso many (?!that)": "the number of",
    r"\bbeside the (?:file|study)\b": "in the file's folder",
    r"\bsound value": "valid value",
    r"\bcourse of (?:the|a|one) part": "trajectory",
    r"\bbut for rounding\b": "up to rounding",
    r"\bmend(?:s|ed|ing)?\b": "fix",
    r"\bin the place of\b": "instead of",
    r"\bmeant is\b": "nominal",
    r"\bno list of\b": "is not a list of",
}  # fmt: skip
SOURCES = ("core", "app", "vibrafeed")
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
THEORY = {"theory.md"}  # its proofs say what a law "tells" of a motion, as papers do


def prose(text: str) -> Iterator[tuple[int, str]]:
    """Yield the lines of a page, with their numbers, without code."""
    is_code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code:
            yield number, re.sub(r"`[^`]*`", "", line)


def messages(text: str) -> Iterator[tuple[int, str]]:
    """Yield the texts of a module that are no docstrings, with their lines."""
    tree = ast.parse(text)
    bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    inner = {
        id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)
        for part in node.values
    }  # fmt: skip
    for node in ast.walk(tree):
        if id(node) in bare or id(node) in inner:
            continue
        if isinstance(node, ast.JoinedStr):
            pieces = [
                str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values
            ]
            yield node.lineno, "".join(pieces)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield node.lineno, node.value


def faults(texts: Iterator[tuple[int, str]], name: str) -> list[str]:
    """Return each use of a word of the list, with its place and with what to say instead."""
    return [
        f"{name}:{line}: {match[0]!r} in {text.strip()[:80]!r}: say {better}"
        for line, text in texts
        for pattern, better in INSTEAD.items()
        if (match := re.search(pattern, text, re.IGNORECASE))
    ]


@pytest.mark.parametrize("source", SOURCES)
def test_messages_and_help(source):
    found = [
        fault
        for path in sorted((ROOT / source).rglob("*.py"))
        for fault in faults(messages(path.read_text(encoding="utf-8")), str(path.relative_to(ROOT)))
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages(page):
    if page.name in THEORY:
        pytest.skip("theory has the words of papers")
    found = faults(prose(page.read_text(encoding="utf-8")), page.name)
    assert not found, "\n".join(found)


def test_planted_words_are_found():
    page = "The answer is told.\n```\ntold = 1\n```\n`told` is a name.\n"
    assert [fault[:3] for fault in faults(prose(page), "p")] == ["p:1"]
    module = (
        '"""It is told."""\nname = f"\'{suffix}\' is no format"\nother = "it is no longer so"\n'
    )
    assert [fault[:3] for fault in faults(messages(module), "m")] == ["m:2"]
