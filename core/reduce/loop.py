"""The compiled loop of a field: cells are computed and gathered in lanes at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.lane_loop import LARGE_TILE_CELLS, TILE_CELLS, LaneLoop, LaneOrder
from vibrafeed.core.plan.plan import Verdict
from vibrafeed.core.plan.trace import Traced, TracedPlan, traced_plan
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.reduce.cutting import Box
from vibrafeed.core.reduce.kernels.folding import COUNT_BITS, COUNTS
from vibrafeed.core.reduce.lanes import Array, BoxLanes, Totals
from vibrafeed.core.reduce.questions import ReducedField, judge_of
from vibrafeed.core.study.reduction import Reduction, ShareCondition

COMPARISONS = {
    "<": np.less,
    "<=": np.less_equal,
    "==": np.equal,
    "!=": np.not_equal,
    ">=": np.greater_equal,
    ">": np.greater,
}


@dataclass(frozen=True)
class Gathering:
    """The lanes that gather one result.

    Attributes
    ----------
    update : str
        A name of `vibrafeed.core.plan.loop_source.UPDATES`.
    output : str
        The output; empty of counts.
    counters : tuple of int
        The first counter of a packed count, and the one after the last.
    """

    update: str
    output: str = ""
    counters: tuple[int, int] = (0, 0)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of arrays in which the cells of this total are gathered, keys of `EMPTY`.

        A largest or least value has a second one if its place is wanted.
        """
        if self.counters[1]:
            return ("counts",)
        if self.update == "sum":
            return ("sum",)
        end = self.end
        return (self.update,) if end == self.update else (self.update, f"{end}_at")

    @cached_property
    def end(self) -> str:
        """The extreme that is gathered, ``largest`` or ``least``, with or without its place."""
        return self.update.removeprefix("first_")


class FieldLoop:
    """The compiled loop of a field of which neither quantiles nor levels are wanted.

    Parameters
    ----------
    traced : TracedPlan
        The graph of its plan; steps are added to it.
    field, grid, asked
        The field, the whole grid, and the reduction that the study asks for.
    flags : mapping of str to sequence of int
        Numbers of the regimes to count, by verdict.
    """

    def __init__(
        self,
        traced: TracedPlan,
        field: ReducedField,
        grid: Grid,
        asked: Reduction,
        flags: Mapping[str, Sequence[int]],
    ):
        self._traced, self._field, self._asked = traced, field, asked
        self._holds = dict(zip(field.plan.conditions, traced.holds, strict=True))
        counted = {name: self._counted(name) for name in self._outputs()}
        self._gatherings: list[Gathering] = []
        results: dict[str, Any] = {}
        for number, (gathering, result) in enumerate(
            [
                *self._counts(counted, flags),
                *(pair for name in field.outputs for pair in _statistics(name, counted, asked)),
            ]
        ):
            self._gatherings.append(gathering)
            results[str(number)] = result
        updates = [(str(k), one.update) for k, one in enumerate(self._gatherings)]
        whole = {name: (0, grid.shape[name]) for name in field.dims}
        piece = grid.piece(whole, field.plan.parameters)
        graph = Traced(traced.graph, results)
        most = TILE_CELLS if "mean" in asked.statistics else LARGE_TILE_CELLS
        self._loop = LaneLoop(field.plan, graph, piece, updates, asked.over, most)
        self.prepare = self._loop.prepare

    @property
    def order(self) -> LaneOrder:
        """The tiles that the lanes gather."""
        return self._loop.order

    @property
    def missing(self) -> frozenset[str]:
        """The sources of loops that are not compiled in this process."""
        return self._loop.missing

    def gather(self, box: Box, lanes: BoxLanes, totals: Totals) -> None:
        """Compute the cells of a box with the compiled loop and add them to the totals.

        A slot is a point of the result. `box` is start and stop on each axis, `lanes` has the
        buffers of this thread in which cells are gathered first, `totals` are those of the box.
        """
        tiles, ranges = lanes.placed(box)
        numbers = self.order.along_loops(lanes.numbers)
        counts = {layout.lanes for layout in tiles.layouts}
        buffers = {count: self._buffers(lanes, count) for count in counts}
        for own, layout, offset in zip(ranges, tiles.layouts, tiles.offsets, strict=True):
            held, flat = buffers[layout.lanes]
            self._loop.run(own, layout.strides, numbers, flat)
            for gathering, arrays in zip(self._gatherings, held, strict=True):
                if gathering.kinds[0] == "counts":
                    totals.fold_counts(arrays[0], layout, offset, *gathering.counters)
                elif gathering.kinds[0] == "sum":
                    totals.fold_sum(gathering.output, arrays[0], layout, offset, lanes.line)
                else:
                    at = arrays[-1][: 0 if len(arrays) == 1 else None]
                    name, end = gathering.output, gathering.end
                    totals.fold_extremes(name, end, arrays[0], at, layout, offset)

    def _buffers(self, lanes: BoxLanes, count: int) -> tuple[list[list[Array]], list[Array]]:
        """Return the arrays of each total for a number of lanes, and all of them in one list."""
        held = [
            [lanes.buffer(f"{k}.{kind}", count) for kind in gathering.kinds]
            for k, gathering in enumerate(self._gatherings)
        ]
        return held, [array for arrays in held for array in arrays]

    def _outputs(self) -> list[str]:
        """Return the outputs that the loop computes, for statistics and conditions."""
        compared = (one.name for conditions in self._field.shares.values() for one in conditions)
        names = dict.fromkeys((*self._field.outputs, *compared))
        return [name for name in names if name not in self._field.plan.verdict_names]

    def _by_regime(self, verdict: Verdict, values: Mapping[int, Any], otherwise: Any) -> Any:
        """Return a node that chooses between values by the regime of each cell.

        A node is an operation of the graph from which the compiled loop is written. `values` has
        nodes or constants for some regimes of the verdict, by number; all others get `otherwise`.
        """
        chosen = values.get(int(REGIMES[verdict.otherwise].value), otherwise)
        for condition in reversed(verdict.conditions):
            mine = values.get(int(REGIMES[condition.regime].value), otherwise)
            chosen = self._traced.graph.apply(np.where, (self._holds[condition], mine, chosen))
        return chosen

    def _counted(self, name: str) -> Any:
        """Return a node of an output in units of files, NaN in cells whose regime does not count.

        A node is an operation of the graph from which the compiled loop is written; `name` is the
        output. Statistics then skip these cells.
        """
        value = self._traced.known[name]
        if QUANTITIES[name].is_angle:
            value = self._traced.graph.apply(np.multiply, (value, 180 / np.pi))
        judge = judge_of(self._field.plan, self._asked, name)
        if judge is None:
            return value
        regimes = (REGIMES[regime] for regime in judge.regimes)
        invalid = {int(one.value): np.nan for one in regimes if not one.valid}
        return self._by_regime(judge, invalid, value)

    def _counts(
        self, counted: Mapping[str, Any], flags: Mapping[str, Sequence[int]]
    ) -> list[tuple[Gathering, Any]]:
        """Return the counts of cells that a loop gathers, several packed into one number.

        They are counts of outputs, then of regimes, then of shares; each adds its own power of 2.
        Of the regimes of a cell at most one holds, so that all regimes in one number are chosen at
        once. Each result is the total to gather and the node of the graph that gives its numbers.

        `counted` has the outputs' nodes, NaN where a cell does not count; `flags` are the numbers
        of the regimes, by verdict.
        """
        field = self._field
        counters: list[Any] = [counted[name] == counted[name] for name in field.outputs]
        counters += [(name, flag) for name in field.regimes for flag in flags[name]]
        counters += [self._met(each, counted) for each in field.shares.values()]
        pairs = []
        for first in range(0, len(counters), COUNTS):
            some = counters[first : first + COUNTS]
            weights = [float(1 << COUNT_BITS * k) for k in range(len(some))]
            packed: Any = 0.0
            for verdict in field.plan.verdicts:
                regimes = {
                    counter[1]: weight
                    for counter, weight in zip(some, weights, strict=True)
                    if isinstance(counter, tuple) and counter[0] == verdict.name
                }
                if regimes:
                    chosen = self._by_regime(verdict, regimes, 0.0)
                    packed = chosen if type(packed) is float else chosen + packed
            for counter, weight in zip(some, weights, strict=True):
                if not isinstance(counter, tuple):
                    packed = np.where(counter, weight, 0.0) + packed
            pairs.append((Gathering("sum", counters=(first, first + len(some))), packed))
        return pairs

    def _met(self, conditions: Sequence[ShareCondition], counted: Mapping[str, Any]) -> Any:
        """Return a node that is true where a cell meets all conditions of a share.

        A node is an operation of the graph from which the compiled loop is written. `conditions`
        are on regimes or on outputs; `counted` has the outputs' nodes, NaN where a cell does not
        count: then no condition holds.
        """
        met: Any = True
        for condition in conditions:
            if condition.is_regime:
                verdicts = {one.name: one for one in self._field.plan.verdicts}
                equal = {int(REGIMES[str(condition.value)].value): condition.comparison == "=="}
                apart = condition.comparison != "=="
                holds = self._by_regime(verdicts[condition.name], equal, apart)
            else:
                value = counted[condition.name]
                holds = COMPARISONS[condition.comparison](value, float(condition.value)) & (
                    value == value
                )
            met = holds & met
        return met


def _statistics(
    name: str, counted: Mapping[str, Any], asked: Reduction
) -> list[tuple[Gathering, Any]]:
    """Return the totals and the node behind each statistic that is asked of an output.

    A total says what a compiled loop gathers, such as a sum or a largest value; a node is an
    operation of the graph that gives its values. `name` is the output, `counted` has the outputs'
    nodes, NaN where a cell does not count, and `asked` is the section `reduce` of the study.
    """
    value, wanted = counted[name], asked.statistics
    pairs = []
    if "mean" in wanted:
        pairs.append((Gathering("sum", name), np.where(value == value, value, 0.0)))
    for end, kind in (("max", "largest"), ("min", "least")):
        if f"arg{end}" in wanted:
            pairs.append((Gathering(f"first_{kind}", name), value))
        elif end in wanted:
            pairs.append((Gathering(kind, name), value))
    return pairs


def field_loop(
    field: ReducedField, grid: Grid, asked: Reduction, flags: Mapping[str, Sequence[int]]
) -> FieldLoop | None:
    """Return the compiled loop for a group of outputs; None if their cells have to be stored.

    That is for quantiles, for levels, and where the plan cannot be traced.

    Parameters
    ----------
    field : ReducedField
        The outputs, over the same axes, with what is asked of them.
    asked : Reduction
        The section `reduce` of the study.
    flags : mapping of str to sequence of int
        The numbers of the regimes to count, by verdict.
    """
    if not field.dims or field.levels or (field.outputs and asked.quantiles):
        return None
    traced = traced_plan(field.plan, grid.axes)
    return None if traced is None else FieldLoop(traced, field, grid, asked, flags)
