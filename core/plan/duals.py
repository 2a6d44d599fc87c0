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

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.operations import OPERATIONS


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
        """Broadcast value and derivative to one shape; `ties` collects switches that are met."""
        self.value: Array
        self.slope: Array
        self.value, self.slope = np.broadcast_arrays(
            np.asarray(value, dtype=np.float64), np.asarray(slope, dtype=np.float64)
        )
        self.ties = ties

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the value."""
        return self.value.shape

    @property
    def ndim(self) -> int:
        """The number of dimensions of the value."""
        return self.value.ndim

    def __getitem__(self, key: Any) -> Dual:
        return Dual(self.value[key], self.slope[key], self.ties)

    def __repr__(self) -> str:
        return f"Dual({self.value!r}, {self.slope!r})"

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        # `np.asarray` would drop the slope; in a box it goes on, to be unpacked by the next rule.
        if dtype is not None:
            raise NotDifferentiableError(f"an array of the type {dtype} cannot hold derivatives")
        box = np.empty(1, dtype=object)
        box[0] = self
        return box.reshape(())

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        name = ufunc.__name__
        out = kwargs.pop("out", ())
        if method != "__call__" or kwargs or any(not isinstance(o, Dual) for o in out):
            raise NotDifferentiableError(f"numpy.{name}: no rule for this call")
        arguments = [unbox(x) for x in inputs]
        values = [value_of(x) for x in arguments]
        slopes = [slope_of(x) for x in arguments]
        if ufunc is np.frexp:
            mantissa, exponent = ufunc(values[0])
            return Dual(mantissa, np.ldexp(slopes[0], -exponent), self.ties), exponent
        operation = OPERATIONS.get(ufunc)
        if operation is None or not (operation.is_flat or operation.slope):
            raise NotDifferentiableError(f"numpy.{name} has no rule for its derivative")
        if operation.tie is not None and np.any(even := operation.tie(*values, *slopes)):
            self.ties.append(np.asarray(even))
        value = ufunc(*values)
        if operation.slope is None:
            return value
        with np.errstate(all="ignore"):
            slope = operation.slope(value, *values, *slopes)
        return Dual(value, slope, self.ties)

    def __array_function__(
        self, function: Callable[..., Any], types: Any, args: Any, kwargs: Any
    ) -> Any:
        name = function.__name__
        if name in SHAPES_ONLY:
            return function(*_map_arguments(value_of, args), **kwargs)
        rule = ARRAY_RULES.get(name)
        if rule is None:
            raise NotDifferentiableError(f"numpy.{name} has no rule for its derivative")
        return rule(self.ties, function, _map_arguments(unbox, args), kwargs)


def unbox(x: Any) -> Any:
    """Return the `Dual` inside an array made by `np.asarray`; return other arguments unchanged."""
    if isinstance(x, np.ndarray) and x.dtype == object and x.ndim == 0:
        return x.item()
    return x


def value_of(x: Any) -> Any:
    """Return the value of a `Dual`; anything else unchanged."""
    return x.value if isinstance(x, Dual) else x


def slope_of(x: Any) -> Any:
    """Return the derivative of a `Dual`; 0 for anything else."""
    return x.slope if isinstance(x, Dual) else 0.0


def _map_arguments(of: Callable[[Any], Any], args: Any) -> Any:
    """Return arguments with a function applied to each, also inside lists and tuples."""
    if isinstance(args, list | tuple):
        return tuple(_map_arguments(of, x) for x in args)
    return of(args)


def _slopes(args: Any) -> Any:
    """Return the derivatives of the arguments of a numpy function, in the shapes of their values.

    An argument may be a dual number (an array with its derivative), an array or a float, whose
    derivative is 0, or a list of these. Other arguments, such as axes, are returned as they are.
    """
    if isinstance(args, list | tuple):
        return tuple(_slopes(x) for x in args)
    if isinstance(args, Dual):
        return args.slope
    return np.zeros_like(args, dtype=np.float64) if isinstance(args, np.ndarray | float) else args


def _clip(ties: list[Any], function: Any, args: Any, kwargs: Any) -> Any:
    """Return clipped dual numbers, by minimum and maximum."""
    return np.minimum(np.maximum(args[0], args[1]), args[2])


def _where(ties: list[Any], function: Any, args: Any, kwargs: Any) -> Any:
    """Return values and derivatives chosen by a condition: the rule for `np.where`.

    `args` are the condition and the two choices, arrays or dual numbers (arrays with a derivative).
    `ties` is the list in which switches without a derivative are noted. `function` and `kwargs` are
    not used: all rules are called alike.
    """
    condition, *values = _map_arguments(value_of, args)
    return Dual(
        np.where(condition, *values), np.where(condition, *_map_arguments(slope_of, args[1:])), ties
    )


def _broadcast(ties: list[Any], function: Any, args: Any, kwargs: Any) -> Any:
    """Return arrays and dual numbers broadcast to one shape: the rule for `np.broadcast_arrays`.

    A dual number is an array with its derivative, and both are broadcast. `args` are the arguments
    of the call, `ties` is the list in which switches without a derivative are noted. `function` and
    `kwargs` are there because all rules are called alike; they are not used.
    """
    whole = np.broadcast_shapes(*(np.shape(value_of(x)) for x in args))
    return tuple(
        Dual(np.broadcast_to(x.value, whole), np.broadcast_to(x.slope, whole), ties)
        if isinstance(x, Dual)
        else np.broadcast_to(x, whole)
        for x in args
    )


def _linear(ties: list[Any], function: Any, args: Any, kwargs: Any) -> Any:
    """Return a linear function, such as a sum, of dual numbers: the rule for such functions.

    A dual number is an array with its derivative; the derivative of the result is the same function
    of the derivatives. `ties` is the list in which switches without a derivative are noted; here
    none is added.
    """
    return Dual(
        function(*_map_arguments(value_of, args), **kwargs),
        function(*_slopes(args), **kwargs),
        ties,
    )


def _cross(ties: list[Any], function: Any, args: Any, kwargs: Any) -> Any:
    """Return the vector product of dual numbers."""
    (a, b), (da, db) = _map_arguments(value_of, args), _slopes(args)
    slope = function(da, b, **kwargs) + function(a, db, **kwargs)
    return Dual(function(a, b, **kwargs), slope, ties)


def _largest(ties: list[Any], function: Any, args: Any, kwargs: Any) -> Any:
    """Return the largest of dual numbers along an axis with its derivative: the rule for `np.max`.

    A dual number is an array with its derivative. `args` is the one array, `kwargs` has its
    ``axis``. `ties` is the list in which switches without a derivative are noted; here none is
    added. `function` is not used: all rules are called alike.
    """
    (of,), axis = args, kwargs["axis"]
    where = np.argmax(of.value, axis=axis, keepdims=True)
    value, slope = (
        np.take_along_axis(part, where, axis=axis).squeeze(axis) for part in (of.value, of.slope)
    )
    return Dual(value, slope, ties)


SHAPES_ONLY = {"shape", "ndim", "size", "zeros_like", "ones_like", "full_like", "empty_like"}
LINEAR = {"stack", "broadcast_to", "concatenate", "sum", "squeeze", "reshape"}
ARRAY_RULES: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(LINEAR, _linear),
    "clip": _clip,
    "where": _where,
    "broadcast_arrays": _broadcast,
    "cross": _cross,
    "max": _largest,
    "amax": _largest,
}
"""Functions of numpy that arrange or choose: of the ties, the function and its arguments."""
