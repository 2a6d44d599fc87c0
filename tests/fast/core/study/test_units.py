"""Units that users write."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, read_json
from vibrafeed.core.intake.forms import read_toml
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.units import UnitError, read_number


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "unit",
    [
        "mm**99999999",
        "mm^99999999",
        "mm**9**9**9",
        "(mm**9)**9",
        "mm**9e9",
        "mm**9_9",
        "mm**(9)**9",
        "mm²²²²²²²²²",
        "mm*9e999999999",
        "mm*1.e99999999",
        "mm**\N{ARABIC-INDIC DIGIT NINE}9999999",
    ],
)
def test_powers_that_would_take_hours_are_no_units(unit):
    with pytest.raises(UnitError):
        read_number("amplitude", QUANTITIES["amplitude"], f"1 {unit}")


LONG = "0.3" + "0" * 250 + " mm"  # cut to 200 characters it is 0.3 m
POINT = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20}
TOO_LONG = "characters. A value has at most 200 characters"


def study(kind="sweep", scene="rectangle-on-plane", parameters=POINT, **more):
    outputs = {} if kind in ("optimise", "calibrate") else {"outputs": ["throw_number"]}
    return {"kind": kind, "scene": scene, **outputs, "parameters": parameters, **more}


def cut(name, text):
    """Return a share of cells below a text."""
    return {"reduce": {"over": ["beta"], "shares": {"low": [f"{name} < {text}"]}}}


MEASURED = {"amplitude": "0.3 mm", "conveying_velocity": "20 mm/s"}
RUNS = {"kind": "calibrate", "parameters": {"frequency": 50, "beta": 20}}
LOOKED_FOR = {"unknowns": {"friction": {"lower": 0.1, "upper": 0.6}}}
RANGE = {"start": "0.1 mm", "stop": "0.3 mm", "step": "0.1 mm"}
BEST = {"kind": "optimise", "variables": {"beta": {"lower": 10, "upper": 40}}}
UNSURE = {"kind": "sensitivity", "parameters": {"frequency": 50, "beta": 20}}
GOAL = {"criterion": {"kind": "maximise", "output": "acceleration_x"}}


@pytest.mark.parametrize(
    "content",
    [
        study(parameters={**POINT, "amplitude": LONG}),
        study(parameters={**POINT, "amplitude": ["0.1 mm", LONG]}),
        *(study(parameters={**POINT, "amplitude": {**RANGE, key: LONG}}) for key in RANGE),
        study(**BEST, **GOAL, constraints=[{"output": "acceleration_x", "lower": LONG}]),
        study(**{**BEST, "variables": {"amplitude": {"lower": LONG, "upper": 1}}}, **GOAL),
        study(**UNSURE, uncertain={"amplitude": {"lower": LONG, "upper": 1}}),
        study(**UNSURE, uncertain={"amplitude": {"mean": "0.3 mm", "deviation": LONG}}),
        study(**UNSURE, uncertain={"amplitude": {"mean": "0.3 mm", "deviation": f"{LONG[:-2]}%"}}),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "amplitude": LONG}]),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "conveying_velocity": LONG}]),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "error": LONG}]),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "error": f"{LONG[:-2]}%"}]),
        study(**RUNS, **LOOKED_FOR, offsets={"beta": {"lower": -1, "upper": LONG}}),
    ],
)
def test_a_text_that_is_longer_than_a_value_is_refused_and_never_cut(content):
    with pytest.raises(StudyError) as caught:
        parse_study(content)
    assert TOO_LONG in str(caught.value)


@pytest.mark.parametrize("content", [cut("drive_along", LONG), cut("regime", "x" * 250)])
def test_a_long_condition_is_refused(content):
    with pytest.raises(StudyError, match="is not a condition"):
        parse_study(study(**content))


@pytest.mark.parametrize("text", ["17,220 mm/s", "1,500"])
def test_thousands_as_the_screen_writes_them_may_be_decimals(text):
    with pytest.raises(UnitError, match=r"may mean two numbers\. Remove the comma, or write a dec"):
        read_number("mean_velocity", QUANTITIES["mean_velocity"], text)
    longest = "0.3".ljust(197, "0") + " mm"
    assert read_number("amplitude", QUANTITIES["amplitude"], longest) == 3e-4
    with pytest.raises(UnitError, match="has 201 characters"):
        read_number("amplitude", QUANTITIES["amplitude"], f"{longest} ")


@pytest.mark.parametrize("read", [read_json, read_toml])
def test_an_integer_of_900_000_digits_is_refused_in_our_words(read):
    digits, words = "1" * 900_000, "it is a number larger than 1.8e308. Fix the value."
    text = '{"frequency": DIGITS}' if read is read_json else "frequency = DIGITS\n"
    for given, place in ((digits, ""), (digits[:400], "frequency: ")):
        with pytest.raises(StudyError) as caught:
            read(text.replace("DIGITS", given))
        assert f"{place}{words}" in str(caught.value)
    with pytest.raises(StudyError, match="has 900,000 characters"):
        parse_study(study(parameters={**POINT, "frequency": digits}))
