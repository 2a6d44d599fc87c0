"""Running the loops of a plan on a grid."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loops.order import Order
from vibrafeed.core.plan.loops.program import FEW_CELLS, Program, edge_of, program_of
from vibrafeed.core.plan.loops.source import LONGEST_ROW, Loop
from vibrafeed.core.plan.loops.trace import Node, Traced
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.threads import share_out

TASK_CELLS = 1 << 20
"""Most cells of one call of a loop, which then takes some hundred microseconds."""
COLUMN_CELLS = 1 << 15
"""The same where numpy works between loops: its arrays stay in the second-level cache."""
FEWEST_SHARED = 1 << 17
"""Fewest cells for which another thread is used."""
SHARES = 4
"""Tasks for each thread, at least: who had the processor for longer takes more of them."""
SPECIAL = (0.0, 1.0, math.inf)
"""Values of a node by which other steps become superfluous, as in x * 1."""

Array = NDArray[Any]
Progress = Callable[[float], object]
Runner = Callable[[Sequence[NDArray[np.int64]], Iterable[Array]], None]

_compiled: set[str] = set()  # the sources of loops that have run in this process


class Fused:
    """The graph of a plan on a grid, ready to be run.

    Parameters
    ----------
    plan, traced, grid
        What to compute, its graph over the axes of the grid, and where.
    """

    def __init__(self, plan: Plan, traced: Traced, grid: Grid):
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
        return self.sources - _compiled

    def run(
        self,
        results: Mapping[str, Array],
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> None:
        """Compute the outputs and verdicts of the plan over the grid, into `results`.

        Parameters
        ----------
        results : mapping of str to ndarray
            Contiguous arrays over the axes that each output depends on, in the grid's order.
        threads : int, optional
            Among which cells are shared out; one a core if left out.
        progress : callable, optional
            Called with the share done since the last call, by any thread.
        """
        with np.errstate(all="ignore"):
            for dims, names in self._groups.items():
                arrays = [results[name] for name in names]
                if dims in self._programs:
                    tell = progress if dims == tuple(self._groups)[-1] else None
                    self._run(dims, arrays, threads or os.cpu_count() or 1, tell)
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
        most = TASK_CELLS if len(program.stages) == 1 else COLUMN_CELLS

        def run(ends: NDArray[np.int64]) -> None:
            loops((ends, strides), flat)
            if progress is not None:
                progress(_cells_between(ends) / cells)

        share = cells if cells < FEWEST_SHARED else -(-cells // (SHARES * threads))
        # The largest first: what is left over at the ends of axes fills the gaps.
        tasks = sorted(
            _tasks(program.order, grid.shape, min(most, share)), key=_cells_between, reverse=True
        )
        if not _compiled.issuperset(program.sources):
            run(tasks.pop(0))  # compiling is for one
            _compiled.update(program.sources)
        share_out(run, tasks, threads)


def _cells_between(ends: NDArray[np.int64]) -> int:
    return math.prod(stop - start for start, stop in ends.tolist())


def even_length(size: int, most: int) -> int:
    """Return the length of pieces of an axis, nearly equal and at most `most` values long."""
    pieces = -(-size // max(1, min(size, most)))
    return -(-size // pieces)


def missing(program: Program) -> frozenset[str]:
    """Return the sources of a program's loops that are not compiled in this process yet."""
    return frozenset(program.sources) - _compiled


def mark_compiled(program: Program) -> None:
    """Record that the loops of a program are compiled in this process."""
    _compiled.update(program.sources)


def _new_rows(count: int) -> list[Array]:
    return [np.empty(LONGEST_ROW) for _ in range(count)]


def bind_stages(
    program: Program,
    operands: Mapping[int, Any],
    rows: Callable[[int], Iterable[Array]] = _new_rows,
) -> Runner:
    """Return a function that runs the compiled loops of a program on some cells.

    A program is the graph of a plan as loops over cells; a function that loops do not have splits
    it, and is taken by numpy between them. What is the same for all cells is found here, once.
    `operands` are the inputs that numpy has computed, the result of `lay_out_operands`; `rows` is
    asked for places for the rows that a loop keeps, by their number, in each call.

    The function takes arrays of int64: start and stop along the row (the innermost loop) and along
    each outer loop, then the strides of the loops in the results, and for loops that add up
    statistics the strides of cell numbers. It takes the flat arrays that the last loop fills, too.
    """
    loops = (stage.loop for stage in program.stages)
    calls = [None if loop is None else _bind_loop(loop, operands, rows) for loop in loops]
    between, last = list(zip(program.stages, calls[:-1], strict=False)), calls[-1]
    assert last is not None

    def run(ranges: Sequence[NDArray[np.int64]], results: Iterable[Array]) -> None:
        columns: dict[int, Array] = {}
        for stage, call in between:
            if call is not None:
                count = _cells_between(ranges[0])
                made = {node.number: np.empty(count, node.dtype) for node in stage.columns}
                call(ranges[:2], columns, made.values())
                columns |= made
            with np.errstate(all="ignore"):  # it is a setting of the thread
                for node in stage.functions:
                    inputs = (columns[n.number] if isinstance(n, Node) else n for n in node.inputs)
                    columns[node.number] = node.function(*inputs)  # type: ignore[misc]
        last(ranges, columns, results)

    return run


def _bind_loop(
    loop: Loop, operands: Mapping[int, Any], rows: Callable[[int], Iterable[Array]]
) -> Callable[[Sequence[NDArray[np.int64]], Mapping[int, Array], Iterable[Array]], None]:
    # Importing numba takes a second: only runs that gain from it pay for it.
    from vibrafeed.core.compiled import compiled_source  # numba, for those whom it repays

    function = compiled_source(loop.source)
    inputs = [operands[node.number] for node in loop.arrays]

    def call(
        ranges: Sequence[NDArray[np.int64]],
        columns: Mapping[int, Array],
        results: Iterable[Array],
    ) -> None:
        own = [columns[node.number] for node in loop.columns]
        function(*ranges, *inputs, *own, *rows(len(loop.rows)), *results)

    return call


def lay_out_operands(
    program: Program, traced: Traced, values: Values, grid: Grid
) -> dict[int, Any]:
    """Return the input arrays of a program's loops, by number of the node.

    They are arrays in the order of the loops, with the axes of loops and row (the innermost loop),
    or plain numbers. `values` computes them by numpy on the grid; a value that changes along the
    row is spread over all of it.
    """
    order, shape = program.order, grid.shape
    row = math.prod(shape[name] for name in order.inner)
    operands: dict[int, Any] = {}
    for leaf in (node for stage in program.stages if stage.loop for node in stage.loop.arrays):
        node = traced.graph.nodes[int(leaf.name)]
        value = values.over(node, order.axes)
        if not value.ndim:
            operands[leaf.number] = value[()].item()
            continue
        kept, is_row = order.kept(node), order.is_row(node)
        whole = [shape[name] for name in kept] + [row] * is_row
        laid = value if not is_row else value.astype(np.float64, copy=False)
        if value.size != math.prod(whole):
            lengths = [
                shape[name] if name in kept or (name in order.inner and is_row) else 1
                for name in order.axes
            ]
            laid = np.empty(lengths, laid.dtype)
            laid[...] = value
        operands[leaf.number] = np.ascontiguousarray(laid.reshape(whole))
    return operands


def groups_of(plan: Plan, grid: Grid) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Return the outputs and verdicts of a plan grouped by the axes that they depend on.

    The groups are in order of their number of points, the largest last. Each group is computed by
    loops of its own over these axes, the keys of the result.
    """
    depends = plan.depends_on(grid.axes)
    groups: dict[tuple[str, ...], list[str]] = {}
    for name in (*plan.outputs, *plan.verdict_names):
        groups.setdefault(grid.dims(depends[name]), []).append(name)
    return {dims: tuple(groups[dims]) for dims in sorted(groups, key=grid.size)}


class Values:
    """Values of nodes that numpy computes, each once, on the grid of its own axes."""

    def __init__(self, traced: Traced, plan: Plan, grid: Grid):
        self._axes = tuple(grid.axes)
        self._known: dict[int, Any] = {}
        values = grid.si()
        for node in traced.graph.nodes:
            if node.function is None:
                value = values[node.name] if node.name in values else plan.defaults[node.name]
                self._known[node.number] = np.asarray(value)

    def of(self, operand: Any) -> Any:
        """Return the value of an operand over all axes of the grid, of size 1 where it is constant.

        `operand` is a node, an operation of the graph, whose value is computed once by numpy and
        kept, or a constant, which is returned itself.
        """
        if not isinstance(operand, Node):
            return operand
        if operand.number not in self._known:
            self._known[operand.number] = operand.function(*map(self.of, operand.inputs))  # type: ignore[misc]
        return self._known[operand.number]

    def over(self, operand: Any, axes: Iterable[str]) -> Array:
        """Return the value of a node or constant as an array over `axes`, or as a scalar.

        `axes` include all axes on which the operand depends; the others are dropped.
        """
        value, kept = np.asarray(self.of(operand)), set(axes)
        if not value.ndim:
            return value
        dropped = tuple(k for k, name in enumerate(self._axes) if name not in kept)
        return value.squeeze(dropped)

    def special(self, nodes: Iterable[Node]) -> tuple[tuple[int, float | bool], ...]:
        """Return the nodes that are 0, 1, infinite, true or false everywhere, with the value.

        A node is an operation of the graph. Each is a pair of the node's number and its value: a
        loop without the operations that such values make superfluous is faster.
        """
        constants: list[tuple[int, float | bool]] = []
        for node in nodes:
            value = np.asarray(self.of(node))
            first = value.item(0)
            if value.item(-1) != first:  # at once, as with most
                continue
            if value.dtype.kind != "b" and (first not in SPECIAL or np.signbit(value).any()):
                continue
            if (value == first).all():
                constants.append((node.number, first))
        return tuple(constants)


def _tasks(order: Order, shape: Mapping[str, int], most: int) -> Iterator[NDArray[np.int64]]:
    row = math.prod(shape[name] for name in order.inner)
    sizes = [row, *(shape[name] for name in order.outer)]
    steps = [inside := min(row, most)]
    for size in reversed(sizes[1:]):
        steps.insert(1, even_length(size, most // inside))
        inside *= steps[1]
    starts = (range(0, size, step) for size, step in zip(sizes, steps, strict=True))
    for at in product(*starts):
        yield np.array(
            [
                (start, min(start + step, size))
                for start, step, size in zip(at, steps, sizes, strict=True)
            ],
            dtype=np.int64,
        )
