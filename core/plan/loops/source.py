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

from vibrafeed.core.plan.loops.order import Order
from vibrafeed.core.plan.loops.trace import Node
from vibrafeed.core.plan.operations import IN_LOOPS

LONGEST_ROW = 1024
"""Most cells of a row that a loop takes at once: the rows that it keeps stay in the first and
second cache."""


def _keep_first(better: str) -> tuple[str, ...]:
    return (
        f"better = ({{value}} == {{value}}) & ({better})",
        "{0} = choose(better, {value}, {0})",
        "{1} = choose(better, {number}, {1})",
    )


LARGER, LESS = "(not ({value} <= {0}))", "(not ({value} >= {0}))"
"""Comparisons that are true of a lane without a cell, which is NaN."""
EARLIER = "(({value} == {0}) & ({number} < {1}))"

UPDATES: dict[str, tuple[int, tuple[str, ...], str]] = {
    "store": (1, ("{0} = {value}",), ""),
    "sum": (1, ("{0} += {value}",), ""),
    "largest": (1, ("{0} = choose({value} > {0}, {value}, {0})",), " + 0.0"),
    "least": (1, ("{0} = choose({value} < {0}, {value}, {0})",), " + 0.0"),
    "first_largest": (2, _keep_first(f"{LARGER} | {EARLIER}"), " + 0.0"),
    "first_least": (2, _keep_first(f"{LESS} | {EARLIER}"), " + 0.0"),
    "next_largest": (2, _keep_first(LARGER), " + 0.0"),
    "next_least": (2, _keep_first(LESS), " + 0.0"),
}
"""What is done with the value of a cell: how many arrays it takes, what happens at its place, and
what is added when a lane is written back.

What is no number changes no extreme. `next_largest` is `first_largest` for a lane that gets its
cells in the order of the grid: a look at places is spared. Adding 0 makes one of the two zeros;
without it the compiler would write only where something changes, which costs a processor several
times as much.
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
    pairs : bool
        Whether rows that gather in the same lanes are taken two at a time.
    """

    updates: tuple[str, ...]
    period: int
    piece: int
    pairs: bool = False


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
        each outer loop, then one for the row, from where these start; the number of a cell
        likewise, from the start of the grid.
    """
    return _Writer(order, leaves, columns, results, is_last, lanes).write()


class _Writer:
    def __init__(
        self,
        order: Order,
        leaves: Collection[Node],
        columns: Collection[Node],
        results: Sequence[Any],
        is_last: bool,
        lanes: Lanes | None,
    ):
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
        self.pairs = bool(lanes and lanes.pairs and is_last and self.deepest)
        self.second = False

    def _need(self, node: Node) -> None:
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
        return self.deepest if node.number in self.deep else self.order.level(node)

    def _is_row(self, node: Node) -> bool:
        return node.number in self.deep or self.order.is_row(node)

    def _kept(self) -> dict[int, Node]:
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
        number = node.number
        if number in self.columns:
            return f"c{number}[done + cells + i]" if self.second else f"c{number}[done + i]"
        if number in self.used:
            if not self.order.is_row(node):
                return self._input(node)
            row = f"{self._input(node)}[i]"
        elif number in self.kept and number not in self.here:
            row = f"r{number}[i]"
        else:
            return self._value(node)
        return f"({row} != 0.0)" if node.dtype == np.bool_ else row

    def _input(self, node: Node) -> str:
        is_second = self.second and self.order.level(node) == self.deepest
        return f"a{node.number}_{'b' * is_second}"

    def _value(self, node: Node) -> str:
        return f"t{node.number}{'b' * (self.second and node.number in self.here)}"

    def write(self) -> Loop:
        arrays = [node for node in self.used.values() if node.number in self.leaves]
        columns = [node for node in self.used.values() if node.number in self.columns]
        lines: list[str] = []
        for level in range(self.deepest + 1):
            pad = "    " * (level + 2)
            first = f"ends[{level}, 0]"
            if level == self.deepest and self.pairs:
                lines += self._paired(arrays, pad)
                first = "unpaired"
            if level:
                lines.append(f"{pad[4:]}for i{level} in range({first}, ends[{level}, 1]):")
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
        plain, rows = self._enter(level)
        lines = self._outside_row(level, arrays, plain)
        if level == self.deepest:
            lines += [*self._starts(), *self._row(rows, self._updated()), "done += cells"]
        elif rows:
            lines += self._row(rows, [])
        return [f"{pad}{line}" for line in lines]

    def _enter(self, level: int) -> tuple[list[Node], list[Node]]:
        here = [node for node in self.nodes if self._level(node) == level]
        self.here = {node.number for node in here}
        plain = [node for node in here if not self._is_row(node)]
        return plain, [node for node in here if self._is_row(node)]

    def _outside_row(self, level: int, arrays: Sequence[Node], plain: Sequence[Node]) -> list[str]:
        lines = [self._taken(one) for one in arrays if self.order.level(one) == level]
        return lines + [f"{self._value(node)} = {self._step(node)}" for node in plain]

    def _paired(self, arrays: Sequence[Node], pad: str) -> list[str]:
        level = self.deepest
        plain, rows = self._enter(level)
        outside, steps, updates = [], [], []
        for self.second in (False, True):
            outside += self._outside_row(level, arrays, plain)
            outside += self._numbers() if self.second else self._starts()
            steps += self._steps(rows)
            updates += self._gathered()
        self.second = False
        inside = [*self._read(), *updates, *self._written()]
        row = ["for i in range(cells):", *(f"    {line}" for line in [*steps, *inside])]
        count = f"ends[{level}, 1] - ends[{level}, 0]"
        pairs = f"({count}) // 2 * 2 if strides[{level - 1}] == 0 else 0"
        return [
            f"{pad[4:]}unpaired = ends[{level}, 0] + ({pairs})",
            f"{pad[4:]}for i{level} in range(ends[{level}, 0], unpaired, 2):",
            *(f"{pad}{line}" for line in [*outside, *row, "done += 2 * cells"]),
        ]

    def _taken(self, node: Node) -> str:
        turns = dict(zip(self.order.outer, self._turns(), strict=True))
        index = ", ".join(turns[name] for name in self.order.kept(node))
        taken = f"a{node.number}[{index}]" if index else f"a{node.number}"
        return f"{self._input(node)} = {taken}{'[at:stop]' if self.order.is_row(node) else ''}"

    def _starts(self) -> list[str]:
        lines = []
        if self.lanes:
            turns = [f"(i{k + 1} - ends[{k + 1}, 0])" for k in range(self.deepest)]
            lines += [f"start = {self._lane_index('strides', turns, '(at - ends[0, 0])')}"]
            lines += self._numbers()
        elif self.is_last:
            turns = [f"i{k + 1} * strides[{k}]" for k in range(self.deepest)]
            lines += [f"start = {' + '.join([*turns, 'at'])}"]
        start = "start" if self.is_last else "done"
        return lines + [f"o{k}_ = o{k}[{start}:{start} + cells]" for k in range(self.arrays)]

    def _numbers(self) -> list[str]:
        return [f"{self._number()} = 0.0 + ({self._lane_index('numbers', self._turns(), 'at')})"]

    def _number(self) -> str:
        return "numberb" if self.second else "number"

    def _turns(self) -> list[str]:
        turns = [f"i{k + 1}" for k in range(self.deepest)]
        return [*turns[:-1], f"({turns[-1]} + 1)"] if self.second else turns

    def _row(self, rows: Sequence[Node], updates: Sequence[str]) -> list[str]:
        lines = [*self._steps(rows), *updates]
        return ["for i in range(cells):", *(f"    {line}" for line in lines)]

    def _steps(self, rows: Sequence[Node]) -> list[str]:
        lines = []
        for node in rows:
            value = self._value(node)
            lines.append(f"{value} = {self._step(node)}")
            if node.number in self.kept:
                if node.dtype == np.bool_:
                    value = f"choose({value}, 1.0, 0.0)"
                lines.append(f"r{node.number}[i] = {value}")
        return lines

    def _lane_index(self, strides: str, turns: Sequence[str], cell: str) -> str:
        assert self.lanes is not None
        turns = [*turns, f"{cell} // {self.lanes.period}"]
        return " + ".join(f"{turn} * {strides}[{k}]" for k, turn in enumerate(turns))

    def _updated(self) -> list[str]:
        return [*self._read(), *self._gathered(), *self._written()]

    def _read(self) -> list[str]:
        return [f"v{k} = o{k}_[i]" for k, update in self._updates_by_array() if update != "store"]

    def _gathered(self) -> list[str]:
        lines, free = [], 0
        for update, term in zip(self.updates, self._terms(), strict=True):
            count, texts, _ = UPDATES[update]
            places = [
                f"o{k}_[i]" if update == "store" else f"v{k}" for k in range(free, free + count)
            ]
            lines += [text.format(*places, value=term, number=self._number()) for text in texts]
            free += count
        return lines

    def _written(self) -> list[str]:
        return [
            f"o{k}_[i] = v{k}{UPDATES[update][2]}"
            for k, update in self._updates_by_array()
            if update != "store"
        ]

    def _updates_by_array(self) -> list[tuple[int, str]]:
        names = [update for update in self.updates for _ in range(UPDATES[update][0])]
        return list(enumerate(names))

    def _terms(self) -> list[str]:
        return [self._term(one) if isinstance(one, Node) else _literal(one) for one in self.results]

    def _step(self, node: Node) -> str:
        terms = (self._term(one) if isinstance(one, Node) else _literal(one) for one in node.inputs)
        assert node.function is not None
        return IN_LOOPS[node.function].format(*terms)


def _literal(value: Any) -> str:
    if isinstance(value, bool | np.bool_):
        return str(bool(value))
    number = float(value)
    if math.isnan(number):
        return "nan"
    if math.isinf(number):
        return "inf" if number > 0 else "-inf"
    return repr(number) if number >= 0 and not np.signbit(number) else f"({number!r})"
