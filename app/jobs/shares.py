"""The tasks of workers for a sweep that is cut into shares, and the number of these shares."""

from __future__ import annotations

import json
import math
from importlib.util import find_spec
from typing import TYPE_CHECKING

from vibrafeed.app.jobs.errors import TornBlockError
from vibrafeed.app.jobs.manifest import NETCDF, ZARR, Making
from vibrafeed.core.errors import LimitError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.shares import ARRAYS, MAX_SHARES, SHARDS, Shares, SharesMissingError
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.app.jobs.store import Store
    from vibrafeed.app.settings import Settings

FEWEST_SECONDS = 10.0
"""Shortest useful time of a task [s]: shorter ones cost more to schedule than to compute."""
MAX_TASKS = 10_000
"""Largest number of tasks: a scheduler handles more of them slowly."""


def compute_share(study: str, where: str, count: int, share: int) -> bytes:
    """Compute one share of a study on a worker and return its record in bytes.

    Shards are written to `where`, an object store or a folder that all workers and their client
    share; a reduced study returns its arrays in the record and needs no such place.

    Parameters
    ----------
    study : str
        The study as JSON.
    where : str
        URL or folder of the Zarr group.
    count, share : int
        Number of shares, and the one to compute, from 0.
    """
    return prepare_content(json.loads(study)).shares(where, count).compute(share, Watch(threads=1))


def sensible_count(prepared: Prepared) -> int:
    """Return a number of shares such that each takes a core ten seconds or more."""
    seconds = prepared.price.of(prepared.cells)
    return int(max(1, min(MAX_TASKS, prepared.boxes, seconds / FEWEST_SECONDS)))


# --- shares of a job of the service


def is_in_shares(prepared: Prepared, settings: Settings) -> bool:
    """True if several calls on workers compute a study, each a share of its cells.

    That is any reduced sweep, and a plain sweep whose result has more cells or bytes than one file
    may have, if the library `obstore` is installed with which its Zarr group is written. `prepared`
    is the study, ready to be computed; `settings` are those of the service.
    """
    if prepared.shares_as == ARRAYS:
        return True
    large = prepared.cells > settings.max_cells or prepared.bytes > settings.max_bytes
    return prepared.shares_as == SHARDS and large and find_spec("obstore") is not None


def check_length(prepared: Prepared, settings: Settings) -> None:
    """Raise `LimitError` if a study is too large or takes too long to be computed in shares.

    The error names a number of cells that would be accepted. The expected time is that of all
    workers together; the size of a Zarr group is limited by the quota of the disk.

    Parameters
    ----------
    prepared : Prepared
        The study, ready to be computed.
    settings : Settings
        The limits of the service.
    """
    if prepared.shares_as == SHARDS:
        prepared.check_limits(cells=settings.max_sweep_cells, bytes_=settings.disk_quota_bytes)
    else:
        prepared.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
    seconds = prepared.price.of(prepared.cells) / settings.workers
    if seconds > settings.max_job_seconds:
        most = math.floor(settings.max_job_seconds)
        fix = prepared.what_fits(most / seconds)
        raise LimitError("seconds of a job", math.ceil(seconds), most, fix)


def shares_of_job(store: Store, key: str, prepared: Prepared) -> Shares:
    """Return the shares into which a job's study is cut; they are written below the study's folder.

    `key` is the study's identifier. Their number depends on the study alone, so that a restarted
    service cuts it alike.
    """
    name = ZARR if prepared.shares_as == SHARDS else NETCDF
    return prepared.shares(str(store.folder(key) / name), count_of(prepared))


def count_of(prepared: Prepared) -> int:
    """Return the number of shares into which a job cuts a study.

    A sweep that is written as a Zarr group has one for each tile (block of cells in a file); a
    reduction, which stores statistics only, has shares that take a second or two.
    """
    most = min(prepared.boxes, MAX_SHARES)
    if prepared.shares_as == SHARDS:
        return most
    return max(1, min(prepared.cells // prepared.share_cells, most))


def write_result(store: Store, key: str, process: str, shares: Shares, seconds: float) -> None:
    """Join the shares of a job into its result, and write the manifest.

    Parameters
    ----------
    store : Store
        Where the result is written.
    key, process : str
        The study's identifier, and the process that computed it.
    shares : Shares
        The computed shares.
    seconds : float
        Computing time of all shares [s], for the manifest.

    Raises
    ------
    TornBlockError
        If a share is missing or damaged; it is to be computed anew.
    """
    cells, count = shares.cells, shares.count
    try:
        table = shares.joined_table()
        if table is not None:
            store.finish(key, table, process=process, cells=cells, blocks=count, seconds=seconds)
        else:
            making = Making(process, cells, count, seconds)
            store.finish_group(key, shares.join, shares.digests, making)
    except SharesMissingError as error:
        shares.forget(error.numbers)
        raise TornBlockError(f"of the shares of {key}, {error}") from None
