"""Studies: units, ranges, and messages that a newcomer can act on."""

import contextlib
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refusals import problems_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_json, parse_study, parse_toml, prepare_content
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.study.values import Fixed, read_values

PLANE = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x"],
    "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": 20, "friction": 0.3},
}


def plane(**parameters: object) -> dict[str, object]:
    return {**PLANE, "parameters": {**PLANE["parameters"], **parameters}}


@pytest.mark.parametrize(
    ("name", "written", "value"),
    [
        ("frequency", "3000 rpm", 50.0),
        ("frequency", "3000 vpm", 50.0),
        ("frequency", "3000 rev/min", 50.0),
        ("frequency", "3000 1/min", 50.0),
        ("frequency", "0.05 kHz", 50.0),
        ("frequency", "50 1/s", 50.0),
        ("frequency", "50", 50.0),
        ("amplitude", "0.35 mm", 0.00035),
        ("amplitude", "350 um", 0.00035),
        ("amplitude", "350 µm", 0.00035),
        ("amplitude", "1e-3 m", 0.001),
        ("amplitude", 0.00035, 0.00035),
        ("alpha", "30 deg", 30.0),
        ("alpha", "30 degree", 30.0),
        ("alpha", 30, 30.0),
        ("alpha", "-90", -90.0),
        ("gravity", "9.8 m/s^2", 9.8),
        ("gravity", "1 g_0", 9.80665),
        ("mass", "5 g", 0.005),
        ("speed", "360 m/h", 0.1),
        ("friction", "0.3", 0.3),
    ],
)
def test_a_value_is_read_exactly(name, written, value):
    assert read_values(name, written) == Fixed(value)


@pytest.mark.parametrize(
    ("name", "written", "words"),
    [
        ("amplitude", "0.5 kg", ["kg", "amplitude", "mm"]),
        ("amplitude", "0.5 mmm", ["mmm"]),
        ("amplitude", "half a mm", ["half a mm"]),
        ("frequency", "314 rad/s", ["angular velocity", "2 pi"]),
        ("frequency", "50 deg", ["deg"]),
        ("friction", "30 deg", ["deg", "friction"]),
        ("alpha", "30 mm", ["mm", "azimuth"]),
        ("alpha", "200 deg", ["200", "at most 180"]),
        ("friction", -0.1, ["-0.1", "at least 0"]),
        ("gravity", "9.8 g", ["'g'"]),
        ("radius", 0, ["greater than 0"]),
        ("radius", True, ["true is not a number"]),
        ("radius", None, ["None"]),
        ("radius", float("inf"), ["finite"]),
        ("radius", float("nan"), ["finite"]),
        ("radius", 10**400, ["finite"]),
        ("radius", "1e999 m", ["finite"]),
        ("radius", "1 m; import os", ["not a unit"]),
        ("radius", "1 m**999999999", ["is not a unit"]),
        ("radius", [], ["empty"]),
        ("radius", [1, 1], ["twice"]),
        ("radius", [1, 3, 2], ["Sort"]),
        ("radius", {"start": 1, "stop": 1, "num": 3}, ["are both 1 m", "Give two ends"]),
        ("radius", {"start": 1, "stop": 2}, ["num or step"]),
        ("radius", {"start": 1, "stop": 2, "num": 3, "step": 1}, ["num or step"]),
        ("radius", {"start": 1, "stop": 2, "num": 1}, ["at least 2"]),
        ("radius", {"start": 1, "stop": 2, "num": 2.5}, ["whole number"]),
        ("radius", {"start": 1, "stop": 2, "num": 10**12}, ["1,000,000,000,000"]),
        ("radius", {"start": 1, "stop": 2, "step": 3}, ["larger than its whole range"]),
        ("radius", {"start": 1, "stop": 2, "step": 0}, ["greater than 0"]),
        ("radius", {"start": 1, "stop": 2, "step": 1e-300}, ["values"]),
        ("radius", {"start": 1, "stop": 2, "nmu": 3}, ["nmu", "num"]),
        ("radius", {"start": 1, "stop": 2, "num": 3, "spacing": "cubic"}, ["cubic", "linear"]),
        ("distance", {"start": 0, "stop": 2, "num": 3, "spacing": "log"}, ["above 0"]),
    ],
)
def test_a_wrong_value_is_refused_with_the_way_to_write_it(name, written, words):
    (problem,) = problems_of(parse_study, plane(**{name: written}))
    assert problem.place == f"parameters.{name}"
    for word in words:
        assert word in f"{problem.message} {problem.fix}"


@pytest.mark.parametrize(
    ("written", "values"),
    [
        ({"start": "0 deg", "stop": "90 deg", "step": "1 deg"}, np.arange(91.0)),
        ({"start": 0, "stop": 1, "step": 0.1}, np.linspace(0, 1, 11)),
        ({"start": 0, "stop": 1, "step": 0.3}, [0, 0.3, 0.6, 0.9]),
        ({"start": 10, "stop": 20, "num": 3}, [10, 15, 20]),
        ({"start": 1, "stop": 100, "num": 3, "spacing": "log"}, [1, 10, 100]),
        ([3, 2, 1], [3, 2, 1]),
        (["1 rad"], [np.rad2deg(1.0)]),
    ],
)
def test_a_range_has_the_values_that_it_says(written, values):
    read = read_values("beta", written)
    assert read.size == len(values)
    # one rounding of the span, since linspace and a step may each round once
    np.testing.assert_allclose(read.array(), values, rtol=0, atol=2e-16 * max(values) + 1e-300)


def test_every_problem_is_reported_at_once_with_its_place():
    fixes = {
        problem.place: problem.fix
        for problem in problems_of(
            parse_toml,
            'kind = "sweep"\nscene = "rectangle-on-plane"\noutput = ["x"]\n'
            '[parameters]\nfrequencey = "50 Hz"\namplitude = "1 kg"\nfriction = -1\n',
        )
    }
    places = ("frequencey", "amplitude", "friction")
    assert fixes.keys() == {"outputs", "output", *(f"parameters.{name}" for name in places)}
    assert fixes["parameters.frequencey"] == "Did you mean 'frequency'?"
    assert fixes["output"] == "Did you mean 'outputs'?"


@pytest.mark.parametrize("text", ["", "[]", "nul", '{"kind": NaN}', "[" * 100_000, b"\xff\xfe"])
def test_a_text_that_is_no_study_is_refused(text):
    with pytest.raises(StudyError):
        parse_json(text)


def test_equal_studies_have_equal_keys_however_they_are_written():
    one = parse_study(plane(frequency="3000 rpm", amplitude="500 um"))
    other = json.loads(json.dumps(plane(amplitude=0.0005, frequency=50.0)))
    other["parameters"] = dict(reversed(other["parameters"].items()))
    assert one.key() == parse_study(other).key()
    assert one.key() != parse_study(plane(frequency=51)).key()
    ranged = parse_study(plane(beta={"start": 0, "stop": 90, "step": 7}, friction=[0.1, 0.3]))
    assert parse_json(ranged.canonical()) == ranged


@settings(deadline=None, max_examples=20)
@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=20),
        lambda inner: (
            st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=12), inner, max_size=4)
        ),
        max_leaves=10,
    ),
    st.sampled_from([*PARAMETERS, "kind", "scene", "variant", "outputs", "title"]),
)
def test_no_value_whatever_ends_in_another_error(value, name):
    with contextlib.suppress(StudyError):
        parse_study(plane(**{name: value}) if name in QUANTITIES else {**PLANE, name: value})


POINT = {"frequency": 50, "amplitude": 3e-4, "beta": 30, "friction": 0.3}
SIMULATE = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": POINT,
}
NUMBER = "Write friction = 0.3 (a plain number)"
TEXT = "Write a text in quotes"
WRONG = [
    (
        {"parameters": {**POINT, "friction": True}},
        "parameters.friction",
        "true is not a number",
        NUMBER,
    ),
    (
        {"parameters": {**POINT, "friction": "steel on steel"}},
        "parameters.friction",
        "'steel on steel' is not a number with a unit",
        'Write friction = { pair = "steel on steel" }',
    ),
    (
        {"parameters": {**POINT, "amplitude": []}},
        "parameters.amplitude",
        "the list of values of amplitude is empty",
        "Give at least one value",
    ),
    (
        {"parameters": []},
        "parameters",
        "an empty list is not a table of keys and values",
        "Write a table, in JSON an object",
    ),
    ({"scene": 3}, "scene", "3 is not a text", TEXT),
    ({"scene": {"a": 1}}, "scene", "a table is not a text", TEXT),
    ({"title": ["x"]}, "title", "a list is not a text", TEXT),
    ({"outputs": "x"}, "outputs", "'x' is not a list", "Write a list in brackets"),
    ({"outputs": []}, "outputs", "the list has too few entries", "Give at least 1"),
    ({"max_periods": 99.5}, "max_periods", "99.5 is not a whole number", "Write a whole number"),
    ({"max_periods": 3}, "max_periods", "3 is too small", "Write at least 8"),
    ({"tolerance": True}, "tolerance", "true is not a number", "Write a plain number"),
    ({"tolerance": {}}, "tolerance", "an empty table is not a number", "Write a plain number"),
    ({"tolerance": 3}, "tolerance", "3 is too large", "Write at most 1"),
    (
        {"verify": "x" * 100},
        "verify",
        f"'{'x' * 60}...' is not a whole number",
        "Write a whole number",
    ),
]


@pytest.mark.parametrize(("change", "place", "message", "fix"), WRONG)
def test_another_type_is_told(change, place, message, fix):
    told = [
        (one.place, one.message, one.fix)
        for one in problems_of(prepare_content, {**SIMULATE, **change})
    ]
    assert (place, message, fix) in told


CONTENT = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
}


RUNS = {
    "kind": "calibrate",
    "scene": "rectangle-on-plane",
    "observations": [{"amplitude": "0.2 mm", "regime": "hops"}],
    "unknowns": {"friction": {"lower": 0.1, "upper": 0.5}},
    "parameters": {"frequency": 50, "beta": 20},
}


@pytest.mark.parametrize(
    ("content", "old", "new", "right", "wrong", "words"),
    [
        (CONTENT, "most_periods", "max_periods", 64, 2, "periods"),
        (RUNS, "doubt", "outlier_probability", 0.02, 0.7, "not a probability between"),
    ],
)
def test_an_old_key_still_works(content, old, new, right, wrong, words):
    before, now = (parse_study({**content, key: right}) for key in (old, new))
    assert getattr(before, new) == right
    assert before.canonical() == now.canonical()
    with pytest.raises(StudyError, match=words):
        parse_study({**content, old: wrong})
