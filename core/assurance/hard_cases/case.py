"""What a hard case is, and how its study is carried out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from core import kinds
from core.assurance.textbook import TextbookValue
from core.dataset.table import Table
from core.intake import prepare_content
from core.watch import Watch

Content = dict[str, Any]
Attempt = Callable[[], tuple[float, float, str]]


@dataclass(frozen=True)
class HardCase:
    """A study at the edge of what numbers or methods bear.

    Attributes
    ----------
    name, family : str
        What it is called, and what it is hard for.
    why : str
        Why it is hard.
    content : mapping
        The study.
    output : str
        The output that is judged.
    answer : callable, optional
        Returns the right value and the largest error; None where the study is to be refused, or
        where only status and finiteness are judged.
    status : tuple of str
        The statuses (of motion) or regimes (of a sweep) that may stand there; empty for any.
    refused : str
        The place that the `StudyError` has to name, if one is right.
    says : bool
        Whether the result states its own error, which is then added to that of the answer.
    blunt : str
        Why the error that the method states may be larger than what it is stated for; empty where
        it may not.
    attempt : callable, optional
        Runs in the place of the study; returns error, stated error and a note.
    """

    name: str
    family: str
    why: str
    content: Mapping[str, Any]
    output: str = ""
    answer: Callable[[], TextbookValue] | None = None
    status: tuple[str, ...] = ()
    refused: str = ""
    says: bool = False
    blunt: str = ""
    attempt: Attempt | None = None


def result_of(content: Mapping[str, Any], watch: Watch | None = None) -> Table:
    """Return the results of a study given as a user writes it."""
    return kinds.tabulate(prepare_content(content), watch)
