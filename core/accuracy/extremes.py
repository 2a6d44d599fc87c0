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
from core.accuracy.hard_cases import HARD_CASES, HardCase, result_of
from core.dataset.table import CONVENTIONS, Table, Variable
from core.errors import StudyError
from core.quantities import MOTION_STATUSES, REGIMES, Flag
from core.watch import Watch

__all__ = ["Outcome", "result_of", "run_case", "run_catalogue", "to_markdown", "to_table"]

WITHOUT_VALUE = {"unbounded", "no_motion", "stopped"}
"""Valid regimes that explain a value that is not finite; all that are not valid do so too."""


@dataclass(frozen=True)
class Outcome:
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


def run_case(case: HardCase, watch: Watch | None = None) -> Outcome:
    """Return what becomes of a case; warnings count as errors."""
    started = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            status, error, stated, passed, note = _judged(case, watch)
        except Warning as warning:
            status, error, stated, passed = "warning", math.nan, math.nan, False
            note = f"{type(warning).__name__}: {warning}"
        except Exception as failure:  # a case must not end the catalogue, whatever is wrong
            status, error, stated, passed = "error", math.nan, math.nan, False
            note = f"{type(failure).__name__}: {failure}"
    took = time.perf_counter() - started
    return Outcome(case.name, case.family, status, error, stated, took, passed, note)


def _judged(case: HardCase, watch: Watch | None) -> tuple[str, float, float, bool, str]:
    """Return status, error, stated error, whether it passed, and a note."""
    if case.attempt is not None:
        error, stated, note = case.attempt()
        return "attempted", error, stated, error <= stated, note
    try:
        prepared = kinds.prepare_content(case.content)
    except StudyError as refusal:
        places = [problem.place for problem in refusal.problems]
        named = bool(case.refused) and places == [case.refused]
        note = str(refusal.problems[0]) if named else f"refused: {refusal}"
        return "refused", math.nan, math.nan, named, note
    if case.refused:
        return "accepted", math.nan, math.nan, False, f"{case.refused} should be refused"
    variables = kinds.tabulate(prepared, watch).variables
    names, explained = _statuses(variables)
    status = ", ".join(sorted(names))
    if case.status and not names <= set(case.status):
        return status, math.nan, math.nan, False, f"not {' or '.join(case.status)}"
    value = np.asarray(variables[case.output].values, dtype=np.float64)
    if not explained and not np.all(np.isfinite(value)):
        return status, math.nan, math.nan, False, "not finite, and nothing says why"
    if case.answer is None:
        return status, math.nan, math.nan, True, "judged by its status"
    answer = case.answer()
    right = np.broadcast_to(answer.value, value.shape)
    allowed = np.broadcast_to(answer.error, value.shape)
    if case.says:
        allowed = allowed + np.nan_to_num(variables["conveying_velocity_error"].values)
    same = (value == right) | (np.isnan(value) & np.isnan(right))
    with np.errstate(invalid="ignore"):
        errors = np.where(same, 0.0, np.abs(value - right))
    worst = np.unravel_index(np.argmax(_shares(errors, allowed)), errors.shape)
    error, stated = float(errors[worst]), float(allowed[worst])
    return status, error, stated, error <= stated, answer.source


def _shares(error: Any, stated: Any) -> Any:
    """Return the error over the stated one, infinite where there should be none; NaN is worst."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        share = np.where(error == 0, 0.0, error / stated)
    return np.where(np.isnan(share), np.inf, share)


def _statuses(variables: Mapping[str, Variable]) -> tuple[set[str], bool]:
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


def _present(variable: Variable, flags: Mapping[str, Flag]) -> dict[str, Flag]:
    """Return the flags that stand in a variable."""
    values = set(np.unique(variable.values).tolist())
    return {name: flag for name, flag in flags.items() if flag.value in values}


def run_catalogue(
    watch: Watch | None = None, cases: Sequence[HardCase] = HARD_CASES
) -> list[Outcome]:
    """Return what becomes of every case, in order; those not started when stopped are left out."""
    watch = watch or Watch()
    outcomes = []
    for case in cases:
        if watch.stopped():
            break
        outcomes.append(run_case(case))
        watch.advance(1 / len(cases))
    return outcomes


def worst_of_families(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Return, for each family, the outcome whose error is the largest share of the stated one."""
    worst: dict[str, Outcome] = {}
    for outcome in outcomes:
        known = worst.get(outcome.family)
        if known is None or outcome.share > known.share:
            worst[outcome.family] = outcome
    return list(worst.values())


def to_table(outcomes: Sequence[Outcome]) -> Table:
    """Return the outcomes as variables over the dimension `case`."""
    dims = ("case",)

    def text(name: str, label: str) -> Variable:
        values = np.array([getattr(outcome, name) for outcome in outcomes], dtype=object)
        return Variable(dims, values, {"long_name": label})

    def number(name: str, label: str, unit: str) -> Variable:
        values = np.array([getattr(outcome, name) for outcome in outcomes], dtype=np.float64)
        return Variable(dims, values, {"long_name": label, "units": unit})

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
            "passed": Variable(dims, passed, {"long_name": "Whether it is right", **flags}),
            "note": text("note", "Source of the reference, or what is wrong"),
        },
        {"Conventions": CONVENTIONS, "title": "Hard cases"},
    )


def to_markdown(outcomes: Sequence[Outcome], untried: int = 0) -> str:
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


def _rows(outcomes: Sequence[Outcome], *, family: bool) -> list[str]:
    first = "| family " if family else ""
    rows = [
        f"{first}| case | status | error | allowed | seconds | is | note |",
        "| --- " * (8 if family else 7) + "|",
    ]
    for outcome in outcomes:
        cells = [outcome.family] if family else []
        cells += [
            outcome.name,
            outcome.status,
            "" if math.isnan(outcome.error) else f"{outcome.error:.2g}",
            "" if math.isnan(outcome.stated_error) else f"{outcome.stated_error:.2g}",
            f"{outcome.seconds:.2f}",
            "right" if outcome.passed else "**wrong**",
            " ".join(outcome.note.split()).replace("|", "\\|"),
        ]
        rows.append("| " + " | ".join(cells) + " |")
    return rows
