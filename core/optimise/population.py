"""Differential evolution of many designs at once (Storn and Price 1997, with Deb's rules 2000).

All designs share the same random numbers: an answer does not depend on what else is in the batch.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.optimise.codes import STATUS
from core.optimise.optima import Optima
from core.optimise.problem import OptimisationProblem, cells_of, chosen_cells, columns
from core.optimise.robust import NODES
from core.optimise.single import spread
from core.watch import Watch

MEMBERS = 24  # of a population, and 8 more for each variable
SAMPLES = 1024  # points from which the first members are taken
MAX_GENERATIONS = 400
CROSSED = 0.9  # share of the variables that change
SMALL = 1e-12  # a population that is narrower in all variables has converged
CELLS = 256  # designs at a time: some 10,000 points a generation stay in the cache
SEED = 1


def by_population(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the best member of every design's population.

    A member that keeps the constraints beats one that does not; of two that do not, the smaller
    violation wins. `design` and `scales` have the shape (cells,).
    """
    cells = cells_of(design)
    step = max(1, CELLS * NODES // max(NODES, problem.nodes))
    pieces = [
        _evolve(problem, chosen_cells(design, piece), chosen_cells(scales, piece), watch, cells)
        for piece in (slice(start, start + step) for start in range(0, cells, step))
    ]
    return Optima(
        np.concatenate([piece.x for piece in pieces], axis=1),
        np.concatenate([piece.status for piece in pieces]),
        evaluations=np.concatenate([np.asarray(piece.evaluations) for piece in pieces]),
    )


def _evolve(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
    all_cells: int,
) -> Optima:
    """Evolve the populations of some designs until they have narrowed; return their best members.

    `all_cells` is the number of designs of the whole study, for the progress.
    """
    cells, count = cells_of(design), len(problem.names)
    members = MEMBERS + 8 * count
    random = np.random.default_rng(SEED)
    best = np.full((count, cells), np.nan)
    ranks = np.full((2, cells), np.nan)
    used = np.zeros(cells, dtype=np.int64)
    alive = np.arange(cells)
    here, sizes = columns(design), columns(scales)
    unit, beyond, value = _first(problem, here, sizes, members)
    done = np.zeros(cells, dtype=np.bool_)
    reported = 0.0
    for generation in range(MAX_GENERATIONS):
        if watch.stopped():
            break
        trial = _trial(unit, beyond, value, random)
        b, v = _judge(problem, trial, here, sizes)
        better = (b < beyond) | ((b == beyond) & (v >= value))
        unit = np.where(better, trial, unit)
        beyond, value = np.where(better, b, beyond), np.where(better, v, value)
        widths = (unit.max(axis=2) - unit.min(axis=2)).max(axis=0)
        narrow = widths < SMALL
        last = generation == MAX_GENERATIONS - 1
        share = _share_done(widths, cells) if not last else 1.0
        if share > reported:
            watch.advance((share - reported) * cells / all_cells)
            reported = share
        ended = narrow | last
        if ended.any():
            cell = alive[ended]
            top = np.lexsort((-value[ended], beyond[ended]), axis=-1)[:, 0]
            rows = np.arange(top.size)
            best[:, cell] = unit[:, ended][:, rows, top]
            ranks[:, cell] = beyond[ended][rows, top], value[ended][rows, top]
            used[cell] = 2 * SAMPLES + members * (generation + 1)
            done[cell] = True
            stay = ~ended
            alive, unit = alive[stay], unit[:, stay]
            beyond, value = beyond[stay], value[stay]
            if not alive.size:
                break
            here, sizes = columns(chosen_cells(design, alive)), columns(chosen_cells(scales, alive))
    status = np.where(ranks[0] <= 0, STATUS["optimal"], STATUS["infeasible"])
    status = np.where(np.isposinf(ranks[0]), STATUS["no_value"], status)
    status = np.where(done, status, STATUS["not_computed"]).astype(np.int8)
    x = problem.lower[:, None] + (problem.upper - problem.lower)[:, None] * best
    x = np.where(best == 1, problem.upper[:, None], x)
    return Optima(np.where(status == STATUS["optimal"], x, np.nan), status, evaluations=used)


def _share_done(widths: Array, cells: int) -> float:
    """Return the progress of populations, 0 to 1, from how far they have narrowed.

    `widths` are those of the populations still evolving, as shares of the bounds; the others of
    `cells` are done.
    """
    orders = np.log(np.clip(widths, SMALL, 1.0)) / np.log(SMALL)
    return float(1 - (widths.size - orders.sum()) / cells)


def _first(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    members: int,
) -> tuple[Array, Array, Array]:
    """Return the first members of each population, with their violations and objectives.

    Half are the best of many points, half are spread out. Where little is feasible, the box around
    the first feasible points is sampled once more. The members are shares of the bounds, shape
    (variables, cells, members); `design` and `scales` have the shape (cells, 1).
    """
    count, cells = len(problem.names), next(iter(design.values())).shape[0]
    points = np.concatenate([_corners(count), spread(SAMPLES, count)], axis=1)[:, None, :SAMPLES]
    wide = np.broadcast_to(points, (count, cells, SAMPLES))
    wide_beyond, wide_value = _judge(problem, wide, design, scales)
    near = wide_beyond <= wide_beyond.min(axis=1, keepdims=True)
    apart = SAMPLES ** (-1 / count)
    low = np.where(near, wide, np.inf).min(axis=2, keepdims=True) - apart
    high = np.where(near, wide, -np.inf).max(axis=2, keepdims=True) + apart
    low, high = np.maximum(low, 0.0), np.minimum(high, 1.0)
    close = low + (high - low) * points
    close_beyond, close_value = _judge(problem, close, design, scales)
    unit = np.concatenate([close, wide], axis=2)
    beyond = np.concatenate([close_beyond, wide_beyond], axis=1)
    value = np.concatenate([close_value, wide_value], axis=1)
    order = np.lexsort((-value, beyond), axis=-1)[:, : members // 2]
    rest = np.broadcast_to(np.arange(members - members // 2), (cells, members - members // 2))
    place = np.concatenate([order, rest], axis=1)
    return (
        np.take_along_axis(unit, place[None], axis=2),
        np.take_along_axis(beyond, place, axis=1),
        np.take_along_axis(value, place, axis=1),
    )


def _judge(
    problem: OptimisationProblem,
    unit: Array,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
) -> tuple[Array, Array]:
    """Return violation and objective of points in the unit box, shape (cells, n).

    `unit` are the points as shares of the bounds, shape (variables, cells, n).
    """
    lower, upper = problem.lower[:, None, None], problem.upper[:, None, None]
    x = np.where(unit == 1, upper, lower + unit * (upper - lower))
    value, beyond = problem.judged(x, design, scales)
    return beyond, value


def _trial(unit: Array, beyond: Array, value: Array, random: np.random.Generator) -> Array:
    """Return a trial point for each member: steps towards the best and along differences of others.

    `unit` are the members as shares of the bounds, shape (variables, cells, members); `beyond` and
    `value` are their violations and objectives. All designs get the same random numbers.
    """
    count, _, members = unit.shape
    top = np.lexsort((-value, beyond), axis=-1)[:, 0]
    best = np.take_along_axis(unit, top[None, :, None], axis=2)
    first, second = _others(members, random), _others(members, random)
    share = random.uniform(0.4, 1.0, members)
    # Half go towards the best, half do their own search: the rest keeps hills apart.
    towards = np.where(random.random(members) < 0.5, share, 0.0)
    third = _others(members, random)
    base = np.where(towards > 0, unit, unit[:, :, third])
    moved = base + towards * (best - base) + share * (unit[:, :, first] - unit[:, :, second])
    crossed = random.random((count, 1, members)) < CROSSED
    crossed[random.integers(count, size=members), 0, np.arange(members)] = True
    # What leaves the box is put onto its edge: maxima there are met exactly.
    return np.clip(np.where(crossed, moved, unit), 0.0, 1.0)


def _others(members: int, random: np.random.Generator) -> NDArray[np.intp]:
    """Return a random other member for each member."""
    return (np.arange(members) + random.integers(1, members, size=members)) % members


def _corners(count: int) -> Array:
    """Return the corners of the unit box, shape (count, 2^count)."""
    return np.stack(np.meshgrid(*[[0.0, 1.0]] * count, indexing="ij")).reshape(count, -1)
