"""Writing the NetCDF file of a sweep that is asked for without a job: a short one."""

from __future__ import annotations

import asyncio
import math
import os
from collections.abc import Awaitable, Callable
from pathlib import Path

from vibrafeed.app.jobs.errors import NoRoomError
from vibrafeed.app.jobs.keys import Key
from vibrafeed.app.jobs.manifest import NETCDF, Manifest
from vibrafeed.app.jobs.process_pool import ProcessPool
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings
from vibrafeed.core.errors import LimitError
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plan.prepared import Prepared

TIMES = 10.0  # as long as a reply may take: a file is finished though its price was too low


class Writer:
    """Computes sweeps and writes their NetCDF files, in processes of a pool.

    The NetCDF library crashes if two threads of one process use it.

    Parameters
    ----------
    store : Store
        Where files go.
    make_room : callable
        Makes room for files; takes the study's identifier, their bytes, and the API key.
    settings : Settings
        The service's.
    process_pool : ProcessPool
        Where sweeps are computed and written.
    """

    def __init__(
        self,
        store: Store,
        make_room: Callable[[str, int, Key], None],
        settings: Settings,
        process_pool: ProcessPool,
    ):
        """Write files of a store in a pool of processes; `make_room` frees disk space first."""
        self._store, self._make_room, self._settings = store, make_room, settings
        self._process_pool = process_pool

    async def write(
        self, key: str, sweep: Prepared, api_key: Key, check: Callable[[], Awaitable[None]]
    ) -> Manifest:
        """Compute a sweep and write its file, unless it exists; return its manifest.

        Parameters
        ----------
        key : str
            Identifier of the sweep.
        sweep : Prepared
            The sweep, ready to be computed.
        api_key : Key
            The API key that asks for the file, in whose quota it counts.
        check : callable
            Awaited every half second; if it raises, the work is ended.

        Raises
        ------
        StoppedError
            If it takes ten times as long as allowed for a reply.
        NoRoomError
            If the file would not fit.
        """
        await asyncio.to_thread(self._make_room, key, sweep.bytes, api_key)
        # Should it have made room for another meanwhile.
        await asyncio.to_thread(self._store.add, sweep.study)
        directory = str(self._settings.data_directory.resolve())
        max_seconds = TIMES * self._settings.max_execution_seconds
        await self._process_pool(write_sweep_file, directory, key, seconds=max_seconds, check=check)
        manifest = await asyncio.to_thread(self._store.manifest, key)
        if manifest is None:
            raise NoRoomError(
                "The result file was just removed to make room for others. Send the request again."
            )
        return manifest

    async def manifest_of(self, key: str) -> Manifest | None:
        """Return the manifest of a sweep's file; None if it is not written yet or is damaged.

        A damaged file is removed. `key` is the sweep's identifier.
        """
        manifest = await asyncio.to_thread(self._store.manifest, key)
        if manifest is None or NETCDF not in manifest.files:
            return None
        path = self._store.folder(key) / NETCDF
        try:
            file = await asyncio.to_thread(path.open, "rb", buffering=0)
        except FileNotFoundError:
            return None
        with file:
            if await self._store.integrity.is_intact(file, manifest.files[NETCDF]["sha256"]):
                return manifest
            damaged = os.fstat(file.fileno())
        await asyncio.to_thread(self._store.remove_file, key, path, damaged)
        return None

    def check(self, sweep: Prepared) -> None:
        """Raise `LimitError` if a sweep is too large, or takes too long, for one request."""
        settings = self._settings
        sweep.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
        seconds = sweep.seconds
        most = settings.max_execution_seconds
        if seconds > most:
            fix = "POST the study to /processes/sweep/execution: that makes a job of it"
            raise LimitError("seconds in one reply", math.ceil(seconds), math.floor(most), fix)


def write_sweep_file(directory: str, key: str) -> None:
    """Compute a stored sweep and write its file, unless it exists; for a process of the pool.

    `directory` is the data directory of the service; `key` is the sweep's identifier.
    """
    store = Store(Path(directory))
    if store.manifest(key) is not None:  # somebody else asked for it, too
        return
    sweep = store.sweep(key)
    table = tabulate(sweep)
    seconds = table.price["elapsed_seconds"]
    store.finish(key, table, process="sweep", cells=sweep.cells, blocks=1, seconds=seconds)
