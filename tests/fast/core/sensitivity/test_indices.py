"""Sobol indices of functions whose own are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import sobol_indices as of_scipy

from benchmarks.sobol_indices import FUNCTIONS, sobol_indices
from vibrafeed.core.sensitivity.indices import design, indices_of


@pytest.mark.parametrize("name", FUNCTIONS)
def test_more_points_come_nearer(name):
    one = FUNCTIONS[name]
    found = sobol_indices(one.values, one.inputs, 1 << 13)
    assert found.first == pytest.approx(one.first, abs=0.02)
    assert found.total == pytest.approx(one.total, abs=0.03)


def test_estimates_are_those_of_scipy():
    one = FUNCTIONS["ishigami"]
    at = design(one.inputs, 64, seed=3, replicates=2)
    values = one.values(at.reshape(one.inputs, -1)).reshape(at.shape[1:])
    found = indices_of(values)
    a, b, *ab = values.reshape(len(values), -1)
    told = of_scipy(func={"f_A": a[None], "f_B": b[None], "f_AB": np.array(ab)[:, None]}, n=128)
    # scipy takes the mean of a and b together from both as well, and the same products.
    assert found.first == pytest.approx(told.first_order, abs=1e-12)
    assert found.total == pytest.approx(told.total_order, abs=1e-12)


def test_points_without_a_value_are_left_out_with_all_that_belong_to_them():
    def holed(x):
        return np.where(x[0] + x[1] < 0.02, np.nan, x[0] + 2 * x[1])

    found = sobol_indices(holed, 2, 4096)
    assert found.first == pytest.approx([0.2, 0.8], abs=0.03)
    constant = sobol_indices(lambda x: np.full(x.shape[1], 3.0), 2, 256)
    none = sobol_indices(lambda x: np.full(x.shape[1], np.nan), 2, 256)
    assert np.isnan([*constant.first, *constant.total, *none.first, *none.total]).all()
