"""Derivatives as variables of a result: what is asked for, names, units, labels."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import TableVariable, flag_attributes
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.flags import DERIVATIVE_STATUSES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.suggestions import suggestion

if TYPE_CHECKING:
    from vibrafeed.core.plan.differences import Derivatives
    from vibrafeed.core.plan.grid import Grid

SECTION = "sensitivities"
MAX_DERIVED = 2_000_000
"""Most derivatives of a study: cells times outputs times parameters."""

Dims = Mapping[str, tuple[str, ...]]
"""The axes of each variable."""

_FACTOR = re.compile(r"([A-Za-z]+)(-?\d+)?")


@dataclass(frozen=True)
class Asked:
    """The derivatives that a study asks for.

    Attributes
    ----------
    outputs : tuple of str
        The outputs that are derived.
    parameters : tuple of str
        The parameters by which they are derived.
    """

    outputs: tuple[str, ...]
    parameters: tuple[str, ...]

    @property
    def passes(self) -> int:
        """The number of times that a cell is computed: usually four for each parameter, and one."""
        return 1 + 4 * len(self.parameters)

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable that the asked derivatives add to a result, by name, in order.

        For each parameter and output there are a derivative, its error, and an elasticity (per cent
        per cent, unit 1); for each parameter a status, which tells where there is no derivative.
        """
        units = {}
        for parameter in self.parameters:
            for output in self.outputs:
                units[derivative_name(output, parameter)] = _per(output, parameter)
                units[error_name(output, parameter)] = _per(output, parameter)
                units[elasticity_name(output, parameter)] = "1"
            units[status_name(parameter)] = "1"
        return units

    def dims(self, grid: Grid, depends: Mapping[str, frozenset[str]]) -> dict[str, tuple[str, ...]]:
        """Return the names of the axes of each variable that the asked derivatives add to a result.

        A derivative has the axes of its output, a status those of all outputs. `depends` has the
        axes on which each quantity of the plan depends.
        """
        every = grid.dims(frozenset().union(*(depends[name] for name in self.outputs)))
        dims = dict.fromkeys(self.units, every)
        for output in self.outputs:
            for parameter in self.parameters:
                for name in (derivative_name, error_name, elasticity_name):
                    dims[name(output, parameter)] = grid.dims(depends[output])
        return dims

    def arrays(
        self, plan: Plan, grid: Grid, dims: Dims, derivatives: Derivatives
    ) -> dict[str, NDArray[Any]]:
        """Return each variable of the asked derivatives over its axes, in the units of files.

        `derivatives` has every cell of the grid, by output and parameter; `dims` has the axes of
        each variable. The status of a parameter is the worst of all outputs.
        """
        shape = tuple(grid.shape.values())
        values: dict[str, Any] = {**plan.defaults, **grid.si()}
        arrays: dict[str, NDArray[Any]] = {}

        def squeezed(name: str, values: NDArray[Any]) -> NDArray[Any]:
            kept = tuple(slice(None) if axis in dims[name] else 0 for axis in grid.axes)
            return values.reshape(shape)[kept]

        for parameter in self.parameters:
            at = np.broadcast_to(values[parameter], shape).ravel()
            derived = [derivatives[output, parameter] for output in self.outputs]
            for output, derivative in zip(self.outputs, derived, strict=True):
                name = derivative_name(output, parameter)
                arrays[name] = squeezed(name, derivative.slope * _factor(output, parameter))
                name = error_name(output, parameter)
                arrays[name] = squeezed(name, derivative.error * _factor(output, parameter))
                name = elasticity_name(output, parameter)
                arrays[name] = squeezed(name, derivative.logarithmic(at))
            name = status_name(parameter)
            worst = np.maximum.reduce([derivative.status for derivative in derived])
            arrays[name] = squeezed(name, worst)
        return arrays

    def variables(self, dims: Dims, arrays: Mapping[str, NDArray[Any]]) -> dict[str, TableVariable]:
        """Return the variables of derivatives for a result by name: axes, values, attributes.

        `dims` has the axes of each, `arrays` the values, both by name.
        """
        labels: dict[str, dict[str, Any]] = {}
        for parameter in self.parameters:
            by = QUANTITIES[parameter].label.lower()
            for output in self.outputs:
                of = QUANTITIES[output].label
                about = {"output": output, "parameter": parameter}
                labels[derivative_name(output, parameter)] = {
                    "units": _per(output, parameter),
                    "long_name": f"Derivative of {in_sentence(of)} by {by}",
                    "comment": f"d({output})/d({parameter}); NaN where "
                    f"{status_name(parameter)} says why there is none.",
                    **about,
                }
                labels[error_name(output, parameter)] = {
                    "units": _per(output, parameter),
                    "long_name": f"Error of the derivative of {in_sentence(of)} by {by}",
                    "comment": "An estimate, from differences over a step and over half of it.",
                    **about,
                }
                labels[elasticity_name(output, parameter)] = {
                    "units": "1",
                    "long_name": f"Sensitivity of {in_sentence(of)} to {by}",
                    "comment": f"d ln({output})/d ln({parameter}).",
                    **about,
                }
            labels[status_name(parameter)] = flag_attributes(
                "motion_status", DERIVATIVE_STATUSES, tuple(DERIVATIVE_STATUSES)
            ) | {"long_name": f"Status of the derivatives by {by}"}
        return {
            name: TableVariable(dims[name], arrays[name], told) for name, told in labels.items()
        }


def derivative_name(output: str, parameter: str) -> str:
    """Return the name of the derivative of an output by a parameter."""
    return f"derivative_{output}_by_{parameter}"


def error_name(output: str, parameter: str) -> str:
    """Return the name of the error of a derivative."""
    return f"{derivative_name(output, parameter)}_error"


def elasticity_name(output: str, parameter: str) -> str:
    """Return the name of the elasticity of an output to a parameter."""
    return f"sensitivity_{output}_to_{parameter}"


def status_name(parameter: str) -> str:
    """Return the name of the status of the derivatives by a parameter."""
    return f"derivative_status_{parameter}"


def is_status(name: str) -> bool:
    """True if a variable is the status of derivatives."""
    return name.startswith("derivative_status_")


def asked_of(
    plan: Plan, parameters: Collection[str], wish: bool | tuple[str, ...] | None, cells: int
) -> Asked | None:
    """Return the derivatives that a study asks for; None if it asks for none.

    Parameters
    ----------
    plan : Plan
        That of the study.
    parameters : collection of str
        The parameters that the study gives.
    wish : bool or tuple of str or None
        The key `sensitivities` of the study.
    cells : int
        Cells of its grid.

    Raises
    ------
    StudyError
        With every problem.
    """
    if not wish:
        return None
    outputs = tuple(name for name in plan.outputs if QUANTITIES[name].is_derived)
    part = plan.part(outputs)  # a parameter of a verdict alone moves no output
    known = [name for name in (*part.parameters, *part.defaults) if QUANTITIES[name].parameter]
    names = wish if isinstance(wish, tuple) else tuple(name for name in parameters if name in known)
    problems = [
        Problem(
            SECTION,
            f"no requested output depends on '{name[:60]}', which sensitivities names",
            suggestion(name, known),
        )
        for name in names
        if name not in known
    ]
    if not outputs:
        message = "none of the requested outputs is a number with a derivative"
        problems.append(
            Problem(SECTION, message, "Leave out sensitivities, or request another output")
        )
    values = cells * len(outputs) * len(names)
    if values > MAX_DERIVED:
        message = f"it asks for {values:,} derivatives and allows {MAX_DERIVED:,}"
        fix = "Give fewer cells, outputs or names of parameters"
        problems.append(Problem(SECTION, message, fix))
    if problems:
        raise StudyError(problems)
    return Asked(outputs, names)


def cells_of(plan: Plan, grid: Grid) -> dict[str, NDArray[np.float64]]:
    """Return the parameters of a plan at every cell of a grid, SI units, shape (cells,)."""
    shape = tuple(grid.shape.values())
    values = grid.si()
    return {name: np.broadcast_to(values[name], shape).ravel() for name in plan.parameters}


def _factor(output: str, parameter: str) -> float:
    factor = np.rad2deg(1.0) if QUANTITIES[output].is_angle else 1.0
    return float(factor * (np.deg2rad(1.0) if QUANTITIES[parameter].is_angle else 1.0))


def _per(output: str, parameter: str) -> str:
    factors = [] if QUANTITIES[output].unit == "1" else [QUANTITIES[output].unit]
    if QUANTITIES[parameter].unit != "1":
        for unit, power in _FACTOR.findall(QUANTITIES[parameter].unit):
            inverse = -int(power or 1)
            factors.append(unit if inverse == 1 else f"{unit}{inverse}")
    return " ".join(factors) or "1"
