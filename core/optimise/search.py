"""The method `search`: differential evolution of many designs at once, for any outputs.

Storn and Price 1997, with Deb's rules (2000): a candidate that keeps the constraints beats one that
does not, and of two that do not, the smaller violation wins. Only the order of values counts, so
that outputs may jump, as mean velocities do, or have no value in places. What leaves the box is
put onto its edge: maxima there are met exactly.

Each design has a population of its own; all share the same random numbers, so that an answer does
not depend on the other designs of a batch.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.problem import (
    LONGEST,
    STATUS,
    UNKNOWN,
    Optima,
    OptimisationProblem,
    cells_of,
    chosen_cells,
    columns,
    statuses_of,
)
from vibrafeed.core.optimise.uncertain import NODES
from vibrafeed.core.plan.grid import spread
from vibrafeed.core.watch import Watch

MAX_VARIABLES = 8
MEMBERS = 24  # of a population, and 8 more for each variable
TIMES_MOTION = 2  # so many times the members for motions, which jump
SAMPLES = 1024  # points from which the first members are taken
MAX_GENERATIONS = 400
ROUGH_GENERATIONS = 25
"""For each variable. Where motions do not repeat tops stand on tops: populations do not narrow."""
CROSSED = 0.9  # share of the variables that change
SMALL = 1e-12  # a population that is narrower in all variables has converged
LEVEL, LEVEL_JUMPS = (1e-15, 1e-6), (1e-11, 1e-3)
"""So near each other, as shares of the value and of the box, members have met a smooth top; an edge
of a jump is not met so exactly."""
ROUGH = 0.03  # share of the first points without an exact value from which a design is rough
CLOSER = (1e-2, 1e-5)  # widths of the populations that start around the best point afterwards
CELLS = 256  # designs at a time: some 10,000 points a generation stay in the cache
SEED = 1

NICHES = 128  # cells of a grid along each variable; the best point of each cell competes
FOLLOWED = 32  # points that are followed again, for each of the shares below
SHARES = (0.0, 1 / 3, 1.0)  # of its error, less which a mean is ranked; longer runs leave 1/3
ROUNDS = ((8.0, 4), (LONGEST, 1))
"""Rounds of longer runs: the factor of their length, and the number of points kept then."""

MAX_GRIDDED = 4  # variables that a grid can have
MAX_POINTS = 4_000_000  # of all designs together


class Candidates(NamedTuple):
    """Points of each design as shares of the bounds, shape (variables, cells, n), judged.

    Violation of the constraints, objective, and error of the objective have the shape (cells, n).
    """

    unit: Array
    violation: Array
    value: Array
    error: Array

    def best(self) -> NDArray[np.intp]:
        """Return the index of the best point of each design, shape (cells,)."""
        return np.lexsort((-self.value, self.violation), axis=-1)[:, 0]

    def at(self, indices: NDArray[np.intp]) -> "Candidates":
        """Return the points at indices, shape (cells, k)."""
        rows = (np.take_along_axis(array, indices, axis=1) for array in self[1:])
        return Candidates(np.take_along_axis(self.unit, indices[None], axis=2), *rows)

    def of(self, cells: Any) -> "Candidates":
        """Return the points of some designs."""
        return Candidates(self.unit[:, cells], *(array[cells] for array in self[1:]))


Judge = Callable[[Array, NDArray[np.intp]], Candidates]
"""Takes points, shape (variables, k, n), of the designs with these k numbers, and judges them."""


class SearchResult(NamedTuple):
    """The result of a search: the best point of each design, shape (cells, 1), and what it took.

    `done`, shape (cells,), is False for a design that was not finished, which has NaN.
    """

    best: Candidates
    evaluations: NDArray[np.int64]
    done: NDArray[np.bool_]

    def put(self, cells: Any, other: "SearchResult") -> None:
        """Take over another search of some designs, with the numbers `cells`."""
        self.best.unit[:, cells] = other.best.unit
        for mine, theirs in zip(self.best[1:], other.best[1:], strict=True):
            mine[cells] = theirs
        self.evaluations[cells] += other.evaluations
        self.done[cells] = other.done


def _empty_result(variables: int, cells: int) -> SearchResult:
    unit, rest = np.full((variables, cells, 1), np.nan), np.full((3, cells, 1), np.nan)
    return SearchResult(
        Candidates(unit, *rest), np.zeros(cells, np.int64), np.zeros(cells, np.bool_)
    )


def by_search(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the best candidate of every design, found by differential evolution.

    Designs are taken in pieces that fit the cache. Where motions do not repeat, a mean has a
    statistical error, and the largest of thousands of means is one that chance favoured: the best
    points are then followed again, over a longer time.
    """
    cells = cells_of(design)
    designs_at_a_time = max(1, CELLS * NODES // max(NODES, problem.nodes))
    pieces = []
    for start in range(0, cells, designs_at_a_time):
        piece = slice(start, start + designs_at_a_time)
        arguments = chosen_cells(design, piece), chosen_cells(scales, piece)
        pieces.append(
            _search_piece(problem, *arguments, watch.part(cells_of(arguments[0]) / cells))
        )
    return Optima(
        np.concatenate([piece.x for piece in pieces], axis=1),
        np.concatenate([piece.status for piece in pieces]),
        evaluations=np.concatenate([np.asarray(piece.evaluations) for piece in pieces]),
    )


def _search_piece(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    # Differential evolution in the unit box, by functions that judge points of some designs, and
    # choose the best point of a design whose values are uncertain.
    silent = replace(watch, progress=None)

    def judge(unit: Array, cells: NDArray[np.intp]) -> Candidates:
        arguments = columns(chosen_cells(design, cells)), columns(chosen_cells(scales, cells))
        value, violation, error = problem.judged(problem.from_unit_box(unit), *arguments, silent)
        return Candidates(unit, violation, value, np.broadcast_to(error, value.shape))

    def choose(candidates: Candidates, cell: int) -> int:
        arguments = chosen_cells(design, [cell]), chosen_cells(scales, [cell])
        unit, violation, value, error = candidates
        return most_reliable(problem, unit[:, 0], (value[0], violation[0], error[0]), *arguments)[0]

    result = best_points(
        judge, len(problem.names), cells_of(design), watch,
        jumps=problem.is_motion, choose=choose,
    )  # fmt: skip
    best = result.best
    status = statuses_of(best.value[:, 0], best.violation[:, 0])
    status = np.where(result.done, status, np.int8(STATUS["not_computed"]))
    x = np.where(status == STATUS["optimal"], problem.from_unit_box(best.unit[:, :, 0]), np.nan)
    return Optima(x, status, evaluations=result.evaluations)


def expected_points(variables: int) -> int:
    """Return about how many motions the search for one design follows, to price a study."""
    return 2 * SAMPLES + 200 * TIMES_MOTION * (MEMBERS + 8 * variables)


def best_points(
    judge: Judge,
    variables: int,
    cells: int,
    watch: Watch,
    *,
    jumps: bool = False,
    choose: Callable[[Candidates, int], int] | None = None,
) -> SearchResult:
    """Return the best point of the unit box of each design.

    Where outputs jump, populations start again around the best point, in ever smaller boxes.
    """
    result = _empty_result(variables, cells)
    members = (TIMES_MOTION if jumps else 1) * (MEMBERS + 8 * variables)
    first = _first_candidates(judge, variables, np.arange(cells))
    is_noisy = (first.error > 0).mean(axis=1) > ROUGH
    smooth_cells = np.flatnonzero(~is_noisy)
    if smooth_cells.size and not watch.stopped():
        part_watch = watch.part(smooth_cells.size / cells)
        solved = _search_and_refine(
            lambda unit, numbers: judge(unit, smooth_cells[numbers]), first.of(smooth_cells),
            members, part_watch, MAX_GENERATIONS, jumps=jumps,
        )  # fmt: skip
        result.put(smooth_cells, solved)
    for cell in np.flatnonzero(is_noisy | (result.best.error[:, 0] > 0)).tolist():
        if watch.stopped():
            break
        evaluated = [first.of([cell])]

        def judge_and_keep(
            unit: Array,
            _: NDArray[np.intp],
            cell: int = cell,
            evaluated: list[Candidates] = evaluated,
        ) -> Candidates:
            evaluated.append(judge(unit, np.array([cell])))
            return evaluated[-1]

        part_watch = watch.part(is_noisy[cell] / cells)
        max_generations = ROUGH_GENERATIONS * variables
        solved = _search_and_refine(
            judge_and_keep, evaluated[0], members, part_watch, max_generations, jumps=jumps
        )
        if choose is not None and solved.done.all():
            points = Candidates(
                *(np.concatenate(arrays, axis=-1) for arrays in zip(*evaluated, strict=True))
            )
            solved = solved._replace(best=points.at(np.array([[choose(points, cell)]])))
        result.put([cell], solved)
    return result


def _search_and_refine(
    judge: Judge,
    first: Candidates,
    members: int,
    watch: Watch,
    max_generations: int,
    *,
    jumps: bool,
) -> SearchResult:
    variables, cells, _ = first.unit.shape
    all_cells = np.arange(cells)
    search_fraction = 0.7 if jumps else 1.0
    result = _evolve(
        judge,
        _first_population(first, members),
        all_cells,
        watch.part(search_fraction),
        max_generations,
        jumps=jumps,
    )
    result.evaluations[:] += first.unit.shape[2]
    random = np.random.default_rng(SEED + 1)
    # Jumps leave a population stuck: search again in ever smaller boxes around the best point.
    for width in CLOSER if jumps else ():
        finished = all_cells[result.done]
        if not finished.size or watch.stopped():
            break
        offsets = width * random.uniform(-1, 1, (variables, 1, MEMBERS + 8 * variables))
        offsets[:, :, 0] = 0.0  # the best point itself
        start = judge(np.clip(result.best.unit[:, finished] + offsets, 0.0, 1.0), finished)
        part_watch = watch.part((1 - search_fraction) / len(CLOSER))
        result.evaluations[finished] += start.unit.shape[2]
        result.put(
            finished, _evolve(judge, start, finished, part_watch, max_generations, jumps=jumps)
        )
    return result


def _evolve(
    judge: Judge,
    start: Candidates,
    cells: NDArray[np.intp],
    watch: Watch,
    max_generations: int,
    *,
    jumps: bool,
) -> SearchResult:
    variables, count, members = start.unit.shape
    random = np.random.default_rng(SEED)
    result = _empty_result(variables, count)
    alive, points, reported = np.arange(count), start, 0.0
    for generation in range(1, max_generations + 1):
        if watch.stopped():
            break
        new = judge(_trial_points(points, random), cells[alive])
        if watch.stopped():
            break  # motions that were not followed have no value
        better = (new.violation < points.violation) | (
            (new.violation == points.violation) & (new.value >= points.value)
        )
        points = Candidates(*(np.where(better, *pair) for pair in zip(new, points, strict=True)))
        widths = (points.unit.max(axis=2) - points.unit.min(axis=2)).max(axis=0)
        is_last = generation == max_generations
        # 0 for a population as wide as the box, 1 for one of the width `SMALL`.
        converged = np.log(np.clip(widths, SMALL, 1.0)) / np.log(SMALL)
        progress = 1.0 if is_last else float(1 - (widths.size - converged.sum()) / count)
        if progress > reported:
            watch.advance(progress - reported)
            reported = progress
        ended = (widths < SMALL) | is_last
        value_tolerance, width_tolerance = LEVEL_JUMPS if jumps else LEVEL
        high, low = points.value.max(axis=1), points.value.min(axis=1)
        # All members feasible and of almost the same value: a smooth top is met.
        is_level = (low >= high - value_tolerance * np.abs(high)) & (
            points.violation.max(axis=1) <= 0
        )
        ended |= is_level & (widths < width_tolerance)
        if ended.any():
            finished = points.of(ended)
            evaluations = np.full(int(ended.sum()), members * generation, dtype=np.int64)
            done = np.ones(evaluations.size, dtype=np.bool_)
            result.put(
                alive[ended], SearchResult(finished.at(finished.best()[:, None]), evaluations, done)
            )
            alive, points = alive[~ended], points.of(~ended)
            if not alive.size:
                watch.advance(1.0 - reported)
                break
    return result


def _first_candidates(judge: Judge, variables: int, cells: NDArray[np.intp]) -> Candidates:
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * variables, indexing="ij"))
    points = np.concatenate([corners.reshape(variables, -1), spread(SAMPLES, variables)], axis=1)
    points = points[:, None, :SAMPLES]
    over_the_box = judge(np.broadcast_to(points, (variables, cells.size, SAMPLES)), cells)
    # Sample once more in the region in which the points violate the constraints least.
    least_violating = over_the_box.violation <= over_the_box.violation.min(axis=1, keepdims=True)
    spacing = SAMPLES ** (-1 / variables)
    low = np.where(least_violating, over_the_box.unit, np.inf).min(axis=2, keepdims=True) - spacing
    high = (
        np.where(least_violating, over_the_box.unit, -np.inf).max(axis=2, keepdims=True) + spacing
    )
    low, high = np.maximum(low, 0.0), np.minimum(high, 1.0)
    in_the_region = judge(low + (high - low) * points, cells)
    return Candidates(
        *(np.concatenate(pair, axis=-1) for pair in zip(in_the_region, over_the_box, strict=True))
    )


def _first_population(points: Candidates, members: int) -> Candidates:
    order = np.lexsort((-points.value, points.violation), axis=-1)[:, : members // 2]
    rest = np.broadcast_to(np.arange(members - members // 2), (len(order), members - members // 2))
    return points.at(np.concatenate([order, rest], axis=1))


def _trial_points(points: Candidates, random: np.random.Generator) -> Array:
    unit = points.unit
    variables, _, members = unit.shape
    best = np.take_along_axis(unit, points.best()[None, :, None], axis=2)

    def random_others() -> NDArray[np.intp]:
        return (np.arange(members) + random.integers(1, members, size=members)) % members

    first, second = random_others(), random_others()
    factor = random.uniform(0.4, 1.0, members)
    # Half of the members move towards the best; the others keep separate hills populated.
    towards_best = np.where(random.random(members) < 0.5, factor, 0.0)
    base = np.where(towards_best > 0, unit, unit[:, :, random_others()])
    mutant = base + towards_best * (best - base) + factor * (unit[:, :, first] - unit[:, :, second])
    is_crossed = random.random((variables, 1, members)) < CROSSED
    is_crossed[random.integers(variables, size=members), 0, np.arange(members)] = True
    return np.clip(np.where(is_crossed, mutant, unit), 0.0, 1.0)


# --- points that fill a box


def box_points(variables: int, cells: int, points: int) -> Array:
    """Return points that fill the unit box, shape (variables, n), about `points` of them.

    They are a grid, or an evenly spread sequence for more than four variables, where so coarse a
    grid would hold little but edges. `cells` is the number of designs for which they are used,
    which limits the grid.
    """
    if variables > MAX_GRIDDED:
        return spread(points, variables)
    per_variable = max(5, min(201, int(min(points, MAX_POINTS / cells) ** (1 / variables))))
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, per_variable)] * variables, indexing="ij"))
    return grid.reshape(variables, -1)


# --- values that do not owe their size to chance


def most_reliable(
    problem: OptimisationProblem,
    unit: Array,
    judged: tuple[Array, Array, Array],
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> tuple[int, float]:
    """Return index and objective of the best evaluated point, chosen after longer runs if need be.

    If the motion of the best point repeats, its mean is exact, and it is taken. Else the points of
    the largest objective less its statistical error are followed for longer, and the best of these
    is taken. Points that keep the constraints come first. The objective is -inf if no point has a
    value.
    """
    value, violation, chance_error = judged
    best = int(np.lexsort((-value, violation))[0])
    if not np.isfinite(value[best]) or chance_error[best] == 0:
        return best, float(value[best])
    competing = np.flatnonzero((violation <= violation[best]) & np.isfinite(value))
    cells = np.minimum((unit[:, competing] * NICHES).astype(np.int64), NICHES - 1)
    error = _known_errors(chance_error[competing])
    # Candidates to follow longer: the best in each cell of a grid, ranked by value less a fraction
    # of its error.
    ranked = [_best_of_each_cell(cells, value[competing] - fraction * error) for fraction in SHARES]
    chosen = competing[np.unique(np.concatenate(ranked))]
    for factor, max_kept in ROUNDS:
        x = problem.from_unit_box(unit[:, chosen])
        value_again, violation, error = problem.longer(factor).judged(x, design, scales)
        order = np.lexsort((_known_errors(error) - value_again, violation))[:max_kept]
        chosen = chosen[order]
    return int(chosen[0]), float(value_again[order[0]])


def _known_errors(chance_error: Array) -> Array:
    return np.where(chance_error < UNKNOWN, chance_error, 0.0)


def _best_of_each_cell(cells: NDArray[np.int64], value: Array) -> NDArray[np.intp]:
    order = np.argsort(-value, kind="stable")
    _, first = np.unique(cells[:, order], axis=1, return_index=True)
    return order[np.sort(first)][:FOLLOWED]
