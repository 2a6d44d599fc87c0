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
from vibrafeed.core.optimise.uncertain import OBJECTIVE, Afresh, judged_afresh
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
    everything = designs_of(prepared.problem, prepared.designs)
    cells = prepared.designs.cells
    step = max(1, BLOCK_CELLS * cells // prepared.cells)
    blocks, says = [], ""
    for start in range(0, cells, step):
        design = chosen_cells(everything, slice(start, start + step))
        block, says = _solved(prepared, design, watch.part(cells_of(design) / cells), RETRIES)
        blocks.append(block)
    shape = tuple(prepared.grid.shape.values())
    arrays = {
        name: np.concatenate([block[name] for block in blocks]).reshape(shape)
        for name in prepared.units
    }
    return Computed(arrays, {"method_message": says} if says else {})


def _solved(
    prepared: Optimisation, design: Mapping[str, Array], watch: Watch, retries: int
) -> tuple[dict[str, NDArray[Any]], str]:
    problem, method = prepared.problem, prepared.method
    scales = problem.scales(design)
    if isinstance(problem.criterion, Pareto):
        return _fronts(prepared, problem.criterion, design, scales, watch)
    optima = METHODS[method].solve(problem, design, scales, watch)
    optima = replace(optima, x=problem.whole(optima.x))
    if problem.uncertain is None:
        return checked(prepared, optima, design, scales), optima.says
    tolerance = METHODS[method].tolerance
    fresh = judged_afresh(problem, optima.x, design, scales, tolerance)
    broken, nodes = fresh.surprises(problem, optima.x, design, scales)
    if not retries:
        status = np.where(broken, np.int8(STATUS["infeasible"]), optima.status)
        optima, nodes = replace(optima, x=np.where(broken, np.nan, optima.x), status=status), {}
    if not nodes and retries < RETRIES:
        # The points that have become nodes favour the answer, as those of a search do.
        fresh = judged_afresh(problem, optima.x, design, scales, tolerance, number=2)
    again = {}
    for cell, points in nodes.items():
        one = chosen_cells(design, [cell])
        again[cell] = _solved(prepared.with_nodes(points), one, watch.part(0.0), retries - 1)
    if len(again) == optima.status.size == 1:
        return again[0]
    arrays = {n: one.copy() for n, one in checked(prepared, optima, design, scales, fresh).items()}
    for cell, (solved, _) in again.items():
        for name, values in solved.items():
            arrays[name][cell] = values[0]
    return arrays, optima.says


def _fronts(
    prepared: Optimisation,
    criterion: Pareto,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> tuple[dict[str, NDArray[Any]], str]:
    problem, points = prepared.problem, criterion.points
    optima = find_front(problem, design, scales, prepared.method, watch)
    optima = replace(optima, x=problem.whole(optima.x))
    number = np.arange(optima.status.size)
    repeated = (optima.x == np.roll(optima.x, 1, axis=1)).all(axis=0) & (number % points > 0)
    once = np.flatnonzero(~repeated)
    each = chosen_cells(design, once // points), chosen_cells(scales, once // points)
    arrays = checked(prepared, optima.chosen(once), *each)
    arrays = {name: values[np.cumsum(~repeated) - 1] for name, values in arrays.items()}
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
    design = {name: np.broadcast_to(one, shape).reshape(-1) for name, one in grid.si().items()}
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
    fresh: Afresh | None = None,
) -> dict[str, NDArray[Any]]:
    """Return every variable of an optimisation's result, checked against other methods."""
    problem, tolerance = prepared.problem, METHODS[prepared.method].tolerance
    cells = optima.status.shape
    lost: NDArray[np.bool_] = np.asarray(np.isnan(optima.x).any(axis=0))
    # Without an optimum the outputs are those of the lower bounds, and left out below.
    x = np.where(lost, problem.lower[:, None], optima.x)
    longest = problem.longer()
    known = longest.known(x, design)
    size = problem.scale(scales)

    def whole(values: Array) -> Array:
        return np.where(lost, np.nan, np.broadcast_to(values, cells))

    if problem.uncertain is None:
        value = whole(problem.objective(known))
    else:
        value = whole(longest.judged(x, design, scales)[0])
    if optima.value is not None:
        # At the edge of stick the outputs are those of a part at rest.
        value = np.where(optima.status == STATUS["not_attained"], optima.value, value)
    objective, forward = value, problem.output(problem.criterion.output, known)
    if fresh is not None and problem.is_sampled:
        objective = whole(fresh.objective.value)
    elif fresh is not None:
        # In a worst case the least over the nodes and over the fresh points, of which the worst are
        # evaluated once more: means of a motion that does not repeat differ by chance.
        again = longest.known(x, {**design, **fresh.at_worst(OBJECTIVE)})
        objective = whole(np.fmin(value, np.min(longest.objective(again), axis=0)))
    if fresh is not None and isinstance(problem.criterion, Maximise):
        forward = objective
    status = _status(problem, optima.status, known, design, scales, forward)
    arrays: dict[str, NDArray[Any]] = {
        f"best_{name}": from_si(name, optima.x[i]) for i, name in enumerate(problem.names)
    }
    arrays["objective"] = problem.sign * objective
    arrays |= {n: whole(problem.output(n, known)) for n in prepared.units if n in known}
    close = {name: tolerance * scale for name, scale in scales.items()}
    arrays |= _limits(problem, fresh, x, design, close, lost)
    arrays |= _at_bounds(problem, x, lost, max(tolerance, AT_BOUND))
    here, near = _of_each_point(problem, known, design)
    gap = gap_of(prepared.method, here, value, lost, near, scales) / size
    arrays["optimum_gap"] = gap
    left_open = np.full(cells, max(tolerance, MISSED))
    if problem.states_error:
        # Chance is taken as large as the shorter runs show it, of which this one was the best.
        doubts = (one.judged(x, design, scales)[2] for one in (problem, longest))
        unsure = whole(np.maximum(*doubts))
        arrays["objective_error"] = np.fmax(whole(problem.error(known)), unsure)
        left_open = np.fmax(left_open, unsure / size)
    if fresh is not None and problem.is_sampled:
        # The error of the motion at each of the points, and that of the points.
        error = fresh.objective.error + arrays.get("objective_error", 0.0)
        arrays["objective_error"] = np.where(lost, np.nan, error)
        arrays["objective_left_out"] = np.where(lost, np.nan, fresh.left_out)
    found = np.isin(status, (STATUS["optimal"], STATUS["target_missed"]))
    arrays["evaluations"] = np.broadcast_to(np.asarray(optima.evaluations, np.float64), cells)
    if prepared.study.sensitivities:
        arrays |= slopes(problem, x, design, close, lost)
    arrays["optimum_status"] = np.where(
        found & (gap > left_open), np.int8(STATUS["suboptimal"]), status
    )
    none = np.int8(REGIMES["not_assessed"].value)
    for name, regime in problem.regimes(known, scales, tolerance).items():
        arrays[name] = np.where(lost, none, np.broadcast_to(regime, cells))
    return arrays


def _limits(
    problem: OptimisationProblem,
    fresh: Afresh | None,
    x: Array,
    design: Mapping[str, Array],
    close: Mapping[str, Array],
    lost: NDArray[np.bool_],
) -> dict[str, NDArray[Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    for kept in problem.kept:
        margin = np.broadcast_to(problem.safe_margin(kept, x, design), lost.shape)
        binds = (np.abs(margin) <= close[kept.output]) & ~lost
        if fresh is not None:
            margin = np.fmin(margin, fresh.worst[kept.name])
            for name, one in zip(broken_names(kept.name), fresh.broken[kept.name], strict=True):
                arrays[name] = np.where(lost, np.nan, one)
        margin = np.where(np.abs(margin) <= close[kept.output], 0.0, margin)
        arrays[f"margin_{kept.name}"] = np.where(lost, np.nan, margin)
        arrays[f"binds_{kept.name}"] = binds.astype(np.int8)
    return arrays


def _at_bounds(
    problem: OptimisationProblem, x: Array, lost: NDArray[np.bool_], tolerance: float
) -> dict[str, NDArray[np.int8]]:
    span = problem.upper - problem.lower
    arrays = {}
    for i, name in enumerate(problem.names):
        for end, bound in (("lower", problem.lower[i]), ("upper", problem.upper[i])):
            at = (np.abs(x[i] - bound) <= tolerance * span[i]) & ~lost
            arrays[f"binds_{name}_{end}"] = at.astype(np.int8)
    return arrays


def _status(
    problem: OptimisationProblem,
    status: NDArray[np.int8],
    known: dict[str, Any],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    forward: Array,
) -> NDArray[np.int8]:
    optimal = status == STATUS["optimal"]
    if problem.sign > 0 and problem.criterion.output in FORWARD:
        rests = ~(np.broadcast_to(forward, status.shape) > 0)
        status = np.where(optimal & rests, STATUS["no_motion"], status)
        if problem.states_error:  # a mean velocity, which may be a negative one
            back = forward < -problem.error(known)
            status = np.where(optimal & back, STATUS["only_backward"], status)
    if np.any(optimal) and not problem.is_motion:
        lower, upper = problem.lower[:, None, None], problem.upper[:, None, None]
        x = lower + (upper - lower) * spread(16, len(problem.names))[:, None, :]
        column = {name: values[:, None] for name, values in design.items()}
        values = problem.objective(problem.known(x, column))
        values = np.broadcast_to(values, (status.size, 16))
        best = np.broadcast_to(problem.objective(known), status.shape)
        apart = np.maximum(values.max(axis=1), best) - np.minimum(values.min(axis=1), best)
        flat = apart <= FLAT * problem.scale(scales)
        status = np.where(optimal & flat & (status == STATUS["optimal"]), STATUS["flat"], status)
    if isinstance(problem.criterion, Target) and problem.uncertain is None:
        value = problem.output(problem.criterion.output, known)
        # Within a thousandth it counts as reached.
        missed = ~np.isclose(value, problem.criterion.target, rtol=1e-3, atol=1e-9)
        status = np.where((status == STATUS["optimal"]) & missed, STATUS["target_missed"], status)
    return np.asarray(status, dtype=np.int8)


def _of_each_point(
    problem: OptimisationProblem, known: dict[str, Any], design: Mapping[str, Array]
) -> tuple[OptimisationProblem, Mapping[str, Array]]:
    if not isinstance(problem.criterion, Pareto):
        return problem, design
    other = np.abs(problem.output(problem.criterion.against, known))
    return problem.limited(), {**design, LIMIT: np.broadcast_to(other, design[LIMIT].shape)}


def slopes(
    problem: OptimisationProblem,
    x: Array,
    design: Mapping[str, Array],
    close: Mapping[str, Array],
    lost: NDArray[np.bool_],
) -> dict[str, Array]:
    """Return the elasticities d ln(output)/d ln(parameter) of the objective's output at optima.

    They tell a user which parameter matters at the optimum. The names are
    ``sensitivity_<parameter>``, the values arrays (cells,), from differences inside one regime; at
    a kink on the border of what limits and bounds allow from inside. NaN where there is none: at
    another kink, a jump, and for a parameter or an output that is 0. 0 for a variable that the
    output does not depend on. `x` are the optima, `close` is what of a margin counts as none.
    """
    output = problem.criterion.output
    used = problem.plan.only(output).parameters
    kept = np.flatnonzero(~lost)
    at = {**design, **dict(zip(problem.names, x, strict=True))}
    at = {name: at[name][kept] for name in problem.plan.parameters}
    close = {name: one[kept] for name, one in close.items()}
    elasticities = {}
    for name in problem.sensitive:
        values = elasticities[f"sensitivity_{name}"] = np.where(lost, np.nan, 0.0)
        if name not in used or not kept.size:
            continue
        cells = {one: at[one] for one in used}
        plan = plan_scene(problem.plan.scene, problem.plan.variant, (output,), cells)
        values[kept] = derivatives(plan, cells, (name,))[output, name].logarithmic(at[name])
        bent = np.isnan(values[kept])
        if bent.any():
            here, tolerances = chosen_cells(at, bent), chosen_cells(close, bent)
            sides = {name: _side(problem, name, here, tolerances)}
            cells = chosen_cells(cells, bent)
            inside = derivatives(plan, cells, (name,), sides=sides)[output, name]
            values[kept[bent]] = inside.logarithmic(here[name])
    return elasticities


def _side(
    problem: OptimisationProblem, name: str, at: Mapping[str, Array], close: Mapping[str, Array]
) -> NDArray[np.int8]:
    # 1 or -1 where limits and bounds are kept above or below the parameter's value only, else 0.
    step = STEPS[0] * scale_of(name, at[name])
    side = np.zeros(step.shape, dtype=np.int8)
    for way in (1, -1):
        moved = {**at, name: at[name] + way * step}
        x = np.stack([moved[one] for one in problem.names])
        inside = ((x >= problem.lower[:, None]) & (x <= problem.upper[:, None])).all(axis=0)
        for kept in problem.kept:
            inside &= problem.safe_margin(kept, x, moved) >= -close[kept.output]
        side += way * inside
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
