"""Views of sweeps as Zarr groups, of which those used last stay in memory."""

from __future__ import annotations

from functools import lru_cache

from vibrafeed.app.jobs.store import Store
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy.view import ZarrView

MAX_VIEWS = 64  # each holds a study and the documents of its arrays: some 100 KB


class ZarrViews:
    """Views the sweeps of a store as Zarr groups. Threads may use it at the same time."""

    def __init__(self, store: Store):
        """View sweeps of a store."""
        self._store = store
        self._kept_view = lru_cache(MAX_VIEWS)(self._make)

    def view(self, key: str) -> ZarrView:
        """Return the Zarr view of a stored sweep: chunks are computed when they are read.

        `key` is the sweep's identifier.

        Raises
        ------
        NotFoundError
            If there is no such sweep.
        """
        if not self._store.last_use(key):  # it may have been removed since it was last read
            self._store.sweep(key)
        self._store.note_use(key)
        return self._kept_view(key)

    def _make(self, key: str) -> ZarrView:
        sweep = self._store.sweep(key)
        return ZarrView(sweep, outline(sweep.unverified()))
