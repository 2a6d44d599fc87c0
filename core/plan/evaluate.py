"""Evaluation of a plan on a grid: arrays in, arrays out.

There is one door and two ways behind it. numpy runs the equations block by block; what is large, or
comes often, goes through a loop that is compiled from them. Both give the same bits.
"""

import math
import os
import sys
import threading
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from itertools import product
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loop_source import Order
from vibrafeed.core.plan.plan import Known, Plan, regimes, run, run_equations
from vibrafeed.core.plan.program import (
    FEW_CELLS,
    Array,
    Program,
    Values,
    bind_stages,
    cells_between,
    edge_of,
    even_length,
    lay_out_operands,
    program_of,
)
from vibrafeed.core.plan.trace import Traced, traced
from vibrafeed.core.watch import Watch

_T = TypeVar("_T")

Progress = Callable[[float], object]
Results = Mapping[str, NDArray[Any]]

BLOCK_CELLS = 32_768  # 256 KiB an array: a handful of them stay in a second-level cache

LOOPED_FROM = 16_384
"""Number of cells that numpy computes in about a millisecond: no loop is compiled for fewer."""
LOADED_FROM, COMPILED_FROM, CACHED_FROM = 5_000_000, 10_000_000, 500_000
"""Numbers of cells that numpy computes in place of a loop before the compiler is loaded, the loop
compiled, or a compiled one looked for on the disk."""

_seen: defaultdict[str, int] = defaultdict(int)
"""Cells that numpy has computed in place of a loop, by its source."""
_lock = threading.Lock()


TASK_CELLS = 1 << 20
"""Most cells of one call of a loop, which then takes some hundred microseconds."""
COLUMN_CELLS = 1 << 15
"""The same where numpy works between loops: its arrays stay in the second-level cache."""
FEWEST_SHARED = 1 << 17
"""Fewest cells for which another thread is used."""
SHARES = 4
"""Tasks for each thread, at least: who had the processor for longer takes more of them."""


def evaluate(
    plan: Plan,
    grid: Grid,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, NDArray[Any]]:
    """Return the outputs and verdicts of a plan over a grid, each over its own axes, SI units.

    `threads` is the most among which cells are shared out, one a core if left out; any thread calls
    `progress` with the share done since.
    """
    results = empty_results(plan, grid)
    cells = grid.size(list(groups_of(plan, grid))[-1])
    graph = traced(plan, grid.along) if cells > LOOPED_FROM else None
    fused = None if graph is None else Fused(plan, graph, grid)
    if fused is not None and is_compiled_for(fused.missing, cells):
        fused.run(results, threads, progress)
    else:
        evaluate_in_blocks(plan, grid, results, progress=progress)
    return results


def evaluate_in_blocks(
    plan: Plan,
    grid: Grid,
    results: Results,
    *,
    block_cells: int = BLOCK_CELLS,
    progress: Progress | None = None,
) -> None:
    """Compute a plan on a grid block by block with numpy: the readable reference.

    The leading axes are taken value by value, and the last of them in steps, so that about
    `block_cells` cells are computed at once. `results` has an array for each output and verdict,
    over the axes that it depends on, which is filled in SI units. `progress` is called after each
    block with its share of the grid.
    """
    depends = plan.depends_on(grid.along)
    axes_used = grid.dims(set().union(*(depends[name] for name in results)))
    steps = _steps(grid, axes_used, block_cells)
    values = grid.si()
    # Equations that depend on none of the sliced axes are computed once.
    blockwise = [equation for equation in plan.equations if depends[equation.gives] & steps.keys()]
    once = [equation for equation in plan.equations if not depends[equation.gives] & steps.keys()]
    known_before = run(
        once, values | {name: np.asarray(value) for name, value in plan.defaults.items()}
    )
    for starts in product(*(range(0, grid.shape[axis], step) for axis, step in steps.items())):
        block = {
            axis: slice(start, min(start + steps[axis], grid.shape[axis]))
            for axis, start in zip(steps, starts, strict=True)
        }
        block_values = {
            name: values[name].take(
                range(block[axis].start, block[axis].stop), axis=[*grid.axes].index(axis)
            )
            for name, axis in grid.along.items()
            if axis in block
        }
        _write(plan, grid, run(blockwise, known_before | block_values), block, results)
        if progress is not None:
            sizes = (axis_slice.stop - axis_slice.start for axis_slice in block.values())
            progress(math.prod(sizes) / grid.size(steps))


def _steps(grid: Grid, used: tuple[str, ...], block_cells: int) -> dict[str, int]:
    fits = (count for count in range(len(used)) if grid.size(used[count:]) <= block_cells)
    sliced = used[: next(fits, len(used))]
    last = {axis: max(1, block_cells // grid.size(used[len(sliced) :])) for axis in sliced[-1:]}
    return dict.fromkeys(sliced, 1) | last


def evaluate_at_once(plan: Plan, grid: Grid, into: Results, watch: Watch) -> None:
    """Compute a plan with simulated motion on the whole grid at once, and write into `into`.

    The equations of motion share out their cells among threads themselves, and ask `watch` whether
    to stop: then cells are left that are not computed.
    """
    values = grid.si()
    quantities = run_equations(plan, {name: values[name] for name in plan.parameters}, watch)
    _write(plan, grid, quantities, {}, into)


def _write(
    plan: Plan, grid: Grid, quantities: Known, block: Mapping[str, slice], results: Results
) -> None:
    depends, quantities = plan.depends_on(grid.along), quantities | regimes(plan, quantities)
    for name, array in results.items():
        values = np.asarray(quantities[name])
        if values.ndim:  # every axis of the grid, of size 1 where it does not depend on it
            axes = enumerate(grid.axes)
            values = values.squeeze(
                tuple(position for position, axis in axes if axis not in depends[name])
            )
        array[tuple(block.get(axis, slice(None)) for axis in grid.dims(depends[name]))] = values


def empty_results(plan: Plan, grid: Grid) -> dict[str, NDArray[Any]]:
    """Return arrays, not filled, for the outputs (doubles) and verdicts (int8) of a plan."""
    depends = plan.depends_on(grid.along)
    dtypes = dict.fromkeys(plan.outputs, np.float64) | dict.fromkeys(plan.verdict_names, np.int8)
    return {
        name: np.empty([grid.shape[axis] for axis in grid.dims(depends[name])], dtype)
        for name, dtype in dtypes.items()
    }


def is_compiled_for(missing: Iterable[str], cells: int) -> bool:
    """True if loops that are not compiled yet are to be, for a number of cells.

    Cells are counted for each source: a loop is compiled once numpy has computed so many that
    compiling would have taken no longer.
    """
    missing = tuple(missing)
    if not missing:
        return True
    with _lock:
        for source in missing:
            _seen[source] += cells
        cells_seen = max(_seen[source] for source in missing)
    if cells_seen < LOADED_FROM and "numba" not in sys.modules:
        return False
    from vibrafeed.core.kernel_cache import is_on_disk

    return cells_seen >= sum(
        CACHED_FROM if is_on_disk(source) else COMPILED_FROM for source in missing
    )


class Fused:
    """The graph of a plan on a grid, ready to be run."""

    def __init__(self, plan: Plan, traced: Traced, grid: Grid):
        # Results over the same axes are one group; groups of few cells need no compiled loops.
        self._grid, self._traced = grid, traced
        self._values = Values(traced, plan, grid)
        self._groups = groups_of(plan, grid)
        with np.errstate(all="ignore"):  # equations for arrays compute what a choice leaves out
            self._programs = {
                dims: self._program(dims, names)
                for dims, names in self._groups.items()
                if grid.size(dims) > FEW_CELLS
            }

    @property
    def sources(self) -> frozenset[str]:
        """The sources of all loops that the plan needs."""
        return frozenset().union(*(program.sources for program in self._programs.values()))

    @property
    def missing(self) -> frozenset[str]:
        """The sources of loops that are not compiled in this process."""
        return frozenset().union(*(program.missing for program in self._programs.values()))

    def run(
        self,
        results: Mapping[str, Array],
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        """Compute the outputs and verdicts of the plan over the grid, into contiguous arrays."""
        with np.errstate(all="ignore"):
            for dims, names in self._groups.items():
                arrays = [results[name] for name in names]
                if dims in self._programs:
                    progress_of_last = progress if dims == tuple(self._groups)[-1] else None
                    self._run(dims, arrays, threads or os.cpu_count() or 1, progress_of_last)
                else:
                    for name, array in zip(names, arrays, strict=True):
                        array[...] = self._values.over(self._traced.results[name], dims)

    def _program(self, dims: tuple[str, ...], names: tuple[str, ...]) -> Program:
        shape = tuple((name, self._grid.shape[name]) for name in dims)
        special = self._values.special(edge_of(self._traced, names, shape))
        return program_of(self._traced, names, shape, special)

    def _run(
        self,
        dims: tuple[str, ...],
        results: Sequence[Array],
        threads: int,
        progress: Progress | None,
    ) -> None:
        program, grid = self._programs[dims], self._grid
        loops = bind_stages(program, lay_out_operands(program, self._traced, self._values, grid))
        sizes = [grid.shape[name] for name in dims]
        strides = np.array(
            [math.prod(sizes[dims.index(name) + 1 :]) for name in program.order.outer],
            dtype=np.int64,
        )
        flat = [array.reshape(-1) for array in results]
        cells = grid.size(dims)
        max_cells = TASK_CELLS if len(program.stages) == 1 else COLUMN_CELLS

        def run(ends: NDArray[np.int64]) -> None:
            loops((ends, strides), flat)
            if progress is not None:
                progress(cells_between(ends) / cells)

        cells_per_task = cells if cells < FEWEST_SHARED else -(-cells // (SHARES * threads))
        # The largest first, so that small remainders fill the gaps at the end.
        tasks = sorted(
            _tasks(program.order, grid.shape, min(max_cells, cells_per_task)),
            key=cells_between,
            reverse=True,
        )
        if program.missing:
            run(tasks.pop(0))  # one thread compiles the loops
            program.mark_compiled()
        share_out(run, tasks, threads)


def groups_of(plan: Plan, grid: Grid) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Return the outputs and verdicts of a plan by the axes that they depend on, largest last."""
    depends = plan.depends_on(grid.along)
    groups: dict[tuple[str, ...], list[str]] = {}
    for name in (*plan.outputs, *plan.verdict_names):
        groups.setdefault(grid.dims(depends[name]), []).append(name)
    return {dims: tuple(groups[dims]) for dims in sorted(groups, key=grid.size)}


def _tasks(order: Order, shape: Mapping[str, int], max_cells: int) -> Iterator[NDArray[np.int64]]:
    """Yield start and stop of each task on the row and on each outer loop, shape (loops + 1, 2)."""
    row_length = math.prod(shape[name] for name in order.inner)
    sizes = [row_length, *(shape[name] for name in order.outer)]
    steps = [cells_inside := min(row_length, max_cells)]
    for size in reversed(sizes[1:]):
        steps.insert(1, even_length(size, max_cells // cells_inside))
        cells_inside *= steps[1]
    starts = (range(0, size, step) for size, step in zip(sizes, steps, strict=True))
    for start in product(*starts):
        yield np.array([start, np.minimum(np.add(start, steps), sizes)], dtype=np.int64).T.copy()


def share_out(function: Callable[[_T], Any], tasks: Iterable[_T], threads: int) -> None:
    """Call a function for each task in several threads, and return when all are done.

    The calling thread is one of them, and does everything itself if the others are busy. The first
    error of a call is raised; tasks that have not begun are left out then. The threads are kept: to
    start two takes as long as a sweep of some 10^5 cells.
    """
    waiting = deque(tasks)
    errors: list[BaseException] = []

    def work() -> None:
        try:
            while True:
                try:
                    task = waiting.popleft()
                except IndexError:
                    return
                function(task)
        except BaseException as error:
            errors.append(error)
            waiting.clear()

    helpers = min(threads, len(waiting)) - 1
    calls = [_pool(threads).submit(work) for _ in range(helpers)]
    work()
    running = [call for call in calls if not call.cancel()]
    try:
        wait(running)
    except BaseException:  # they still write into the caller's arrays
        wait(running)
        raise
    if errors:
        raise errors[0]


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max(1, threads - 1), thread_name_prefix="shared")


if hasattr(os, "register_at_fork"):  # a fork has no threads but its own
    os.register_at_fork(after_in_child=_pool.cache_clear)
