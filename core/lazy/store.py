"""A result of any size into a file: its blocks are computed and written side by side.

A Zarr group takes blocks in any order and from anywhere, so that a run that was stopped goes on and
the workers of a cluster write it together. A NetCDF file is written in one go, by one thread.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from dask.base import compute
from dask.delayed import delayed
from numpy.typing import NDArray

from vibrafeed.core.code_version import code_version
from vibrafeed.core.dataset.files import partial, settle, whole
from vibrafeed.core.dataset.group import create_arrays, put
from vibrafeed.core.dataset.netcdf import created
from vibrafeed.core.dataset.stores import (
    GROUP,
    UNFINISHED,
    document_of,
    keys_in,
    open_group,
    plain_errors,
    put_document,
    remove_all,
)
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.lazy.dataset import (
    Field,
    block_cells,
    box_of,
    chunks_of,
    compute_block,
    fields_of,
    watched,
)
from vibrafeed.core.plan.labels import coordinates_of
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.system import cores, sync
from vibrafeed.core.watch import Watch

STORED_CELLS = 1 << 20
"""Cells of a block that is stored, and of a chunk of its file: 8 MiB a variable."""
AT_ONCE = 1024
"""Blocks that dask is told of at once: each takes it 15 KB."""
Region = tuple[slice, ...]


@dataclass(frozen=True)
class Block:
    """A box of cells of a field.

    Attributes
    ----------
    field : Field
        The field.
    box : mapping of str to (int, int)
        Start and stop on each of its axes.
    at : mapping of str to int
        Number of the block on each axis.
    """

    field: Field
    box: Mapping[str, tuple[int, int]]
    at: Mapping[str, int]


class Blocks:
    """The blocks in which a study is stored; equal studies have equal blocks."""

    def __init__(self, prepared: Prepared):
        self.prepared, self._fields = prepared, []
        for field in fields_of(prepared):
            chunks = chunks_of(prepared, field, block_cells(prepared, field, STORED_CELLS))
            self._fields.append((field, chunks, [len(lengths) for lengths in chunks.values()]))
        self._starts = [
            0,
            *itertools.accumulate(math.prod(block_counts) for _, _, block_counts in self._fields),
        ]

    def __len__(self) -> int:
        return self._starts[-1]

    def __getitem__(self, index: int) -> Block:
        field_number = next(number for number, stop in enumerate(self._starts[1:]) if index < stop)
        field, chunks, counts = self._fields[field_number]
        position = np.unravel_index(index - self._starts[field_number], counts) if counts else ()
        numbers = [int(number) for number in position]
        return Block(field, box_of(chunks, numbers), dict(zip(field.dims, numbers, strict=True)))

    def compute(self, index: int, watch: Watch) -> dict[str, NDArray[Any]]:
        """Return the variables of a block; raise `StoppedError` if `watch` stops it."""
        block = self[index]
        return compute_block(self.prepared, block.field, block.box, watch)

    def regions(self, block: Block) -> dict[str, Region]:
        """Return the regions of the arrays that the variables of a block fill.

        A variable without an axis of the field is in the first of its blocks along that axis.
        """
        dims = self.prepared.dims
        return {
            name: tuple(slice(*block.box[dim]) for dim in dims[name])
            for name in block.field.names
            if not any(block.at[dim] for dim in block.at if dim not in dims[name])
        }

    def chunk(self, name: str) -> tuple[int, ...]:
        """Return the lengths of the blocks of a variable."""
        chunks = next(chunks for field, chunks, _ in self._fields if name in field.names)
        return tuple(chunks[dim][0] for dim in self.prepared.dims[name])


def _in_batches(
    function: Callable[[int, Watch], Any], numbers: Sequence[int], at_once: int, watch: Watch
) -> Iterator[tuple[int, Any]]:
    for start in range(0, len(numbers), at_once):
        batch = numbers[start : start + at_once]
        with watched(watch.part(len(batch) / len(numbers))):
            task = delayed(function, pure=False)
            (results,) = compute([task(index, Watch(threads=1)) for index in batch])
        yield from zip(batch, results, strict=True)


# --- NetCDF


def store_netcdf(
    prepared: Prepared,
    outline: Table,
    path: Path,
    watch: Watch,
    *,
    history: str | None = None,
    compression: bool = True,
) -> None:
    """Compute a study and write it as NetCDF, which appears when it is complete.

    Equal studies give equal bytes without a history. Memory is that of a few blocks.

    Raises
    ------
    StoppedError
        If `watch` stops it; then nothing is left.
    OSError
        If it cannot be written.
    """
    blocks = Blocks(prepared)
    chunks = {name: blocks.chunk(name) for name in outline.variables}
    table, at_once = whole_table(prepared, outline), 4 * (watch.threads or cores())
    if history is not None:
        table = table.with_history(history)
    with (
        whole(path) as temporary,
        created(temporary, table, compression=compression, chunks=chunks) as file,
    ):
        for index, arrays in _in_batches(blocks.compute, range(len(blocks)), at_once, watch):
            for name, region in blocks.regions(blocks[index]).items():
                file[name][region] = arrays[name]


def whole_table(prepared: Prepared, outline: Table) -> Table:
    """Return the table of a study without the values of its arrays, which take no memory."""
    shape = prepared.grid.shape
    variables = {
        name: replace(
            variable,
            values=np.broadcast_to(
                variable.values.reshape(-1)[:1].reshape([1] * len(variable.dims)),
                [shape[dim] for dim in variable.dims],
            ),
        )
        for name, variable in outline.variables.items()
    }
    return Table(coordinates_of(prepared.plan, prepared.grid), variables, outline.attributes)


# --- Zarr


@dataclass(frozen=True)
class ZarrStore:
    """The Zarr group of a study under way: any process may write any of its blocks.

    Attributes
    ----------
    prepared : Prepared
        The study.
    where : str
        A folder, or the URL of an object store such as ``s3://bucket/key``, whose keys and address
        come from the environment.
    """

    prepared: Prepared
    where: str

    @property
    def under_way(self) -> str:
        """The folder or URL while blocks are missing."""
        return self.where if "://" in self.where else str(partial(Path(self.where)))

    @property
    def identity(self) -> dict[str, str]:
        """The text by which a run knows its own group."""
        return {"study": self.prepared.study.key(), "version": code_version()}

    @cached_property
    def blocks(self) -> Blocks:
        """The blocks of the study."""
        return Blocks(self.prepared)

    def begin(self, outline: Table, *, resume: bool = False) -> None:
        """Create the group; with `resume` keep one that a run of the same study has begun.

        Raises
        ------
        FileExistsError
            If something else is there.
        OSError
            If it cannot be written.
        """
        if "://" not in self.where and Path(self.where).exists():
            raise FileExistsError(f"{self.where} exists already")
        with plain_errors():
            keys = keys_in(self.under_way)
            if GROUP in keys:
                unfinished_study = open_group(self.under_way).attrs.get(UNFINISHED)
                # Only a folder shows by its name that it is ours.
                if unfinished_study is None and "://" in self.where:
                    raise FileExistsError(f"{self.where} exists already")
                if resume and unfinished_study == self.identity:
                    return
            elif keys:
                raise FileExistsError(f"{self.where} holds other files")
            remove_all(self.under_way)
            self._create(outline)

    def _create(self, outline: Table) -> None:
        group = open_group(self.under_way, create=True)
        chunks = {name: self.blocks.chunk(name) for name in outline.variables}
        create_arrays(group, outline, sizes=self.prepared.grid.shape, chunks=chunks)
        for name, coordinate in coordinates_of(self.prepared.plan, self.prepared.grid).items():
            put(group, name, ..., coordinate.values)
        group.attrs[UNFINISHED] = self.identity
        names = (*outline.coordinates, *outline.variables)
        put_document(self.under_way, document_of(group, names))

    def missing(self) -> list[int]:
        """Return the numbers of the blocks that are not stored."""
        stored_keys = keys_in(self.under_way)
        return [
            number
            for number in range(len(self.blocks))
            if not self._keys(self.blocks[number]) <= stored_keys
        ]

    def _keys(self, block: Block) -> set[str]:
        dims = self.prepared.dims
        return {
            "/".join([name, "c", *(str(block.at[dim]) for dim in dims[name])])
            for name in self.blocks.regions(block)
        }

    def write(self, index: int, watch: Watch) -> None:
        """Compute a block and store it.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        block, arrays = self.blocks[index], self.blocks.compute(index, watch)
        stored = _opened(self.under_way, self.prepared.study.key())
        with plain_errors():
            for name, region in self.blocks.regions(block).items():
                put(stored, name, region, arrays[name])
        if "://" not in self.where:
            for key in self._keys(block):
                sync(Path(self.under_way) / key)

    def store(self, watch: Watch) -> None:
        """Compute and store all blocks that are missing, on the threads of dask or its cluster.

        Raises
        ------
        StoppedError
            If `watch` stops it; the blocks that were written by then stay.
        """
        missing, count = self.missing(), len(self.blocks)
        watch.advance(1 - len(missing) / count)
        for _ in _in_batches(self.write, missing, AT_ONCE, watch.part(len(missing) / count)):
            pass

    def finish(self, further: Mapping[str, Any] = MappingProxyType({})) -> None:
        """Remove the mark of an unfinished group, add attributes, and move a group of files.

        The attributes `further` are, for example, the cost. A group in an object store is written
        in its place, and is complete without the mark.
        """
        with plain_errors():
            group = open_group(self.under_way)
            attributes = dict(group.attrs)
            attributes.pop(UNFINISHED, None)
            group.attrs.put({**attributes, **further})
            consolidated = group.metadata.consolidated_metadata
            names = () if consolidated is None else consolidated.metadata
            # Again, with the arrays in a fixed order: that of zarr differs from run to run.
            put_document(self.under_way, document_of(group, names))
        if "://" not in self.where:
            for temporary in Path(self.under_way).rglob("*.partial"):  # of writers that were killed
                temporary.unlink(missing_ok=True)
            settle(Path(self.under_way), Path(self.where))


@lru_cache(maxsize=4)
def _opened(where: str, study: str) -> Mapping[str, Any]:  # another study has other arrays
    return dict(open_group(where).arrays())
