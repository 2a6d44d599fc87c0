"""The bytes of a shard, after the codec `sharding_indexed` of Zarr v3.

A shard is its chunks one after another, then an index, then the index's CRC-32C. A chunk is what
blosc makes of its little-endian values, then the CRC-32C of that. The index has two 64-bit numbers
for each chunk of the shard, in the order of the array: where it begins, and its length; both are
2^64 - 1 for a chunk beyond the end of the array.

The zarr library writes the same, at a third of the speed: it puts values and chunks together on one
thread, and copies what a shard holds so far for each chunk that is added.
"""

from __future__ import annotations

import math
from concurrent.futures import Executor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.dataset.chunks import chunk_of, inside
from core.dataset.layout import Box, Layout, Tile
from core.dataset.zarr_metadata import BLOSC_LEVEL, BLOSC_NAME, is_shuffled

NO_CHUNK = np.iinfo(np.uint64).max


def pack(tile: Tile, values: NDArray[Any], pool: Executor) -> bytes:
    """Return the shard of one array of a tile; `pool` packs the chunks."""
    layout = tile.field.layout
    boxes = list(layout.chunks(tile.box))
    index = np.full((*_counts(layout), 2), NO_CHUNK, dtype="<u8")
    parts, end = [], 0
    packed = pool.map(lambda box: _packed(values, inside(box, tile.box), layout.chunk), boxes)
    for box, data in zip(boxes, packed, strict=True):
        at = (b // c for (b, _), c in zip(inside(box, tile.box), layout.chunk, strict=True))
        index[tuple(at)] = end, len(data)
        parts.append(data)
        end += len(data)
    return b"".join([*parts, _with_checksum(index.tobytes())])


def index_length(layout: Layout) -> int:
    """Return the bytes at the end of a shard that tell where its chunks are."""
    return 16 * math.prod(_counts(layout)) + 4


def is_whole(index: bytes, size: int) -> bool:
    """Return whether the index of a shard is sound, and tells of all its bytes."""
    if _with_checksum(index[:-4]) != index:
        return False
    places = np.frombuffer(index[:-4], "<u8").reshape(-1, 2)
    lengths = places[places[:, 0] != NO_CHUNK, 1]
    return int(lengths.sum()) == size - len(index)


def _counts(layout: Layout) -> tuple[int, ...]:
    """Return the number of chunks of a shard along each dimension."""
    return tuple(t // c for t, c in zip(layout.tile, layout.chunk, strict=True))


def _packed(values: NDArray[Any], box: Box, shape: tuple[int, ...]) -> bytes:
    from numcodecs import blosc

    chunk = chunk_of(values, box, np.empty(shape, values.dtype.newbyteorder("<")))
    # On a thread that is not the first one, blosc itself uses no threads: what it makes of a chunk
    # would depend on which of them is done first.
    shuffle = blosc.SHUFFLE if is_shuffled(chunk.itemsize) else blosc.NOSHUFFLE
    return _with_checksum(
        blosc.compress(chunk.reshape(-1), BLOSC_NAME.encode(), BLOSC_LEVEL, shuffle)
    )


def _with_checksum(data: bytes) -> bytes:
    from google_crc32c import value as crc32c

    return bytes(data) + int(crc32c(data)).to_bytes(4, "little")
