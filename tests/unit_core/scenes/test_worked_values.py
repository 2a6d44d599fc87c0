"""Worked values, computed independently of this code, digit by digit.

Base: A0 = 0.4 mm, f = 50 Hz, mu = 0.35, alpha 12, beta 6 degrees, g = 9.8.
"""

from __future__ import annotations

import pytest

from core.study import parse_study
from core.sweep import sweep

BASE = {
    "frequency": "50 Hz", "amplitude": "0.4 mm", "friction": 0.35,
    "alpha": 12, "beta": 6, "gravity": 9.8,
}  # fmt: skip
TRACK = {**BASE, "gamma": 4, "delta": 3}
NEAR = {**TRACK, "radius": 0.5, "distance": "0.2 mm"}
FAR = {**NEAR, "distance": 0.3}
LATER = {**TRACK, "radius": 0.5, "time": 0.02}
PLANE, CYLINDER, NARROW = "rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"
EXACT = 1e-13

ROWS = [
    (PLANE, "thesis", "vibration_acceleration", BASE, 39.4784176043574, EXACT),
    (PLANE, "thesis", "acceleration_x", BASE, 36.4184949223834, EXACT),
    (PLANE, "thesis", "acceleration_y", BASE, 6.17737655114761, EXACT),
    (PLANE, "physical", "acceleration_x", BASE, 36.4618868729308, EXACT),
    (PLANE, "physical", "acceleration_y", BASE, 7.75021330571150, EXACT),
    (CYLINDER, "physical", "roll_root", BASE, 37.1269497403638, EXACT),
    (CYLINDER, "physical", "acceleration_x", BASE, 36.4544619996203, EXACT),
    (CYLINDER, "physical", "acceleration_y", BASE, 7.78683568438178, EXACT),
    # the last three are printed with twelve digits: half a unit of the last one
    (CYLINDER, "physical", "angular_acceleration", BASE, 188.112226609, 0.5e-9 / 188),
    (CYLINDER, "thesis", "angular_acceleration", BASE, 4081.5300688, 0.5e-7 / 4081),
    (CYLINDER, "derived", "angular_acceleration", BASE, 1360.51002293, 0.5e-8 / 1360),
    (NARROW, "thesis", "starting_acceleration", TRACK, 40.756711161203, EXACT),
    (NARROW, "derived", "starting_acceleration", TRACK, 40.3985610674032, EXACT),
    (NARROW, "physical", "starting_acceleration", TRACK, 40.3985610674032, EXACT),
    (NARROW, "thesis", "transport_velocity", NEAR, 0.127673028873224, EXACT),
    (NARROW, "derived", "transport_velocity", NEAR, 0.127110826913668, EXACT),
    (NARROW, "thesis", "transport_velocity", FAR, 4.46856380037475, EXACT),
    (NARROW, "derived", "transport_velocity", FAR, 4.44888669748826, EXACT),
    (NARROW, "derived", "velocity_at_time", LATER, 0.804938461112923, EXACT),
    (NARROW, "derived", "distance_at_time", LATER, 0.00806452559550407, EXACT),
    (NARROW, "physical", "wall_speed", {**TRACK, "radius": 0.5}, 1.95594186346, 0.5e-11 / 1.9),
    (NARROW, "physical", "normal_acceleration", TRACK, 5.63611152489, 0.5e-11 / 5.6),
    (NARROW, "physical", "acceleration_x", TRACK, 35.7479260324329, EXACT),
]


@pytest.mark.parametrize(("scene", "variant", "output", "parameters", "value", "tolerance"), ROWS)
def test_a_worked_value(scene, variant, output, parameters, value, tolerance):
    used = dict(parameters)
    if output == "angular_acceleration":
        used["diameter"] = "8 mm"
    for name in {"vibration_acceleration": ("friction", "alpha", "beta", "gravity"),
                 "wall_speed": ("friction",),
                 "normal_acceleration": ("friction", "alpha")}.get(output, ()):  # fmt: skip
        used.pop(name)
    study = {
        "kind": "sweep", "scene": scene, "variant": variant, "outputs": [output],
        "parameters": used,
    }  # fmt: skip
    assert float(sweep(parse_study(study))[output]) == pytest.approx(value, rel=tolerance)
