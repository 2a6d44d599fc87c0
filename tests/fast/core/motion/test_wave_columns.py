"""Kernels find the numbers of a wave in a row where `Wave.columns` writes them."""

import numpy as np
import pytest

from vibrafeed.core.motion.kernels.sine_sums import wave_columns
from vibrafeed.core.motion.waves import ALONG, ENDS, NORMAL, Wave


@pytest.mark.parametrize(("orders", "steps"), [(3, 0), (0, 4), (2, 3), (1, 1)])
def test_columns_of_a_wave(orders, steps):
    random = np.random.default_rng(orders + 10 * steps)
    wave = Wave(random.normal(size=(3, 2, orders, 2)), random.normal(size=(4, steps, 2)))
    before = np.full((2, 5), 7.0)
    row = np.concatenate([before, wave.columns((2,))], axis=1)[1]
    at = wave_columns.py_func(row, before.shape[1])
    assert (at.orders, at.steps) == (orders, steps)
    for first, axis in ((at.along, ALONG), (at.normal, NORMAL)):
        both = row[first : first + 2 * orders].reshape(2, orders)
        np.testing.assert_array_equal(both, wave.harmonics[axis, ..., 1])
    for first, axis in ((at.levels, ALONG), (at.normal_levels, NORMAL), (at.ends, ENDS)):
        np.testing.assert_array_equal(row[first : first + steps], wave.steps[axis, :, 1])


def test_a_row_without_a_wave_has_no_orders_and_no_steps():
    at = wave_columns.py_func(np.arange(5.0), 5)
    assert (at.orders, at.steps) == (0, 0)
