"""What a worker runs of a sweep that is cut into parts, and how many parts that are."""

from __future__ import annotations

import json
import math
import time
from importlib.util import find_spec

from app.jobs.errors import TornBlockError
from app.jobs.manifest import NETCDF, ZARR, Making
from app.jobs.store import Store
from app.settings import Settings
from core.errors import LimitError, VibrafeedError
from core.kinds import prepare_content
from core.plan.prepared import Prepared
from core.plan.tiles import Tiled
from core.reduce.run import cores
from core.sweep import ReducedSweep, Sweep
from core.sweep.parts import MOST_PARTS, Parts, PartsMissingError
from core.watch import Watch

FEWEST_SECONDS = 10.0
"""What a task of a scheduler takes at least: less is not worth its telling."""
MOST_TASKS = 10_000
"""More are too many for one scheduler."""
TRIED = 3  # tiles from which the time of all is told
REDUCED_CELLS = 500_000_000  # of a part of a job: a second or two


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


# --- parts of a job of the service


def is_in_parts(prepared: Prepared, settings: Settings) -> bool:
    """Return whether a job is carried out in parts: what is reduced, or too large for memory."""
    if isinstance(prepared, ReducedSweep):
        return True
    large = prepared.cells > settings.max_cells or prepared.bytes > settings.max_bytes
    return isinstance(prepared, Sweep) and large and find_spec("obstore") is not None


def check_length(prepared: Prepared, settings: Settings) -> None:
    """Raise `LimitError` if a study in parts gives too much, or takes longer than a job may.

    How large a group may be, the quota of the disk says.
    """
    if isinstance(prepared, Sweep):
        prepared.check_limits(cells=settings.max_sweep_cells, bytes_=settings.disk_quota_bytes)
    else:
        prepared.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
    seconds = prepared.cells * prepared.seconds_a_cell / settings.workers
    if seconds > settings.max_job_seconds:
        most = math.floor(settings.max_job_seconds)
        fix = prepared.what_fits(most / seconds)
        raise LimitError("seconds of a job", math.ceil(seconds), most, fix)


def parts_of_job(store: Store, key: str, prepared: Prepared) -> Parts:
    """Return the parts of a job; their number follows from the study alone."""
    assert isinstance(prepared, Sweep | ReducedSweep)
    if isinstance(prepared, Sweep):
        return Parts(prepared, str(store.folder(key) / ZARR), count_of(prepared))
    return Parts(prepared, str(store.folder(key) / NETCDF), count_of(prepared))


def count_of(prepared: Prepared) -> int:
    """Return the number of parts of a job: tiles, or what takes a second or two to reduce."""
    if isinstance(prepared, ReducedSweep):
        return max(1, min(prepared.cells // REDUCED_CELLS, len(prepared.work), MOST_PARTS))
    assert isinstance(prepared, Sweep)
    return min(len(Tiled(prepared).tiles), MOST_PARTS)


def write_result(store: Store, key: str, process: str, parts: Parts, seconds: float) -> None:
    """Join the parts of a job, and write its manifest.

    Raises
    ------
    TornBlockError
        If a part is missing or damaged; it is to be computed anew.
    """
    sweep, count = parts.sweep, parts.count
    try:
        if isinstance(sweep, ReducedSweep):
            table = parts.answers(sweep)
            store.finish(
                key, table, process=process, cells=sweep.cells, blocks=count, seconds=seconds
            )
        else:
            making = Making(process, sweep.cells, count, seconds)
            store.finish_group(key, parts.join, parts.digests, making)
    except PartsMissingError as error:
        parts.forget(error.numbers)
        raise TornBlockError(f"of the parts of {key}, {error}") from None
