"""Numbers at the ends of what floats hold: infinite or missing under a status, and no warning."""

from __future__ import annotations

import math

import numpy as np
import pytest

import vibrafeed
from core.quantities import REGIMES

NOT_VALID = [regime.value for regime in REGIMES.values() if not regime.valid]


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"])
@pytest.mark.parametrize("amplitude", [1e300, 1e308, 1.7e308])
def test_a_drive_beyond_floats_is_said_by_the_regime(scene, amplitude):
    on_track = {"radius": 0.3} if scene == "rectangle-on-track" else {}
    dataset = vibrafeed.sweep(
        scene=scene, outputs=["acceleration_x", "throw_number"], frequency=50,
        amplitude=[amplitude, 1e-4], beta=30, friction=0.3, **on_track,
    )  # fmt: skip
    assert np.isin(dataset.regime.values[0], NOT_VALID)
    assert np.isfinite(dataset.acceleration_x.values[1]).all()


@pytest.mark.parametrize("method", ["events", "time-stepping", "reference"])
def test_a_motion_beyond_floats_returns_and_says_so(method):
    dataset = vibrafeed.simulate(
        scene="rectangle-on-plane", method=method, frequency=50, amplitude=[1e200, 1e-4], beta=30,
        friction=0.5,
    )  # fmt: skip
    assert math.isnan(dataset.conveying_velocity.values[0])
    assert np.isfinite(dataset.conveying_velocity.values[1])


def test_a_drive_straight_up_moves_nothing_along():
    dataset = vibrafeed.simulate(
        scene="rectangle-on-plane", method="reference", frequency=50, amplitude="0.25 mm", beta=90,
        friction=0.5, outputs=["conveying_velocity", "period_multiple"],
    )  # fmt: skip
    # What is left is the cosine of the float nearest to 90 degrees.
    assert dataset.conveying_velocity.values == pytest.approx(0.0, abs=1e-15)
    assert dataset.period_multiple.values == 1


def test_parts_without_length_have_no_finite_rate():
    assert vibrafeed.parts_per_minute(velocity=0.1, length=0) == math.inf
    assert math.isnan(vibrafeed.parts_per_minute(velocity=0.0, length=0))
    assert vibrafeed.parts_per_minute(velocity=0.1, length=0, gap=0.01) == pytest.approx(600)
