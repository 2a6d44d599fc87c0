"""Dual numbers: derivatives of elementary functions, and what has none."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.plan.duals import Dual, NotDifferentiableError

SMOOTH = {
    "sqrt": np.sqrt, "square": np.square, "exp": np.exp, "expm1": np.expm1, "log": np.log,
    "log1p": np.log1p, "sin": np.sin, "cos": np.cos, "tan": np.tan, "arcsin": np.arcsin,
    "arccos": np.arccos, "arctan": np.arctan, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh,
    "arctanh": np.arctanh, "reciprocal": np.reciprocal, "absolute": np.abs,
    "negative": np.negative,
    "arctan2": lambda x: np.arctan2(x, 0.3) + np.arctan2(0.3, x),
    "hypot": lambda x: np.hypot(x, 0.3), "maximum": lambda x: np.maximum(x * x, 0.1),
    "minimum": lambda x: np.minimum(0.9, x), "clip": lambda x: np.clip(x * x, 0.1, 0.9),
    "power": lambda x: x**2.5 + 1.5**x + x**x, "divide": lambda x: 0.7 / x + x / 0.7 + x / (1 + x),
    "where": lambda x: np.where(x > 0.5, x * x, -x),
}  # fmt: skip


@pytest.mark.parametrize("name", SMOOTH)
def test_elementary_derivatives_against_differences(name):
    # A fourth-order difference: truncation h^4/30 f^(5) and rounding eps/h f both stay below 1e-9.
    f, h, x = SMOOTH[name], 1e-3, np.array([0.35, 0.62])
    slope = f(Dual(x, 1.0, [])).slope
    expected = (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h)
    assert slope == pytest.approx(expected, rel=1e-7, abs=1e-9)


def test_the_chain_rule():
    x = np.array([0.3, 0.7])
    inner = np.sin(Dual(x, 1.0, []))
    outer = np.exp(Dual(np.sin(x), 1.0, []))
    assert np.exp(inner).slope == pytest.approx(outer.slope * inner.slope, rel=1e-15)


def test_what_does_not_change_has_no_slope_however_steep():
    still = Dual(np.array([0.0]), 0.0, [])
    assert np.sqrt(still).slope == 0
    assert np.hypot(still, still).slope == 0


@pytest.mark.parametrize(
    "choose", [np.abs, lambda x: np.maximum(x, 0.0), lambda x: np.where(x == 0, 1.0, x)]
)
def test_a_choice_between_equals_is_noted(choose):
    ties = []
    choose(Dual(np.array([0.0, 1.0]), 1.0, ties))
    assert ties


def test_asarray_does_not_lose_the_slope():
    x = Dual(2.0, 1.0, [])
    assert (np.asarray(x) * x).slope == 4.0
    with pytest.raises(NotDifferentiableError):
        np.asarray(x, dtype=np.float64)


@pytest.mark.parametrize("function", [np.floor, np.linalg.norm, np.add.reduce])
def test_functions_without_a_rule_say_so(function):
    with pytest.raises(NotDifferentiableError):
        function(Dual(np.ones(2), 1.0, []))
