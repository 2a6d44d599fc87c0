"""The tiles of a box, gathered in lanes and folded: statistics without a second look at a cell."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.lane_loop import LaneOrder, aligned
from vibrafeed.core.reduce.cutting import Box
from vibrafeed.core.reduce.kernels import folding
from vibrafeed.core.reduce.kernels.bits import LEAST, MOST
from vibrafeed.core.reduce.state import State
from vibrafeed.core.reduce.sums import LEVELS, propagate_carries

Shape = tuple[tuple[str, int], ...]
Integers = NDArray[np.int64]
Array = NDArray[np.float64]

GATHERED = {
    "counts": 0.0,
    "sum": 0.0,
    "first_largest": math.nan,
    "largest_at": math.inf,
    "first_least": math.nan,
    "least_at": math.inf,
}
"""The kinds of lanes that gather stored cells, and what a lane of each holds without a cell."""
EMPTY = {**GATHERED, "largest": -math.inf, "least": math.inf}
"""The same of all kinds; an extreme without its place begins with what no value is beyond."""


@dataclass(frozen=True)
class TileLayout:
    """The layout of the lanes of a tile.

    Attributes
    ----------
    strides : ndarray of int64, shape (loops + 1,)
        Lanes from one value of an axis to the next, by `LaneOrder.along_loops`.
    lanes : int
        Number of lanes.
    numbers : ndarray of int64, shape (lanes,)
        What the place of a lane in a row adds to the number of a cell.
    order : ndarray of int64, shape (lanes,)
        The lanes of the first slot, of the second and so on.
    own_slots : ndarray of int64, shape (slots of the tile,)
        Those slots, among the slots of the box but for an offset.
    """

    strides: Integers
    lanes: int
    numbers: Integers
    order: Integers
    own_slots: Integers


@dataclass(frozen=True)
class BoxTiles:
    """The tiles of boxes of equal lengths, the last axis fastest: what is gathered at a time.

    Attributes
    ----------
    ends : ndarray of int64, shape (tiles, axes, 2)
        Start and stop of each tile on each axis of the field, from the start of the box.
    ranges : ndarray of int64, shape (tiles, loops + 1, 2)
        The same as loops take them, by `LaneOrder.ranges`.
    layouts : tuple of TileLayout
        The layout of each tile's lanes.
    offsets : tuple of int
        What is added to the slots of each layout to get slots of the box.
    """

    ends: Integers
    ranges: Integers
    layouts: tuple[TileLayout, ...]
    offsets: tuple[int, ...]


class BoxLanes:
    """The lanes that gather the tiles of a box, in buffers that one thread uses again and again.

    Parameters
    ----------
    order : LaneOrder
        The tiles.
    dims, over : sequence of str
        The axes of the field, and those that go.
    shape : mapping of str to int
        Number of values of each axis.
    """

    def __init__(
        self, order: LaneOrder, dims: Sequence[str], over: Sequence[str], shape: Mapping[str, int]
    ):
        self.order, self._dims, self._shape = order, dims, shape
        self._goes = frozenset(over)
        self.numbers = _strides({name: shape[name] for name in dims if name in self._goes})
        self._along = order.cells_along(dims)
        self._held: dict[str, Array] = {}
        self.line = np.empty(order.most_lanes(shape, over))
        self._layouts = lru_cache(maxsize=64)(self._placed)
        self.tiles = lru_cache(maxsize=16)(self._tiles)

    def buffer(self, kind: str, lanes: int) -> Array:
        """Return an array in which a compiled loop gathers totals of one kind, shape (lanes,).

        A lane is a place for one total. `kind` is a name that ends in a key of `EMPTY`, such as
        ``"sum"``. At first all lanes are empty; whoever adds them to the totals of a block empties
        them again, so that the array serves for the next cells.
        """
        of = kind.split(".")[-1]
        name = f"{kind} {lanes}"
        if name not in self._held:
            self._held[name] = aligned((lanes,))
            self._held[name][:] = EMPTY[of]
        return self._held[name]

    def _tiles(self, lengths: tuple[int, ...]) -> BoxTiles:
        """Return the tiles of boxes that have some lengths along the axes of the field.

        A box contains whole tiles only. Boxes of equal lengths have the same tiles: `tiles` keeps
        the last results.
        """
        steps = [self.order.steps[name] for name in self._dims]
        along = [
            [(start, min(start + step, length)) for start in range(0, length, step)]
            for length, step in zip(lengths, steps, strict=True)
        ]
        tiles = list(itertools.product(*along))
        ends = np.array(tiles, np.int64).reshape(len(tiles), len(lengths), 2)
        box = dict(zip(self._dims, lengths, strict=True))
        strides = _strides({name: box[name] for name in self._dims if name not in self._goes})
        own = np.array([strides.get(name, 0) for name in self._dims], np.int64)
        layouts = tuple(
            self._layouts(tuple(sizes), tuple(strides.items()))
            for sizes in (ends[..., 1] - ends[..., 0]).tolist()
        )
        ranges = self.order.ranges(self._dims, ends)
        return BoxTiles(ends, ranges, layouts, tuple((ends[..., 0] @ own).tolist()))

    def placed(self, box: Box) -> tuple[BoxTiles, Integers]:
        """Return the tiles of a box, and where they lie in the grid, as loops take them.

        A box is start and stop on each axis; the array has the shape (tiles, loops + 1, 2).
        """
        tiles = self.tiles(tuple(stop - start for start, stop in box))
        loops, cells = self._along
        return tiles, tiles.ranges + np.array([[box[axis][0]] for axis in loops], np.int64) * cells

    def _placed(self, lengths: tuple[int, ...], slot_strides: Shape) -> TileLayout:
        """Return the layout of lanes for tiles of given lengths: which lane belongs to which slot.

        A lane is a place in which cells are gathered, a slot a point of the result. `lengths` are
        those of the axes; `slot_strides` are the slots from one value to the next, for each axis
        that stays.
        """
        lanes = self.order.lanes(dict(zip(self._dims, lengths, strict=True)), self._goes)
        of_slot = dict(slot_strides)
        count = math.prod(lanes.values())
        slots, numbers = np.zeros(count, np.int64), np.zeros(count, np.int64)
        for name, at in zip(lanes, np.indices(tuple(lanes.values())), strict=True):
            if name in self.order.inner and name in self._goes:
                numbers += at.reshape(-1) * self.numbers[name]
            elif name not in self._goes:
                slots += at.reshape(-1) * of_slot[name]
        order = np.argsort(slots, kind="stable")
        each = math.prod(n for name, n in lanes.items() if name in self._goes)
        strides = _strides(lanes)
        if self.order.gathers:
            del strides[self.order.inner[0]]
        own_slots = slots[order][::each].copy()
        return TileLayout(self.order.along_loops(strides), count, numbers, order, own_slots)

    def gather(
        self, cells: Array, at: Integers, layout: TileLayout, lanes: Mapping[str, Array]
    ) -> None:
        """Add stored cells of a tile to lanes, places for totals, as a compiled loop would.

        Parameters
        ----------
        cells : ndarray
            Values of an output over the axes of the field, NaN where a cell does not count.
        at : ndarray of int64, shape (axes,)
            Where the tile starts on each axis.
        layout : TileLayout
            Which lane belongs to which point of the result.
        lanes : mapping of str to ndarray
            An array for each kind of total, a key of `GATHERED`; they are updated.
        """
        axes = [self._dims.index(name) for name in (*self.order.outer, *self.order.inner)]
        rows = cells.transpose(axes)
        steps = self.order.along_loops(self.numbers)  # the last along the row, if there is one
        outer = rows.shape[: len(self.order.outer)]
        starts = np.zeros(outer, np.int64)
        numbers = np.full(outer, at[axes[: steps.size]] @ steps)
        for loop, turn in enumerate(np.indices(outer)):
            starts += turn * layout.strides[loop]
            numbers += turn * steps[loop]
        along = steps[-1] if self.order.inner else 0
        folding.gather(
            np.ascontiguousarray(rows).reshape(starts.size, -1),
            starts.reshape(-1), numbers.reshape(-1), self.order.piece,
            0 if self.order.gathers else self.order.piece,
            self.order.piece // self.order.period * along,
            *(lanes[kind] for kind in GATHERED),
        )  # fmt: skip


class Totals:
    """The totals of the slots of a box, from the tiles that were seen so far.

    Parameters
    ----------
    slots, counters : int
        Number of slots of the box, and of counts of each.

    Attributes
    ----------
    counts : ndarray of int64, shape (counters, slots)
        Counts.
    """

    def __init__(self, slots: int, counters: int):
        self.counts = np.zeros((counters, slots), np.int64)
        self._slots = slots
        self._ends: dict[str, Integers] = {}
        self._sums: dict[str, tuple[Integers, Array, Integers]] = {}

    def fold_sum(
        self, name: str, lanes: Array, layout: TileLayout, offset: int, line: Array
    ) -> None:
        """Add the sums that a tile has gathered for an output to the totals; empty the lanes.

        Parameters
        ----------
        name : str
            The output.
        lanes : ndarray
            A sum for each lane, 0 afterwards.
        layout : TileLayout
            Which lanes belong to which slot, a point of the result.
        offset : int
            Added to the slots of the tile: where the tile stands in the box.
        line : ndarray
            Room for the lanes of one slot, overwritten.
        """
        if name not in self._sums:
            digits = np.zeros((LEVELS, self._slots), np.int64)
            self._sums[name] = digits, np.zeros(self._slots), np.array([LEVELS, -1])
        folding.fold_sums(lanes, layout.order, layout.own_slots, offset, line, *self._sums[name])

    def fold_extremes(
        self, name: str, kind: str, lanes: Array, at: Array, layout: TileLayout, offset: int
    ) -> None:
        """Update the largest or least values of an output from lanes of a tile; empty the lanes.

        Parameters
        ----------
        name, kind : str
            The output; ``"largest"`` or ``"least"``.
        lanes, at : ndarray
            The extreme in each lane, and the number of the row in which it lies; `at` is empty if
            no place is wanted.
        layout : TileLayout
            Which lanes belong to which slot, a point of the result.
        offset : int
            Added to the slots of the tile: where the tile stands in the box.
        """
        ends, row = self._ends_of(name), 2 if kind == "least" else 0
        folding.fold_extremes(
            lanes, at, kind == "least", layout.order, layout.own_slots, offset, layout.numbers,
            ends[row], ends[row + 1],
        )  # fmt: skip

    def fold_counts(
        self, lanes: Array, layout: TileLayout, offset: int, first: int, last: int
    ) -> None:
        """Add packed counts in lanes to the counters `first` to `last`; empty the lanes.

        `offset` is that of the tile among the slots of the box.
        """
        folding.fold_counts(lanes, layout.order, layout.own_slots, offset, self.counts[first:last])

    def state(self, name: str, counter: int) -> State:
        """Return the totals of an output after all tiles of a box, as arrays that can be added up.

        They are extremes, count and exact sum for each slot, a point of the reduced result; names
        begin with that of the output. `counter` is the row of `counts` that counts its cells.
        """
        ends = self._ends_of(name)
        state: State = {f"{name}.ends": np.concatenate([ends, self.counts[counter : counter + 1]])}
        if name in self._sums:
            digits, beyond, levels = self._sums[name]
            low, high = (int(levels[0]), int(levels[1])) if levels[1] >= 0 else (0, 0)
            # One digit more has room for what is carried.
            state[f"{name}.low"] = np.array([low])
            state[f"{name}.digits"] = propagate_carries(digits[low : high + 2])
            state[f"{name}.beyond"] = beyond
        return state

    def _ends_of(self, name: str) -> Integers:
        """Return the extremes of an output, int64 of shape (4, slots), created empty if missing.

        Rows: key and cell of the largest, then of the least, for each slot, a point of the result.
        A key is an integer that sorts like the float.
        """
        if name not in self._ends:
            self._ends[name] = np.zeros((4, self._slots), np.int64)
            self._ends[name][0], self._ends[name][2] = LEAST, MOST
        return self._ends[name]


def _strides(sizes: Mapping[str, int]) -> dict[str, int]:
    """Return the distance of neighbours along each axis in a flat array, the last axis fastest.

    `sizes` are the lengths of the axes, in order.
    """
    strides: dict[str, int] = {}
    stride = 1
    for name in reversed(tuple(sizes)):
        strides[name] = stride
        stride *= sizes[name]
    return strides
