"""The catalogue of hard cases: every case is right, and the catalogue can tell what is wrong."""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

from core.accuracy import extremes
from core.accuracy.extremes import (
    run_case,
    run_catalogue,
    to_markdown,
    to_table,
    worst_of_families,
)
from core.accuracy.hard_cases import HARD_CASES, HardCase
from core.accuracy.textbook import Answer, exact
from core.watch import Watch

BY_NAME = {case.name: case for case in HARD_CASES}
EASY = BY_NAME["every axis of one value"]
FAMILIES = 16  # those that the catalogue promises


@pytest.mark.parametrize("case", HARD_CASES, ids=lambda case: case.name)
def test_every_hard_case_is_right(case: HardCase) -> None:
    outcome = run_case(case)
    assert outcome.passed, f"{outcome.status}: {outcome.error:g} > {outcome.stated_error:g}; {outcome.note}"  # noqa: E501  # fmt: skip


def test_names_are_unique_and_every_family_has_cases() -> None:
    assert len(BY_NAME) == len(HARD_CASES)
    families = [case.family for case in HARD_CASES]
    assert len(set(families)) == FAMILIES
    assert min(families.count(family) for family in set(families)) >= 4
    for case in HARD_CASES:
        assert case.why
        judged = (case.answer, case.attempt, *case.status, case.refused)
        assert any(judged), f"{case.name} cannot fail"


def test_an_exact_answer_knows_its_condition() -> None:
    # x - y at 1 and 1 - 1e-12: two roundings of 1 are 4e-4 of the difference.
    answer = exact(lambda x, y: x - y, x=1.0, y=1.0 - 1e-12)()
    assert answer.value == pytest.approx(1e-12, rel=1e-4)
    assert answer.error == pytest.approx(8 * 2.0**-52 * 2, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"answer": lambda: Answer(1.0, 1e-9, "wrong")}, "wrong"),
        ({"status": ("flight",)}, "not flight"),
        ({"refused": "parameters.beta"}, "should be refused"),
        ({"content": {**EASY.content, "outputs": ["nonsense"]}}, "refused"),
        ({"output": "mass"}, "KeyError"),
    ],
)
def test_a_case_that_is_not_right_says_why(change: dict, words: str) -> None:
    outcome = run_case(replace(EASY, **change))
    assert not outcome.passed
    assert words in outcome.note
    assert outcome.share == math.inf


def test_a_warning_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def noisy(content: object) -> object:
        warnings.warn("digits are lost", RuntimeWarning, stacklevel=1)
        return content

    monkeypatch.setattr(extremes.kinds, "prepare_content", noisy)
    outcome = run_case(EASY)
    assert (outcome.status, outcome.passed) == ("warning", False)
    assert "digits are lost" in outcome.note


def test_what_is_not_finite_needs_a_reason() -> None:
    value = BY_NAME["stopping distance at K = 0"]
    assert run_case(value).passed
    held = replace(value, answer=lambda: Answer(1.0, math.inf, "anything"))
    assert run_case(held).passed  # infinite where the regime says so
    unexplained = replace(EASY, answer=None)
    table = extremes.result_of(EASY.content)
    table.variables["throw_number"].values[...] = np.nan
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(extremes.kinds, "tabulate", lambda *_: table)
        outcome = run_case(unexplained)
    assert (outcome.passed, outcome.note) == (False, "not finite, and nothing says why")


def test_the_report_has_the_worst_first_and_then_all() -> None:
    some = [EASY, BY_NAME["beta = 1e300"], replace(EASY, name="bad", status=("flight",))]
    told = []
    outcomes = run_catalogue(Watch(told.append), some)
    assert sum(told) == pytest.approx(1.0)
    assert [outcome.name for outcome in worst_of_families(outcomes)] == ["bad", "beta = 1e300"]
    text = to_markdown(outcomes)
    assert re.match(r"3 hard cases in \d+ s: 2 right, 1 wrong\.", text)
    assert text.index("bad") < text.index("### All cases")
    assert all(text.count(case.name) >= 1 for case in some)
    assert to_markdown(outcomes, 5).startswith("It was stopped: 5 of 8 cases were not tried.")
    table = to_table(outcomes)
    assert table.variables["passed"].values.tolist() == [1, 1, 0]
    assert table.to_xarray().sizes == {"case": 3}
    assert run_catalogue(Watch(stop=lambda: True), some) == []
