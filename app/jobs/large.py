"""Jobs whose result is too large for one file: a Zarr group that grows block by block."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from vibrafeed.app.jobs.manifest import ZARR, Making
from vibrafeed.core import lazy
from vibrafeed.core.errors import LimitError
from vibrafeed.core.plan.prepared import Prepared

if TYPE_CHECKING:
    from vibrafeed.app.jobs.store import Store
    from vibrafeed.app.settings import Settings
    from vibrafeed.core.lazy.store import ZarrStore


def is_large(prepared: Prepared, settings: Settings) -> bool:
    """True if a study has more cells or bytes than one file may have, computed one by one.

    `settings` are those of the service.
    """
    large = prepared.cells > settings.max_cells or prepared.bytes > settings.max_bytes
    return prepared.not_lazy is None and large


def check_length(prepared: Prepared, settings: Settings) -> None:
    """Raise `LimitError` if a large study has too many cells, or takes too long for a job.

    The error names a number of cells that would be accepted. The expected time is that of all
    workers together.
    """
    prepared.check_limits(cells=settings.max_sweep_cells, bytes_=settings.disk_quota_bytes)
    seconds = prepared.price.of(prepared.cells) / settings.workers
    if seconds > settings.max_job_seconds:
        most = math.floor(settings.max_job_seconds)
        fix = prepared.what_fits(most / seconds)
        raise LimitError("seconds of a job", math.ceil(seconds), most, fix)


def group_of_job(store: Store, key: str, prepared: Prepared) -> ZarrStore:
    """Return the group of a job, below the folder of its study."""
    return lazy.store.ZarrStore(prepared, str(store.folder(key) / ZARR))


def finish(store: Store, key: str, process: str, group: ZarrStore, seconds: float) -> None:
    """Complete the group of a job whose blocks are all stored, and write the manifest."""
    prepared = group.prepared
    making = Making(process, prepared.cells, len(group.blocks), seconds)
    store.finish_group(key, group.finish, making)
