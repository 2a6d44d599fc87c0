"""Studies that are computed as a whole: their pieces are kept beside the result until it is whole.

They are those of the jobs of the service, in the same files.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from vibrafeed.app.jobs.blocks import Blocks
from vibrafeed.app.jobs.errors import TornBlockError
from vibrafeed.core import kinds
from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.dataset.files import partial
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.pieces import (
    Computed,
    Cut,
    carry_out,
    cells_of,
    cells_of_piece,
    join,
    run_cost,
)
from vibrafeed.core.plan.prepared import Box, Prepared
from vibrafeed.core.watch import Watch

PIECE_SECONDS = 2.0
"""Approximate time of a piece on all cores [s]: what a killed run loses."""
SPENT = "spent_seconds"
"""Name of the note of a stored piece that holds its computing time [s]."""


class Pieces:
    """The pieces of a study, which are stored one by one so that a stopped run can go on.

    Parameters
    ----------
    prepared : Prepared
        The study, ready to be computed.
    target : str
        The path or URL of the result.
    resume : bool
        True to go on with stored pieces; else they are removed.
    """

    def __init__(self, prepared: Prepared, target: str, *, resume: bool):
        """Prepare the pieces of a study; unless it resumes, remove those of an earlier run."""
        self._prepared, self._kind = prepared, kinds.KINDS[prepared.study.kind]
        self.folder = partial(Path(target))
        if not resume:
            self.remove()
        self._store, self._key = Blocks(self.folder), ""
        self._cells = cells_of_piece(prepared, PIECE_SECONDS * (os.cpu_count() or 1))
        self._spent = 0.0
        if not prepared.keeps_some or "://" in target:
            self._cells = prepared.cells  # one piece, which is not kept
        self._cut = Cut(prepared, self._cells)
        if len(self) > 1:
            with contextlib.suppress(OSError):  # who cannot write here is told with the result
                self._begin()

    def __len__(self) -> int:
        """Return the number of pieces, 1 or more."""
        return len(self._cut)

    @property
    def kept(self) -> int:
        """The number of pieces that are stored on disk."""
        return sum(self._is_kept(index) for index in range(len(self))) if self._key else 0

    def tabulate(self, watch: Watch) -> Table:
        """Return the result of the study as a table, computing only pieces that are not stored yet.

        A piece is a range of cells; each is stored when it is done, so that a run that was stopped
        can continue. Studies that are not divided (`_key` is empty) are computed at once. The price
        in the attributes counts the computing time of earlier runs, too. `watch` takes the progress
        and may stop the run.

        Raises
        ------
        StoppedError
            If `watch` stops a study whose incomplete result is of no use.
        """
        if not self._key:
            return kinds.tabulate(self._prepared, watch)
        table = carry_out(self._prepared, self._compute, self._kind.label, watch)
        seconds = float(table.price["elapsed_seconds"]) + self._spent
        return table.with_price(run_cost(cells_of(self._prepared, table), seconds))

    def remove(self) -> None:
        """Remove the stored pieces, which are in the result or no longer needed."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _begin(self) -> None:
        """Create the folder of the pieces, or take the size of the pieces that are stored there.

        A piece is a block of cells that is computed and stored at a time, so that a stopped run can
        go on. Stored pieces may have another size than this machine would choose.
        """
        key, _ = self._store.add(self._prepared.study)
        there = [int(one.name) for one in (self._store.folder(key) / "blocks").glob("[0-9]*")]
        if there and self._cells not in there:  # they come from a machine with other cores
            self._cells = max(there)
            self._cut = Cut(self._prepared, self._cells)
        self._key = key

    def _is_kept(self, index: int) -> bool:
        """True if a piece is stored on disk."""
        return self._store.has_block(self._key, self._cells, index)

    def _compute(self, prepared: Prepared, watch: Watch) -> Computed:
        """Compute all pieces that are not stored, join them with the stored, return the arrays.

        `prepared` is the whole study. After a stop by `watch` the unfinished piece is among them;
        cells that were not reached have no value.
        """
        count = len(self)
        left = [index for index in range(count) if not self._is_kept(index)]
        if len(left) < count:
            watch.advance(1 - len(left) / count)
        held = {}  # pieces that are not on the disk
        for index in left:
            computed = self._piece(index, watch.part(1 / count))
            if watch.stopped() or not self._keep(index, *computed):
                held[index] = computed[0]
        # What is whole comes last: it stands where an output has not the axis of the cut.
        return join(prepared, self._in_order(held, watch))

    def _in_order(self, held: dict[int, Computed], watch: Watch) -> Iterator[tuple[Box, Computed]]:
        """Yield the box and the arrays of each piece, first those that are not stored.

        `held` are the computed pieces that were unfinished or could not be stored, by number. A box
        is start and stop of a piece on each axis. `watch` may stop computing a damaged piece again.
        """
        for index, computed in held.items():
            yield self._cut.box(index), computed
        for index in range(len(self)):
            if index not in held:
                yield self._cut.box(index), self._read(index, watch)

    def _piece(self, index: int, watch: Watch) -> tuple[Computed, float]:
        """Compute a piece; return its arrays and the seconds that it took, without compiling.

        `index` is its number, from 0.
        """
        started, compiling = time.perf_counter(), stopwatch.spent
        computed = self._kind.compute(self._prepared.within(self._cut.box(index)), watch)
        return computed, time.perf_counter() - started - (stopwatch.spent - compiling)

    def _keep(self, index: int, computed: Computed, seconds: float) -> bool:
        """Store a computed piece on disk with its computing time; True if that succeeded.

        `index` is the number of the piece, `seconds` its time [s], which is counted when the piece
        is read.
        """
        noted = replace(computed, notes={**computed.notes, SPENT: repr(seconds)})
        try:
            self._store.write_block(self._key, self._cells, index, noted)
        except OSError:
            return False
        self._spent -= seconds  # it is counted as it is read
        return True

    def _read(self, index: int, watch: Watch) -> Computed:
        """Return a piece read from disk, and count its computing time; compute it again if damaged.

        `index` is the number of the piece; `watch` may stop computing it again.
        """
        try:
            computed = self._store.read_block(self._key, self._cells, index)
        except TornBlockError:
            return self._piece(index, replace(watch, progress=None))[0]
        notes = dict(computed.notes)
        self._spent += float(notes.pop(SPENT))
        return replace(computed, notes=notes)
