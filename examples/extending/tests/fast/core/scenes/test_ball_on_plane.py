"""A ball rolls with 5/7 of the drive until it leaves the floor."""

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.quantities import REGIMES

BALL = {"outputs": "acceleration_x", "frequency": 50, "amplitude": "0.1 mm"}


def test_a_ball_rolls_with_five_sevenths_of_the_drive():
    found = vibrafeed.sweep("ball-on-plane", **BALL, beta=0)
    # 5/7 of P cos(0) cos(0), P = 1e-4 (100 pi)^2; a few roundings
    assert float(found.acceleration_x) == pytest.approx(5 / 7 * 9.869604401089358, rel=1e-14)


def test_gravity_along_the_track_does_not_depend_on_the_drive():
    found = vibrafeed.sweep("ball-on-plane", **BALL, beta=[0, 10, 20], gamma=[0, 5], gravity=9.8)
    costs = found.acceleration_x.sel(gamma=0) - found.acceleration_x.sel(gamma=5)
    assert costs.values == pytest.approx(5 / 7 * 9.8 * np.sin(np.radians(5)), rel=1e-13)


def test_beyond_a_throw_number_of_one_it_flies():
    found = vibrafeed.sweep("ball-on-plane", **BALL, beta=[5, 80], gravity=5)
    assert found.regime.values.tolist() == [REGIMES["roll"].value, REGIMES["flight"].value]
