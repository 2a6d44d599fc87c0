"""Regularised contact of `benchmarks.stiff` nears the exact laws, at the orders that are stated."""

import numpy as np
import pytest

from benchmarks.stiff import CASES, Stiff, measured


@pytest.mark.parametrize(
    ("case", "laws", "order"),
    [
        ("stick-slip", [(1e-6, 1e8), (1e-9, 1e8)], 2 / 3),  # slip_speed^(2/3)
        ("hop", [(1e-4, 1e6), (1e-4, 1e10)], 1 / 3),  # stiffness^(-1/3)
    ],
)
def test_errors_fall_as_the_theory_says(case, laws, order):
    first, second = (measured(case, "LSODA", *law)[0] for law in laws)
    ratio = np.log(first / second) / np.log(1e3 if case == "stick-slip" else 1e4)
    assert ratio == pytest.approx(order, abs=0.05)


def test_the_jacobian_is_the_derivative():
    part = Stiff(CASES["stick-slip"], 1e-3, 1e6)
    state, step = np.array([0.0, -2e-6, 1.5e-3, -1e-4]), np.array([1.0, 1e-11, 1e-8, 1e-8])
    found = part.jacobian(0.0, state)
    for k, h in enumerate(step):
        change = h * np.eye(4)[k]
        ahead, behind = (np.array(part.rate(0.3, state + way * change)) for way in (1, -1))
        assert found[:, k] == pytest.approx((ahead - behind) / (2 * h), rel=1e-5, abs=1e-6)
