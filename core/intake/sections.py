"""The sections that studies have; a kind has those that are keys of its model."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Final

from vibrafeed.core.errors import Problem
from vibrafeed.core.intake.observed import OBSERVATIONS
from vibrafeed.core.intake.posteriors import UNCERTAIN
from vibrafeed.core.intake.recorded import DRIVE
from vibrafeed.core.intake.section import Section, Stranger, no_parameter
from vibrafeed.core.quantities import WORDS, by_letters, letter_of
from vibrafeed.core.study.reduction import LevelSet, Reduction
from vibrafeed.core.study.section_names import CRITERIA, DRIVE_ANGLES


def _parameter_names(parameters: Any, known: Collection[str]) -> Iterable[str]:
    del known
    return map(str, parameters) if isinstance(parameters, Mapping) else ()


def _open(variables: Any, known: Collection[str]) -> Iterable[str]:
    """Return the variables of an optimisation; if none are given, the drive's angles in the scene.

    `known` are the parameters of the scene.
    """
    if isinstance(variables, Mapping):
        return map(str, variables)
    return (name for name in DRIVE_ANGLES if name in known)


def _asked(outputs: Any) -> Iterable[str]:
    return outputs if isinstance(outputs, list | tuple) else ()


def _looked_for(criterion: Any) -> Iterable[str]:
    found = criterion if isinstance(criterion, Mapping) else {}
    names = (found.get("output", "acceleration_x"), found.get("against"))
    return (name for name in names if isinstance(name, str))


def _no_key_of_reduce(stranger: Stranger) -> Problem:
    part = LevelSet if len(stranger.path) > 2 else Reduction
    fix = stranger.suggest(stranger.name, part.model_fields)
    return Problem(stranger.place, f"'{stranger.name}' is not a key of the section reduce", fix)


SECTIONS: Final[Mapping[str, Section]] = {
    "parameters": Section(names=_parameter_names, unknown=no_parameter, by_parameter=True),
    "uncertain": UNCERTAIN,
    "variables": Section(names=_open, unknown=no_parameter, by_parameter=True),
    "unknowns": Section(names=_parameter_names, unknown=no_parameter, by_parameter=True),
    "offsets": Section(unknown=no_parameter, by_parameter=True),
    "factors": Section(unknown=no_parameter, by_parameter=True),
    "candidates": Section(unknown=no_parameter, by_parameter=True),
    "observations": OBSERVATIONS,
    "drive": DRIVE,
    "criterion": Section(outputs=_looked_for, tags=CRITERIA),
    "outputs": Section(outputs=_asked),
    "reduce": Section(unknown=_no_key_of_reduce),
}
"""Every section by its key, in the order in which they are read."""


# --- The words for angles in a study: azimuth is alpha, elevation beta, climb gamma, lean delta.


def in_letters(content: Any) -> tuple[Any, list[Problem]]:
    """Return the content of a study with the letters of angles in place of their words.

    The problems are those of angles that a section gives twice, by word and by letter. `content` is
    that of a file or request, of which nothing is known; it is not changed itself.
    """
    if not isinstance(content, Mapping):
        return content, []
    letters, problems = dict(content), list[Problem]()
    for key, raw in content.items():
        faults: list[Problem] = []
        if key in ("sensitivities", "reduce"):
            letters[key] = _reduction(raw) if isinstance(raw, Mapping) else _names(raw)
        elif key == "observations" and isinstance(raw, Mapping | list | tuple):
            letters[key], faults = _rows([raw] if isinstance(raw, Mapping) else raw)
        elif key in SECTIONS and SECTIONS[key].by_parameter and isinstance(raw, Mapping):
            letters[key], faults = by_letters(raw, f"{key}.")
        problems += faults
    return letters, problems


def words_in(content: Any) -> dict[str, str]:
    """Return the words by which a study names angles, by their letters.

    An angle that it names by its letter, too, is left out. `content` is as the user wrote it.
    """
    sections = content.items() if isinstance(content, Mapping) else ()
    written = {
        name
        for key, raw in sections
        if key in SECTIONS
        for part in (raw if isinstance(raw, list | tuple) else (raw,))
        if isinstance(part, Mapping)
        for name in part
    }
    return {letter: word for word, letter in WORDS.items() if {word, letter} & written == {word}}


def _rows(rows: list[Any] | tuple[Any, ...]) -> tuple[list[Any], list[Problem]]:
    letters, problems = list[Any](), list[Problem]()
    for number, row in enumerate(rows, 1):
        faults: list[Problem] = []
        if isinstance(row, Mapping) and not WORDS.keys().isdisjoint(row):
            row, faults = by_letters(row, f"observations row {number}, ")
        letters.append(row)
        problems = problems or faults
    return letters, problems


def _reduction(raw: Mapping[str, Any]) -> dict[str, Any]:
    letters = {name: _names(part) if name == "over" else part for name, part in raw.items()}
    levels = raw.get("levels")
    if isinstance(levels, Mapping):
        letters["levels"] = {
            name: {key: _names(part) if key == "along" else part for key, part in level.items()}
            if isinstance(level, Mapping)
            else level
            for name, level in levels.items()
        }
    return letters


def _names(raw: Any) -> Any:
    if isinstance(raw, list | tuple):
        return [*map(_names, raw)]
    return letter_of(raw) if isinstance(raw, str) else raw
