"""The sections that studies have; a kind has those that are keys of its model."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Final

from vibrafeed.core.errors import Problem
from vibrafeed.core.intake.observed import OBSERVATIONS
from vibrafeed.core.intake.posteriors import UNCERTAIN
from vibrafeed.core.intake.recorded import DRIVE
from vibrafeed.core.intake.section import Section, Stranger, no_parameter
from vibrafeed.core.study.reduction import LevelSet, Reduction
from vibrafeed.core.study.section_names import CRITERIA, DRIVE_ANGLES


def _parameter_names(parameters: Any, known: Collection[str]) -> Iterable[str]:
    """Return the names of the parameters in a section."""
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
    """Return the names of the outputs."""
    return outputs if isinstance(outputs, list | tuple) else ()


def _looked_for(criterion: Any) -> Iterable[str]:
    """Return the names of the outputs in a criterion: its objective, and what it trades against."""
    found = criterion if isinstance(criterion, Mapping) else {}
    names = (found.get("output", "acceleration_x"), found.get("against"))
    return (name for name in names if isinstance(name, str))


def _no_key_of_reduce(stranger: Stranger) -> Problem:
    """Return the problem of an unknown key of the section `reduce`, or of its level set."""
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
