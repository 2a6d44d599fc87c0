"""The tasks of workers for a sweep that is cut into parts, and the number of these parts."""

from __future__ import annotations

import json
import math
from importlib.util import find_spec

from app.jobs.errors import TornBlockError
from app.jobs.manifest import NETCDF, ZARR, Making
from app.jobs.store import Store
from app.settings import Settings
from core.errors import LimitError
from core.intake import prepare_content
from core.plan.parts import ARRAYS, MAX_PARTS, SHARDS, Parts, PartsMissingError
from core.plan.prepared import Prepared
from core.watch import Watch

FEWEST_SECONDS = 10.0
"""Shortest useful time of a task [s]: shorter ones cost more to schedule than to compute."""
MAX_TASKS = 10_000
"""Largest number of tasks: a scheduler handles more of them slowly."""


def compute_part(study: str, where: str, count: int, part: int) -> bytes:
    """Compute one part of a study on a worker and return its record in bytes.

    Shards are written to `where`, an object store or a folder that all workers and their client
    share; a reduced study returns its arrays in the record and needs no such place.

    Parameters
    ----------
    study : str
        The study as JSON.
    where : str
        URL or folder of the Zarr group.
    count, part : int
        Number of parts, and the one to compute, from 0.
    """
    return prepare_content(json.loads(study)).parts(where, count).compute(part, Watch(threads=1))


def sensible_count(prepared: Prepared) -> int:
    """Return a number of parts such that each takes a core ten seconds or more."""
    seconds = prepared.seconds_in_parts()
    return int(max(1, min(MAX_TASKS, prepared.boxes, seconds / FEWEST_SECONDS)))


# --- parts of a job of the service


def is_in_parts(prepared: Prepared, settings: Settings) -> bool:
    """True if a job is computed in parts: a reduction, or a result too large for memory."""
    if prepared.part_of == ARRAYS:
        return True
    large = prepared.cells > settings.max_cells or prepared.bytes > settings.max_bytes
    return prepared.part_of == SHARDS and large and find_spec("obstore") is not None


def check_length(prepared: Prepared, settings: Settings) -> None:
    """Raise `LimitError` if the result of a study in parts is too large or takes too long.

    The size of a Zarr group is limited by the quota of the disk. The expected time is that of all
    workers together; the message names a number of cells that would be accepted.
    """
    if prepared.part_of == SHARDS:
        prepared.check_limits(cells=settings.max_sweep_cells, bytes_=settings.disk_quota_bytes)
    else:
        prepared.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
    seconds = prepared.cells * prepared.seconds_a_cell / settings.workers
    if seconds > settings.max_job_seconds:
        most = math.floor(settings.max_job_seconds)
        fix = prepared.what_fits(most / seconds)
        raise LimitError("seconds of a job", math.ceil(seconds), most, fix)


def parts_of_job(store: Store, key: str, prepared: Prepared) -> Parts:
    """Return the parts of a job, which write below the study's folder; `key` is its identifier.

    Their number depends on the study alone, so that a restarted service cuts it alike.
    """
    name = ZARR if prepared.part_of == SHARDS else NETCDF
    return prepared.parts(str(store.folder(key) / name), count_of(prepared))


def count_of(prepared: Prepared) -> int:
    """Return the number of parts of a job.

    A sweep that is written as a Zarr group has one per tile; a reduction has parts of a second or
    two.
    """
    most = min(prepared.boxes, MAX_PARTS)
    if prepared.part_of == SHARDS:
        return most
    return max(1, min(prepared.cells // prepared.part_cells, most))


def write_result(store: Store, key: str, process: str, parts: Parts, seconds: float) -> None:
    """Join the parts of a job into its result, and write the manifest.

    Parameters
    ----------
    store : Store
        Where the result is written.
    key, process : str
        The study's identifier, and the process that computed it.
    parts : Parts
        The computed parts.
    seconds : float
        Computing time of all parts [s], for the manifest.

    Raises
    ------
    TornBlockError
        If a part is missing or damaged; it is to be computed anew.
    """
    cells, count = parts.cells, parts.count
    try:
        table = parts.joined_table()
        if table is not None:
            store.finish(key, table, process=process, cells=cells, blocks=count, seconds=seconds)
        else:
            making = Making(process, cells, count, seconds)
            store.finish_group(key, parts.join, parts.digests, making)
    except PartsMissingError as error:
        parts.forget(error.numbers)
        raise TornBlockError(f"of the parts of {key}, {error}") from None
