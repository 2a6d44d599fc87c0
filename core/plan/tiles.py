"""A study of closed forms cut into tiles: what each of them holds, and its values.

Outputs that have the same axes make a field, which has a grid of its own: nothing is computed, or
cut, along axes that it does not have. The tiles of all fields are counted together.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.dataset.layout import Box, Layout
from core.plan.evaluate import evaluate
from core.plan.grid import Grid, axis_values, from_si
from core.plan.plan import Plan
from core.plan.prepared import BYTES, Prepared
from core.study.values import Points


@dataclass(frozen=True)
class Field:
    """Outputs with the same axes.

    Attributes
    ----------
    names : tuple of str
        The outputs, and `regime` if it has these axes too.
    dims : tuple of str
        The axes.
    layout : Layout
        How their arrays are cut.
    plan : Plan
        What they pull.
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    layout: Layout
    plan: Plan

    @property
    def bytes(self) -> int:
        """Bytes of the values of all its arrays, with the padding of chunks."""
        return self.layout.stored * sum(BYTES.get(name, 8) for name in self.names)


@dataclass(frozen=True)
class Tile:
    """A part of a field."""

    field: Field
    box: Box

    @property
    def cells(self) -> int:
        """Number of points."""
        return math.prod(stop - start for start, stop in self.box)

    @property
    def where(self) -> dict[str, tuple[int, int]]:
        """Start and stop on each axis of the field."""
        return dict(zip(self.field.dims, self.box, strict=True))


class Tiles:
    """The tiles of a study whose outputs are closed forms, in the order in which files have them.

    Parameters
    ----------
    prepared : Prepared
        The study, of any size.
    """

    def __init__(self, prepared: Prepared):
        self._grid = prepared.grid
        together: dict[tuple[str, ...], list[str]] = {}
        for name, dims in prepared.dims.items():
            together.setdefault(dims, []).append(name)
        plan = prepared.plan
        self.fields = tuple(
            Field(
                tuple(names),
                dims,
                Layout.of([prepared.grid.shape[dim] for dim in dims]),
                plan.part(
                    tuple(name for name in names if name != "regime"),
                    plan.conditions if "regime" in names else (),
                ),
            )
            for dims, names in together.items()
        )

    @cached_property
    def _ends(self) -> list[int]:
        return list(accumulate(field.layout.tiles for field in self.fields))

    def __len__(self) -> int:
        """Return the number of tiles of all fields, at least one."""
        return self._ends[-1]

    def __getitem__(self, index: int) -> Tile:
        """Return a tile by its number."""
        at = bisect_right(self._ends, index)
        field = self.fields[at]
        return Tile(field, field.layout.box(index - (self._ends[at] - field.layout.tiles)))

    @property
    def cells(self) -> int:
        """Number of points of all fields together: the work."""
        return sum(math.prod(field.layout.shape) for field in self.fields)

    @property
    def bytes(self) -> int:
        """Bytes of all arrays uncompressed, with the padding of chunks."""
        return sum(field.bytes for field in self.fields)

    def values(self, tile: Tile) -> dict[str, NDArray[Any]]:
        """Return the arrays of a tile, in the units of files."""
        computed = evaluate(tile.field.plan, self._part(tile.field.plan, tile.where))
        return {name: _as_in_files(name, computed[name]) for name in tile.field.names}

    def at(self, places: Mapping[str, NDArray[np.int64]]) -> dict[str, NDArray[np.float64]]:
        """Return the outputs at some cells, SI units, each cell evaluated alone.

        `places` has the position on each axis of the study, shape (count,).
        """
        count = next((place.size for place in places.values()), 1)
        found = {name: np.empty(count) for field in self.fields for name in field.names}
        for field in self.fields:
            for k in range(count):
                where = {dim: (int(places[dim][k]), int(places[dim][k]) + 1) for dim in field.dims}
                values = evaluate(field.plan, self._part(field.plan, where))
                for name in field.names:
                    found[name][k] = values[name].item()
        del found["regime"]
        return found

    def _part(self, plan: Plan, where: Mapping[str, tuple[int, int]]) -> Grid:
        axes, fixed = self._grid.axes, self._grid.fixed
        return Grid(
            {dim: Points(tuple(axis_values(axes[dim], *ends))) for dim, ends in where.items()},
            {name: value for name, value in fixed.items() if name in plan.parameters},
        )


def _as_in_files(name: str, values: NDArray[Any]) -> NDArray[Any]:
    return values if name == "regime" else from_si(name, values)
