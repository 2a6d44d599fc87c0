"""The midpoint rule agrees with exact motion within its stated error, which is of first order."""

import pytest

import vibrafeed
from vibrafeed.core.motion import midpoint

HOP = {"frequency": 60, "amplitude": "0.4 mm", "beta": 25, "friction": 0.4, "gravity": 9.8}
STICK_SLIP = {**HOP, "amplitude": "0.05 mm", "beta": 20, "friction": 0.3}
REBOUND = {**HOP, "amplitude": "0.2 mm", "beta": 32, "restitution": 0.2}
OUTPUTS = ["conveying_velocity", "conveying_velocity_error"]


@pytest.mark.parametrize("parameters", [HOP, STICK_SLIP, REBOUND])
def test_it_agrees_with_exact_motion_within_an_error_of_first_order(parameters, monkeypatch):
    exact = vibrafeed.simulate("rectangle-on-plane", **parameters).conveying_velocity
    stated = []
    for steps in (100, 400, 1600):
        monkeypatch.setattr(midpoint, "STEPS", steps)
        found = vibrafeed.simulate(
            "rectangle-on-plane", method="midpoint", outputs=OUTPUTS, **parameters
        )
        stated.append(float(found.conveying_velocity_error))
        assert abs(float(found.conveying_velocity - exact)) <= stated[-1]
    assert stated[0] / stated[2] == pytest.approx(16, rel=0.5)
