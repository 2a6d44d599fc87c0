"""The loops over the axes of what is computed, and the source of one loop for steps of a graph.

The trailing axes are joined into one row that the innermost loop goes along, so that a processor's
wide registers are full. The others are loops around it, in the order that lets most steps stand
outside of the last. A row that an outer loop makes is kept for the loops within.

Within a loop everything but truth is a float, whole numbers too, and truth where it is kept: a
processor changes the width of its values at the price of many steps.
"""

from __future__ import annotations

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
    longest: float = math.inf,
) -> Order:
    """Return the order of loops over some axes that makes the work of a graph least.

    A row, the innermost loop, has at most `longest` cells for each value of its first axis.
    """
    steps = [node for node in nodes if node.function]
    orders = []
    for count in range(len(axes) + 1):
        row = math.prod(shape[name] for name in axes[count:])
        period = math.prod(shape[name] for name in axes[count + 1 :])
        if period <= longest and (not count or row >= LEAST_ROW):
            outer = _outwards(axes[:count], shape, steps)
            orders.append(Order(tuple(axes), outer, tuple(axes[count:])))
    return min(orders, key=lambda order: _work_of(order, shape, nodes))


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


def _work_of(order: Order, shape: Mapping[str, int], nodes: Collection[Node]) -> float:
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
    """The settings by which a loop takes cells into lanes: a name of `UPDATES` for each result.

    A row has `period` cells for each value of its first axis, of which whole periods, at most
    `piece`, are taken at once. `pairs`: rows that gather in the same lanes are taken two at a time.
    """

    updates: tuple[str, ...]
    period: int
    piece: int
    pairs: bool = False


@dataclass(frozen=True)
class Loop:
    """The source of a compiled loop, and what it is given, in the order of its arguments.

    It is a function ``loop(ends, strides, ...)``; with lanes, ``loop(ends, strides, numbers,
    ...)``. `arrays` numpy has made, laid out by `Order.kept`, and rows last; `columns` have a value
    for each cell in turn; `rows` are places of `LONGEST_ROW` cells for rows that are kept.
    """

    source: str
    arrays: tuple[Node, ...]
    columns: tuple[Node, ...]
    rows: tuple[Node, ...]


class LoopWriter:
    """Writes the source of a loop that computes some nodes for each cell.

    Numpy has made the values of `leaves` on their own axes, and those of `columns` for each cell.
    Of the last loop the results are written where the grid has them, else one after another. A lane
    is found by a stride for each outer loop, then one for the row; the number of a cell likewise.
    """

    def __init__(
        self,
        order: Order,
        leaves: Collection[Node],
        columns: Collection[Node],
        results: Sequence[Any],
        *,
        is_last: bool,
        lanes: Lanes | None = None,
    ):
        self.order, self.results, self.is_last, self.lanes = order, results, is_last, lanes
        self.updates = lanes.updates if lanes else ("store",) * len(results)
        self.arrays = [update for update in self.updates for _ in range(UPDATES[update][0])]
        self.leaves = {node.number for node in leaves}
        self.columns = {node.number for node in columns}
        self.deepest = len(order.outer)
        self.steps: dict[int, Node] = {}  # that the loop computes, inputs first
        self.used: dict[int, Node] = {}  # that it reads from arrays made beforehand
        self.deep = set(self.columns)  # that depend on a value given cell by cell
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

    def _kept(self) -> dict[int, Node]:  # values along a row that an inner loop needs
        used = [(one, self._level(node)) for node in self.nodes for one in node.before]
        used += [(one, self.deepest) for one in self.results if isinstance(one, Node)]
        kept = {
            one.number: one
            for one, level in used
            if one.number in self.steps and self._is_row(one) and self._level(one) < level
        }
        return dict(sorted(kept.items()))

    def _level(self, node: Node) -> int:
        return self.deepest if node.number in self.deep else self.order.level(node)

    def _is_row(self, node: Node) -> bool:
        return node.number in self.deep or self.order.is_row(node)

    def _term(self, node: Any) -> str:
        if not isinstance(node, Node):
            return _literal(node)
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
        """Return the loop."""
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
            *(f"o{k}" for k in range(len(self.arrays))),
        ]
        piece = self.lanes.piece if self.lanes else LONGEST_ROW
        head = [
            f"def loop(ends, strides, {'numbers, ' if self.lanes else ''}{', '.join(names)}):",
            "    done = 0",
            f"    for at in range(ends[0, 0], ends[0, 1], {piece}):",
            f"        stop = min(at + {piece}, ends[0, 1])",
            "        cells = stop - at",
        ]
        source = "\n".join([*head, *lines]) + "\n"
        return Loop(source, tuple(arrays), tuple(columns), tuple(self.kept.values()))

    def _at_level(self, level: int, arrays: Sequence[Node], pad: str) -> list[str]:
        plain, rows = self._enter(level)
        lines = self._outside_row(level, arrays, plain)
        if level == self.deepest:
            row = [*self._steps(rows), *self._in_lanes(self._gathered())]
            lines += [*self._starts(), *_along(row), "done += cells"]
        elif rows:
            lines += _along(self._steps(rows))
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
        """Return the lines of the innermost outer loop that take two rows at a time.

        Both are gathered in the same lanes, one after the other, as if taken singly: the bits are
        the same. Where the rows have lanes of their own, and for an odd last row, single rows
        follow.
        """
        level = self.deepest
        plain, rows = self._enter(level)
        outside, steps, updates = [], [], []
        for self.second in (False, True):
            outside += self._outside_row(level, arrays, plain)
            outside += self._numbers() if self.second else self._starts()
            steps += self._steps(rows)
            updates += self._gathered()
        self.second = False
        row = _along([*steps, *self._in_lanes(updates)])
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
        named = (f"o{k}_ = o{k}[{start}:{start} + cells]" for k in range(len(self.arrays)))
        return [*lines, *named]

    def _numbers(self) -> list[str]:
        index = self._lane_index("numbers", self._turns(), "at")
        return [f"number{'b' * self.second} = 0.0 + ({index})"]

    def _turns(self) -> list[str]:
        turns = [f"i{k + 1}" for k in range(self.deepest)]
        return [*turns[:-1], f"({turns[-1]} + 1)"] if self.second else turns

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

    def _in_lanes(self, gathered: Iterable[str]) -> list[str]:
        """Return lines between those that read what the lanes of a cell hold and write it back."""
        held = [(k, UPDATES[one][2]) for k, one in enumerate(self.arrays) if one != "store"]
        read = (f"v{k} = o{k}_[i]" for k, _ in held)
        return [*read, *gathered, *(f"o{k}_[i] = v{k}{added}" for k, added in held)]

    def _gathered(self) -> list[str]:
        lines, free, number = [], 0, f"number{'b' * self.second}"
        for update, result in zip(self.updates, self.results, strict=True):
            count, texts, _ = UPDATES[update]
            place = "o{}_[i]" if update == "store" else "v{}"
            places, term = [*map(place.format, range(free, free + count))], self._term(result)
            lines += [text.format(*places, value=term, number=number) for text in texts]
            free += count
        return lines

    def _step(self, node: Node) -> str:
        assert node.function is not None
        return IN_LOOPS[node.function].format(*map(self._term, node.inputs))


def _along(lines: Iterable[str]) -> list[str]:
    return ["for i in range(cells):", *(f"    {line}" for line in lines)]


def _literal(value: Any) -> str:
    if isinstance(value, bool | np.bool_):
        return str(bool(value))
    number = float(value)
    if math.isnan(number):
        return "nan"
    if math.isinf(number):
        return "inf" if number > 0 else "-inf"
    return repr(number) if number >= 0 and not np.signbit(number) else f"({number!r})"
