"""The loops that fill arrays with the same axes, and the steps of numpy around them.

What depends on few axes is computed by numpy on its own small grid, once. What is left has a value
for each cell, or nearly: one loop computes it without an array in between. A function that numpy
has and a loop cannot repeat to the last bit (a logarithm, a sine) splits the loop: numpy takes it
between two loops, some thousand cells at a time.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from vibrafeed.core.plan.loops.order import Order, order_of
from vibrafeed.core.plan.loops.source import LONGEST_ROW, Lanes, Loop, write_loop
from vibrafeed.core.plan.loops.trace import Graph, Node, Traced
from vibrafeed.core.plan.operations import IN_LOOPS

FEW_CELLS = 4096
"""Values that numpy computes in some microseconds: so few are not computed in a loop."""
OWN_GRID = 16
"""A function that loops do not have is computed by numpy on the grid of its own axes where that is
so many times smaller than the whole."""
PAIRED_CELLS = 1 << 28
"""Fewest cells of a grid whose rows are gathered in pairs: 0.05 to 0.3 ns are saved a cell, and the
loop takes a second more to be compiled, once."""
MAX_VALUES = 1 << 20
"""Most values of an array that numpy computes before a loop with lanes, whose grid may have any
size."""

Shape = tuple[tuple[str, int], ...]
"""Axes and their lengths."""


@dataclass(frozen=True)
class Stage:
    """A loop, and the functions of numpy that follow it; none after the last loop.

    The loop fills `columns` (there is none where numpy has all that it needs), and then the results
    of `functions` are columns of later loops.
    """

    loop: Loop | None
    columns: tuple[Node, ...]
    functions: tuple[Node, ...]


@dataclass(frozen=True)
class Program:
    """The loops that fill arrays with the same axes.

    Attributes
    ----------
    order : Order
        The loops over their axes.
    stages : tuple of Stage
        What is done, one after the other.
    lanes : Lanes or None
        How the last loop takes cells into lanes; None if it stores them.
    """

    order: Order
    stages: tuple[Stage, ...]
    lanes: Lanes | None = None

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """The sources of all loops."""
        return tuple(stage.loop.source for stage in self.stages if stage.loop)


@lru_cache(maxsize=256)
def edge_of(
    traced: Traced,
    names: tuple[str, ...],
    shape: Shape,
    row: tuple[str, ...] = (),
    most: int | None = None,
) -> tuple[Node, ...]:
    """Return the nodes of a graph that numpy computes beforehand, and loops take as inputs.

    A node is an operation. By numpy goes what has few values, what no loop can compute unless it
    has too many values, and what these need. A value that depends on axes of the row and on others
    would be laid out as a row for each of the others: loops compute it themselves, if they can.

    Parameters
    ----------
    names : tuple of str
        The results wanted.
    shape : tuple of (str, int)
        Names and lengths of the axes.
    row : tuple of str
        The axes of the innermost loop.
    most : int, optional
        The largest number of values of an array.
    """
    lengths = dict(shape)
    cells = math.prod(lengths.values())
    few, many = max(FEW_CELLS, cells // FEW_CELLS), cells // OWN_GRID
    if most is not None:
        few, many = min(few, most), min(many, most)

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
    updates: tuple[str, ...] = (),
) -> Program:
    """Return the compiled loops that compute some results of a graph over axes of given lengths.

    Parameters
    ----------
    traced : Traced
        The graph of operations and its results.
    names : tuple of str
        The results wanted.
    shape : tuple of (str, int)
        Names and lengths of the axes.
    special : tuple of (int, number)
        Numbers of nodes that have one value everywhere, with it: operations that it makes
        superfluous are left out.
    updates : tuple of str, optional
        For each result a name of `UPDATES`: the loops then gather cells into totals instead of
        storing them.
    """
    lengths = dict(shape)
    most = MAX_VALUES if updates else None
    _, nodes = _renewed(traced, names, edge_of(traced, names, shape, (), most), special)
    order = order_of(tuple(lengths), lengths, nodes, LONGEST_ROW if updates else math.inf)
    lanes = None
    if updates:
        period = math.prod(lengths[name] for name in order.inner[1:])
        pairs = math.prod(lengths.values()) >= PAIRED_CELLS and "store" not in updates
        lanes = Lanes(updates, period, LONGEST_ROW // period * period, pairs)
    edge = edge_of(traced, names, shape, order.inner, most)
    results, needed = _renewed(traced, names, edge, special)
    stages = _stages(order, needed, results, lanes)
    return Program(order, stages, lanes)


def _is_called(node: Node) -> bool:
    return node.function is not None and node.function not in IN_LOOPS


def _stages(
    order: Order, nodes: Sequence[Node], results: Sequence[Any], lanes: Lanes | None
) -> tuple[Stage, ...]:
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
            loop = write_loop(order, leaves, known.values(), columns, is_last=False)
        stages.append(Stage(loop, columns, after))
        known |= {node.number: node for node in after}
    last = write_loop(order, leaves, known.values(), results, is_last=True, lanes=lanes)
    return (*stages, Stage(last, (), ()))


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
            new[operand.number] = graph.apply(
                operand.function, [renewed(each) for each in operand.inputs]
            )
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
