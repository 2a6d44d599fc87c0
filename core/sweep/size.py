"""The size of the file of a sweep, estimated before it is made."""

from __future__ import annotations

import random

import numpy as np

from vibrafeed.core.dataset.chunks import DEFLATED, encoder
from vibrafeed.core.dataset.layout import Tile
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.tiles import Tiled

CHUNKS = 12  # chunks that are packed for the estimate


def bytes_in_file(sweep: Prepared, *, compressed: bool) -> int:
    """Return the bytes that the result of a sweep will take in a file, before it is computed.

    Without compression the number is exact. With it, a few random chunks are computed and packed,
    and their ratio is taken for all; the chunks are the same for equal studies. `sweep` is a
    checked study with its grid. `compressed` is true for a file whose arrays are packed.
    """
    tiled = Tiled(sweep)
    if not compressed or not len(tiled.tiles):
        return tiled.bytes
    chance, encode = random.Random(sweep.study.key()), encoder(DEFLATED)
    largest = max(tiled.tiles.fields, key=lambda field: field.layout.stored)
    plain = packed = 0
    for _ in range(CHUNKS):
        box = largest.layout.box(chance.randrange(largest.layout.tiles))
        chunk = Tile(largest, chance.choice(list(largest.layout.chunks(box))))
        inside = tuple((0, stop - start) for start, stop in chunk.box)
        for values in tiled.values(chunk).values():
            plain += values.nbytes
            packed += len(encode(values, inside, np.empty_like(values)))
    return int(tiled.bytes * packed / plain)
