"""Results in an object store, from which each server fetches those that it lacks."""

from __future__ import annotations

import contextlib
import json
import logging
import tempfile
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from itertools import chain
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from vibrafeed.app.jobs.errors import LostStoreError
from vibrafeed.app.jobs.groups import LIST, read_list
from vibrafeed.app.jobs.integrity import has_digest
from vibrafeed.app.jobs.manifest import MANIFEST, ZARR, Manifest
from vibrafeed.core.dataset.files import PART, whole
from vibrafeed.core.dataset.stores import open_store, plain_errors
from vibrafeed.core.system import replace, sync

if TYPE_CHECKING:
    from obstore.store import ObjectStore

logger = logging.getLogger("vibrafeed.store")

STUDY = "study.json"
WAIT = 5.0  # s that a request waits for a download; then its client has to ask again


class RemoteResults:
    """Sends results to an object store, and fetches them, each below its study's identifier.

    A result is there when its manifest is, which is sent last and fetched last.

    Parameters
    ----------
    url : str
        Of the store, such as ``s3://bucket/prefix``; keys and address come from the environment.
    """

    def __init__(self, url: str):
        """Use the object store at a URL, with a thread for downloads."""
        self._url = url.rstrip("/")
        self._lock = Lock()
        self._fetching: dict[str, Future[bool]] = {}
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="fetch")

    def send(self, key: str, folder: Path) -> None:
        """Upload the result in a study's folder to the object store, unless it is there already.

        `key` is the study's identifier. Raises `OSError` if the store cannot be used.
        """
        manifest = (folder / MANIFEST).read_bytes()
        with _plain_errors():
            store = self._store(key)
            if _get(store, MANIFEST) == manifest:
                return
            # Whatever is replaced is no result meanwhile.
            with contextlib.suppress(FileNotFoundError):
                store.delete(MANIFEST)
            for name in chain((STUDY,), _names(folder, Manifest(**json.loads(manifest)))):
                store.put(name, folder / name)
            store.put(MANIFEST, manifest)

    def fetch(self, key: str, folder: Path) -> bool | None:
        """Download a result into a study's folder; return True if it is there.

        False if the store has no such result, or a damaged one, which is then removed from the
        store. None if the download takes longer than 5 s: it continues in the background. `key` is
        the study's identifier. Raises `OSError` if the store cannot be used.
        """
        with self._lock:
            fetching = self._fetching.get(key)
            is_new = fetching is None
            if fetching is None:
                fetching = self._thread.submit(self._fetch, key, folder)
                self._fetching[key] = fetching
        if is_new:  # what it tells is told to those who wait: later it may be another
            fetching.add_done_callback(lambda _: self._forget(key))
        return fetching.result() if wait([fetching], WAIT).done else None

    def close(self) -> None:
        """Stop downloading."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _forget(self, key: str) -> None:
        """Forget a download that has ended."""
        with self._lock:
            self._fetching.pop(key, None)

    def _fetch(self, key: str, folder: Path) -> bool:
        """Download a result into a study's folder; False if it is not stored or damaged.

        `key` is the study's identifier. The files go into a temporary folder first, and the
        manifest is written last, so that an incomplete download is never a result. A damaged result
        is removed from the store.
        """
        with _plain_errors():
            store = self._store(key)
            packed = _get(store, MANIFEST)
            if packed is None:
                return False
            manifest = Manifest(**json.loads(packed))
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(prefix=".", suffix=PART, dir=folder) as scratch:
                there = Path(scratch)
                if not _download(store, there, manifest):
                    logger.warning("a result in the object store is broken: %s", key)
                    if _get(store, MANIFEST) == packed:  # or another has sent a new one
                        store.delete(MANIFEST)
                    return False
                for path in list(there.iterdir()):
                    target = folder / path.name
                    if target.is_dir():  # a torn group, which goes with the scratch
                        replace(target, there / f"old-{path.name}")
                    replace(path, target)
        sync(folder)
        with whole(folder / MANIFEST) as temporary:
            temporary.write_bytes(packed)
        return True

    def _store(self, key: str) -> ObjectStore:
        """Return the part of the object store that holds a study."""
        return open_store(f"{self._url}/{key}")


def _names(folder: Path, manifest: Manifest) -> Iterator[str]:
    """Yield the names of all files of a result in a folder, those of its Zarr group included.

    `manifest` lists the files; a group's own files are in its list of digests.
    """
    for name in manifest.files:
        if name == ZARR:
            yield LIST
            yield from (f"{ZARR}/{key}" for key in read_list(folder))
        else:
            yield name


def _download(store: ObjectStore, folder: Path, manifest: Manifest) -> bool:
    """Download all files of a result into a folder.

    True if all have the digests of the manifest.
    """
    if not _write(store, STUDY, folder):
        return False
    for name, known in manifest.files.items():
        first = LIST if name == ZARR else name
        if not (_write(store, first, folder) and has_digest(folder / first, known["sha256"])):
            return False
    if ZARR in manifest.files:
        for key, digest in read_list(folder).items():
            name = f"{ZARR}/{key}"
            if not (_write(store, name, folder) and has_digest(folder / name, digest)):
                return False
    return True


def _write(store: ObjectStore, name: str, folder: Path) -> bool:
    """Download one file from the object store into a folder; True if the store has the file.

    `name` is its name in the store and its path below the folder.
    """
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        found = store.get(name)
    except FileNotFoundError:
        return False
    with path.open("wb") as file:
        for piece in found.stream():
            file.write(piece)
    sync(path)
    return True


@contextlib.contextmanager
def _plain_errors() -> Iterator[None]:
    """Turn all errors of the object store that the block raises into `LostStoreError`.

    The original error is its cause.
    """
    try:
        with plain_errors():
            yield
    except OSError as error:
        raise LostStoreError(*error.args) from error


def _get(store: ObjectStore, name: str) -> bytes | None:
    """Return the bytes of a file in the object store; None if there is none of this name."""
    try:
        return bytes(store.get(name).bytes())
    except FileNotFoundError:
        return None
