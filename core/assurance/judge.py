"""Answers to problems: this program's own, by its studies, and how all answers are judged."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from core import kinds
from core.assurance.case import Content, KnownProblem, Term
from core.dataset.table import Table
from core.errors import VibrafeedError
from core.intake import prepare_content
from core.watch import Watch


@dataclass(frozen=True)
class Outcome:
    """What became of a problem.

    Attributes
    ----------
    problem : KnownProblem
    found : float
        The answer; NaN where there is none.
    note : str
        Why there is none.
    """

    problem: KnownProblem
    found: float
    note: str = ""

    @property
    def passed(self) -> bool:
        """Whether the answer is right; one that is only shown is if there is one."""
        return not self.note and self.problem.holds(self.found)

    @property
    def judged(self) -> bool:
        """Whether the answer is judged at all."""
        return self.problem.relation != "shown"

    @property
    def miss(self) -> float:
        """By how much the answer misses; infinite where there is none."""
        return self.problem.miss(self.found)


@dataclass(frozen=True)
class Summary:
    """How many problems of a family were judged and right, and the one nearest to its tolerance."""

    family: str
    judged: int
    passed: int
    worst: Outcome | None


def solve(problems: Sequence[KnownProblem], watch: Watch | None = None) -> list[Outcome]:
    """Return this program's own outcomes, in order; `watch` may stop it early."""
    watch = watch or Watch()
    outcomes: list[Outcome] = []
    for problem in problems:
        if watch.stopped():
            break
        outcomes.append(_solved(problem))
        watch.advance(1 / len(problems))
    return outcomes


def _solved(problem: KnownProblem) -> Outcome:
    """Return what this program's studies answer."""
    try:
        outputs = outputs_of(problem.terms)
    except VibrafeedError as error:
        return Outcome(problem, math.nan, f"refused: {error}")
    found = problem.answer(outputs)
    return Outcome(problem, found, "" if math.isfinite(found) else "it has no value")


def outputs_of(terms: Sequence[Term]) -> list[float]:
    """Return the output of each term; what differs in outputs alone is one study.

    Raises
    ------
    StudyError
        If a study is refused.
    """
    studies: dict[str, Content] = {}
    keys = []
    for term in terms:
        rest = {name: value for name, value in term.study.items() if name != "outputs"}
        key = json.dumps(rest, sort_keys=True)
        keys.append(key)
        before = studies.get(key, {"outputs": ()})["outputs"]
        names = list(dict.fromkeys((*before, *term.study["outputs"])))
        studies[key] = {**term.study, "outputs": names}
    tables = {key: kinds.tabulate(prepare_content(content)) for key, content in studies.items()}
    return [_picked(tables[key], term) for key, term in zip(keys, terms, strict=True)]


def _picked(table: Table, term: Term) -> float:
    """Return the one number of an output that a term names."""
    values = np.asarray(table.variables[term.output].values, dtype=np.float64)
    if term.pick == "value":
        return values.item()
    ends = {"first": 0, "last": -1}
    if term.pick in ends:
        return float(values[ends[term.pick]])
    return float(values.min() if term.pick == "least" else values.max())


def judge(problems: Iterable[KnownProblem], answers: Mapping[str, float | None]) -> list[Outcome]:
    """Return the outcomes of another program's answers; what it left out is no outcome."""
    return [
        Outcome(problem, math.nan, "it has no answer")
        if answers[problem.id] is None
        else Outcome(problem, float(answers[problem.id] or 0.0))
        for problem in problems
        if problem.id in answers
    ]


def summaries(outcomes: Sequence[Outcome]) -> list[Summary]:
    """Return a summary of each family, in the order of the outcomes."""
    found = []
    for family in dict.fromkeys(outcome.problem.family for outcome in outcomes):
        judged = [o for o in outcomes if o.problem.family == family and o.judged]
        worst = max(judged, key=_share, default=None)
        passed = sum(outcome.passed for outcome in judged)
        found.append(Summary(family, len(judged), passed, worst))
    return found


def _share(outcome: Outcome) -> float:
    """Return how much of its tolerance a miss takes."""
    if not outcome.passed:
        return math.inf
    return outcome.miss / outcome.problem.tolerance if outcome.miss > 0 else 0.0
