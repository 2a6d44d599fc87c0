"""The check of every optimum, once, by a method that did not find it.

That is the closed form where there is one, else points all over the bounds. `verify` in a study
goes further for some random optima: it computes the outputs there in extended precision (those of a
motion by another method), and the optimum by another method.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.verify import Comparison, compare
from vibrafeed.core.optimise.afresh import judged_afresh
from vibrafeed.core.optimise.exact import closed_optima, is_closed
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optima import STATUS
from vibrafeed.core.optimise.optimisation import Optimisation
from vibrafeed.core.optimise.problem import (
    LIMIT,
    ROUNDING,
    OptimisationProblem,
    chosen_cells,
    columns,
)
from vibrafeed.core.optimise.search import filled, most_reliable
from vibrafeed.core.plan.grid import to_si
from vibrafeed.core.plan.labels import Sample, sample_of
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.optimise_study import Limited, Pareto
from vibrafeed.core.sweep.verify import AGAINST, Rounding, rounding_of
from vibrafeed.core.watch import Watch

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
    """Return the objective of another method less ours, to check it; NaN without both.

    Parameters
    ----------
    method : str
        The one by which our optima were found.
    value : ndarray, shape (cells,)
        Our objective.
    lost : ndarray of bool, shape (cells,)
        True where there is no optimum.
    design, scales : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters, and the sizes of outputs, by which violations are divided.
    """
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
    cells, points = next(iter(design.values())).size, POINTS
    if problem.is_motion:
        points = POINTS_MOTION
    unit = filled(len(problem.names), cells, points)
    x = problem.inside(unit)[:, None, :]
    step = max(1, BLOCK // (unit.shape[1] * problem.nodes))
    best = np.full(cells, -np.inf)
    for start in range(0, cells, step):
        piece = np.arange(start, min(start + step, cells))
        here, sizes = chosen_cells(design, piece), chosen_cells(scales, piece)
        judged = problem.judged_with_error(x, columns(here), columns(sizes))
        value, beyond, error = (np.broadcast_to(one, judged[0].shape) for one in judged)
        best[piece] = np.where(beyond <= 0, value, -np.inf).max(axis=1)
        unsure = (error > 0).any(axis=1) & (beyond <= 0).any(axis=1)
        for cell in np.flatnonzero(unsure):
            one = value[cell], beyond[cell], error[cell]
            alone = chosen_cells(here, [cell]), chosen_cells(sizes, [cell])
            best[piece[cell]] = most_reliable(problem, unit, one, *alone)[1]
    return best


def accuracy(gaps: Array) -> str:
    """Return the accuracy of optima in words, as an attribute of a file.

    `gaps` is the variable `optimum_gap`: by how much another method finds better optima, over the
    size of the objective.
    """
    text = (
        "optimum_gap: what another method finds better, over the largest size of the objective; "
        "below 0 where it finds less"
    )
    known = gaps[np.isfinite(gaps)]
    return f"{text}; the largest here is {known.max():.2g}" if known.size else text


def verified(
    prepared: Optimisation, arrays: Mapping[str, NDArray[np.generic]], watch: Watch
) -> dict[str, str | int]:
    """Return the result of verifying random optima, as attributes of the dataset.

    The outputs at the optima are computed another way, and another method looks for better optima.
    Empty if the study does not ask for it.

    Parameters
    ----------
    prepared : Optimisation
        The study.
    arrays : mapping of str to ndarray
        The computed variables, in the units of studies.
    watch : Watch
        May stop the verification; what was compared until then counts.
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
    rival = _rival(prepared)
    watch = watch.part(0.5 if rival else 1.0)
    against, sentences = [], []
    judged, lost, left = np.zeros((3, sample.count), dtype=np.bool_)
    failed = 0
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
            unit = QUANTITIES[prepared.problem.criterion.output].unit
            more = f"{better:.2g}{'' if unit == '1' else f' {unit}'} more"
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
    """Return the fixed parameters of the sampled cells in SI units, with each optimum's own limit.

    With these another method can solve the same problem. On a trade-off front the limit is the size
    of the other output at the point. `known` are the computed variables of the cells, in the units
    of studies.
    """
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
    """Return the agreement of the outputs at some optima with outputs computed another way.

    The second result names that way: extended precision, or another method of motion.

    Parameters
    ----------
    prepared : Optimisation
        The study.
    design, x : mapping of str to ndarray, ndarray
        Fixed parameters and best values of the sampled cells, SI units; x is (variables, cells).
    known : mapping of str to ndarray
        The computed variables of these cells, in the units of studies.
    chosen : ndarray of int
        Positions of the cells to compare.
    watch : Watch
        May stop the work.
    """
    problem, plan = prepared.problem, prepared.plan
    given = dict(zip(problem.names, x, strict=True))
    cells = {name: (given | dict(design))[name][chosen] for name in plan.parameters}
    names = [name for name in plan.outputs if name in known]
    if problem.is_motion:
        got = {name: known[name][chosen] for name in names}
        other = prepared.other_motion
        assert other is not None  # the study would have been refused
        return compare(
            plan, cells, got, other.name, watch
        ), f"the motion by the method {other.name}"
    values = {name: np.asarray(to_si(name, known[name][chosen])) for name in names}
    return rounding_of(plan, cells, values, watch), AGAINST


def _rival(prepared: Optimisation) -> str | None:
    # Motions take too long: their optima are compared with points in any case.
    if prepared.problem.is_motion:
        return None
    return "search" if prepared.method != "search" else "scipy"


def _better(
    prepared: Optimisation,
    rival: str,
    design: Mapping[str, Array],
    known: Mapping[str, Array],
    chosen: NDArray[np.intp],
    watch: Watch,
) -> tuple[NDArray[np.bool_], int, float]:
    """Return the advantage of another method's optima over ours, in sampled cells.

    Parameters
    ----------
    prepared : Optimisation
        The study.
    rival : str
        The other method, a key of `METHODS`.
    design, known : mapping of str to ndarray
        The fixed parameters, SI units, and our results, in the units of studies, over all sampled
        cells.
    chosen : ndarray of int
        Positions in these of the cells to compare.
    watch : Watch
        May stop the other method.

    Returns
    -------
    tuple
        True for each of the chosen cells that the rival solved before a stop; the position of the
        cell where its objective is furthest above ours; by how much, 0 if nowhere.
    """
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
    x = np.where(lost, problem.lower[:, None], optima.x)
    theirs, beyond = problem.judged(x, here, scales)
    sound = ~lost & (beyond <= METHODS[rival].tolerance)
    if problem.uncertain is not None:
        # As ours are: at points of which neither search knew.
        fresh = judged_afresh(problem, x, here, scales, METHODS[rival].tolerance)
        theirs = np.where(problem.is_sampled, fresh.objective.value, theirs)
        sound &= ~fresh.surprises(problem, x, here, scales)[0]
    ours = problem.sign * known["objective"][chosen]
    more = np.where(sound, theirs - ours, -np.inf)
    worst = int(np.argmax(more))
    solved = optima.status != STATUS["not_computed"]
    return solved, int(chosen[worst]), float(max(more[worst], 0.0))
