"""Derivatives of the outputs of a plan by its parameters, from differences of its own equations.

Closed forms and motion are computed at x, x +- h and x +- h/2, many cells at once. With D(h) =
(F(x + h) - F(x - h))/(2 h) the derivative is (4 D(h/2) - D(h))/3 (Richardson); |D(h/2) - D(h)| and
the rounding of F over h state its error (theory 13.16).

The first step is 2^-16 of the scale of a parameter: near eps^(1/3), where truncation and rounding
of D are equal, and not larger, since kinks of motion lie close. Other steps serve where it fails.
"""

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import TableVariable, flag_attributes
from vibrafeed.core.errors import Problem, StudyError, raise_any
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan, plan_scene, run_equations
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.flags import DERIVATIVE_STATUSES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.scenes import CONSTRAINTS
from vibrafeed.core.suggestions import suggestion
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
SECTION = "sensitivities"
MAX_DERIVED = 2_000_000
"""Most derivatives of a study: cells times outputs times parameters."""

Dims = Mapping[str, tuple[str, ...]]
"""The axes of each variable."""


class Derived(NamedTuple):
    """An output, its derivative by one parameter, the estimated error and the status of that.

    Arrays of shape (cells,), SI units, NaN where there is none; `status` has the value of a
    `DERIVATIVE_STATUSES` entry.
    """

    value: Array
    slope: Array
    error: Array
    status: NDArray[np.int8]

    def logarithmic(self, parameter_values: Array) -> Array:
        """Return the elasticity d ln(output)/d ln(parameter), NaN where the output is 0.

        `parameter_values` are in SI units, shape (cells,). It is the exponent if the output is
        a power of the parameter.
        """
        with np.errstate(all="ignore"):
            usable = (self.value != 0) & np.isfinite(self.value)
            return np.asarray(np.where(usable, self.slope / self.value * parameter_values, np.nan))


Derivatives: TypeAlias = dict[tuple[str, str], Derived]
"""By output and parameter."""


def derivatives(
    plan: Plan,
    cells: Mapping[str, Any],
    parameters: Collection[str],
    watch: Watch | None = None,
    sides: Mapping[str, NDArray[np.int8]] = MappingProxyType({}),
) -> Derivatives:
    """Return the derivatives of every output of a plan by some parameters, at some cells.

    NaN at a kink, at a jump, and where the motion does not repeat; from inside where the parameter
    is at an end of what it may be. `cells` have parameters, SI units, that broadcast to (cells,).
    `sides` have, by parameter and of shape (cells,), 1 or -1 where only values above or below that
    of the cell count. What `watch` stops has the status `not_computed`. Raises `StudyError` if no
    output depends on a parameter.
    """
    watch, values = watch or Watch(), values_of(plan, cells, parameters)
    model = _Model(*_with_counts(plan), len(plan.outputs))
    count = next(iter(values.values())).size
    results_by_parameter = np.full((4, len(parameters), len(plan.outputs), count), np.nan)
    results_by_parameter[3], both_sides = STATUS["not_computed"], np.zeros(count, dtype=np.int8)
    pass_watch = watch.part(1 / (ceil(count / BLOCK) * (1 + len(parameters))))
    for start in range(0, count, BLOCK):
        piece = slice(start, start + BLOCK)
        piece_values = {name: values[name][piece] for name in (*model.plan.parameters, *parameters)}
        results = model.at(piece_values, pass_watch)
        for number, parameter in enumerate(parameters):
            side = sides.get(parameter, both_sides)[piece]
            derived = model.derived(piece_values, parameter, side, *results, watch, pass_watch)
            if not watch.stopped():
                results_by_parameter[:, number, :, piece] = derived
    value, slope, error, status = results_by_parameter
    return {
        (output, parameter): Derived(
            value[parameter_number, output_number],
            slope[parameter_number, output_number],
            error[parameter_number, output_number],
            status[parameter_number, output_number].astype(np.int8),
        )
        for parameter_number, parameter in enumerate(parameters)
        for output_number, output in enumerate(plan.outputs)
    }


def values_of(
    plan: Plan, cells: Mapping[str, Any], parameters: Collection[str]
) -> dict[str, Array]:
    """Return every parameter and default of a plan at cells, SI units, each of shape (cells,).

    Raises `StudyError` for one of `parameters`, to derive by, that the plan does not use.
    """
    values = {**plan.defaults, **{name: cells[name] for name in plan.parameters}}
    unknown = [name for name in parameters if name not in values]
    if unknown:
        fix = f"Known here: {', '.join(values)}"
        message = f"no requested output of {plan.scene.name} depends on "
        raise StudyError([Problem(f"parameters.{n}", message + n, fix) for n in unknown])
    columns = np.broadcast_arrays(np.zeros(1), *values.values())[1:]
    return {
        name: np.asarray(column, np.float64) for name, column in zip(values, columns, strict=True)
    }


def _with_counts(plan: Plan) -> tuple[Plan, tuple[str, ...]]:
    # The plan with the counts that tell regimes apart, and the names of its outputs and counts.
    if not any(equation.takes_long for equation in plan.equations):
        return plan.part(plan.outputs), plan.outputs
    counts = tuple(name for name in COUNTS if name in plan.scene.outputs(plan.variant))
    outputs = tuple(dict.fromkeys((*plan.outputs, *counts)))
    extended = plan_scene(plan.scene, plan.variant, outputs, plan.parameters)
    settings = {name: value for name, value in plan.defaults.items() if name in extended.defaults}
    return replace(extended, defaults={**extended.defaults, **settings}), (*plan.outputs, *counts)


class Slopes(NamedTuple):
    """Derivatives from difference quotients, and what they are judged by; arrays of one shape.

    `error` is the difference of the quotients over the step and over half of it, `largest` the
    larger of both. `apart` and `near` are differences of the slopes on both sides, over the step
    and over half of it: half as much if the function is smooth, as much at a kink, twice at a jump.
    """

    slope: Array
    error: Array
    apart: Array
    near: Array
    largest: Array


def slopes_of(values: Array, step: Array, is_one_sided: Mask | bool = False) -> Slopes:
    """Return derivatives from values at the points `OFFSETS`, then at x itself, shape (5, ...).

    `step` is h, below 0 where points of `is_one_sided` lie below x.
    """
    with np.errstate(all="ignore"):
        central = np.tensordot(WEIGHTS[0], values, 1) / step
        # Less the value at x, so that equal values give exactly 0.
        one_sided = np.tensordot(WEIGHTS[1], values - values[-1], 1) / step
        wide, narrow, step_jump, half_step_jump = np.where(is_one_sided, one_sided, central)
        largest = np.maximum(np.abs(wide), np.abs(narrow))
        # D(h) and D(h/2) have errors of order h^2, which (4 D(h/2) - D(h))/3 cancels.
        return Slopes(
            (4 * narrow - wide) / 3, np.abs(narrow - wide), step_jump, half_step_jump, largest
        )


def jacobian(rows: Callable[[Array], Array], point: Array, step: float) -> Array:
    """Return the derivatives of `rows` at a point of the unit box, shape (n, rows).

    Central differences, one-sided at the sides of the box. `rows` takes points, shape (2 n, n), and
    returns a row for each.
    """
    steps = step * np.eye(point.size)
    forward, backward = np.minimum(point + steps, 1.0), np.maximum(point - steps, 0.0)
    rows_forward, rows_backward = np.split(rows(np.concatenate([forward, backward])), 2)
    return np.asarray((rows_forward - rows_backward) / np.diag(forward - backward)[:, np.newaxis])


@dataclass(frozen=True)
class _Model:
    """A plan whose first outputs are derived, the others being counts that tell regimes apart."""

    plan: Plan
    names: tuple[str, ...]
    derives: int

    def at(self, values: Mapping[str, Array], watch: Watch) -> tuple[Array, Array]:
        """Return outputs, shape (outputs, cells), and counts likewise."""
        results = run_equations(self.plan, values, watch)
        shape = len(self.names), next(iter(values.values())).size
        rows = np.reshape([np.broadcast_to(results[name], shape[1:]) for name in self.names], shape)
        return rows[: self.derives], rows[self.derives :]

    def derived(
        self, values: Mapping[str, Array], parameter: str, side: NDArray[np.int8], middle: Array,
        counts: Array, watch: Watch, pass_watch: Watch,
    ) -> Array:  # fmt: skip
        """Return value, derivative, error and status, shape (4, outputs, cells), at cells."""
        scale = scale_of(parameter, values[parameter])
        slope_scale, finite = np.abs(middle) / scale, np.isfinite(middle)
        best = np.stack(
            [np.full(middle.shape, number) for number in (np.nan, np.inf, STATUS["kink"])]
        )
        repeats = counts[0] >= 1 if len(counts) else np.ones(scale.size, dtype=bool)
        is_open = repeats & finite.any(axis=0)
        for relative in STEPS:
            (to_do,) = np.nonzero(is_open)
            if not to_do.size or watch.stopped():
                break
            values_to_do = {name: array[to_do] for name, array in values.items()}
            results_to_do = middle[:, to_do], counts[:, to_do], slope_scale[:, to_do]
            step = relative * scale[to_do]
            by_step = self._by_one_step(
                values_to_do, parameter, side[to_do], step, *results_to_do, pass_watch
            )
            best[:, :, to_do] = np.where(by_step[1] < best[1][:, to_do], by_step, best[:, :, to_do])
            is_accurate = best[1] <= GOOD * np.fmax(np.abs(best[0]), slope_scale)
            is_open, pass_watch = repeats & ~(is_accurate | ~finite).all(axis=0), watch.part(0.0)
        slope, error, status = best
        allowed_error = np.fmax(TRUSTED * np.abs(slope), NEGLIGIBLE * slope_scale)
        status[np.isfinite(error) & ~(error <= allowed_error)] = STATUS["unsettled"]
        status[~finite] = STATUS["no_value"]
        status[:, ~repeats] = STATUS["not_periodic"]
        best[:2, status >= STATUS["kink"]] = np.nan
        return np.stack([middle, slope, error, status])

    def _by_one_step(
        self, values: Mapping[str, Array], parameter: str, side: NDArray[np.int8], step: Array,
        middle: Array, counts_here: Array, slope_scale: Array, watch: Watch,
    ) -> Array:  # fmt: skip
        """Return derivatives by one step, their errors, infinite if it does not count, and status.

        `slope_scale` is the output over the scale of the parameter.
        """
        centre = values[parameter]
        allowed_above, allowed_below = (
            self._is_allowed(values, parameter, centre + direction * step) for direction in (1, -1)
        )
        direction = np.where(side == 0, 1 * allowed_above - allowed_below, side)
        is_one_sided, step = direction != 0, np.where(direction < 0, -step, step)
        is_side_allowed = np.where(side > 0, allowed_above, allowed_below) | (side == 0)
        points = centre + np.where(is_one_sided, OFFSETS[1], OFFSETS[0]) * step
        repeated = {name: np.tile(array, 4) for name, array in values.items()}
        rows = self.at({**repeated, parameter: points.ravel()}, watch)
        outputs, counts_at_points = (row.reshape(-1, *points.shape) for row in rows)
        # At an end of its range a motion may be of another kind, as without any rebound.
        reference_counts = np.where(is_one_sided, counts_at_points[:, -1], counts_here)
        same_regime = (
            np.isclose(counts_at_points, reference_counts[:, np.newaxis], rtol=1e-12, atol=0).all(
                axis=(0, 1)
            )
            & is_side_allowed
        )
        output_values = np.concatenate([np.moveaxis(outputs, 1, 0), middle[np.newaxis]])
        slopes = slopes_of(output_values, step, is_one_sided)
        with np.errstate(all="ignore"):
            kink = np.abs(2 * slopes.near - slopes.apart)  # 0 but for h^3 where F is smooth
            is_valid = same_regime & (kink <= AGREE * (slopes.largest + slope_scale))
            error = slopes.error + kink / 2 + ROUNDING * np.abs(middle / step)
        status = np.where(is_one_sided, STATUS["one_sided"], STATUS["differences"])
        error = np.where(is_valid, error, np.inf)
        return np.stack([slopes.slope, error, np.broadcast_to(status, error.shape)])

    def _is_allowed(self, values: Mapping[str, Array], parameter: str, new_values: Array) -> Mask:
        # True where the parameter may have the new value: within its bounds, and relations hold.
        quantity = QUANTITIES[parameter]
        unit = np.deg2rad(1.0) if quantity.is_angle else 1.0
        lower, upper = quantity.lower * unit, quantity.upper * unit
        allowed = ((new_values > lower) if quantity.strict else (new_values >= lower)) & (
            new_values <= upper
        )
        values = {**values, parameter: new_values}
        for constraint in (*self.plan.scene.constraints, *CONSTRAINTS):
            applies = (
                constraint.variant in ("", self.plan.variant) and parameter in constraint.parameters
            )
            if applies and set(constraint.parameters) <= set(values):
                rows = zip(*(values[name] for name in constraint.parameters), strict=True)
                allowed &= [constraint.holds(*np.repeat(row, 2).tolist()) for row in rows]
        return np.asarray(allowed)


def scale_of(parameter: str, values: Array) -> Array:
    """Return a power of two near the size of each value, or the least usual size, 1 for angles."""
    quantity = QUANTITIES[parameter]
    usual_size = 1.0 if quantity.is_angle else (quantity.usual or (0.0,))[0]
    size = np.maximum(np.abs(values), usual_size)
    return np.asarray(np.ldexp(1.0, np.frexp(np.where(size == 0, 1.0, size))[1]))


@dataclass(frozen=True)
class Added:
    """Variables that a study adds to its outputs, each over the axes of an output."""

    outputs: tuple[str, ...]

    @property
    def passes(self) -> int:
        """The number of times that a cell is computed for them."""
        raise NotImplementedError

    @property
    def labels(self) -> dict[str, dict[str, Any]]:
        """The attributes of each variable in order; `output` says whose axes it has, else all."""
        raise NotImplementedError

    @property
    def units(self) -> dict[str, str]:
        """The unit of each variable."""
        return {name: attributes.get("units", "1") for name, attributes in self.labels.items()}

    def dims(self, grid: Grid, depends: Mapping[str, Iterable[str]]) -> dict[str, tuple[str, ...]]:
        """Return the axes of each variable: those of its output, for a flag of all outputs."""
        all_axes = {axis for name in self.outputs for axis in depends[name]}
        return {
            name: grid.dims(depends[attributes["output"]] if "output" in attributes else all_axes)
            for name, attributes in self.labels.items()
        }

    def variables(self, dims: Dims, arrays: Mapping[str, NDArray[Any]]) -> dict[str, TableVariable]:
        """Return the variables for a result by name: axes, values, attributes."""
        return {
            name: TableVariable(dims[name], arrays[name], attributes)
            for name, attributes in self.labels.items()
        }


def over_axes(
    by_cell: Mapping[str, NDArray[Any]], grid: Grid, dims: Dims
) -> dict[str, NDArray[Any]]:
    """Return variables of all cells of a grid, shape (cells,), each over its own axes."""
    shape = tuple(grid.shape.values())
    return {
        name: array.reshape(shape)[
            tuple(slice(None) if axis in dims[name] else 0 for axis in grid.axes)
        ]
        for name, array in by_cell.items()
    }


@dataclass(frozen=True)
class Asked(Added):
    """The outputs of a study that are derived, and the parameters by which they are."""

    parameters: tuple[str, ...]

    @property
    def passes(self) -> int:
        """The number of times that a cell is computed: usually four for each parameter, and one."""
        return 1 + 4 * len(self.parameters)

    @cached_property
    def labels(self) -> dict[str, dict[str, Any]]:
        """The attributes of each variable that the asked derivatives add to a result, in order."""
        labels: dict[str, dict[str, Any]] = {}
        for parameter in self.parameters:
            parameter_label, status = QUANTITIES[parameter].label.lower(), _status_name(parameter)
            for output in self.outputs:
                output_label, unit = in_sentence(QUANTITIES[output].label), _per(output, parameter)
                texts = (
                    (unit, f"Derivative of {output_label} by {parameter_label}",
                     f"d({output})/d({parameter}); NaN where {status} says why there is none."),
                    (unit, f"Error of the derivative of {output_label} by {parameter_label}",
                     "An estimate, from differences over a step and over half of it."),
                    ("1", f"Sensitivity of {output_label} to {parameter_label}",
                     f"d ln({output})/d ln({parameter})."),
                )  # fmt: skip
                for name, (units, title, comment) in zip(
                    _names(output, parameter), texts, strict=True
                ):
                    labels[name] = {
                        "units": units, "long_name": title, "comment": comment,
                        "output": output, "parameter": parameter,
                    }  # fmt: skip
            labels[status] = flag_attributes(
                "motion_status", DERIVATIVE_STATUSES, tuple(DERIVATIVE_STATUSES)
            ) | {"long_name": f"Status of the derivatives by {parameter_label}"}
        return labels

    def arrays(
        self, plan: Plan, grid: Grid, dims: Dims, derivatives: Derivatives
    ) -> dict[str, NDArray[Any]]:
        """Return each variable of the asked derivatives over its axes, in the units of files.

        The status of a parameter is the worst of all outputs.
        """
        shape = tuple(grid.shape.values())
        values: dict[str, Any] = {**plan.defaults, **grid.si()}
        by_cell: dict[str, NDArray[Any]] = {}
        for parameter in self.parameters:
            parameter_values = np.broadcast_to(values[parameter], shape).ravel()
            derived = [derivatives[output, parameter] for output in self.outputs]
            for output, derivative in zip(self.outputs, derived, strict=True):
                factor = np.rad2deg(1.0) if QUANTITIES[output].is_angle else 1.0
                factor *= np.deg2rad(1.0) if QUANTITIES[parameter].is_angle else 1.0
                values_of_output = (
                    derivative.slope * factor,
                    derivative.error * factor,
                    derivative.logarithmic(parameter_values),
                )
                by_cell |= zip(_names(output, parameter), values_of_output, strict=True)
            worst = np.maximum.reduce([derivative.status for derivative in derived])
            by_cell[_status_name(parameter)] = worst
        return over_axes(by_cell, grid, dims)


def _names(output: str, parameter: str) -> tuple[str, str, str]:
    derivative = f"derivative_{output}_by_{parameter}"
    return derivative, f"{derivative}_error", f"sensitivity_{output}_to_{parameter}"


def _status_name(parameter: str) -> str:
    return f"derivative_status_{parameter}"


def asked_of(
    plan: Plan, parameters: Collection[str], requested: bool | tuple[str, ...] | None, cells: int
) -> Asked | None:
    """Return the derivatives that a study asks for by its key `sensitivities`, None for none.

    Raises `StudyError` with every problem.
    """
    if not requested:
        return None
    outputs = tuple(name for name in plan.outputs if QUANTITIES[name].is_derived)
    derived_plan = plan.part(outputs)  # a parameter of a verdict alone moves no output
    derivable = [
        name
        for name in (*derived_plan.parameters, *derived_plan.defaults)
        if QUANTITIES[name].parameter
    ]
    names = (
        requested
        if isinstance(requested, tuple)
        else tuple(name for name in parameters if name in derivable)
    )
    faults = [
        (f"no requested output depends on '{name[:60]}', which sensitivities names",
         suggestion(name, derivable))
        for name in names
        if name not in derivable
    ]  # fmt: skip
    if not outputs:
        faults.append(
            (
                "no requested output has a derivative",
                "Remove sensitivities, or request another output",
            )
        )
    values = cells * len(outputs) * len(names)
    if values > MAX_DERIVED:
        faults.append(
            (
                f"the study asks for {values:,} derivatives, at most {MAX_DERIVED:,} are allowed",
                "Reduce the cells, the outputs or the parameters in sensitivities",
            )
        )
    raise_any(Problem(SECTION, *texts) for texts in faults)
    return Asked(outputs, names)


def cells_of(plan: Plan, grid: Grid) -> dict[str, NDArray[np.float64]]:
    """Return the parameters of a plan at every cell of a grid, SI units, shape (cells,)."""
    values, shape = grid.si(), tuple(grid.shape.values())
    return {name: np.broadcast_to(values[name], shape).ravel() for name in plan.parameters}


def _per(output: str, parameter: str) -> str:
    units = "" if QUANTITIES[output].unit == "1" else QUANTITIES[output].unit
    for unit, power in re.findall(r"([A-Za-z]+)(-?\d+)?", QUANTITIES[parameter].unit):
        inverse = -int(power or 1)
        units += f" {unit}" if inverse == 1 else f" {unit}{inverse}"
    return units.strip() or "1"
