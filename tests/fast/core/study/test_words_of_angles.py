"""Azimuth, elevation, climb and lean stand for alpha, beta, gamma and delta in every way in."""

import json

import numpy as np
import pytest
import xarray

from refusals import problems_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import (
    gather,
    load_study,
    parse_json,
    parse_study,
    prepare_content,
    study_of,
)
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import read_fixed
from vibrafeed.core.quantities import WORDS
from vibrafeed.core.sweep.slice import compute_slice, prepare_cut

LETTERS = {letter: word for word, letter in WORDS.items()}
DRIVE = {"frequency": "50 Hz", "amplitude": "0.3 mm", "friction": 0.3}
TRACK = {"kind": "simulate", "scene": "rectangle-on-track"}
PLANE = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"]}
GRID = {"start": 10, "stop": 30, "num": 5}
RANGE = {"lower": "10 deg", "upper": "30 deg"}
RUNS = [
    {"beta": 20, "amplitude": "0.25 mm", "conveying_velocity": "20 mm/s", "error": "1 mm/s"},
    {"beta": 25, "amplitude": "0.25 mm", "conveying_velocity": "18 mm/s", "error": "1 mm/s"},
]
STUDIES = {
    "parameters": {
        **TRACK,
        "parameters": {**DRIVE, "alpha": 2, "beta": "20 deg", "gamma": 1, "delta": 5,
                       "radius": "0.2 m"},
    },
    "sensitivities": {**PLANE, "parameters": {**DRIVE, "beta": GRID}, "sensitivities": ["beta"]},
    "reduce": {
        **PLANE,
        "parameters": {**DRIVE, "beta": GRID, "gamma": [0, 2]},
        "reduce": {
            "over": ["beta", "gamma"], "statistics": ["max"],
            "levels": {"climb": {"output": "acceleration_x", "level": 1, "along": "beta"}},
        },
    },
    "variables": {
        "kind": "optimise", "scene": "rectangle-on-plane", "parameters": {**DRIVE, "gamma": 1},
        "variables": {"alpha": RANGE, "beta": RANGE},
        "criterion": {"kind": "maximise", "output": "acceleration_x"},
    },
    "uncertain": {
        "kind": "sensitivity", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"],
        "parameters": DRIVE, "uncertain": {"beta": RANGE},
    },
    "calibrate": {
        "kind": "calibrate", "scene": "rectangle-on-plane", "parameters": {"frequency": "50 Hz"},
        "observations": RUNS, "unknowns": {"friction": {"lower": 0.1, "upper": 0.5},
                                           "gamma": {"lower": -2, "upper": 2}},
        "offsets": {"beta": {"mean": 0, "deviation": "2 deg"}},
        "factors": {"amplitude": {"lower": 0.9, "upper": 1.1}},
        "candidates": {"beta": GRID, "amplitude": "0.3 mm"},
    },
    "columns": {
        "kind": "calibrate", "scene": "rectangle-on-plane",
        "parameters": {"frequency": "50 Hz", "gamma": 0},
        "observations": {name: [run[name] for run in RUNS] for name in RUNS[0]},
        "unknowns": {"friction": {"lower": 0.1, "upper": 0.5}},
    },
}  # fmt: skip


def in_words(study):
    """Return a study with the words of angles, as a user would write it."""
    text = json.dumps(study)
    for letter, word in LETTERS.items():
        text = text.replace(f'"{letter}"', f'"{word}"')
    return json.loads(text)


def told(content):
    return [str(problem) for problem in problems_of(prepare_content, content)]


@pytest.mark.parametrize("section", STUDIES)
def test_a_study_in_words_is_that_in_letters(section, tmp_path):
    letters, words = STUDIES[section], in_words(STUDIES[section])
    expected, file = parse_study(letters), tmp_path / "study.json"
    file.write_text(json.dumps(words))
    for made in (
        parse_study(words), parse_json(json.dumps(words)), load_study(file), study_of(words),
        parse_study(gather(words, {})), parse_study(gather(file, {})),
    ):  # fmt: skip
        assert made.key() == expected.key()
        assert made.content() == expected.content()


@pytest.mark.parametrize(
    "section",
    ["parameters", "variables", "uncertain", "offsets", "candidates", "unknowns", "observations"],
)
def test_an_angle_is_given_once(section):
    study = json.loads(json.dumps(STUDIES.get(section, STUDIES["calibrate"])))
    given = study[section][1] if section == "observations" else study[section]
    word = "climb" if section == "unknowns" else "elevation"
    given[word] = given[WORDS[word]]
    place = f"observations row 2, {word}" if section == "observations" else f"{section}.{word}"
    fault = f"{word} and {WORDS[word]} are the same angle, and both are given"
    assert f"{place}: {fault}. Leave out {word} or {WORDS[word]}." in told(study)


def test_keywords_take_words():
    loose = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": "acceleration_x", **DRIVE}
    expected = parse_study(gather(None, {**loose, "beta": [10, 20], "gamma": 1}))
    array = xarray.DataArray([10, 20], dims="elevation", attrs={"units": "degree"})
    for study, keywords in (
        (None, {**loose, "elevation": [10, 20], "parameters": {"climb": 1}}),
        ({**loose, "beta": 5, "climb": 7}, {"elevation": [10, 20], "gamma": 1}),
        ({**loose, "elevation": 5, "climb": 7}, {"beta": [10, 20], "climb": 1}),
        (expected, {"elevation": array}),
    ):
        assert parse_study(gather(study, keywords)).key() == expected.key()
    for one in ({"elevation": 5, "beta": 6}, {"elevation": 5, "parameters": {"beta": 6}}):
        with pytest.raises(StudyError, match="elevation and beta are the same angle"):
            parse_study(gather(None, {**loose, **one}))


def test_arrays_of_words_may_be_designs():
    pairs = {
        "elevation": xarray.DataArray([10, 20], dims="run"),
        "climb": xarray.DataArray([1, 2], dims="run"),
    }
    content = gather(None, {**PLANE, **DRIVE, **pairs})
    assert content["parameters"]["elevation"] == {"design": [10, 20]}
    assert content["parameters"]["climb"] == {"design": [1, 2]}


def test_messages_say_what_the_user_wrote():
    study = {**TRACK, "parameters": {**DRIVE, "elevation": "30 mm", "climb": 100, "azimut": 3}}
    assert told(study)[:3] == [
        "parameters.elevation: 'mm' does not measure drive elevation. "
        'Write elevation = "20 deg" (a bare number is in degree).',
        "parameters.climb: climb is 100 degree. It must be at most 90.",
        "parameters.azimut: 'azimut' is not a parameter. Did you mean 'alpha' (azimuth)?",
    ]
    small = {**PLANE, "parameters": {**DRIVE, "elevation": 0.35}}  # radians, probably
    assert prepare_content(small).questions[0].startswith("elevation = 0.35 means")
    outside = {**PLANE, "elevation": 20, "parameters": DRIVE}
    assert told(outside)[0].startswith("parameters: elevation is outside")


def test_slices_and_pictures_take_words():
    study = {**PLANE, "parameters": {**DRIVE, "beta": GRID, "gamma": [0, 2]}}
    sweep, at = prepare_content(study), {"climb": "2 deg"}
    wishes = (["beta"], {"gamma": "2 deg"}), (["elevation"], at)
    one, other = (
        compute_slice(prepare_cut(sweep, output="acceleration_x", axes=axes, at=at, most=100))
        for axes, at in wishes
    )
    np.testing.assert_array_equal(one["values"]["data"], other["values"]["data"])
    with pytest.raises(StudyError, match=r"^climb: climb and gamma are the same angle"):
        prepare_cut(sweep, output="acceleration_x", axes=["beta"], at={**at, "gamma": 0}, most=100)
    assert read_fixed(at) == {"gamma": 2.0}
    with pytest.raises(PlotError, match="same angle"):
        read_fixed({**at, "gamma": 1})
