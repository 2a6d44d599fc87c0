"""Advice for unknown names: never the name of another quantity, but how that one follows."""

import pytest

from vibrafeed.core import suggestions
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content, read_json, read_toml
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.suggestions import nearest, suggestion

PLANE = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x"],
    "parameters": {"frequency": 50, "amplitude": "0.1 mm", "beta": 20, "friction": 0.3},
}


def problems(study=PLANE, **parameters):
    content = {**study, "parameters": {**study["parameters"], **parameters}}
    with pytest.raises(StudyError) as caught:
        prepare_content(
            {
                **content,
                "parameters": {
                    name: value
                    for name, value in content["parameters"].items()
                    if value is not None
                },
            }
        )
    return [str(problem) for problem in caught.value.problems]


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


@pytest.mark.parametrize("typed", ["drive_voltage", "voltage", "volts", "drive_current"])
def test_a_voltage_is_no_force(typed):
    advice = suggestion(typed, PARAMETERS)
    assert "square of voltage" in advice
    assert "scale drive_force by (V/V0)^2" in advice
    (message,) = problems(**{typed: 180})
    assert advice in message


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


def test_relations_speak_of_names_that_there_are_and_take_none():
    for target, names, sentence in suggestions._RELATIONS:
        assert target in QUANTITIES
        assert target in sentence or "frequency" in sentence
        assert not {*names.split()} & {*PARAMETERS}


def test_a_name_that_nobody_wrote_is_not_to_be_removed():
    (message,) = problems(weight="3 N")
    assert message.startswith("parameters.weight: 'weight' is not a parameter. Write mass")


def test_the_mass_of_a_box_is_in_its_middle():
    box = {"kind": "sweep", "scene": "resting-part", "outputs": ["let_down_share_flat"],
           "parameters": {"length": "30 mm", "width": "20 mm", "height": "10 mm"}}  # fmt: skip
    (message,) = problems(box, centre_of_mass="5 mm")
    assert "a box has its mass in the middle" in message
    assert "count a drop test" in message
    assert "turned" not in message


def test_a_friction_in_per_cent_is_a_share():
    content = {**PLANE, "parameters": {**PLANE["parameters"], "friction": ["20%", "30 %"]}}
    assert prepare_content(content).grid.coordinate("friction").tolist() == [0.2, 0.3]
    assert "'%' is not a unit" in problems(beta="30 %")[0]


def test_a_decimal_comma_is_named():
    toml = "kind = 'sweep'\n[parameters]\nfriction = 0,3\n"
    span = "[parameters]\nfriction = { start = 0,1, stop = 0.3, num = 3 }\n"
    for read, text, told in (
        (read_toml, toml, "file: line 3: the number 0,3 has a decimal comma. Write 0.3."),
        (read_toml, span, "file: line 2: the number 0,1 has a decimal comma. Write 0.1."),
        (read_json, '{"parameters": {"friction": 0,3}}',
         "body: line 1: the number 0,3 has a decimal comma. Write 0.3."),
    ):  # fmt: skip
        with pytest.raises(StudyError) as caught:
            read(text)
        assert str(caught.value) == told
    assert read_json('{"a": [0,3], "b": 1}') == {"a": [0, 3], "b": 1}


def test_a_number_without_a_unit_has_none_in_messages():
    (message,) = problems(friction={"start": 0.5, "stop": 0.3, "num": 3})
    assert message == (
        "parameters.friction: stop (0.3) of the range of friction is not above start (0.5). "
        "Swap start and stop, or list the values: a list may fall."
    )
    assert prepare_content({**PLANE, "parameters": {**PLANE["parameters"], "friction": [0.5, 0.3]}})


@pytest.mark.parametrize("name", ["vertical_amplitude", "peak_to_peak"])
def test_a_sine_beside_harmonics_is_told_as_zero_to_peak_amplitudes(name):
    """ "A sin(beta)" had been said of a vertical amplitude, too, which is A sin(beta) itself."""
    study = {**PLANE, "kind": "simulate", "outputs": ["conveying_velocity"]}
    told = " ".join(
        problems(study, amplitude=None, beta=None, amplitude_along_1=1e-4, **{name: 1e-4})
    )
    assert "amplitude_normal_1 = amplitude sin(beta), which is the vertical amplitude" in told


def test_a_share_of_rest_has_two_ends():
    study = {"kind": "sweep", "scene": "resting-part", "outputs": ["resting_share_flat"],
             "parameters": {"length": "12 mm", "width": "8 mm", "height": "3 mm"}}  # fmt: skip
    with pytest.raises(StudyError, match="Ask for let_down_share_flat and thrown_share_flat"):
        prepare_content(study)
