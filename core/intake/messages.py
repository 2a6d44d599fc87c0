"""Messages for the errors that pydantic reports of a study, in the words of this program."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from vibrafeed.core.errors import MAX_PROBLEMS, Problem
from vibrafeed.core.intake.section import Section, Stranger
from vibrafeed.core.quantities import letter_of
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.suggestions import Suggestions

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

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
    """Return the path of a pydantic error in the study, the tag of an alternative, and the section.

    The tag is the alternative that pydantic tried, such as a kind of criterion; pydantic puts it
    into the path, where it is no key of the study. It is empty where there are none. `within` is
    the section that was validated, empty for a whole study; `sections` are the known sections by
    their keys.
    """
    path, tag = [within, *error["loc"]] if within else [*error["loc"]], ""
    section = sections.get(str(path[0]), Section()) if path else Section()
    if len(path) > 1 and path[1] in section.tags:
        tag = str(path.pop(1))  # which alternative it is, and no key
    if path and path[-1] == "[key]":
        del path[-1]  # it is the name that is wrong, and stands before
    return path, tag, section


def _outside(names: list[str]) -> Problem:
    """Return the problem of parameters that stand at the top level of a study.

    They belong in its section `parameters`; `names` are those of the parameters.
    """
    listed = ", ".join(names[:OUTSIDE]) + (", ..." if len(names) > OUTSIDE else "")
    message = f"{listed} {'stands' if len(names) == 1 else 'stand'} outside"
    fix = "Write them below the line [parameters], in JSON within that object"
    return Problem("parameters", message, fix)


def _is_outside(error: ErrorDetails) -> bool:
    """True if the error is a parameter at the top level of a study."""
    name, *below = error["loc"]
    return error["type"] == "extra_forbidden" and not below and letter_of(name) in PARAMETERS


def _problem(
    error: ErrorDetails, path: list[Any], section: Section, suggest: Suggestions
) -> Problem:
    """Return the problem of a study behind one error of pydantic, in the words of this program.

    `error` is pydantic's record, `path` the place of the value in the study, `section` describes
    the section there; `suggest` looks for names similar to a wrong one.
    """
    key = section.place(path)
    context: dict[str, Any] = error.get("ctx", {})
    if error["type"] == "value":
        fix = context["fix"]
        if callable(fix):
            fix = suggest.within(fix)
        return Problem(key, context["message"], fix)
    if error["type"] == "union_tag_invalid":
        tag = str(context["tag"])[:60]
        message = f"'{tag}' is not a {path[0]}"
        return Problem(f"{key}.kind", message, suggest(tag, section.tags))
    if error["type"] == "union_tag_not_found":
        fix = "Write kind = " + " or ".join(f'"{name}"' for name in section.tags)
        return Problem(f"{key}.kind", "it is missing", fix)
    if error["type"] == "missing":
        name = str(path[-1])[:60] if path else ""
        return Problem(key, "it is missing", f"Add {name}")
    message, fix = _value_message(error["type"], error.get("input"), context)
    return Problem(key, message or error["msg"].removesuffix("."), fix)


def _value_message(kind: str, value: object, context: Mapping[str, Any]) -> tuple[str, str]:
    """Return the message for a wrong value in a study, and the advice to fix it.

    `kind` is the type of pydantic's error, such as `float_type` or `too_long`, and `context` its
    details, such as a bound. The message is empty if `kind` is unknown here; pydantic's own is then
    shown.
    """
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
