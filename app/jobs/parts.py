"""What a worker runs of a sweep that is cut into parts, and how many parts that are."""

from __future__ import annotations

import json
import time

from core.errors import VibrafeedError
from core.kinds import prepare_content
from core.plan.tiles import Tiled
from core.reduce.run import cores
from core.sweep import ReducedSweep, Sweep
from core.sweep.parts import Parts
from core.watch import Watch

FEWEST_SECONDS = 10.0
"""What a task of a scheduler takes at least: less is not worth its telling."""
MOST_TASKS = 10_000
"""More are too many for one scheduler."""
TRIED = 3  # tiles from which the time of all is told


def compute_part(study: str, where: str, count: int, part: int) -> bytes:
    """Compute a part of a study, given as JSON; return its record.

    Shards are written to `where`, which all workers and their client have to see: an object store,
    or a folder that they share. A reduced study needs neither.
    """
    prepared = prepare_content(json.loads(study))
    if not isinstance(prepared, Sweep | ReducedSweep):
        raise VibrafeedError("only sweeps have parts")
    return Parts(prepared, where, count).compute(part, Watch(threads=1))


def sensible_count(sweep: Sweep | ReducedSweep) -> int:
    """Return the number of parts of which each takes a core some ten seconds or more."""
    if isinstance(sweep, ReducedSweep):
        boxes, seconds = len(sweep.work), sweep.work.seconds() * cores()
    else:
        tiled = Tiled(sweep)
        boxes = len(tiled.tiles)
        tried = [tiled.tiles[boxes * k // (TRIED + 1)] for k in range(min(boxes, TRIED + 1))]
        started = cells = 0.0
        for k, tile in enumerate(tried):
            if k <= 1:  # the first may have had a loop compiled
                started, cells = time.perf_counter(), 0.0
            tiled.values(tile)
            cells += tile.cells
        # Packing takes as long as computing, about.
        seconds = 2 * (time.perf_counter() - started) / max(cells, 1.0) * tiled.tiles.cells
    return int(max(1, min(MOST_TASKS, boxes, seconds / FEWEST_SECONDS)))
