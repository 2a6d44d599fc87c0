"""The hard cases, carried out and judged: no warning, no error, no inf or NaN without a status."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from core import kinds
from core.assurance.hard_cases import HARD_CASES, HardCase, result_of
from core.assurance.textbook import TextbookValue
from core.dataset.markdown import markdown_table
from core.dataset.table import CONVENTIONS, Table, TableVariable
from core.errors import StudyError
from core.intake import prepare_content
from core.mechanics.arrays import Array
from core.quantities import MOTION_STATUSES, REGIMES, Flag
from core.watch import Watch

__all__ = [
    "CaseOutcome",
    "ComputedCase",
    "carry_out",
    "judge",
    "result_of",
    "run_case",
    "run_catalogue",
    "to_markdown",
    "to_table",
]  # fmt: skip

STATED = "conveying_velocity_error"

WITHOUT_VALUE = {"unbounded", "no_motion", "stopped"}
"""Valid regimes that explain a value that is not finite; all that are not valid do so too."""


@dataclass(frozen=True)
class CaseOutcome:
    """What became of a hard case.

    Attributes
    ----------
    name, family : str
        Those of the case.
    status : str
        Statuses or regimes of its cells; `refused`, `warning` or `error` where there are none.
    error, stated_error : float
        The largest error, and what was stated for it; NaN where none is judged. Of arrays those of
        the cell where the first is the largest share of the second.
    seconds : float
        How long it took.
    passed : bool
        Whether status and error are as they should be.
    note : str
        What was wrong, or where the reference comes from.
    """

    name: str
    family: str
    status: str
    error: float
    stated_error: float
    seconds: float
    passed: bool
    note: str

    @property
    def share(self) -> float:
        """The error over the stated one; 0 where there is none to judge, infinite if it failed."""
        if not self.passed:
            return math.inf
        if not self.error > 0:
            return 0.0
        return self.error / self.stated_error


@dataclass(frozen=True)
class ComputedCase:
    """What the study of a case gave, and what is right for it.

    Attributes
    ----------
    statuses : frozenset of str
        Names of the statuses or regimes of all cells.
    explained : bool
        Whether one of them says why a value is missing.
    value : ndarray
        The judged output.
    stated : ndarray or None
        The error that the method states for its conveying velocity; None where it states none.
    answer : TextbookValue or None
        The right value; None where the case is judged by its status.
    """

    statuses: frozenset[str]
    explained: bool
    value: Array
    stated: Array | None
    answer: TextbookValue | None


Verdict = tuple[str, float, float, bool, str]
"""Status, error, stated error, whether the case passed, and a note."""


def run_case(case: HardCase, watch: Watch | None = None) -> CaseOutcome:
    """Return what becomes of a case; warnings count as errors."""
    return carry_out(case, watch)[0]


def carry_out(
    case: HardCase, watch: Watch | None = None
) -> tuple[CaseOutcome, ComputedCase | None]:
    """Return what becomes of a case, and what was computed; None where it was no study's result."""
    started = time.perf_counter()
    computed = None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            result = _computed(case, watch)
            if isinstance(result, ComputedCase):
                computed, result = result, judge(case, result)
            status, error, stated, passed, note = result
        except Warning as warning:
            status, error, stated, passed = "warning", math.nan, math.nan, False
            note = f"{type(warning).__name__}: {warning}"
        except Exception as failure:  # a case must not end the catalogue, whatever is wrong
            status, error, stated, passed = "error", math.nan, math.nan, False
            note = f"{type(failure).__name__}: {failure}"
    took = time.perf_counter() - started
    return CaseOutcome(case.name, case.family, status, error, stated, took, passed, note), computed


def _computed(case: HardCase, watch: Watch | None) -> ComputedCase | Verdict:
    """Return what the study gives, or the verdict where nothing of it is left to judge."""
    if case.attempt is not None:
        error, allowed, note = case.attempt()
        return "attempted", error, allowed, error <= allowed, note
    try:
        prepared = prepare_content(case.content)
    except StudyError as refusal:
        places = [problem.place for problem in refusal.problems]
        named = bool(case.refused) and places == [case.refused]
        note = str(refusal.problems[0]) if named else f"refused: {refusal}"
        return "refused", math.nan, math.nan, named, note
    if case.refused:
        return "accepted", math.nan, math.nan, False, f"{case.refused} should be refused"
    variables = kinds.tabulate(prepared, watch).variables
    names, explained = _statuses(variables)
    value = np.asarray(variables[case.output].values, dtype=np.float64)
    stated = None
    if STATED in variables:
        stated = np.asarray(variables[STATED].values, dtype=np.float64)
    answer = case.answer() if case.answer else None
    return ComputedCase(frozenset(names), explained, value, stated, answer)


def judge(case: HardCase, computed: ComputedCase) -> Verdict:
    """Return the verdict on what a case's study gave; nothing is computed anew."""
    value, said, answer = computed.value, computed.stated, computed.answer
    status = ", ".join(sorted(computed.statuses))

    def wrong(note: str) -> Verdict:
        return status, math.nan, math.nan, False, note

    if case.status and not computed.statuses <= set(case.status):
        return wrong(f"not {' or '.join(case.status)}")
    finite = np.isfinite(value)
    if not computed.explained and not np.all(finite):
        return wrong("not finite, and nothing says why")
    if said is not None and not np.all(np.isfinite(said[finite])):
        return wrong("finite, with a stated error that is not")
    if answer is None:
        return status, math.nan, math.nan, True, "judged by its status"
    right = np.broadcast_to(answer.value, value.shape)
    allowed = np.broadcast_to(answer.error, value.shape)
    if said is not None and not case.blunt and case.output == "conveying_velocity":
        size = np.where(right == 0, _drive_speed(case.content), np.abs(right))
        if np.any(said[finite] > size[finite]):
            return wrong("the stated error is larger than what it is stated for")
    if case.says:
        if said is None:
            return wrong("no error is stated")
        allowed = allowed + np.where(finite, said, 0.0)
    same = (value == right) | (np.isnan(value) & np.isnan(right))
    with np.errstate(invalid="ignore"):
        errors = np.where(same, 0.0, np.abs(value - right))
    worst = np.unravel_index(np.argmax(_shares(errors, allowed)), errors.shape)
    error, stated = float(errors[worst]), float(allowed[worst])
    return status, error, stated, error <= stated, answer.source


def _drive_speed(content: Mapping[str, Any]) -> float:
    """Return the largest speed of the track, which a stated error of a value of 0 stands beside."""
    given = content["parameters"]
    return 2 * math.pi * float(np.max(given["frequency"])) * float(np.max(given["amplitude"]))


def _shares(error: Any, stated: Any) -> Any:
    """Return the error over the stated one, infinite where there should be none; NaN is worst."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        share = np.where(error == 0, 0.0, error / stated)
    return np.where(np.isnan(share), np.inf, share)


def _statuses(variables: Mapping[str, TableVariable]) -> tuple[set[str], bool]:
    """Return the names of the statuses of all cells, and whether one explains a missing value."""
    regimes = _present(variables["regime"], REGIMES) if "regime" in variables else {}
    statuses = regimes
    if "motion_status" in variables:
        statuses = _present(variables["motion_status"], MOTION_STATUSES)
    explained = (
        all(not flag.valid or name in WITHOUT_VALUE for name, flag in flags.items())
        for flags in (statuses, regimes)
        if flags
    )
    return set(statuses), any(explained)


def _present(variable: TableVariable, flags: Mapping[str, Flag]) -> dict[str, Flag]:
    """Return the flags that stand in a variable."""
    values = set(np.unique(variable.values).tolist())
    return {name: flag for name, flag in flags.items() if flag.value in values}


def run_catalogue(
    watch: Watch | None = None, cases: Sequence[HardCase] = HARD_CASES
) -> list[CaseOutcome]:
    """Return what becomes of every case, in order; those not started when stopped are left out."""
    watch = watch or Watch()
    outcomes = []
    for case in cases:
        if watch.stopped():
            break
        outcomes.append(run_case(case))
        watch.advance(1 / len(cases))
    return outcomes


def worst_of_families(outcomes: Iterable[CaseOutcome]) -> list[CaseOutcome]:
    """Return, for each family, the outcome whose error is the largest share of the stated one."""
    worst: dict[str, CaseOutcome] = {}
    for outcome in outcomes:
        known = worst.get(outcome.family)
        if known is None or outcome.share > known.share:
            worst[outcome.family] = outcome
    return list(worst.values())


def to_table(outcomes: Sequence[CaseOutcome]) -> Table:
    """Return the outcomes as variables over the dimension `case`."""
    dims = ("case",)

    def text(name: str, label: str) -> TableVariable:
        values = np.array([getattr(outcome, name) for outcome in outcomes], dtype=object)
        return TableVariable(dims, values, {"long_name": label})

    def number(name: str, label: str, unit: str) -> TableVariable:
        values = np.array([getattr(outcome, name) for outcome in outcomes], dtype=np.float64)
        return TableVariable(dims, values, {"long_name": label, "units": unit})

    passed = np.array([outcome.passed for outcome in outcomes], dtype=np.int8)
    flags = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "failed passed"}
    return Table(
        {"case": text("name", "Name of the case")},
        {
            "family": text("family", "What it is hard for"),
            "status": text("status", "Status or regime"),
            "error": number("error", "Error, in the unit of the judged output", "1"),
            "stated_error": number("stated_error", "Largest error that is right", "1"),
            "seconds": number("seconds", "Run time", "s"),
            "passed": TableVariable(dims, passed, {"long_name": "Whether it is right", **flags}),
            "note": text("note", "Source of the reference, or what is wrong"),
        },
        {"Conventions": CONVENTIONS, "title": "Hard cases"},
    )


def to_markdown(outcomes: Sequence[CaseOutcome], untried: int = 0) -> str:
    """Return the outcomes as Markdown: the worst of each family first, then all.

    `untried` is how many cases were left when it was stopped.
    """
    failed = sum(not outcome.passed for outcome in outcomes)
    took = sum(outcome.seconds for outcome in outcomes)
    stopped = f"It was stopped: {untried} of {untried + len(outcomes)} cases were not tried."
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
            *_rows(worst_of_families(outcomes), family=True),
            "",
            "### All cases",
            "",
            *_rows(outcomes, family=False),
            "",
        ]
    )


def _rows(outcomes: Sequence[CaseOutcome], *, family: bool) -> list[str]:
    columns = ("case", "status", "error", "allowed", "seconds", "is", "note")
    rows = [
        (
            *([outcome.family] if family else []),
            outcome.name,
            outcome.status,
            "" if math.isnan(outcome.error) else f"{outcome.error:.2g}",
            "" if math.isnan(outcome.stated_error) else f"{outcome.stated_error:.2g}",
            f"{outcome.seconds:.2f}",
            "right" if outcome.passed else "**wrong**",
            outcome.note,
        )
        for outcome in outcomes
    ]
    return markdown_table((*(["family"] if family else []), *columns), rows)
