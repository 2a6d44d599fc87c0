"""Evaluation of a plan on a grid: arrays in, arrays out.

There is one door and two ways behind it. numpy runs the equations block by block; what is large, or
comes often, goes through a loop that is compiled from them. Both give the same bits.
"""

from __future__ import annotations

import sys
import threading
from collections import defaultdict
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.blocks import Progress, Results, evaluate_in_blocks
from vibrafeed.core.plan.equations import regimes, run_equations
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loops.fused import Fused, groups_of
from vibrafeed.core.plan.loops.trace import traced
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.watch import Watch

FEW_CELLS = 16_384
"""Number of cells that numpy computes in about a millisecond: no loop is compiled for fewer."""
LOADED_FROM, COMPILED_FROM, CACHED_FROM = 5_000_000, 10_000_000, 500_000
"""Numbers of cells that numpy computes in place of a loop before the compiler is loaded, the loop
compiled, or a compiled one looked for on the disk."""

_seen: defaultdict[str, int] = defaultdict(int)
"""Cells that numpy has computed in place of a loop, by its source."""
_lock = threading.Lock()


def evaluate(
    plan: Plan,
    grid: Grid,
    *,
    into: Results | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, NDArray[Any]]:
    """Return the outputs of a plan over a grid, each over the axes that it depends on.

    Parameters
    ----------
    plan, grid
        What to compute, and where; every parameter of the plan is on the grid.
    into : mapping of str to ndarray, optional
        Contiguous arrays to fill instead of new ones.
    threads : int, optional
        Most threads among which cells are shared out; one a core if left out. What is computed does
        not depend on it.
    progress : callable, optional
        Called with the share done since the last call, maybe from another thread.

    Returns
    -------
    dict of str to ndarray
        The asked outputs and verdicts; SI units.
    """
    results: dict[str, NDArray[Any]] = dict(into or empty_results(plan, grid))
    fused = _fused(plan, grid)
    if fused is None:
        evaluate_in_blocks(plan, grid, results, progress=progress)
    else:
        fused.run(results, threads, progress)
    return results


def evaluate_at_once(plan: Plan, grid: Grid, into: Results, watch: Watch) -> None:
    """Compute a plan with simulated motion on the whole grid at once, and write into `into`.

    The equations of motion share out their cells among threads themselves, and ask `watch` whether
    to stop: then cells are left that are not computed. `into` has an array for each output and
    verdict over its own axes, SI units.
    """
    depends = plan.depends_on(grid.axes)
    given = grid.si()
    known = run_equations(plan, {name: given[name] for name in plan.parameters}, watch)
    known |= regimes(plan, known)
    for name, array in into.items():
        values = np.asarray(known[name])
        if values.ndim:
            axes = enumerate(grid.axes)
            values = values.squeeze(tuple(at for at, axis in axes if axis not in depends[name]))
        array[...] = values


def empty_results(plan: Plan, grid: Grid) -> dict[str, NDArray[Any]]:
    """Return uninitialised arrays for the outputs and verdicts of a plan, to be filled later.

    Each has the shape of the axes of the grid on which it depends; regimes are int8, outputs
    doubles.
    """
    depends = plan.depends_on(grid.axes)
    results: dict[str, NDArray[Any]] = {}
    for name in (*plan.outputs, *plan.verdict_names):
        shape = tuple(grid.shape[axis] for axis in grid.dims(depends[name]))
        results[name] = np.empty(shape, np.int8 if name in plan.verdict_names else np.float64)
    return results


def _fused(plan: Plan, grid: Grid) -> Fused | None:
    cells = grid.size(list(groups_of(plan, grid))[-1])
    if cells <= FEW_CELLS:
        return None
    graph = traced(plan, grid.axes)
    if graph is None:
        return None
    fused = Fused(plan, graph, grid)
    return fused if is_compiled_for(fused.missing, cells) else None


def is_compiled_for(missing: Iterable[str], cells: int) -> bool:
    """True if loops that are not compiled yet are to be, for a number of cells.

    `missing` are the sources of the loops. Cells are counted for each source: a loop is compiled
    once numpy has computed so many that compiling would have taken no longer.
    """
    missing = tuple(missing)
    if not missing:
        return True
    with _lock:
        for source in missing:
            _seen[source] += cells
        seen = max(_seen[source] for source in missing)
    if seen < LOADED_FROM and "numba" not in sys.modules:
        return False
    from vibrafeed.core.kernel_cache import is_on_disk

    return seen >= sum(CACHED_FROM if is_on_disk(one) else COMPILED_FROM for one in missing)
