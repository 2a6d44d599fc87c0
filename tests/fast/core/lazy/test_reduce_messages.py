"""What is wrong with a reduction is told at its place, all at once, and what would be right."""

from typing import Any

import pytest

from refusals import places_of, problems_of
from vibrafeed.core.errors import LimitError, StoppedError, StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import open_lazily, tabulate
from vibrafeed.core.watch import Watch

STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number", "acceleration_x"],
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": 10},
        "beta": [10, 20, 30],
        "friction": [0.2, 0.4],
    },
}


def problems(**asked: Any) -> list[str]:
    return [str(problem) for problem in problems_of(prepare_content, {**STUDY, "reduce": asked})]


MAX = {"statistics": ["max"]}


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({**MAX}, "reduce.over: it is missing. Add over."),
        ({**MAX, "over": []}, "reduce.over: "),
        (
            {**MAX, "over": ["bta"]},
            "reduce.over.0: 'bta' is not an axis of this study. Did you mean 'beta' (elevation)?",
        ),
        (
            {**MAX, "over": ["frequency"]},
            "reduce.over.0: 'frequency' is not an axis of this study. Known: ",
        ),
        (
            {"over": ["beta"], "statistics": ["maxx"]},
            "reduce.statistics.0: 'maxx' is not a statistic. Did you mean 'max'?",
        ),
        (
            {"over": ["beta"], "statistics": ["median"]},
            "reduce.statistics.0: 'median' is not a statistic. Write quantiles = [0.5].",
        ),
        (
            {"over": ["beta"], "quantiles": [50]},
            "reduce.quantiles.0: '50' is not a quantile. Write a number from 0 to 1, such as "
            "0.5 for the median.",
        ),
        (
            {"over": ["beta"]},
            "reduce: no statistic is requested. Give statistics, "
            "quantiles, regimes, shares or levels.",
        ),
        (
            {**MAX, "over": ["beta"], "of": ["throw_numbr"]},
            "reduce.of.0: 'throw_numbr' is not a numeric output of this study. Did you mean "
            "'throw_number'?",
        ),
        ({**MAX, "over": ["beta"], "cell": "all"}, "Did you mean 'cells'?"),
        (
            {"over": ["beta"], "shares": {"a": ["throw number < 1"]}},
            "reduce.shares.a.0: 'throw number < 1' is not a condition. Write, for example, "
            "'throw_number < 1' or 'regime == slip'.",
        ),
        (
            {"over": ["beta"], "shares": {"a": ["regime == slipp"]}},
            "reduce.shares.a.0: 'slipp' is not a regime. Did you mean 'slip'?",
        ),
        (
            {"over": ["beta"], "shares": {"a": ["regime == roll"]}},
            "reduce.shares.a.0: regime is never 'roll' in this study. Possible values: stick, "
            "slip, flight.",
        ),
        ({"over": ["beta"], "shares": {"a": ["regime < slip"]}}, "regimes have no order"),
        (
            {"over": ["beta"], "shares": {"a": ["acceleration_x > 1 mm"]}},
            "reduce.shares.a.0: 'mm' does not measure",
        ),
        (
            {"over": ["beta"], "shares": {"a": ["floor_force > 1 N"]}},
            "reduce.shares.a.0: 'floor_force' is not an output of this study. ",
        ),
        ({"over": ["beta"], "shares": {"a": []}}, "reduce.shares.a: the share has no condition"),
        (
            {"over": ["beta"], "shares": {"A b": ["throw_number < 1"]}},
            "reduce.shares.A b: 'A b' is not a valid name of a variable",
        ),
        (
            {
                "over": ["beta"],
                "levels": {"a": {"output": "throw_number", "level": 1, "along": "amplitude"}},
            },
            "reduce.levels.a.along: 'amplitude' is not an axis in reduce.over. Known: beta.",
        ),
        (
            {
                "over": ["friction"],
                "levels": {"a": {"output": "throw_number", "level": 1, "along": "friction"}},
            },
            "reduce.levels.a.along: throw_number does not depend on friction. Remove this level.",
        ),
        (
            {
                "over": ["beta"],
                "levels": {"a": {"output": "throw_number", "level": "1 m", "along": "beta"}},
            },
            "reduce.levels.a.level: 'm' does not measure",
        ),
        (
            {
                "over": ["beta"],
                "levels": {"a": {"output": "throw_number", "along": "beta", "at": 1, "level": 1}},
            },
            "reduce.levels.a.at: 'at' is not a key of the section reduce",
        ),
    ],
)
def test_each_mistake_is_told_where_it_is(asked: dict[str, Any], told: str) -> None:
    found = problems(**asked)
    assert len(found) == 1
    assert told in found[0]


def test_an_axis_that_moves_no_output_is_not_reduced() -> None:
    content = {**STUDY, "outputs": ["throw_number"], "reduce": {**MAX, "over": ["friction"]}}
    with pytest.raises(StudyError, match=r"reduce.over.0: no requested output depends on friction"):
        prepare_content(content)


def test_equal_reductions_have_one_key() -> None:
    asked = {
        "over": ["friction", "beta", "beta"],
        "statistics": ["argmax", "max"],
        "quantiles": [0.5, 0.1],
        "shares": {"b": ["acceleration_x>=0.1 g_0"], "a": ["regime==slip"]},
    }
    other = {
        "over": ["beta", "friction"],
        "statistics": ["max", "argmax"],
        "quantiles": [0.1, 0.5],
        "shares": {"a": ["regime == slip"], "b": ["acceleration_x >= 0.980665"]},
    }
    one = parse_study({**STUDY, "reduce": asked})
    assert one.key() == parse_study({**STUDY, "reduce": other}).key()
    assert one.key() == parse_study(one.content()).key()
    assert one.key() != parse_study(STUDY).key()


def test_limits_are_of_what_is_stored() -> None:
    prepared = prepare_content({**STUDY, "reduce": {"over": ["amplitude", "friction"], **MAX}})
    assert (prepared.cells, prepared.stored) == (60, 3)
    prepared.check_limits(cells=3, bytes_=8 * 12)
    with pytest.raises(LimitError, match="over more axes"):
        prepared.check_limits(cells=2, bytes_=None)


def test_what_is_stopped_is_no_answer_and_what_is_reduced_has_no_cells() -> None:
    prepared = prepare_content({**STUDY, "reduce": {"over": ["beta"], **MAX}})
    with pytest.raises(StoppedError, match="before all cells were evaluated"):
        tabulate(prepared, Watch(stop=lambda: True))
    with pytest.raises(StudyError, match="but no single cells"):
        open_lazily(prepared)
    with pytest.raises(StudyError, match="/processes/sweep/execution"):
        prepare_content({**STUDY, "reduce": {"over": ["beta"], **MAX}}, "sweep")
    with pytest.raises(StudyError, match="'reduce' is not a key of a study of kind 'optimise'"):
        prepare_content({**STUDY, "kind": "optimise", "reduce": {"over": ["beta"], **MAX}})


@pytest.mark.parametrize("own", [{"sensitivities": True}, {"trajectory": 10}])
def test_what_a_simulation_cannot_tell_of_a_reduction_and_all_at_once(own: dict[str, Any]) -> None:
    outputs = ["conveying_velocity", "motion_status", "acceleration_q"]
    study = {**STUDY, "kind": "simulate", "outputs": outputs, **own}
    places = set(
        places_of(
            prepare_content,
            {**study, "reduce": {"over": ["beta", "gamma"], "of": ["motion_status"]}},
        )
    )
    assert {"outputs", *own, "reduce.over.1", "reduce.of.0"} <= places


def test_cells_that_do_not_count() -> None:
    asked = {"over": ["amplitude", "beta"], "statistics": ["max", "argmax"], "regimes": True}
    valid = tabulate(prepare_content({**STUDY, "verify": 5, "reduce": asked})).to_xarray()
    assert valid.attrs["verified_cells"] == 5
    every = tabulate(prepare_content({**STUDY, "reduce": {**asked, "cells": "all"}})).to_xarray()
    assert float(every.throw_number_max) == float(valid.throw_number_max) > 1  # it always holds
    assert int(every.throw_number_count) == int(valid.throw_number_count) == 30
    flight = valid.regime_flight_count
    assert (valid.acceleration_x_count + flight == 30).all()
    assert (every.acceleration_x_count == 30).all()
    assert float(every.throw_number_argmax_beta) == 30
    assert every.throw_number_max.attrs["cell_methods"] == "amplitude: beta: maximum"
    assert every.beta.attrs["reduced_range"].tolist() == [10, 30]


def test_quantiles_of_more_cells_than_memory_holds_are_refused() -> None:
    parameters = {**STUDY["parameters"], "beta": {"start": 0, "stop": 60, "num": 10_000}}
    parameters["amplitude"] = {"start": 1e-4, "stop": 1e-3, "num": 10_000}
    asked = {"over": ["amplitude", "beta"], "quantiles": [0.5]}
    assert places_of(prepare_content, {**STUDY, "parameters": parameters, "reduce": asked}) == [
        "reduce.quantiles"
    ]
