"""The catalogue of hard cases: every case is right, and the catalogue can tell what is wrong."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.worked_values import MEAN_VELOCITIES
from vibrafeed.core.assurance.case import Case, CaseValues, Truth
from vibrafeed.core.assurance.hard_cases import HARD_CASES
from vibrafeed.core.assurance.hard_cases.studies import WORKED
from vibrafeed.core.assurance.judge import judge, results_of, run_case, run_cases, summaries
from vibrafeed.core.assurance.tables import hard_cases_markdown, hard_cases_table
from vibrafeed.core.assurance.textbook import exact
from vibrafeed.core.motion import cells
from vibrafeed.core.watch import Watch

BY_NAME = {case.id: case for case in HARD_CASES}
EASY = BY_NAME["every axis of one value"]
(TERM,) = EASY.terms
FAMILIES = 16  # those that the catalogue promises


CANNOT_TELL = {
    **{
        f"K, gravity {ulps:+d} ulp from the drive": "the roundings of A0 w^2 are larger than K"
        for ulps in (-3, -1, 0, 1, 3)
    },
    "m tau, mu = mu_c (1+0)": "what the rounding of mu_c leaves, below that of the sum",
    **{
        f"{solver}, slip speed 0.001": "the stated error, of friction so soft, is larger than "
        "the mean speed; what it gives is judged by a case of its own"
        for solver in ("regularised", "regularised-BDF")
    },
}
"""Cases that a wrong value would pass, with the reason why it must be so."""


def wrong_values(value: np.ndarray, right: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the values with one cell made wrong; of large arrays only the first and the last.

    Of millions it is the last alone: each judgement takes half a second.
    """
    cells = range(value.size) if value.size <= 16 else (0, value.size - 1)
    cells = cells if value.size <= 1_000_000 else cells[-1:]
    for cell in cells:
        known = right.flat[cell]
        found = value.flat[cell]
        wrongs = (1.5 * found, -found, 0.0) if np.isfinite(known) and known != 0 else (1.0,)
        for wrong in wrongs:
            changed = value.copy()
            changed.flat[cell] = wrong
            yield changed


def passing_though_wrong(case: Case, computed: CaseValues) -> list[np.ndarray]:
    right = np.broadcast_to(case.truth.value, computed.value.shape)
    wrongs = wrong_values(computed.value, right)
    return [wrong for wrong in wrongs if judge(case, replace(computed, value=wrong)).passed]


def by_night(case: Case) -> tuple[pytest.MarkDecorator, ...]:
    """The stiff comparison takes most of the time of all: by day it has its hardest slip."""
    is_easier = case.id.startswith("regularised") and not case.id.endswith("1e-12")
    return (pytest.mark.night,) if is_easier or case.id.startswith("regularised-BDF") else ()


@pytest.mark.by_day(75)
@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=by_night(case), id=case.id) for case in HARD_CASES]
)
def test_every_hard_case_is_right_and_would_fail_if_it_were_wrong(case: Case) -> None:
    outcome, computed = run_case(case)
    assert outcome.passed, f"{outcome.status}: {outcome.error:g} > {outcome.allowed:g}; {outcome.note}"  # noqa: E501  # fmt: skip
    if computed is None or case.truth is None or case.compute:
        return
    assert bool(passing_though_wrong(case, computed)) == (case.id in CANNOT_TELL)
    if computed.stated is not None and np.isfinite(computed.value).all():
        for stated in (np.inf, np.nan):
            blind = replace(computed, stated=np.full_like(computed.stated, stated))
            assert not judge(case, blind).passed
    if computed.stated is not None and case.terms[0].output == "conveying_velocity":
        vast = replace(computed, stated=np.full_like(computed.stated, 1e300))
        right = np.abs(case.truth.value)
        assert not case.blunt or np.any(computed.stated > right), "it could do without `blunt`"
        finite = np.isfinite(computed.value).any()
        assert judge(case, vast).passed == (bool(case.blunt) or not finite)


def test_names_are_unique_and_every_family_has_cases() -> None:
    assert len(BY_NAME) == len(HARD_CASES)
    families = [case.family for case in HARD_CASES]
    assert len(set(families)) == FAMILIES
    assert min(families.count(family) for family in set(families)) >= 4
    for case in HARD_CASES:
        assert case.title
        judged = (case.known, case.compute, *case.status, case.refused)
        assert any(judged), f"{case.id} has no judge"
    assert set(CANNOT_TELL) <= set(BY_NAME)


def test_equal_cells_of_motion_are_found_to_be_equal(monkeypatch: pytest.MonkeyPatch) -> None:
    computed = []
    different = cells._different

    def watched(groups: np.ndarray) -> tuple:
        rows, where = different(groups)
        computed.append((groups.shape[0], rows.shape[0]))
        return rows, where

    monkeypatch.setattr(cells, "_different", watched)
    results_of(BY_NAME["equal cells of motion"].terms[0].study)
    assert computed == [(4, 3)]


def test_an_exact_answer_knows_its_condition() -> None:
    # x - y at 1 and 1 - 1e-12: two roundings of 1 are 4e-4 of the difference.
    answer = exact(lambda x, y: x - y, x=1.0, y=1.0 - 1e-12)()
    assert answer.value == pytest.approx(1e-12, rel=1e-4)
    assert answer.tolerance == pytest.approx(8 * 2.0**-52 * 2, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"known": lambda: Truth(1.0, 1e-9, "wrong")}, "wrong"),
        ({"status": ("flight",)}, "not flight"),
        ({"refused": "parameters.beta"}, "should be refused"),
        ({"terms": (replace(TERM, study={**TERM.study, "outputs": ["nonsense"]}),)}, "refused"),
        ({"terms": (replace(TERM, output="mass"),)}, "KeyError"),
        ({"states_error": True}, "no error is stated"),
    ],
)
def test_a_case_that_is_not_right_says_why(change: dict, words: str) -> None:
    outcome = run_case(replace(EASY, **change))[0]
    assert not outcome.passed
    assert words in outcome.remark
    assert outcome.share == math.inf


def test_a_warning_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def noisy(content: object) -> object:
        warnings.warn("digits are lost", RuntimeWarning, stacklevel=1)
        return content

    monkeypatch.setattr("vibrafeed.core.assurance.judge.prepare_content", noisy)
    outcome, _ = run_case(EASY)
    assert (outcome.status, outcome.passed) == ("warning", False)
    assert "digits are lost" in outcome.note


def test_what_is_not_finite_needs_a_reason() -> None:
    value = BY_NAME["stopping distance at K = 0"]
    assert run_case(value)[0].passed
    held = replace(value, known=lambda: Truth(1.0, math.inf, "anything"))
    assert run_case(held)[0].passed  # infinite where the regime says so
    unexplained = replace(EASY, known=None)
    table = results_of(EASY.terms[0].study)
    table.variables["throw_number"].values[...] = np.nan
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("vibrafeed.core.assurance.judge.results_of", lambda _: table)
        outcome, _ = run_case(unexplained)
    assert (outcome.passed, outcome.note) == (False, "not finite, and nothing says why")


def test_the_report_has_the_worst_first_and_then_all() -> None:
    some = [EASY, BY_NAME["beta = 1e300"], replace(EASY, id="bad", status=("flight",))]
    told = []
    outcomes = run_cases(some, Watch(told.append))
    assert sum(told) == pytest.approx(1.0)
    assert [family.worst.case.id for family in summaries(outcomes)] == ["bad", "beta = 1e300"]
    text = hard_cases_markdown(outcomes)
    assert re.match(r"3 hard cases in \d+ s: 2 right, 1 wrong\.", text)
    assert text.index("bad") < text.index("### All cases")
    assert all(text.count(case.id) >= 1 for case in some)
    assert hard_cases_markdown(outcomes, 5).startswith(
        "The comparison was stopped: 5 of 8 cases were not tried."
    )
    table = hard_cases_table(outcomes)
    assert table.variables["passed"].values.tolist() == [1, 1, 0]
    assert table.to_xarray().sizes == {"case": 3}
    assert run_cases(some, Watch(stop=lambda: True)) == []


@pytest.mark.parametrize(
    ("case", "worked"),
    [
        ("motion with shrinking hops", "chatter"),
        ("regularised, slip speed 1e-06", "stick-slip"),
        ("regularised, stiffness 1e+06", "hop"),
    ],
)
def test_what_the_catalogue_repeats_is_a_worked_value(case: str, worked: str) -> None:
    answer = BY_NAME[case].truth
    assert answer.source == WORKED
    assert answer.value == MEAN_VELOCITIES[worked].value
