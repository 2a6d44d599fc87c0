"""The table of operations: what each reader of an equation makes of a function of numpy.

An equation is written once, for arrays. Two readers run it on something else:
`vibrafeed.core.plan.duals` on numbers with a derivative, and `vibrafeed.core.plan.loops` on nodes
of a graph, whose steps become a compiled loop. A row of the table is all that they know of one
function; where a row has nothing for a reader, that reader refuses the function.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.angles import cosine, sine
from vibrafeed.core.mechanics.elementwise import (
    LOGARITHMIC,
    arc_quotient,
    arc_series,
    arctan_quotient,
    binade,
    expm1_quotient,
    exponent,
    log1p_quotient,
    sin_quotient,
    sinh_quotient,
    tan_quotient,
    tanh_quotient,
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
    slope : callable or None
        Derivative of the result: takes the result, the arguments and their derivatives.
    loop : str
        The expression in a compiled loop, of the arguments; exact or rounded once, so that its bits
        are numpy's. Empty: numpy computes it between two loops; a loop takes the steps of an
        `Elementwise`.
    tie : callable or None
        Where the function chooses between equals that a step would decide; takes the arguments and
        their derivatives.
    is_flat : bool
        True if the result is a truth value or a step function, which carries no derivative.
    """

    function: Function
    slope: Function | None = None
    loop: str = ""
    tie: Function | None = None
    is_flat: bool = False

    @property
    def gives_truth(self) -> bool:
        """True if the result is a truth value."""
        return self.is_flat and str(self.function.types[0]).endswith("?")  # type: ignore[attr-defined]


def _times(factor: Any, slope: Any) -> Any:
    """Return a product that is 0 where the slope is 0, even for an infinite factor.

    So the slope of a branch not taken does not become NaN.
    """
    return np.where(slope == 0, 0.0, factor * slope)


def _chain(factor: Callable[[Any, Any], Any]) -> Function:
    """Return the rule for the slope of a one-argument function f(x), factor(f, x) dx.

    `factor` gives df/dx from the value f and the argument x.
    """
    return lambda f, x, dx: _times(factor(f, x), dx)


def _same(a: Any, b: Any, da: Any, db: Any) -> Any:
    """True where two arguments are equal but have different slopes."""
    return (a == b) & (da != db)


def _zero(x: Any, dx: Any) -> Any:
    """True where an argument is 0 but has a slope."""
    return (x == 0) & (dx != 0)


def _comparison(function: Function, sign: str) -> Operation:
    """Return the operation of a comparison, which has no derivative and ties between equals.

    `sign` is the operator in a compiled loop.
    """
    return Operation(function, None, f"{{}} {sign} {{}}", _same, is_flat=True)


def _flat(function: Function, loop: str) -> Operation:
    """Return the operation of a piecewise constant function, which has no derivative.

    `loop` is the expression in a compiled loop.
    """
    return Operation(function, None, loop, is_flat=True)


def _arc_slope(f: Any, square: Any, root: Any, dsquare: Any, droot: Any) -> Any:
    """Return the derivative of `arc_quotient`, by the chain rule, for functions of dual numbers.

    `arc_quotient` is f = artanh(u)/u, where u^2 is the square and its root is sqrt(1 - u^2); for a
    negative square f = arctan(u)/u with u^2 = -square.

    Parameters
    ----------
    f, square, root : ndarray
        Its value and its two arguments.
    dsquare, droot : ndarray
        The derivatives of the arguments. Where the square is near 1 it has lost digits, and the
        root is used.
    """
    apart = np.where(square > LOGARITHMIC, square, 1.0)
    u = np.sqrt(apart)
    by_root = (_times(1 / (2 * u * (1 + u)), dsquare) - _times(1 / root, droot)) / u
    by_root = by_root - _times(f / (2 * apart), dsquare)
    return np.where(square > LOGARITHMIC, by_root, _times(_arc_rise(f, square), dsquare))


def _arc_rise(f: Any, square: Any) -> Any:
    """Return the derivative of f, `arc_quotient`, by its square below 1; near 0 by a series."""
    small = np.abs(square) < 0.02
    by_series = sum(k * square ** (k - 1) / (2 * k + 1) for k in range(1, 11))
    apart = np.where(small, 1.0, square)
    return np.where(small, by_series, (1 / (1 - square) - f) / (2 * apart))


def _slip_slope(
    z: Any, x: Any, y: Any, s: Any, held: Any, dx: Any, dy: Any, ds: Any, dheld: Any
) -> Any:
    """Return the derivative of `slip_share` by the chain rule, for functions of dual numbers.

    `slip_share` is the root z of x^2/(z + s)^2 + y^2/(z + held s)^2 = 1, which says how a cylinder
    slips; the derivative follows from this equation. x, y, s and held are its arguments, arrays,
    and dx to dheld their derivatives.
    """
    a, b = z + s, z + held * s
    by_a, by_b = np.square(x / a) / a, np.square(y / b) / b
    moved = _times(x / (a * a), dx) + _times(y / (b * b), dy)
    moved = moved - _times(by_a, ds) - _times(by_b, held * ds + s * dheld)
    return moved / (by_a + by_b)


def _quotient(function: Function, rise: Function, powers: tuple[float, ...]) -> Operation:
    """Return the operation of a function over its argument, q(x) = f(x)/x with the limit 1 at 0.

    Its slope is (f'(x) - q)/x, near 0 that of a power series.

    Parameters
    ----------
    function
        The quotient.
    rise
        The derivative f' of the function above the line; takes q and x.
    powers
        Coefficients of the series of q, from that of x on; of x^2 and its powers if q is even.
    """
    is_even = function not in (expm1_quotient, log1p_quotient)
    step = 2 if is_even else 1
    near = NEAR_EVEN if is_even else NEAR
    coefficients = [step * (k + 1) * c for k, c in enumerate(powers)]

    def slope(q: Any, x: Any, dx: Any) -> Any:
        """Return the slope of the quotient."""
        is_near = np.abs(x) < near
        apart = np.where(is_near, 1.0, x)
        series = np.polynomial.polynomial.polyval(np.where(is_near, x, 0.0) ** step, coefficients)
        series = series * x ** (step - 1)
        return _times(np.where(is_near, series, (rise(q, x) - q) / apart), dx)

    return Operation(function, slope)


NEAR, NEAR_EVEN = 0.1, 0.3
"""Arguments below which the slope of a quotient f(x)/x goes by its series; of even quotients."""

_FACTORIALS = [1.0 / math.factorial(k) for k in range(1, 24)]
_TANGENT = (
    1 / 3, 2 / 15, 17 / 315, 62 / 2835, 1382 / 155_925, 21_844 / 6_081_075,
    929_569 / 638_512_875, 6_404_582 / 10_854_718_875, 443_861_162 / 1_856_156_927_625,
    18_888_466_084 / 194_896_477_400_625,
)  # fmt: skip


def _alternating(powers: Iterable[float]) -> tuple[float, ...]:
    """Return coefficients with signs that alternate, the first negative."""
    return tuple(-c if k % 2 == 0 else c for k, c in enumerate(powers))


_QUOTIENTS = (
    _quotient(expm1_quotient, lambda q, x: np.exp(-x), _alternating(_FACTORIALS[1:12])),
    _quotient(
        log1p_quotient,
        lambda q, x: 1 / (1 + x),
        _alternating(1 / k for k in range(2, 18)),
    ),
    _quotient(sin_quotient, lambda q, x: cosine(x), _alternating(_FACTORIALS[2:18:2])),
    _quotient(sinh_quotient, lambda q, x: np.cosh(x), tuple(_FACTORIALS[2:18:2])),
    _quotient(tan_quotient, lambda q, x: 1 + np.square(q * x), _TANGENT),
    _quotient(tanh_quotient, lambda q, x: 1 / np.square(np.cosh(x)), _alternating(_TANGENT)),
    _quotient(
        arctan_quotient,
        lambda q, x: 1 / (1 + x * x),
        _alternating(1 / k for k in range(3, 35, 2)),
    ),
)

# Columns: function, derivative, compiled loop, ties.
_ROWS = (
    # Arithmetic.
    Operation(np.add, lambda f, a, b, da, db: da + db, "{} + {}"),
    Operation(np.subtract, lambda f, a, b, da, db: da - db, "{} - {}"),
    Operation(
        np.multiply,
        lambda f, a, b, da, db: _times(b, da) + _times(a, db),
        "{} * {}",
    ),
    Operation(
        np.divide,
        lambda f, a, b, da, db: _times(1 / b, da) - _times(f / b, db),
        "{} / {}",
    ),
    Operation(
        np.power,
        lambda f, a, b, da, db: _times(b * np.power(a, b - 1.0), da) + _times(f * np.log(a), db),
    ),
    Operation(np.positive, _chain(lambda f, x: 1.0)),
    Operation(np.negative, _chain(lambda f, x: -1.0), "-{}"),
    Operation(np.square, _chain(lambda f, x: 2 * x), "{0} * {0}"),
    Operation(np.reciprocal, _chain(lambda f, x: -f * f), "1.0 / {}"),
    Operation(np.sqrt, _chain(lambda f, x: 0.5 / f), "sqrt({})"),
    Operation(
        np.hypot,
        lambda f, a, b, da, db: _times(a / f, da) + _times(b / f, db),
        tie=lambda a, b, da, db: (a == 0) & (b == 0) & (da != -db),
    ),
    Operation(np.ldexp, lambda f, a, n, da, dn: np.ldexp(da, n)),
    # Exponentials and logarithms.
    Operation(np.exp, _chain(lambda f, x: f)),
    Operation(np.expm1, _chain(lambda f, x: np.exp(x))),
    Operation(np.log, _chain(lambda f, x: 1 / x)),
    Operation(
        np.log1p,
        _chain(lambda f, x: 1 / (1 + x)),
    ),
    # Parts of a float, for loops alone.
    Operation(binade, loop="binade({})"),
    Operation(exponent, loop="exponent({})"),
    # Whole functions of ours.
    Operation(arc_quotient, _arc_slope),
    Operation(arc_series, _chain(_arc_rise)),
    Operation(slip_share, _slip_slope),
    *_QUOTIENTS,
    # Functions of angles, and hyperbolic ones.
    Operation(np.sin, _chain(lambda f, x: cosine(x))),
    Operation(np.cos, _chain(lambda f, x: -sine(x))),
    Operation(np.tan, _chain(lambda f, x: 1 + f * f)),
    Operation(
        np.arcsin,
        _chain(lambda f, x: 1 / np.sqrt((1 - x) * (1 + x))),
    ),
    Operation(
        np.arccos,
        _chain(lambda f, x: -1 / np.sqrt((1 - x) * (1 + x))),
    ),
    Operation(np.arctan, _chain(lambda f, x: 1 / (1 + x * x))),
    Operation(
        np.arctan2,
        lambda f, y, x, dy, dx: _times(x / (x * x + y * y), dy) - _times(y / (x * x + y * y), dx),
    ),
    Operation(np.sinh, _chain(lambda f, x: np.cosh(x))),
    Operation(np.cosh, _chain(lambda f, x: np.sinh(x))),
    Operation(np.tanh, _chain(lambda f, x: 1 / np.square(np.cosh(x)))),
    Operation(
        np.arctanh,
        _chain(lambda f, x: 1 / ((1 - x) * (1 + x))),
    ),
    # Comparisons and truth values.
    _comparison(np.less, "<"),
    _comparison(np.less_equal, "<="),
    _comparison(np.greater, ">"),
    _comparison(np.greater_equal, ">="),
    _comparison(np.equal, "=="),
    _comparison(np.not_equal, "!="),
    Operation(np.bitwise_and, loop="{} & {}"),
    Operation(np.bitwise_or, loop="{} | {}"),
    Operation(np.invert, loop="{} ^ True"),
    _flat(np.isnan, "{0} != {0}"),
    _flat(np.isinf, "abs({}) == inf"),
    _flat(np.isfinite, "abs({}) < inf"),
    _flat(np.signbit, ""),
    _flat(np.rint, ""),
    # Choices. As in numpy, what is not a number wins.
    Operation(np.where, lambda f, c, a, b, dc, da, db: np.where(c, da, db), "choose({}, {}, {})"),
    Operation(
        np.maximum,
        lambda f, a, b, da, db: np.where(a >= b, da, db),
        "choose(({0} >= {1}) | ({0} != {0}), {0}, {1})",
        _same,
    ),
    Operation(
        np.minimum,
        lambda f, a, b, da, db: np.where(a <= b, da, db),
        "choose(({0} <= {1}) | ({0} != {0}), {0}, {1})",
        _same,
    ),
    Operation(np.absolute, _chain(lambda f, x: np.sign(x)), "abs({})", _zero),
    Operation(
        np.sign,
        _chain(lambda f, x: 0.0),
        "choose({0} > 0.0, 1.0, choose({0} < 0.0, -1.0, choose({0} == 0.0, 0.0, {0})))",
        _zero,
    ),
    Operation(
        np.copysign,
        lambda f, a, b, da, db: _times(np.sign(a) * np.copysign(1.0, b), da),
        "copysign({}, {})",
        tie=lambda a, b, da, db: (b == 0) & (db != 0),
    ),
)

OPERATIONS: dict[Function, Operation] = {row.function: row for row in _ROWS}
"""The rows, by their function."""

IN_LOOPS: dict[Function, str] = {row.function: row.loop for row in _ROWS if row.loop}
"""The functions that a compiled loop takes in, with their expressions."""
