"""Advice for unknown names: never the name of another quantity, but how that one follows."""

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content, read_json, read_toml
from vibrafeed.core.study.grid_study import PARAMETERS
from vibrafeed.core.suggestions import nearest, suggestion

PLANE = {
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
    with pytest.raises(StudyError) as caught:
        read(text)
    right = number.replace(",", ".")
    assert str(caught.value) == f"{place}: the number {number} has a decimal comma. Write {right}."


BOX = {"kind": "sweep", "scene": "resting-part",
       "parameters": {"length": "30 mm", "width": "20 mm", "height": "10 mm"}}  # fmt: skip


ALONG = {"kind": "simulate", "outputs": ["conveying_velocity"]}


@pytest.mark.parametrize(
    ("study", "parameters", "words"),
    [
        *((PLANE, {typed: 180}, ["square of voltage", "scale drive_force by (V/V0)^2"])
          for typed in ("drive_voltage", "volts", "drive_current")),
        (PLANE, {"weight": "3 N"},
         ["parameters.weight: 'weight' is not a parameter. Write mass"]),
        ({**BOX, "outputs": ["let_down_share_flat"]}, {"centre_of_mass": "5 mm"},
         ["a box has its mass in the middle", "count a drop test"]),
        ({**BOX, "outputs": ["resting_share_flat"]}, {},
         ["Ask for let_down_share_flat and thrown_share_flat"]),
        (PLANE, {"beta": "30 %"}, ["'%' is not a unit"]),
        # A number without a unit has none in messages.
        (PLANE, {"friction": {"start": 0.5, "stop": 0.3, "num": 3}},
         ["parameters.friction: stop (0.3) of the range of friction is not above start (0.5). "
          "Swap start and stop, or list the values: a list may fall."]),
        # "A sin(beta)" had been said of a vertical amplitude, too, which is A sin(beta) itself.
        *(({**PLANE, **ALONG, "parameters": {"frequency": 50, "friction": 0.3}},
           {"amplitude_along_1": 1e-4, name: 1e-4},
           ["amplitude_normal_1 = amplitude sin(beta), which is the vertical amplitude"])
          for name in ("vertical_amplitude", "peak_to_peak")),
    ],
)  # fmt: skip
def test_a_study_is_told_what_it_may_mean(study, parameters, words):
    with pytest.raises(StudyError) as caught:
        prepare_content({**study, "parameters": {**study["parameters"], **parameters}})
    told = str(caught.value)
    assert all(word in told for word in words), told


def test_a_friction_in_per_cent_is_a_share_and_a_list_may_fall():
    content = {**PLANE, "parameters": {**PLANE["parameters"], "friction": ["30%", "20 %"]}}
    assert prepare_content(content).grid.coordinate("friction").tolist() == [0.3, 0.2]
