"""The bytes of a shard, after the codec `sharding_indexed` of Zarr v3, as zarr-python makes them.

A shard is its chunks one after another, then an index, then the index's CRC-32C. The index has two
64-bit numbers for each chunk of the shard: where it begins, and its length; both are 2^64 - 1 for a
chunk beyond the end of the array.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import google_crc32c
import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.layout import Layout, Tile

NO_CHUNK = np.iinfo(np.uint64).max


def pack(document: Mapping[str, Any], tile: Tile, values: NDArray[Any], key: str) -> bytes:
    """Return the bytes of the Zarr v3 shard (one file of compressed chunks) for a tile of an array.

    A tile is the block of cells that is computed and stored at a time. Equal values give equal
    bytes.

    Parameters
    ----------
    document : mapping
        The array's metadata, the content of its `zarr.json`.
    tile : Tile
        The tile, with its start and stop on each axis.
    values : ndarray
        The values in the tile, in its shape.
    key : str
        Key of the shard within the array, such as `c/0/1`.
    """
    import zarr
    from zarr.buffer.cpu import Buffer

    held: dict[str, Any] = {"zarr.json": Buffer.from_bytes(json.dumps(document).encode())}
    array = zarr.open_array(zarr.storage.MemoryStore(held), mode="r+", zarr_format=3)
    # A shard of fill values alone is there, too: what is missing is not written yet.
    array = array.with_config({"write_empty_chunks": True})
    array[tuple(slice(*ends) for ends in tile.box)] = values
    return bytes(held[key].to_bytes())


def index_length(layout: Layout) -> int:
    """Return the size of the index at the end of a shard [bytes]."""
    chunks = math.prod(t // c for t, c in zip(layout.tile, layout.chunk, strict=True))
    return 16 * chunks + 4


def is_whole(index: bytes, size: int) -> bool:
    """True if a stored Zarr shard is complete: its index is intact, and its chunks fill the rest.

    `index` are the last bytes of the shard: position and length of each chunk, and a CRC-32C.
    `size` is the number of all its bytes. A run that goes on with a stopped one computes the other
    shards again.
    """
    if int(google_crc32c.value(index[:-4])).to_bytes(4, "little") != index[-4:]:
        return False
    places = np.frombuffer(index[:-4], "<u8").reshape(-1, 2)
    lengths = places[places[:, 0] != NO_CHUNK, 1]
    return int(lengths.sum()) == size - len(index)
