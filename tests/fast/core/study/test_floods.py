"""What holds thousands of mistakes is refused for little, in few words."""

import json
from unittest import mock

import pytest

from night import spread
from refusals import problems_of
from vibrafeed.core import suggestions
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content, read_json
from work import calls

PLAIN = {"frequency": 50, "amplitude": "1 mm", "beta": 30}
SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": PLAIN,
}
OPTIMISE = {
    "kind": "optimise",
    "scene": "rectangle-on-plane",
    "criterion": {"kind": "maximise", "output": "acceleration_x"},
    "parameters": PLAIN,
}


def named(count):
    return [f"frequncy_{k}" for k in range(count)]


def over(**reduce):
    ranged = {**SWEEP, "parameters": {**PLAIN, "beta": [10, 20]}}
    return {**ranged, "reduce": {"over": ["beta"], **reduce}}


FLOODS = {
    "outputs": {**SWEEP, "outputs": named(40_000)},
    "outputs of another type": {**SWEEP, "outputs": [1] * 300_000},
    "parameters": {**SWEEP, "parameters": dict.fromkeys(named(60_000), 1)},
    "keys": {**SWEEP, **dict.fromkeys(named(40_000), 1)},
    "some parameters and keys": {
        **SWEEP,
        **dict.fromkeys(named(900), 1),
        "parameters": {**PLAIN, **dict.fromkeys(named(900), 1)},
    },
    "levels": {**SWEEP, "parameters": {**PLAIN, "beta": [1] * 400_000}},
    "levels in many units": {
        **SWEEP,
        "parameters": {
            **PLAIN,
            "frequency": [
                f"{k + 1} Hz{' m/m' * (k % 4)}{' s/s' * (k // 4 % 4)}" for k in range(9000)
            ],
        },
    },
    "levels in texts": {
        **SWEEP,
        "parameters": {**PLAIN, "frequency": [*(f"{k + 1} Hz" for k in range(50_000)), "1 Hz"]},
    },
    "lists": {**SWEEP, "parameters": {**PLAIN, "beta": [[]] * 300_000}},
    "constraints": {**OPTIMISE, "constraints": [{}] * 200_000},
    "statistics": over(statistics=["maxx"] * 100_000),
    "conditions": over(shares={f"s{k}": ["throw_numbr < 1"] * 2_000 for k in range(20)}),
    "recording": {
        **SWEEP, "kind": "simulate", "drive": {"data": "t,ax\n" + "x,y\n" * 190_000, "along": "ax"}
    },
}  # fmt: skip


MAX_CALLS = 20
"""Of functions, for a character of the body: 10 at most, of searches among some 400 names."""


@pytest.mark.parametrize("name", spread(FLOODS, 7))
def test_a_flood_of_mistakes_is_refused_soon_and_in_few_words(name):
    body, caught = json.dumps(FLOODS[name]), []

    def prepare():
        with pytest.raises(StudyError) as error:
            prepare_content(read_json(body))
        caught.append(error.value)

    searched = mock.Mock(wraps=suggestions.suggestion)
    with mock.patch.object(suggestions, "suggestion", searched):
        work = calls(prepare)
    # At most some calls for each value; each of these took thousands when every name was looked up.
    assert work < MAX_CALLS * len(body)
    assert len(caught[0].problems) <= 250
    assert searched.call_count <= 3 * suggestions.SEARCHED


def test_the_first_of_many_names_are_searched_for():
    content = {**SWEEP, "parameters": {**PLAIN, **dict.fromkeys(named(50), 1)}}
    fixes = [
        p.fix
        for p in problems_of(prepare_content, content)
        if p.place.startswith("parameters.frequncy")
    ]
    assert fixes.count("Did you mean 'frequency'?") == suggestions.SEARCHED
    assert set(fixes[suggestions.SEARCHED :]) == {"Fix the ones before it first"}
