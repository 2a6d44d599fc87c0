"""Writing the NetCDF file of a sweep that is asked for without a job."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor

from app.store import Manifest, Store
from core.kinds import tabulate
from core.sweep import Sweep


class Writer:
    """Owns the NetCDF library in the server: it crashes if two threads of a process use it."""

    def __init__(self, store: Store):
        self._store = store
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="netcdf")

    async def result(self, key: str, sweep: Sweep) -> Manifest:
        """Return the manifest of the result of a sweep; the first call computes and writes it.

        A result that is there does not wait for what is being written, and no thread of the routes
        waits.
        """
        known = await asyncio.to_thread(self._store.manifest, key)
        if known is not None:
            return known
        return await asyncio.wrap_future(self._thread.submit(self._write, key, sweep))

    def close(self) -> None:
        """Finish the write under way, and take no more."""
        self._thread.shutdown()

    def _write(self, key: str, sweep: Sweep) -> Manifest:
        known = self._store.manifest(key)
        if known is not None:
            return known
        table = tabulate(sweep)
        seconds = table.price["elapsed_seconds"]
        return self._store.finish(
            key, table, process="sweep", cells=sweep.cells, blocks=1, seconds=seconds
        )
