"""The size of the file of a sweep, estimated before it is made."""

from __future__ import annotations

import random

import numpy as np

from core.dataset.chunks import DEFLATED, encoder
from core.dataset.layout import Tile
from core.plan.prepared import Prepared
from core.plan.tiles import Tiled

CHUNKS = 12  # chunks that are packed for the estimate


def bytes_in_file(sweep: Prepared, *, compressed: bool) -> int:
    """Return the bytes of a sweep in a file; an estimate if compressed.

    The estimate packs a few random chunks, which are the same for equal studies.
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
