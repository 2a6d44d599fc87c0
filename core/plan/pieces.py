"""The record of a kind of study, and carrying out a study in pieces.

A module of the kind's package holds its record as `KIND`.

A piece is a part of the grid. What is computed of it does not depend on the other pieces, so that
they may be computed anywhere, in any order, and again.
"""

import math
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.prepared import Box, Chosen, Prepared
from vibrafeed.core.scenes import Scene
from vibrafeed.core.study.grid_study import Study
from vibrafeed.core.watch import Watch

Ready = TypeVar("Ready", bound=Prepared)

FOLLOWED = "motions_followed"
"""The attribute of a result that has the number of its cells, where only computing can tell it."""
MAX_PIECE_CELLS = 1_000_000  # points that a piece stores at most: a bound on memory
MAX_PIECES = 100_000  # pieces of a study: more would be too short to be worth handing out


@dataclass(frozen=True)
class Computed:
    """The arrays that computing a study gives, before they are labelled.

    Attributes
    ----------
    arrays : mapping of str to ndarray
        Each variable over its `Prepared.dims`.
    notes : mapping of str to str
        Attributes of the whole that only computing can tell.
    """

    arrays: Mapping[str, NDArray[Any]]
    notes: Mapping[str, str] = field(default_factory=dict)


def carry_out(
    prepared: Ready,
    compute: Callable[[Ready, Watch], Computed],
    label: Callable[[Ready, Computed, Watch], Table],
    watch: Watch | None = None,
) -> Table:
    """Compute a prepared study and return the table of its results, with cells and seconds.

    The seconds, an attribute of the table, leave out the time for verifying and for compiling.

    Parameters
    ----------
    prepared : Prepared
        A checked study with its plan and grid.
    compute, label : callable
        Those of the study's kind: `compute` returns bare arrays for a study, `label` makes a table
        of them and verifies some cells. Both get their share of the watch.
    watch : Watch, optional
        Takes the progress and may stop the computation.
    """
    watch, computing_share = watch or Watch(), prepared.computing_share
    started, compiling_before = time.perf_counter(), stopwatch.spent
    computed = compute(prepared, watch.part(computing_share))
    seconds = time.perf_counter() - started - (stopwatch.spent - compiling_before)
    table = label(prepared, computed, watch.part(1 - computing_share))
    return table.with_price(run_cost(cells_of(prepared, table), seconds))


def cells_of(prepared: Prepared, table: Table) -> int:
    """Return the number of cells computed for a result.

    Some kinds only know it afterwards and note it in the result; else it is the number of the
    study.
    """
    return int(table.attributes.get(FOLLOWED, prepared.cells))


def run_cost(cells: int, seconds: float) -> dict[str, float]:
    """Return the cost of a run as attributes of its result."""
    return {"elapsed_seconds": seconds, "cells_per_second": cells / max(seconds, 1e-9)}


def cells_of_piece(prepared: Prepared, seconds: float) -> int:
    """Return the number of cells of a piece of a study that takes about `seconds` on one core.

    Pieces are what the service gives to its workers. There are at most `MAX_PIECES` of them, and a
    piece stores at most `MAX_PIECE_CELLS`.
    """
    cells = seconds / prepared.seconds_a_cell
    min_cells = prepared.cells / MAX_PIECES
    # A study with `reduce` stores fewer values than it has cells.
    max_cells = MAX_PIECE_CELLS * prepared.cells / prepared.stored
    return int(min(max_cells, max(cells, min_cells, 1)))


class Cut:
    """A study cut into pieces of about equal size, in the order of its grid.

    Leading axes are taken value by value, one axis in steps, and the axes after it whole.

    Parameters
    ----------
    prepared : Prepared
        The study.
    cells : int
        Most points of a piece.
    """

    def __init__(self, prepared: Prepared, cells: int):
        """Divide a study into pieces of about `cells` cells."""
        axes = prepared.cut_axes
        shape = [prepared.grid.shape[name] for name in axes]
        cells_inside = prepared.cells // math.prod(shape)
        cut_count = len(axes)
        while cut_count and cells_inside * shape[cut_count - 1] <= cells:
            cut_count -= 1
            cells_inside *= shape[cut_count]
        self._axes, self._shape = axes[:cut_count], shape[:cut_count]
        # Steps of nearly equal length: no piece is a small remainder.
        self._parts = [*self._shape[:-1]]
        if cut_count:
            self._parts.append(-(-shape[cut_count - 1] // max(1, cells // cells_inside)))

    def __len__(self) -> int:
        """Return the number of pieces, at least one."""
        return math.prod(self._parts)

    def box(self, index: int) -> Box:
        """Return the box of cells of a piece of a study: start and stop (exclusive) by axis.

        `index` is the number of the piece, from 0, with the last axis fastest. Pieces are nearly
        equal.
        """
        position = np.unravel_index(index, self._parts) if self._parts else ()
        return {
            name: (int(at) * size // parts, (int(at) + 1) * size // parts)
            for name, size, parts, at in zip(
                self._axes, self._shape, self._parts, position, strict=True
            )
        }


def join(prepared: Prepared, pieces: Iterable[tuple[Box, Computed]]) -> Computed:
    """Join the results of the pieces of a study into those of the whole study.

    `pieces` are pairs: the box of a piece (start and stop on the axes that are cut) and its arrays.
    They are taken one after another, so that they need not all be in memory.
    """
    arrays: dict[str, NDArray[Any]] = {}
    notes: dict[str, str] = {}
    for box, piece in pieces:
        notes |= piece.notes
        for name, values in piece.arrays.items():
            if not box:
                arrays[name] = values
                continue
            dims = prepared.dims[name]
            if name not in arrays:
                arrays[name] = np.empty(tuple(prepared.sizes[dim] for dim in dims), values.dtype)
            arrays[name][tuple(slice(*box[dim]) if dim in box else slice(None) for dim in dims)] = (
                values
            )
    return Computed(arrays, notes)


class Sketch(NamedTuple):
    """The names in a study, or in content that is no sound study yet.

    `names` are the parameters that it gives or leaves open, wherever they stand.
    """

    scene: str
    variant: str | None
    method: str | None
    outputs: Collection[str]
    names: Collection[str]


@dataclass(frozen=True)
class Kind:
    """All that the rest of the program knows of a kind of study.

    Attributes
    ----------
    name : str
        The value of the key `kind`.
    title, description : str
        What lists of kinds show: a few words, and a sentence or two.
    model : type
        The model of its studies.
    scenes : tuple of mapping
        Where its scenes are; the first names all of them, others give further outputs.
    example : mapping
        A short study that is carried out at once.
    prepare : callable
        Takes a study; returns it prepared, or raises `StudyError` with every problem.
    choose : callable
        Takes a `Sketch`; returns the scene, the variant or method in force, and what is wrong with
        the one that is named. Raises `StudyError` without a scene.
    compute : callable
        Takes what `prepare` returns and a `Watch`; returns what was `Computed`.
    label : callable
        Takes what `prepare` returns, what was computed, and a `Watch` that may stop verifying;
        returns the `Table` of results.
    choices : mapping of str to iterable of str
        Values of keys that are no scenes, variants or outputs, and that the model does not list.
    is_measured : bool
        True if error against run time is measured for its studies (`vibrafeed.core.report`).
    verified : callable
        Takes what `prepare` returns and a `Watch`; returns the verification of random cells, which
        are computed alone, as attributes.
    compiles : mapping of str to tuple of mapping
        Studies that need every kernel of the kind; each group has its own.
    """

    name: str
    title: str
    description: str
    model: type[Study]
    scenes: tuple[Mapping[str, Scene], ...]
    example: Mapping[str, Any]
    prepare: Callable[[Any], Prepared]
    choose: Callable[[Sketch], Chosen]
    compute: Callable[[Any, Watch], Computed]
    label: Callable[[Any, Computed, Watch], Table]
    choices: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    is_measured: bool = False
    verified: Callable[[Any, Watch], Mapping[str, Any]] = lambda _prepared, _watch: {}
    compiles: Mapping[str, tuple[Mapping[str, Any], ...]] = field(
        default_factory=lambda: MappingProxyType({})
    )
