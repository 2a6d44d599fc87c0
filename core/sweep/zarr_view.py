"""A sweep as a Zarr v3 group that is evaluated on read: no chunk exists before it is asked for.

Every size that is allocated here is that of a chunk, whatever the size of the sweep.
"""

from __future__ import annotations

import json
import math
import operator
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.layout import CHUNK_CELLS
from vibrafeed.core.dataset.zarr_metadata import FILL, array_document, group_document
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.pieces import carry_out
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.sweep.cells import compute, label
from vibrafeed.core.sweep.chunk_wishes import Wishes, read_wishes, wished_shape

_CHUNK = re.compile(r"c((?:/(?:0|[1-9][0-9]{0,17}))*)")


@dataclass(frozen=True)
class _Array:
    """The shape of an array and of its chunks; `plan` is what an output pulls."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    chunk_shape: tuple[int, ...]
    dtype: np.dtype[Any]
    plan: Plan | None

    @property
    def chunks(self) -> tuple[int, ...]:
        """The number of chunks along each dimension."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk_shape, strict=True))

    @property
    def chunk_bytes(self) -> int:
        """The bytes of a chunk."""
        return math.prod(self.chunk_shape) * self.dtype.itemsize


class ZarrView:
    """A read-only Zarr v3 group of a sweep: keys in, bytes out.

    The keys are ``zarr.json``, ``{array}/zarr.json`` and ``{array}/c/i/j/...``; the arrays are the
    coordinates, the outputs and the verdicts. Values are to the bit those that `tabulate` gives.
    Threads may read at the same time.

    Parameters
    ----------
    sweep : Prepared
        The sweep, of any size.
    chunk_cells : int
        Largest number of values of a chunk.
    chunks : str
        Lengths of chunks that a reader wishes, such as ``frequency:all``; all axes are cut alike if
        left out. Coordinates have chunks of their own.

    Raises
    ------
    StudyError
        If the wishes cannot be met.
    """

    def __init__(self, sweep: Prepared, *, chunk_cells: int = CHUNK_CELLS, chunks: str = ""):
        """Lay out the arrays of a sweep in chunks, as wished."""
        self._grid, self._in_files = sweep.grid, sweep.in_files
        # Dimensions and attributes do not depend on how many values an axis has; what is computed
        # when it is read cannot have been verified.
        first = dict.fromkeys(sweep.grid.axes, (0, 1))
        self._labels = carry_out(sweep.within(first).unverified(), compute, label)
        wishes = read_wishes(chunks, sweep.grid.shape, chunk_cells) if chunks else {}
        self._arrays = self._lay_out(sweep, chunk_cells, wishes)

    def read(self, key: str) -> bytes:
        """Return the bytes of a key of the Zarr group; raise `KeyError` if there is no such key.

        A chunk is computed when it is asked for.
        """
        name, index = self._find(key)
        if index is None:
            return self._documents[name]
        return self._chunk(name, index)

    def length(self, key: str) -> int:
        """Return the number of bytes of a key without computing them.

        Raises `KeyError` if the group does not have the key.
        """
        name, index = self._find(key)
        return len(self._documents[name]) if index is None else self._arrays[name].chunk_bytes

    def chunks(self) -> dict[str, tuple[int, ...]]:
        """Return the number of chunks along each dimension of every array."""
        return {name: array.chunks for name, array in self._arrays.items()}

    def _lay_out(self, sweep: Prepared, chunk_cells: int, wishes: Wishes) -> dict[str, _Array]:
        """Return shape, chunks, type and plan of every array of a Zarr group that shows a sweep.

        A chunk is the piece of an array that is computed when it is read. It has at most
        `chunk_cells` values; `wishes` are lengths of chunks along some axes that the user asks for.
        """
        arrays = {}
        labels = self._labels
        for name, variable in (*labels.coordinates.items(), *labels.variables.items()):
            shape = tuple(self._grid.shape[dim] for dim in variable.dims)
            plan = None
            if name in labels.variables:
                plan = sweep.plan.part((name,))
            arrays[name] = _Array(
                variable.dims,
                shape,
                wished_shape(
                    variable.dims, shape, wishes if name in labels.variables else {}, chunk_cells
                ),
                variable.values.dtype,
                plan,
            )
        return arrays

    @cached_property
    def _documents(self) -> dict[str, bytes]:
        """The metadata documents, JSON as bytes, of the Zarr group (key ``""``) and its arrays."""
        documents = {
            name: array_document(self._labels, name, array.shape, array.chunk_shape)
            for name, array in self._arrays.items()
        }
        documents[""] = group_document(self._labels, dict(documents))
        return {
            name: json.dumps(document, allow_nan=False).encode()
            for name, document in documents.items()
        }

    def _find(self, key: str) -> tuple[str, tuple[int, ...] | None]:
        """Return the name of the array and the position of the chunk that a key of the group means.

        Keys are ``zarr.json``, ``<array>/zarr.json`` and ``<array>/c/0/1``. The position is None
        for a metadata document, the name empty for that of the group. Raises `KeyError` for other
        keys.
        """
        if key == "zarr.json":
            return "", None
        name, _, rest = key.partition("/")
        array = self._arrays.get(name)
        if array is not None and rest == "zarr.json":
            return name, None
        found = _CHUNK.fullmatch(rest)
        if array is not None and found is not None:
            index = tuple(map(int, found[1].split("/")[1:]))
            if len(index) == len(array.chunks) and all(map(operator.lt, index, array.chunks)):
                return name, index
        raise KeyError(key)

    def _chunk(self, name: str, index: tuple[int, ...]) -> bytes:
        """Compute a chunk of an array; return its bytes, filled up at the end of an axis.

        A chunk is the piece of an array that is read at once. `name` is an output, a verdict or a
        coordinate, `index` the position of the chunk on each axis.
        """
        array = self._arrays[name]
        box = {
            dim: (i * c, min((i + 1) * c, n))
            for dim, i, c, n in zip(array.dims, index, array.chunk_shape, array.shape, strict=True)
        }
        # Chunks at the end of an axis are as large as the others: the format asks for it.
        filled = np.full(
            array.chunk_shape, FILL[array.dtype.name][0], array.dtype.newbyteorder("<")
        )
        filled[tuple(slice(stop - start) for start, stop in box.values())] = self._values(name, box)
        return filled.tobytes()

    def _values(self, name: str, box: Mapping[str, tuple[int, int]]) -> NDArray[Any]:
        """Return the values of an array of a Zarr group in a box of cells, in the units of files.

        The values are computed for each request, not stored: `name` is an output, a verdict or a
        coordinate. `box` has start and stop on each axis of the array.
        """
        axes, plan = self._grid.axes, self._arrays[name].plan
        if plan is None:
            if name in axes:
                return axes[name].array(*box[name])
            return self._labels.coordinates[name].values
        return self._in_files(name, evaluate(plan, self._grid.piece(box, plan.parameters))[name])
