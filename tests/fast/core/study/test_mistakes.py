"""What people type by mistake leads to what they mean: names, numbers, files."""

from __future__ import annotations

import json

import pytest

from vibrafeed.app.cli.questions import QUESTIONS
from vibrafeed.core.catalogue import describe_all
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, prepare_content, read_content
from vibrafeed.core.intake.forms import keys_of_studies
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.quantities import QUANTITIES, WORD_OF
from vibrafeed.core.study.grid_study import CRITERIA, PARAMETERS, RecordedDrive
from vibrafeed.core.study.units import UnitError
from vibrafeed.core.study.unusual import questions
from vibrafeed.core.study.values import position_on_axis
from vibrafeed.core.suggestions import OTHER_NAMES, nearest

PLANE = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
}
TRACK = {**PLANE, "scene": "rectangle-on-track"}
TOML = 'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfrequency = 50\n'


def told(content):
    with pytest.raises(StudyError) as caught:
        prepare_content(content)
    return [str(problem) for problem in caught.value.problems]


def with_parameters(study=PLANE, **more):
    return {**study, "parameters": {**study["parameters"], **more}}


def test_other_names_stand_for_names_that_there_are():
    variants = {name for system in SYSTEMS.values() for name in system.variants}
    scenes = {scene["name"] for scene in describe_all()}
    known = {
        *QUANTITIES,
        *scenes,
        *keys_of_studies(),
        *RecordedDrive.model_fields,
        *KINDS,
        *CRITERIA,
        *METHODS,
        *variants,
    }
    known |= {word for question in QUESTIONS for word in question.choices}
    assert {name for names in OTHER_NAMES.values() for name in names} <= known
    parameters = {name for names in OTHER_NAMES.values() for name in names} & set(PARAMETERS)
    # Another name is not the name of a parameter itself: that would never be looked up.
    assert not {other for other, names in OTHER_NAMES.items() if other in parameters} - {"speed"}


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("mu", "friction"), ("µ", "friction"), ("mu_s", "friction_static"),
        ("mu_k", "friction_kinetic"), ("friction_coefficient", "friction"), ("clim", "gamma"),
        ("climb_angle", "gamma"), ("inclination", "gamma"), ("launch_angle", "beta"),
        ("vibration-angle", "beta"), ("throw_angle", "beta"), ("Stroke", "peak_to_peak"),
        ("freq", "frequency"), ("f", "frequency"), ("Friction Coefficient", "friction"),
    ],
)  # fmt: skip
def test_other_names_of_parameters_lead_to_them(typed, name):
    (message,) = told(with_parameters(**{typed: 1, name: 0.3}))[:1]
    word = f" ({WORD_OF[name]})" if name in WORD_OF else ""
    assert f"Did you mean '{name}'{word}?" in message


@pytest.mark.parametrize("typed", ["velocity", "speed", "feed_speed", "average velocity"])
def test_a_velocity_is_that_of_the_kind_of_study(typed):
    assert "Did you mean 'conveying_velocity'?" in told({**PLANE, "outputs": [typed]})[0]
    sweep = {**TRACK, "kind": "sweep", "outputs": [typed]}
    assert "Did you mean 'transport_velocity'?" in told(sweep)[0]


def test_an_output_of_another_kind_of_study_is_told_so():
    (message,) = told({**TRACK, "outputs": ["transport_velocity"]})
    assert message == (
        "outputs: a sweep gives transport_velocity; a simulation gives conveying_velocity. "
        'Ask for conveying_velocity in outputs, or set kind = "sweep".'
    )
    reverse = with_parameters({**TRACK, "kind": "sweep", "outputs": ["conveying_velocity"]})
    assert told(reverse) == [
        "outputs: a simulation gives conveying_velocity; a sweep gives transport_velocity. "
        'Ask for transport_velocity in outputs, or set kind = "simulate".'
    ]


def test_a_name_that_nothing_is_like_gets_the_names_of_its_scene():
    (message,) = told(with_parameters(coating=1))
    assert message == (
        "parameters.coating: 'coating' is not a parameter. Known: alpha, amplitude, beta, "
        "frequency, friction, friction_kinetic, friction_static, gamma, gravity, hold_down, "
        "hold_down_force, length, line_purity, line_yield, mass, occupancy, part_gap, "
        "peak_to_peak, restitution, vertical_amplitude, vertical_peak_to_peak."
    )
    (message,) = told(with_parameters(TRACK, coating=1))
    assert "wall_friction" in message


def test_parameters_outside_of_their_place_are_one_problem():
    loose = {"kind": "simulate", "scene": "rectangle-on-plane", **PLANE["parameters"]}
    assert told(loose) == [
        "parameters: frequency, amplitude, beta, friction stand outside. "
        "Write them below the line [parameters], in JSON within that object."
    ]
    assert told(with_parameters(outputs=["conveying_velocity"])) == [
        "parameters.outputs: 'outputs' is a key of the study, but stands in the section "
        "[parameters]. "
        "Move outputs above the line [parameters]."
    ]


def test_a_megabyte_of_names_looks_few_up():
    """Beside the floods: other names are looked up, never searched for."""
    many = {f"{name}{k}": 1 for k in range(300) for name in ("mu", "slope")}
    assert len(told(with_parameters(**many))) <= 250


@pytest.mark.parametrize(
    ("name", "typed", "means", "usual", "ask"),
    [
        ("amplitude", 0.5, "0.5 means 500 mm", "0.0001 to 25 mm", 'Did you mean "0.5 mm"?'),
        ("frequency", 5000, "5000 means 5,000 Hz", "1 to 1,000 Hz", 'Did you mean "5000 rpm"?'),
        ("beta", 0.35, "0.35 means 0.35 °", "1 to 180 °", 'Did you mean "0.35 rad"?'),
        ("friction", 30, "30 is unusual", "0.01 to 2", "Did you mean 0.3?"),
        ("radius", {"start": 100, "stop": 300, "num": 3}, "300 means 300,000 mm",
         "0.01 to 5,000 mm", 'Did you mean "300 mm"?'),
        ("amplitude", ["0.1 mm", "0.5 m"], '"0.5 m" is unusual', "0.0001 to 25 mm",
         "Is that what you mean?"),
    ],
)  # fmt: skip
def test_unusual_numbers_are_asked_about(name, typed, means, usual, ask):
    line = f"{name} = {means}; usual values are {usual}. {ask}"
    assert questions(with_parameters(**{name: typed})) == [line]


def test_usual_numbers_are_not():
    assert questions(PLANE) == []
    for one in ({"beta": "0.35 deg"}, {"beta": 0}, {"amplitude": [0, 0.0001]}, {"friction": 0}):
        assert questions(with_parameters(**one)) == []
    assert questions({"variables": {"beta": {"lower": 0.1, "upper": 0.5}}})
    assert questions("nothing") == questions({"parameters": 3}) == []


def test_a_byte_order_mark_is_read_over(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(TOML, encoding="utf-8-sig")
    assert load_study(path).scene == "rectangle-on-plane"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("study.json", TOML,
         "file: this is TOML, and its name ends in .json. Name it study.toml."),
        ("study.toml", json.dumps(PLANE),
         "file: this is JSON, and its name ends in .toml. Name it study.json."),
        ("study.toml", "beta = 20 deg", "file: it is not TOML: Expected newline or end of "
         "document after a statement (at line 1, column 11). Fix the syntax there: texts, such as "
         '"20 deg", stand in quotes.'),
        ("study.json", "{", "file: it is not JSON: Expecting property name enclosed in double "
         "quotes: line 1 column 2 (char 1). Fix the syntax there."),
        ("study.nc", "", "file: it is a result, not a study. Draw it with `vibrafeed plot`, or "
         "name its study."),
    ],
)  # fmt: skip
def test_files_are_told_apart(tmp_path, name, text, message):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(StudyError) as caught:
        read_content(path)
    assert str(caught.value) == message


def test_the_nearest_values_of_an_axis_are_told_in_the_unit_that_people_read():
    import numpy as np

    values = np.array([0.0006984949833, 0.0007088277592])
    with pytest.raises(UnitError) as caught:
        position_on_axis("amplitude", values, 0.0007, "trade")
    assert str(caught.value) == (
        "0.7 mm is not a value of the axis amplitude. The nearest are 0.6984949833 and "
        "0.7088277592 mm"
    )


def test_what_is_near_is_searched_for_when_no_other_name_says_it():
    assert nearest("betta", PARAMETERS) == "beta"
    assert nearest("mu", ["a", "b"]) is None
