"""The outputs of a plan to 50 digits: its own equations, run on numbers of that precision.

The equations are written for arrays and do not ask what stands in them. Arrays of `Number` run
them with mpmath by the functions of `DIGITS`; where a step would round to a float it fails instead,
so that a result has all its digits or there is none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath
import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.watch import Watch

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

STEP = CONTEXT.mpf(10) ** -20
"""Step of the central differences behind a condition number, as a share of the parameter."""

VANISHES = 1e-35  # SI units: a result of 50 digits that is less counts as 0

PIECE = 64  # cells that are computed before progress is reported


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


class NotPreciseError(VibrafeedError):
    """An equation rounds to floats on its way, so that its value to 50 digits is not known."""


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


def exact_values(
    plan: Plan, cells: Mapping[str, Array], *, partial: bool = False, watch: Watch | None = None
) -> dict[str, NDArray[np.object_]]:
    """Return the outputs of a closed-form plan at cells to 50 digits.

    Parameters
    ----------
    plan : Plan
        What to compute; every parameter of it is among the cells.
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units; each float is taken as it is, to its last bit.
    partial : bool
        Leave out what an equation rounds on its way to, instead of an error.
    watch : Watch, optional
        Told of progress.

    Returns
    -------
    dict of str to ndarray of object, shape (n,)
        Numbers of `mpmath`, SI units.

    Raises
    ------
    NotPreciseError
        If an equation rounds on its way; not if `partial`.
    """
    columns, size = _columns(cells)
    return _outputs(plan, columns, size, partial, watch or Watch())


def sensitivities(
    plan: Plan, cells: Mapping[str, Array], *, partial: bool = False, watch: Watch | None = None
) -> dict[str, NDArray[np.object_]]:
    """Return the sum |x dF/dx| over the parameters x, for each output F, to 50 digits.

    Over |F| the sum is the condition number: if every parameter changes by a share h, the output
    changes by at most h times that number of itself. It is found by central differences.

    Parameters
    ----------
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units.
    partial : bool
        True to leave out outputs that an equation rounds to floats, instead of an error.
    watch : Watch, optional
        Takes the progress, and may stop the work.

    Returns
    -------
    dict of str to ndarray of mpmath numbers, shape (n,)
    """
    watch = watch or Watch()
    columns, size = _columns(cells)
    names = [name for name in columns if name in plan.parameters]
    share = watch.part(1 / max(1, 2 * len(names)))
    moved: dict[str, Any] = dict.fromkeys(plan.outputs, np.full(size, CONTEXT.zero))
    for name in names:
        up, down = (
            _outputs(
                plan,
                {**columns, name: columns[name] * Number(1 + way * STEP)},
                size,
                partial,
                share,
            )
            for way in (1, -1)
        )
        moved = {
            output: total + abs(up[output] - down[output]) / (2 * STEP)
            for output, total in moved.items()
            if output in up
        }
    return moved


def _columns(cells: Mapping[str, Array]) -> tuple[dict[str, Any], int]:
    """Return the cells as columns of 50-digit numbers, and their length.

    A parameter is the float that it is, but for multiples of 90 degrees (`mechanics.arrays`).
    """
    columns = {name: _AS_NUMBER(np.atleast_1d(values)) for name, values in cells.items()}
    size = max((column.size for column in columns.values()), default=1)
    return {name: np.broadcast_to(column, size) for name, column in columns.items()}, size


_AS_NUMBER = np.frompyfunc(lambda value: Number(CONTEXT.mpf(float(value))), 1, 1)


def _outputs(
    plan: Plan, columns: Mapping[str, Any], size: int, partial: bool, watch: Watch
) -> dict[str, NDArray[np.object_]]:
    """Return the outputs of a plan at cells to 50 digits, as mpmath numbers, shape (size,).

    Parameters
    ----------
    columns : mapping of str to ndarray of mpmath numbers, shape (size,)
        The parameters, SI units.
    partial : bool
        True to leave out outputs that an equation rounds to floats; else `NotPreciseError` is
        raised.
    watch : Watch
        Takes the progress, and may stop the work.
    """
    rounds: dict[str, str] = {}
    outputs = {name: np.empty(size, dtype=object) for name in plan.outputs}
    for start in range(0, size, PIECE):
        piece = slice(start, min(start + PIECE, size))
        count = piece.stop - piece.start
        # Defaults as columns too: numpy turns arrays without dimension into bare elements.
        known: dict[str, Any] = {
            name: _labelled(_AS_NUMBER(np.full(count, value)))
            for name, value in plan.defaults.items()
        }
        known |= {name: _labelled(columns[name][piece]) for name in plan.parameters}
        _run(plan, known, rounds)
        for name in plan.outputs:
            if name not in rounds:
                with np.errstate(all="ignore"):
                    values = np.broadcast_to(_numbers(known[name]), count)
                outputs[name][piece] = [number.value for number in values]
        watch.advance(count / size)
    for name in rounds:
        if name in outputs and not partial:
            raise NotPreciseError(rounds[name])
        outputs.pop(name, None)
    return outputs


def _run(plan: Plan, known: dict[str, Any], rounds: dict[str, str]) -> None:
    """Add the results of a plan's equations to `known`, as arrays of numbers of 50 digits.

    `known` has the parameters and defaults. A quantity that an equation rounds to floats goes to
    `rounds` instead, with the reason, as do those that need it.
    """
    for equation in plan.equations:
        lost = [name for name in equation.inputs if name in rounds]
        if lost:
            rounds[equation.gives] = rounds[lost[0]]
            continue
        inputs = {name: known[name] for name in equation.inputs}
        try:
            with np.errstate(all="ignore"):  # of NaN on its way into a number
                known[equation.gives] = _labelled(equation.function(**inputs))
        except TypeError as error:
            rounds[equation.gives] = f"{equation.gives} of {plan.scene.name}: {error}"


@dataclass(frozen=True)
class Errors:
    """Errors of one output over some cells; arrays of shape (cells,).

    NaN where the exact value is 0 and the float is not: rounding of 0 by law has no scale.

    Attributes
    ----------
    relative : ndarray
        Error over the exact value.
    ulps : ndarray
        Error in units in the last place of the exact value.
    conditioned : ndarray
        The same over the condition number, which is at least 1.
    condition : ndarray
        Condition number: sum of |x dF/dx|/|F| over the parameters x, at least 1.
    """

    relative: Array
    ulps: Array
    conditioned: Array
    condition: Array


def errors_of(
    got: Array, exact: NDArray[np.object_], moved: NDArray[np.object_], dtype: Any
) -> Errors:
    """Return the errors of values computed in a floating-point type.

    Parameters
    ----------
    got : ndarray, shape (n,)
        Values as the floats gave them.
    exact : ndarray of object, shape (n,)
        Exact values, numbers of mpmath.
    moved : ndarray of object, shape (n,)
        Sum of |x dF/dx| over the parameters x, numbers of mpmath, for the condition number.
    dtype : type
        The floating-point type, by whose last place errors are counted.

    Returns
    -------
    Errors
        Errors over the value, in units in the last place, and these over the condition number;
        condition numbers. All of shape (n,), NaN where the exact value is 0 and the float is not.
    """
    count = len(exact)
    relative, ulps, conditioned, condition = (np.full(count, np.nan) for _ in range(4))
    for cell in range(count):
        value, number = exact[cell], float(got[cell])
        if not CONTEXT.isfinite(value) or not np.isfinite(dtype(float(value))):
            # The right infinity, or no value where there is none, is no error.
            same = number == float(value) or (CONTEXT.isnan(value) and np.isnan(number))
            errors = (0.0, 0.0, 0.0) if same else (np.inf, np.inf, np.inf)
            relative[cell], ulps[cell], conditioned[cell] = errors
            continue
        if abs(value) < VANISHES:
            if number == 0:
                relative[cell] = ulps[cell] = conditioned[cell] = 0.0
            continue
        error = abs(CONTEXT.mpf(number) - value) if np.isfinite(number) else CONTEXT.inf
        unit = CONTEXT.mpf(float(np.spacing(np.abs(dtype(float(value))))))
        size = abs(value)
        kappa = CONTEXT.one
        if CONTEXT.isfinite(moved[cell]):
            kappa = max(kappa, moved[cell] / size)
        relative[cell] = float(error / size)
        ulps[cell] = float(error / unit)
        conditioned[cell] = float(error / unit / kappa)
        condition[cell] = float(kappa)
    return Errors(relative, ulps, conditioned, condition)
