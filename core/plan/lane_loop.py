"""A loop that takes cells into lanes: what is known of many cells, without an array of them.

A lane is a place in a row. It gathers the cells that stand there, row after row: each step is on
whole rows, so that a processor's wide registers are full and no value crosses lanes.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loop_source import LONGEST_ROW
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.program import (
    MAX_VALUES,
    Runner,
    Values,
    bind_stages,
    edge_of,
    even_length,
    lay_out_operands,
    program_of,
)
from vibrafeed.core.plan.trace import Traced

DEPTH = 240
"""Most cells that a lane gathers: few enough that their sum is accurate, and that counts fit in 8
bits."""
LANES, MAX_LANES = 1024, 1 << 15
"""Usual number of lanes of a tile, and the most that it has where few cells go to each."""
TILE_CELLS = 1 << 19
"""Most cells of a tile, which then takes some hundred microseconds."""
LARGE_TILE_CELLS = 1 << 21
"""The same where no values are summed: a largest value does not depend on how cells are taken."""
STAGED_CELLS = 1 << 15
"""The same where numpy works between loops: its arrays stay in the second-level cache."""
FEWEST_TILES = 64
"""A grid has at least so many tiles, if its rows allow it, to be shared out among threads and
parts."""
LONGEST_AXIS = 1 << 20
"""Longest axis that is computed by a loop with lanes, which is given all its values at once."""
LINE = 64
"""Bytes of a line of a processor's cache: wide registers are filled from one line."""


@dataclass(frozen=True)
class LaneOrder:
    """The loops over the axes of a field, and the tiles whose cells lanes gather.

    A row along the axes `inner` has `period` cells for each value of its first axis, and at most
    `piece` lanes; `gathers`: that axis is reduced, and pieces of the row gather in the same lanes.
    `steps` has the values of each axis in a tile. `apart` are outer axes that are reduced, but
    whose values have lanes of their own.
    """

    outer: tuple[str, ...]
    inner: tuple[str, ...]
    piece: int
    period: int
    gathers: bool
    steps: Mapping[str, int]
    apart: frozenset[str]

    @classmethod
    def of(
        cls,
        outer: Sequence[str],
        inner: Sequence[str],
        shape: Mapping[str, int],
        over: Iterable[str],
        most: int = TILE_CELLS,
    ) -> LaneOrder:
        """Return the order in which a loop takes the cells of a grid to gather totals over axes.

        It follows from the grid alone: results do not depend on the machine.
        """
        goes = set(over)
        depth = DEPTH
        cells = math.prod(shape[name] for name in (*outer, *inner))
        most = max(1, min(most, -(-cells // FEWEST_TILES)))
        period = math.prod(shape[name] for name in inner[1:])
        piece = LONGEST_ROW // period * period
        gone = math.prod(shape[name] for name in (*outer, *inner[:1]) if name in goes)
        lanes = min(max(LANES, most // min(DEPTH, gone)), MAX_LANES, most)
        gathers = bool(inner) and inner[0] in goes
        steps = {name: shape[name] for name in inner[1:]}
        if gathers:
            at_once = min(shape[inner[0]], piece // period)
            pieces = even_length(-(-shape[inner[0]] // at_once), max(1, min(DEPTH, most // piece)))
            steps[inner[0]] = min(shape[inner[0]], pieces * at_once)
            depth //= pieces
            lanes = max(1, lanes // (at_once * period))
            most //= steps[inner[0]] * period
        elif inner:
            steps[inner[0]] = even_length(shape[inner[0]], max(1, lanes // period))
            lanes = max(1, lanes // (steps[inner[0]] * period))
            most //= steps[inner[0]] * period
        apart = set()
        for name in reversed(outer):
            is_deep = name in goes and depth > 1
            steps[name] = even_length(shape[name], max(1, min(depth if is_deep else lanes, most)))
            most //= steps[name]
            if is_deep:
                depth //= steps[name]
                continue
            lanes //= steps[name]
            if name in goes:
                apart.add(name)
        return cls(tuple(outer), tuple(inner), piece, period, gathers, steps, frozenset(apart))

    def lanes(self, shape: Mapping[str, int], over: Iterable[str]) -> dict[str, int]:
        """Return the number of lanes of a tile of some shape on each axis, outermost first."""
        goes = set(over)
        lanes = {name: shape[name] for name in self.outer if name not in goes or name in self.apart}
        for name in self.inner:
            lanes[name] = shape[name]
        if self.gathers:
            lanes[self.inner[0]] = min(shape[self.inner[0]], self.piece // self.period)
        return lanes

    def is_in_grid_order(self, axes: Iterable[str], over: Iterable[str]) -> bool:
        """True if each lane gets its cells in the order of the grid."""
        goes = set(over) - self.apart
        mixed = [name for name in self.outer if name in goes and self.steps[name] > 1]
        if self.gathers and self.steps[self.inner[0]] * self.period > self.piece:
            mixed.insert(0, self.inner[0])
        return mixed == [name for name in axes if name in mixed]

    def along_loops(self, values: Mapping[str, int]) -> NDArray[np.int64]:
        """Return a number, 0 where none is given, for each outer loop, then one for the row."""
        return np.array([values.get(name, 0) for name in (*self.outer, *self.inner[:1])], np.int64)

    def cells_along(self, axes: Sequence[str]) -> tuple[list[int], NDArray[np.int64]]:
        """Return the places of row and outer loops among `axes`, and cells for each value."""
        names = (*self.inner[:1], *self.outer)
        cells = [self.period] * len(self.inner[:1]) + [1] * len(self.outer)
        return [axes.index(name) for name in names], np.array(cells, np.int64).reshape(-1, 1)

    def ranges(self, axes: Sequence[str], ends: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return tiles as loops take them: start and stop along the row, then on each outer loop.

        `ends` on each of `axes` are int64, shape (tiles, axes, 2); the result (tiles, loops + 1,
        2).
        """
        loops, cells = self.cells_along(axes)
        return np.ascontiguousarray(ends[:, loops]) * cells

    def most_lanes(self, shape: Mapping[str, int], over: Iterable[str]) -> int:
        """Return the number of lanes of the largest tile of a grid."""
        tile = {name: min(step, shape[name]) for name, step in self.steps.items()}
        return math.prod(self.lanes(tile, over).values())


class LaneLoop:
    """The compiled loop of a plan that gathers its results in lanes.

    `grid` has the axes of the field alone; `updates` are names of results, each with a key of
    `vibrafeed.core.plan.loop_source.UPDATES`. A tile has at most `most` cells.
    """

    def __init__(
        self,
        plan: Plan,
        traced: Traced,
        grid: Grid,
        updates: Sequence[tuple[str, str]],
        over: Iterable[str],
        most: int = TILE_CELLS,
    ):
        self._grid = grid
        shape = tuple(grid.shape.items())
        names = tuple(name for name, _ in updates)
        with np.errstate(all="ignore"):  # equations for arrays compute what a choice leaves out
            values = Values(traced, plan, grid)
            special = values.special(edge_of(traced, names, shape, (), MAX_VALUES))
            wanted = tuple(update for _, update in updates)
            program = program_of(traced, names, shape, special, wanted)
            most = most if len(program.stages) == 1 else STAGED_CELLS
            order = LaneOrder.of(program.order.outer, program.order.inner, grid.shape, over, most)
            if order.is_in_grid_order(grid.shape, over):
                wanted = tuple(update.replace("first", "next") for update in wanted)
                program = program_of(traced, names, shape, special, wanted)
        self._program, self.order = program, order
        self._traced, self._values = traced, values
        self._loops: Runner | None = None
        self._threads = threading.local()

    @property
    def missing(self) -> frozenset[str]:
        """The sources of its loops that are not compiled in this process."""
        return self._program.missing

    def prepare(self) -> None:
        """Compute by numpy the inputs of the loop; to be called once before any `run`."""
        with np.errstate(all="ignore"):
            operands = lay_out_operands(self._program, self._traced, self._values, self._grid)
        for number, values in operands.items():
            if isinstance(values, np.ndarray):
                operands[number] = aligned(values.shape, values.dtype)
                operands[number][...] = values
        self._loops = bind_stages(self._program, operands, self._rows)

    def _rows(self, count: int) -> NDArray[np.float64]:
        held: dict[str, NDArray[np.float64]] = self._threads.__dict__
        if "rows" not in held or len(held["rows"]) < count:
            held["rows"] = aligned((count, LONGEST_ROW))
        return held["rows"][:count]

    def run(
        self,
        ranges: NDArray[np.int64],
        strides: NDArray[np.int64],
        numbers: NDArray[np.int64],
        lanes: Sequence[NDArray[np.float64]],
    ) -> None:
        """Compute the cells of a tile and add them to the flat arrays `lanes`.

        `ranges` is one of `LaneOrder.ranges`. `strides`, int64, shape (loops + 1,), are lanes from
        one value of an axis to the next, by `LaneOrder.along_loops`, `numbers` the same for the
        numbers of cells, by which `first_largest` and `first_least` name a cell.
        """
        assert self._loops is not None
        self._loops((ranges, strides, numbers), lanes)
        self._program.mark_compiled()


def aligned(shape: Sequence[int], dtype: Any = np.float64) -> NDArray[Any]:
    """Return a new array, not filled, that begins with a line of the cache.

    numpy's own begin at any multiple of 16 bytes: half of all loads may then touch two lines, and a
    compiled loop takes up to a tenth longer.
    """
    size = math.prod(shape) * np.dtype(dtype).itemsize
    room = np.empty(size + LINE, np.uint8)
    start = -room.__array_interface__["data"][0] % LINE
    return room[start : start + size].view(dtype).reshape(shape)
