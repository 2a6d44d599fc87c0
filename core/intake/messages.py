"""What pydantic finds wrong with a study, in our words."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from core.errors import MAX_PROBLEMS, Problem
from core.intake.section import Section, Stranger
from core.study.grid_study import PARAMETERS
from core.suggestions import Suggestions

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

OUTSIDE = 5  # misplaced parameters that are named


def problems_of(
    error: ValidationError,
    sections: Mapping[str, Section],
    unknown: Callable[[Stranger], Problem],
    keys: Collection[str] = (),
    parameters: Collection[str] = PARAMETERS,
    within: str = "",
) -> list[Problem]:
    """Return what is wrong with a study, each once and few enough to be read.

    Parameters
    ----------
    error : ValidationError
        What pydantic found.
    sections : mapping of str to Section
        Those of the study.
    unknown : callable
        Takes a key that stands in none of them, and is not known; returns what is wrong with it.
    keys, parameters : collection of str
        As in `Stranger`.
    within : str
        The section that it was that pydantic looked at, if not a whole study.
    """
    faults = error.errors(include_url=False, include_input=False)
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
    """Return where an error is, which alternative of its section was tried, and that section."""
    path, tag = [within, *error["loc"]] if within else [*error["loc"]], ""
    section = sections.get(str(path[0]), Section()) if path else Section()
    if len(path) > 1 and path[1] in section.tags:
        tag = str(path.pop(1))  # which alternative it is, and no key
    if path and path[-1] == "[key]":
        del path[-1]  # it is the name that is wrong, and stands before
    return path, tag, section


def _outside(names: list[str]) -> Problem:
    """Return what is wrong with parameters that stand among the keys of a study."""
    listed = ", ".join(names[:OUTSIDE]) + (", ..." if len(names) > OUTSIDE else "")
    message = f"{listed} {'stands' if len(names) == 1 else 'stand'} outside"
    fix = "Write them below the line [parameters], in JSON within that object"
    return Problem("parameters", message, fix)


def _is_outside(error: ErrorDetails) -> bool:
    """True if a parameter stands among the keys of a study."""
    path = error["loc"]
    return error["type"] == "extra_forbidden" and len(path) == 1 and path[0] in PARAMETERS


def _problem(
    error: ErrorDetails, path: list[Any], section: Section, suggest: Suggestions
) -> Problem:
    """Return one error of pydantic in our words."""
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
    return Problem(key, error["msg"].removesuffix("."), "Fix the value or its type")
