"""Problems whose answer is known: each is right, and a wrong answer would be wrong."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from vibrafeed.core.assurance.answers import answers_of, read_answers
from vibrafeed.core.assurance.case import EVIDENCE, RELATIONS, Case, half_unit
from vibrafeed.core.assurance.catalogue import FAMILIES, cases, document, families_of
from vibrafeed.core.assurance.forms import FORMULAS, forms
from vibrafeed.core.assurance.hard_cases import HARD_CASES
from vibrafeed.core.assurance.judge import Outcome, judge_results, outputs_of, run_cases, summaries
from vibrafeed.core.assurance.tables import expected, markdown, number, rows, sentence, verdict
from vibrafeed.core.assurance.worked import rail
from vibrafeed.core.assurance.worked.values import of_hard_case
from vibrafeed.core.errors import StudyError

# Hard cases are tested for themselves, in tests/laws/test_hard_cases.py.
LETTERS = [letter for letter in FAMILIES if letter != "H"]
RANDOM = 4


@pytest.fixture(scope="module")
def outcomes() -> list[Outcome]:
    return run_cases(cases(LETTERS, RANDOM))


def test_every_problem_is_right(outcomes):
    assert {outcome.case.family for outcome in outcomes} == set(LETTERS)
    wrong = [(one.case.id, one.value, one.case.right.value) for one in outcomes if not one.passed]
    assert not wrong


def test_a_wrong_answer_would_be_wrong(outcomes):
    for outcome in outcomes:
        problem = outcome.case
        if problem.relation == "shown":
            assert problem.holds(1e9)
            continue
        off = 2 * problem.right.tolerance or 0.5 * (problem.right.value or 1.0)
        signs = {"equals": (1, -1), "at most": (1,), "at least": (-1,)}[problem.relation]
        for sign in signs:
            assert not problem.holds(problem.right.value + sign * off), problem.id
        assert not Outcome(problem, math.nan).passed
        # Nothing is not near enough, and neither is what is off by a hundredth.
        if problem.relation == "equals" and problem.right.value != 0:
            assert not problem.holds(0.0), problem.id
            near = problem.holds(1.01 * problem.right.value)
            assert not near or problem.evidence == "measured", problem.id


def test_the_digits_of_the_source_are_those_of_the_formula():
    checked = 0
    for form in forms().values():
        for problem in form.cases():
            if problem.inputs.get("weak", 0.0) > 1e-4:
                continue  # not near its limit
            value = form.formula.value(problem.inputs)
            limit = form.tolerance if "weak" in problem.inputs else 0.0
            assert abs(value - problem.right.value) <= problem.right.tolerance + limit, problem.id
            checked += 1
    assert checked > 12


def test_forms_have_formulas_and_families():
    assert set(forms()) == set(FORMULAS)
    every = cases(LETTERS, 3)
    names = [problem.id for problem in every]
    assert len(set(names)) == len(names)
    for problem in every:
        assert problem.evidence in EVIDENCE
        assert problem.relation in RELATIONS
        assert problem.why
        assert problem.right.source
        assert problem.title
        assert problem.right.tolerance >= 0
        for term in problem.terms:
            assert term.output in term.study["outputs"] or "trajectory" in term.study
    for form in forms().values():
        for given in (*(row["given"] for row in form.listed),
                      *(one.inputs for one in form.random(3, 5))):  # fmt: skip
            stems = {name.rstrip("0123456789") for name in form.inputs}
            named = {name.rstrip("0123456789").replace("normal", "along") for name in given}
            assert named <= {stem.replace("normal", "along") for stem in stems}, form.name


def test_a_hard_case_is_a_problem_where_a_closed_form_answers_it():
    hard = {case.id: case for case in HARD_CASES}
    found = of_hard_case(hard["motion without friction, A0 = 1e-310 m"])
    (outcome,) = run_cases([found])
    assert found.id == "H-motion-without-friction-a0-1e-310-m"
    assert outcome.passed
    assert of_hard_case(hard["regularised, slip speed 1e-06"]) is None
    assert of_hard_case(hard["beta = 1e300"]) is None


def test_random_members_have_what_the_formula_allows():
    given = [problem.inputs for problem in forms()["Q-two-levels"].random(60, 3)]
    assert any(one["gamma"] == 90 for one in given)
    assert any(one["hold_down"] > 0 for one in given)
    assert any(one["gamma"] < 0 for one in given)
    assert any(one["friction_static"] > one["friction_kinetic"] for one in given)
    few, many = (list(forms()["W-winkler"].random(count, 3)) for count in (2, 5))
    assert few == many[:2]
    assert few != list(forms()["W-winkler"].random(2, 4))


def test_the_measured_set_keeps_its_scatter(outcomes):
    assert len(rail.runs()) == 67
    (scatter,) = (one for one in outcomes if one.case.id == "Y-scatter-1")
    assert len(scatter.case.terms) == 43
    assert scatter.value == pytest.approx(3.06, abs=0.1)
    shown = [one for one in outcomes if one.case.family == "Y" and not one.judged]
    assert len(shown) == 67


def test_the_document_alone_answers_a_problem():
    told = json.loads(json.dumps(document(cases(["Q", "S"], 1))))
    assert set(told["families"]) == {"Q", "S"}
    assert "T a_m/(2 (a_s + a_m))" in told["forms"]["Q-two-levels"]["words"]
    first = told["problems"][0]
    (term,) = first["answer"]["terms"]
    made = replace(cases(["Q"])[0].terms[0], study=term["study"])
    (found,) = outputs_of([made])
    assert term["times"] * found - term["minus"] == pytest.approx(15.882857, abs=5e-7)
    assert first["digits"] == "15.882857"
    assert first["tolerance"] == 5e-7


def test_a_study_that_is_refused_is_an_answer_that_is_wrong():
    problem = cases(["W"])[0]
    study = {**problem.terms[0].study, "scene": "nowhere"}
    (outcome,) = run_cases([replace(problem, terms=(replace(problem.terms[0], study=study),))])
    assert not outcome.passed
    assert verdict(outcome).startswith("wrong: refused: scene")
    assert sentence([outcome], "it") == "it: 1 of 1 problems are wrong."


def test_what_is_shown_has_the_digits_that_count(outcomes):
    assert number(15.882857142857, 5e-7) == "15.88285714"
    assert number(5.249e-8, 0.0) == "5.25e-08"
    assert number(math.nan, 1.0) == "none"
    assert half_unit("3.2700") == pytest.approx(5e-5)
    assert half_unit("1e-8") == pytest.approx(5e-9)
    bound = next(one for one in outcomes if one.case.relation == "at most")
    assert expected(bound.case).startswith("at most ")
    page = markdown(outcomes[:30], "it")
    assert page.count("\n| ") >= 30
    assert "No claim of this program" in page
    assert all(len(row) == 8 for row in rows(outcomes))


# --- answers of others


def test_other_answers_are_judged_alike():
    told = {
        "format": "vibrafeed-answers-1",
        "program": "Another 1",
        "answers": {"Q-two-levels-1": 15.8828571, "W-winkler-1": 3.4, "W-winkler-2": None,
                    "M-line-r9.3": 2.2074161},
    }  # fmt: skip
    given = answers_of(told)
    outcomes = judge_results(given.cases, given.values)
    right = {one.case.id: one.passed for one in outcomes}
    assert right == {
        "Q-two-levels-1": True, "W-winkler-1": False, "W-winkler-2": False, "M-line-r9.3": True,
    }  # fmt: skip
    worst = {one.family: one.worst.case.id for one in summaries(outcomes)}
    assert worst["W"] == "W-winkler-1"


@pytest.mark.parametrize(
    ("content", "places"),
    [
        ([], ["answers"]),
        ({"format": "vibrafeed-answers-1"}, ["answers"]),
        (
            {"format": "x", "program": 3, "more": 1,
             "answers": {"Q-two-level-1": 1, "W-winkler-1": "2", "M-line-r1.99999": 1,
                         "O-bound-r1.1": math.inf}},
            ["more", "format", "program", "answers.M-line-r1.99999", "answers.Q-two-level-1",
             "answers.W-winkler-1", "answers.O-bound-r1.1"],
        ),
    ],
)  # fmt: skip
def test_everything_wrong_with_answers_is_told(content, places):
    with pytest.raises(StudyError) as refused:
        answers_of(content)
    assert [problem.place for problem in refused.value.problems] == places


def test_a_file_that_is_no_json_is_refused(tmp_path):
    path = tmp_path / "answers.json"
    with pytest.raises(StudyError, match="No such file"):
        read_answers(path)
    path.write_text("{", encoding="utf-8")
    with pytest.raises(StudyError, match="it is not JSON"):
        read_answers(path)
    answers = '{"format": "vibrafeed-answers-1", "answers": {"Q-two-levels-1": %s}}'
    for digits, words in ((400, "is not a number"), (5000, "a number has thousands of digits")):
        path.write_text(answers % ("1" * digits), encoding="utf-8")
        with pytest.raises(StudyError, match=words):
            read_answers(path)


def test_families_by_letters():
    assert families_of(["w,q", "Q"]) == ("Q", "W")
    with pytest.raises(StudyError, match="'K' is not a family"):
        families_of(["K"])


def test_a_problem_of_two_runs_is_the_sum_of_both():
    problem: Case = next(iter(forms()["S-mirror"].random(1, 2)))
    there, back = outputs_of(problem.terms)
    assert abs(there) > 1e-4
    assert problem.result([there, back]) == pytest.approx(
        problem.terms[0].times * (there + back), abs=1e-15
    )
