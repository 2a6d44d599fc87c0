"""The loops that fill arrays with the same axes, and the steps of numpy around them.

What depends on few axes is computed by numpy on its own small grid, once, what is left by one loop
without an array in between. A function that a loop cannot repeat to the last bit (a logarithm, a
sine) splits it: numpy takes it between two loops, some thousand cells at a time.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loop_source import LONGEST_ROW, Loop, LoopWriter, Order, order_of
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.trace import IN_LOOPS, Graph, Node, Traced

FEW_CELLS = 4096
"""Values that numpy computes in some microseconds: so few are not computed in a loop."""
OWN_GRID = 16
"""A function that loops do not have is computed by numpy on the grid of its own axes where that is
so many times smaller than the whole."""

SPECIAL = (0.0, 1.0, math.inf)
"""Values of a node by which other steps become superfluous, as in x * 1."""

Array = NDArray[Any]
Runner = Callable[[Sequence[NDArray[np.int64]], Iterable[Array]], None]
Shape = tuple[tuple[str, int], ...]
"""Axes and their lengths."""

_compiled: set[str] = set()  # the sources of loops that have run in this process


@dataclass(frozen=True)
class Stage:
    """A loop, and the functions of numpy that follow it; none after the last loop.

    The loop, if numpy lacks something, fills `columns`; the results of `functions` are columns of
    later loops.
    """

    loop: Loop | None
    columns: tuple[Node, ...]
    functions: tuple[Node, ...]


@dataclass(frozen=True)
class Program:
    """The loops that fill arrays with the same axes: their order, and what is done in turn."""

    order: Order
    stages: tuple[Stage, ...]

    @cached_property
    def sources(self) -> frozenset[str]:
        """The sources of all loops."""
        return frozenset(stage.loop.source for stage in self.stages if stage.loop)

    @property
    def missing(self) -> frozenset[str]:
        """The sources of loops that are not compiled in this process."""
        return self.sources - _compiled

    def mark_compiled(self) -> None:
        """Record that its loops are compiled in this process."""
        _compiled.update(self.sources)


@lru_cache(maxsize=256)
def edge_of(
    traced: Traced,
    names: tuple[str, ...],
    shape: Shape,
    row: tuple[str, ...] = (),
) -> tuple[Node, ...]:
    """Return the nodes of a graph that numpy computes beforehand, and loops take as inputs.

    That is what has few values, what no loop can compute, and what these need. A value that depends
    on axes of the row and on others would be laid out as a row for each of the others: loops
    compute it.
    """
    lengths = dict(shape)
    cells = math.prod(lengths.values())
    few_values, many_values = max(FEW_CELLS, cells // FEW_CELLS), cells // OWN_GRID

    def is_by_numpy(node: Node) -> bool:
        size = math.prod(lengths[name] for name in node.axes)
        if node.function is None:
            return True
        if node.function not in IN_LOOPS:
            return size <= many_values
        return size <= few_values and (node.axes <= row_axes or not node.axes & row_axes)

    row_axes = frozenset(row)
    edge: dict[int, Node] = {}
    seen = set[int]()
    to_visit = [result for name in names if isinstance(result := traced.results[name], Node)]
    while to_visit:
        node = to_visit.pop()
        if is_by_numpy(node):
            edge[node.number] = node
        elif node.number not in seen:
            seen.add(node.number)
            to_visit += node.before
    return tuple(edge[number] for number in sorted(edge))


@lru_cache(maxsize=256)
def program_of(
    traced: Traced,
    names: tuple[str, ...],
    shape: Shape,
    special: tuple[tuple[int, float | bool], ...],
) -> Program:
    """Return the compiled loops that compute some results of a graph over axes of given lengths.

    Operations that the values of `special` nodes make superfluous are left out.
    """
    lengths = dict(shape)
    _, nodes = _rebuilt(traced, names, edge_of(traced, names, shape, ()), special)
    order = order_of(tuple(lengths), lengths, nodes)
    results, needed = _rebuilt(traced, names, edge_of(traced, names, shape, order.inner), special)
    return Program(order, _stages(order, needed, results))


def _is_called(node: Node) -> bool:
    return node.function is not None and node.function not in IN_LOOPS


def _stages(order: Order, nodes: Sequence[Node], results: Sequence[Any]) -> tuple[Stage, ...]:
    # Functions that loops cannot call run by numpy between loops: each stage is a loop that
    # computes their inputs, then those functions.
    stage_of = _stage_numbers(results)
    leaves = [node for node in nodes if node.function is None]
    calls = [(stage_of[node.number], node) for node in nodes if _is_called(node)]
    stages, columns_before = [], dict[int, Node]()
    for stage in range(1, 1 + max((call_stage for call_stage, _ in calls), default=0)):
        functions = tuple(node for call_stage, node in calls if call_stage == stage)
        inputs = {operand.number: operand for node in functions for operand in node.before}
        columns = tuple(inputs[number] for number in inputs if number not in columns_before)
        loop = None
        if columns:
            loop = LoopWriter(
                order, leaves, columns_before.values(), columns, is_last=False
            ).write()
        stages.append(Stage(loop, columns, functions))
        columns_before |= {node.number: node for node in functions}
    last_loop = LoopWriter(order, leaves, columns_before.values(), results, is_last=True)
    return (*stages, Stage(last_loop.write(), (), ()))


def _rebuilt(
    traced: Traced,
    names: tuple[str, ...],
    edge: Iterable[Node],
    special: tuple[tuple[int, float | bool], ...],
) -> tuple[list[Any], list[Node]]:
    # The results on a new graph whose leaves are the nodes `edge`, and the nodes that they need.
    graph = Graph()
    rebuilt_nodes: dict[int, Any] = {
        node.number: graph.leaf(str(node.number), node.axes, node.dtype) for node in edge
    } | dict(special)

    def rebuilt(operand: Any) -> Any:
        if not isinstance(operand, Node):
            return operand
        if operand.number not in rebuilt_nodes:
            assert operand.function is not None
            rebuilt_nodes[operand.number] = graph.apply(
                operand.function, map(rebuilt, operand.inputs)
            )
        return rebuilt_nodes[operand.number]

    with np.errstate(all="ignore"):  # constants may overflow where their result is not used
        results = [rebuilt(traced.results[name]) for name in names]
    return results, [graph.nodes[number] for number in sorted(_stage_numbers(results))]


def _stage_numbers(results: Iterable[Any]) -> dict[int, int]:
    # The stage after which each node is known: one more with each call of numpy on the way.
    stages: dict[int, int] = {}

    def visit(node: Node) -> int:
        if node.number not in stages:
            stage_before = max((visit(input_node) for input_node in node.before), default=0)
            stages[node.number] = stage_before + _is_called(node)
        return stages[node.number]

    for result in results:
        if isinstance(result, Node):
            visit(result)
    return stages


class Values:
    """Values of nodes that numpy computes, each once, on the grid of its own axes."""

    def __init__(self, traced: Traced, plan: Plan, grid: Grid):
        # Leaves have the values of parameters and defaults; other nodes follow on request.
        self._axes = tuple(grid.axes)
        self._values: dict[int, Any] = {}
        values = grid.si()
        for node in traced.graph.nodes:
            if node.function is None:
                value = values[node.name] if node.name in values else plan.defaults[node.name]
                self._values[node.number] = np.asarray(value)

    def of(self, operand: Any) -> Any:
        """Return the value of a node, computed once, of size 1 along other axes; or a constant."""
        if not isinstance(operand, Node):
            return operand
        if operand.number not in self._values:
            self._values[operand.number] = operand.function(*map(self.of, operand.inputs))  # type: ignore[misc]
        return self._values[operand.number]

    def over(self, operand: Any, axes: Iterable[str]) -> Array:
        """Return the value of a node or constant as an array over `axes`, or as a scalar."""
        value, kept = np.asarray(self.of(operand)), set(axes)
        if not value.ndim:
            return value
        dropped = tuple(k for k, name in enumerate(self._axes) if name not in kept)
        return value.squeeze(dropped)

    def special(self, nodes: Iterable[Node]) -> tuple[tuple[int, float | bool], ...]:
        """Return the nodes that are 0, 1, infinite, true or false everywhere, with the value."""
        constants: list[tuple[int, float | bool]] = []
        for node in nodes:
            value = np.asarray(self.of(node))
            first_value = value.item(0)
            if value.item(-1) != first_value:  # quick, and true of most
                continue
            if value.dtype.kind != "b" and (first_value not in SPECIAL or np.signbit(value).any()):
                continue
            if (value == first_value).all():
                constants.append((node.number, first_value))
        return tuple(constants)


def even_length(size: int, most: int) -> int:
    """Return the length of pieces of an axis, nearly equal and at most `most` values long."""
    pieces = -(-size // max(1, min(size, most)))
    return -(-size // pieces)


def cells_between(ends: NDArray[np.int64]) -> int:
    """Return the cells of a task: `ends` are start and stop of each loop, shape (loops, 2)."""
    return math.prod(stop - start for start, stop in ends.tolist())


def bind_stages(program: Program, operands: Mapping[int, Any]) -> Runner:
    """Return a function that runs the compiled loops of a program on some cells.

    The function takes arrays of int64: start and stop along the row and along each outer loop, then
    the strides of the loops in the results; and the flat arrays that the last loop fills.
    """
    loops = (stage.loop for stage in program.stages)
    calls = [None if loop is None else _bind_loop(loop, operands) for loop in loops]
    stages_before_last, last_call = list(zip(program.stages, calls[:-1], strict=False)), calls[-1]
    assert last_call is not None

    def run(ranges: Sequence[NDArray[np.int64]], results: Iterable[Array]) -> None:
        columns: dict[int, Array] = {}
        for stage, call in stages_before_last:
            if call is not None:
                count = cells_between(ranges[0])
                outputs = {node.number: np.empty(count, node.dtype) for node in stage.columns}
                call(ranges[:2], columns, outputs.values())
                columns |= outputs
            with np.errstate(all="ignore"):  # each thread has its own
                for node in stage.functions:
                    inputs = (
                        columns[operand.number] if isinstance(operand, Node) else operand
                        for operand in node.inputs
                    )
                    columns[node.number] = node.function(*inputs)  # type: ignore[misc]
        last_call(ranges, columns, results)

    return run


def _bind_loop(
    loop: Loop, operands: Mapping[int, Any]
) -> Callable[[Sequence[NDArray[np.int64]], Mapping[int, Array], Iterable[Array]], None]:
    from vibrafeed.core.compiled import compiled_source  # numba takes a second to import

    function = compiled_source(loop.source)
    inputs = [operands[node.number] for node in loop.arrays]

    def call(
        ranges: Sequence[NDArray[np.int64]],
        columns: Mapping[int, Array],
        results: Iterable[Array],
    ) -> None:
        loop_columns = [columns[node.number] for node in loop.columns]
        rows = (np.empty(LONGEST_ROW) for _ in loop.rows)
        function(*ranges, *inputs, *loop_columns, *rows, *results)

    return call


def lay_out_operands(
    program: Program, traced: Traced, values: Values, grid: Grid
) -> dict[int, Any]:
    """Return the inputs of a program's loops, arrays or numbers, by number of the node.

    A value that changes along the row is spread over all of it.
    """
    order, shape = program.order, grid.shape
    row_length = math.prod(shape[name] for name in order.inner)
    operands: dict[int, Any] = {}
    for leaf in (node for stage in program.stages if stage.loop for node in stage.loop.arrays):
        node = traced.graph.nodes[int(leaf.name)]
        value = values.over(node, order.axes)
        if not value.ndim:
            operands[leaf.number] = value[()].item()
            continue
        loop_axes, is_row = order.kept(node), order.is_row(node)
        shape_of_array = [shape[name] for name in loop_axes] + [row_length] * is_row
        array = value if not is_row else value.astype(np.float64, copy=False)
        if value.size != math.prod(shape_of_array):
            lengths = [
                shape[name] if name in loop_axes or (name in order.inner and is_row) else 1
                for name in order.axes
            ]
            array = np.empty(lengths, array.dtype)
            array[...] = value
        operands[leaf.number] = np.ascontiguousarray(array.reshape(shape_of_array))
    return operands
