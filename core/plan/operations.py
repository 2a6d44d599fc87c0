"""The table of operations: what each reader of an equation makes of a function of numpy.

An equation is written once, for arrays. Two readers run it on something else:
`vibrafeed.core.plan.loops` on nodes of a graph, whose steps become a compiled loop, and
`vibrafeed.core.sweep.precise` on numbers of 50 digits. A row of the table is all that they know of
one function; where a row has nothing for a reader, that reader refuses the function.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.elementwise import (
    LOGARITHMIC,
    arc_quotient,
    arc_series,
    binade,
    exponent,
)
from vibrafeed.core.mechanics.rolling import slip_share

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Operation:
    """A function of numpy as the two readers have it.

    Attributes
    ----------
    function : callable
        The function: one of numpy's elementwise functions or of
        `vibrafeed.core.mechanics.elementwise`, or `numpy.where`.
    loop : str
        The expression in a compiled loop, of the arguments; exact or rounded once, so that its bits
        are numpy's. Empty: numpy computes it between two loops; a loop takes the steps of an
        `Elementwise`.
    digits : callable or None
        The function for numbers of many digits: takes a context of mpmath and the arguments.
    gives_truth : bool
        True if the result is a truth value.
    """

    function: Function
    loop: str = ""
    digits: Function | None = None
    gives_truth: bool = False


def _divide(m: Any, above: Any, below: Any) -> Any:
    """Return a quotient of numbers of 50 digits by the rules of floats: infinite or NaN over 0.

    `m` is the context of mpmath.
    """
    if below == 0:
        return m.nan if above == 0 or m.isnan(above) else m.sign(above) * m.inf
    return above / below


def _power(m: Any, base: Any, exponent: Any) -> Any:
    """Return a power of numbers of 50 digits by the rules of floats: 0 to a negative is infinite.

    `m` is the context of mpmath.
    """
    return m.inf if base == 0 and exponent < 0 else base**exponent


def _arc_digits(m: Any, square: Any, root: Any) -> Any:
    """Return `arc_quotient`, artanh(u)/u or arctan(u)/u, of numbers of 50 digits.

    u^2 is `square`, or minus that below 0, and `root` is sqrt(1 - square); `m` is the context of
    mpmath. It serves to verify the same function of floats.
    """
    if square == 0:
        return m.one
    u = m.sqrt(abs(square))
    if square < 0:
        return m.atan(u) / u
    return (m.log((1 + u) / root) if square > LOGARITHMIC else m.atanh(u)) / u


def _slip_digits(m: Any, x: Any, y: Any, s: Any, held: Any) -> Any:
    """Return the positive root z of x^2/(z + s)^2 + y^2/(z + held s)^2 = 1 in 50 digits.

    It is the function `slip_share` of a slipping cylinder for mpmath numbers, to verify that
    function. `m` is the context of mpmath; x and y are the push along and across the axis, x^2 +
    y^2 = 1, s is friction over the push, and `held` a number of the part's inertia. Newton's method
    climbs from below.
    """
    z = max(x - s, y - held * s, 1 - held * s, m.zero)
    for _ in range(200):
        a, b = z + s, z + held * s
        excess = (x / a) ** 2 + (y / b) ** 2 - 1
        step = excess / (2 * (x**2 / a**3 + y**2 / b**3))
        z += step
        if not step > z * m.eps * 8:
            break
    return z


# Columns: function, compiled loop, 50 digits, whether it gives a truth value.
_ROWS = (
    # Arithmetic.
    Operation(np.add, "{} + {}", lambda m, x, y: x + y),
    Operation(np.subtract, "{} - {}", lambda m, x, y: x - y),
    Operation(np.multiply, "{} * {}", lambda m, x, y: x * y),
    Operation(np.divide, "{} / {}", _divide),
    Operation(np.power, digits=_power),
    Operation(np.positive, digits=lambda m, x: x),
    Operation(np.negative, "-{}", lambda m, x: -x),
    Operation(np.square, "{0} * {0}", lambda m, x: x * x),
    Operation(np.reciprocal, "1.0 / {}", lambda m, x: _divide(m, 1, x)),
    Operation(np.sqrt, "sqrt({})", lambda m, x: m.sqrt(x)),
    Operation(np.hypot, digits=lambda m, x, y: m.sqrt(x * x + y * y)),
    Operation(np.ldexp, digits=lambda m, x, n: m.ldexp(x, int(n))),
    # Exponentials and logarithms.
    Operation(np.exp, digits=lambda m, x: m.exp(x)),
    Operation(np.expm1, digits=lambda m, x: m.expm1(x)),
    Operation(np.log, digits=lambda m, x: -m.inf if x == 0 else m.log(x)),
    Operation(np.log1p, digits=lambda m, x: -m.inf if x == -1 else m.log1p(x)),
    # Parts of a float, for loops alone.
    Operation(binade, "binade({})"),
    Operation(exponent, "exponent({})"),
    # Whole functions of ours.
    Operation(arc_quotient, digits=_arc_digits),
    Operation(arc_series, digits=lambda m, w: _arc_digits(m, w, m.sqrt(1 - w))),
    Operation(slip_share, digits=_slip_digits),
    # Functions of angles, and hyperbolic ones.
    Operation(np.sin, digits=lambda m, x: m.sin(x)),
    Operation(np.cos, digits=lambda m, x: m.cos(x)),
    Operation(np.tan, digits=lambda m, x: m.tan(x)),
    Operation(np.arcsin, digits=lambda m, x: m.asin(x)),
    Operation(np.arccos, digits=lambda m, x: m.acos(x)),
    Operation(np.arctan, digits=lambda m, x: m.atan(x)),
    Operation(np.arctan2, digits=lambda m, y, x: m.atan2(y, x)),
    Operation(np.sinh, digits=lambda m, x: m.sinh(x)),
    Operation(np.cosh, digits=lambda m, x: m.cosh(x)),
    Operation(np.tanh, digits=lambda m, x: m.tanh(x)),
    Operation(np.arctanh, digits=lambda m, x: m.sign(x) * m.inf if abs(x) == 1 else m.atanh(x)),
    # Comparisons and truth values.
    Operation(np.less, "{} < {}", lambda m, x, y: x < y, True),
    Operation(np.less_equal, "{} <= {}", lambda m, x, y: x <= y, True),
    Operation(np.greater, "{} > {}", lambda m, x, y: x > y, True),
    Operation(np.greater_equal, "{} >= {}", lambda m, x, y: x >= y, True),
    Operation(np.equal, "{} == {}", lambda m, x, y: x == y, True),
    Operation(np.not_equal, "{} != {}", lambda m, x, y: x != y, True),
    Operation(np.bitwise_and, "{} & {}"),
    Operation(np.bitwise_or, "{} | {}"),
    Operation(np.invert, "{} ^ True"),
    Operation(np.isnan, "{0} != {0}", lambda m, x: m.isnan(x), True),
    Operation(np.isinf, "abs({}) == inf", lambda m, x: m.isinf(x), True),
    Operation(np.isfinite, "abs({}) < inf", lambda m, x: m.isfinite(x), True),
    Operation(np.rint, digits=lambda m, x: m.nint(x) if m.isfinite(x) else x),
    # Choices. As in numpy, what is not a number wins.
    Operation(np.where, "choose({}, {}, {})"),
    Operation(
        np.maximum,
        "choose(({0} >= {1}) | ({0} != {0}), {0}, {1})",
        lambda m, x, y: x if x >= y or m.isnan(x) else y,
    ),
    Operation(
        np.minimum,
        "choose(({0} <= {1}) | ({0} != {0}), {0}, {1})",
        lambda m, x, y: x if x <= y or m.isnan(x) else y,
    ),
    Operation(np.absolute, "abs({})", lambda m, x: abs(x)),
    Operation(
        np.sign,
        "choose({0} > 0.0, 1.0, choose({0} < 0.0, -1.0, choose({0} == 0.0, 0.0, {0})))",
        lambda m, x: x if m.isnan(x) else m.sign(x),
    ),
    Operation(np.copysign, "copysign({}, {})"),
)

OPERATIONS: dict[Function, Operation] = {row.function: row for row in _ROWS}
"""The rows, by their function."""

IN_LOOPS: dict[Function, str] = {row.function: row.loop for row in _ROWS if row.loop}
"""The functions that a compiled loop takes in, with their expressions."""
