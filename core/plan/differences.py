"""Derivatives of the outputs of a plan by its parameters, from differences of its own equations.

Closed forms and motion are computed at x, x +- h and x +- h/2, many cells at once. With D(h) =
(F(x + h) - F(x - h))/(2 h) the derivative is (4 D(h/2) - D(h))/3 (Richardson); |D(h/2) - D(h)| and
the rounding of F over h state its error (theory 13.16).

The first step is 2^-16 of the scale of a parameter: near eps^(1/3), where truncation and rounding
of D are equal, and not larger, since kinks of motion lie close. Other steps serve where it fails.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from math import ceil
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan.equations import run_equations
from vibrafeed.core.plan.plan import Plan, plan_scene
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.flags import DERIVATIVE_STATUSES
from vibrafeed.core.scenes.aliases import CONSTRAINTS
from vibrafeed.core.watch import Watch

STEPS = 2.0 ** -np.array([16, 12, 8, 20, 24, 28, 32])
"""Steps over the scale of the parameter; powers of two, so that x + h is exact."""
OFFSETS = np.array([[-1, -1 / 2, 1 / 2, 1], [1 / 4, 1 / 2, 1, 1]])[:, :, np.newaxis]
"""Points beside x over the step: on both sides, and on one, where the other is out of bounds."""
WEIGHTS = np.array([
    [[-1 / 2, 0, 0, 1 / 2, 0], [0, -1, 1, 0, 0], [1, 0, 0, 1, -2], [0, 2, 2, 0, -4]],
    [[0, 4, -1, 0, -3], [8, -2, 0, 0, -6], [0, -4, 2, 0, 2], [-8, 4, 0, 0, 4]],
])  # fmt: skip
"""Of the values at these points and at x: D(h), D(h/2), and what slopes differ by, at h and h/2."""
GOOD = 1e-8  # relative error from which on no other step is tried
TRUSTED = 1e-3  # largest relative error of a derivative that is still reported
NEGLIGIBLE = 1e-6  # and, over value and scale, of one that is next to 0
ROUNDING = 2.0**-51  # relative rounding of the difference of two values
AGREE = 1e-5
"""Difference of the slopes on both sides of x, over the larger slope and over value and scale, that
counts as none: more is a kink or a jump."""
COUNTS = ("period_multiple", "impacts_per_period", "collisions_per_period")
"""Whole numbers that do not change inside a regime; a scene may lack some."""
BLOCK = 1 << 15  # cells that are computed at once
STATUS: Mapping[str, int] = {name: flag.value for name, flag in DERIVATIVE_STATUSES.items()}


class Derived(NamedTuple):
    """An output and its derivative by one parameter, SI units; arrays of shape (cells,).

    Attributes
    ----------
    value, slope : ndarray
        The output and its derivative, NaN where there is none.
    error : ndarray
        Estimate of the error of `slope`, NaN where there is none.
    status : ndarray of int8
        Value of a `DERIVATIVE_STATUSES` entry.
    """

    value: Array
    slope: Array
    error: Array
    status: NDArray[np.int8]

    def logarithmic(self, at: Array) -> Array:
        """Return the elasticity d ln(output)/d ln(parameter), shape (cells,).

        `at` are the values of the parameter, SI units, shape (cells,). NaN where the output is 0.
        It is the exponent if the output is a power of the parameter.
        """
        with np.errstate(all="ignore"):
            usable = (self.value != 0) & np.isfinite(self.value)
            elasticity: Array = np.where(usable, self.slope / self.value * at, np.nan)
        return elasticity


Derivatives: TypeAlias = dict[tuple[str, str], Derived]
"""By output and parameter."""


def derivatives(
    plan: Plan, cells: Mapping[str, Any], parameters: Collection[str], watch: Watch | None = None
) -> Derivatives:
    """Return the derivatives of every output of a plan by some parameters, at some cells.

    The keys are pairs (output, parameter), the values arrays over the cells, SI units and radians.
    NaN at a kink, at a jump, and where the motion does not repeat; from inside where the parameter
    is at an end of what it may be.

    Parameters
    ----------
    plan : Plan
        Its outputs are derived.
    cells : mapping of str to array_like
        Parameters, SI units and radians, that broadcast to the shape (cells,).
    parameters : collection of str
        What to derive by: parameters of the cells, or those with a default value.
    watch : Watch, optional
        May stop the work; derivatives that are not finished have the status `not_computed`.

    Raises `StudyError` if no output depends on a parameter.
    """
    watch = watch or Watch()
    values = values_of(plan, cells, parameters)
    whole, counts = _with_counts(plan)
    model = _Model(whole, plan.outputs, counts, watch)
    count = next(iter(values.values())).size
    shape = (len(parameters), len(plan.outputs), count)
    value, slope, error = np.full((3, *shape), np.nan)
    status = np.full(shape, STATUS["not_computed"], dtype=np.int8)
    share = 1 / (ceil(count / BLOCK) * (1 + len(parameters)))
    for start in range(0, count, BLOCK):
        piece = slice(start, start + BLOCK)
        near = {name: values[name][piece] for name in (*whole.parameters, *parameters)}
        outputs, kinds = model.at(near, share)
        for place, parameter in enumerate(parameters):
            told = model.derived(near, parameter, outputs, kinds, share)
            if not watch.stopped():
                for array, part in zip((value, slope, error, status), told, strict=True):
                    array[place, :, piece] = part
    return {
        (output, parameter): Derived(*(array[k, j] for array in (value, slope, error, status)))
        for k, parameter in enumerate(parameters)
        for j, output in enumerate(plan.outputs)
    }


def values_of(
    plan: Plan, cells: Mapping[str, Any], parameters: Collection[str]
) -> dict[str, Array]:
    """Return every parameter and default of a plan at cells, SI units, each of shape (cells,).

    `cells` has the values of the plan's parameters, which broadcast; `parameters` are those by
    which outputs are to be derived. Raises `StudyError` for one of them that the plan does not use.
    """
    values = {**plan.defaults, **{name: cells[name] for name in plan.parameters}}
    unknown = [name for name in parameters if name not in values]
    if unknown:
        fix = f"Known here: {', '.join(values)}"
        message = f"no output asked for of {plan.scene.name} is computed from it"
        raise StudyError([Problem(f"parameters.{name}", message, fix) for name in unknown])
    columns = [np.asarray(value, dtype=np.float64) for value in values.values()]
    shape = np.broadcast_shapes((1,), *(column.shape for column in columns))
    return {n: np.broadcast_to(c, shape) for n, c in zip(values, columns, strict=True)}


def _with_counts(plan: Plan) -> tuple[Plan, tuple[str, ...]]:
    if not any(equation.takes_long for equation in plan.equations):
        return plan.part(plan.outputs), ()
    counts = tuple(name for name in COUNTS if name in plan.scene.outputs(plan.variant))
    outputs = tuple(dict.fromkeys((*plan.outputs, *counts)))
    more = plan_scene(plan.scene, plan.variant, outputs, plan.parameters)
    settings = {name: value for name, value in plan.defaults.items() if name in more.defaults}
    return replace(more, defaults={**more.defaults, **settings}), counts


class Slopes(NamedTuple):
    """Derivatives from difference quotients, and what they are judged by; arrays of one shape.

    Attributes
    ----------
    slope, error : ndarray
        The derivative, and the difference of the quotients over the step and over half of it.
    apart, near : ndarray
        Difference of the slopes on both sides, over the step and over half of it: half as much if
        the function is smooth, as much at a kink, twice as much at a jump.
    largest : ndarray
        The larger of both quotients.
    """

    slope: Array
    error: Array
    apart: Array
    near: Array
    largest: Array


def slopes_of(values: Array, step: Array, inside: Mask | bool = False) -> Slopes:
    """Return derivatives from values at the points `OFFSETS`, then at x itself, shape (5, ...).

    `step` is h, below 0 where `inside` points lie below x.
    """
    with np.errstate(all="ignore"):
        both = np.tensordot(WEIGHTS[0], values, 1) / step
        one = np.tensordot(WEIGHTS[1], values - values[-1], 1) / step  # equal values: exactly 0
        wide, narrow, apart, near = np.where(inside, one, both)
        largest = np.maximum(np.abs(wide), np.abs(narrow))
        return Slopes((4 * narrow - wide) / 3, np.abs(narrow - wide), apart, near, largest)


def jacobian(rows: Callable[[Array], Array], at: Array, step: float) -> Array:
    """Return the derivatives of `rows` at a point of the unit box, shape (n, rows).

    Central differences, one-sided at the sides of the box. `rows` takes points, shape (2 n, n), and
    returns a row for each.
    """
    steps = step * np.eye(at.size)
    ahead, behind = np.minimum(at + steps, 1.0), np.maximum(at - steps, 0.0)
    values = rows(np.concatenate([ahead, behind]))
    change = values[: at.size] - values[at.size :]
    slopes: Array = change / np.diag(ahead - behind)[:, np.newaxis]
    return slopes


@dataclass(frozen=True)
class _Model:
    plan: Plan
    outputs: tuple[str, ...]
    counts: tuple[str, ...]
    watch: Watch

    def at(self, values: Mapping[str, Array], share: float) -> tuple[Array, Array]:
        known = run_equations(self.plan, values, self.watch.part(share))
        size = next(iter(values.values())).size
        outputs, kinds = (
            np.reshape([np.broadcast_to(known[name], size) for name in names], (len(names), size))
            for names in (self.outputs, self.counts)
        )
        return outputs, kinds

    def derived(
        self, values: Mapping[str, Array], parameter: str, middle: Array, kinds: Array, share: float
    ) -> tuple[Array, Array, Array, NDArray[np.int8]]:
        scale = _scale_of(parameter, values[parameter])
        size, finite = np.abs(middle) / scale, np.isfinite(middle)
        slope, error = np.full(middle.shape, np.nan), np.full(middle.shape, np.inf)
        status = np.full(middle.shape, STATUS["kink"], dtype=np.int8)
        repeats = kinds[0] >= 1 if self.counts else np.ones(scale.size, dtype=bool)
        is_open = repeats & finite.any(axis=0)
        for relative in STEPS:
            (todo,) = np.nonzero(is_open)
            if not todo.size or self.watch.stopped():
                break
            near = {name: array[todo] for name, array in values.items()}
            here = middle[:, todo], kinds[:, todo], size[:, todo]
            tried = self._tried(near, parameter, relative * scale[todo], *here, share)
            better = tried[1] < error[:, todo]
            for array, new in zip((slope, error, status), tried, strict=True):
                array[:, todo] = np.where(better, new, array[:, todo])
            good = error <= GOOD * np.fmax(np.abs(slope), size)
            is_open, share = repeats & ~(good | ~finite).all(axis=0), 0.0
        room = np.fmax(TRUSTED * np.abs(slope), NEGLIGIBLE * size)
        status[np.isfinite(error) & ~(error <= room)] = STATUS["unsettled"]
        status[~finite] = STATUS["no_value"]
        status[:, ~repeats] = STATUS["not_periodic"]
        slope[status >= STATUS["kink"]] = error[status >= STATUS["kink"]] = np.nan
        return middle, slope, error, status

    def _tried(
        self, near: Mapping[str, Array], parameter: str, step: Array, middle: Array, kinds: Array,
        size: Array, share: float,
    ) -> tuple[Array, Array, Array]:  # fmt: skip
        at = near[parameter]
        over, under = (self._may_be(near, parameter, at + way * step) for way in (1, -1))
        inside, step = over != under, np.where(over >= under, step, -step)
        around = at + np.where(inside, OFFSETS[1], OFFSETS[0]) * step
        moved = {name: np.tile(array, 4) for name, array in near.items()}
        rows = self.at({**moved, parameter: around.ravel()}, share)
        outputs, others = (row.reshape(-1, *around.shape) for row in rows)
        # At an end of its range a motion may be of another kind, as without any rebound.
        own = np.where(inside, others[:, -1], kinds)
        same = np.isclose(others, own[:, np.newaxis], rtol=1e-12, atol=0).all(axis=(0, 1))
        values = np.concatenate([np.moveaxis(outputs, 1, 0), middle[np.newaxis]])
        slopes = slopes_of(values, step, inside)
        with np.errstate(all="ignore"):
            kink = np.abs(2 * slopes.near - slopes.apart)  # 0 but for h^3 where F is smooth
            counts = same & (kink <= AGREE * (slopes.largest + size))
            error = slopes.error + kink / 2 + ROUNDING * np.abs(middle / step)
        error = np.where(counts, error, np.inf)
        status = np.where(inside, STATUS["one_sided"], STATUS["differences"])
        return slopes.slope, error, np.broadcast_to(status, error.shape)

    def _may_be(self, near: Mapping[str, Array], parameter: str, to: Array) -> Mask:
        quantity = QUANTITIES[parameter]
        unit = np.deg2rad(1.0) if quantity.is_angle else 1.0
        lower, upper = quantity.lower * unit, quantity.upper * unit
        allowed = ((to > lower) if quantity.strict else (to >= lower)) & (to <= upper)
        values = {**near, parameter: to}
        for one in (*self.plan.scene.constraints, *CONSTRAINTS):
            concerned = one.variant in ("", self.plan.variant) and parameter in one.parameters
            if concerned and set(one.parameters) <= set(values):
                rows = zip(*(values[name] for name in one.parameters), strict=True)
                allowed &= [one.holds(*np.repeat(row, 2).tolist()) for row in rows]
        return np.asarray(allowed)


def _scale_of(parameter: str, at: Array) -> Array:
    quantity = QUANTITIES[parameter]
    least = 1.0 if quantity.is_angle else (quantity.usual or (0.0,))[0]
    size = np.maximum(np.abs(at), least)
    return np.asarray(np.ldexp(1.0, np.frexp(np.where(size == 0, 1.0, size))[1]))
