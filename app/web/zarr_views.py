"""Views of sweeps and chunks of them that were read last, within a budget of memory."""

from __future__ import annotations

import threading
from collections import OrderedDict

from vibrafeed.app.jobs.store import Store
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy.view import ZarrView

MAX_VIEWS = 64  # each holds a study and the documents of its arrays: some 100 KB


class ZarrViews:
    """Reads the sweeps of a store as Zarr groups; remembers what was read last.

    Threads may use it at the same time. Two that ask for the same chunk at once both compute it:
    that takes milliseconds and gives the same bytes.
    """

    def __init__(self, store: Store, most_bytes: int):
        """Read sweeps of a store; cache at most `most_bytes` of chunks."""
        self._store, self._most_bytes = store, most_bytes
        self._lock = threading.Lock()
        self._views: OrderedDict[tuple[str, str], ZarrView] = OrderedDict()
        self._chunks: OrderedDict[tuple[str, str, str], bytes] = OrderedDict()
        self._bytes = 0

    def view(self, key: str, chunks: str = "") -> ZarrView:
        """Return the Zarr view of a stored sweep: chunks are computed when they are read.

        `key` is the sweep's identifier; `chunks` holds a reader's wishes for chunk lengths, such as
        `frequency:all,friction:1`. The views used last are kept in memory.

        Raises
        ------
        NotFoundError
            If there is no such sweep.
        StudyError
            If the wishes cannot be met.
        """
        is_there = self._store.used(key) > 0  # it may have been removed since it was last read
        wish = (key, chunks)
        with self._lock:
            view = self._views.get(wish) if is_there else self._views.pop(wish, None)
            if view is not None and is_there:
                self._views.move_to_end(wish)
                return view
        sweep = self._store.sweep(key)
        view = ZarrView(sweep, outline(sweep.unverified()), chunks=chunks)
        with self._lock:
            self._views[wish] = view
            while len(self._views) > MAX_VIEWS:
                self._views.popitem(last=False)
        return view

    def holds(self, key: str, path: str, chunks: str = "") -> bool:
        """True if a path of a sweep's Zarr group is in memory, so that nothing is computed for it.

        The arguments are those of `read`.
        """
        with self._lock:
            is_laid_out = (key, chunks) in self._views
            return is_laid_out and (path.endswith(".json") or (key, chunks, path) in self._chunks)

    def read(self, key: str, path: str, chunks: str = "") -> bytes:
        """Return the bytes at a path of a sweep's Zarr group; raise `KeyError` if there are none.

        `key` is the sweep's identifier, `path` is within the group, such as `throw_number/c/0/1`;
        `chunks` holds a reader's wishes for chunk lengths. Chunks that were read last are cached.
        """
        entry = (key, chunks, path)
        self._store.note_use(key)
        with self._lock:
            content = self._chunks.get(entry)
            if content is not None:
                self._chunks.move_to_end(entry)
                return content
        content = self.view(key, chunks).read(path)
        with self._lock:
            if entry not in self._chunks and len(content) <= self._most_bytes:
                self._chunks[entry] = content
                self._bytes += len(content)
                while self._bytes > self._most_bytes:
                    _, dropped = self._chunks.popitem(last=False)
                    self._bytes -= len(dropped)
        return content
