"""Intervals of calibrations and of Sobol indices hold the truth as often as they say."""

from pathlib import Path

import numpy as np
import pytest

import vibrafeed
from benchmarks.calibrations import covered
from benchmarks.sobol_indices import FUNCTIONS, coverage
from vibrafeed.core.intake import load_study

RAIL = Path(__file__).parents[2] / "configs" / "calibrate-rail.toml"


def test_intervals_of_calibrations():
    """The bar is 93 to 97 % of 1,000 calibrations: `python -m benchmarks.calibrations` counts them.

    Of the some 25 unknowns here 95 % intervals miss more than 5 in one of 500 such samples.
    """
    few, many, count = covered(12, "errors", seed=1)
    assert count * (1.0 - many) < 5.5
    assert 0.35 < few < 0.95


@pytest.mark.parametrize("name", FUNCTIONS)
def test_intervals_of_indices(name):
    held = coverage(FUNCTIONS[name], samples=512, repeats=25)
    # Of 25 x inputs x 2 intervals 95 %: 12 % fewer would be six deviations away at the least.
    assert held.mean() >= 0.83


def test_one_number_tells_the_speeds_of_a_rail_of_cast_iron():
    """Yako, Yuan and Salisbury 2026: friction over mass is 0.558 per kg, rms 3.06 mm/s."""
    content = load_study(RAIL).content()
    content["parameters"]["mass"] = 1.0
    content["unknowns"] = {"friction": {"lower": 0.3, "upper": 1.0}}
    rail = vibrafeed.calibrate({**content, "points": 1_000})
    assert rail.best_friction == pytest.approx(0.558, abs=0.01)
    assert rail.lower_95_friction < 0.558 < rail.upper_95_friction
    assert float(np.sqrt(np.mean(np.square(rail.residual)))) == pytest.approx(3.06e-3, abs=1e-4)
    # Of 43 residuals of a normal distribution the scatter is known to a tenth.
    assert rail.discrepancy_lower_95 < 3.06e-3 * np.sqrt(43 / 42) < rail.discrepancy_upper_95
    width = float(rail.discrepancy_upper_68 - rail.discrepancy_lower_68) / 2
    assert width == pytest.approx(3.06e-3 / np.sqrt(2 * 42), rel=0.2)
