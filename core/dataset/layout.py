"""The layout of an array in a file: chunks, which a reader takes, and tiles of whole chunks.

A tile is the unit of work, of progress and of resuming, and one shard of a Zarr array. Both depend
on the shape alone, never on the machine: equal studies give equal bytes.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

# Values of a chunk, 512 KiB of floats or 64 KiB of flags: worth a request, and soon sent.
CHUNK_CELLS = 65_536
# Values of a tile, 32 MiB of floats: long enough to write, and four of them fit into memory.
TILE_CELLS = 4_194_304
# Largest ratio of stored to real values of chunks that are cut alike; beyond it, lengths are sought
# that fit the axes better.
MAX_PADDING = 1.05
MAX_TRIED = 128  # largest length that is tried: longer ones pad by less than 1/128 anyway

Box = tuple[tuple[int, int], ...]
"""A part of an array: start and stop along each of its dimensions."""


@dataclass(frozen=True)
class Layout:
    """The layout of an array in chunks and tiles.

    Attributes
    ----------
    shape, chunk, tile : tuple of int
        Lengths of the whole, of a chunk and of a tile. A tile is a whole number of chunks; those at
        the end of an axis may be cut off by the end of the array.
    """

    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    tile: tuple[int, ...]

    @classmethod
    def of(cls, shape: Sequence[int]) -> Layout:
        """Return the layout in chunks and tiles for an array; equal shapes get equal layouts.

        `shape` is the number of values along each dimension, which may be 0.
        """
        lengths = tuple(max(1, n) for n in shape)  # an axis may have no values
        chunk = chunk_shape(lengths, CHUNK_CELLS)
        return cls(tuple(shape), chunk, _tile_shape(lengths, chunk, TILE_CELLS))

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """The number of tiles along each dimension."""
        return tuple(-(-n // length) for n, length in zip(self.shape, self.tile, strict=True))

    @property
    def tiles(self) -> int:
        """The number of tiles."""
        return math.prod(self.counts)

    @property
    def stored(self) -> int:
        """The number of values in all chunks, padding included."""
        return math.prod(
            -(-n // length) * length for n, length in zip(self.shape, self.chunk, strict=True)
        )

    def box(self, index: int) -> Box:
        """Return start and stop of a tile on each axis of the array.

        Tiles are equal blocks of the array, those at the end of an axis cut off, in which a large
        result is computed and written. `index` is the number of the tile in C order, from 0.
        """
        at = np.unravel_index(index, self.counts) if self.shape else ()
        return tuple(
            (int(k) * length, min((int(k) + 1) * length, n))
            for k, length, n in zip(at, self.tile, self.shape, strict=True)
        )

    def chunks(self, box: Box) -> Iterator[Box]:
        """Yield start and stop of each chunk of a tile on each axis of the array, in C order.

        A tile is the block of cells that is computed at once; it is stored in chunks, each
        compressed by itself. `box` is start and stop of the tile on each axis.
        """
        steps = (
            [(start, min(start + length, stop)) for start in range(begin, stop, length)]
            for (begin, stop), length in zip(box, self.chunk, strict=True)
        )
        yield from itertools.product(*steps)


@dataclass(frozen=True)
class StoredField:
    """Arrays over the same dimensions, which are cut alike.

    Attributes
    ----------
    names : tuple of str
        The arrays.
    dims : tuple of str
        Their dimensions, at least one.
    layout : Layout
        How each of them is cut.
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    layout: Layout


@dataclass(frozen=True)
class Tile:
    """A tile of all arrays of a field."""

    field: StoredField
    box: Box

    @property
    def cells(self) -> int:
        """The number of points."""
        return math.prod(stop - start for start, stop in self.box)

    @property
    def where(self) -> dict[str, tuple[int, int]]:
        """Start and stop on each dimension."""
        return dict(zip(self.field.dims, self.box, strict=True))


class Tiles:
    """The tiles of all arrays of a result, in the order in which files have them.

    What has no dimension is in none: it is known before the first tile.

    Parameters
    ----------
    dims : mapping of str to tuple of str
        The dimensions of each array.
    sizes : mapping of str to int
        The length of each dimension.
    """

    def __init__(self, dims: Mapping[str, tuple[str, ...]], sizes: Mapping[str, int]):
        """Divide the arrays of a result, given their dimensions and sizes, into tiles."""
        together: dict[tuple[str, ...], list[str]] = {}
        for name, own in dims.items():
            if own:
                together.setdefault(own, []).append(name)
        self.fields = tuple(
            StoredField(tuple(names), own, Layout.of([sizes[dim] for dim in own]))
            for own, names in together.items()
        )
        self._ends = list(itertools.accumulate(field.layout.tiles for field in self.fields))

    def __len__(self) -> int:
        """Return the number of tiles of all fields."""
        return self._ends[-1] if self._ends else 0

    def __iter__(self) -> Iterator[Tile]:
        """Yield the tiles in their order."""
        return map(self.__getitem__, range(len(self)))

    def __getitem__(self, index: int) -> Tile:
        """Return a tile by its number, counted from 0 through all fields."""
        at = bisect_right(self._ends, index)
        layout = self.fields[at].layout
        return Tile(self.fields[at], layout.box(index - self._ends[at] + layout.tiles))

    @property
    def cells(self) -> int:
        """The number of points of all fields together."""
        return sum(math.prod(field.layout.shape) for field in self.fields)

    def stored(self, widths: Mapping[str, int]) -> int:
        """Return the uncompressed bytes of all chunks.

        `widths` are the bytes of a value, by array.
        """
        return sum(f.layout.stored * sum(widths[name] for name in f.names) for f in self.fields)


def chunk_shape(shape: tuple[int, ...], most: int) -> tuple[int, ...]:
    """Return the chunk shape of an array of a shape, with at most `most` values in a chunk.

    All axes are cut alike as far as they are long enough: a reader who takes a slice along any two
    of them then reads few values that were not asked for. Where such chunks would hold much padding
    (seven axes of 13 values: three times the array), lengths that fit the axes better are searched:
    those with the least sum of penalties for padding, for uneven lengths and for small chunks.
    """
    alike = _cut_alike(shape, most)
    if math.prod(map(_padding, shape, alike)) <= MAX_PADDING:
        return alike
    # The best lengths so far, for each size that a chunk can have, in steps of a quarter octave.
    best: dict[int, tuple[float, int, tuple[int, ...]]] = {0: (0.0, 1, ())}
    for size, fair in zip(shape, alike, strict=True):
        near = {1, fair, *range(max(1, fair // 4), min(size, 4 * fair, MAX_TRIED) + 1)}
        lengths = sorted({-(-size // -(-size // length)) for length in near})
        longer: dict[int, tuple[float, int, tuple[int, ...]]] = {}
        for cost, cells, before in best.values():
            for length in lengths:
                if cells * length > most:
                    break
                # Both matter: bytes that hold nothing, and axes along which slices are dear.
                uneven = math.log(length / fair) ** 2
                more = cost + 3 * math.log(_padding(size, length)) + 0.1 * uneven
                key = round(4 * math.log2(cells * length))
                if key not in longer or more < longer[key][0]:
                    longer[key] = (more, cells * length, (*before, length))
        best = longer
    return min(best.values(), key=lambda one: one[0] + 0.5 * math.log(most / one[1]))[2]


def _cut_alike(shape: tuple[int, ...], most: int) -> tuple[int, ...]:
    """Return chunk lengths as nearly equal as the axes allow, with a product of at most `most`.

    `shape` is the number of values along each axis of the array.
    """
    lengths = [1] * len(shape)
    budget = most
    # Short axes first: what they leave over goes to the long ones.
    for done, position in enumerate(sorted(range(len(shape)), key=lambda p: shape[p])):
        fair = max(1, int(budget ** (1 / (len(shape) - done)) + 1e-9))
        pieces = -(-shape[position] // fair)
        lengths[position] = -(-shape[position] // pieces)
        budget //= lengths[position]
    return tuple(lengths)


def _padding(size: int, length: int) -> float:
    """Return the ratio of stored to real values if an axis is cut into pieces of a length.

    `size` is the length of the axis; it is 1 if `length` divides it.
    """
    return -(-size // length) * length / size


def _tile_shape(shape: tuple[int, ...], chunk: tuple[int, ...], most: int) -> tuple[int, ...]:
    """Return the tile shape of an array, a whole number of chunks along each axis.

    A tile is the block of cells that is computed and written at a time. It has at most `most`
    values, or one chunk; last axes are taken whole where possible, and tiles are nearly equal.
    `shape` and `chunk` are the lengths of the array and of a chunk along each axis.
    """
    budget = max(1, most // math.prod(chunk))
    tile: list[int] = []
    for size, length in zip(reversed(shape), reversed(chunk), strict=True):
        chunks = -(-size // length)
        pieces = -(-chunks // min(chunks, budget))
        each = -(-chunks // pieces)
        tile.insert(0, each * length)
        budget //= each
    return tuple(tile)
