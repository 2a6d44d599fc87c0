"""Each row of the table of operations: loops to the bit of numpy."""

import itertools
import math

import numpy as np
import pytest

from vibrafeed.core.mechanics.arrays import binade, exponent
from vibrafeed.core.plan.trace import IN_LOOPS

AT_EDGES = [0.0, -0.0, 1.0, -1.5, 3e-300, math.inf, -math.inf, math.nan]


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
