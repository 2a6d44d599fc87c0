"""The words for the angles that formulas call by letters; a study may use either."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from vibrafeed.core.errors import Problem

WORDS: Final[Mapping[str, str]] = {
    "azimuth": "alpha",
    "elevation": "beta",
    "climb": "gamma",
    "lean": "delta",
}
"""Each word, and the parameter that it names."""
WORD_OF: Final[Mapping[str, str]] = {letter: word for word, letter in WORDS.items()}
"""The word for each of these parameters."""


def letter_of(name: Any) -> Any:
    """Return the parameter that a word names; any other name as it is."""
    return WORDS.get(name, name)


def by_letters(
    written: Mapping[Any, Any], within: str = ""
) -> tuple[dict[Any, Any], list[Problem]]:
    """Return values by parameter, the words for angles replaced by their letters, and problems.

    A problem is a word beside its own letter. `written` has values by the names that a user wrote;
    `within` is the start of their places, such as ``parameters.``.
    """
    problems = [
        Problem(
            f"{within}{word}",
            f"{word} and {letter} are the same angle, and both are given",
            f"Leave out {word} or {letter}",
        )
        for word, letter in WORDS.items()
        if word in written and letter in written
    ]
    return {letter_of(name): value for name, value in written.items()}, problems
