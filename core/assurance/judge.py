"""The judge of cases: it runs their studies, or reads another program's results, and compares."""

from __future__ import annotations

import json
import math
import time
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibrafeed.core import kinds
from vibrafeed.core.assurance.case import Case, CaseValues, Content, Term, Truth
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.quantities import MOTION_STATUSES, REGIMES, Flag
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.watch import Watch

STATED = "conveying_velocity_error"

WITHOUT_VALUE = {"unbounded", "no_motion", "stopped", "no_pass"}
"""Valid regimes that explain a value that is not finite; all that are not valid do so too."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of a case.

    Attributes
    ----------
    case : Case
    value : float
        The result; NaN where there is none. Of arrays, here and below, that of the cell where the
        error is the largest share of what is allowed.
    error, allowed : float
        The error, and the largest that is right; NaN where none is judged.
    passed : bool
        True where status and error are as they should be; of a result that is only shown, where
        there is one.
    status : str
        Statuses or regimes of the cells; `refused`, `warning` or `error` where there are none.
    note : str
        What is wrong besides the error, or how the case was judged.
    seconds : float
        How long it took.
    """

    case: Case
    value: float = math.nan
    error: float = math.nan
    allowed: float = math.nan
    passed: bool = False
    status: str = ""
    note: str = ""
    seconds: float = 0.0

    @property
    def judged(self) -> bool:
        """True where the result is compared with a truth, not only shown."""
        return self.case.relation != "shown"

    @property
    def remark(self) -> str:
        """The note, or the source of the truth."""
        return self.note or (self.case.right.source if self.case.known else "")

    @property
    def share(self) -> float:
        """The error over the tolerance; 0 without a truth, infinite for a failed case."""
        if not self.passed:
            return math.inf
        return self.error / self.allowed if self.error > 0 else 0.0


@dataclass(frozen=True)
class Summary:
    """The numbers of judged and right cases of a family, and the one nearest to its tolerance."""

    family: str
    judged: int
    passed: int
    worst: Outcome | None


def run_cases(cases: Sequence[Case], watch: Watch | None = None) -> list[Outcome]:
    """Run the studies of cases with known results, and return an outcome for each, in order.

    When `watch` stops the work, the cases that were not begun are left out.
    """
    watch = watch or Watch()
    outcomes = []
    for case in cases:
        if watch.stopped():
            break
        outcomes.append(run_case(case)[0])
        watch.advance(1 / len(cases))
    return outcomes


def run_case(case: Case) -> tuple[Outcome, CaseValues | None]:
    """Run the study of one case with a known result; return its outcome and the values computed.

    No values (None) are returned where the study was refused or failed. Warnings and exceptions are
    caught and make a failed outcome, except for the refusal that the case expects.
    """
    started = time.perf_counter()
    computed = None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            computed = case.compute() if case.compute else _computed(case)
            outcome = judge(case, computed)
        except StudyError as refusal:
            named = [problem.place for problem in refusal.problems] == [case.refused]
            note = str(refusal.problems[0]) if named else f"refused: {refusal}"
            outcome = Outcome(case, passed=named, status="refused", note=note)
        except Exception as failure:  # a case must not end the others, whatever is wrong
            status = "warning" if isinstance(failure, Warning) else "error"
            outcome = Outcome(case, status=status, note=f"{type(failure).__name__}: {failure}")
    return replace(outcome, seconds=time.perf_counter() - started), computed


def judge_results(cases: Iterable[Case], results: Mapping[str, float | None]) -> list[Outcome]:
    """Return an outcome for each case that another program has answered.

    `results` has its numbers by the id of the case, None where it found none; a case that is not
    among them is left out.
    """
    return [
        Outcome(case, note="it has no answer")
        if (value := results[case.id]) is None
        else judge(case, CaseValues(np.asarray(value, dtype=np.float64)))
        for case in cases
        if case.id in results
    ]


def _incomplete(case: Case, computed: CaseValues) -> str:
    """Return a fault of the computed values of a case that shows without the truth; "" if none.

    That is a status or regime other than the case allows, a value that is not finite although no
    status explains it, or a finite value whose stated error is not finite.
    """
    if case.status and not computed.statuses <= set(case.status):
        return f"not {' or '.join(case.status)}"
    finite, stated = np.isfinite(computed.value), computed.stated
    if not computed.explained and not np.all(finite):
        return "not finite, and nothing says why"
    if stated is not None and not np.all(np.isfinite(stated[finite])):
        return "finite, with a stated error that is not"
    return ""


def _states_too_much(case: Case, truth: Truth, value: Array, stated: Array) -> bool:
    """True if the stated error of a mean velocity exceeds the velocity itself in some cell.

    Such an error would pass any result. Only cases whose output is the conveying velocity are
    looked at, and none that says why its error may be large (`blunt`).

    Parameters
    ----------
    case, truth : Case, Truth
        The case with its true value; where that is 0, the drive's largest speed takes its place.
    value, stated : ndarray
        Computed velocity and the error that the method states for it, over the cells.
    """
    if case.blunt or case.terms[0].output != "conveying_velocity":
        return False
    size = np.abs(np.broadcast_to(truth.value, np.shape(value)))
    size = np.where(size == 0, _drive_speed(case.terms[0].study), size)
    finite = np.isfinite(value)
    return bool(np.any(stated[finite] > size[finite]))


def judge(case: Case, computed: CaseValues) -> Outcome:
    """Compare the computed values of a case with its known result, and return the outcome.

    Of several cells, the outcome shows the one whose error is the largest share of what is allowed.
    The allowed error is the tolerance of the case, plus the error that the method itself states
    where the case says so. Without a known result only the status is judged.
    """
    value, stated = computed.value, computed.stated
    status = ", ".join(sorted(computed.statuses))
    failed = Outcome(case, status=status)
    if case.refused:
        return replace(failed, status="accepted", note=f"{case.refused} should be refused")
    note = _incomplete(case, computed)
    if note:
        return replace(failed, note=note)
    if case.truth is None:
        return replace(failed, passed=True, note="judged by its status")
    allowed = np.broadcast_to(case.truth.tolerance, np.shape(value))
    if stated is not None and _states_too_much(case, case.truth, value, stated):
        return replace(failed, note="the stated error is larger than the value itself")
    if case.states_error:
        if stated is None:
            return replace(failed, note="no error is stated")
        allowed = allowed + np.where(np.isfinite(value), stated, 0.0)
    errors = case.errors(value)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        shares = np.where(errors == 0, 0.0, errors / allowed)
    worst = np.unravel_index(np.argmax(shares), shares.shape)
    error, most = float(errors[worst]), float(allowed[worst])
    passed = case.relation == "shown" or error <= most
    return Outcome(case, float(value[worst]), error, most, passed, status, computed.note)


def summaries(outcomes: Sequence[Outcome]) -> list[Summary]:
    """Return the counts of judged and right cases, and the worst case, for each family of outcomes.

    Families come in the order of the outcomes. Outcomes that are only shown are not counted; worst
    is the case whose error is the largest share of what is allowed.
    """
    families = []
    for family in dict.fromkeys(outcome.case.family for outcome in outcomes):
        judged = [o for o in outcomes if o.case.family == family and o.judged]
        worst = max(judged, key=lambda outcome: outcome.share, default=None)
        passed = sum(outcome.passed for outcome in judged)
        families.append(Summary(family, len(judged), passed, worst))
    return families


def results_of(content: Content) -> Table:
    """Return the results of a study as a user would write it."""
    return kinds.tabulate(prepare_content(content))


def outputs_of(terms: Sequence[Term]) -> list[Any]:
    """Return the outputs of each term; studies that differ in outputs only are joined.

    Raises
    ------
    StudyError
        If a study is refused.
    """
    return _outputs(terms, _tables(terms))


def _computed(case: Case) -> CaseValues:
    """Run the studies of a case, and return its result with statuses and stated error.

    The study of a case that has to be refused is only prepared (which raises `StudyError`); the
    value is NaN if that does not happen.
    """
    if case.refused:
        prepare_content(case.terms[0].study)
        return CaseValues(np.asarray(math.nan))
    tables = _tables(case.terms)
    flags = [_statuses(table.variables) for table in tables.values()]
    stated = None
    if len(tables) == 1:
        (table,) = tables.values()
        if STATED in table.variables:
            stated = np.asarray(table.variables[STATED].values, dtype=np.float64)
    return CaseValues(
        np.asarray(case.result(_outputs(case.terms, tables)), dtype=np.float64),
        frozenset[str]().union(*(names for names, _ in flags)),
        any(explained for _, explained in flags),
        stated,
    )


def _key(term: Term) -> str:
    """Return a key that is equal for terms whose studies differ in outputs alone."""
    rest = {name: value for name, value in term.study.items() if name != "outputs"}
    return json.dumps(rest, sort_keys=True)


def _tables(terms: Sequence[Term]) -> dict[str, Table]:
    """Return the result of each distinct study of some terms, by a key made of the study.

    Studies that differ in their outputs alone are run once, with all of these outputs.
    """
    studies: dict[str, dict[str, Any]] = {}
    for term in terms:
        before = studies.get(_key(term), {"outputs": ()})["outputs"]
        names = list(dict.fromkeys((*before, *term.study["outputs"])))
        studies[_key(term)] = {**term.study, "outputs": names}
    return {key: results_of(content) for key, content in studies.items()}


def _outputs(terms: Sequence[Term], tables: Mapping[str, Table]) -> list[Any]:
    """Return the outputs of all terms."""
    return [_picked(tables[_key(term)], term) for term in terms]


def _picked(table: Table, term: Term) -> Any:
    """Return the values that a term takes of its output: all, an extreme, or the one at an end.

    `term.pick` says which: "value" gives an array over the cells, "least" and "largest" a number,
    and "first" and "last" the number at an end of the output's only axis.
    """
    values = np.asarray(table.variables[term.output].values, dtype=np.float64)
    if term.pick == "value":
        return values
    ends = {"first": 0, "last": -1}
    if term.pick in ends:
        return float(values[ends[term.pick]])
    return float(values.min() if term.pick == "least" else values.max())


def _drive_speed(content: Mapping[str, Any]) -> float:
    """Return the largest speed of a study's track, 2 pi f A0 [m/s], of the largest f and A0 in it.

    It is the scale for stated errors of velocities that are 0. `content` is the study.
    """
    frequency, amplitude = (
        float(np.max(content["parameters"][name])) for name in ("frequency", "amplitude")
    )
    return 2 * math.pi * frequency * amplitude


def _statuses(variables: Mapping[str, TableVariable]) -> tuple[set[str], bool]:
    """Return the names of the statuses of all cells, and True if one explains a missing value.

    `variables` are those of a result. The statuses are those of motions; a result without them has
    its regimes in their place. A value may be missing where a status or regime is not valid, or is
    one of `WITHOUT_VALUE`, such as "stopped".
    """
    present = [_present(one, REGIMES) for name, one in variables.items() if is_regime(name)]
    statuses = {name for flags in present for name in flags}
    if "motion_status" in variables:
        present.append(_present(variables["motion_status"], MOTION_STATUSES))
        statuses = set(present[-1])
    explained = (
        all(not flag.valid or name in WITHOUT_VALUE for name, flag in flags.items())
        for flags in present
        if flags
    )
    return statuses, any(explained)


def _present(variable: TableVariable, flags: Mapping[str, Flag]) -> dict[str, Flag]:
    """Return the flags that occur in a variable."""
    values = set(np.unique(variable.values).tolist())
    return {name: flag for name, flag in flags.items() if flag.value in values}
