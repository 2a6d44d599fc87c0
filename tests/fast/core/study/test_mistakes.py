"""What people type by mistake leads to what they mean, never to the name of another quantity."""

import json

import numpy as np
import pytest

from refusals import problems_of, words_of
from vibrafeed.app.cli.questions import QUESTIONS
from vibrafeed.core.catalogue import describe_all
from vibrafeed.core.intake import load_study, prepare_content, read_content, read_json, read_toml
from vibrafeed.core.intake.forms import keys_of_studies
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.quantities import QUANTITIES, WORD_OF
from vibrafeed.core.study.grid_study import CRITERIA, PARAMETERS, RecordedDrive
from vibrafeed.core.study.units import UnitError
from vibrafeed.core.study.unusual import questions
from vibrafeed.core.study.values import position_on_axis
from vibrafeed.core.suggestions import OTHER_NAMES, nearest, suggestion

PLANE = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
}
TRACK = {**PLANE, "scene": "rectangle-on-track"}
TOML = 'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfrequency = 50\n'


def told(content):
    return [str(problem) for problem in problems_of(prepare_content, content)]


def with_parameters(study=PLANE, **more):
    return {**study, "parameters": {**study["parameters"], **more}}


def test_other_names_stand_for_names_that_there_are():
    known = {
        *QUANTITIES, *keys_of_studies(), *RecordedDrive.model_fields, *KINDS, *CRITERIA, *METHODS,
        *(scene["name"] for scene in describe_all()),
        *(name for system in SYSTEMS.values() for name in system.variants),
        *(word for question in QUESTIONS for word in question.choices),
    }  # fmt: skip
    named = {name for names in OTHER_NAMES.values() for name in names}
    assert named <= known
    # Another name is not the name of a parameter itself: that would never be looked up.
    assert not OTHER_NAMES.keys() & named & set(PARAMETERS) - {"speed"}


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


@pytest.mark.parametrize("typed", ["velocity", "speed", "average velocity"])
@pytest.mark.parametrize(
    ("kind", "output"), [("simulate", "conveying_velocity"), ("sweep", "transport_velocity")]
)
def test_a_velocity_is_that_of_the_kind_of_study(typed, kind, output):
    (message, *_) = told({**TRACK, "kind": kind, "outputs": [typed]})
    assert f"Did you mean '{output}'?" in message


@pytest.mark.parametrize(
    ("study", "messages"),
    [
        ({**TRACK, "outputs": ["transport_velocity"]},
         ["outputs: transport_velocity is an output of a sweep, not of a simulation. "
          'Request conveying_velocity, or set kind = "sweep".']),
        ({**with_parameters(TRACK), "kind": "sweep", "outputs": ["conveying_velocity"]},
         ["outputs: conveying_velocity is an output of a simulation, not of a sweep. "
          'Request transport_velocity, or set kind = "simulate".']),
        (with_parameters(coating=1),
         ["parameters.coating: 'coating' is not a parameter. Known: alpha, amplitude, beta, "
          "burst_periods, frequency, friction, friction_kinetic, friction_static, gamma, gravity, "
          "hold_down, "
          "hold_down_force, length, line_purity, line_yield, mass, occupancy, part_gap, "
          "peak_to_peak, restitution, vertical_amplitude, vertical_peak_to_peak."]),
        ({"kind": "simulate", "scene": "rectangle-on-plane", **PLANE["parameters"]},
         ["parameters: frequency, amplitude, beta, friction are outside the section [parameters]. "
          "Move them below the line [parameters], or in JSON into the object parameters."]),
        (with_parameters(outputs=["conveying_velocity"]),
         ["parameters.outputs: 'outputs' is a key of the study, but it is in the section "
          "[parameters]. Move outputs above the line [parameters]."]),
    ],
)  # fmt: skip
def test_what_stands_in_a_wrong_place_is_told_so(study, messages):
    assert told(study) == messages


@pytest.mark.parametrize(
    ("name", "typed", "told"),
    [
        ("amplitude", 0.5,
         ['0.5 means 500 mm; usual values are 0.0001 to 25 mm. Did you mean "0.5 mm"?']),
        ("frequency", 5000,
         ['5000 means 5,000 Hz; usual values are 1 to 1,000 Hz. Did you mean "5000 rpm"?']),
        ("beta", 0.35,
         ['0.35 means 0.35 °; usual values are 1 to 180 °. Did you mean "0.35 rad"?']),
        ("friction", 30, ["30 is unusual; usual values are 0.01 to 2. Did you mean 0.3?"]),
        ("radius", {"start": 100, "stop": 300, "num": 3},
         ["300 means 300,000 mm; usual values are 0.01 to 5,000 mm. Did you mean \"300 mm\"?"]),
        ("amplitude", ["0.1 mm", "0.5 m"],
         ['"0.5 m" is unusual; usual values are 0.0001 to 25 mm. Is that what you mean?']),
        ("beta", "0.35 deg", []),
        ("beta", 0, []),
        ("amplitude", [0, 0.0001], []),
    ],
)  # fmt: skip
def test_unusual_numbers_are_asked_about(name, typed, told):
    assert questions(with_parameters(**{name: typed})) == [f"{name} = {one}" for one in told]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("study.json", TOML,
         "the file contains TOML, but its name ends in .json. Rename it to study.toml."),
        ("study.toml", json.dumps(PLANE),
         "the file contains JSON, but its name ends in .toml. Rename it to study.json."),
        ("study.toml", "beta = 20 deg", "it is not TOML: Expected newline or end of "
         "document after a statement (at line 1, column 11), in the line beta = 20 deg. Fix the "
         'syntax there: put texts, such as "20 deg", in quotes.'),
        ("study.toml", 'beta = "20 deg', "it is not TOML: Unterminated string (at end of "
         'document), in the line beta = "20 deg. Is a quote missing there?'),
        ("study.json", "{", "it is not JSON: Expecting property name enclosed in double "
         "quotes: line 1 column 2 (char 1). Fix the syntax there."),
        ("study.nc", "", "it is a result, not a study. Draw it with `vibrafeed plot`, or "
         "give the study's file."),
    ],
)  # fmt: skip
def test_files_are_told_apart(tmp_path, name, text, message):
    (tmp_path / name).write_text(text, encoding="utf-8-sig")  # a mark is read over
    assert words_of(read_content, tmp_path / name) == f"file: {message}"


def test_the_nearest_values_of_an_axis_are_told_in_the_unit_that_people_read():
    values = np.array([0.0006984949833, 0.0007088277592])
    with pytest.raises(UnitError, match=r"^0\.7 mm is not .* 0\.6984949833 and 0\.7088277592 mm$"):
        position_on_axis("amplitude", values, 0.0007, "trade")


SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x"],
    "parameters": {"frequency": 50, "amplitude": "0.1 mm", "beta": 20, "friction": 0.3},
}


@pytest.mark.parametrize(
    ("typed", "advice"),
    [
        ("angular_frequency", "Write frequency = omega/(2 pi), in Hz"),
        ("omega", "Write frequency = omega/(2 pi), in Hz"),
        ("rpm", 'Write the unit with the value: frequency = "3000 rpm"'),
        ("rms_amplitude", "Write amplitude = sqrt(2) times the rms value of a sine"),
        ("Horizontal amplitude", "Write amplitude = horizontal amplitude/cos(beta)"),
        ("bowl_diameter", "Write radius = diameter/2, at the wall of the track"),
        ("part_radius", "Write diameter = 2 times the radius"),
        ("amplitude_mm", 'Write the unit with the value, as in amplitude = "1 mm"'),
        ("stroke_mm", 'Write the unit with the value, as in peak_to_peak = "1 mm"'),
        ("beta_rad", 'Write the unit with the value, as in beta = "1 rad"'),
        ("vertical_acceleration",
         "Write vertical_amplitude = acceleration/(2 pi frequency)^2, and beta"),
        ("density", "Write mass = density times volume"),
        ("amplitude_normal", "Did you mean 'vertical_amplitude'?"),
        ("vertical_stroke", "Did you mean 'vertical_peak_to_peak'?"),
        ("stroke", "Did you mean 'peak_to_peak'?"),
        ("natural_frequency", "Did you mean 'ring_down_frequency'?"),
        ("amplitude_y", "Write vertical_amplitude, and beta, if y is normal to the track"),
        ("z_amplitude", "Did you mean 'vertical_amplitude'?"),
        ("amplitude_pp", "Did you mean 'peak_to_peak'?"),
        ("machine_number",
         "Write amplitude = machine number times gravity/(2 pi frequency)^2, along the drive"),
        ("spring_rate",
         "Write spring_stiffness = stiffness of all springs together, along the stroke"),
        ("phase",
         "Write phase_normal_1 = lead of the normal motion over that along (a lag is negative), "
         "beside amplitude_along_1 and amplitude_normal_1"),
        ("force", "Did you mean 'drive_force'?"),
        ("gamma_percent", "Write gamma = atan(per cent/100)"),
    ],
)  # fmt: skip
def test_a_related_quantity_gets_the_relation(typed, advice):
    assert suggestion(typed, PARAMETERS) == advice


@pytest.mark.parametrize(
    "typed",
    ["max_amplitude", "mean_friction", "half_amplitude", "track_speed", "base_weight",
     "bowl_mass", "static_mass", "cone_angle", "inner_radius", "horizontal_friction",
     "amplitude_dc", "spring_weight"],
)  # fmt: skip
def test_no_name_of_another_quantity_is_suggested(typed):
    assert nearest(typed, PARAMETERS) is None
    assert suggestion(typed, PARAMETERS, ["alpha"]) == "Known: alpha"


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("vertical_amplitud", "vertical_amplitude"), ("vertcal_amplitude", "vertical_amplitude"),
        ("friction_statc", "friction_static"), ("frict", "friction"), ("ampltude", "amplitude"),
        ("peaktopeak", "peak_to_peak"), ("wiper_hight_1", "wiper_height_1"),
        ("spring_stifness", "spring_stiffness"), ("phase_normal", "phase_normal_1"),
        ("smal_diameter", "small_diameter"), ("parts_mass", "part_mass_9"),
        ("frictionstatic", "friction_static"),
    ],
)  # fmt: skip
def test_a_slip_of_the_pen_is_mended(typed, meant):
    assert nearest(typed, PARAMETERS) == meant


@pytest.mark.parametrize(
    ("read", "text", "place", "number"),
    [
        (read_toml, "kind = 'sweep'\n[parameters]\nfriction = 0,3\n", "file: line 3", "0,3"),
        (read_toml, "[parameters]\nb = { start = 0,1, stop = 0.3 }\n", "file: line 2", "0,1"),
        (read_toml, "[parameters]\nb=-0,3 mm\n", "file: line 2", "-0,3"),
        (read_json, '{"parameters": {"friction": 0,3}}', "body: line 1", "0,3"),
    ],
)
def test_a_decimal_comma_is_named(read, text, place, number):
    right = number.replace(",", ".")
    assert (
        words_of(read, text) == f"{place}: the number {number} has a decimal comma. Write {right}."
    )


BOX = {"kind": "sweep", "scene": "resting-part",
       "parameters": {"length": "30 mm", "width": "20 mm", "height": "10 mm"}}  # fmt: skip


ALONG = {"kind": "simulate", "outputs": ["conveying_velocity"]}


@pytest.mark.parametrize(
    ("study", "parameters", "words"),
    [
        *((SWEEP, {typed: 180}, ["square of voltage", "one measured point by measured_volt"])
          for typed in ("volts", "drive_current")),
        (SWEEP, {"weight": "3 N"},
         ["parameters.weight: 'weight' is not a parameter. Write mass"]),
        ({**BOX, "outputs": ["let_down_share_flat"]}, {"centre_of_mass": "5 mm"},
         ["a box has its mass in the middle", "count a drop test"]),
        ({**BOX, "outputs": ["resting_share_flat"]}, {},
         ["Ask for let_down_share_flat and thrown_share_flat"]),
        (SWEEP, {"beta": "30 %"}, ["'%' is not a unit"]),
        # A number without a unit has none in messages.
        (SWEEP, {"friction": {"start": 0.5, "stop": 0.5, "num": 3}},
         ["parameters.friction: start and stop of the range of friction are both 0.5. "]),
        # "A sin(beta)" had been said of a vertical amplitude, too, which is A sin(beta) itself.
        *(({**SWEEP, **ALONG, "parameters": {"frequency": 50, "friction": 0.3}},
           {"amplitude_along_1": 1e-4, name: 1e-4},
           ["amplitude_normal_1 = amplitude sin(beta), which is the vertical amplitude"])
          for name in ("vertical_amplitude", "peak_to_peak")),
    ],
)  # fmt: skip
def test_a_study_is_told_what_it_may_mean(study, parameters, words):
    told = words_of(prepare_content, {**study, "parameters": {**study["parameters"], **parameters}})
    assert all(word in told for word in words), told


def test_a_friction_in_per_cent_is_a_share_and_a_list_may_fall():
    content = {**SWEEP, "parameters": {**SWEEP["parameters"], "friction": ["30%", "20 %"]}}
    assert prepare_content(content).grid.coordinate("friction").tolist() == [0.3, 0.2]


DRIVEN_BY = """\
kind = "simulate"
scene = "rectangle-on-plane"
parameters = {{ friction = 0.3 }}
{}
"""
SLASHES = "Write / between the folders of a path, not \\"


@pytest.mark.parametrize(
    "path", ["C:\\Users\\anna\\x.csv", "data\\x.csv", "C:\\temp\\x.csv", "data\\"]
)
def test_a_backslash_in_double_quotes_is_told(path):
    message = words_of(read_toml, f'[drive]\nfile = "{path}"\n')
    assert "line 2" in message
    assert message.endswith("In a path write / for \\, or set the path in '...'.")


def test_utf_16_is_what_powershell_writes(tmp_path):
    file = tmp_path / "study.toml"
    file.write_bytes(DRIVEN_BY.format("").replace("\n", "\r\n").encode("utf-16"))
    message = "it is not UTF-8 text. Save it as UTF-8; in PowerShell write it with -o FILE, not >."
    assert words_of(read_content, file) == f"file: {message}"
    file.write_bytes("title = 'Sch\u00fcttgut'".encode("latin-1"))
    assert words_of(read_content, file) == "file: it is not UTF-8 text. Save it as UTF-8."


@pytest.mark.parametrize(
    ("kind", "line", "words"),
    [
        ("simulate", "drive = { file = 'data\\x.csv', along = 'a' }", SLASHES),
        ("simulate", 'drive = { file = "data\\new.csv", along = "a" }', SLASHES),
        ("calibrate", "observations = 'data\\x.csv'", SLASHES),
        ("sensitivity", "uncertain = { friction = { calibration = 'data\\x.nc' } }", SLASHES),
        ("simulate", "drive = { file = 'data/x.csv', along = 'a' }", "Give the path of a CSV file"),
    ],
)
def test_a_missing_file_with_backslashes_is_told_of_the_separator(tmp_path, kind, line, words):
    file = tmp_path / "study.toml"
    file.write_text(DRIVEN_BY.format(line).replace("simulate", kind))
    assert words in words_of(load_study, file)
