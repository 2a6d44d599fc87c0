"""A section of a study: a key that holds more than a value, and what its reader has to know."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from vibrafeed.core.errors import Problem
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.suggestions import Suggestions

if TYPE_CHECKING:
    from vibrafeed.core.measured.drive import Fit

Content = dict[str, Any]
"""What stands in a study: its keys and their values, as a file or request has them."""


class Resolved(NamedTuple):
    """Content with the numbers of a file instead of its name, and problems of the file.

    If the file cannot be used, the section is left out of the content. `fit` is that of a
    recording.
    """

    content: Content
    problems: Iterable[Problem] = ()
    fit: Fit | None = None


@dataclass(frozen=True)
class Stranger:
    """A key that a study, or one of its sections, does not have.

    Attributes
    ----------
    path : sequence
        Its path in the study; the name comes last.
    place : str
        The same, as users read it.
    tag : str
        The alternative that the section is, such as a kind of criterion, if it has any.
    keys : collection of str
        The keys of the study.
    parameters : collection of str
        The parameters of the scene, which messages list.
    suggest : Suggestions
        Looks for similar names.
    """

    path: Sequence[Any]
    place: str
    tag: str
    keys: Collection[str]
    parameters: Collection[str]
    suggest: Suggestions

    @property
    def name(self) -> str:
        """The key itself, shortened if it is long."""
        return str(self.path[-1])[:60]

    @property
    def within(self) -> str:
        """The section that contains the key; empty for a key of the study."""
        return str(self.path[0]) if len(self.path) > 1 else ""


def dotted(path: Sequence[Any]) -> str:
    """Return a path as users read it: keys joined by dots."""
    return ".".join(str(part)[:60] for part in path) or "study"


def no_key(stranger: Stranger) -> Problem:
    """Return the problem of an unknown key in a section of a study with fixed keys.

    `stranger` describes the key, its place, the section, and the alternative of the section that
    was tried, which the message names.
    """
    tag = f" '{stranger.tag}'" if stranger.tag else ""
    section = stranger.within.removesuffix("s")
    message = f"'{stranger.name}' is not a key of the {section}{tag}"
    return Problem(stranger.place, message, "Remove it")


def no_parameter(stranger: Stranger) -> Problem:
    """Return the problem of an unknown name in a section of a study whose keys are parameters.

    `stranger` describes the name, its place and the section. A key of the study gets the advice to
    move it; another name the most similar parameter.
    """
    name, within = stranger.name, stranger.within
    if name in stranger.keys:
        message = f"'{name}' is a key of the study, but stands in the section [{within}]"
        return Problem(stranger.place, message, f"Move {name} above the line [{within}]")
    fix = stranger.suggest(name, PARAMETERS, stranger.parameters)
    return Problem(stranger.place, f"'{name}' is not a parameter", fix)


def advice_on_path(path: str | Path, fix: str) -> str:
    """Return the advice for a file that cannot be read; `fix`, unless the path has backslashes.

    Only Windows has them between folders, and in TOML those in double quotes stand for other
    characters, such as a tab.
    """
    text = str(path)
    slipped = ("\\" in text and os.sep == "/") or any(letter in text for letter in "\b\t\n\f\r")
    return "Write / between the folders of a path, not \\" if slipped else fix


def _nothing(*_: Any) -> Iterable[str]:
    """Return no names."""
    return ()


def _as_it_is(raw: Any, folder: Path) -> Any:
    """Return a section unchanged."""
    del folder
    return raw


@dataclass(frozen=True)
class Section:
    """The rules by which a section of a study is read; by default it only has to be there.

    Attributes
    ----------
    names : callable
        Takes the section's content, if any, and the parameters of the scene; returns the parameters
        that it gives or leaves open.
    outputs : callable
        Takes the section's content; returns the outputs that it asks for.
    tags : tuple of str
        The alternatives among which its key `kind` chooses.
    by_parameter : bool
        True if its keys are parameters.
    place : callable
        Takes the path of a value; returns it as users read it.
    unknown : callable
        Takes a `Stranger`; returns its problem.
    beside : callable
        Takes the section's content and the folder of the study; returns it with file names that can
        be found from anywhere.
    resolve : callable, optional
        Takes content that has the section, and True if files of this machine may be read; replaces
        the name of a file by its numbers.
    absent : callable, optional
        Takes the section as a `Stranger` to a kind that does not have it; returns the problem.
    """

    names: Callable[[Any, Collection[str]], Iterable[str]] = _nothing
    outputs: Callable[[Any], Iterable[str]] = _nothing
    tags: tuple[str, ...] = ()
    by_parameter: bool = False
    place: Callable[[Sequence[Any]], str] = dotted
    unknown: Callable[[Stranger], Problem] = no_key
    beside: Callable[[Any, Path], Any] = _as_it_is
    resolve: Callable[[Content, bool], Resolved] | None = None
    absent: Callable[[Stranger], Problem] | None = None
