"""A force that holds the part down: levels, rails, and three methods (theory 13.1)."""

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.errors import StudyError

SINE = {"frequency": 50, "amplitude": "0.3 mm", "beta": 30, "friction": 0.4, "gravity": 9.8}
RAIL = {"frequency": 20, "gravity": 9.81, "gamma": 90, "friction_static": 0.44,
        "friction_kinetic": 0.34}  # fmt: skip
OUTPUTS = ["conveying_velocity", "conveying_velocity_error", "motion_status", "throw_number"]


def run(parameters, scene="rectangle-on-plane", method="events"):
    return vibrafeed.simulate(scene=scene, method=method, outputs=OUTPUTS, **parameters)


@pytest.mark.parametrize("held", [40.0, 80.0])
def test_a_part_climbs_a_vertical_rail_as_fast_as_its_closed_form(held):
    """Quaid's two-level wave, with a clamping force onto the rail and gravity along it."""
    slow, fast, period, g = 0.7 * 9.81, 8 * 9.81, 1 / 20, 9.81
    slip, first = 0.34 * held + g, fast / (2 * (slow + fast))
    assert slow <= 0.44 * held - g
    assert fast > 0.44 * held + g
    closed = period / 2 * slow**2 * (fast - slip) / ((slow + fast) * (slow + slip))
    found = run({
        **RAIL, "hold_down": held, "acceleration_along_1": slow, "acceleration_along_2": -fast,
        "acceleration_along_3": slow, "duration_1": first, "duration_2": 1 - 2 * first,
        "duration_3": first,
    })  # fmt: skip
    assert float(found.conveying_velocity) == pytest.approx(closed, rel=1e-12)


@pytest.mark.parametrize("method", ["events", "reference"])
def test_without_a_force_a_vertical_rail_holds_nothing(method):
    found = run({**RAIL, "amplitude": "3 mm", "beta": 0}, method=method)
    assert np.isnan(found.conveying_velocity)


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"])
def test_both_methods_agree_on_a_vertical_rail(scene):
    steep = {**RAIL, "amplitude": "8 mm", "beta": 35, "hold_down": 60}
    exact, other = (run(steep, scene=scene, method=name) for name in ("events", "reference"))
    assert exact.throw_number > 1
    assert abs(exact.conveying_velocity) > 1e-3
    apart = abs(float(other.conveying_velocity - exact.conveying_velocity))
    error = float(other.conveying_velocity_error + exact.conveying_velocity_error)
    assert apart <= error + 1e-9 * abs(float(exact.conveying_velocity))


def test_on_the_level_it_is_more_gravity():
    drive = {**SINE, "restitution": 0.3, "amplitude": np.linspace(1e-4, 1e-3, 40)}
    held, heavy = run({**drive, "hold_down": 5.2}), run({**drive, "gravity": 15.0})
    assert np.allclose(held.throw_number, heavy.throw_number, rtol=1e-15)
    both = np.isin(held.motion_status, [1, 2])
    assert both.sum() > 20
    velocities = held.conveying_velocity[both], heavy.conveying_velocity[both]
    np.testing.assert_allclose(*velocities, rtol=1e-9, atol=1e-15)
    with pytest.raises(StudyError, match="hold_down"):
        run({**SINE, "hold_down": -1})
