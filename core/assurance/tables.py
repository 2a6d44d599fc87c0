"""Outcomes for people and programs: a table in words, Markdown, JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from core.assurance.case import RELATIONS, KnownProblem
from core.assurance.catalogue import FAMILIES, NOT_CLAIMED
from core.assurance.judge import Outcome, Summary, summaries
from core.dataset.markdown import markdown_table

FORMAT = "vibrafeed-outcomes-1"
FAMILY_COLUMNS = ("family", "problems", "right", "closest call", "found", "expected",
                  "off by", "allowed")  # fmt: skip
COLUMNS = ("problem", "what", "found", "expected", "unit", "off by", "allowed", "is")


def number(value: float, tolerance: float, most: int = 15) -> str:
    """Return a value with as many digits as its tolerance tells, and one more, or so at most."""
    if not math.isfinite(value):
        return "none"
    if value == 0:
        return "0"
    if tolerance == 0:
        return f"{value:.3g}"
    digits = 2 - math.floor(math.log10(tolerance / abs(value)))
    return f"{value:.{min(max(digits, 3), most)}g}"


def expected(problem: KnownProblem) -> str:
    """Return what is expected, as its source writes it if that has few digits."""
    said = problem.digits or number(problem.expected, problem.tolerance)
    return f"{RELATIONS[problem.relation]}{said}"


def verdict(outcome: Outcome) -> str:
    """Return what became of a problem, in a word or two."""
    if outcome.note:
        return f"wrong: {outcome.note}"
    if not outcome.judged:
        return "not judged"
    return "right" if outcome.passed else "wrong"


def rows(outcomes: Sequence[Outcome]) -> list[tuple[str, ...]]:
    """Return a row of `COLUMNS` for each outcome."""
    return [
        (
            outcome.problem.id,
            outcome.problem.title,
            number(outcome.found, outcome.problem.tolerance),
            expected(outcome.problem),
            "" if outcome.problem.unit == "1" else outcome.problem.unit,
            _off(outcome),
            f"{outcome.problem.tolerance:.1g}" if outcome.judged else "",
            verdict(outcome),
        )
        for outcome in outcomes
    ]


def family_rows(found: Sequence[Summary]) -> list[tuple[str, ...]]:
    """Return a row of `FAMILY_COLUMNS` for each family."""
    return [_family_row(summary) for summary in found]


def _family_row(summary: Summary) -> tuple[str, ...]:
    name = f"{summary.family}: {FAMILIES[summary.family]}"
    counts = (name, f"{summary.judged:,}", f"{summary.passed:,}")
    if summary.worst is None:
        return (*counts, "", "", "", "", "")
    problem = summary.worst.problem
    unit = "" if problem.unit == "1" else f" {problem.unit}"
    return (
        *counts,
        problem.id,
        number(summary.worst.found, problem.tolerance) + unit,
        expected(problem) + unit,
        _off(summary.worst),
        f"{problem.tolerance:.1g}",
    )


def _off(outcome: Outcome) -> str:
    if outcome.note:
        return ""
    return f"{outcome.miss:.1e}" if 0 < outcome.miss < 1e-2 else f"{outcome.miss:.3g}"


def sentence(outcomes: Sequence[Outcome], program: str) -> str:
    """Return how many were right, in a sentence."""
    judged = [outcome for outcome in outcomes if outcome.judged]
    wrong = sum(not outcome.passed for outcome in judged)
    shown = len(outcomes) - len(judged)
    more = f" {shown} more are shown and not judged." if shown else ""
    if not wrong:
        return f"{program}: all of {len(judged):,} problems are right.{more}"
    return f"{program}: {wrong:,} of {len(judged):,} problems are wrong.{more}"


def document(outcomes: Sequence[Outcome], program: str) -> dict[str, Any]:
    """Return outcomes as plain values, for JSON."""
    judged = [outcome for outcome in outcomes if outcome.judged]
    return {
        "format": FORMAT,
        "program": program,
        "judged": len(judged),
        "right": sum(outcome.passed for outcome in judged),
        "families": [
            {
                "family": one.family, "title": FAMILIES[one.family], "judged": one.judged,
                "right": one.passed, "worst": one.worst.problem.id if one.worst else None,
            }
            for one in summaries(outcomes)
        ],
        "outcomes": [_outcome(outcome) for outcome in outcomes],
    }  # fmt: skip


def _outcome(outcome: Outcome) -> Mapping[str, Any]:
    problem = outcome.problem
    return {
        "id": problem.id, "family": problem.family, "title": problem.title,
        "source": problem.source, "truth": problem.truth, "found": outcome.found,
        "relation": problem.relation, "expected": problem.expected, "unit": problem.unit,
        "difference": outcome.miss, "tolerance": problem.tolerance, "judged": outcome.judged,
        "right": outcome.passed, "note": outcome.note,
    }  # fmt: skip


def markdown(outcomes: Sequence[Outcome], program: str) -> str:
    """Return outcomes as a page: families first, then every problem."""
    lines = ["# Validation", "", sentence(outcomes, program), ""]
    lines += [*markdown_table(FAMILY_COLUMNS, family_rows(summaries(outcomes))), ""]
    for family in dict.fromkeys(outcome.problem.family for outcome in outcomes):
        mine = [outcome for outcome in outcomes if outcome.problem.family == family]
        lines += [f"## {family}: {FAMILIES[family]}", "", *markdown_table(COLUMNS, rows(mine)), ""]
    lines += ["## No claim of this program", ""]
    lines += [f"- {name}: {words}" for name, words in NOT_CLAIMED.items()]
    return "\n".join(lines) + "\n"
