"""The problem that an optimiser solves, and the optima that it finds.

Candidates are arrays. The outputs come from the scene's own plan, as in a sweep.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import Motion
from vibrafeed.core.plan.grid import from_si
from vibrafeed.core.plan.plan import Plan, regimes, run_equations
from vibrafeed.core.quantities import OPTIMUM_STATUSES, QUANTITIES
from vibrafeed.core.study.distributions import Distribution
from vibrafeed.core.study.optimise_study import (
    Criterion,
    Limited,
    Minimise,
    Pareto,
    Target,
    Weighted,
)
from vibrafeed.core.watch import Watch

LIMIT = "limit"
"""Name of the limit of a criterion, and of its value among the arrays of a design."""

ROUNDING = 1e-15  # of an output's scale: a smaller violation of a limit may be rounding
UNKNOWN = 1e300  # stands for an unknown error: larger than any value, but finite

LONGEST = 1000.0
"""Times the periods over which a motion that does not repeat is followed: some fall into another
motion, far slower, after a hundred thousand periods only."""

SECOND: dict[str, str] = {
    f"oriented_feed_rate{end}": f"purity{end}" for end in ("", "_lower", "_upper")
}
"""Of choices that are as good by a maximised output, the output that decides between them: a line
that also lets wrong parts through gives no fewer right ones."""

MEAN_VELOCITIES = (
    "conveying_velocity", "velocity_x", "velocity_y", "velocity_towards", "travel_speed"
)  # fmt: skip
"""Outputs whose error is that of the motion's mean."""

TIE = 1e-12  # share of an output's scale within which choices are as good

Arrays = dict[str, Any]


@dataclass(frozen=True)
class OutputBound:
    """A bound that an output has to keep.

    Attributes
    ----------
    name, output : str
        Name of the constraint, and its output.
    bound : float or None
        The bound in the unit of studies; None if each design has its own (`design[LIMIT]`).
    upper : bool
        True for an upper bound, False for a lower one.
    absolute : bool
        True if the absolute value has to keep it.
    """

    name: str
    output: str
    bound: float | None
    upper: bool
    absolute: bool = False


How = Literal["worst", "mean", "quantile"]


@dataclass(frozen=True)
class Uncertain:
    """Parameters that are not known exactly, at the nodes at which candidates are judged.

    Attributes
    ----------
    distributions : mapping of str to Distribution
        Of each parameter.
    values : mapping of str to ndarray
        The parameters at the nodes, shape (nodes,), SI units.
    how : {"worst", "mean", "quantile"}
        What counts over the nodes.
    weights : ndarray, optional
        Of a mean that is no plain one.
    quantile : float
        Which quantile counts.
    in_statistic : int, optional
        The number of nodes, the first ones, that a mean or a quantile counts; constraints hold at
        all nodes. All of them if None.
    """

    distributions: Mapping[str, Distribution]
    values: Mapping[str, Array]
    how: How
    weights: Array | None = None
    quantile: float = 0.5
    in_statistic: int | None = None

    @property
    def size(self) -> int:
        """The number of nodes."""
        return next(iter(self.values.values())).size

    def with_nodes(self, values: Mapping[str, Array]) -> "Uncertain":
        """Return the same with further nodes after the others; `values` are theirs, SI units."""
        extended = {
            name: np.append(node_values, values[name]) for name, node_values in self.values.items()
        }
        return replace(self, values=extended)

    def statistic(self, values: Array, sign: float) -> Array:
        """Return the statistic of values over uncertain parameters: least, mean or quantile.

        `values` has the points of the uncertain parameters along its first axis, which is taken
        away. `sign` is -1 if the sign of the output was turned, as it is minimised.
        """
        values = values[: self.in_statistic]
        if self.how == "quantile":
            fraction = self.quantile if sign > 0 else 1 - self.quantile
            return np.asarray(np.quantile(values, fraction, axis=0))
        if self.how == "worst":
            return np.asarray(values.min(axis=0))
        if self.weights is None:
            return np.asarray(values.mean(axis=0))
        return np.asarray(np.tensordot(self.weights, values, axes=1))


@dataclass(frozen=True)
class OptimisationProblem:
    """The problem that an optimiser solves, for any number of designs at once.

    A design is a mapping of every fixed parameter (and of `limit`) to an array; all of them, and
    the candidates, broadcast.
    """

    plan: Plan
    bounds: Mapping[str, tuple[float, float]]
    """The lower and the upper end of each variable, SI units."""
    criterion: Criterion
    constraints: tuple[OutputBound, ...]
    uncertain: Uncertain | None = None
    """Parameters that are not known exactly, and what counts of an objective under them.

    Their values in a design are those that are meant; constraints hold at all nodes.
    """

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the variables."""
        return tuple(self.bounds)

    @cached_property
    def lower(self) -> Array:
        """The lower bounds, shape (variables,), SI units."""
        return np.array([lower for lower, _ in self.bounds.values()])

    @cached_property
    def upper(self) -> Array:
        """The upper bounds, shape (variables,), SI units."""
        return np.array([upper for _, upper in self.bounds.values()])

    def from_unit_box(self, unit: Array) -> Array:
        """Return points, shares of the bounds (variables, ...), in SI units; both ends exact."""
        ends = (-1, *[1] * (unit.ndim - 1))
        lower, upper = self.lower.reshape(ends), self.upper.reshape(ends)
        return np.where(unit == 1, upper, lower + unit * (upper - lower))

    @property
    def sign(self) -> float:
        """-1 if the criterion is minimised, as the distance from a target is; else 1."""
        return -1.0 if isinstance(self.criterion, Minimise | Target) else 1.0

    @property
    def against(self) -> str | None:
        """The output whose absolute value is to be small; None if there is none."""
        return getattr(self.criterion, "against", None)

    @property
    def weight(self) -> float:
        """The weight of the other output in the objective."""
        return self.criterion.weight if isinstance(self.criterion, Weighted) else 0.0

    @property
    def second(self) -> str | None:
        """The output that decides between choices that are as good; None if there is none."""
        second = SECOND.get(self.criterion.output)
        return second if self.criterion.kind == "maximise" and second in self.plan.outputs else None

    @cached_property
    def is_motion(self) -> bool:
        """True if the outputs are those of a simulated motion, which have jumps."""
        return any(equation.takes_long for equation in self.plan.equations)

    @cached_property
    def judged_outputs(self) -> tuple[str, ...]:
        """The outputs by which candidates are judged."""
        constrained = (constraint.output for constraint in self.constraints)
        names = (self.criterion.output, self.against, self.second, *constrained)
        return tuple(dict.fromkeys(name for name in names if name))

    @cached_property
    def sensitive(self) -> tuple[str, ...]:
        """The parameters by which a study with sensitivities derives the criterion's output."""
        parameters = self.plan.only(self.criterion.output).parameters
        return tuple(dict.fromkeys((*self.names, *parameters)))

    @cached_property
    def bare(self) -> Plan:
        """The plan without regimes and outputs that are only reported."""
        return self.plan.part(self.judged_outputs)

    def quantities(
        self,
        x: Array,
        design: Mapping[str, Array],
        watch: Watch | None = None,
        plan: Plan | None = None,
    ) -> Arrays:
        """Return every quantity at candidates by name, parameters and outputs, in SI units."""
        plan = plan or self.plan
        fixed = {name: design[name] for name in plan.parameters if name in design}
        variables = dict(zip(self.names, self.with_whole_counts(x), strict=True))
        return run_equations(plan, {**fixed, **variables}, watch)

    def with_whole_counts(self, x: Array) -> Array:
        """Return candidates, shape (variables, ...), with counts rounded to whole numbers."""
        counted = np.array([QUANTITIES[name].count for name in self.names])
        if not counted.any():
            return x
        return np.where(counted.reshape(-1, *[1] * (x.ndim - 1)), np.rint(x), x)

    def output(self, name: str, quantities: Arrays) -> Array:
        """Return an output in the unit of studies."""
        return np.asarray(from_si(name, np.asarray(quantities[name], dtype=np.float64)))

    def objective(self, quantities: Arrays) -> Array:
        """Return the value to maximise, in the unit of studies; NaN where an output has no value.

        It is the output, or its distance from the target, with its sign (minus to minimise it),
        less the weight times the size of the other output. `quantities` has all quantities at the
        candidates, SI units.
        """
        value = self.output(self.criterion.output, quantities)
        if isinstance(self.criterion, Target):
            value = np.abs(value - self.criterion.target)
        value = self.sign * value
        if self.weight and self.against:
            value = value - self.weight * np.abs(self.output(self.against, quantities))
        return value

    def objective_statistic(self, x: Array, design: Mapping[str, Array]) -> Array:
        """Return the objective of candidates, or its statistic; NaN where there is none."""
        if self.uncertain is None:
            return self.objective(self.quantities(x, design))
        design_at_nodes = self.at_nodes(design, x)
        values = self.objective(self.quantities(x, design_at_nodes))
        node_values = design_at_nodes[next(iter(self.uncertain.values))]
        values = np.broadcast_to(values, np.broadcast_shapes(values.shape, node_values.shape))
        without_value = np.isnan(values).any(axis=0)
        statistic = self.uncertain.statistic(np.where(without_value, 0.0, values), self.sign)
        return np.where(without_value, np.nan, statistic)

    def margin(
        self, constraint: OutputBound, quantities: Arrays, design: Mapping[str, Array]
    ) -> Array:
        """Return the distance of an output from its bound, below 0 where it is broken.

        In the unit of studies; `quantities` are the quantities at candidates, SI units.
        """
        value = self.output(constraint.output, quantities)
        bound = design[LIMIT] if constraint.bound is None else constraint.bound
        value = np.abs(value) if constraint.absolute else value
        return np.asarray(bound - value if constraint.upper else value - bound)

    def judged(
        self,
        x: Array,
        design: Mapping[str, Array],
        scales: Mapping[str, Array],
        watch: Watch | None = None,
    ) -> tuple[Array, Array, Array]:
        """Return objective, violation of the constraints and error of the objective of candidates.

        The violation is the sum of all over their scales; where an output has no value it is inf
        and the objective -inf: a NaN would end scipy's differential evolution. With uncertain
        parameters the objective is the statistic that the study asks for, and the largest violation
        and error count. All have the shape of the candidates and designs together.
        """
        if self.uncertain is not None:
            design = self.at_nodes(design, x)
        quantities = self.quantities(x, design, watch, self.bare)
        shape = np.broadcast_shapes(*(part.shape for part in (*x, *design.values())))
        value = np.broadcast_to(self.objective(quantities), shape)
        if self.second:
            value = value + TIE * scales[self.criterion.output] * np.nan_to_num(
                self.output(self.second, quantities)
            )
        violation = np.zeros(shape)
        for constraint in self.constraints:
            margin = self.margin(constraint, quantities, design)
            violation = violation + np.maximum(-margin, 0.0) / scales[constraint.output]
        without_value = np.isnan(value) | np.isnan(violation)
        value, violation = (
            np.where(without_value, -np.inf, value),
            np.where(without_value, np.inf, violation),
        )
        error = np.broadcast_to(self.chance_error(quantities), shape)
        if self.uncertain is None:
            return value, violation, error
        failed = np.isinf(value).any(axis=0)
        value = self.uncertain.statistic(np.where(failed, 0.0, value), self.sign)
        return np.where(failed, -np.inf, value), violation.max(axis=0), error.max(axis=0)

    @property
    def is_sampled(self) -> bool:
        """True if the objective is a statistic over points drawn from distributions."""
        return self.uncertain is not None and self.uncertain.how != "worst"

    @property
    def states_error(self) -> bool:
        """True if the output is a mean over a motion with a known error."""
        return self.is_motion and self.criterion.output in MEAN_VELOCITIES

    def longer(self, factor: float = LONGEST) -> "OptimisationProblem":
        """Return the problem with motions that do not repeat followed `factor` times as long.

        It is the problem itself if its outputs are closed forms, or if the method of motion has no
        limit of its own on the periods.
        """
        if not self.is_motion or "max_periods" not in self.plan.defaults:
            return self
        max_periods = factor * self.plan.defaults["max_periods"]
        plan = replace(self.plan, defaults={**self.plan.defaults, "max_periods": max_periods})
        return replace(self, plan=plan)

    def chance_error(self, quantities: Arrays) -> Array:
        """Return the statistical error of the objective at candidates, in the unit of studies.

        A motion that does not repeat is averaged over a limited time. It is 0 where it repeats, and
        `UNKNOWN` for other outputs than the mean velocity.
        """
        motion = quantities.get("motion")
        if not isinstance(motion, Motion):
            return np.zeros(())
        error = self.error(quantities) if self.states_error else UNKNOWN
        return np.where(motion.multiple == 0, error, 0.0)

    def error(self, quantities: Arrays) -> Array:
        """Return the stated error of the mean velocity, in the unit of studies."""
        error = quantities["motion"].error * quantities["velocity_scale"]
        return np.asarray(from_si(self.criterion.output, error))

    @property
    def nodes(self) -> int:
        """The values of uncertain parameters at which a candidate is judged."""
        return 1 if self.uncertain is None else self.uncertain.size

    def at_nodes(self, design: Mapping[str, Array], x: Array) -> dict[str, Array]:
        """Return designs with the nodes of the uncertain parameters added, along a new first axis.

        Only for a problem that has uncertain parameters.
        """
        assert self.uncertain is not None
        axes = max(x.ndim - 1, *(values.ndim for values in design.values()))
        nodes = self.uncertain.values.items()
        return {
            **design,
            **{name: node_values.reshape(-1, *(1,) * axes) for name, node_values in nodes},
        }

    def safe_margin(self, constraint: OutputBound, x: Array, design: Mapping[str, Array]) -> Array:
        """Return the margin of a constraint at candidates, the least one over uncertain parameters.

        `x` are candidates, SI units, shape (variables, ...), with which `design` broadcasts.
        """
        if self.uncertain is None:
            return self.margin(constraint, self.quantities(x, design), design)
        design_at_nodes = self.at_nodes(design, x)
        margins = self.margin(constraint, self.quantities(x, design_at_nodes), design_at_nodes)
        # Without a first axis over the nodes the output depends on no uncertain parameter.
        varies = margins.ndim == design_at_nodes[next(iter(self.uncertain.values))].ndim
        return np.asarray(margins.min(axis=0) if varies else margins)

    def scales(self, design: Mapping[str, Array]) -> dict[str, Array]:
        """Return the size of each output that takes part, in each design, shape (cells,), by name.

        It is the largest size over the corners and middles of the variables' bounds, or 1 where an
        output is 0 or has no value. Violations and gaps are divided by it, so that they can be
        compared and added.
        """
        fractions = np.array(list(product((0.0, 0.5, 1.0), repeat=len(self.names)))).T[:, None, :]
        x = self.lower[:, None, None] + (self.upper - self.lower)[:, None, None] * fractions
        cells = cells_of(design)
        quantities = self.quantities(x, columns(design), plan=self.bare)
        scales = {}
        for name in self.judged_outputs:
            sizes = np.abs(self.output(name, quantities))
            sizes = np.broadcast_to(sizes, np.broadcast_shapes(sizes.shape, (cells, 1)))
            largest = np.where(np.isfinite(sizes), sizes, 0.0).max(axis=1)
            scales[name] = np.where(largest > 0, largest, 1.0)
        return scales

    def scale(self, scales: Mapping[str, Array]) -> Array:
        """Return the scale of the objective, from those of the outputs, shape (cells,)."""
        scale = scales[self.criterion.output]
        return np.maximum(scale, self.weight * scales[self.against]) if self.against else scale

    def regimes(
        self, quantities: Arrays, scales: Mapping[str, Array], touching: float
    ) -> dict[str, NDArray[np.int8]]:
        """Return the number of the regime at each point by each verdict, as files write it.

        At an optimum on the verge of lift-off the normal acceleration is a rounding of either sign:
        a contact that is to be kept counts as kept if it is within `touching` times its size.
        """
        snapped = dict(quantities)
        for constraint in self.constraints:
            if constraint.name in CONTACT_OUTPUTS:
                value = np.asarray(quantities[constraint.output])
                is_touching = np.abs(value) <= touching * scales[constraint.output]
                snapped[constraint.output] = np.where(is_touching, np.finfo(np.float64).tiny, value)
        return regimes(self.plan, snapped)

    def limited(self) -> "OptimisationProblem":
        """Return the problem of a point of a front: an output with a limit of the other one."""
        criterion = self.criterion
        assert isinstance(criterion, Pareto | Limited | Weighted)
        inner = Limited(output=criterion.output, against=criterion.against, limit=0.0)
        others = tuple(constraint for constraint in self.constraints if constraint.name != LIMIT)
        limit = OutputBound(LIMIT, criterion.against, None, upper=True, absolute=True)
        return replace(self, criterion=inner, constraints=(limit, *others))


CONTACT_OUTPUTS: dict[str, str] = {
    "floor_contact": "normal_acceleration",
    "wall_contact": "wall_balance",
}
"""Contacts that a study may keep, and the output that is not negative then."""


def broken_names(constraint_name: str) -> tuple[str, str]:
    """Return the names of the probability that a constraint is broken, and of its error."""
    name = f"probability_{constraint_name}_broken"
    return name, f"{name}_error"


def cells_of(design: Mapping[str, Array]) -> int:
    """Return the number of designs."""
    return int(next(iter(design.values())).shape[0])


def columns(design: Mapping[str, Array]) -> dict[str, Array]:
    """Return a design of shape (cells,) as (cells, 1), for candidates along the last axis."""
    return {name: values[..., None] for name, values in design.items()}


def chosen_cells(design: Mapping[str, Array], cells: Any) -> dict[str, Array]:
    """Return a selection of the designs."""
    return {name: values[cells] for name, values in design.items()}


STATUS: Mapping[str, int] = {name: flag.value for name, flag in OPTIMUM_STATUSES.items()}
"""The value of each `OPTIMUM_STATUSES` entry."""


@dataclass(frozen=True)
class Optima:
    """The optima of every design; all arrays but `x` have the shape (cells,).

    Attributes
    ----------
    x : ndarray, shape (variables, cells)
        The best values, SI units; NaN where there are none.
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    value : ndarray or None
        The objective as the method computes it; None for that of the scene's outputs.
    evaluations : ndarray of int64 or int
        Number of points at which the outputs were computed.
    says : str
        The method's own message at the end.
    """

    x: Array
    status: NDArray[np.int8]
    value: Array | None = None
    evaluations: NDArray[np.int64] | int = 1
    says: str = ""

    def chosen(self, cells: NDArray[np.intp]) -> "Optima":
        """Return the optima at some positions."""
        value = None if self.value is None else self.value[cells]
        evaluations = np.broadcast_to(self.evaluations, self.status.shape)[cells]
        return Optima(self.x[:, cells], self.status[cells], value, evaluations, self.says)


Solver = Callable[[OptimisationProblem, Mapping[str, Array], Mapping[str, Array], Watch], Optima]
"""Takes problem, designs (arrays of shape (cells,)), scales of the outputs, and a watch."""


def statuses_of(value: Array, violation: Array, tolerance: float = 0.0) -> NDArray[np.int8]:
    """Return the status of best points: optimal, infeasible, or without a value, shape (cells,).

    `value` are their objectives; `violation` their violations of constraints, which `tolerance`
    allows.
    """
    status = np.where(np.isfinite(violation), STATUS["infeasible"], STATUS["no_value"])
    is_optimal = (violation <= tolerance) & np.isfinite(value)
    return np.where(is_optimal, STATUS["optimal"], status).astype(np.int8)
