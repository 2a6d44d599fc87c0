"""The dataset of a study whose variables are dask arrays over their own axes.

A block is a box of cells; one call computes every variable in it. Everything that is too large for
memory goes through here: reductions, files, slices of a service, clusters.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import dask
import dask.array
import numpy as np
import xarray
from dask.callbacks import Callback
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plan.evaluate import empty_results, evaluate, evaluate_at_once
from vibrafeed.core.plan.labels import coordinates_of
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.program import even_length
from vibrafeed.core.system import cores
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from dask.array import Array

BLOCK_CELLS = 3 << 20
"""Most cells of a block of closed forms: some milliseconds, and 24 MiB a variable.

The C library gives arrays above 32 MiB back to the system each time, and a new one takes longer
than the closed forms in it."""
COUNTED = "counted "
"""Begins the name of an output that is NaN where its regime describes no real part."""
STOPPED = "it was stopped before all cells were evaluated, so there is no result"
BLOCK_SECONDS = 1.0
"""Time on one core that a block of simulated motion should take."""
SCHEDULER: ContextVar[Any] = ContextVar("SCHEDULER", default="threads")
"""Dask's scheduler: threads, or the client of a cluster that somebody has named.

Not dask's own default: that is the client made last in the process, such as that of a service."""


@dataclass(frozen=True)
class Field:
    """Variables that one call computes in a block.

    Attributes
    ----------
    names : tuple of str
        The variables.
    dims : tuple of str
        The axes of all of them together, in the order of the grid.
    plan : Plan
        The equations that they need.
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    plan: Plan

    @property
    def takes_long(self) -> bool:
        """True if an equation simulates motion."""
        return any(equation.takes_long for equation in self.plan.equations)


def dataset(
    prepared: Prepared,
    outline: Table,
    *,
    whole: Collection[str] = (),
    cells: int | None = None,
) -> xarray.Dataset:
    """Return the dataset of a study of any size; nothing of it is computed yet.

    Parameters
    ----------
    prepared : Prepared
        A study whose cells are computed one by one.
    outline : Table
        The result of one cell of it: the attributes of the variables and of the whole.
    whole, cells : optional
        As for `arrays_of`.
    """
    arrays = arrays_of(prepared, whole=whole, cells=cells)
    variables = {
        name: xarray.Variable(prepared.dims[name], arrays[name], dict(variable.attributes))
        for name, variable in outline.variables.items()
    }
    coordinates = {
        name: xarray.Variable(coordinate.dims, coordinate.values, dict(coordinate.attributes))
        for name, coordinate in coordinates_of(prepared.plan, prepared.grid).items()
    }
    return xarray.Dataset(variables, coordinates, dict(outline.attributes))


def arrays_of(
    prepared: Prepared, *, whole: Collection[str] = (), cells: int | None = None
) -> "dict[str, Array]":
    """Return the variables of a study as dask arrays in the units of files, by name.

    Parameters
    ----------
    prepared : Prepared
        The study, whose variables are over their `Prepared.dims`.
    whole : collection of str, optional
        Axes along which a block is to hold all cells, as far as it has room.
    cells : int, optional
        Most cells of a block; by default `BLOCK_CELLS`, or `BLOCK_SECONDS` of motion.
    """
    arrays: dict[str, Array] = {}
    for field in fields_of(prepared):
        chunks = chunks_of(prepared, field, cells or block_cells(prepared, field), whole)
        arrays |= _arrays(prepared, field, chunks)
    return arrays


def fields_of(prepared: Prepared) -> list[Field]:
    """Return the fields of a study: variables of motion together, closed forms by their axes.

    A motion is followed once for all that is told of it; a closed form costs little, and is not
    computed along axes that neither it nor the verdict on it has.
    """
    plan, dims, groups = prepared.plan, prepared.dims, dict[tuple[str, ...], list[str]]()
    for name in (*plan.outputs, *plan.verdict_names):
        judges = {judge.name} if (judge := plan.verdict_on(name)) else set()
        is_slow = any(equation.takes_long for equation in plan.part((name,)).equations)
        axes_of_name = prepared.grid.dims(
            {*dims[name], *(dim for judge_name in judges for dim in dims[judge_name])}
        )
        groups.setdefault(("motion",) if is_slow else axes_of_name, []).append(name)
    fields = []
    for group in groups.values():
        judges = {judge.name for name in group if (judge := plan.verdict_on(name))}
        plan_of_group = plan.part([*group, *sorted(judges - {*group})])
        axes = {dim for name in (*group, *judges) for dim in dims[name]}
        fields.append(Field(tuple(group), prepared.grid.dims(axes), plan_of_group))
    return fields


def block_cells(prepared: Prepared, field: Field, most: int = BLOCK_CELLS) -> int:
    """Return the number of cells of a block of a field; equal studies have equal blocks."""
    if not field.takes_long:
        return most
    # A price that is measured would give other blocks, and last digits of means, in each run.
    return max(1, min(most, int(BLOCK_SECONDS / prepared.stated_seconds_a_cell)))


def chunks_of(
    prepared: Prepared, field: Field, cells: int, whole: Iterable[str] = ()
) -> dict[str, tuple[int, ...]]:
    """Return the lengths of the blocks along each axis of a field, equal but for the last.

    The axes of `whole` come first, then the last axis before the one before it, each with as many
    of its cells as a block has room for.
    """
    shape, cells_left, chunks = prepared.grid.shape, cells, dict[str, tuple[int, ...]]()
    for dim in (
        *(name for name in reversed(field.dims) if name in set(whole)),
        *reversed(field.dims),
    ):
        if dim not in chunks:
            step = even_length(shape[dim], cells_left)
            chunks[dim] = tuple(
                min(step, shape[dim] - start) for start in range(0, shape[dim], step)
            )
            cells_left //= step
    return {dim: chunks[dim] for dim in field.dims}


def box_of(
    chunks: Mapping[str, Sequence[int]], numbers: Iterable[int]
) -> dict[str, tuple[int, int]]:
    """Return start and stop on each axis of the block with some numbers on them."""
    return {
        dim: (number * lengths[0], number * lengths[0] + lengths[number])
        for (dim, lengths), number in zip(chunks.items(), numbers, strict=True)
    }


def compute_block(
    prepared: Prepared, field: Field, box: Mapping[str, tuple[int, int]], watch: Watch
) -> dict[str, NDArray[Any]]:
    """Return the variables of a field, and verdicts on them, in a box of cells, in units of files.

    `box` has start and stop on each axis of the field.

    Raises
    ------
    StoppedError
        If `watch` stops motions before all are followed.
    """
    grid = prepared.grid.piece(box, field.plan.parameters)
    if field.takes_long:
        arrays = empty_results(field.plan, grid)
        evaluate_at_once(field.plan, grid, arrays, watch)
        if watch.stopped():
            raise StoppedError(STOPPED)
    else:
        arrays = evaluate(field.plan, grid, threads=watch.threads)
    return {
        name: prepared.in_files(name.removeprefix(COUNTED), values)
        for name, values in arrays.items()
    }


def _arrays(
    prepared: Prepared,
    field: Field,
    chunks: Mapping[str, tuple[int, ...]],
) -> "dict[str, Array]":
    def block(block_id: tuple[int, ...] = ()) -> NDArray[Any]:
        # One object for each block, since its variables have different axes.
        holder = np.empty([1] * len(block_id), dtype=object)
        box = box_of(chunks, block_id)
        holder[(0,) * len(block_id)] = compute_block(prepared, field, box, Watch(threads=1))
        return holder

    counts = [len(chunks[dim]) for dim in field.dims]
    key = f"{prepared.study.key()[:16]}-{'-'.join(map(str, counts))}"
    blocks = dask.array.map_blocks(
        block,
        chunks=tuple((1,) * count for count in counts),
        dtype=object,
        meta=np.empty((0,) * len(counts), dtype=object),
        name=f"block-{field.names[0]}-{key}",
    )
    arrays = {}
    for name in field.names:
        dims = prepared.dims[name]
        blocks_of_variable = blocks[tuple(slice(None) if dim in dims else 0 for dim in field.dims)]
        dtype = np.dtype(np.int8 if prepared.width(name) == 1 else np.float64)
        arrays[name] = blocks_of_variable.map_blocks(
            _variable,
            variable=name,
            dtype_=dtype,
            chunks=tuple(chunks[dim] for dim in dims),
            dtype=dtype,
            meta=np.empty((0,) * len(dims), dtype=dtype),
            name=f"{name}-{key}",
        )
    return arrays


def _variable(held: NDArray[Any], variable: str, dtype_: np.dtype[Any]) -> NDArray[Any]:
    # Statuses of motion are computed as doubles.
    values: NDArray[Any] = held.item()[variable]
    return values.astype(dtype_, copy=False)


@contextmanager
def watched(watch: Watch) -> Iterator[None]:
    """Let dask compute with the threads of a watch, report to it, and stop when it says so.

    Raises
    ------
    StoppedError
        If the watch stops it between two blocks.
    """
    remaining = 1.0

    def check(*_: Any) -> None:
        if watch.stopped():
            raise StoppedError(STOPPED)

    def advance(_key: Any, _result: Any, _graph: Any, state: dict[str, Any], _worker: Any) -> None:
        nonlocal remaining
        done = len(state["finished"])
        tasks = done + sum(len(state[group]) for group in ("ready", "waiting", "running"))
        remaining_now = 1 - done / max(1, tasks)
        if remaining_now < remaining:
            watch.advance(remaining - remaining_now)
            remaining = remaining_now

    check()
    callback = Callback(pretask=check, posttask=advance)
    threads = watch.threads or cores()
    with callback, dask.config.set(scheduler=SCHEDULER.get(), num_workers=threads):
        yield
    watch.advance(remaining)
