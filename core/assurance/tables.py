"""Outcomes for people and programs: rows of words, Markdown, JSON, a dataset."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from vibrafeed.core.assurance.case import RELATIONS, Case
from vibrafeed.core.assurance.catalogue import FAMILIES, NOT_CLAIMED
from vibrafeed.core.assurance.judge import Outcome, Summary, summaries
from vibrafeed.core.dataset.markdown import markdown_table
from vibrafeed.core.dataset.table import CONVENTIONS, Table, TableVariable

FORMAT = "vibrafeed-outcomes-1"


def number(value: float, tolerance: float, most: int = 15) -> str:
    """Return a number as text, with one digit more than its tolerance justifies.

    There are 3 digits at least and `most` at most; "none" if the number is not finite.
    """
    if not math.isfinite(value):
        return "none"
    if value == 0:
        return "0"
    if tolerance == 0:
        return f"{value:.3g}"
    digits = 2 - math.floor(math.log10(tolerance / abs(value)))
    return f"{value:.{min(max(digits, 3), most)}g}"


def expected(case: Case) -> str:
    """Return the expected value as text, as its source writes it if short."""
    said = case.digits or number(case.right.value, case.right.tolerance)
    return f"{RELATIONS[case.relation]}{said}"


def verdict(outcome: Outcome) -> str:
    """Return the verdict on a case in one or two words."""
    if outcome.passed:
        return "right" if outcome.judged else "not judged"
    return f"wrong: {outcome.note}" if outcome.note else "wrong"


def _value(outcome: Outcome) -> str:
    """Return the value of an outcome as text."""
    return number(outcome.value, outcome.case.right.tolerance)


def _off(outcome: Outcome) -> str:
    """Return the error of a validation problem as text for a table; empty where none is judged.

    `outcome` has the error in the unit of the problem, NaN if it is not judged.
    """
    error = outcome.error
    if math.isnan(error):
        return ""
    return f"{error:.1e}" if 0 < error < 1e-2 else f"{error:.3g}"


def _unit(outcome: Outcome) -> str:
    """Return the unit of an outcome; empty if dimensionless."""
    return "" if outcome.case.unit == "1" else outcome.case.unit


def _two_digits(value: float) -> str:
    """Return a number with two digits; empty for NaN."""
    return "" if math.isnan(value) else f"{value:.2g}"


Columns = Mapping[str, Callable[[Outcome], str]]

COLUMNS: Columns = {
    "problem": lambda outcome: outcome.case.id,
    "what": lambda outcome: outcome.case.title,
    "found": _value,
    "expected": lambda outcome: expected(outcome.case),
    "unit": _unit,
    "off by": _off,
    "allowed": lambda o: f"{o.case.right.tolerance:.1g}" if o.judged else "",
    "is": verdict,
}
"""Columns of `vibrafeed validate`."""

HARD_COLUMNS: Columns = {
    "case": lambda outcome: outcome.case.id,
    "status": lambda outcome: outcome.status,
    "error": lambda outcome: _two_digits(outcome.error),
    "allowed": lambda outcome: _two_digits(outcome.allowed),
    "seconds": lambda outcome: f"{outcome.seconds:.2f}",
    "is": lambda outcome: "right" if outcome.passed else "**wrong**",
    "note": lambda outcome: outcome.remark,
}
"""Columns of the hard cases in a report."""

FAMILY_COLUMNS = ("family", "problems", "right", "closest call", "found", "expected",
                  "off by", "allowed")  # fmt: skip


def rows(outcomes: Sequence[Outcome], columns: Columns = COLUMNS) -> list[tuple[str, ...]]:
    """Return a table row for each outcome."""
    return [tuple(cell(outcome) for cell in columns.values()) for outcome in outcomes]


def family_rows(families: Sequence[Summary]) -> list[tuple[str, ...]]:
    """Return a table row of `FAMILY_COLUMNS` for each family."""
    return [_family_row(summary) for summary in families]


def _family_row(summary: Summary) -> tuple[str, ...]:
    """Return the row of a family in the table of `vibrafeed validate`: counts and its worst case.

    `summary` has the numbers of judged and right cases and the case nearest to its tolerance, which
    may be missing.
    """
    name = f"{summary.family}: {FAMILIES[summary.family]}"
    counts = (name, f"{summary.judged:,}", f"{summary.passed:,}")
    if summary.worst is None:
        return (*counts, "", "", "", "", "")
    unit = f" {_unit(summary.worst)}".rstrip()
    case, _, value, right, _, off, allowed, _ = rows([summary.worst])[0]
    return (*counts, case, value + unit, right + unit, off, allowed)


def sentence(outcomes: Sequence[Outcome], program: str) -> str:
    """Return a sentence on how many validation problems a program solved.

    `program` is its name. Outcomes that are shown beside a measurement and not judged are counted
    apart.
    """
    judged = [outcome for outcome in outcomes if outcome.judged]
    failures = sum(not outcome.passed for outcome in judged)
    shown = len(outcomes) - len(judged)
    more = f" {shown} more are shown and not judged." if shown else ""
    if not failures:
        return f"{program}: all of {len(judged):,} problems are right.{more}"
    return f"{program}: {failures:,} of {len(judged):,} problems are wrong.{more}"


def document(outcomes: Sequence[Outcome], program: str) -> dict[str, Any]:
    """Return the outcomes of validation as plain values for a JSON file.

    `program` is the name of the program that was judged. Counts of judged and right problems stand
    above a list of families and a list of all outcomes.
    """
    judged = [outcome for outcome in outcomes if outcome.judged]
    return {
        "format": FORMAT,
        "program": program,
        "judged": len(judged),
        "right": sum(outcome.passed for outcome in judged),
        "families": [
            {
                "family": family.family, "title": FAMILIES[family.family], "judged": family.judged,
                "right": family.passed, "worst": family.worst.case.id if family.worst else None,
            }
            for family in summaries(outcomes)
        ],
        "outcomes": [_outcome(outcome) for outcome in outcomes],
    }  # fmt: skip


def _outcome(outcome: Outcome) -> Mapping[str, Any]:
    """Return the outcome of a validation problem as plain values: found, expected, verdict."""
    case = outcome.case
    return {
        "id": case.id, "family": case.family, "title": case.title, "source": case.right.source,
        "truth": case.evidence, "found": outcome.value, "relation": case.relation,
        "expected": case.right.value, "unit": case.unit,
        "difference": math.inf if math.isnan(outcome.error) else outcome.error,
        "tolerance": case.right.tolerance, "judged": outcome.judged, "right": outcome.passed,
        "note": outcome.note,
    }  # fmt: skip


def markdown(outcomes: Sequence[Outcome], program: str) -> str:
    """Return the outcomes of validation as a Markdown page: a table of families, then of cases.

    `program` is the name of the program that was judged.
    """
    lines = ["# Validation", "", sentence(outcomes, program), ""]
    lines += [*markdown_table(FAMILY_COLUMNS, family_rows(summaries(outcomes))), ""]
    for family in dict.fromkeys(outcome.case.family for outcome in outcomes):
        mine = [outcome for outcome in outcomes if outcome.case.family == family]
        lines += [
            f"## {family}: {FAMILIES[family]}",
            "",
            *markdown_table((*COLUMNS,), rows(mine)),
            "",
        ]
    lines += ["## No claim of this program", ""]
    lines += [f"- {name}: {words}" for name, words in NOT_CLAIMED.items()]
    return "\n".join(lines) + "\n"


def hard_cases_table(outcomes: Sequence[Outcome]) -> Table:
    """Return the outcomes of hard cases as a table over the dimension `case`, to be stored.

    It has family, status, error, allowed error, run time [s], verdict and note of each.
    """

    def variable(values: Sequence[Any], kind: type, label: str, **more: Any) -> TableVariable:
        """Return a variable over cases."""
        return TableVariable(("case",), np.array(values, kind), {"long_name": label, **more})

    def text(name: str, label: str) -> TableVariable:
        """Return a text variable over cases."""
        return variable([getattr(outcome, name) for outcome in outcomes], object, label)

    def real(name: str, label: str, unit: str) -> TableVariable:
        """Return a variable of reals over cases."""
        values = [getattr(outcome, name) for outcome in outcomes]
        return variable(values, np.float64, label, units=unit)

    names = [outcome.case.id for outcome in outcomes]
    families = [outcome.case.family for outcome in outcomes]
    flags = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "failed passed"}
    passed = [outcome.passed for outcome in outcomes]
    return Table(
        {"case": variable(names, object, "Name of the case")},
        {
            "family": variable(families, object, "What it is hard for"),
            "status": text("status", "Status or regime"),
            "error": real("error", "Error, in the unit of the judged output", "1"),
            "stated_error": real("allowed", "Largest error that is right", "1"),
            "seconds": real("seconds", "Run time", "s"),
            "passed": variable(passed, np.int8, "Whether it is right", **flags),
            "note": text("remark", "Source of the reference, or what is wrong"),
        },
        {"Conventions": CONVENTIONS, "title": "Hard cases"},
    )


def hard_cases_markdown(outcomes: Sequence[Outcome], untried: int = 0) -> str:
    """Return the outcomes of hard cases as Markdown: the worst of each family, then all.

    `untried` is the number of cases that had not been run when the comparison was stopped.
    """
    failed = sum(not outcome.passed for outcome in outcomes)
    took = sum(outcome.seconds for outcome in outcomes)
    stopped = (
        f"The comparison was stopped: {untried} of {untried + len(outcomes)} cases were not tried."
    )
    worst = [family.worst for family in summaries(outcomes) if family.worst]
    with_family: Columns = {"family": lambda outcome: outcome.case.family, **HARD_COLUMNS}
    return "\n".join(
        [
            *([stopped, ""] if untried else []),
            f"{len(outcomes)} hard cases in {took:.0f} s: {len(outcomes) - failed} right, "
            f"{failed} wrong. Warnings count as wrong, and so does what is not finite if no status "
            "says why.",
            "",
            "Error: of the judged output, in its unit. Allowed: what is stated for it, by the "
            "method itself or by the reference that the note names; where both are left out the "
            "case is judged by its status, or has to be refused.",
            "",
            "### Worst of each family",
            "",
            *markdown_table((*with_family,), rows(worst, with_family)),
            "",
            "### All cases",
            "",
            *markdown_table((*HARD_COLUMNS,), rows(outcomes, HARD_COLUMNS)),
            "",
        ]
    )
