"""Each row of the table of operations: loops to the bit of numpy, digits by numbers."""

from __future__ import annotations

import ast
import math
from pathlib import Path

import numpy as np
import pytest

import vibrafeed.core.plan
from precise import DIGITS_OF, Number, Precise
from vibrafeed.core.mechanics.arrays import (
    arc_quotient,
    arc_series,
    binade,
    exponent,
)
from vibrafeed.core.mechanics.rolling import slip_share
from vibrafeed.core.plan.trace import IN_LOOPS
from vibrafeed.core.quantities import QUANTITIES

ROOT = Path(vibrafeed.core.plan.__file__).parent
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


def name(function):
    return function.__name__


def points(function):
    return OWN_POINTS.get(function) or POINTS[function.nin]


def choose(condition, one, other):
    return one if condition else other


def divided(expression, values):
    """Return what a loop gives, with the quotients of a processor in place of Python's errors."""
    words = {"sqrt": np.sqrt, "abs": abs, "copysign": math.copysign, "inf": math.inf}
    words |= {"binade": binade, "exponent": exponent}
    kinds = [v if isinstance(v, bool) else np.float64(v) for v in values]
    with np.errstate(all="ignore"):
        return eval(
            expression.format(*(f"v[{k}]" for k in range(3))),
            words | {"v": kinds, "choose": choose},
        )


@pytest.mark.parametrize("function", [one for one in IN_LOOPS if one is not np.where], ids=name)
def test_a_loop_has_the_bits_of_numpy(function):
    is_logical = function in (np.bitwise_and, np.bitwise_or, np.invert)
    edges = [False, True] if is_logical else AT_EDGES
    pairs = [(x, y) for x in edges for y in edges] if function.nin == 2 else [(x,) for x in edges]
    for values in pairs:
        with np.errstate(all="ignore"):
            want = function(*values)
        got = divided(IN_LOOPS[function], values)
        if isinstance(want, bool | np.bool_):
            assert bool(got) == bool(want), values
        elif np.isnan(want):
            assert np.isnan(got), values
        elif function in (np.maximum, np.minimum):  # which of two zeros, numpy does not say
            assert got == want, values
        else:
            assert np.float64(got).tobytes() == np.float64(want).tobytes(), values


@pytest.mark.parametrize(
    "function",
    [one for one in (*IN_LOOPS, *BETWEEN_LOOPS) if name(one) in DIGITS_OF],
    ids=name,
)
def test_digits_begin_as_numpy_does(function):
    for values in points(function):
        got = function(*(Number(v) if isinstance(v, float) else v for v in values))
        want = function(*values)
        if isinstance(want, np.bool_):
            assert bool(got) == bool(want)
        else:
            assert float(got.value) == pytest.approx(float(want), rel=1e-14)


def test_numbers_and_arrays_of_them_meet_the_same_rows():
    array = np.array([Number(0.25), Number(4.0)], dtype=object).view(Precise)
    assert [float(x.value) for x in np.sqrt(array) * 2.0 + Number(1)] == [2.0, 5.0]
    assert (array > Number(1)).tolist() == [False, True]
    array *= Number(2)
    assert [float(x.value) for x in array] == [0.5, 8.0]
    with pytest.raises(TypeError, match="spacing is not known to 50 digits"):
        np.spacing(Number(1))


def test_the_plan_knows_no_parameter_by_name():
    """What is said of single parameters and outputs stands in the tables of scenes."""
    parameters = {name for name, quantity in QUANTITIES.items() if quantity.parameter}
    named = {
        (path.name, node.value)
        for path in ROOT.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and node.value in parameters
    }
    assert not named
