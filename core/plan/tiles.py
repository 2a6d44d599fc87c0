"""The tiles of a study of closed forms, each evaluated by itself.

A field of a study, which is outputs with the same axes, has a plan and a grid of its own: nothing
is computed, or cut, along axes that it does not have.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.layout import Tile, Tiles
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared


class Tiled:
    """A study of closed forms, of any size, that is evaluated tile by tile.

    Parameters
    ----------
    prepared : Prepared
        The study.

    Attributes
    ----------
    tiles : Tiles
        Where the tiles lie.
    """

    def __init__(self, prepared: Prepared):
        """Divide the grid of a study into tiles."""
        self.tiles = Tiles(prepared.dims, prepared.grid.shape)
        self._grid, self._plan, self._prepared = prepared.grid, prepared.plan, prepared
        self._plans = {field: prepared.plan.part(field.names) for field in self.tiles.fields}

    @property
    def bytes(self) -> int:
        """The bytes of all arrays in uncompressed files."""
        width = self._prepared.width
        return self.tiles.stored({n: width(n) for f in self.tiles.fields for n in f.names})

    def values(self, tile: Tile) -> dict[str, NDArray[Any]]:
        """Return the arrays of a tile, in the units of files."""
        computed = self._evaluated(self._plans[tile.field], tile.where)
        return {name: self._prepared.in_files(name, computed[name]) for name in tile.field.names}

    def part(self, name: str, where: Mapping[str, tuple[int, int]]) -> NDArray[Any]:
        """Return an array of the study in a box of its own axes, in the units of files."""
        return self._prepared.in_files(name, self._evaluated(self._plan.part((name,)), where)[name])

    def at(self, positions: Mapping[str, NDArray[np.int64]], count: int) -> dict[str, NDArray[Any]]:
        """Return the outputs of a sweep at some cells, SI units, (count,) each, to verify them.

        `positions` has, for each axis of the study, the index of every cell on it, shape (count,).
        The sweep may be too large to be computed as a whole; cells are computed one by one.
        """
        cells = [
            self._evaluated(
                self._plan, {d: (int(p[k]), int(p[k]) + 1) for d, p in positions.items()}
            )
            for k in range(count)
        ]
        return {
            name: np.array([cell[name].item() for cell in cells], dtype=np.float64)
            for name in self._plan.outputs
        }

    def _evaluated(self, plan: Plan, where: Mapping[str, tuple[int, int]]) -> dict[str, Any]:
        """Return the outputs of a plan on a part of the grid."""
        return evaluate(plan, self._grid.piece(where, plan.parameters))
