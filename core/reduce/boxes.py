"""One box of a field: its cells are evaluated, and what is asked of them is told."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from functools import cached_property
from itertools import compress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plan.evaluate import evaluate, evaluate_at_once, is_compiled_for
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.lane_loop import LONGEST_AXIS, TILE_CELLS, LaneOrder
from vibrafeed.core.plan.loop_source import LONGEST_ROW
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.reduce.cutting import Box, Cutting, Rows
from vibrafeed.core.reduce.kernels import others
from vibrafeed.core.reduce.kernels.bits import MAGNITUDE
from vibrafeed.core.reduce.lanes import GATHERED, BoxLanes, Totals
from vibrafeed.core.reduce.loop import FieldLoop, field_loop
from vibrafeed.core.reduce.questions import (
    EVERY_REGIME,
    EXACT_CELLS,
    VALID_REGIMES,
    ReducedField,
    judge_of,
    takes_long,
)
from vibrafeed.core.reduce.state import STOPPED, State
from vibrafeed.core.study.reduction import Reduction, ShareCondition
from vibrafeed.core.watch import Watch

LONG_TILE_CELLS = 1 << 13
"""Most cells of a tile of simulated motion: boxes hold whole tiles, and a computation can be
stopped between boxes."""
COMPARED = {"<": 1, "==": 2, "<=": 3, ">": 4, "!=": 5, ">=": 6}
"""Comparisons as bits: 1 for a value below the level, 2 for an equal one, 4 for one above."""
Buffers = dict[str, NDArray[Any]]


class Boxes:
    """The boxes of a field: what its cells are evaluated and reduced in.

    Parameters
    ----------
    plan : Plan
        Of the whole study; its regimes tell which cells count.
    grid : Grid
        The whole grid.
    asked : Reduction
        The reduction that the study asks for.
    field : ReducedField
        The field.
    cells : int
        Most cells of a box, `BOX_CELLS` or fewer.

    Attributes
    ----------
    cutting : Cutting
        How the field is cut.
    is_exact : bool
        True if quantiles come from all cells of a slot, False if from a histogram.
    flags : dict of str to tuple of int
        Numbers of the regimes that cells can have by each verdict that is counted.
    cells_a_slot : int
        Number of cells of the field that are reduced to one slot.
    times : int
        Number of points of the whole grid that one cell of the field stands for.
    """

    def __init__(self, plan: Plan, grid: Grid, asked: Reduction, field: ReducedField, cells: int):
        self.field, self._asked, self._grid = field, asked, grid
        verdicts = [one for one in plan.verdicts if one.name in field.regimes]
        self.flags = {v.name: tuple(int(REGIMES[n].value) for n in v.regimes) for v in verdicts}
        # A cell has one regime: those of the last are what is left, and spare the loop some steps.
        self._counted_flags = {name: flags[:-1] or flags for name, flags in self.flags.items()}
        depends = field.plan.depends_on(grid.axes)
        names = (*field.plan.outputs, *field.plan.verdict_names)
        self._dims = {name: grid.dims(depends[name]) for name in names}
        shape = tuple(grid.shape[dim] for dim in field.dims)
        goes = tuple(dim in asked.over for dim in field.dims)
        seen = math.prod(compress(shape, goes))
        self.is_exact = seen <= EXACT_CELLS
        if asked.quantiles and self.is_exact and field.outputs:
            cells = max(cells, seen)
        self._loop: FieldLoop | None = None
        self._at_once = takes_long(field.plan)
        if not self._at_once and max(shape, default=0) <= LONGEST_AXIS:
            self._loop = field_loop(field, grid, asked, self._counted_flags)
        self._order = self._loop.order if self._loop else stored_order(field, grid, asked)
        self.cutting = Cutting.of(shape, goes, cells, tile=self._tile())
        self.cells_a_slot = seen
        self.times = math.prod(grid.shape[dim] for dim in asked.over if dim not in field.dims)
        self._threads = threading.local()

    def _tile(self) -> tuple[int, ...]:
        """Return the tile size on each axis, in cells; 1 where only regimes are computed."""
        steps = self._order.steps if self.field.outputs or self._loop else {}
        return tuple(steps.get(dim, 1) for dim in self.field.dims)

    @cached_property
    def _compiled(self) -> FieldLoop | None:
        """The compiled loop for these outputs, or None if numpy is done sooner.

        Whether compiling is worth its time depends on the number of cells; it is done here.
        """
        if self._loop is None or not is_compiled_for(self._loop.missing, self.cutting.cells):
            return None
        self._loop.prepare()
        return self._loop

    def seen(self, box: Box, watch: Watch | None = None) -> State:
        """Compute the cells of a box and return the state of the statistics after them.

        A box is start and stop on each axis. The state has arrays over the slots, points of the
        result: counts, sums, extremes and the like, which can be added up.

        Raises
        ------
        StoppedError
            If `watch` stops cells that take long.
        """
        loop = self._compiled
        if loop is None:
            return self._seen_stored(box, watch or Watch(threads=1))
        return self._seen_in_lanes(loop, box)

    def _seen_in_lanes(self, loop: FieldLoop, box: Box) -> State:
        """Return the state of the statistics after a box, by a compiled loop that stores no cells.

        The loop adds each cell to the totals of its slot, a point of the result. A box is start and
        stop on each axis. The state has arrays (slots,), by output or count and the name of the
        total.
        """
        field, state = self.field, State()
        flags = [(name, flag) for name in field.regimes for flag in self._counted_flags[name]]
        counters = len(field.outputs) + len(flags) + len(field.shares)
        totals = Totals(self._slots(box), counters)
        loop.gather(box, self._lanes(), totals)
        for counter, name in enumerate(field.outputs):
            state |= totals.state(name, counter)
        names = [*(f"{name}.{flag}" for name, flag in flags), *field.shares]
        for counter, name in enumerate(names, start=len(field.outputs)):
            state[f"{name}.count"] = totals.counts[counter]
        cells = math.prod(stop - start for start, stop in box) // self._slots(box)
        for name in field.regimes:
            *others_, last = self.flags[name]
            if others_:
                counted = [state[f"{name}.{flag}.count"] for flag in others_]
                state[f"{name}.{last}.count"] = cells - np.sum(counted, axis=0)
        return state

    def _slots(self, box: Box) -> int:
        """Return the number of slots in a box."""
        return math.prod(stop - start for start, stop in self.cutting.kept(box))

    def _lanes(self) -> BoxLanes:
        """Return the buffers in which this thread gathers totals, made on its first call.

        They tell, too, in which order cells are taken.
        """
        held: dict[str, Any] = self._threads.__dict__
        if "lanes" not in held:
            held["lanes"] = BoxLanes(
                self._order, self.field.dims, self._asked.over, self._grid.shape
            )
        lanes: BoxLanes = held["lanes"]
        return lanes

    def _seen_stored(self, box: Box, watch: Watch) -> State:
        """Return the state of the statistics after a box, by numpy: cells are stored, then reduced.

        A box is start and stop on each axis. The state has arrays over the points of the result.
        Raises `StoppedError` if `watch` stops it.
        """
        field, state = self.field, State()
        rows = Rows.of(tuple(stop - start for start, stop in box), self.cutting.goes)
        wider = self._wider(box)
        wide = self._evaluated(wider, watch)
        values = self._narrowed(wide, wider, box)
        for name in field.outputs:
            state |= self._statistics(name, values, box)
            if self._asked.quantiles:
                state |= self._quantiles(name, values, rows, box)
        for name in field.regimes:
            for flag in self.flags[name]:
                state[f"{name}.{flag}.count"] = _counted(values[name], flag, rows)
        for name, conditions in field.shares.items():
            state[f"{name}.count"] = self._met(conditions, values, rows)
        if field.levels:
            lengths = tuple(stop - start for start, stop in wider)
            rows = Rows.of(lengths, self.cutting.goes)
            for name in field.levels:
                state |= self._crossings(name, wide, rows, wider)
        return state

    def _wider(self, box: Box) -> Box:
        """Return a box with one more cell before it on the axes along which levels are crossed.

        A crossing of a level lies between two cells, of which the first may be in the box before. A
        box is start and stop on each axis; at the start of an axis there is no cell before.
        """
        return tuple(
            (start - (dim in self.field.along and start > 0), stop)
            for dim, (start, stop) in zip(self.field.dims, box, strict=True)
        )

    def _narrowed(self, wide: Buffers, wider: Box, box: Box) -> Buffers:
        """Return the values of a box, flat, out of those of the wider box that `_wider` made.

        `wide` has the arrays of the wider box by name; a box is start and stop on each axis.
        """
        if wider == box:
            return wide
        lengths = [stop - start for start, stop in wider]
        here = tuple(
            slice(start - first, stop - first)
            for (start, stop), (first, _) in zip(box, wider, strict=True)
        )
        return {name: array.reshape(lengths)[here].reshape(-1) for name, array in wide.items()}

    def _evaluated(self, box: Box, watch: Watch) -> Buffers:
        """Return outputs and regimes of all cells of a box by name, flat, in the units of files.

        Each array has one entry for every cell, also of outputs that do not depend on all axes. The
        arrays are buffers of this thread, which the next box uses again. Raises `StoppedError` if
        `watch` stops it.
        """
        field = self.field
        ends = dict(zip(field.dims, box, strict=True))
        piece = self._grid.piece(ends, field.plan.parameters)
        lengths = tuple(stop - start for start, stop in box)
        into = {
            name: self._buffer(name, tuple(piece.shape[dim] for dim in dims))
            for name, dims in self._dims.items()
        }
        if self._at_once:
            evaluate_at_once(field.plan, piece, into, watch)
            if watch.stopped():
                raise StoppedError(STOPPED)
        else:
            evaluate(field.plan, piece, into=into, threads=1)
        whole: Buffers = {}
        for name, array in into.items():
            if name in QUANTITIES and QUANTITIES[name].is_angle:
                np.rad2deg(array, out=array)
            if self._dims[name] != field.dims:
                aligned = array.reshape(
                    [piece.shape[d] if d in self._dims[name] else 1 for d in field.dims]
                )
                array = self._buffer(f"{name} everywhere", lengths, array.dtype)
                array[...] = aligned
            whole[name] = array.reshape(-1)
        return whole

    def _buffer(self, name: str, shape: tuple[int, ...], dtype: Any = None) -> NDArray[Any]:
        """Return an array of this thread for the cells of a box; the next box reuses its memory.

        It is not cleared. `name` tells buffers apart. `dtype` counts when the buffer is made; by
        default bytes for a verdict, else doubles. Memory that is used again spares the time to
        allocate it.
        """
        held: Buffers = self._threads.__dict__
        cells = math.prod(shape)
        if name not in held or held[name].size < cells:
            dtype = dtype or (np.int8 if name in self.field.plan.verdict_names else np.float64)
            held[name] = np.empty(cells, dtype)
        return held[name][:cells].reshape(shape)

    def _statistics(self, name: str, values: Buffers, box: Box) -> State:
        """Return the state of the statistics of one output after a box, from its stored cells.

        Sums are made in the order of the compiled loop, so that both give the same bits. `values`
        has outputs and regimes of the cells, flat; `box` is start and stop on each axis.
        """
        lanes, totals = self._lanes(), Totals(self._slots(box), 1)
        cells = self._counted(name, values, box)
        starts = np.array([start for start, _ in box], np.int64)
        tiles = lanes.tiles(cells.shape)
        for ends, layout, offset in zip(tiles.ends, tiles.layouts, tiles.offsets, strict=True):
            held = {kind: lanes.buffer(kind, layout.lanes) for kind in GATHERED}
            here = tuple(slice(start, stop) for start, stop in ends.tolist())
            lanes.gather(cells[here], starts + ends[:, 0], layout, held)
            totals.fold_counts(held["counts"], layout, offset, 0, 1)
            totals.fold_sum(name, held["sum"], layout, offset, lanes.line)
            for kind in ("largest", "least"):
                extremes, at = held[f"first_{kind}"], held[f"{kind}_at"]
                totals.fold_extremes(name, kind, extremes, at, layout, offset)
        state = totals.state(name, 0)
        if "mean" not in self._asked.statistics:
            state = {key: values for key, values in state.items() if key.endswith(".ends")}
        return state

    def _counted(self, name: str, values: Buffers, box: Box) -> NDArray[np.float64]:
        """Return an output's cells of a box, NaN where their regime keeps them from counting."""
        cells = self._buffer("masked", tuple(stop - start for start, stop in box))
        others.masked(values[name], *self._judged(name, values), cells.reshape(-1))
        return cells

    def _judged(self, name: str, values: Buffers) -> tuple[NDArray[np.int8], int]:
        """Return the regimes of the cells of an output, and those that count, a bit for each."""
        judge = judge_of(self.field.plan, self._asked, name)
        if judge is not None:
            return values[judge.name], VALID_REGIMES
        none = self._buffer("no regime", values[name].shape, np.int8)
        none[:] = 0
        return none, EVERY_REGIME

    def _quantiles(self, name: str, values: Buffers, rows: Rows, box: Box) -> State:
        """Return the state of an output's quantiles after a box: final values, or a histogram.

        Final values are possible where a box has all cells of its slots, points of the result; else
        histograms of all boxes are added up. `values` has outputs and regimes of the cells, flat;
        `rows` tells which cells belong to which slot; `box` is start and stop on each axis.
        """
        if not self.is_exact:
            counts = self._buffer("bins", (others.BINS,), np.int64)
            counts[:] = 0
            others.histogram(values[name], *self._judged(name, values), counts)
            bins = np.flatnonzero(counts)
            return {f"{name}.bins": bins, f"{name}.filled": counts[bins]}
        cells = self._counted(name, values, box)
        goes = self.cutting.goes
        order = sorted(range(len(box)), key=lambda axis: goes[axis])
        lines = cells.transpose(order).reshape(rows.count, -1)
        return {f"{name}.quantiles": exact_quantiles(lines, self._asked.quantiles, self.times)}

    def _met(
        self, conditions: tuple[ShareCondition, ...], values: Buffers, rows: Rows
    ) -> NDArray[np.int64]:
        """Return the number of cells of each slot that meet a share's conditions, shape (slots,).

        A slot is a point of the reduced result. `values` has outputs and regimes of all cells of a
        box, flat; `rows` says which cells belong to which slot.
        """
        met = np.ones(next(iter(values.values())).size, np.int8)
        for condition in conditions:
            if condition.is_regime:
                same = values[condition.name] == REGIMES[str(condition.value)].value
                met[same if condition.comparison == "!=" else ~same] = 0
            else:
                others.meet(
                    values[condition.name], *self._judged(condition.name, values),
                    COMPARED[condition.comparison], float(condition.value), met,
                )  # fmt: skip
        return _counted(met, 1, rows)

    def _crossings(self, name: str, values: Buffers, rows: Rows, box: Box) -> State:
        """Return the state of a level after a box: its smallest or largest crossing in each slot.

        A level asks where along an axis an output crosses a value; a slot is a point of the result.
        The crossing is infinite where there is none. `values` has outputs and regimes of the cells,
        flat, of the wider box that `_wider` made, `box` here; `rows` says which cells belong to
        which slot.
        """
        level, dims = self.field.levels[name], self.field.dims
        at = dims.index(level.along)
        stride = math.prod(stop - start for start, stop in box[at + 1 :])
        largest = level.take == "largest"
        crossings = np.full(rows.count, -np.inf if largest else np.inf)
        others.crossings(
            values[level.output], *self._judged(level.output, values), level.level,
            self._grid.axes[level.along].array(*box[at]), stride, largest,
            rows.slots, rows.length, rows.spread, crossings,
        )  # fmt: skip
        return {f"{name}.{level.take}": crossings}


def exact_quantiles(
    lines: NDArray[np.float64], quantiles: tuple[float, ...], times: int = 1
) -> NDArray[np.float64]:
    """Return quantiles of each line of values, ignoring NaN, shape (quantiles, lines).

    `lines` has the shape (lines, cells), a line for each point of the result. Each value counts
    `times`, as it stands for so many cells. A quantile between two cells lies on the straight line
    between their values, as in numpy's method `linear`.
    """
    lines = np.sort(lines, axis=-1)
    counts = lines.shape[1] - np.count_nonzero(np.isnan(lines), axis=-1)
    result = np.full((len(quantiles), len(lines)), np.nan)
    some = np.flatnonzero(counts)
    for k, quantile in enumerate(quantiles):
        cells = counts[some] * times
        place = quantile * (cells - 1)
        before = np.floor(place).astype(np.int64)
        share = place - before
        low = lines[some, before // times]
        high = lines[some, np.minimum(before + 1, cells - 1) // times]
        with np.errstate(invalid="ignore"):
            step = np.where(low == high, 0.0, high - low)
            between = np.where(share < 0.5, low + step * share, high - step * (1 - share))
        result[k, some] = np.where(share == 0, low, between)  # an infinite step has no part of 0
    return result


def _counted(flags: NDArray[np.int8], wanted: int, rows: Rows) -> NDArray[np.int64]:
    """Return the number of cells of each slot whose flag is `wanted`, shape (slots,).

    A slot is a point of the reduced result. `flags` are the regimes of all cells of a box, flat;
    `rows` says which cells belong to which slot.
    """
    counts = np.zeros(rows.count, np.int64)
    count: Callable[..., None] = others.count_across if rows.spread else others.count_along
    count(flags, wanted, rows.slots, rows.length, counts)
    return counts


def values_of(keys: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the floats that belong to integer keys, which have the same order as the floats."""
    return (keys ^ ((keys >> 63) & MAGNITUDE)).view(np.float64)


def stored_order(field: ReducedField, grid: Grid, asked: Reduction) -> LaneOrder:
    """Return the order of cells in tiles where all cells are stored before statistics.

    `field` is a group of outputs over the same axes. The innermost loop runs over as many of the
    last axes as its length allows. With quantiles, the axes that stay come first, so that a tile
    has all cells of a few values of the result. `asked` is the section `reduce` of the study. The
    order tells which axes are loops and which the innermost row, and the values of each axis in a
    tile.
    """
    dims = field.dims
    if asked.quantiles:
        dims = tuple(sorted(dims, key=lambda dim: dim in asked.over))
        over = sum(dim in asked.over for dim in dims)
    else:
        over = len(dims)
    count, period = 0, 1
    while count < over and period <= LONGEST_ROW:
        count, period = count + 1, period * grid.shape[dims[-1 - count]]
    split = len(dims) - count
    most = LONG_TILE_CELLS if takes_long(field.plan) else TILE_CELLS
    return LaneOrder.of(dims[:split], dims[split:], grid.shape, asked.over, most)
