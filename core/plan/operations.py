"""The table of operations: what each reader of an equation makes of a function of numpy.

An equation is written once, for arrays. Three readers run it on something else:
`vibrafeed.core.plan.duals` on numbers with a derivative, `vibrafeed.core.plan.loops` on nodes of a
graph, whose steps become a compiled loop, and `vibrafeed.core.sweep.precise` on numbers of 50
digits. A row of the table is all that they know of one function; where a row has nothing for a
reader, that reader refuses the function.
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
    """A function of numpy as the three readers have it.

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
    digits : callable or None
        The function for numbers of many digits: takes a context of mpmath and the arguments.
    tie : callable or None
        Where the function chooses between equals that a step would decide; takes the arguments and
        their derivatives.
    is_flat : bool
        True if the result is a truth value or a step function, which carries no derivative.
    """

    function: Function
    slope: Function | None = None
    loop: str = ""
    digits: Function | None = None
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


def _same(a: Any, b: Any, da: Any, db: Any) -> Any:
    """True where two arguments are equal but have different slopes."""
    return (a == b) & (da != db)


def _zero(x: Any, dx: Any) -> Any:
    """True where an argument is 0 but has a slope."""
    return (x == 0) & (dx != 0)


def _comparison(function: Function, sign: str, digits: Function) -> Operation:
    """Return the operation of a comparison, which has no derivative and ties between equals.

    `sign` is the operator in a compiled loop, `digits` the comparison of numbers of 50 digits.
    """
    return Operation(function, None, f"{{}} {sign} {{}}", digits, _same, is_flat=True)


def _flat(function: Function, loop: str, digits: Function | None) -> Operation:
    """Return the operation of a piecewise constant function, which has no derivative.

    `loop` is the expression in a compiled loop, `digits` the function for numbers of 50 digits.
    """
    return Operation(function, None, loop, digits, is_flat=True)


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


def _quotient(
    function: Function, rise: Function, digits: str, powers: tuple[float, ...]
) -> Operation:
    """Return the operation of a function over its argument, q(x) = f(x)/x with the limit 1 at 0.

    Its slope is (f'(x) - q)/x, near 0 that of a power series.

    Parameters
    ----------
    function
        The quotient.
    rise
        The derivative f' of the function above the line; takes q and x.
    digits
        The name of f in mpmath; expm1 stands for 1 - exp(-x).
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

    def precise(m: Any, x: Any) -> Any:
        """Return the quotient in numbers of 50 digits."""
        if x == 0:
            return m.one
        return -m.expm1(-x) / x if digits == "expm1" else getattr(m, digits)(x) / x

    return Operation(function, slope, digits=precise)


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
    _quotient(expm1_quotient, lambda q, x: np.exp(-x), "expm1", _alternating(_FACTORIALS[1:12])),
    _quotient(
        log1p_quotient,
        lambda q, x: 1 / (1 + x),
        "log1p",
        _alternating(1 / k for k in range(2, 18)),
    ),
    _quotient(sin_quotient, lambda q, x: cosine(x), "sin", _alternating(_FACTORIALS[2:18:2])),
    _quotient(sinh_quotient, lambda q, x: np.cosh(x), "sinh", tuple(_FACTORIALS[2:18:2])),
    _quotient(tan_quotient, lambda q, x: 1 + np.square(q * x), "tan", _TANGENT),
    _quotient(
        tanh_quotient, lambda q, x: 1 / np.square(np.cosh(x)), "tanh", _alternating(_TANGENT)
    ),
    _quotient(
        arctan_quotient,
        lambda q, x: 1 / (1 + x * x),
        "atan",
        _alternating(1 / k for k in range(3, 35, 2)),
    ),
)

# Columns: function, derivative, compiled loop, 50 digits, ties.
_ROWS = (
    # Arithmetic.
    Operation(np.add, lambda f, a, b, da, db: da + db, "{} + {}", lambda m, x, y: x + y),
    Operation(np.subtract, lambda f, a, b, da, db: da - db, "{} - {}", lambda m, x, y: x - y),
    Operation(
        np.multiply,
        lambda f, a, b, da, db: _times(b, da) + _times(a, db),
        "{} * {}",
        lambda m, x, y: x * y,
    ),
    Operation(
        np.divide,
        lambda f, a, b, da, db: _times(1 / b, da) - _times(f / b, db),
        "{} / {}",
        _divide,
    ),
    Operation(
        np.power,
        lambda f, a, b, da, db: _times(b * np.power(a, b - 1.0), da) + _times(f * np.log(a), db),
        digits=_power,
    ),
    Operation(np.positive, _chain(lambda f, x: 1.0), digits=lambda m, x: x),
    Operation(np.negative, _chain(lambda f, x: -1.0), "-{}", lambda m, x: -x),
    Operation(np.square, _chain(lambda f, x: 2 * x), "{0} * {0}", lambda m, x: x * x),
    Operation(
        np.reciprocal, _chain(lambda f, x: -f * f), "1.0 / {}", lambda m, x: _divide(m, 1, x)
    ),
    Operation(np.sqrt, _chain(lambda f, x: 0.5 / f), "sqrt({})", lambda m, x: m.sqrt(x)),
    Operation(
        np.hypot,
        lambda f, a, b, da, db: _times(a / f, da) + _times(b / f, db),
        digits=lambda m, x, y: m.sqrt(x * x + y * y),
        tie=lambda a, b, da, db: (a == 0) & (b == 0) & (da != -db),
    ),
    Operation(
        np.ldexp, lambda f, a, n, da, dn: np.ldexp(da, n), digits=lambda m, x, n: m.ldexp(x, int(n))
    ),
    # Exponentials and logarithms.
    Operation(np.exp, _chain(lambda f, x: f), digits=lambda m, x: m.exp(x)),
    Operation(np.expm1, _chain(lambda f, x: np.exp(x)), digits=lambda m, x: m.expm1(x)),
    Operation(
        np.log, _chain(lambda f, x: 1 / x), digits=lambda m, x: -m.inf if x == 0 else m.log(x)
    ),
    Operation(
        np.log1p,
        _chain(lambda f, x: 1 / (1 + x)),
        digits=lambda m, x: -m.inf if x == -1 else m.log1p(x),
    ),
    # Parts of a float, for loops alone.
    Operation(binade, loop="binade({})"),
    Operation(exponent, loop="exponent({})"),
    # Whole functions of ours.
    Operation(arc_quotient, _arc_slope, digits=_arc_digits),
    Operation(arc_series, _chain(_arc_rise), digits=lambda m, w: _arc_digits(m, w, m.sqrt(1 - w))),
    Operation(slip_share, _slip_slope, digits=_slip_digits),
    *_QUOTIENTS,
    # Functions of angles, and hyperbolic ones.
    Operation(np.sin, _chain(lambda f, x: cosine(x)), digits=lambda m, x: m.sin(x)),
    Operation(np.cos, _chain(lambda f, x: -sine(x)), digits=lambda m, x: m.cos(x)),
    Operation(np.tan, _chain(lambda f, x: 1 + f * f), digits=lambda m, x: m.tan(x)),
    Operation(
        np.arcsin,
        _chain(lambda f, x: 1 / np.sqrt((1 - x) * (1 + x))),
        digits=lambda m, x: m.asin(x),
    ),
    Operation(
        np.arccos,
        _chain(lambda f, x: -1 / np.sqrt((1 - x) * (1 + x))),
        digits=lambda m, x: m.acos(x),
    ),
    Operation(np.arctan, _chain(lambda f, x: 1 / (1 + x * x)), digits=lambda m, x: m.atan(x)),
    Operation(
        np.arctan2,
        lambda f, y, x, dy, dx: _times(x / (x * x + y * y), dy) - _times(y / (x * x + y * y), dx),
        digits=lambda m, y, x: m.atan2(y, x),
    ),
    Operation(np.sinh, _chain(lambda f, x: np.cosh(x)), digits=lambda m, x: m.sinh(x)),
    Operation(np.cosh, _chain(lambda f, x: np.sinh(x)), digits=lambda m, x: m.cosh(x)),
    Operation(
        np.tanh, _chain(lambda f, x: 1 / np.square(np.cosh(x))), digits=lambda m, x: m.tanh(x)
    ),
    Operation(
        np.arctanh,
        _chain(lambda f, x: 1 / ((1 - x) * (1 + x))),
        digits=lambda m, x: m.sign(x) * m.inf if abs(x) == 1 else m.atanh(x),
    ),
    # Comparisons and truth values.
    _comparison(np.less, "<", lambda m, x, y: x < y),
    _comparison(np.less_equal, "<=", lambda m, x, y: x <= y),
    _comparison(np.greater, ">", lambda m, x, y: x > y),
    _comparison(np.greater_equal, ">=", lambda m, x, y: x >= y),
    _comparison(np.equal, "==", lambda m, x, y: x == y),
    _comparison(np.not_equal, "!=", lambda m, x, y: x != y),
    Operation(np.bitwise_and, loop="{} & {}"),
    Operation(np.bitwise_or, loop="{} | {}"),
    Operation(np.invert, loop="{} ^ True"),
    _flat(np.isnan, "{0} != {0}", lambda m, x: m.isnan(x)),
    _flat(np.isinf, "abs({}) == inf", lambda m, x: m.isinf(x)),
    _flat(np.isfinite, "abs({}) < inf", lambda m, x: m.isfinite(x)),
    # Numbers of 50 digits have one zero, without a sign.
    _flat(np.signbit, "", None),
    _flat(np.rint, "", lambda m, x: m.nint(x) if m.isfinite(x) else x),
    # Choices. As in numpy, what is not a number wins.
    Operation(np.where, lambda f, c, a, b, dc, da, db: np.where(c, da, db), "choose({}, {}, {})"),
    Operation(
        np.maximum,
        lambda f, a, b, da, db: np.where(a >= b, da, db),
        "choose(({0} >= {1}) | ({0} != {0}), {0}, {1})",
        lambda m, x, y: x if x >= y or m.isnan(x) else y,
        _same,
    ),
    Operation(
        np.minimum,
        lambda f, a, b, da, db: np.where(a <= b, da, db),
        "choose(({0} <= {1}) | ({0} != {0}), {0}, {1})",
        lambda m, x, y: x if x <= y or m.isnan(x) else y,
        _same,
    ),
    Operation(np.absolute, _chain(lambda f, x: np.sign(x)), "abs({})", lambda m, x: abs(x), _zero),
    Operation(
        np.sign,
        _chain(lambda f, x: 0.0),
        "choose({0} > 0.0, 1.0, choose({0} < 0.0, -1.0, choose({0} == 0.0, 0.0, {0})))",
        lambda m, x: x if m.isnan(x) else m.sign(x),
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
