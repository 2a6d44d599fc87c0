"""Cuts a grid for a reduction: blocks of slots, each seen in rounds of cells.

Where the cells of a slot fit in a box, a block has many slots and one round; otherwise it is one
slot, seen in many rounds. Either way a box is one round of one block, and what is known of a block
is all that has to be in memory beside the result.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.program import even_length

BOX_CELLS = 1 << 22
"""Most cells of a box, which then takes some milliseconds."""
BLOCK_SLOTS = 1 << 17
"""Most slots of a block: their sums and extremes take some 16 MiB."""

Box = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Cutting:
    """The cut of the axes of a field.

    Attributes
    ----------
    shape : tuple of int
        Number of values of each axis.
    goes : tuple of bool
        Whether the axis is reduced.
    steps : tuple of int
        Number of values of each axis in a box, but for the last boxes.
    """

    shape: tuple[int, ...]
    goes: tuple[bool, ...]
    steps: tuple[int, ...]

    @classmethod
    def of(
        cls,
        shape: Sequence[int],
        goes: Sequence[bool],
        cells: int = BOX_CELLS,
        slots: int = BLOCK_SLOTS,
        tile: Sequence[int] = (),
    ) -> Cutting:
        """Return a cut of a grid into boxes of cells, in blocks of the reduced result.

        A box has at most `cells` cells, a block at most `slots` points (slots) of the result, if
        whole tiles allow it.

        Parameters
        ----------
        shape : sequence of int
            Lengths of the axes.
        goes : sequence of bool
            True for the axes that are reduced away.
        tile : sequence of int, optional
            Number of values of each axis that belong together; a box has whole tiles, one at least.
        """
        tile = tuple(tile) or (1,) * len(shape)
        steps = [min(n, step) for n, step in zip(shape, tile, strict=True)]
        last_first = range(len(shape) - 1, -1, -1)
        seen = math.prod(size for size, gone in zip(shape, goes, strict=True) if gone)
        kept = math.prod(step for step, gone in zip(steps, goes, strict=True) if not gone)

        def widen(axes: Iterable[int], budget: int) -> None:
            """Enlarge the boxes along some axes, in this order, to at most `budget` tiles."""
            for axis in axes:
                tiles = even_length(-(-shape[axis] // steps[axis]), budget)
                steps[axis] = min(shape[axis], tiles * steps[axis])
                budget //= tiles

        if seen * kept <= cells:
            for axis in (axis for axis in last_first if goes[axis]):
                steps[axis] = shape[axis]
            room = min(cells // seen, slots) // kept
            widen((axis for axis in last_first if not goes[axis]), room)
        else:
            room = cells // math.prod(steps)
            widen((axis for axis in last_first if goes[axis]), room)
        return cls(tuple(shape), tuple(goes), tuple(steps))

    @cached_property
    def _pieces(self) -> tuple[int, ...]:
        """Return the number of boxes along each axis."""
        return tuple(-(-n // step) for n, step in zip(self.shape, self.steps, strict=True))

    @cached_property
    def blocks(self) -> int:
        """The number of blocks."""
        return math.prod(n for n, gone in zip(self._pieces, self.goes, strict=True) if not gone)

    @cached_property
    def rounds(self) -> int:
        """The number of rounds of each block."""
        return math.prod(n for n, gone in zip(self._pieces, self.goes, strict=True) if gone)

    @property
    def cells(self) -> int:
        """The number of cells of all boxes."""
        return math.prod(self.shape)

    def box(self, block: int, turn: int) -> Box:
        """Return a box of cells: start and stop on each axis.

        `block` is the number of the block, a region of the reduced result, and `turn` that of the
        round: the boxes whose cells are reduced to that block are taken one after another.
        """
        left = {False: block, True: turn}
        box: list[tuple[int, int]] = []
        axes = zip(self.goes, self._pieces, self.steps, self.shape, strict=True)
        for gone, pieces, step, size in reversed(list(axes)):
            left[gone], at = divmod(left[gone], pieces)
            box.insert(0, (at * step, min((at + 1) * step, size)))
        return tuple(box)

    def kept(self, box: Box) -> Box:
        """Return the slots that a box contributes to: start and stop on each axis that stays."""
        return tuple(ends for ends, gone in zip(box, self.goes, strict=True) if not gone)

    def order(self, box: Box, cells: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the number that each of a box's cells has among all cells of its slot.

        A slot is a point of the reduced result; of equal extremes the cell with the least number
        counts. `box` is start and stop on each axis, `cells` are positions in the box, flat.
        """
        lengths = [stop - start for start, stop in box]
        at = np.unravel_index(cells, lengths) if box else ()
        number = np.zeros_like(cells)
        for place, (start, _), n, gone in zip(at, box, self.shape, self.goes, strict=True):
            if gone:
                number = number * n + (place + start)
        return number


@dataclass(frozen=True)
class Rows:
    """The rows of a box, as kernels take them.

    Attributes
    ----------
    slots : ndarray of int64, shape (rows,)
        The slot of each row, or of its first cell.
    length : int
        Cells of a row.
    spread : bool
        Whether the cells of a row go to slots one after another; else all to one.
    count : int
        Number of slots of the box.
    """

    slots: NDArray[np.int64]
    length: int
    spread: bool
    count: int

    @classmethod
    def of(cls, lengths: tuple[int, ...], goes: tuple[bool, ...]) -> Rows:
        """Return the cells of a box as rows, each of one slot or with a slot for each cell.

        A slot is a point of the reduced result. `lengths` are the values of the box on each axis;
        `goes` is true for axes that are reduced. Rows run along the last axes of one kind and are
        as long as possible. The result has the slot of each row's first cell, the cells of a row,
        whether these have slots of their own, and the number of slots.
        """
        axes = [(n, gone) for n, gone in zip(lengths, goes, strict=True) if n > 1]
        spread = bool(axes) and not axes[-1][1]
        length = 1
        while axes and axes[-1][1] != spread:
            length *= axes.pop()[0]
        slots = np.zeros([n for n, _ in axes], np.int64)
        stride = length if spread else 1
        for axis in range(len(axes) - 1, -1, -1):
            size, gone = axes[axis]
            if not gone:
                places = np.arange(size, dtype=np.int64) * stride
                slots += places.reshape([-1] + [1] * (len(axes) - axis - 1))
                stride *= size
        return cls(slots.reshape(-1), length, spread, stride)
