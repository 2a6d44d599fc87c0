"""Functions of numpy, and ours, on numbers of 50 digits.

Equations are written for arrays and do not ask what stands in them. Arrays of `Number` run them
with mpmath by the functions of `DIGITS_OF`; where a step would round to a float it fails instead,
so that a result has all its digits or there is none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import mpmath
import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

DIGITS = 50

CONTEXT = mpmath.MPContext()
"""A context of its own: nothing here changes the precision that others work with."""
CONTEXT.dps = DIGITS

CONSTANTS = {
    math.pi: +CONTEXT.pi,
    2 * math.pi: 2 * CONTEXT.pi,
    1 / 3: CONTEXT.mpf(1) / 3,
    2 / 3: CONTEXT.mpf(2) / 3,
}
"""The exact numbers that some floats in equations stand for; other floats, and parameters, are
taken as they are."""


def _divide(m: Any, above: Any, below: Any) -> Any:
    """Return a quotient by the rules of floats: infinite or NaN over 0."""
    if below == 0:
        return m.nan if above == 0 or m.isnan(above) else m.sign(above) * m.inf
    return above / below


def _arc(m: Any, square: Any, root: Any) -> Any:
    """Return artanh(u)/u with u^2 = square, or arctan(u)/u below 0; root is sqrt(1 - square)."""
    if square == 0:
        return m.one
    u = m.sqrt(abs(square))
    if square < 0:
        return m.atan(u) / u
    return (m.log((1 + u) / root) if square > 0.25 else m.atanh(u)) / u


def _slip(m: Any, x: Any, y: Any, s: Any, held: Any) -> Any:
    """Return the positive root z of x^2/(z + s)^2 + y^2/(z + held s)^2 = 1, by Newton's method."""
    z = max(x - s, y - held * s, 1 - held * s, m.zero)
    for _ in range(200):
        a, b = z + s, z + held * s
        excess = (x / a) ** 2 + (y / b) ** 2 - 1
        step = excess / (2 * (x**2 / a**3 + y**2 / b**3))
        z += step
        if not step > z * m.eps * 8:
            break
    return z


DIGITS_OF: dict[str, Callable[..., Any]] = {
    "add": lambda m, x, y: x + y,
    "subtract": lambda m, x, y: x - y,
    "multiply": lambda m, x, y: x * y,
    "divide": _divide,
    "power": lambda m, x, y: m.inf if x == 0 and y < 0 else x**y,
    "positive": lambda m, x: x,
    "negative": lambda m, x: -x,
    "square": lambda m, x: x * x,
    "reciprocal": lambda m, x: _divide(m, 1, x),
    "sqrt": lambda m, x: m.sqrt(x),
    "hypot": lambda m, x, y: m.sqrt(x * x + y * y),
    "ldexp": lambda m, x, n: m.ldexp(x, int(n)),
    "exp": lambda m, x: m.exp(x),
    "expm1": lambda m, x: m.expm1(x),
    "log": lambda m, x: -m.inf if x == 0 else m.log(x),
    "log1p": lambda m, x: -m.inf if x == -1 else m.log1p(x),
    "arc_quotient": _arc,
    "arc_series": lambda m, w: _arc(m, w, m.sqrt(1 - w)),
    "slip_share": _slip,
    "sin": lambda m, x: m.sin(x),
    "cos": lambda m, x: m.cos(x),
    "tan": lambda m, x: m.tan(x),
    "arcsin": lambda m, x: m.asin(x),
    "arccos": lambda m, x: m.acos(x),
    "arctan": lambda m, x: m.atan(x),
    "arctan2": lambda m, y, x: m.atan2(y, x),
    "sinh": lambda m, x: m.sinh(x),
    "cosh": lambda m, x: m.cosh(x),
    "tanh": lambda m, x: m.tanh(x),
    "arctanh": lambda m, x: m.sign(x) * m.inf if abs(x) == 1 else m.atanh(x),
    "less": lambda m, x, y: x < y,
    "less_equal": lambda m, x, y: x <= y,
    "greater": lambda m, x, y: x > y,
    "greater_equal": lambda m, x, y: x >= y,
    "equal": lambda m, x, y: x == y,
    "not_equal": lambda m, x, y: x != y,
    "isnan": lambda m, x: m.isnan(x),
    "isinf": lambda m, x: m.isinf(x),
    "isfinite": lambda m, x: m.isfinite(x),
    "rint": lambda m, x: m.nint(x) if m.isfinite(x) else x,  # one zero, without a sign
    "maximum": lambda m, x, y: x if x >= y or m.isnan(x) else y,
    "minimum": lambda m, x, y: x if x <= y or m.isnan(x) else y,
    "absolute": lambda m, x: abs(x),
    "sign": lambda m, x: x if m.isnan(x) else m.sign(x),
}
"""Functions by their names, numpy's and ours: each takes a context of mpmath and the arguments."""


TRUTHS = ("less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "isnan", "isinf",
          "isfinite")  # fmt: skip


def _mpf(value: Any) -> Any:
    """Return a value as an mpmath number of 50 digits; NaN if it is complex.

    Floats that stand for pi, 2 pi, 1/3 or 2/3 in an equation become these numbers exactly; others
    are taken as they are.
    """
    if isinstance(value, Number):
        return value.value
    if isinstance(value, CONTEXT.mpf | CONTEXT.mpc):
        return value if isinstance(value, CONTEXT.mpf) else CONTEXT.nan
    if isinstance(value, float | np.floating):
        plain = float(value)
        return CONSTANTS.get(plain) or CONTEXT.mpf(plain)
    return CONTEXT.mpf(int(value))


class Number(NDArrayOperatorsMixin):
    """A real number of 50 digits that behaves as a float does: no exceptions, NaN and infinities.

    It has no `__float__`: what would round it by the way fails.
    """

    __slots__ = ("value",)

    def __init__(self, value: Any):
        """Take a value as a number of 50 digits."""
        self.value = value if type(value) is CONTEXT.mpf else _mpf(value)

    def __repr__(self) -> str:
        return f"Number({CONTEXT.nstr(self.value, 20)})"

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **settings: Any) -> Any:
        if method != "__call__" or settings or ufunc.__name__ not in DIGITS_OF:
            raise TypeError(f"numpy.{ufunc.__name__} is not known to {DIGITS} digits")
        return _apply(ufunc, inputs)

    def __bool__(self) -> bool:
        return bool(self.value != 0)

    def __hash__(self) -> int:
        return hash(self.value)


class Precise(np.ndarray[Any, np.dtype[np.object_]]):
    """An array of `Number`; functions of numpy on it give such arrays, or arrays of truth."""

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = None, **settings: Any
    ) -> Any:
        """Apply a numpy function with 50 digits."""
        if method == "__call__" and ufunc.__name__ in DIGITS_OF:
            result = _apply(ufunc, inputs)
            if out is None:
                return result
            np.copyto(np.asarray(out[0]), np.asarray(result))
            return out[0]
        if out is not None:
            settings["out"] = tuple(np.asarray(array) for array in out)
        plain = [_numbers(array) for array in inputs]
        return _labelled(getattr(ufunc, method)(*plain, **settings))

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        """Apply a numpy function that rearranges numbers, such as `np.where`."""
        return _labelled(super().__array_function__(func, types, args, kwargs))


def _apply(function: Any, inputs: Sequence[Any]) -> Any:
    """Return the results of a function of arrays of numbers, element by element."""
    results = _of_elements(function, len(inputs))(*map(np.asarray, inputs))
    return (
        np.asarray(results).astype(np.bool_) if function.__name__ in TRUTHS else _labelled(results)
    )


@cache
def _of_elements(function: Any, count: int) -> Any:
    """Return a numpy function that applies a function with 50 digits to each element of arrays."""
    digits, truth = DIGITS_OF[function.__name__], function.__name__ in TRUTHS

    def apply(*elements: Any) -> Any:
        result = digits(CONTEXT, *[x.value if type(x) is Number else _mpf(x) for x in elements])
        return result if truth else Number(result)

    return np.frompyfunc(apply, count, 1)


def _numbers(values: Any) -> Any:
    """Return an array with floats replaced by numbers of 50 digits; others stay as they are.

    `values` are arguments of an equation that is computed with 50 digits.
    """
    array = np.asarray(values)
    if array.dtype.kind == "b" or array.dtype.kind in "iu":
        return array
    return np.asarray(_AS_NUMBERS(array), dtype=object)


def _as_number(value: Any) -> Any:
    """Return a value as a 50-digit number; truth values unchanged."""
    return value if isinstance(value, Number | bool | np.bool_) else Number(value)


_AS_NUMBERS = np.frompyfunc(_as_number, 1, 1)


def _labelled(result: Any) -> Any:
    """Return object arrays as `Precise` arrays, also inside lists and tuples.

    An object array has mpmath numbers; the type `Precise` tells numpy's functions to compute with
    these. Other results are returned as they are.
    """
    if isinstance(result, np.ndarray):
        return result.view(Precise) if result.dtype == object else result
    if isinstance(result, tuple):
        make = getattr(result, "_make", tuple)
        return make(_labelled(one) for one in result)
    if isinstance(result, list):
        return [_labelled(one) for one in result]
    return result
