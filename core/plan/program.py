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
    few, many = max(FEW_CELLS, cells // FEW_CELLS), cells // OWN_GRID

    def by_numpy(node: Node) -> bool:
        size = math.prod(lengths[name] for name in node.axes)
        if node.function is None:
            return True
        if node.function not in IN_LOOPS:
            return size <= many
        return size <= few and (node.axes <= along or not node.axes & along)

    along = frozenset(row)
    edge: dict[int, Node] = {}
    seen = set[int]()
    left = [one for name in names if isinstance(one := traced.results[name], Node)]
    while left:
        node = left.pop()
        if by_numpy(node):
            edge[node.number] = node
        elif node.number not in seen:
            seen.add(node.number)
            left += node.before
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
    _, nodes = _renewed(traced, names, edge_of(traced, names, shape, ()), special)
    order = order_of(tuple(lengths), lengths, nodes)
    edge = edge_of(traced, names, shape, order.inner)
    results, needed = _renewed(traced, names, edge, special)
    return Program(order, _stages(order, needed, results))


def _is_called(node: Node) -> bool:
    return node.function is not None and node.function not in IN_LOOPS


def _stages(order: Order, nodes: Sequence[Node], results: Sequence[Any]) -> tuple[Stage, ...]:
    ready = _ready(results)
    leaves = [node for node in nodes if node.function is None]
    turns = [(ready[node.number], node) for node in nodes if _is_called(node)]
    stages, known = [], dict[int, Node]()
    for now in range(1, 1 + max((turn for turn, _ in turns), default=0)):
        after = tuple(node for turn, node in turns if turn == now)
        wanted = {one.number: one for node in after for one in node.before}
        columns = tuple(wanted[number] for number in wanted if number not in known)
        loop = None
        if columns:
            loop = LoopWriter(order, leaves, known.values(), columns, is_last=False).write()
        stages.append(Stage(loop, columns, after))
        known |= {node.number: node for node in after}
    last = LoopWriter(order, leaves, known.values(), results, is_last=True)
    return (*stages, Stage(last.write(), (), ()))


def _renewed(
    traced: Traced,
    names: tuple[str, ...],
    edge: Iterable[Node],
    special: tuple[tuple[int, float | bool], ...],
) -> tuple[list[Any], list[Node]]:
    graph = Graph()
    new: dict[int, Any] = {
        node.number: graph.leaf(str(node.number), node.axes, node.dtype) for node in edge
    } | dict(special)

    def renewed(operand: Any) -> Any:
        if not isinstance(operand, Node):
            return operand
        if operand.number not in new:
            assert operand.function is not None
            new[operand.number] = graph.apply(operand.function, map(renewed, operand.inputs))
        return new[operand.number]

    with np.errstate(all="ignore"):  # of a number that is far from where it is taken
        results = [renewed(traced.results[name]) for name in names]
    return results, [graph.nodes[number] for number in sorted(_ready(results))]


def _ready(results: Iterable[Any]) -> dict[int, int]:
    ready: dict[int, int] = {}

    def visit(node: Node) -> int:
        if node.number not in ready:
            before = max((visit(inner) for inner in node.before), default=0)
            ready[node.number] = before + _is_called(node)
        return ready[node.number]

    for result in results:
        if isinstance(result, Node):
            visit(result)
    return ready


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
        """Return the value of a node, computed once, of size 1 along other axes; or a constant."""
        if not isinstance(operand, Node):
            return operand
        if operand.number not in self._known:
            self._known[operand.number] = operand.function(*map(self.of, operand.inputs))  # type: ignore[misc]
        return self._known[operand.number]

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
            first = value.item(0)
            if value.item(-1) != first:  # at once, as with most
                continue
            if value.dtype.kind != "b" and (first not in SPECIAL or np.signbit(value).any()):
                continue
            if (value == first).all():
                constants.append((node.number, first))
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
    between, last = list(zip(program.stages, calls[:-1], strict=False)), calls[-1]
    assert last is not None

    def run(ranges: Sequence[NDArray[np.int64]], results: Iterable[Array]) -> None:
        columns: dict[int, Array] = {}
        for stage, call in between:
            if call is not None:
                count = cells_between(ranges[0])
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
        own = [columns[node.number] for node in loop.columns]
        rows = (np.empty(LONGEST_ROW) for _ in loop.rows)
        function(*ranges, *inputs, *own, *rows, *results)

    return call


def lay_out_operands(
    program: Program, traced: Traced, values: Values, grid: Grid
) -> dict[int, Any]:
    """Return the inputs of a program's loops, arrays or numbers, by number of the node.

    A value that changes along the row is spread over all of it.
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
