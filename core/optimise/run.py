"""Carrying out an optimisation: solve every design, check the answers, label them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.afresh import judged_afresh
from vibrafeed.core.optimise.checked import checked
from vibrafeed.core.optimise.front import distinct_points, find_front, knee
from vibrafeed.core.optimise.labels import label
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optimisation import Optimisation
from vibrafeed.core.optimise.problem import LIMIT, OptimisationProblem, cells_of, chosen_cells
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.study.optimise_study import Limited, Pareto
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
    """Return every variable of an optimisation for some designs, by name, and the method's message.

    Where fresh points of uncertain parameters break a limit, the design is solved again with those
    points among its nodes; it is infeasible if that does not help.

    Parameters
    ----------
    prepared : Optimisation
        The study.
    design : mapping of str to ndarray, each of shape (cells,)
        The fixed parameters, SI units. The points of a trade-off front stand one after another.
    watch : Watch
        Takes the progress and may stop the work.
    retries : int
        How often designs are solved again, at most.
    """
    problem, method = prepared.problem, prepared.method
    scales = problem.scales(design)
    if isinstance(problem.criterion, Pareto):
        return _fronts(prepared, problem.criterion, design, scales, watch)
    optima = METHODS[method].solve(problem, design, scales, watch)
    optima = replace(optima, x=problem.whole(optima.x))
    if problem.uncertain is None:
        return checked(prepared, optima, design, scales), optima.says
    fresh = judged_afresh(problem, optima.x, design, scales, method)
    broken, nodes = fresh.surprises(problem, optima.x, design, scales)
    if not retries:
        optima, nodes = optima.made_infeasible(broken), {}
    if not nodes and retries < RETRIES:
        # The points that have become nodes favour the answer, as those of a search do.
        fresh = judged_afresh(problem, optima.x, design, scales, method, number=2)
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
    """Return every variable of the trade-off fronts of some designs, and the method's message.

    Arguments as in `find_front`. A point that a front has many times is checked once.
    """
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

    A design is a point of the grid. A limit that the criterion sets on the other output is among
    them.
    """
    shape = tuple(grid.shape.values())
    design = {
        name: np.broadcast_to(values, shape).reshape(-1) for name, values in grid.si().items()
    }
    return with_limit(problem, design, grid.cells)


def with_limit(
    problem: OptimisationProblem, design: Mapping[str, Array], cells: int
) -> dict[str, Array]:
    """Return designs, shape (cells,), with the limit of the criterion; infinite without one."""
    criterion = problem.criterion
    limit = criterion.limit if isinstance(criterion, Limited) else np.inf
    return {**design, LIMIT: np.full(cells, limit)}


__all__ = ["compute", "designs_of", "label"]
