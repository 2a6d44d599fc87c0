"""Differential evolution of many designs at once (Storn and Price 1997, with Deb's rules 2000).

All designs share the same random numbers: an answer does not depend on what else is in the batch.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.codes import STATUS
from vibrafeed.core.optimise.optima import Optima
from vibrafeed.core.optimise.problem import OptimisationProblem, cells_of, chosen_cells, columns
from vibrafeed.core.optimise.robust import NODES
from vibrafeed.core.optimise.single import spread
from vibrafeed.core.watch import Watch

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
    """Return the best candidate of every design, found by differential evolution.

    A candidate that keeps the constraints beats one that does not; of two that do not, the smaller
    violation wins. Each design has a population of its own; designs are taken in pieces that fit
    the cache.

    Parameters
    ----------
    design, scales : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters of each design, SI units, and the sizes of its outputs, by which
        violations are divided.
    watch : Watch
        Takes the progress, and may stop the search.

    Returns
    -------
    Optima
        The best values, shape (variables, cells), NaN where there are none; statuses and numbers of
        evaluations, shape (cells,).
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
    """Return the best members of some designs' populations, after these have narrowed.

    It is differential evolution of all designs at once; a design whose population has narrowed is
    finished.

    Parameters
    ----------
    design, scales : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters, SI units, and the sizes of outputs, by which violations are divided.
    watch : Watch
        Takes the progress, and may stop the search: unfinished designs then have no optimum.
    all_cells : int
        The number of designs of the whole study, for the progress.

    Returns
    -------
    Optima
        The best values, shape (variables, cells), NaN where there are none; statuses and numbers of
        evaluations, shape (cells,).
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
    """Return the first members of each design's population, with their violations and objectives.

    Half are the best of many points, half are spread out. Where few points keep the constraints,
    the box around them is sampled once more.

    Parameters
    ----------
    design, scales : mapping of str to ndarray, each of shape (cells, 1)
        The fixed parameters, and the sizes of outputs, by which violations are divided.
    members : int
        Number of members of a population.

    Returns
    -------
    tuple of ndarray
        Members as shares of the bounds, shape (variables, cells, members); violations and
        objectives, shape (cells, members).
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
    """Return violation of constraints and objective of points, each of shape (cells, n).

    `unit` are the points as shares of the bounds, shape (variables, cells, n); `design` and
    `scales` have the fixed parameters and the sizes of outputs, shape (cells, 1).
    """
    lower, upper = problem.lower[:, None, None], problem.upper[:, None, None]
    x = np.where(unit == 1, upper, lower + unit * (upper - lower))
    value, beyond = problem.judged(x, design, scales)
    return beyond, value


def _trial(unit: Array, beyond: Array, value: Array, random: np.random.Generator) -> Array:
    """Return a trial point for each member of the populations, of the shape of `unit`.

    It is a step towards the best member or none, and along the difference of two others, in some of
    the variables (differential evolution).

    Parameters
    ----------
    unit : ndarray, shape (variables, cells, members)
        The members as shares of the bounds.
    beyond, value : ndarray, shape (cells, members)
        Their violations and objectives.
    random : numpy.random.Generator
        The source of random numbers, which are the same for all designs.
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
