"""Studies as programs write them: objects, paths, mappings, keywords, arrays."""

import json

import numpy as np
import pytest
import xarray

from refusals import told_of
from vibrafeed.core.intake import gather, load_study, parse_study

POINT = {"frequency": "50 Hz", "amplitude": "0.25 mm", "friction": 0.5}
WRITTEN = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": {**POINT, "beta": 30}}
LOOSE = {"scene": "rectangle-on-plane", **POINT, "beta": 30}


def problems(*arguments, **keywords):
    return told_of(lambda: parse_study(gather(*arguments, **keywords)))


def test_all_ways_of_writing_make_the_same_study(tmp_path):
    study, path = parse_study(WRITTEN), tmp_path / "study.json"
    path.write_text(json.dumps(WRITTEN))
    mixed = {"scene": "rectangle-on-plane", **POINT, "parameters": {"beta": 30}}
    ways = (
        (WRITTEN, {}), (LOOSE, {}), (mixed, {}), (None, LOOSE), (str(path), {}),
        (None, {**LOOSE, "outputs": "conveying_velocity"}),
        (study, {"beta": 30}), (path, {"beta": 30}), (study, {"kind": "simulate"}),
    )  # fmt: skip
    for given, keywords in ways:
        assert parse_study(gather(given, keywords, "simulate")) == study
    assert gather(study, {}, "simulate") is study
    assert load_study(str(path)) == study
    changed = {"frequency": 50.0, "amplitude": 0.00025, "beta": 20.0, "friction": 0.5}
    for given in (WRITTEN, LOOSE, path, study):
        found = parse_study(gather(given, {"beta": 20, "method": "reference"}, "simulate"))
        assert found.method == "reference"
        assert found.content()["parameters"] == changed


@pytest.mark.parametrize(
    "values",
    [
        [10, 20, 30],
        (10, 20, 30),
        range(10, 31, 10),
        np.linspace(10, 30, 3),
        np.array([10, 20, 30], dtype=np.int16),
        np.array(["10 deg", "20 deg", "30 deg"]),
        [np.float32(10), "20 deg", np.int64(30)],
        xarray.DataArray([10.0, 20.0, 30.0], dims="beta"),
    ],
    ids=lambda values: type(values).__name__,
)
def test_many_values_make_one_axis(values):
    study = parse_study(gather(LOOSE, {"beta": values}, "simulate"))
    assert study.content()["parameters"]["beta"] == [10.0, 20.0, 30.0]


def test_numbers_of_numpy_stand_wherever_numbers_do():
    span = {"start": np.int64(10), "stop": np.float32(30), "num": np.int32(3)}
    given = {"verify": np.int64(5), "trajectory": np.arange(3.0), "beta": span}
    study = parse_study(gather(LOOSE, given, "simulate"))
    assert (study.verify, study.trajectory) == (5, (0.0, 1.0, 2.0))
    assert study.content()["parameters"]["beta"]["num"] == 3
    for number in (np.float32(20), np.array(20)):
        study = parse_study(gather(LOOSE, {"beta": number}, "simulate"))
        assert study.content()["parameters"]["beta"] == 20.0


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"frequncy": 1}, "parameters.frequncy", "Did you mean 'frequency'?"),
        ({"methd": 1}, "methd", "Did you mean 'method'?"),
        ({"paramters": 1}, "paramters", "Did you mean 'parameters'?"),
        ({"xyzzy": 1}, "parameters.xyzzy", "is not a parameter"),
        ({"parameters": {"beta": 20}}, "parameters.beta", "beta is given twice"),
        ({"parameters": 5}, "parameters", ""),
        ({"kind": "swep"}, "kind", "'swep' is not a kind"),
        ({"criterion": 3}, "criterion", "not a key of a study of kind 'simulate'"),
    ],
)
def test_what_is_wrong_with_keywords_is_told_at_its_place(change, place, words):
    assert words in problems(None, {**LOOSE, **change}, "simulate")[place]


@pytest.mark.parametrize(
    ("beta", "message"),
    [
        (np.ones((2, 2)), "the value is an array of 2 dimensions"),
        (range(10**12), "too many values"),
        (np.array([]), "the list of values of beta is empty"),
        (np.array([1.0, np.nan]), "nan is not a finite number"),
        (np.array([True]), "true is not a number"),
        (1j, "1j is not a number"),
    ],
    ids=str,
)
def test_what_is_no_axis_is_refused_at_its_place(beta, message):
    for keywords in ({**LOOSE, "beta": beta}, {**WRITTEN, "parameters": {**POINT, "beta": beta}}):
        found = problems(None, keywords, "simulate")
        assert list(found) == ["parameters.beta"]
        assert message in found["parameters.beta"]


def test_another_kind_is_refused_however_it_is_written(tmp_path):
    path = tmp_path / "study.json"
    path.write_text(json.dumps(WRITTEN))
    for given in (parse_study(WRITTEN), WRITTEN, path):
        found = problems(given, {"beta": 3}, "sweep")
        assert list(found) == ["kind"]
        assert "of kind 'simulate', not 'sweep'. Carry it out with simulate()" in found["kind"]
    assert "it is missing" in problems(None, LOOSE)["kind"]


def test_what_is_no_study_is_told(tmp_path):
    path = tmp_path / "list.json"
    path.write_text("[]")
    for given, place, words in (
        (5, "study", "a value of type int is neither"), (path, "study", "list is neither"),
        (tmp_path / "none.toml", "file", "cannot be read"),
    ):  # fmt: skip
        assert words in problems(given, {})[place]
