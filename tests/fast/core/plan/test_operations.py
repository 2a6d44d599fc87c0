"""Each row of the table of operations: loops to the bit of numpy, digits by numbers."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from precise import DIGITS_OF, Number
from vibrafeed.core.mechanics.arrays import (
    arc_quotient,
    arc_series,
    binade,
    exponent,
)
from vibrafeed.core.mechanics.rolling import slip_share
from vibrafeed.core.plan.trace import IN_LOOPS

POINTS = {1: [(0.35,), (0.62,)], 2: [(0.35, 0.62), (0.62, 0.35)]}
OWN_POINTS = {  # of functions of ours, whose arguments belong together
    np.ldexp: [(0.35, 2), (0.62, -3)],
    arc_quotient: [(x, math.sqrt(1 - x)) for x in (0.96, 0.4, 0.2, 1e-3, 0.0, -1e-3, -0.7, -9.0)],
    arc_series: [(w,) for w in (0.039, 0.021, 1e-3, 0.0, -1e-3, -0.03)],
    slip_share: [(0.6, 0.8, 0.3, 3.0), (0.8, 0.6, 0.0, 3.0), (0.28, 0.96, 0.25, 2.3)],
}
BETWEEN_LOOPS = (
    np.power, np.positive, np.hypot, np.ldexp, np.exp, np.expm1, np.log, np.log1p, arc_quotient,
    arc_series, slip_share, np.sin, np.cos, np.tan, np.arcsin, np.arccos, np.arctan, np.arctan2,
    np.sinh, np.cosh, np.tanh, np.arctanh, np.rint,
)  # fmt: skip
AT_EDGES = [0.0, -0.0, 1.0, -1.5, 3e-300, math.inf, -math.inf, math.nan]


def points(function):
    return OWN_POINTS.get(function) or POINTS[function.nin]


def of_loop(expression, values):
    """Return what a loop gives, with the quotients of a processor in place of Python's errors."""
    words = {"sqrt": np.sqrt, "abs": abs, "copysign": math.copysign, "inf": math.inf}
    words |= {"binade": binade, "exponent": exponent}
    words["choose"] = lambda condition, one, other: one if condition else other
    words["v"] = [v if isinstance(v, bool) else np.float64(v) for v in values]
    return eval(expression.format("v[0]", "v[1]", "v[2]"), words)


@pytest.mark.parametrize(
    "function", [one for one in IN_LOOPS if one is not np.where], ids=lambda one: one.__name__
)
def test_a_loop_has_the_bits_of_numpy(function):
    is_logical = function in (np.bitwise_and, np.bitwise_or, np.invert)
    edges = [False, True] if is_logical else AT_EDGES
    for values in itertools.product(edges, repeat=function.nin):
        with np.errstate(all="ignore"):
            want = np.asarray(function(*values))
            got = np.asarray(of_loop(IN_LOOPS[function], values), dtype=want.dtype)
        np.testing.assert_array_equal(got, want, err_msg=str(values))
        # Of NaN the bits are free; which of two zeros is the larger, numpy does not say.
        if want.dtype == float and function not in (np.maximum, np.minimum):
            assert np.isnan(want) or np.signbit(got) == np.signbit(want), values


@pytest.mark.parametrize(
    "function",
    [one for one in (*IN_LOOPS, *BETWEEN_LOOPS) if one.__name__ in DIGITS_OF],
    ids=lambda one: one.__name__,
)
def test_digits_begin_as_numpy_does(function):
    for values in points(function):
        got = function(*(Number(v) if isinstance(v, float) else v for v in values))
        assert float(getattr(got, "value", got)) == pytest.approx(
            float(function(*values)), rel=1e-14
        )
