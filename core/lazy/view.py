"""A sweep as a Zarr group that is computed when it is read: no chunk exists before.

Every size that is allocated here is that of a chunk, whatever the size of the sweep.
"""

import json
import math
import operator
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import zarr
from zarr.storage import MemoryStore

from vibrafeed.core.dataset.group import create_arrays
from vibrafeed.core.dataset.stores import GROUP, document_of
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.prepared import Prepared

CHUNK_CELLS = 65_536
"""Most values of a chunk, 512 KiB of floats: worth a request, and soon sent."""
_CHUNK = re.compile(r"c((?:/(?:0|[1-9][0-9]{0,17}))*)")


class ZarrView:
    """A read-only Zarr v3 group of a sweep: keys in, bytes out.

    The keys are ``zarr.json``, ``{array}/zarr.json`` and ``{array}/c/i/j/...``; the arrays are the
    coordinates, the outputs and the verdicts. Values are those of a run in memory. Threads may read
    at the same time.

    Parameters
    ----------
    sweep : Prepared
        The sweep, of any size.
    outline : Table
        The result of its first cell.
    chunk_cells : int
        Largest number of values of a chunk.
    """

    def __init__(self, sweep: Prepared, outline: Table, *, chunk_cells: int = CHUNK_CELLS):
        # A group in memory gives the documents; chunks are computed when they are asked for.
        self._sweep, self._outline = sweep, outline
        sizes = sweep.grid.shape
        shapes = {
            name: even_shape(variable.dims, sizes, chunk_cells)
            for name, variable in {**outline.coordinates, **outline.variables}.items()
        }
        group = zarr.open_group(MemoryStore(), mode="w", zarr_format=3)
        create_arrays(group, outline, sizes=sizes, chunks=shapes, compressed=False)
        names = (*outline.coordinates, *outline.variables)
        document = document_of(group, names)
        arrays = json.loads(document)["consolidated_metadata"]["metadata"]
        self._documents = {GROUP: document} | {
            f"{name}/{GROUP}": json.dumps(variable).encode() for name, variable in arrays.items()
        }
        self._arrays: dict[str, Any] = {name: group[name] for name in names}

    def read(self, key: str) -> bytes:
        """Return the bytes of a key; raise `KeyError` if the group does not have it."""
        if key in self._documents:
            return self._documents[key]
        return self._chunk(*self._find(key))

    def length(self, key: str) -> int:
        """Return the number of bytes of a key without computing them; raise `KeyError` likewise."""
        if key in self._documents:
            return len(self._documents[key])
        array = self._arrays[self._find(key)[0]]
        return math.prod(array.chunks) * array.dtype.itemsize

    def _find(self, key: str) -> tuple[str, tuple[int, ...]]:
        # The array and the index of the chunk that a key names.
        name, _, chunk_key = key.partition("/")
        match = _CHUNK.fullmatch(chunk_key)
        if name in self._arrays and match is not None:
            index = tuple(map(int, match[1].split("/")[1:]))
            counts = self._arrays[name].cdata_shape
            if len(index) == len(counts) and all(map(operator.lt, index, counts)):
                return name, index
        raise KeyError(key)

    def _chunk(self, name: str, index: tuple[int, ...]) -> bytes:
        array, grid = self._arrays[name], self._sweep.grid
        ends = [
            (number * length, min((number + 1) * length, size))
            for number, length, size in zip(index, array.chunks, array.shape, strict=True)
        ]
        if name in grid.axes:
            values: Any = grid.axes[name].array(*ends[0])
        elif name in grid.paired:
            values = grid.paired[name].array(*ends[0])
        elif name in self._outline.coordinates:
            values = self._outline.coordinates[name].values
        else:
            plan, dims = self._sweep.plan.part((name,)), self._outline.variables[name].dims
            piece = grid.piece(dict(zip(dims, ends, strict=True)), plan.parameters)
            values = self._sweep.in_files(name, evaluate(plan, piece)[name])
        chunk = np.full(array.chunks, array.fill_value, array.dtype.newbyteorder("<"))
        chunk[tuple(slice(stop - start) for start, stop in ends)] = values
        return chunk.tobytes()


def even_shape(dims: Sequence[str], sizes: Mapping[str, int], max_cells: int) -> tuple[int, ...]:
    """Return the chunk lengths of an array: all axes are cut alike."""
    lengths, cells_left = dict[str, int](), max_cells
    # Short axes first: the room that they leave goes to the long ones.
    for position, dim in enumerate(sorted(dims, key=lambda dim: sizes[dim])):
        equal_length = max(1, int(cells_left ** (1 / (len(dims) - position)) + 1e-9))
        lengths[dim] = -(-sizes[dim] // -(-sizes[dim] // equal_length))
        cells_left //= lengths[dim]
    return tuple(lengths[dim] for dim in dims)
