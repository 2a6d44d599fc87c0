"""Derivatives of the outputs of a plan by its parameters, at many cells in one pass.

The equations of the plan are run on numbers that carry their derivative
(`vibrafeed.core.plan.duals`): each is exact up to rounding. What has no formula, such as a motion,
comes with a rule of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import reduce
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.duals import Dual, NotDifferentiableError, slope_of, unbox, value_of
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.quantities.derivative import DERIVATIVE_STATUSES
from vibrafeed.core.scenes import Equation

SIDE = 1e-6  # step to either side of a switch, as a share of the parameter
WIDER = 16  # the farther points are so many steps away
ROUNDING = 1e-12  # rounding error that a value may have, as a share of it
AGREE = 1e-5  # relative difference of the derivatives of both sides that are still one

Statuses: TypeAlias = NDArray[np.int8]
DERIVATIVE_STATUS: Mapping[str, int] = {
    name: flag.value for name, flag in DERIVATIVE_STATUSES.items()
}

Ruled: TypeAlias = tuple[Any, "Statuses | int"]
Rule: TypeAlias = Callable[[Mapping[str, Any]], Ruled]
"""Takes the arguments of an equation, of which some carry a derivative; returns what the equation
gives, which carries one, and the status of each cell."""


class Derived(NamedTuple):
    """An output and its derivative by one parameter, SI units; arrays of shape (cells,).

    Attributes
    ----------
    value, slope : ndarray
        The output and its derivative, NaN where there is none.
    error : ndarray
        Estimate of the error of `slope`; 0 if exact up to rounding, NaN where there is none.
    status : ndarray of int8
        Value of a `DERIVATIVE_STATUSES` entry.
    below, above : ndarray
        At a switch of the equations the derivatives next to it, else NaN.
    jumps : ndarray of bool
        Whether the output jumps at a switch.
    """

    value: Array
    slope: Array
    error: Array
    status: Statuses
    below: Array
    above: Array
    jumps: NDArray[np.bool_]

    def logarithmic(self, at: Array) -> Array:
        """Return the elasticity d ln(output)/d ln(parameter), shape (cells,).

        `at` are the values of the parameter, SI units, shape (cells,). NaN where the output is 0.
        It is the exponent if the output is a power of the parameter.
        """
        with np.errstate(all="ignore"):
            usable = (self.value != 0) & np.isfinite(self.value)
            elasticity: Array = np.where(usable, self.slope / self.value * at, np.nan)
        return elasticity

    def at(self, where: NDArray[np.bool_]) -> Derived:
        """Return the record of the cells for which the mask `where` is true."""
        value, slope, error, status, below, above, jumps = self
        told = (value[where], slope[where], error[where], status[where])
        return Derived(*told, below[where], above[where], jumps[where])

    def put(self, where: NDArray[np.bool_], part: Derived) -> None:
        """Write the record `part` over the cells for which the mask `where` is true."""
        arrays: tuple[NDArray[Any], ...] = self
        for array, values in zip(arrays, part, strict=True):
            array[where] = values


Derivatives: TypeAlias = dict[tuple[str, str], Derived]
"""By output and parameter."""


def derivatives(
    plan: Plan,
    cells: Mapping[str, Any],
    parameters: Collection[str],
    rules: Mapping[str, Rule] | None = None,
) -> Derivatives:
    """Return the exact derivatives of every output of a plan by some parameters, at some cells.

    The keys are pairs (output, parameter), the values arrays over the cells, SI units and radians.
    At a switch of the equations (an equality that a step would decide) both sides are evaluated:
    the derivative is that of both if they agree, else NaN with the two.

    Parameters
    ----------
    plan : Plan
        Its outputs are derived.
    cells : mapping of str to array_like
        Parameters, SI units and radians, that broadcast to the shape (cells,).
    parameters : collection of str
        What to derive by: parameters of the cells, or those with a default value.
    rules : mapping of str to callable, optional
        Derivatives of equations that numpy's rules do not give, by what the equation gives.

    Raises `StudyError` if a parameter is no number or an equation has no rule for its derivative.
    """
    values = values_of(plan, cells, parameters)
    results: Derivatives = {}
    for parameter in parameters:
        middle = _carry_derivative(plan, values, parameter, rules or {})
        doubtful = np.zeros(values[parameter].shape, dtype=bool)
        for carried in middle.values():
            doubtful |= carried.is_doubtful
        sides: list[dict[str, _Slope]] = []
        if doubtful.any():
            near = {name: value[doubtful] for name, value in values.items()}
            sides = _derivatives_beside(plan, near, parameter, rules or {})
        for output, carried in middle.items():
            derived = _between_switches(carried)
            if sides:
                step = SIDE * _size(values[parameter][doubtful])
                around = [side[output] for side in sides]
                some = _from_both_sides(carried.value[doubtful], step, *around)
                here = carried.is_doubtful
                derived.put(here, some.at(here[doubtful]))
            results[output, parameter] = derived
    return results


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


class _Slope(NamedTuple):
    """Value, slope and status of an output; of a cell at a switch the status is `both_sides`."""

    value: Array
    slope: Array
    status: Statuses

    @property
    def is_doubtful(self) -> NDArray[np.bool_]:
        """A mask of the cells at a switch of formulas, where both sides must be evaluated."""
        open_ = self.status < DERIVATIVE_STATUS["kink"]
        unsure = (self.status > DERIVATIVE_STATUS["exact"]) | ~np.isfinite(self.slope)
        return np.asarray(open_ & unsure & np.isfinite(self.value))


def _carry_derivative(
    plan: Plan, values: Mapping[str, Array], parameter: str, rules: Mapping[str, Rule]
) -> dict[str, _Slope]:
    """Return value, derivative and status of each output by one parameter, from dual numbers.

    The plan's equations are run with the parameter as an array that carries a derivative of 1. The
    status says where the equations met a switch, so that both sides must be looked at.

    Parameters
    ----------
    values : mapping of str to ndarray, shape (cells,)
        All parameters at the cells, SI units.
    parameter : str
        What to derive by.
    rules : mapping of str to callable
        Derivatives of equations that dual numbers cannot follow, by what the equation gives.
    """
    ties: list[Any] = []
    cells = values[parameter].size
    known: dict[str, Any] = dict(values)
    known[parameter] = Dual(values[parameter], 1.0, ties)
    status: dict[str, Any] = {}
    for equation in plan.equations:
        ties.clear()
        arguments = {name: known[name] for name in equation.inputs}
        rule_status: Any = 0
        if equation.gives in rules:
            known[equation.gives], rule_status = rules[equation.gives](arguments)
        else:
            known[equation.gives] = unbox(_run(equation, arguments, parameter))
        before = [status[name] for name in equation.inputs if name in status]
        switches = [DERIVATIVE_STATUS["both_sides"] * _by_cell(where, cells) for where in ties]
        status[equation.gives] = reduce(np.maximum, [rule_status, *before, *switches])
    shape = values[parameter].shape
    return {
        name: _Slope(
            np.broadcast_to(np.asarray(value_of(known[name]), np.float64), shape),
            np.broadcast_to(np.asarray(slope_of(known[name]), np.float64), shape),
            np.broadcast_to(np.asarray(status.get(name, 0), np.int8), shape),
        )
        for name in plan.outputs
    }


def _by_cell(where: NDArray[np.bool_], cells: int) -> NDArray[np.bool_]:
    """Return a mask of any shape as one entry per cell, true where any of its entries is.

    A mask without an axis of cells holds for all of them.
    """
    # Vectors have their components behind the cells; a lone vector is as long as few cells are.
    if where.ndim and where.shape[0] == cells and cells > 4:
        return np.asarray(where.reshape(cells, -1).any(axis=1))
    return np.full(cells, bool(where.any()))


def _run(equation: Equation, arguments: Mapping[str, Any], parameter: str) -> Any:
    """Return an equation's result for arguments that are dual numbers: arrays with a derivative.

    Parameters
    ----------
    arguments : mapping of str to Dual or ndarray
        Inputs of the equation, by name.
    parameter : str
        The parameter by which the dual numbers are derived, for the message.

    Raises
    ------
    StudyError
        If numpy's functions in the equation have no rule for a derivative.
    """
    function = equation.derivative or equation.function
    try:
        with np.errstate(all="ignore"):  # of the branches not taken, whose slopes may be anything
            return function(**arguments)
    except NotDifferentiableError as error:
        raise StudyError(
            [
                Problem(
                    f"outputs.{equation.gives}",
                    f"the equation of {equation.gives} has no exact derivative by {parameter}: "
                    f"{error}",
                    f"Leave {parameter} out of sensitivities, or compare two points of a sweep",
                )
            ]
        ) from error


def _between_switches(carried: _Slope) -> Derived:
    """Return the derivative of an output for cells that are at no switch of formulas.

    `carried` has its value, slope and status from dual numbers, arrays over cells. The slope is NaN
    where the status says that no derivative exists; the status becomes `no_value` where the output
    is not finite. The result has value, derivative, an error of 0, and the status; what is known at
    switches only is NaN.
    """
    lost = ~np.isfinite(carried.value) & (carried.status < DERIVATIVE_STATUS["kink"])
    status = np.where(lost, np.int8(DERIVATIVE_STATUS["no_value"]), carried.status)
    none = status >= DERIVATIVE_STATUS["kink"]
    empty = np.full(carried.value.shape, np.nan)
    slope = np.where(none, np.nan, carried.slope)
    error = np.where(none, np.nan, 0.0)
    jumps = np.zeros(carried.value.shape, dtype=bool)
    return Derived(
        carried.value.copy(), slope, error, status.astype(np.int8), empty, empty.copy(), jumps
    )


def _size(at: Array) -> Array:
    """Return the absolute values, 1 where they are 0."""
    return np.where(at == 0, 1.0, np.abs(at))


def _derivatives_beside(
    plan: Plan, values: Mapping[str, Array], parameter: str, rules: Mapping[str, Rule]
) -> list[dict[str, _Slope]]:
    """Return values and derivatives of outputs at four points beside a switch, ascending.

    The points are two below and two above each cell, 16 and 1 steps away; a step is 1e-6 of the
    parameter.

    Parameters
    ----------
    values : mapping of str to ndarray, shape (cells,)
        All parameters at the cells at a switch, SI units.
    parameter : str
        The parameter that is moved, and by which outputs are derived.
    rules : mapping of str to callable
        Derivatives of equations that numpy's rules do not give, by what the equation gives.
    """
    at = values[parameter]
    step = SIDE * _size(at)
    return [
        _carry_derivative(plan, {**values, parameter: at + away * step}, parameter, rules)
        for away in (-WIDER, -1, 1, WIDER)
    ]


def _from_both_sides(
    value: Array, step: Array, far_below: _Slope, below: _Slope, above: _Slope, far_above: _Slope
) -> Derived:
    """Return the derivative of an output at a switch of formulas if both sides agree, else NaN.

    The output jumps if its values on both sides differ by more than the slopes explain; it has a
    kink if the slopes stay apart however near the points. Then the status is `kink`, else
    `both_sides`.

    Parameters
    ----------
    value : ndarray, shape (n,)
        The output at the switch, in n cells.
    step : ndarray, shape (n,)
        Distance of the near points in the parameter; the far ones are 16 times as far.
    far_below, below, above, far_above : _Slope
        Value and slope of the output at these points.
    """
    with np.errstate(all="ignore"):
        largest = np.fmax(np.abs(below.slope), np.abs(above.slope))
        apart = np.abs(above.slope - below.slope)
        # A jump: values of both sides further apart than the slopes explain.
        room = 4 * step * largest + ROUNDING * np.abs(value)
        jumps = np.abs(above.value - below.value) > room
        # At a kink the slopes stay apart however near; those of a bend come together.
        far_apart = np.abs(far_above.slope - far_below.slope)
        bends = apart <= np.fmax(AGREE * largest, far_apart * 2 / WIDER)
        smooth = np.isfinite(apart) & bends & ~jumps
        mean = (below.slope + above.slope) / 2
    status = np.where(smooth, DERIVATIVE_STATUS["both_sides"], DERIVATIVE_STATUS["kink"]).astype(
        np.int8
    )
    slope, error = np.where(smooth, mean, np.nan), np.where(smooth, apart, np.nan)
    return Derived(value, slope, error, status, below.slope, above.slope, jumps)
