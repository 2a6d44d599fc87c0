"""The loops over the axes of what is computed: which are joined into a row, which stand outside.

The trailing axes are joined into one row that the innermost loop goes along, so that a processor's
wide registers are full. The others are loops around it, in the order that lets most steps stand
outside of the last.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.plan.loops.trace import Node

LEAST_ROW = 64
"""Fewest cells of a row, unless all axes are joined."""
TURN = 250.0
"""Cost of beginning a row, in additions of a row's loop."""
LAID = 40.0
"""Cost per cell of laying a value out along a row before the loops, in additions."""
LANES, UNROLLED = 4, 16
"""Additions that a processor does at once in a row, and cells of one turn of the row's loop."""
SLOW: dict[Any, float] = {np.divide: 15.0, np.sqrt: 20.0, np.reciprocal: 15.0}
"""Cost of a step, in additions; 1 for functions that are not here."""


@dataclass(frozen=True)
class Order:
    """The loops over the axes of what is computed.

    Attributes
    ----------
    axes : tuple of str
        All of them, in the order of the grid.
    outer : tuple of str
        Those that are loops, outermost first.
    inner : tuple of str
        The trailing axes, joined into one row.
    """

    axes: tuple[str, ...]
    outer: tuple[str, ...]
    inner: tuple[str, ...]

    def level(self, node: Node) -> int:
        """Return the number of outer loops within which a node is computed, for its axes."""
        return max((k + 1 for k, name in enumerate(self.outer) if name in node.axes), default=0)

    def is_row(self, node: Node) -> bool:
        """True if a node has a value per cell of a row."""
        return any(name in node.axes for name in self.inner)

    def kept(self, node: Node) -> tuple[str, ...]:
        """Return the loop axes of a node, in the order of the grid."""
        return tuple(name for name in self.axes if name in node.axes and name not in self.inner)


def order_of(
    axes: Sequence[str],
    shape: Mapping[str, int],
    nodes: Collection[Node],
    longest: float = math.inf,
) -> Order:
    """Return the order of loops over some axes that makes the work of a graph of operations least.

    An operation stands in the outermost loop that it can, so that the order decides how often it is
    done. `nodes` are the operations and the inputs that they need, `shape` has the length of each
    axis. A row, the innermost loop, has at most `longest` cells for each value of its first axis.
    """
    steps = [node for node in nodes if node.function]
    orders = []
    for count in range(len(axes) + 1):
        row = math.prod(shape[name] for name in axes[count:])
        period = math.prod(shape[name] for name in axes[count + 1 :])
        if period <= longest and (not count or row >= LEAST_ROW):
            outer = _outwards(axes[:count], shape, steps)
            orders.append(Order(tuple(axes), outer, tuple(axes[count:])))
    return min(orders, key=lambda order: work_of(order, shape, nodes))


def _outwards(
    axes: Sequence[str], shape: Mapping[str, int], steps: Collection[Node]
) -> tuple[str, ...]:
    left, outer = list(axes), list[str]()
    work = [(SLOW.get(step.function, 1.0), step.axes) for step in steps]
    while left:
        # `work` is what stands within all loops that are left. A loop of one turn costs nothing.
        repeated = {
            name: sum(weight for weight, among in work if name in among) * (shape[name] > 1)
            for name in left
        }
        least = min(left, key=repeated.__getitem__)
        left.remove(least)
        outer.insert(0, least)
        work = [(weight, among) for weight, among in work if least not in among]
    return tuple(outer)


def work_of(order: Order, shape: Mapping[str, int], nodes: Collection[Node]) -> float:
    """Return the cost of computing a graph of operations in an order of loops, to compare orders.

    Its unit is the addition of two numbers within a row, the innermost loop. `nodes` are operations
    and inputs, `shape` has the length of each axis.
    """
    row = math.prod(shape[name] for name in order.inner)
    # What a row has beyond whole turns of its loop is taken cell by cell.
    along = row + (LANES - 1) * (row % UNROLLED)
    turns = [1]
    for name in order.outer:
        turns.append(turns[-1] * shape[name])
    work = TURN * turns[-1]
    for node in nodes:
        is_row = order.is_row(node)
        if node.function:
            each = along if is_row else LANES
            work += SLOW.get(node.function, 1.0) * turns[order.level(node)] * each
        elif is_row:
            work += LAID * row
    return work
