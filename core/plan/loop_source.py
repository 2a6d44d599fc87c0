"""The loops over the axes of what is computed, and the source of one loop for steps of a graph.

The trailing axes are joined into one row that the innermost loop goes along, so that a processor's
wide registers are full. The others are loops around it, in the order that lets most steps stand
outside of the last. A row that an outer loop makes is kept for the loops within.

Within a loop everything but truth is a float, whole numbers too, and truth where it is kept: a
processor changes the width of its values at the price of many steps.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.plan.trace import IN_LOOPS, Node

LONGEST_ROW = 1024
"""Most cells of a row that a loop takes at once: the rows that it keeps stay in the first and
second cache."""
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
    """The loops over the axes of what is computed: outermost first, then those of the row."""

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
) -> Order:
    """Return the order of loops over some axes that makes the work of a graph least."""
    steps = [node for node in nodes if node.function]
    orders = []
    for count in range(len(axes) + 1):
        row_length = math.prod(shape[name] for name in axes[count:])
        if not count or row_length >= LEAST_ROW:
            outer = _loops_from_outside(axes[:count], shape, steps)
            orders.append(Order(tuple(axes), outer, tuple(axes[count:])))
    return min(orders, key=lambda order: _work_of(order, shape, nodes))


def _loops_from_outside(
    axes: Sequence[str], shape: Mapping[str, int], steps: Collection[Node]
) -> tuple[str, ...]:
    axes_left, outer = list(axes), list[str]()
    costs = [(SLOW.get(step.function, 1.0), step.axes) for step in steps]
    while axes_left:
        # `costs` are of the steps within all loops that are left, of which the innermost is the one
        # that repeats least work. A loop of one turn costs nothing.
        cost_of_repeats = {
            name: sum(weight for weight, step_axes in costs if name in step_axes)
            * (shape[name] > 1)
            for name in axes_left
        }
        cheapest = min(axes_left, key=cost_of_repeats.__getitem__)
        axes_left.remove(cheapest)
        outer.insert(0, cheapest)
        costs = [(weight, step_axes) for weight, step_axes in costs if cheapest not in step_axes]
    return tuple(outer)


def _work_of(order: Order, shape: Mapping[str, int], nodes: Collection[Node]) -> float:
    row_length = math.prod(shape[name] for name in order.inner)
    # Cells beyond whole turns of the unrolled loop are computed one by one.
    padded_row = row_length + (LANES - 1) * (row_length % UNROLLED)
    turns = [1]
    for name in order.outer:
        turns.append(turns[-1] * shape[name])
    work = TURN * turns[-1]
    for node in nodes:
        is_row = order.is_row(node)
        if node.function:
            steps_per_turn = padded_row if is_row else LANES
            work += SLOW.get(node.function, 1.0) * turns[order.level(node)] * steps_per_turn
        elif is_row:
            work += LAID * row_length
    return work


@dataclass(frozen=True)
class Loop:
    """The source of a compiled loop, and what it is given, in the order of its arguments.

    It is a function ``loop(ends, strides, ...)``. `arrays` numpy has made, laid out by
    `Order.kept`, and rows last; `columns` have a value for each cell in turn; `rows` are places of
    `LONGEST_ROW` cells for rows that are kept.
    """

    source: str
    arrays: tuple[Node, ...]
    columns: tuple[Node, ...]
    rows: tuple[Node, ...]


class LoopWriter:
    """Writes the source of a loop that computes some nodes for each cell.

    Numpy has made the values of `leaves` on their own axes, and those of `columns` for each cell.
    Of the last loop the results are written where the grid has them, else one after another.
    """

    def __init__(
        self,
        order: Order,
        leaves: Collection[Node],
        columns: Collection[Node],
        results: Sequence[Any],
        *,
        is_last: bool,
    ):
        self.order, self.results, self.is_last = order, results, is_last
        self.leaves = {node.number for node in leaves}
        self.columns = {node.number for node in columns}
        self.deepest = len(order.outer)
        self.steps: dict[int, Node] = {}  # nodes that it computes, inputs first
        self.inputs: dict[int, Node] = {}  # nodes that it reads from arrays made beforehand
        self.by_cell = set(self.columns)  # numbers of nodes that depend on a column
        for result in results:
            if isinstance(result, Node):
                self._add_steps(result)
        self.nodes = [self.steps[number] for number in sorted(self.steps)]
        self.stored_rows = self._rows_to_store()
        self.computed_here: set[int] = set()

    def _add_steps(self, node: Node) -> None:
        # Inputs first, so that the steps are in an order in which they can be computed.
        if node.number in self.steps or node.number in self.inputs:
            return
        if node.number in self.leaves | self.columns:
            self.inputs[node.number] = node
            return
        for before in node.before:
            self._add_steps(before)
        if any(before.number in self.by_cell for before in node.before):
            self.by_cell.add(node.number)
        self.steps[node.number] = node

    def _rows_to_store(self) -> dict[int, Node]:  # rows that a deeper loop needs
        uses = [(before, self._level(node)) for node in self.nodes for before in node.before]
        uses += [(result, self.deepest) for result in self.results if isinstance(result, Node)]
        stored = {
            node.number: node
            for node, level in uses
            if node.number in self.steps and self._is_row(node) and self._level(node) < level
        }
        return dict(sorted(stored.items()))

    def _level(self, node: Node) -> int:
        return self.deepest if node.number in self.by_cell else self.order.level(node)

    def _is_row(self, node: Node) -> bool:
        return node.number in self.by_cell or self.order.is_row(node)

    def _term(self, node: Any) -> str:
        # A value in the loop's text: c of a column, a of an array, r of a stored row, t of a step.
        if not isinstance(node, Node):
            return _literal(node)
        number = node.number
        if number in self.columns:
            return f"c{number}[done + i]"
        if number in self.inputs:
            if not self.order.is_row(node):
                return f"a{number}_"
            row = f"a{number}_[i]"
        elif number in self.stored_rows and number not in self.computed_here:
            row = f"r{number}[i]"
        else:
            return f"t{number}"
        return f"({row} != 0.0)" if node.dtype == np.bool_ else row

    def write(self) -> Loop:
        """Return the loop."""
        arrays = [node for node in self.inputs.values() if node.number in self.leaves]
        columns = [node for node in self.inputs.values() if node.number in self.columns]
        lines: list[str] = []
        for level in range(self.deepest + 1):
            indent = "    " * (level + 2)
            if level:
                lines.append(
                    f"{indent[4:]}for i{level} in range(ends[{level}, 0], ends[{level}, 1]):"
                )
            lines += self._at_level(level, arrays, indent)
        names = [
            *(f"a{node.number}" for node in arrays),
            *(f"c{node.number}" for node in columns),
            *(f"r{number}" for number in self.stored_rows),
            *(f"o{k}" for k in range(len(self.results))),
        ]
        head = [
            f"def loop(ends, strides, {', '.join(names)}):",
            "    done = 0",
            f"    for at in range(ends[0, 0], ends[0, 1], {LONGEST_ROW}):",
            f"        stop = min(at + {LONGEST_ROW}, ends[0, 1])",
            "        cells = stop - at",
        ]
        source = "\n".join([*head, *lines]) + "\n"
        return Loop(source, tuple(arrays), tuple(columns), tuple(self.stored_rows.values()))

    def _at_level(self, level: int, arrays: Sequence[Node], indent: str) -> list[str]:
        # The lines within so many outer loops: elements of arrays, steps, then the loop over the
        # row.
        scalars, rows = self._enter(level)
        lines = [self._input_line(node) for node in arrays if self.order.level(node) == level]
        lines += [f"t{node.number} = {self._expression(node)}" for node in scalars]
        if level == self.deepest:
            stored = [f"o{k}_[i] = {self._term(result)}" for k, result in enumerate(self.results)]
            lines += [
                *self._result_slices(),
                *_row_loop([*self._row_lines(rows), *stored]),
                "done += cells",
            ]
        elif rows:
            lines += _row_loop(self._row_lines(rows))
        return [f"{indent}{line}" for line in lines]

    def _enter(self, level: int) -> tuple[list[Node], list[Node]]:
        here = [node for node in self.nodes if self._level(node) == level]
        self.computed_here = {node.number for node in here}
        scalars = [node for node in here if not self._is_row(node)]
        return scalars, [node for node in here if self._is_row(node)]

    def _input_line(self, node: Node) -> str:
        counters = {name: f"i{k + 1}" for k, name in enumerate(self.order.outer)}
        index = ", ".join(counters[name] for name in self.order.kept(node))
        element = f"a{node.number}[{index}]" if index else f"a{node.number}"
        return f"a{node.number}_ = {element}{'[at:stop]' if self.order.is_row(node) else ''}"

    def _result_slices(self) -> list[str]:
        terms = [f"i{k + 1} * strides[{k}]" for k in range(self.deepest)]
        lines = [f"start = {' + '.join([*terms, 'at'])}"] if self.is_last else []
        start = "start" if self.is_last else "done"
        slices = (f"o{k}_ = o{k}[{start}:{start} + cells]" for k in range(len(self.results)))
        return [*lines, *slices]

    def _row_lines(self, rows: Sequence[Node]) -> list[str]:
        # Stored rows hold floats: a truth value is stored as 1.0 or 0.0.
        lines = []
        for node in rows:
            value = f"t{node.number}"
            lines.append(f"{value} = {self._expression(node)}")
            if node.number in self.stored_rows:
                if node.dtype == np.bool_:
                    value = f"choose({value}, 1.0, 0.0)"
                lines.append(f"r{node.number}[i] = {value}")
        return lines

    def _expression(self, node: Node) -> str:
        assert node.function is not None
        return IN_LOOPS[node.function].format(*map(self._term, node.inputs))


def _row_loop(lines: Iterable[str]) -> list[str]:
    return ["for i in range(cells):", *(f"    {line}" for line in lines)]


def _literal(value: Any) -> str:
    # A number as Python text; negative ones in brackets, since they stand within formulas.
    if isinstance(value, bool | np.bool_):
        return str(bool(value))
    number = float(value)
    if math.isnan(number):
        return "nan"
    if math.isinf(number):
        return "inf" if number > 0 else "-inf"
    return repr(number) if number >= 0 and not np.signbit(number) else f"({number!r})"
