"""All cases with a number, and all families."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from types import MappingProxyType
from typing import Any

from vibrafeed import core
from vibrafeed.core.assurance.case import EVIDENCE, RELATIONS, Case
from vibrafeed.core.assurance.forms import forms
from vibrafeed.core.assurance.worked import rail, throws, values
from vibrafeed.core.errors import Problem, StudyError

FORMAT = "vibrafeed-validation-1"

ABOUT = (
    "Problems of vibratory feeding whose answer is known; g is 9.81 m/s2 unless a study says "
    "otherwise. The terms of an answer say how it is made of outputs of vibrafeed's studies, in SI "
    "units and degrees: times * output - minus, summed, or the root of their mean square. Any "
    "program that computes the same number may answer; `vibrafeed validate --answers` judges it."
)

FAMILIES: Mapping[str, str] = MappingProxyType(
    {
        "Q": "Two-level wave",
        "O": "Best level wave",
        "W": "Winkler's wave",
        "M": "Drives far above friction",
        "S": "Symmetries of the waveform",
        "B": "Balances of any drive",
        "Z": "Level sine",
        "R": "On which side a part comes to rest",
        "D": "Dice of steel, thrown",
        "C": "Thick coins, thrown",
        "Y": "A rail of cast iron, measured",
        "V": "Worked values",
        "F": "Figures of the thesis",
        "H": "Hard cases with a closed form",
    }
)
"""Families by their letters, in the order in which they are shown."""

ELSEWHERE: Mapping[str, tuple[Callable[[], Iterable[Case]], ...]] = MappingProxyType(
    {
        "D": (throws.dice,),
        "C": (throws.coins,),
        "Y": (rail.cases,),
        "V": (values.mean_velocities, values.reference_speeds, values.hops, values.closed_forms,
              values.limiting_friction),
        "F": (values.limiting_friction,),
        "H": (values.hard_cases,),
    }
)  # fmt: skip
"""What gives the problems of families that are no forms; of each those of the letter count."""

NOT_CLAIMED: Mapping[str, str] = MappingProxyType(
    {
        "bulk": "v = 3.81 N S of bulk conveyors, and rates that rise by 20 to 30 % with 10 % of "
        "amplitude: rules of thumb, which judge nothing.",
    }
)
"""What is known of feeders and is no claim of this program."""


def families_of(asked: Collection[str]) -> tuple[str, ...]:
    """Return the letters of the asked families of validation problems, in the order of `FAMILIES`.

    Each text of `asked` holds one or more letters, separated by commas; all families if there is
    none.

    Raises
    ------
    StudyError
        With every letter that is no family.
    """
    letters = [letter.strip().upper() for several in asked for letter in several.split(",")]
    problems = [
        Problem("family", f"'{letter[:20]}' is not a family", f"Known: {', '.join(FAMILIES)}")
        for letter in letters
        if letter not in FAMILIES
    ]
    if problems:
        raise StudyError(problems)
    return tuple(letter for letter in FAMILIES if not letters or letter in letters)


def cases(families: Collection[str] = (), random: int = 0, seed: int = 1) -> tuple[Case, ...]:
    """Return the validation problems of some families, with their known results.

    Parameters
    ----------
    families : collection of str
        Letters of the families, such as "Q"; all if empty.
    random : int
        Number of further problems of each form, with random inputs.
    seed : int
        Seed of the random inputs: equal seeds give equal problems.

    Raises
    ------
    StudyError
        If a letter is no family.
    """
    members: list[Case] = []
    for letter in families_of(families):
        for form in forms().values():
            if form.name.startswith(f"{letter}-"):
                members += [*form.cases(), *form.random(random, seed)]
        for make in ELSEWHERE.get(letter, ()):
            members += [case for case in make() if case.family == letter]
    return tuple(members)


def document(asked: Collection[Case]) -> dict[str, Any]:
    """Return validation problems as plain values for JSON, with all that is needed to solve them.

    Other programs read that file; `asked` are the problems. Forms, families and kinds of evidence
    that the problems refer to are included.
    """
    letters = dict.fromkeys(case.family for case in asked)
    named = {case.form for case in asked}
    return {
        "format": FORMAT,
        "program": f"vibrafeed {core.__version__}",
        "about": ABOUT,
        "truths": dict(EVIDENCE),
        "relations": list(RELATIONS),
        "families": {letter: FAMILIES[letter] for letter in letters},
        "forms": {
            form.name: {"title": form.title, "words": form.words, "inputs": dict(form.inputs)}
            for form in forms().values()
            if form.name in named
        }
        | ({"Y-run": {"title": "Measured speeds", "words": rail.WORDS, "inputs": rail.INPUTS}}
           if "Y-run" in named else {}),
        "not_claimed": dict(NOT_CLAIMED),
        "problems": [case.document() for case in asked],
    }  # fmt: skip
