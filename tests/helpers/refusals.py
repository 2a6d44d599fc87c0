"""What is said of a study that is refused."""

from collections.abc import Callable
from typing import Any

import pytest

from vibrafeed.core.errors import Problem, StudyError


def problems_of(call: Callable[..., object], *given: Any, **named: Any) -> tuple[Problem, ...]:
    """Return the problems for which a call is refused."""
    with pytest.raises(StudyError) as caught:
        call(*given, **named)
    return tuple(caught.value.problems)


def words_of(call: Callable[..., object], *given: Any, **named: Any) -> str:
    """Return the words with which a call is refused."""
    return str(StudyError(problems_of(call, *given, **named)))


def places_of(call: Callable[..., object], *given: Any, **named: Any) -> list[str]:
    """Return the places of the problems for which a call is refused."""
    return [problem.place for problem in problems_of(call, *given, **named)]


def told_of(call: Callable[..., object], *given: Any, **named: Any) -> dict[str, str]:
    """Return by place what is wrong and what would be right."""
    return {p.place: f"{p.message}. {p.fix}" for p in problems_of(call, *given, **named)}
