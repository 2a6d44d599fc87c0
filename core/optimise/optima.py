"""Carrying out an optimisation: solve every design, check the answers."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.optimise.check import distinct_points, find_front, gap_of, knee, label
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optimisation import Optimisation
from vibrafeed.core.optimise.prepare import choose_problem_scene, prepare
from vibrafeed.core.optimise.problem import (
    LIMIT,
    MEAN_VELOCITIES,
    STATUS,
    Optima,
    OptimisationProblem,
    broken_names,
    cells_of,
    chosen_cells,
)
from vibrafeed.core.optimise.uncertain import OBJECTIVE, FreshEvaluation, evaluated_at_fresh_points
from vibrafeed.core.plan.differences import STEPS, derivatives, scale_of
from vibrafeed.core.plan.grid import Grid, from_si, spread
from vibrafeed.core.plan.pieces import Computed, Kind
from vibrafeed.core.plan.plan import plan_scene
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.optimise_study import (
    Limited,
    Maximise,
    OptimiseStudy,
    Pareto,
    Target,
)
from vibrafeed.core.watch import Watch

RETRIES = 8  # solutions with more nodes where fresh points break a limit
BLOCK_CELLS = 65_536  # optima that are computed at a time, which bounds the memory


def compute(prepared: Optimisation, watch: Watch) -> Computed:
    """Return every variable of the optima of a study over its designs, in the units of studies.

    Designs are solved in blocks that fit the memory. `watch` takes the progress and may stop the
    search: the rest then has the status that it was not computed.
    """
    all_designs = designs_of(prepared.problem, prepared.designs)
    cells = prepared.designs.cells
    designs_at_a_time = max(1, BLOCK_CELLS * cells // prepared.cells)
    blocks, message = [], ""
    for start in range(0, cells, designs_at_a_time):
        design = chosen_cells(all_designs, slice(start, start + designs_at_a_time))
        block, message = _solve_designs(
            prepared, design, watch.part(cells_of(design) / cells), RETRIES
        )
        blocks.append(block)
    shape = tuple(prepared.grid.shape.values())
    arrays = {
        name: np.concatenate([block[name] for block in blocks]).reshape(shape)
        for name in prepared.units
    }
    return Computed(arrays, {"method_message": message} if message else {})


def _solve_designs(
    prepared: Optimisation, design: Mapping[str, Array], watch: Watch, retries: int
) -> tuple[dict[str, NDArray[Any]], str]:
    # The variables of the result by name, and the message of the method.
    problem, method = prepared.problem, prepared.method
    scales = problem.scales(design)
    if isinstance(problem.criterion, Pareto):
        return _solve_fronts(prepared, problem.criterion, design, scales, watch)
    optima = METHODS[method].solve(problem, design, scales, watch)
    optima = replace(optima, x=problem.with_whole_counts(optima.x))
    if problem.uncertain is None:
        return checked(prepared, optima, design, scales), optima.says
    tolerance = METHODS[method].tolerance
    fresh = evaluated_at_fresh_points(problem, optima.x, design, scales, tolerance)
    broken, nodes = fresh.worse_than_nodes(problem, optima.x, design, scales)
    # Fresh points that are worse become nodes, and the design is solved again with them.
    if not retries:
        status = np.where(broken, np.int8(STATUS["infeasible"]), optima.status)
        optima, nodes = replace(optima, x=np.where(broken, np.nan, optima.x), status=status), {}
    if not nodes and retries < RETRIES:
        # The optimum was chosen by the points that became nodes: judge it at others.
        fresh = evaluated_at_fresh_points(problem, optima.x, design, scales, tolerance, number=2)
    solved_again = {}
    for cell, points in nodes.items():
        single_design = chosen_cells(design, [cell])
        solved_again[cell] = _solve_designs(
            prepared.with_nodes(points), single_design, watch.part(0.0), retries - 1
        )
    if len(solved_again) == optima.status.size == 1:
        return solved_again[0]
    arrays = {
        name: values.copy()
        for name, values in checked(prepared, optima, design, scales, fresh).items()
    }
    for cell, (solved, _) in solved_again.items():
        for name, values in solved.items():
            arrays[name][cell] = values[0]
    return arrays, optima.says


def _solve_fronts(
    prepared: Optimisation,
    criterion: Pareto,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> tuple[dict[str, NDArray[Any]], str]:
    problem, points = prepared.problem, criterion.points
    optima = find_front(problem, design, scales, prepared.method, watch)
    optima = replace(optima, x=problem.with_whole_counts(optima.x))
    position = np.arange(optima.status.size)
    repeats = (optima.x == np.roll(optima.x, 1, axis=1)).all(axis=0) & (position % points > 0)
    # Equal points that follow one another are checked once.
    distinct = np.flatnonzero(~repeats)
    arguments = chosen_cells(design, distinct // points), chosen_cells(scales, distinct // points)
    arrays = checked(prepared, optima.chosen(distinct), *arguments)
    arrays = {name: values[np.cumsum(~repeats) - 1] for name, values in arrays.items()}
    names = (criterion.output, criterion.against)
    output, other = (arrays[name].reshape(-1, points) for name in names)
    count = distinct_points(output, other, [scales[name][:, None] for name in names])
    arrays["knee"] = knee(output, other).ravel()
    arrays["front_points"] = np.repeat(count, points)
    return arrays, optima.says


def designs_of(problem: OptimisationProblem, grid: Grid) -> dict[str, Array]:
    """Return the fixed parameters of every design in SI units, each of shape (cells,), by name.

    A design is a point of the grid. The limit that the criterion sets on the other output is among
    them; infinite without one.
    """
    shape, criterion = tuple(grid.shape.values()), problem.criterion
    limit = criterion.limit if isinstance(criterion, Limited) else np.inf
    design = {
        name: np.broadcast_to(values, shape).reshape(-1) for name, values in grid.si().items()
    }
    return {**design, LIMIT: np.full(grid.cells, limit)}


# --- what is told of the optima


FORWARD = ("acceleration_x", "starting_acceleration", *MEAN_VELOCITIES)
"""Outputs that are forward motion where they are positive."""

FLAT = 1e-14  # of the objective's scale: a smaller difference of all choices is rounding
MISSED = 1e-6  # of the objective's scale: a larger gap means that the method missed the optimum
AT_BOUND = 1e-9  # of a variable's range: it lies on its bound


def checked(
    prepared: Optimisation,
    optima: Optima,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    fresh: FreshEvaluation | None = None,
) -> dict[str, NDArray[Any]]:
    """Return every variable of an optimisation's result, checked against other methods."""
    problem, tolerance = prepared.problem, METHODS[prepared.method].tolerance
    cells = optima.status.shape
    without_optimum: NDArray[np.bool_] = np.asarray(np.isnan(optima.x).any(axis=0))
    # Without an optimum the outputs are those of the lower bounds, and left out below.
    x = np.where(without_optimum, problem.lower[:, None], optima.x)
    longest = problem.longer()
    quantities = longest.quantities(x, design)
    size = problem.scale(scales)

    def masked(values: Array) -> Array:
        return np.where(without_optimum, np.nan, np.broadcast_to(values, cells))

    if problem.uncertain is None:
        value = masked(problem.objective(quantities))
    else:
        value = masked(longest.judged(x, design, scales)[0])
    if optima.value is not None:
        # At the edge of stick the outputs are those of a part at rest.
        value = np.where(optima.status == STATUS["not_attained"], optima.value, value)
    objective, speed = value, problem.output(problem.criterion.output, quantities)
    if fresh is not None and problem.is_sampled:
        objective = masked(fresh.objective.value)
    elif fresh is not None:
        # In a worst case the least over the nodes and over the fresh points, of which the worst are
        # evaluated once more: means of a motion that does not repeat differ by chance.
        at_worst = longest.quantities(x, {**design, **fresh.at_worst(OBJECTIVE)})
        objective = masked(np.fmin(value, np.min(longest.objective(at_worst), axis=0)))
    if fresh is not None and isinstance(problem.criterion, Maximise):
        speed = objective
    status = _refined_status(problem, optima.status, quantities, design, scales, speed)
    arrays: dict[str, NDArray[Any]] = {
        f"best_{name}": from_si(name, optima.x[index]) for index, name in enumerate(problem.names)
    }
    arrays["objective"] = problem.sign * objective
    arrays |= {
        name: masked(problem.output(name, quantities))
        for name in prepared.units
        if name in quantities
    }
    margin_tolerances = {name: tolerance * scale for name, scale in scales.items()}
    arrays |= _margins_and_bindings(problem, fresh, x, design, margin_tolerances, without_optimum)
    arrays |= _at_bounds(problem, x, without_optimum, max(tolerance, AT_BOUND))
    gap_problem, gap_design = _of_each_front_point(problem, quantities, design)
    gap = gap_of(prepared.method, gap_problem, value, without_optimum, gap_design, scales) / size
    arrays["optimum_gap"] = gap
    allowed_gap = np.full(cells, max(tolerance, MISSED))
    if problem.states_error:
        # The larger error of short and long runs: the optimum was the best of the short ones.
        chance_errors = (each.judged(x, design, scales)[2] for each in (problem, longest))
        chance_error = masked(np.maximum(*chance_errors))
        arrays["objective_error"] = np.fmax(masked(problem.error(quantities)), chance_error)
        allowed_gap = np.fmax(allowed_gap, chance_error / size)
    if fresh is not None and problem.is_sampled:
        # The error of the motion at each of the points, and that of the points.
        error = fresh.objective.error + arrays.get("objective_error", 0.0)
        arrays["objective_error"] = np.where(without_optimum, np.nan, error)
        arrays["objective_left_out"] = np.where(without_optimum, np.nan, fresh.left_out)
    is_checked = np.isin(status, (STATUS["optimal"], STATUS["target_missed"]))
    arrays["evaluations"] = np.broadcast_to(np.asarray(optima.evaluations, np.float64), cells)
    if prepared.study.sensitivities:
        arrays |= slopes(problem, x, design, margin_tolerances, without_optimum)
    arrays["optimum_status"] = np.where(
        is_checked & (gap > allowed_gap), np.int8(STATUS["suboptimal"]), status
    )
    not_assessed = np.int8(REGIMES["not_assessed"].value)
    for name, regime in problem.regimes(quantities, scales, tolerance).items():
        arrays[name] = np.where(without_optimum, not_assessed, np.broadcast_to(regime, cells))
    return arrays


def _margins_and_bindings(
    problem: OptimisationProblem,
    fresh: FreshEvaluation | None,
    x: Array,
    design: Mapping[str, Array],
    margin_tolerances: Mapping[str, Array],
    without_optimum: NDArray[np.bool_],
) -> dict[str, NDArray[Any]]:
    # Of each constraint: its margin, whether it binds, and how probably it is broken.
    arrays: dict[str, NDArray[Any]] = {}
    for constraint in problem.constraints:
        margin = np.broadcast_to(problem.safe_margin(constraint, x, design), without_optimum.shape)
        binds = (np.abs(margin) <= margin_tolerances[constraint.output]) & ~without_optimum
        if fresh is not None:
            margin = np.fmin(margin, fresh.worst[constraint.name])
            for name, estimate in zip(
                broken_names(constraint.name), fresh.broken[constraint.name], strict=True
            ):
                arrays[name] = np.where(without_optimum, np.nan, estimate)
        margin = np.where(np.abs(margin) <= margin_tolerances[constraint.output], 0.0, margin)
        arrays[f"margin_{constraint.name}"] = np.where(without_optimum, np.nan, margin)
        arrays[f"binds_{constraint.name}"] = binds.astype(np.int8)
    return arrays


def _at_bounds(
    problem: OptimisationProblem, x: Array, without_optimum: NDArray[np.bool_], tolerance: float
) -> dict[str, NDArray[np.int8]]:
    span = problem.upper - problem.lower
    arrays = {}
    for index, name in enumerate(problem.names):
        for end, bound in (("lower", problem.lower[index]), ("upper", problem.upper[index])):
            binds = (np.abs(x[index] - bound) <= tolerance * span[index]) & ~without_optimum
            arrays[f"binds_{name}_{end}"] = binds.astype(np.int8)
    return arrays


def _refined_status(
    problem: OptimisationProblem,
    status: NDArray[np.int8],
    quantities: dict[str, Any],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    speed: Array,
) -> NDArray[np.int8]:
    optimal = status == STATUS["optimal"]
    if problem.sign > 0 and problem.criterion.output in FORWARD:
        rests = ~(np.broadcast_to(speed, status.shape) > 0)
        status = np.where(optimal & rests, STATUS["no_motion"], status)
        if problem.states_error:  # a mean velocity, which may be a negative one
            moves_backwards = speed < -problem.error(quantities)
            status = np.where(optimal & moves_backwards, STATUS["only_backward"], status)
    if np.any(optimal) and not problem.is_motion:
        lower, upper = problem.lower[:, None, None], problem.upper[:, None, None]
        x = lower + (upper - lower) * spread(16, len(problem.names))[:, None, :]
        designs = {name: values[:, None] for name, values in design.items()}
        values = problem.objective(problem.quantities(x, designs))
        values = np.broadcast_to(values, (status.size, 16))
        best = np.broadcast_to(problem.objective(quantities), status.shape)
        range_of_values = np.maximum(values.max(axis=1), best) - np.minimum(
            values.min(axis=1), best
        )
        is_flat = range_of_values <= FLAT * problem.scale(scales)
        status = np.where(optimal & is_flat & (status == STATUS["optimal"]), STATUS["flat"], status)
    if isinstance(problem.criterion, Target) and problem.uncertain is None:
        value = problem.output(problem.criterion.output, quantities)
        # Within a thousandth it counts as reached.
        missed = ~np.isclose(value, problem.criterion.target, rtol=1e-3, atol=1e-9)
        status = np.where((status == STATUS["optimal"]) & missed, STATUS["target_missed"], status)
    return np.asarray(status, dtype=np.int8)


def _of_each_front_point(
    problem: OptimisationProblem, quantities: dict[str, Any], design: Mapping[str, Array]
) -> tuple[OptimisationProblem, Mapping[str, Array]]:
    if not isinstance(problem.criterion, Pareto):
        return problem, design
    other = np.abs(problem.output(problem.criterion.against, quantities))
    return problem.limited(), {**design, LIMIT: np.broadcast_to(other, design[LIMIT].shape)}


def slopes(
    problem: OptimisationProblem,
    x: Array,
    design: Mapping[str, Array],
    margin_tolerances: Mapping[str, Array],
    without_optimum: NDArray[np.bool_],
) -> dict[str, Array]:
    """Return the elasticities d ln(output)/d ln(parameter) of the objective's output at optima.

    They tell a user which parameter matters at the optimum. The names are
    ``sensitivity_<parameter>``, the values arrays (cells,), from differences inside one regime; at
    a kink on the border of what limits and bounds allow from inside. NaN where there is none: at
    another kink, a jump, and for a parameter or an output that is 0. 0 for a variable that the
    output does not depend on. `x` are the optima; margins below `margin_tolerances` count as none.
    """
    output = problem.criterion.output
    needed = problem.plan.only(output).parameters
    solved = np.flatnonzero(~without_optimum)
    parameters = {**design, **dict(zip(problem.names, x, strict=True))}
    parameters = {name: parameters[name][solved] for name in problem.plan.parameters}
    margin_tolerances = {
        name: cell_values[solved] for name, cell_values in margin_tolerances.items()
    }
    elasticities = {}
    for name in problem.sensitive:
        values = elasticities[f"sensitivity_{name}"] = np.where(without_optimum, np.nan, 0.0)
        if name not in needed or not solved.size:
            continue
        cells = {parameter: parameters[parameter] for parameter in needed}
        plan = plan_scene(problem.plan.scene, problem.plan.variant, (output,), cells)
        values[solved] = derivatives(plan, cells, (name,))[output, name].logarithmic(
            parameters[name]
        )
        at_kink = np.isnan(values[solved])
        if at_kink.any():
            at_kinks = chosen_cells(parameters, at_kink)
            tolerances = chosen_cells(margin_tolerances, at_kink)
            sides = {name: _feasible_side(problem, name, at_kinks, tolerances)}
            cells = chosen_cells(cells, at_kink)
            one_sided = derivatives(plan, cells, (name,), sides=sides)[output, name]
            values[solved[at_kink]] = one_sided.logarithmic(at_kinks[name])
    return elasticities


def _feasible_side(
    problem: OptimisationProblem,
    name: str,
    parameters: Mapping[str, Array],
    margin_tolerances: Mapping[str, Array],
) -> NDArray[np.int8]:
    # 1 or -1 where limits and bounds are kept above or below the parameter's value only, else 0.
    step = STEPS[0] * scale_of(name, parameters[name])
    side = np.zeros(step.shape, dtype=np.int8)
    for direction in (1, -1):
        moved = {**parameters, name: parameters[name] + direction * step}
        x = np.stack([moved[variable] for variable in problem.names])
        inside = ((x >= problem.lower[:, None]) & (x <= problem.upper[:, None])).all(axis=0)
        for constraint in problem.constraints:
            inside &= (
                problem.safe_margin(constraint, x, moved) >= -margin_tolerances[constraint.output]
            )
        side += direction * inside
    return side


KIND: Final = Kind(
    name="optimise",
    title="Find the best drive",
    description="Finds the best angles, or other parameters, of a drive for each of many designs.",
    model=OptimiseStudy,
    scenes=(SCENES, SYSTEMS),
    example={
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "criterion": {"kind": "maximise", "output": "acceleration_x"},
        "parameters": {"frequency": "50 Hz", "amplitude": "0.5 mm", "friction": 0.3},
    },
    prepare=prepare,
    choose=lambda sketch: choose_problem_scene(
        sketch.scene, sketch.variant, sketch.outputs, sketch.names
    ),
    compute=compute,
    label=label,
    choices=MappingProxyType({"method": tuple(METHODS)}),
)
