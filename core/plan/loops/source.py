"""The source of one loop for many steps of a graph.

A step that does not depend on the axes of a row is a number, one that does is a row, and a row that
an outer loop makes is kept for the loops within.

Within a loop everything but truth is a float, whole numbers too, and truth is a float where it is
kept: a processor changes the width of its values at the price of many steps.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.plan.loops.order import Order
from core.plan.loops.trace import Node
from core.plan.operations import IN_LOOPS

LONGEST_ROW = 1024
"""Most cells of a row that a loop takes at once: the rows that it keeps stay in the first and
second cache."""

UPDATES: dict[str, tuple[int, tuple[str, ...]]] = {
    "store": (1, ("{0} = {value}",)),
    "sum": (1, ("{0} += {value}",)),
    "largest": (1, ("{0} = choose({value} > {0}, {value}, {0}) + 0.0",)),
    "least": (1, ("{0} = choose({value} < {0}, {value}, {0}) + 0.0",)),
    "first_largest": (
        2,
        (
            "better = ({value} > {0}) | (({value} == {0}) & (number < {1}))",
            "{0} = choose(better, {value}, {0}) + 0.0",
            "{1} = choose(better, number, {1}) + 0.0",
        ),
    ),
    "first_least": (
        2,
        (
            "better = ({value} < {0}) | (({value} == {0}) & (number < {1}))",
            "{0} = choose(better, {value}, {0}) + 0.0",
            "{1} = choose(better, number, {1}) + 0.0",
        ),
    ),
}
"""What is done with the value of a cell: how many arrays it takes, and what happens at its place.

What is no number changes no extreme. Adding 0 makes one of the two zeros; without it the compiler
would write only where something changes, which costs a processor several times as much.
"""


@dataclass(frozen=True)
class Lanes:
    """The settings by which a loop takes cells into lanes instead of storing them.

    Attributes
    ----------
    updates : tuple of str
        For each result, what is done with it: names of `UPDATES`.
    period : int
        Cells of a row for each value of its first axis.
    piece : int
        Most cells of a row that are taken at once: whole periods.
    """

    updates: tuple[str, ...]
    period: int
    piece: int


@dataclass(frozen=True)
class Loop:
    """The source of a compiled loop, and what it is given, in the order of its arguments.

    Attributes
    ----------
    source : str
        A function ``loop(ends, strides, ...)``; with lanes, ``loop(ends, strides, numbers, ...)``.
    arrays : tuple of Node
        Arrays that numpy has made, laid out by `Order.kept`, and rows last.
    columns : tuple of Node
        Arrays with a value for each cell, in the order in which the loop takes the cells.
    rows : tuple of Node
        Places for rows that are kept, of `LONGEST_ROW` cells each.
    """

    source: str
    arrays: tuple[Node, ...]
    columns: tuple[Node, ...]
    rows: tuple[Node, ...]


def write_loop(
    order: Order,
    leaves: Collection[Node],
    columns: Collection[Node],
    results: Sequence[Any],
    *,
    is_last: bool,
    lanes: Lanes | None = None,
) -> Loop:
    """Return the source of a loop that computes some nodes for each cell.

    Parameters
    ----------
    order : Order
        The loops.
    leaves : collection of Node
        Nodes whose values numpy has made, on their own axes.
    columns : collection of Node
        Nodes whose values numpy has made for each cell.
    results : sequence of Node or number
        What to compute.
    is_last : bool
        True if results are written where the grid has them, False if one after another.
    lanes : Lanes, optional
        How cells are taken into lanes; they are stored if left out. A lane is found by a stride for
        each loop, then one for the row, and an offset; the number of a cell likewise.
    """
    return _Writer(order, leaves, columns, results, is_last, lanes).write()


class _Writer:
    """Writes the source of one loop: each step at the level of the loops on which it depends."""

    def __init__(
        self,
        order: Order,
        leaves: Collection[Node],
        columns: Collection[Node],
        results: Sequence[Any],
        is_last: bool,
        lanes: Lanes | None,
    ):
        """Collect the nodes, arguments and updates of a loop to be written."""
        self.order, self.results, self.is_last, self.lanes = order, results, is_last, lanes
        self.updates = lanes.updates if lanes else ("store",) * len(results)
        self.arrays = sum(UPDATES[update][0] for update in self.updates)
        self.leaves = {node.number for node in leaves}
        self.columns = {node.number for node in columns}
        self.deepest = len(order.outer)
        self.steps: dict[int, Node] = {}
        self.used: dict[int, Node] = {}
        self.deep = set(self.columns)
        for result in results:
            if isinstance(result, Node):
                self._need(result)
        self.nodes = [self.steps[number] for number in sorted(self.steps)]
        self.kept = self._kept()
        self.here: set[int] = set()

    def _need(self, node: Node) -> None:
        """Collect the operations of a loop: a node of the traced graph and all nodes it depends on.

        `steps` gets the nodes that the loop computes, inputs first; `used` those that it reads from
        arrays made beforehand, where the descent ends; `deep` those that depend on a value given
        cell by cell and cannot be moved to an outer loop. Nodes that are known already are skipped.
        """
        if node.number in self.steps or node.number in self.used:
            return
        if node.number in self.leaves | self.columns:
            self.used[node.number] = node
            return
        for one in node.before:
            self._need(one)
        if any(one.number in self.deep for one in node.before):
            self.deep.add(node.number)
        self.steps[node.number] = node

    def _level(self, node: Node) -> int:
        """Return the number of outer loops within which a node is computed."""
        return self.deepest if node.number in self.deep else self.order.level(node)

    def _is_row(self, node: Node) -> bool:
        """True if a node has a value per cell of a row."""
        return node.number in self.deep or self.order.is_row(node)

    def _kept(self) -> dict[int, Node]:
        """Return the nodes whose values along a row are stored for an inner loop, by number.

        A row is the innermost loop; a node that does not depend on an outer axis is computed along
        the row once.
        """
        used = [(operand, self._level(node)) for node in self.nodes for operand in node.before]
        used += [(operand, self.deepest) for operand in self.results if isinstance(operand, Node)]
        kept = {
            operand.number: operand
            for operand, level in used
            if operand.number in self.steps
            and self._is_row(operand)
            and self._level(operand) < level
        }
        return dict(sorted(kept.items()))

    def _term(self, node: Node) -> str:
        """Return the source text for the value of a node inside the innermost loop.

        It is a local variable, an element of an array made beforehand, or one of a row that an
        outer loop has stored.
        """
        number = node.number
        if number in self.columns:
            return f"c{number}[done + i]"
        if number in self.used:
            if not self.order.is_row(node):
                return f"a{number}_"
            row = f"a{number}_[i]"
        elif number in self.kept and number not in self.here:
            row = f"r{number}[i]"
        else:
            return f"t{number}"
        return f"({row} != 0.0)" if node.dtype == np.bool_ else row

    def write(self) -> Loop:
        """Return the loop: its source text, and the nodes of the graph that are its arguments.

        A line stands inside as few loops as its values allow.
        """
        arrays = [node for node in self.used.values() if node.number in self.leaves]
        columns = [node for node in self.used.values() if node.number in self.columns]
        lines: list[str] = []
        for level in range(self.deepest + 1):
            pad = "    " * (level + 2)
            if level:
                lines.append(f"{pad[4:]}for i{level} in range(ends[{level}, 0], ends[{level}, 1]):")
            lines += self._at_level(level, arrays, pad)
        names = [
            *(f"a{node.number}" for node in arrays),
            *(f"c{node.number}" for node in columns),
            *(f"r{number}" for number in self.kept),
            *(f"o{k}" for k in range(self.arrays)),
        ]
        piece = self.lanes.piece if self.lanes else LONGEST_ROW
        head = [
            f"def loop(ends, strides, {'numbers, ' if self.lanes else ''}{', '.join(names)}):",
            "    done = 0",
            f"    for at in range(ends[0, 0], ends[0, 1], {piece}):",
            f"        stop = min(at + {piece}, ends[0, 1])",
            "        cells = stop - at",
        ]
        return Loop(
            "\n".join([*head, *lines]) + "\n",
            tuple(arrays),
            tuple(columns),
            tuple(self.kept.values()),
        )

    def _at_level(self, level: int, arrays: Sequence[Node], pad: str) -> list[str]:
        """Return the lines of a loop's source at one level: inputs, numbers, then loops along rows.

        The level counts the loops outside; a step stands as far outside as it can. `arrays` are the
        inputs that numpy has computed, `pad` is the indentation.
        """
        here = [node for node in self.nodes if self._level(node) == level]
        self.here = {node.number for node in here}
        plain = [node for node in here if not self._is_row(node)]
        rows = [node for node in here if self._is_row(node)]
        lines = [self._taken(one) for one in arrays if self.order.level(one) == level]
        lines += [f"t{node.number} = {self._step(node)}" for node in plain]
        if level == self.deepest:
            lines += [*self._starts(), *self._row(rows, self._updated()), "done += cells"]
        elif rows:
            lines += self._row(rows, [])
        return [f"{pad}{line}" for line in lines]

    def _taken(self, node: Node) -> str:
        """Return the line of a loop's source that takes an element or a row of an input array.

        `node` is an input that numpy has computed. The line indexes its array by the outer loops on
        whose axes it depends, and gives the element, or a row of it for the innermost loop, a local
        name.
        """
        turns = {name: f"i{k + 1}" for k, name in enumerate(self.order.outer)}
        index = ", ".join(turns[name] for name in self.order.kept(node))
        taken = f"a{node.number}[{index}]" if index else f"a{node.number}"
        return f"a{node.number}_ = {taken}{'[at:stop]' if self.order.is_row(node) else ''}"

    def _starts(self) -> list[str]:
        """Return the source lines that find where results of a row begin in their arrays.

        The results are arrays over the grid, columns for numpy's next step, or lanes, places for
        totals.
        """
        lines = []
        if self.lanes:
            lines += [f"start = {self._lane_index('strides')}"]
            lines += [f"number = 0.0 + ({self._lane_index('numbers')})"]
        elif self.is_last:
            turns = [f"i{k + 1} * strides[{k}]" for k in range(self.deepest)]
            lines += [f"start = {' + '.join([*turns, 'at'])}"]
        start = "start" if self.is_last else "done"
        return lines + [f"o{k}_ = o{k}[{start}:{start} + cells]" for k in range(self.arrays)]

    def _row(self, rows: Sequence[Node], updates: Sequence[str]) -> list[str]:
        """Return the source lines of the loop along a row, the innermost one.

        They compute the nodes `rows` of the graph in order, store those that later loops need, and
        then have the lines `updates`, which store or gather results.
        """
        lines = ["for i in range(cells):"]
        for node in rows:
            lines.append(f"    t{node.number} = {self._step(node)}")
            if node.number in self.kept:
                value = f"t{node.number}"
                if node.dtype == np.bool_:
                    value = f"choose({value}, 1.0, 0.0)"
                lines.append(f"    r{node.number}[i] = {value}")
        return [*lines, *(f"    {line}" for line in updates)]

    def _lane_index(self, strides: str) -> str:
        """Return the source text for the index of a row's first cell among lanes.

        A lane is a place for a total. `strides` is the name of the array that has the distance for
        each loop.
        """
        assert self.lanes is not None
        turns = [f"i{k + 1}" for k in range(self.deepest)] + [f"at // {self.lanes.period}"]
        terms = [f"{turn} * {strides}[{k}]" for k, turn in enumerate(turns)]
        return " + ".join([*terms, f"{strides}[{len(turns)}]"])

    def _updated(self) -> list[str]:
        """Return the source lines of the last loop that write the results of a cell.

        A result is stored, or gathered into a total such as a sum or a largest value: an entry of
        `UPDATES`.
        """
        lines, free = [], 0
        for update, term in zip(self.updates, self._terms(), strict=True):
            count, texts = UPDATES[update]
            places = [f"o{free + k}_[i]" for k in range(count)]
            lines += [text.format(*places, value=term) for text in texts]
            free += count
        return lines

    def _terms(self) -> list[str]:
        """Return the source texts for the results in the last loop."""
        return [self._term(one) if isinstance(one, Node) else _literal(one) for one in self.results]

    def _step(self, node: Node) -> str:
        """Return the source text of a step: its function called with its inputs."""
        terms = (self._term(one) if isinstance(one, Node) else _literal(one) for one in node.inputs)
        assert node.function is not None
        return IN_LOOPS[node.function].format(*terms)


def _literal(value: Any) -> str:
    """Return a number or truth value as source text, with infinity, NaN and -0.0.

    Constants of equations are written so into the source of compiled loops.
    """
    if isinstance(value, bool | np.bool_):
        return str(bool(value))
    number = float(value)
    if math.isnan(number):
        return "nan"
    if math.isinf(number):
        return "inf" if number > 0 else "-inf"
    return repr(number) if number >= 0 and not np.signbit(number) else f"({number!r})"
