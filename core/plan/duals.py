"""Numbers with their derivative: numpy's functions carry both along, exactly but for rounding.

A function of arrays that is given a `Dual` for one of its arguments returns its value and the
derivative by that argument (forward differentiation). No formula has to be written twice, and no
step has to be chosen.

At a switch the derivative may not exist: |x| at 0, the larger of two equal numbers, x == 0 where
a quotient takes its limit. Where a comparison of a `Dual` comes out even, and would not stay so, is
noted in its list `ties`; whoever asked has to look from both sides.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from core.mechanics.angles import cosine, sine
from core.mechanics.arrays import Array


class NotDifferentiableError(TypeError):
    """A function of numpy met a `Dual` and has no rule for its derivative."""


class Dual(NDArrayOperatorsMixin):
    """An array and its derivative by one number.

    Attributes
    ----------
    value, slope : ndarray
        Value and derivative, of one shape.
    ties : list of ndarray of bool
        Where functions had to choose between equals; shared by all that comes of it.
    """

    def __init__(self, value: Any, slope: Any, ties: list[Any]):
        self.value: Array
        self.slope: Array
        self.value, self.slope = np.broadcast_arrays(
            np.asarray(value, dtype=np.float64), np.asarray(slope, dtype=np.float64)
        )
        self.ties = ties

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the value."""
        return self.value.shape

    @property
    def ndim(self) -> int:
        """Number of dimensions of the value."""
        return self.value.ndim

    def __getitem__(self, key: Any) -> Dual:
        return Dual(self.value[key], self.slope[key], self.ties)

    def __repr__(self) -> str:
        return f"Dual({self.value!r}, {self.slope!r})"

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        # `np.asarray` would drop the slope; in a box it goes on, to be unpacked by the next rule.
        if dtype is not None:
            raise NotDifferentiableError(f"an array of {dtype} has no place for a derivative")
        box = np.empty(1, dtype=object)
        box[0] = self
        return box.reshape(())

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        name = ufunc.__name__
        out = kwargs.pop("out", ())
        if method != "__call__" or kwargs or any(not isinstance(o, Dual) for o in out):
            raise NotDifferentiableError(f"numpy.{name}: no rule for this call")
        arguments = [unboxed(x) for x in inputs]
        values = [value_of(x) for x in arguments]
        if name in VALUE_ONLY:
            return ufunc(*values)
        if name in COMPARISONS:
            a, b = arguments
            self._note(values[0] == values[1], a, b)
            return ufunc(*values)
        slopes = [slope_of(x) for x in arguments]
        if name in SWITCHES:
            even = values[0] == (values[1] if len(values) > 1 else 0)
            self._note(even, arguments[0], arguments[1] if len(values) > 1 else 0.0)
        if name == "copysign":
            self._note(values[1] == 0, 0.0, arguments[1])
        if name == "hypot":
            self._note((values[0] == 0) & (values[1] == 0), arguments[0], -arguments[1])
        if name == "frexp":
            mantissa, exponent = ufunc(values[0])
            return Dual(mantissa, np.ldexp(slopes[0], -exponent), self.ties), exponent
        rule = RULES.get(name)
        if rule is None:
            raise NotDifferentiableError(f"numpy.{name} has no rule for its derivative")
        value = ufunc(*values)
        with np.errstate(all="ignore"):
            slope = rule(value, *values, *slopes)
        return Dual(value, slope, self.ties)

    def __array_function__(
        self, function: Callable[..., Any], types: Any, args: Any, kwargs: Any
    ) -> Any:
        name = function.__name__
        if name in SHAPES_ONLY:
            return function(*_mapped(value_of, args), **kwargs)
        if name == "clip":
            return np.minimum(np.maximum(args[0], args[1]), args[2])
        args = _mapped(unboxed, args)
        values, slopes = _mapped(value_of, args), _mapped(slope_of, args)
        if name == "where":
            condition = values[0]
            return Dual(
                np.where(condition, *values[1:]), np.where(condition, *slopes[1:]), self.ties
            )
        if name == "broadcast_arrays":
            whole = np.broadcast_shapes(*(np.shape(x) for x in values))
            return tuple(
                Dual(np.broadcast_to(v, whole), np.broadcast_to(d, whole), self.ties)
                if isinstance(x, Dual)
                else np.broadcast_to(v, whole)
                for x, v, d in zip(args, values, slopes, strict=True)
            )
        if name in LINEAR:
            value, slope = function(*values, **kwargs), function(*_slopes(args), **kwargs)
            return Dual(value, slope, self.ties)
        if name == "cross":
            slopes = _slopes(args)
            slope = function(slopes[0], values[1], **kwargs)
            slope = slope + function(values[0], slopes[1], **kwargs)
            return Dual(function(*values, **kwargs), slope, self.ties)
        if name in ("max", "amax"):
            place = np.argmax(values[0], axis=kwargs["axis"], keepdims=True)
            value, slope = (
                np.take_along_axis(part[0], place, axis=kwargs["axis"]).squeeze(kwargs["axis"])
                for part in (values, slopes)
            )
            return Dual(value, slope, self.ties)
        raise NotDifferentiableError(f"numpy.{name} has no rule for its derivative")

    def _note(self, even: Any, a: Any, b: Any) -> None:
        """Note a choice between equals that a step would decide."""
        where = even & (slope_of(a) != slope_of(b))
        if np.any(where):
            self.ties.append(np.asarray(where))


def unboxed(x: Any) -> Any:
    """Return what `np.asarray` made of a `Dual` as that `Dual`, anything else as it is."""
    if isinstance(x, np.ndarray) and x.dtype == object and x.ndim == 0:
        return x.item()
    return x


def value_of(x: Any) -> Any:
    """Return the value of a `Dual`, anything else as it is."""
    return x.value if isinstance(x, Dual) else x


def slope_of(x: Any) -> Any:
    """Return the derivative of a `Dual`, 0 of anything else."""
    return x.slope if isinstance(x, Dual) else 0.0


def _mapped(of: Callable[[Any], Any], args: Any) -> Any:
    """Return arguments with a function applied to each and to those in lists and tuples."""
    if isinstance(args, list | tuple):
        return tuple(_mapped(of, x) for x in args)
    return of(args)


def _slopes(args: Any) -> Any:
    """Return arguments with arrays replaced by derivatives of their own shape."""
    if isinstance(args, list | tuple):
        return tuple(_slopes(x) for x in args)
    if isinstance(args, Dual):
        return args.slope
    return np.zeros_like(args, dtype=np.float64) if isinstance(args, np.ndarray | float) else args


def _times(factor: Any, slope: Any) -> Any:
    """Return the product, 0 where nothing changes, however steep the factor."""
    return np.where(slope == 0, 0.0, factor * slope)


def _chain(factor: Callable[[Any, Any], Any]) -> Callable[..., Any]:
    """Return the rule of a function of one argument, from its derivative by value and argument."""
    return lambda f, x, dx: _times(factor(f, x), dx)


def _power(f: Any, a: Any, b: Any, da: Any, db: Any) -> Any:
    return _times(b * np.power(a, b - 1.0), da) + _times(f * np.log(a), db)


COMPARISONS = {"less", "less_equal", "greater", "greater_equal", "equal", "not_equal"}
SWITCHES = {"absolute", "sign", "maximum", "minimum"}
VALUE_ONLY = {"isfinite", "isnan", "isinf", "signbit", "rint"}
SHAPES_ONLY = {"shape", "ndim", "size", "zeros_like", "ones_like", "full_like", "empty_like"}
LINEAR = {"stack", "broadcast_to", "concatenate", "sum", "squeeze", "reshape"}

RULES: dict[str, Callable[..., Any]] = {
    "positive": _chain(lambda f, x: 1.0),
    "negative": _chain(lambda f, x: -1.0),
    "absolute": _chain(lambda f, x: np.sign(x)),
    "sign": _chain(lambda f, x: 0.0),
    "square": _chain(lambda f, x: 2 * x),
    "sqrt": _chain(lambda f, x: 0.5 / f),
    "reciprocal": _chain(lambda f, x: -f * f),
    "exp": _chain(lambda f, x: f),
    "expm1": _chain(lambda f, x: np.exp(x)),
    "log": _chain(lambda f, x: 1 / x),
    "log1p": _chain(lambda f, x: 1 / (1 + x)),
    "sin": _chain(lambda f, x: cosine(x)),
    "cos": _chain(lambda f, x: -sine(x)),
    "tan": _chain(lambda f, x: 1 + f * f),
    "arcsin": _chain(lambda f, x: 1 / np.sqrt((1 - x) * (1 + x))),
    "arccos": _chain(lambda f, x: -1 / np.sqrt((1 - x) * (1 + x))),
    "arctan": _chain(lambda f, x: 1 / (1 + x * x)),
    "sinh": _chain(lambda f, x: np.cosh(x)),
    "cosh": _chain(lambda f, x: np.sinh(x)),
    "tanh": _chain(lambda f, x: 1 / np.square(np.cosh(x))),
    "arctanh": _chain(lambda f, x: 1 / ((1 - x) * (1 + x))),
    "add": lambda f, a, b, da, db: da + db,
    "subtract": lambda f, a, b, da, db: da - db,
    "multiply": lambda f, a, b, da, db: _times(b, da) + _times(a, db),
    "divide": lambda f, a, b, da, db: _times(1 / b, da) - _times(f / b, db),
    "power": _power,
    "hypot": lambda f, a, b, da, db: _times(a / f, da) + _times(b / f, db),
    "arctan2": lambda f, y, x, dy, dx: (
        _times(x / (x * x + y * y), dy) - _times(y / (x * x + y * y), dx)
    ),
    "maximum": lambda f, a, b, da, db: np.where(a >= b, da, db),
    "minimum": lambda f, a, b, da, db: np.where(a <= b, da, db),
    "copysign": lambda f, a, b, da, db: _times(np.sign(a) * np.copysign(1.0, b), da),
    "ldexp": lambda f, a, n, da, dn: np.ldexp(da, n),
}
"""Derivatives: of value, arguments and their slopes, in the order of the arguments."""
