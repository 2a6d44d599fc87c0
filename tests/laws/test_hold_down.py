"""A force that holds the part down: levels, rails, and three methods (theory 13.1)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import run_study

SINE = {"frequency": 50, "amplitude": "0.3 mm", "beta": 30, "friction": 0.4, "gravity": 9.8}
RAIL = {"frequency": 20, "gravity": 9.81, "gamma": 90, "friction_static": 0.44,
        "friction_kinetic": 0.34}  # fmt: skip
OUTPUTS = ["conveying_velocity", "conveying_velocity_error", "motion_status", "throw_number"]


def study(parameters, scene="rectangle-on-plane", method="events", outputs=OUTPUTS, **more):
    return {"kind": "simulate", "scene": scene, "method": method, "outputs": outputs,
            "parameters": parameters, **more}  # fmt: skip


def run(parameters, **more):
    return run_study(parse_study(study(parameters, **more)))


def two_levels(slow, fast, period):
    """Return a drive that pulls with `slow` around a piece of `fast` the other way."""
    first = fast / (2 * (slow + fast))
    return {
        "acceleration_along_1": slow, "acceleration_along_2": -fast, "acceleration_along_3": slow,
        "duration_1": first, "duration_2": 1 - 2 * first, "duration_3": first,
        "frequency": 1 / period,
    }  # fmt: skip


@pytest.mark.parametrize("held", [40.0, 50.0, 80.0])
def test_a_part_climbs_a_vertical_rail_as_fast_as_its_closed_form(held):
    """Quaid's two-level wave, with a clamping force onto the rail and gravity along it."""
    slow, fast, period, g = 0.7 * 9.81, 8 * 9.81, 1 / 20, 9.81
    slip = 0.34 * held + g
    assert slow <= 0.44 * held - g
    assert fast > 0.44 * held + g
    closed = period / 2 * slow**2 * (fast - slip) / ((slow + fast) * (slow + slip))
    found = run({**RAIL, **two_levels(slow, fast, period), "hold_down": held})
    assert float(found.conveying_velocity) == pytest.approx(closed, rel=1e-12)


@pytest.mark.parametrize("method", ["events", "reference"])
def test_without_a_force_a_vertical_rail_holds_nothing(method):
    found = run({**RAIL, "amplitude": "3 mm", "beta": 0}, method=method)
    assert np.isnan(found.conveying_velocity)


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"])
@pytest.mark.parametrize("amplitude", ["3 mm", "8 mm"], ids=["slides", "hops"])
def test_both_methods_agree_on_a_vertical_rail(scene, amplitude):
    steep = {**RAIL, "amplitude": amplitude, "beta": 35, "hold_down": 60}
    if amplitude == "3 mm":  # out of the plane, where no closed flow helps
        steep["alpha"] = 10
    exact, other = (run(steep, scene=scene, method=name) for name in ("events", "reference"))
    assert (exact.throw_number > 1) == (amplitude == "8 mm")
    assert abs(exact.conveying_velocity) > 1e-3
    apart = abs(float(other.conveying_velocity - exact.conveying_velocity))
    error = float(other.conveying_velocity_error + exact.conveying_velocity_error)
    assert apart <= error + 1e-9 * abs(float(exact.conveying_velocity))


def test_on_the_level_it_is_more_gravity():
    drive = {
        **SINE,
        "restitution": 0.3,
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": 40},
    }
    held = run({**drive, "hold_down": 5.2})
    heavy = run({**drive, "gravity": 15.0})
    assert np.allclose(held.throw_number, heavy.throw_number, rtol=1e-15)
    both = np.isin(held.motion_status, [1, 2])
    assert both.sum() > 20
    assert np.allclose(
        held.conveying_velocity[both], heavy.conveying_velocity[both], rtol=1e-9, atol=1e-15
    )


def test_what_a_study_does_not_give_is_left_out():
    plain = run(SINE)
    assert "hold_down" not in plain.coords
    assert float(plain.hold_down_number) == 0.0
    none = run({**SINE, "hold_down": 0})
    assert none.conveying_velocity.item() == plain.conveying_velocity.item()
    wave = run({"frequency": 50, "amplitude_along_1": "0.3 mm", "friction": 0.4, "hold_down": 5},
               outputs=["conveying_velocity", "load_number"])  # fmt: skip
    assert float(wave.load_number) == pytest.approx(1 + 5 / 9.80665, rel=1e-15)


def test_it_lifts_the_throw_number_only_as_a_load():
    found = run({**SINE, "gamma": 20, "hold_down": 4.9})
    load = math.cos(math.radians(20)) + 0.5
    drive = 3e-4 * (100 * math.pi) ** 2 / 9.8 * 0.5
    assert float(found.throw_number) == pytest.approx(drive / load, rel=1e-14)


def test_a_pull_off_the_floor_is_refused():
    with pytest.raises(StudyError) as refused:
        prepare_content(study({**SINE, "hold_down": -1}))
    assert [problem.place for problem in refused.value.problems] == ["parameters.hold_down"]
