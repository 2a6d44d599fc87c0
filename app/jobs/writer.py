"""Writing the NetCDF file of a sweep that is asked for without a job: a short one."""

from __future__ import annotations

import asyncio
import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from app.jobs.keys import NOBODY, Key
from app.jobs.manifest import NETCDF, Manifest
from app.jobs.store import Store
from app.settings import Settings
from core.errors import LimitError
from core.kinds import tabulate
from core.plan.prepared import Prepared


class Writer:
    """Owns the NetCDF library in the server: it crashes if two threads of a process use it.

    Parameters
    ----------
    store : Store
        Where files go.
    make_room : callable
        Makes room for a study of an identifier, so many bytes, and whoever asks for it.
    settings : Settings
        The service's.
    """

    def __init__(
        self, store: Store, make_room: Callable[[str, int, Key], None], settings: Settings
    ):
        self._store, self._make_room, self._settings = store, make_room, settings
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="netcdf")

    async def result(self, key: str, sweep: Prepared, who: Key = NOBODY) -> Manifest:
        """Return the manifest of the result of a sweep; the first call computes and writes it.

        A result that is there does not wait for what is being written, and no thread of the routes
        waits.

        Raises
        ------
        LimitError
            If the sweep is not there and is too large, or takes too long, for one reply.
        NoRoomError
            If the file would not fit.
        """
        known = await self.known(key)
        if known is not None:
            return known
        self.check(sweep)
        return await asyncio.wrap_future(self._thread.submit(self._write, key, sweep, who))

    async def known(self, key: str) -> Manifest | None:
        """Return the manifest of the result of a sweep; None if it is not made yet, or broken.

        What is broken is taken away.
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
            if await self._store.integrity.is_sound(file, manifest.files[NETCDF]["sha256"]):
                return manifest
            found = os.fstat(file.fileno())
        await asyncio.to_thread(self._store.take_away, key, path, found)
        return None

    def check(self, sweep: Prepared) -> None:
        """Raise `LimitError` if a sweep is too large, or takes too long, for one reply."""
        settings = self._settings
        sweep.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
        seconds = sweep.cells * sweep.seconds_a_cell + sweep.seconds_to_verify
        most = settings.max_execution_seconds
        if seconds > most:
            fix = "POST the study to /processes/sweep/execution: that makes a job of it"
            raise LimitError("seconds in one reply", math.ceil(seconds), math.floor(most), fix)

    def close(self) -> None:
        """Finish the write under way, and take no more."""
        self._thread.shutdown(cancel_futures=True)

    def _write(self, key: str, sweep: Prepared, who: Key) -> Manifest:
        known = self._store.manifest(key)
        if known is not None:
            return known
        self._make_room(key, sweep.bytes, who)
        table = tabulate(sweep)
        seconds = table.price["elapsed_seconds"]
        self._store.add(sweep.study)  # should it have made room for another meanwhile
        return self._store.finish(
            key, table, process="sweep", cells=sweep.cells, blocks=1, seconds=seconds
        )
