"""Carrying out a reduction: boxes among threads, states joined, answers made of them."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.reduce import cutting
from vibrafeed.core.reduce.boxes import Boxes
from vibrafeed.core.reduce.cutting import Box
from vibrafeed.core.reduce.questions import fields_of
from vibrafeed.core.reduce.state import STOPPED, State, merge_states
from vibrafeed.core.study.reduction import Reduction
from vibrafeed.core.system import cores
from vibrafeed.core.watch import Watch


@dataclass(frozen=True)
class ReductionBox:
    """A box of a reduction: one round of a block of a field."""

    field: int
    block: int
    box: Box

    @property
    def cells(self) -> int:
        """The number of cells of the study in the box, a range of indices on each axis."""
        cells = 1
        for start, stop in self.box:
            cells *= stop - start
        return cells


class Units:
    """All boxes of a reduction, in order: the work, and what parts of it are counted in.

    Parameters
    ----------
    plan, grid
        Of the whole study.
    asked : Reduction
        What is asked.
    cells : int, optional
        Most cells of a box, if not as usual. No result depends on it.
    """

    def __init__(self, plan: Plan, grid: Grid, asked: Reduction, cells: int | None = None):
        self.boxes = tuple(
            Boxes(plan, grid, asked, field, cells or cutting.BOX_CELLS)
            for field in fields_of(plan, grid, asked)
        )
        counts = (one.cutting.blocks * one.cutting.rounds for one in self.boxes)
        self._ends = tuple(itertools.accumulate(counts))
        self.cells = sum(one.cutting.cells for one in self.boxes)

    def __len__(self) -> int:
        """Return the number of boxes."""
        return self._ends[-1]

    def __getitem__(self, index: int) -> ReductionBox:
        """Return a box by its number, from 0 in the order of fields, blocks and rounds."""
        field = next(k for k, end in enumerate(self._ends) if index < end)
        own = self.boxes[field].cutting
        start = self._ends[field] - own.blocks * own.rounds
        block, turn = divmod(index - start, own.rounds)
        return ReductionBox(field, block, own.box(block, turn))

    def states(self, start: int, stop: int, watch: Watch) -> Iterator[tuple[int, int, State]]:
        """Yield the states of the statistics of some boxes: field, block, and state of that block.

        A field is a group of outputs over the same axes, a block a region of the result, which
        several boxes of cells may add to; the numbers of both are given. Only the boxes from
        `start` to `stop` count, so that machines can share them. Boxes are computed by threads and
        joined in order.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        indices, running = iter(range(start, stop)), deque[tuple[ReductionBox, Future[State]]]()
        threads = watch.threads or cores()
        state: State | None = None
        before: ReductionBox | None = None
        cells = max(1, sum(self[k].cells for k in (start, stop - 1)) // 2 * (stop - start))
        with ThreadPoolExecutor(threads, thread_name_prefix="reduce") as pool:
            try:
                while True:
                    # The first box alone: it may have a loop compiled, which is for one.
                    ahead = 1 if before is None else 2 * threads
                    for index in itertools.islice(indices, ahead - len(running)):
                        unit = self[index]
                        running.append((unit, pool.submit(self._seen, unit, watch)))
                    if not running:
                        break
                    unit, future = running.popleft()
                    result = future.result()
                    if before is not None and (unit.field, unit.block) == (
                        before.field,
                        before.block,
                    ):
                        state = result if state is None else merge_states(state, result)
                    else:
                        if before is not None and state is not None:
                            yield before.field, before.block, state
                        state = result
                    before = unit
                    watch.advance(unit.cells / cells)
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
        if before is not None and state is not None:
            yield before.field, before.block, state

    def _seen(self, unit: ReductionBox, watch: Watch) -> State:
        """Evaluate the cells of one box and return the state of the statistics after these cells.

        A box is a range of indices on each axis of the study, small enough for memory; `unit` names
        it and the group of outputs that is computed there. States of boxes are joined by the
        caller. If boxes are fewer than threads, each is evaluated by several threads. Raises
        `StoppedError` if `watch` stops it.
        """
        if watch.stopped():
            raise StoppedError(STOPPED)
        # Boxes run side by side; the threads that they leave share the cells of each.
        threads = max(1, (watch.threads or cores()) // len(self))
        silent = replace(watch, progress=None, threads=threads)
        return self.boxes[unit.field].seen(unit.box, silent)
