"""Intervals of calibrations and of Sobol indices hold the truth as often as they say."""

from __future__ import annotations

import pytest

from benchmarks.calibrations import covered
from benchmarks.sobol_indices import FUNCTIONS, coverage


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
