"""Optima checked and labelled: each answer once, by a method that did not find it.

That is the closed form where there is one, else points all over the bounds. `verify` in a study
goes further for some random optima: it computes the outputs there in extended precision (those of a
motion by another method), and the optimum by another method.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import (
    Table,
    TableVariable,
    regime_attributes,
)
from vibrafeed.core.mechanics.arrays import Array, Mask, ratio
from vibrafeed.core.motion.simulate import Comparison, compare
from vibrafeed.core.optimise.exact import closed_front, closed_optima, is_closed
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optimisation import Optimisation, criterion_in_words
from vibrafeed.core.optimise.problem import (
    LIMIT,
    ROUNDING,
    STATUS,
    Optima,
    OptimisationProblem,
    broken_names,
    cells_of,
    chosen_cells,
    columns,
)
from vibrafeed.core.optimise.search import box_points, most_reliable
from vibrafeed.core.optimise.uncertain import evaluated_at_fresh_points, lower_bounds_where_missing
from vibrafeed.core.plan.grid import to_si
from vibrafeed.core.plan.labels import Sample, coordinates_of, global_attributes, sample_of
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.statistics import REPLICATES
from vibrafeed.core.quantities import OPTIMUM_STATUSES, QUANTITIES, REGIMES
from vibrafeed.core.study.optimise_study import Limited, Pareto, Weighted
from vibrafeed.core.study.values import evenly
from vibrafeed.core.sweep.verify import AGAINST, Rounding, rounding_of
from vibrafeed.core.watch import Watch

WIDE = 1e3  # of the other output's scale: a limit that never binds
HEAVY = 1e3  # weight that puts the other output first; a steeper ridge is harder to climb along
FLAT = 1e-9
SMALL = 1e-6  # of an output's scale: a smaller difference of two points is that of a search
SLACK = 1e-9  # of its scale, of a limit that only single points would keep


def find_front(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    method: str,
    watch: Watch,
) -> Optima:
    """Return the trade-off front of every design, from the largest output to the least other one.

    Without a closed form both ends are found first, then the largest output at equally spaced
    limits of the other one, all designs and limits at once. The arrays of the result have the shape
    (cells * points,), the points of a design one after the other.
    """
    criterion = problem.criterion
    assert isinstance(criterion, Pareto)
    points = criterion.points
    if method == "exact":
        return closed_front(problem, design, points)
    solve = METHODS[method].solve
    limited_problem, scale = problem.limited(), scales[criterion.against]
    silent = replace(watch, progress=None)  # the many points between them are the progress
    best_output = solve(limited_problem, {**design, LIMIT: WIDE * scale}, scales, silent)
    # At the other end the other output has a large weight in the objective.
    weighted = Weighted(output=criterion.output, against=criterion.against, weight=HEAVY)
    least_other = solve(replace(problem, criterion=weighted), design, scales, silent)
    cells = cells_of(design)
    x = np.repeat(least_other.x[:, :, None], points, axis=2)
    status = np.repeat(least_other.status[:, None], points, axis=1)
    evaluations = np.ones((cells, points), dtype=np.int64)
    optima = least_other
    largest, at_least_other = (
        _output_at(problem, criterion.output, optimum, design)
        for optimum in (best_output, least_other)
    )
    # Without a trade-off one choice is best in both outputs, and a front is one point.
    traded = np.flatnonzero(~(at_least_other >= largest - SMALL * scales[criterion.output]))
    if traded.size:
        other_sizes = (
            np.abs(_output_at(problem, criterion.against, optimum, design))
            for optimum in (best_output, least_other)
        )
        first, last = (values[traded] for values in other_sizes)
        levels = first[:, None] + (last - first)[:, None] * evenly(0.0, 1.0, points)
        repeated = {name: np.repeat(values[traded], points) for name, values in design.items()}
        repeated_scales = {
            name: np.repeat(values[traded], points) for name, values in scales.items()
        }
        limits = np.where(np.isnan(levels), WIDE, levels + SLACK * scale[traded, None])
        optima = solve(limited_problem, {**repeated, LIMIT: limits.ravel()}, repeated_scales, watch)
        x[:, traded] = optima.x.reshape(len(problem.names), -1, points)
        status[traded] = optima.status.reshape(-1, points)
        evaluations[traded] = np.broadcast_to(optima.evaluations, limits.size).reshape(-1, points)
        x[:, traded, 0], status[traded, 0] = best_output.x[:, traded], best_output.status[traded]
        x[:, traded, -1], status[traded, -1] = least_other.x[:, traded], least_other.status[traded]
    return Optima(
        x.reshape(len(problem.names), -1), status.ravel(), evaluations=evaluations.ravel(),
        says=optima.says,
    )  # fmt: skip


def distinct_points(output: Array, other: Array, sizes: Sequence[Array]) -> Array:
    """Return the number of distinct points of each trade-off front, 0 of one without a value.

    `output` and `other` are the two outputs, shape (cells, points), and `sizes` their scales, shape
    (cells, 1); the result has the shape (cells,). A front of one point is no trade-off.
    """
    pairs = zip((output, np.abs(other)), sizes, strict=True)
    differs = [np.abs(np.diff(values, axis=1)) > SMALL * size for values, size in pairs]
    return np.isfinite(output).any(axis=1) + np.logical_or(*differs).sum(axis=1, dtype=np.float64)


def _output_at(
    problem: OptimisationProblem, name: str, optima: Optima, design: Mapping[str, Array]
) -> Array:
    without_optimum = np.isnan(optima.x).any(axis=0)
    value = problem.output(
        name, problem.quantities(lower_bounds_where_missing(problem, optima.x), design)
    )
    return np.where(without_optimum, np.nan, np.broadcast_to(value, without_optimum.shape))


def knee(output: Array, other: Array) -> NDArray[np.int8]:
    """Return 1 at the knee of each trade-off front, where it bends most, else 0.

    `output` and `other` are the two outputs, shape (cells, points); the result is int8 of that
    shape. The knee is the point farthest from the chord between the ends, both outputs over their
    range; the first point of a front without range or without values.
    """

    def over_range(values: Array) -> Array:
        low, high = values.min(axis=1, keepdims=True), values.max(axis=1, keepdims=True)
        # A range of rounding is none.
        span = np.where(high - low > FLAT * np.maximum(np.abs(high), np.abs(low)), high - low, 0.0)
        return ratio(values - low, span, 0.0)

    incomplete = ~(np.isfinite(output) & np.isfinite(other)).all(axis=1, keepdims=True)
    x = over_range(np.where(incomplete, 0.0, output))
    y = over_range(np.where(incomplete, 0.0, np.abs(other)))
    # From (1, 1), the largest output, to (0, 0): what lies above the chord is better in both.
    distance = x - y
    marks = np.zeros(output.shape, dtype=np.int8)
    marks[np.arange(len(distance)), np.argmax(distance, axis=1)] = 1
    return marks


POINTS = 40_000  # with which a design's optimum is compared
POINTS_MOTION = 1_600  # the same for motions, which take long
BLOCK = 262_144  # points that are evaluated at a time


def gap_of(
    method: str,
    problem: OptimisationProblem,
    value: Array,
    without_optimum: Mask,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> Array:
    """Return the objective of another method less ours, to check it; NaN without both."""
    design = _with_slack_limit(problem, design, scales)
    reference = np.full(without_optimum.shape, np.nan)
    if method != "exact" and is_closed(problem):
        reference = np.asarray(closed_optima(problem, design).value)
    unsolved = np.flatnonzero(np.isnan(reference) & ~without_optimum)
    if unsolved.size:
        best = best_of_points(
            problem, chosen_cells(design, unsolved), chosen_cells(scales, unsolved)
        )
        reference[unsolved] = np.where(np.isfinite(best), best, np.nan)
    return np.where(without_optimum, np.nan, reference - value)


def _with_slack_limit(
    problem: OptimisationProblem, design: Mapping[str, Array], scales: Mapping[str, Array]
) -> Mapping[str, Array]:
    if LIMIT not in (constraint.name for constraint in problem.constraints) or not problem.against:
        return design
    # A limit of nothing, which rounding may just break, would leave no answer.
    return {**design, LIMIT: design[LIMIT] + ROUNDING * scales[problem.against]}


def best_of_points(
    problem: OptimisationProblem, design: Mapping[str, Array], scales: Mapping[str, Array]
) -> Array:
    """Return the best objective of each design at points all over the bounds, shape (cells,).

    It is -inf where no point keeps the constraints. Of motions that do not repeat the best points
    are followed for longer before one is chosen. Arguments as in `gap_of`.
    """
    cells = cells_of(design)
    unit = box_points(len(problem.names), cells, POINTS_MOTION if problem.is_motion else POINTS)
    x = problem.from_unit_box(unit)[:, None, :]
    cells_at_a_time = max(1, BLOCK // (unit.shape[1] * problem.nodes))
    best = np.full(cells, -np.inf)
    for start in range(0, cells, cells_at_a_time):
        piece = np.arange(start, min(start + cells_at_a_time, cells))
        piece_design, piece_scales = chosen_cells(design, piece), chosen_cells(scales, piece)
        judged = problem.judged(x, columns(piece_design), columns(piece_scales))
        value, violation, error = (np.broadcast_to(array, judged[0].shape) for array in judged)
        best[piece] = np.where(violation <= 0, value, -np.inf).max(axis=1)
        uncertain_cells = (error > 0).any(axis=1) & (violation <= 0).any(axis=1)
        for cell in np.flatnonzero(uncertain_cells):
            of_points = value[cell], violation[cell], error[cell]
            cell_arguments = chosen_cells(piece_design, [cell]), chosen_cells(piece_scales, [cell])
            best[piece[cell]] = most_reliable(problem, unit, of_points, *cell_arguments)[1]
    return best


def verified(
    prepared: Optimisation, arrays: Mapping[str, NDArray[np.generic]], watch: Watch
) -> dict[str, str | int]:
    """Return the result of verifying random optima, as attributes of the dataset.

    The outputs at the optima are computed another way, and another method looks for better optima.
    Empty if the study does not ask for it.
    """
    if prepared.study.verify is None:
        return {}
    sample = sample_of(prepared, arrays, ("optimum_status", STATUS["not_computed"]))
    sampled = {name: sample.at(arrays[name], tuple(prepared.grid.axes)) for name in prepared.units}
    x = np.stack([to_si(name, sampled[f"best_{name}"]) for name in prepared.problem.names])
    with_optimum = np.flatnonzero(~np.isnan(x).any(axis=0))
    design = _sampled_designs(prepared, sample, sampled)
    # An edge of stick that is approached and never reached is a jump of the outputs.
    smooth = with_optimum[sampled["optimum_status"][with_optimum] != STATUS["not_attained"]]
    # Motions take too long: their optima are compared with points in any case.
    rival = "search" if prepared.method != "search" else "scipy"
    rival = "" if prepared.problem.is_motion else rival
    watch = watch.part(0.5 if rival else 1.0)
    references, sentences, failed = [], [], 0
    checked, not_compared, not_evaluated = np.zeros((3, sample.count), dtype=np.bool_)
    if smooth.size:
        agreement, reference = _compared_outputs(prepared, design, x, sampled, smooth, watch)
        references.append(reference)
        checked[smooth], not_compared[smooth] = True, ~agreement.compared
        not_evaluated[smooth] = ~agreement.evaluated
        failed = agreement.failed
        if agreement.evaluated.any():
            sentences.append(agreement.in_words(sample.where(int(smooth[agreement.cell]))))
    if rival and with_optimum.size:
        solved, cell, advantage = _compared_with_rival(
            prepared, rival, design, sampled, with_optimum, watch
        )
        references.append(f"answers of the method {rival}")
        checked[with_optimum] = True
        not_compared[with_optimum] |= ~solved
        not_evaluated[with_optimum] |= ~solved
        if solved.any():
            finding = f"{advantage:.2g}{QUANTITIES[prepared.problem.criterion.output].suffix} more"
            finding = finding if advantage else "nothing better"
            sentences.append(f"objective {sample.where(cell)}: {rival} finds {finding}")
    if sample.count and not with_optimum.size:
        sentences.append("no cell has an optimum")
    return sample.verification_attributes(
        " and ".join(references) or "nothing",
        "; ".join(sentences),
        evaluated=sample.count - int(not_evaluated.sum()),
        compared=int((checked & ~not_compared).sum()),
        failed=failed,
    )


def _sampled_designs(
    prepared: Optimisation, sample: Sample, sampled: Mapping[str, Array]
) -> dict[str, Array]:
    problem = prepared.problem
    design = prepared.designs.at(sample.positions, sample.count, prepared.plan.parameters)
    criterion = problem.criterion
    limit = np.full(sample.count, criterion.limit if isinstance(criterion, Limited) else np.inf)
    if isinstance(criterion, Pareto):
        limit = np.abs(sampled[criterion.against])
    return {**design, LIMIT: limit}


def _compared_outputs(
    prepared: Optimisation,
    design: Mapping[str, Array],
    x: Array,
    sampled: Mapping[str, Array],
    chosen: NDArray[np.intp],
    watch: Watch,
) -> tuple[Rounding | Comparison, str]:
    # The comparison, and the name of what the outputs were compared with.
    problem, plan = prepared.problem, prepared.plan
    variables = dict(zip(problem.names, x, strict=True))
    cells = {name: (variables | dict(design))[name][chosen] for name in plan.parameters}
    names = [name for name in plan.outputs if name in sampled]
    if problem.is_motion:
        outputs = {name: sampled[name][chosen] for name in names}
        assert prepared.other_motion is not None  # the study would have been refused
        other = prepared.other_motion.name
        return compare(plan, cells, outputs, other, watch), f"the motion by the method {other}"
    values = {name: np.asarray(to_si(name, sampled[name][chosen])) for name in names}
    return rounding_of(plan, cells, values, watch), AGAINST


def _compared_with_rival(
    prepared: Optimisation,
    rival: str,
    design: Mapping[str, Array],
    sampled: Mapping[str, Array],
    chosen: NDArray[np.intp],
    watch: Watch,
) -> tuple[NDArray[np.bool_], int, float]:
    # Which designs the rival solved, the cell where its optimum is better by most, and by how much.
    if watch.stopped():
        return np.zeros(chosen.size, dtype=np.bool_), -1, 0.0
    problem = prepared.problem
    chosen_design = chosen_cells(design, chosen)
    scales = problem.scales(chosen_design)
    if isinstance(problem.criterion, Pareto):
        problem = problem.limited()
    chosen_design = dict(_with_slack_limit(problem, chosen_design, scales))
    optima = METHODS[rival].solve(problem, chosen_design, scales, watch)
    without_optimum = np.isnan(optima.x).any(axis=0)
    x = lower_bounds_where_missing(problem, optima.x)
    rival_values, violation, _ = problem.judged(x, chosen_design, scales)
    is_valid = ~without_optimum & (violation <= METHODS[rival].tolerance)
    if problem.uncertain is not None:
        # Both optima are judged at points that neither search used.
        fresh = evaluated_at_fresh_points(
            problem, x, chosen_design, scales, METHODS[rival].tolerance
        )
        rival_values = np.where(problem.is_sampled, fresh.objective.value, rival_values)
        is_valid &= ~fresh.worse_than_nodes(problem, x, chosen_design, scales)[0]
    own_values = problem.sign * sampled["objective"][chosen]
    advantage = np.where(is_valid, rival_values - own_values, -np.inf)
    largest, solved = int(np.argmax(advantage)), optima.status != STATUS["not_computed"]
    return solved, int(chosen[largest]), float(max(advantage[largest], 0.0))


def label(prepared: Optimisation, computed: Computed, watch: Watch) -> Table:
    """Return the results of an optimisation as a table, verified if the study asks for it.

    `computed` has the arrays of all variables by name; `watch` may stop the verification.
    """
    arrays, dims, problem = computed.arrays, tuple(prepared.grid.axes), prepared.problem
    scene, method_label = prepared.plan.scene, METHODS[prepared.method].says
    attributes, words = dict(prepared.attributes), criterion_in_words(problem)
    for verdict in prepared.plan.verdicts:
        names = {*verdict.regimes}
        if (arrays[verdict.name] == REGIMES["not_assessed"].value).any():
            names.add("not_assessed")
        outputs = verdict.outputs if len(prepared.plan.verdicts) > 1 else ()
        attributes[verdict.name] = regime_attributes(tuple(names), outputs)
    gaps = arrays["optimum_gap"][np.isfinite(arrays["optimum_gap"])]
    accuracy = [
        "optimum_gap: the advantage of another method's optimum over the largest size of the "
        "objective; below 0 where that optimum is worse",
        *([f"the largest here is {gaps.max():.2g}"] if gaps.size else []),
    ]
    if problem.uncertain is not None:
        accuracy.insert(
            0,
            "errors of mean, quantile and probabilities are half the widths of 95 % intervals, "
            f"from {REPLICATES} scramblings of Sobol points which the search did not use",
        )
    return Table(
        coordinates_of(prepared.plan, prepared.grid),
        {name: TableVariable(dims, arrays[name], attributes[name]) for name in prepared.units},
        {
            **global_attributes(prepared, f"optimisation, {method_label}"),
            "title": prepared.study.title or f"{scene.title}: {words}",
            "criterion": words,
            "method": prepared.method,
            # That of the motion; `method` is the optimiser's.
            **({"motion_method": prepared.plan.variant} if scene.choice == "method" else {}),
            "message": _message(prepared, arrays),
            "accuracy": "; ".join(accuracy),
            "evaluations": float(arrays["evaluations"].sum()),
            **computed.notes,
            **verified(prepared, arrays, watch),
        },
    )


def _message(prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]) -> str:
    by_value = {flag.value: (name, flag.description) for name, flag in OPTIMUM_STATUSES.items()}
    arrays = {name: values.ravel() for name, values in arrays.items()}
    if arrays["optimum_status"].size > 1:
        statuses, more = arrays["optimum_status"], ""
        if isinstance(prepared.study.criterion, Pareto):
            statuses, more = _statuses_of_fronts(prepared.study.criterion, arrays)
        counts = np.bincount(statuses, minlength=len(by_value))
        parts = [f"{by_value[value][0]} {count:,}" for value, count in enumerate(counts) if count]
        answers = "1 answer" if statuses.size == 1 else f"{statuses.size:,} answers"
        return f"of {answers}: {', '.join(parts)}{more}"
    name, description = by_value[int(arrays["optimum_status"][0])]
    text = f"{name}: {description}"
    if np.isnan(arrays["objective"][0]):
        return text
    clauses = [
        f"{name} = {arrays[f'best_{name}'][0]:.6g}{QUANTITIES[name].suffix}"
        for name in prepared.problem.names
    ]
    binding = [
        name.removeprefix("binds_")
        for name in arrays
        if name.startswith("binds_") and arrays[name][0]
    ]
    binding_text = f"; binding: {', '.join(binding)}" if binding else "; nothing binds"
    return "; ".join(
        (text, ", ".join(clauses) + binding_text, *_broken_probabilities(prepared, arrays))
    )


def _statuses_of_fronts(
    criterion: Pareto, arrays: Mapping[str, NDArray[Any]]
) -> tuple[NDArray[np.int8], str]:
    # The status of each answer, one for a front of a single point, and a note on such fronts.
    by_front = {
        name: arrays[name].reshape(-1, criterion.points)
        for name in ("optimum_status", "front_points", criterion.output, criterion.against)
    }
    single = by_front["front_points"][:, 0] == 1
    status = by_front["optimum_status"]
    statuses = np.concatenate([status[single, 0], status[~single].ravel()])
    if not single.any():
        return statuses, ""
    other = np.abs(by_front[criterion.against][single, 0]).max()
    is_none = other <= FLAT * np.abs(by_front[criterion.output][single, 0]).max()
    reached = f"{criterion.against} = 0" if is_none else f"the least |{criterion.against}|"
    where = "" if single.size == 1 else f" in {single.sum():,} of {single.size:,} designs"
    return (
        statuses,
        f"; no trade-off{where}: {reached} is reached at the largest {criterion.output}",
    )


def _broken_probabilities(
    prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]
) -> Iterator[str]:
    if prepared.problem.uncertain is None or not prepared.problem.constraints:
        return
    probabilities = {
        constraint.name: arrays[broken_names(constraint.name)[0]][0]
        for constraint in prepared.problem.constraints
    }
    texts = [
        f"{100 * share:.2g} % of units break {name}"
        for name, share in probabilities.items()
        if share
    ]
    yield ", ".join(texts) or "no unit of those drawn breaks a limit"
