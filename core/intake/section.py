"""A section of a study: a key that holds more than a value, and what its reader has to know."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import ValidationError

from vibrafeed.core.errors import MAX_PROBLEMS, Problem
from vibrafeed.core.quantities import letter_of
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.suggestions import Suggestions

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

    from vibrafeed.core.measured.fit import Fit


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
    return Problem(
        stranger.place, f"'{stranger.name}' is not a key of the {section}{tag}", "Remove it"
    )


def no_parameter(stranger: Stranger) -> Problem:
    """Return the problem of an unknown name in a section of a study whose keys are parameters.

    `stranger` describes the name, its place and the section. A key of the study gets the advice to
    move it; another name the most similar parameter.
    """
    name, within = stranger.name, stranger.within
    if name in stranger.keys:
        return Problem(
            stranger.place,
            f"'{name}' is a key of the study, but stands in the section [{within}]",
            f"Move {name} above the line [{within}]",
        )
    return Problem(
        stranger.place,
        f"'{name}' is not a parameter",
        stranger.suggest(name, PARAMETERS, stranger.parameters),
    )


def advice_on_path(path: str | Path, fix: str) -> str:
    """Return the advice for a file that cannot be read; `fix`, unless the path has backslashes.

    Only Windows has them between folders, and in TOML those in double quotes stand for other
    characters, such as a tab.
    """
    text = str(path)
    slipped = ("\\" in text and os.sep == "/") or any(letter in text for letter in "\b\t\n\f\r")
    return "Write / between the folders of a path, not \\" if slipped else fix


def _nothing(*_: Any) -> Iterable[str]:
    return ()


def _as_it_is(raw: Any, folder: Path) -> Any:
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


# --- Messages for the errors that pydantic reports of a study, in the words of this program.


OUTSIDE = 5  # misplaced parameters that a message names at most
LONGEST = 60  # characters of a value that a message repeats

_TEXT = "a text", "Write a text in quotes"
_NUMBER = "a number", "Write a plain number"
_WHOLE = "a whole number", "Write a whole number"
_SWITCH = "true or false", "Write true or false"
_LIST = "a list", "Write a list in brackets"
_TABLE = "a table of keys and values", "Write a table, in JSON an object"
KINDS_OF_VALUES = {
    "string_type": _TEXT,
    "float_type": _NUMBER,
    "float_parsing": _NUMBER,
    "finite_number": ("a finite number", "Write a plain number"),
    "int_type": _WHOLE,
    "int_parsing": _WHOLE,
    "int_from_float": _WHOLE,
    "bool_type": _SWITCH,
    "bool_parsing": _SWITCH,
    "tuple_type": _LIST,
    "list_type": _LIST,
    "dict_type": _TABLE,
    "mapping_type": _TABLE,
    "model_type": _TABLE,
    "model_attributes_type": _TABLE,
}
"""What a value has to be, and how to write it, by pydantic's names of its errors."""

BOUNDS = {
    "greater_than_equal": ("ge", "at least"),
    "greater_than": ("gt", "more than"),
    "less_than_equal": ("le", "at most"),
    "less_than": ("lt", "less than"),
}
"""The key of a bound that a value breaks, and its words."""


def problems_of(
    error: ValidationError,
    sections: Mapping[str, Section],
    unknown: Callable[[Stranger], Problem],
    keys: Collection[str] = (),
    parameters: Collection[str] = PARAMETERS,
    within: str = "",
) -> list[Problem]:
    """Return the problems behind a pydantic error, each once, and not too many to read.

    Parameters
    ----------
    error : ValidationError
        The error that pydantic raised.
    sections : mapping of str to Section
        The sections of the study by their keys.
    unknown : callable
        Returns the problem of an unknown key at the top level.
    keys, parameters : collection of str
        Keys of the study and parameters of its scene, for suggestions; as in `Stranger`.
    within : str
        The key of the section that was validated; empty for a whole study.
    """
    faults = error.errors(include_url=False)
    outside = [] if within else [str(fault["loc"][0]) for fault in faults if _is_outside(fault)]
    suggest = Suggestions()
    problems = []
    if outside:
        problems.append(_outside(outside))
        faults = [
            fault for fault in faults if not _is_outside(fault) and fault["loc"] != ("parameters",)
        ]
    for fault in faults[:MAX_PROBLEMS]:
        path, tag, section = _path_of(fault, within, sections)
        if fault["type"] == "extra_forbidden":
            says = section.unknown if len(path) > 1 else unknown
            place = section.place(path)
            problems.append(says(Stranger(path, place, tag, keys, parameters, suggest)))
        else:
            problems.append(_problem(fault, path, section, suggest))
    if len(faults) > MAX_PROBLEMS:
        more = f"{len(faults) - MAX_PROBLEMS:,} further problems are not listed"
        problems.append(Problem("study", more, "Fix these first"))
    return problems


def _path_of(
    error: ErrorDetails, within: str, sections: Mapping[str, Section]
) -> tuple[list[Any], str, Section]:
    path, tag = [within, *error["loc"]] if within else [*error["loc"]], ""
    section = sections.get(str(path[0]), Section()) if path else Section()
    if len(path) > 1 and path[1] in section.tags:
        tag = str(path.pop(1))  # which alternative it is, and no key
    if path and path[-1] == "[key]":
        del path[-1]  # it is the name that is wrong, and stands before
    return path, tag, section


def _outside(names: list[str]) -> Problem:
    listed = ", ".join(names[:OUTSIDE]) + (", ..." if len(names) > OUTSIDE else "")
    return Problem(
        "parameters",
        f"{listed} {'stands' if len(names) == 1 else 'stand'} outside",
        "Write them below the line [parameters], in JSON within that object",
    )


def _is_outside(error: ErrorDetails) -> bool:
    name, *below = error["loc"]
    return error["type"] == "extra_forbidden" and not below and letter_of(name) in PARAMETERS


def _problem(
    error: ErrorDetails, path: list[Any], section: Section, suggest: Suggestions
) -> Problem:
    key = section.place(path)
    context: dict[str, Any] = error.get("ctx", {})
    if error["type"] == "value":
        fix = context["fix"]
        if callable(fix):
            fix = suggest.within(fix)
        return Problem(key, context["message"], fix)
    if error["type"] == "union_tag_invalid":
        tag = str(context["tag"])[:60]
        return Problem(f"{key}.kind", f"'{tag}' is not a {path[0]}", suggest(tag, section.tags))
    if error["type"] == "union_tag_not_found":
        return Problem(
            f"{key}.kind",
            "it is missing",
            ("Write kind = " + " or ".join(f'"{name}"' for name in section.tags)),
        )
    if error["type"] == "missing":
        name = str(path[-1])[:60] if path else ""
        return Problem(key, "it is missing", f"Add {name}")
    message, fix = _value_message(error["type"], error.get("input"), context)
    return Problem(key, message or error["msg"].removesuffix("."), fix)


def _value_message(kind: str, value: object, context: Mapping[str, Any]) -> tuple[str, str]:
    said = shown(value)
    if kind in KINDS_OF_VALUES:
        noun, fix = KINDS_OF_VALUES[kind]
        return f"{said} is not {noun}", fix
    if kind in BOUNDS:
        key, words = BOUNDS[kind]
        bound = context[key]
        beyond = "small" if words.startswith(("at least", "more")) else "large"
        return f"{said} is too {beyond}", f"Write {words} {bound:.15g}"
    if kind == "too_short":
        least = context["min_length"]
        return "it has too few entries", f"Give at least {least}"
    if kind == "too_long":
        most = context["max_length"]
        return f"it has more than {most:,} entries", f"Give at most {most:,}"
    if kind == "string_too_long":
        most = context["max_length"]
        return f"it has more than {most:,} characters", "Shorten it"
    if kind in ("literal_error", "enum"):
        return f"{said} is not among its values", f"Write {context['expected']}"
    return "", "Fix the value or its type"


def shown(value: object) -> str:
    """Return a value of a study as messages show it, such as "'abc'", "true" or "a table".

    Tables and lists are named only, and texts beyond `LONGEST` characters are cut.
    """
    if isinstance(value, bool):
        return str(value).lower()  # as TOML and JSON have it
    if value is None:
        return "null"
    if isinstance(value, Mapping):
        return "a table" if value else "an empty table"
    if isinstance(value, list | tuple):
        return "a list" if value else "an empty list"
    if isinstance(value, str):
        return repr(value if len(value) <= LONGEST else f"{value[:LONGEST]}...")
    text = str(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
