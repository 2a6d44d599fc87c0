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
from vibrafeed.core.optimise.search import filled, most_reliable
from vibrafeed.core.optimise.uncertain import judged_afresh, some
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
    inner, scale = problem.limited(), scales[criterion.against]
    ends = replace(watch, progress=None)  # the many points between them are the progress
    top = solve(inner, {**design, LIMIT: WIDE * scale}, scales, ends)
    # At the other end the other output has a large weight in the objective.
    heavy = Weighted(output=criterion.output, against=criterion.against, weight=HEAVY)
    least = solve(replace(problem, criterion=heavy), design, scales, ends)
    cells = cells_of(design)
    x = np.repeat(least.x[:, :, None], points, axis=2)
    status = np.repeat(least.status[:, None], points, axis=1)
    evaluations = np.ones((cells, points), dtype=np.int64)
    optima = least
    most, there = (_value(problem, criterion.output, end, design) for end in (top, least))
    # Without a trade-off one choice is best in both outputs, and a front is one point.
    rest = np.flatnonzero(~(there >= most - SMALL * scales[criterion.output]))
    if rest.size:
        against = (np.abs(_value(problem, criterion.against, end, design)) for end in (top, least))
        first, last = (one[rest] for one in against)
        levels = first[:, None] + (last - first)[:, None] * evenly(0.0, 1.0, points)
        repeated = {name: np.repeat(values[rest], points) for name, values in design.items()}
        wide = {name: np.repeat(values[rest], points) for name, values in scales.items()}
        limits = np.where(np.isnan(levels), WIDE, levels + SLACK * scale[rest, None])
        optima = solve(inner, {**repeated, LIMIT: limits.ravel()}, wide, watch)
        x[:, rest] = optima.x.reshape(len(problem.names), -1, points)
        status[rest] = optima.status.reshape(-1, points)
        evaluations[rest] = np.broadcast_to(optima.evaluations, limits.size).reshape(-1, points)
        x[:, rest, 0], status[rest, 0] = top.x[:, rest], top.status[rest]
        x[:, rest, -1], status[rest, -1] = least.x[:, rest], least.status[rest]
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
    moved = [np.abs(np.diff(one, axis=1)) > SMALL * size for one, size in pairs]
    return np.isfinite(output).any(axis=1) + np.logical_or(*moved).sum(axis=1, dtype=np.float64)


def _value(
    problem: OptimisationProblem, name: str, optima: Optima, design: Mapping[str, Array]
) -> Array:
    lost = np.isnan(optima.x).any(axis=0)
    value = problem.output(name, problem.known(some(problem, optima.x), design))
    return np.where(lost, np.nan, np.broadcast_to(value, lost.shape))


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

    lost = ~(np.isfinite(output) & np.isfinite(other)).all(axis=1, keepdims=True)
    x = over_range(np.where(lost, 0.0, output))
    y = over_range(np.where(lost, 0.0, np.abs(other)))
    # From (1, 1), the largest output, to (0, 0): what lies above the chord is better in both.
    away = x - y
    marks = np.zeros(output.shape, dtype=np.int8)
    marks[np.arange(len(away)), np.argmax(away, axis=1)] = 1
    return marks


POINTS = 40_000  # with which a design's optimum is compared
POINTS_MOTION = 1_600  # the same for motions, which take long
BLOCK = 262_144  # points that are evaluated at a time


def gap_of(
    method: str,
    problem: OptimisationProblem,
    value: Array,
    lost: Mask,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> Array:
    """Return the objective of another method less ours, to check it; NaN without both."""
    design = _slack(problem, design, scales)
    reference = np.full(lost.shape, np.nan)
    if method != "exact" and is_closed(problem):
        reference = np.asarray(closed_optima(problem, design).value)
    rest = np.flatnonzero(np.isnan(reference) & ~lost)
    if rest.size:
        others, sizes = chosen_cells(design, rest), chosen_cells(scales, rest)
        best = best_of_points(problem, others, sizes)
        reference[rest] = np.where(np.isfinite(best), best, np.nan)
    return np.where(lost, np.nan, reference - value)


def _slack(
    problem: OptimisationProblem, design: Mapping[str, Array], scales: Mapping[str, Array]
) -> Mapping[str, Array]:
    if LIMIT not in (kept.name for kept in problem.kept) or not problem.against:
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
    unit = filled(len(problem.names), cells, POINTS_MOTION if problem.is_motion else POINTS)
    x = problem.inside(unit)[:, None, :]
    step = max(1, BLOCK // (unit.shape[1] * problem.nodes))
    best = np.full(cells, -np.inf)
    for start in range(0, cells, step):
        piece = np.arange(start, min(start + step, cells))
        here, sizes = chosen_cells(design, piece), chosen_cells(scales, piece)
        judged = problem.judged(x, columns(here), columns(sizes))
        value, beyond, error = (np.broadcast_to(one, judged[0].shape) for one in judged)
        best[piece] = np.where(beyond <= 0, value, -np.inf).max(axis=1)
        unsure = (error > 0).any(axis=1) & (beyond <= 0).any(axis=1)
        for cell in np.flatnonzero(unsure):
            one = value[cell], beyond[cell], error[cell]
            alone = chosen_cells(here, [cell]), chosen_cells(sizes, [cell])
            best[piece[cell]] = most_reliable(problem, unit, one, *alone)[1]
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
    dims = tuple(prepared.grid.axes)
    known = {name: sample.at(arrays[name], dims) for name in prepared.units}
    x = np.stack([to_si(name, known[f"best_{name}"]) for name in prepared.problem.names])
    answered = np.flatnonzero(~np.isnan(x).any(axis=0))
    design = _design(prepared, sample, known)
    # An edge of stick that is approached and never reached is a jump of the outputs.
    smooth = answered[known["optimum_status"][answered] != STATUS["not_attained"]]
    # Motions take too long: their optima are compared with points in any case.
    rival = "search" if prepared.method != "search" else "scipy"
    rival = "" if prepared.problem.is_motion else rival
    watch = watch.part(0.5 if rival else 1.0)
    against, sentences, failed = [], [], 0
    judged, lost, left = np.zeros((3, sample.count), dtype=np.bool_)
    if smooth.size:
        agreement, by = _outputs(prepared, design, x, known, smooth, watch)
        against.append(by)
        judged[smooth], lost[smooth], left[smooth] = True, ~agreement.compared, ~agreement.evaluated
        failed = agreement.failed
        if agreement.evaluated.any():
            sentences.append(agreement.in_words(sample.where(int(smooth[agreement.cell]))))
    if rival and answered.size:
        solved, cell, better = _better(prepared, rival, design, known, answered, watch)
        against.append(f"answers of the method {rival}")
        judged[answered] = True
        lost[answered] |= ~solved
        left[answered] |= ~solved
        if solved.any():
            more = f"{better:.2g}{QUANTITIES[prepared.problem.criterion.output].suffix} more"
            more = more if better else "nothing better"
            sentences.append(f"objective {sample.where(cell)}: {rival} finds {more}")
    if sample.count and not answered.size:
        sentences.append("no cell has an optimum")
    return sample.verification_attributes(
        " and ".join(against) or "nothing",
        "; ".join(sentences),
        evaluated=sample.count - int(left.sum()),
        compared=int((judged & ~lost).sum()),
        failed=failed,
    )


def _design(prepared: Optimisation, sample: Sample, known: Mapping[str, Array]) -> dict[str, Array]:
    problem = prepared.problem
    design = prepared.designs.at(sample.positions, sample.count, prepared.plan.parameters)
    criterion = problem.criterion
    limit = np.full(sample.count, criterion.limit if isinstance(criterion, Limited) else np.inf)
    if isinstance(criterion, Pareto):
        limit = np.abs(known[criterion.against])
    return {**design, LIMIT: limit}


def _outputs(
    prepared: Optimisation,
    design: Mapping[str, Array],
    x: Array,
    known: Mapping[str, Array],
    chosen: NDArray[np.intp],
    watch: Watch,
) -> tuple[Rounding | Comparison, str]:
    problem, plan = prepared.problem, prepared.plan
    given = dict(zip(problem.names, x, strict=True))
    cells = {name: (given | dict(design))[name][chosen] for name in plan.parameters}
    names = [name for name in plan.outputs if name in known]
    if problem.is_motion:
        got = {name: known[name][chosen] for name in names}
        assert prepared.other_motion is not None  # the study would have been refused
        other = prepared.other_motion.name
        return compare(plan, cells, got, other, watch), f"the motion by the method {other}"
    values = {name: np.asarray(to_si(name, known[name][chosen])) for name in names}
    return rounding_of(plan, cells, values, watch), AGAINST


def _better(
    prepared: Optimisation,
    rival: str,
    design: Mapping[str, Array],
    known: Mapping[str, Array],
    chosen: NDArray[np.intp],
    watch: Watch,
) -> tuple[NDArray[np.bool_], int, float]:
    if watch.stopped():
        return np.zeros(chosen.size, dtype=np.bool_), -1, 0.0
    problem = prepared.problem
    here = chosen_cells(design, chosen)
    scales = problem.scales(here)
    if isinstance(problem.criterion, Pareto):
        problem = problem.limited()
    here = dict(_slack(problem, here, scales))
    optima = METHODS[rival].solve(problem, here, scales, watch)
    lost = np.isnan(optima.x).any(axis=0)
    x = some(problem, optima.x)
    theirs, beyond, _ = problem.judged(x, here, scales)
    sound = ~lost & (beyond <= METHODS[rival].tolerance)
    if problem.uncertain is not None:
        # As ours are: at points of which neither search knew.
        fresh = judged_afresh(problem, x, here, scales, METHODS[rival].tolerance)
        theirs = np.where(problem.is_sampled, fresh.objective.value, theirs)
        sound &= ~fresh.surprises(problem, x, here, scales)[0]
    ours = problem.sign * known["objective"][chosen]
    more = np.where(sound, theirs - ours, -np.inf)
    worst, solved = int(np.argmax(more)), optima.status != STATUS["not_computed"]
    return solved, int(chosen[worst]), float(max(more[worst], 0.0))


def label(prepared: Optimisation, computed: Computed, watch: Watch) -> Table:
    """Return the results of an optimisation as a table, verified if the study asks for it.

    `computed` has the arrays of all variables by name; `watch` may stop the verification.
    """
    arrays, dims, problem = computed.arrays, tuple(prepared.grid.axes), prepared.problem
    scene, says = prepared.plan.scene, METHODS[prepared.method].says
    attributes, words = dict(prepared.attributes), criterion_in_words(problem)
    for verdict in prepared.plan.verdicts:
        names = {*verdict.regimes}
        if (arrays[verdict.name] == REGIMES["not_assessed"].value).any():
            names.add("not_assessed")
        judged = verdict.outputs if len(prepared.plan.verdicts) > 1 else ()
        attributes[verdict.name] = regime_attributes(tuple(names), judged)
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
            **global_attributes(prepared, f"optimisation, {says}"),
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
            statuses, more = _of_fronts(prepared.study.criterion, arrays)
        counts = np.bincount(statuses, minlength=len(by_value))
        parts = [f"{by_value[v][0]} {n:,}" for v, n in enumerate(counts) if n]
        answers = "1 answer" if statuses.size == 1 else f"{statuses.size:,} answers"
        return f"of {answers}: {', '.join(parts)}{more}"
    name, description = by_value[int(arrays["optimum_status"][0])]
    text = f"{name}: {description}"
    if np.isnan(arrays["objective"][0]):
        return text
    clauses = [
        f"{n} = {arrays[f'best_{n}'][0]:.6g}{QUANTITIES[n].suffix}" for n in prepared.problem.names
    ]
    binding = [n.removeprefix("binds_") for n in arrays if n.startswith("binds_") and arrays[n][0]]
    tight = f"; binding: {', '.join(binding)}" if binding else "; nothing binds"
    return "; ".join((text, ", ".join(clauses) + tight, *_shares_broken(prepared, arrays)))


def _of_fronts(
    criterion: Pareto, arrays: Mapping[str, NDArray[Any]]
) -> tuple[NDArray[np.int8], str]:
    known = {
        name: arrays[name].reshape(-1, criterion.points)
        for name in ("optimum_status", "front_points", criterion.output, criterion.against)
    }
    single = known["front_points"][:, 0] == 1
    status = known["optimum_status"]
    statuses = np.concatenate([status[single, 0], status[~single].ravel()])
    if not single.any():
        return statuses, ""
    other = np.abs(known[criterion.against][single, 0]).max()
    is_none = other <= FLAT * np.abs(known[criterion.output][single, 0]).max()
    reached = f"{criterion.against} = 0" if is_none else f"the least |{criterion.against}|"
    where = "" if single.size == 1 else f" in {single.sum():,} of {single.size:,} designs"
    return (
        statuses,
        f"; no trade-off{where}: {reached} is reached at the largest {criterion.output}",
    )


def _shares_broken(prepared: Optimisation, arrays: Mapping[str, NDArray[Any]]) -> Iterator[str]:
    if prepared.problem.uncertain is None or not prepared.problem.kept:
        return
    shares = {one.name: arrays[broken_names(one.name)[0]][0] for one in prepared.problem.kept}
    told = [f"{100 * share:.2g} % of units break {name}" for name, share in shares.items() if share]
    yield ", ".join(told) or "no unit of those drawn breaks a limit"
