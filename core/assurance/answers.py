"""Answers of other programs: a JSON file of numbers by the names of problems.

    {"format": "vibrafeed-answers-1", "program": "Another 1", "answers": {"Q-two-levels-1": 15.88}}

A program may leave problems out, and may answer members with random inputs of any seed: their names
tell which they are. `null` says that it tried and has no answer.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vibrafeed.core.assurance.case import Case
from vibrafeed.core.assurance.catalogue import FAMILIES, cases
from vibrafeed.core.assurance.forms import forms
from vibrafeed.core.errors import MAX_PROBLEMS, Problem, StudyError
from vibrafeed.core.suggestions import suggestion

FORMAT = "vibrafeed-answers-1"
MAX_RANDOM = 10_000
"""Members of a form under one seed."""
MAX_SEEDS = 100

_RANDOM = re.compile(r"(.+)-r(\d{1,9})\.(\d{1,9})")
_KEYS = {"format", "program", "answers"}


@dataclass(frozen=True)
class ProgramAnswers:
    """The answers of a program.

    Attributes
    ----------
    program : str
        Its name, as it says.
    cases : tuple of Case
        What it answers.
    values : mapping of str to float or None
        Its answers, by the names of the problems.
    """

    program: str
    cases: tuple[Case, ...]
    values: Mapping[str, float | None]


def read_answers(path: Path) -> ProgramAnswers:
    """Return another program's answers to the validation problems from a JSON file.

    Raises
    ------
    StudyError
        If the file cannot be read or is not JSON, or with every problem of its content.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        fix = "Name a JSON file of answers"
        raise StudyError([Problem("answers", error.strerror or str(error), fix)]) from None
    except ValueError as error:
        is_syntax = isinstance(error, json.JSONDecodeError | UnicodeDecodeError)
        reason = error if is_syntax else "a number has thousands of digits"
        raise StudyError([Problem("answers", f"it is not JSON: {reason}", _FORM)]) from None
    return answers_of(content)


_FORM = f'Write {{"format": "{FORMAT}", "program": "...", "answers": {{"Q-two-levels-1": 15.88}}}}'


def answers_of(content: object) -> ProgramAnswers:
    """Return another program's answers to the validation problems from the content of its file.

    `content` is a mapping with "format", "program" (a name) and "answers": numbers, or None for
    none, by the name of the problem, such as "Q-two-levels-1". Raises `StudyError` with every
    mistake in it.
    """
    if not isinstance(content, Mapping):
        raise StudyError([Problem("answers", "the file of answers is not a JSON object", _FORM)])
    problems = [
        Problem(
            str(key)[:40],
            f"{str(key)[:40]!r} is not a key of a file of answers",
            suggestion(str(key), _KEYS),
        )
        for key in content
        if key not in _KEYS
    ]
    if content.get("format") != FORMAT:
        problems.append(
            Problem(
                "format",
                "the format of the file of answers is missing or unknown",
                f'Write "{FORMAT}"',
            )
        )
    program = content.get("program", "the program")
    if not isinstance(program, str) or len(program) > 200:
        problems.append(
            Problem(
                "program",
                "program in the file of answers is not a text of at most 200 characters",
                'Write the name of the program, such as "Another 1.2"',
            )
        )
    answers = content.get("answers")
    if not isinstance(answers, Mapping) or not answers:
        problems.append(Problem("answers", "the file of answers holds no answers", _FORM))
        raise StudyError(problems)
    asked, unknown = _asked(answers)
    problems += unknown
    problems += [
        Problem(
            f"answers.{name}"[:80],
            f"the answer {str(value)[:40]} is not a number",
            "Write a finite number, or null for no answer",
        )
        for name, value in answers.items()
        if not _is_answer(value)
    ]
    if problems:
        raise StudyError(problems[:MAX_PROBLEMS])
    return ProgramAnswers(program, asked, answers)


def _is_answer(value: Any) -> bool:
    """True if a value can be an answer: None or a finite number."""
    if value is None:
        return True
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and abs(value) <= sys.float_info.max  # not so of NaN


def _asked(names: Collection[str]) -> tuple[tuple[Case, ...], list[Problem]]:
    """Return the validation problems with the given names, and mistakes for names that are unknown.

    Names begin with the letter of a family of problems; those of random problems hold the seed from
    which their inputs are drawn, so that they can be made again here.
    """
    letters = {name.partition("-")[0] for name in names}
    known = {problem.id: problem for problem in cases(letters & set(FAMILIES) or {"Q"})}
    most, problems = _random(names)
    for (form, seed), count in most.items():
        known |= {problem.id: problem for problem in forms()[form].random(count, seed)}
    reported = {problem.place for problem in problems}
    unknown = [name for name in names if name not in known and f"answers.{name}" not in reported]
    problems += [
        Problem(
            f"answers.{name}"[:80],
            f"validate has no problem '{name[:60]}'",
            suggestion(name, known),
        )
        for name in unknown[:MAX_PROBLEMS]
    ]
    return tuple(problem for name, problem in known.items() if name in names), problems


def _random(names: Collection[str]) -> tuple[dict[tuple[str, int], int], list[Problem]]:
    """Return the number of random problems named per form and seed, and mistakes for large ones.

    `names` are those of answers; that of a random problem ends with its seed and number, as in
    "Q-two-levels-r1.20". The count is the largest number, by (form, seed): making so many problems
    gives all that are named. Numbers and seeds are limited, as they cost memory.
    """
    problems: list[Problem] = []
    most: dict[tuple[str, int], int] = {}
    for name in names:
        found = _RANDOM.fullmatch(name)
        if not (found and found[1] in forms()):
            continue
        key, number = (found[1], int(found[2])), int(found[3])
        seeds = {seed for _, seed in most} | {key[1]}
        if number > MAX_RANDOM or len(seeds) > MAX_SEEDS:
            fix = (
                f"Use problems with numbers up to {MAX_RANDOM:,}, and at most {MAX_SEEDS} "
                "different seeds"
            )
            problems.append(
                Problem(
                    f"answers.{name}",
                    "the name of this random problem in answers has too high a number, or "
                    "one seed too many",
                    fix,
                )
            )
        else:
            most[key] = max(most.get(key, 0), number)
    return most, problems
