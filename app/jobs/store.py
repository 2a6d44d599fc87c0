"""Studies and results on disk, addressed by content: equal studies share one folder.

A folder each, named by the study's identifier: ``study.json``; ``blocks/`` while it is computed;
``result.nc`` and, where it is small, ``result.json``; last ``manifest.json``. A file appears
complete or not at all, and a result is there when its manifest is. Servers and workers use the same
folders; who finishes a study holds a lock on its folder.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import logging
import os
import re
import shutil
import tempfile
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import orjson

import core
from app.jobs.blocks import pack, unpack
from app.jobs.errors import NotFoundError, OtherVersionError, TornBlockError
from app.jobs.manifest import (
    JSON,
    MANIFEST,
    MOST_JSON_VALUES,
    NETCDF,
    ZARR,
    Manifest,
    fingerprint,
)
from core.dataset.document import to_document
from core.dataset.files import PART, partial, whole
from core.dataset.netcdf import write_netcdf
from core.dataset.records import ENDING
from core.dataset.shards import GROUP, GROWING
from core.dataset.table import Table
from core.errors import StudyError, VibrafeedError
from core.kinds import prepare_content
from core.plan.pieces import Computed
from core.plan.prepared import Prepared
from core.study.load import read_json
from core.study.models import Study
from core.sweep import Sweep

logger = logging.getLogger("vibrafeed.store")

IDENTIFIER = re.compile(r"[0-9a-f]{64}")
USED_EVERY = 3600.0  # s; the use of a study is noted no more often
MOST_KNOWN = 64  # studies that are kept in memory
MOST_KNOWN_BYTES = 20_000  # of such a study: a list of values takes many times that in memory
PARTS_KEPT = 3600.0  # s without a change, after which nobody is writing any more


def identifier(study: Study, process: str | None = None) -> str:
    """Return the SHA-256 of a study, the version, and the process if it is not the study's own."""
    words = [core.__version__, study.canonical()]
    if process not in (None, study.kind):
        words.insert(0, str(process))
    return hashlib.sha256(" ".join(words).encode()).hexdigest()


class Store:
    """Keeps studies and what is computed of them, below one directory.

    Threads and processes may use it at the same time.
    """

    def __init__(self, directory: Path):
        self.directory = directory / "studies"
        self._lock = threading.Lock()
        # That were asked for last, and whether the identifier is the study's own, for no process.
        self._known: OrderedDict[str, tuple[Prepared, bool]] = OrderedDict()

    def add(self, study: Study, process: str | None = None) -> tuple[str, bool]:
        """Keep a study; return its identifier, and whether it is new."""
        key = identifier(study, process)
        path = self.directory / key / "study.json"
        if path.exists():
            self.note_use(key)
            return key, False
        path.parent.mkdir(parents=True, exist_ok=True)
        with _kept(path) as temporary:
            temporary.write_text(study.canonical(), encoding="utf-8")
        return key, True

    def get(self, key: str) -> Prepared:
        """Return the study of an identifier; raise `NotFoundError` if there is none."""
        return self._get(key)[0]

    def sweep(self, key: str) -> Sweep:
        """Return the sweep of an identifier.

        Raises
        ------
        NotFoundError
            If there is none.
        OtherVersionError
            If another version of vibrafeed was posted it.
        """
        try:
            found, is_own = self._get(key)
        except StudyError:  # it was sound when it was posted
            raise _not_own(key, None) from None
        if isinstance(found, Sweep) and is_own:
            return found
        raise _not_own(key, found)

    def _get(self, key: str) -> tuple[Prepared, bool]:
        path = self.folder(key) / "study.json"
        with self._lock:
            known = self._known.get(key)
            if known is not None and path.exists():  # it may have been removed
                self._known.move_to_end(key)
                self.note_use(key)
                return known
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            raise _unknown(key) from None
        self.note_use(key)
        prepared = prepare_content(read_json(content))
        found = prepared, identifier(prepared.study) == key
        if len(content) <= MOST_KNOWN_BYTES:
            with self._lock:
                self._known[key] = found
                while len(self._known) > MOST_KNOWN:
                    self._known.popitem(last=False)
        return found

    def folder(self, key: str) -> Path:
        """Return the folder of a study; raise `NotFoundError` for what is no identifier."""
        # Only what looks like an identifier reaches the file system.
        if not IDENTIFIER.fullmatch(key):
            raise _unknown(key)
        return self.directory / key

    # --- blocks

    def has_block(self, key: str, cells: int, index: int) -> bool:
        """Return whether a block of a study cut into pieces of so many cells is there."""
        return self._block(key, cells, index).exists()

    def write_block(self, key: str, cells: int, index: int, computed: Computed) -> None:
        """Keep what was computed of a piece."""
        path = self._block(key, cells, index)
        digest, content = pack(computed)
        for last in (False, True):
            # Not the study's own folder: if that is gone, so is the study.
            path.parent.parent.mkdir(exist_ok=True)
            path.parent.mkdir(exist_ok=True)
            try:
                with _kept(path) as temporary, temporary.open("wb") as file:
                    file.write(digest)
                    file.write(content)
            except FileNotFoundError:  # whoever finished the study has just removed its blocks
                if last:
                    raise
            else:
                return

    def read_block(self, key: str, cells: int, index: int) -> Computed:
        """Return what was computed of a piece; raise `TornBlockError` if it cannot be read."""
        path = self._block(key, cells, index)
        try:
            block = path.read_bytes()
        except FileNotFoundError:
            raise TornBlockError(f"block {index} of {key} is gone") from None
        computed = unpack(block)
        if computed is None:
            path.unlink(missing_ok=True)
            raise TornBlockError(f"block {index} of {key} is not what was written")
        return computed

    def give_up(self, key: str, claim: str) -> None:
        """Tell the workers that nobody waits for their blocks of a claim on a study."""
        with contextlib.suppress(OSError):  # the study may be gone, and its blocks with it
            self._given_up(key, claim).parent.mkdir(exist_ok=True)
            self._given_up(key, claim).touch()

    def is_given_up(self, key: str, claim: str) -> bool:
        """Return whether workers have been told so."""
        return self._given_up(key, claim).exists()

    def _given_up(self, key: str, claim: str) -> Path:
        name = hashlib.sha256(claim.encode()).hexdigest()[:32]
        return self.folder(key) / "blocks" / f"{name}.given-up"

    def drop_blocks(self, key: str) -> None:
        """Remove the blocks of a study whose result is there; a late worker may have left one."""
        if self._manifest(key) is not None:
            folder = self.folder(key)
            shutil.rmtree(folder / "blocks", ignore_errors=True)
            shutil.rmtree(partial(folder / ZARR), ignore_errors=True)
            for result in (NETCDF, ZARR):
                shutil.rmtree(folder / f"{result}{ENDING}", ignore_errors=True)

    def _block(self, key: str, cells: int, index: int) -> Path:
        # Blocks of another size, left by a job that was given up, are never taken for these.
        return self.folder(key) / "blocks" / str(cells) / f"{index:06d}.block"

    # --- results

    def manifest(self, key: str) -> Manifest | None:
        """Return what is known of a result; None while there is none."""
        found = self._manifest(key)
        if found is not None:
            self.note_use(key)
        return found

    def _manifest(self, key: str) -> Manifest | None:
        path = self.folder(key) / MANIFEST
        try:
            return Manifest(**json.loads(path.read_bytes()))
        except FileNotFoundError:
            return None
        except (ValueError, TypeError):  # damaged: the result is made again
            logger.warning("a manifest cannot be read: %s", key)
            return None

    def finish(
        self,
        key: str,
        table: Table,
        *,
        process: str,
        cells: int,
        blocks: int,
        seconds: float,
        more: Callable[[Path, Path], Iterable[Path]] | None = None,
    ) -> Manifest:
        """Write a result and, last, its manifest; its blocks are needed no more.

        What somebody else has finished meanwhile stands. `more` takes the NetCDF file and a
        folder, and returns further files that it wrote there.
        """

        def write(folder: Path) -> list[str]:
            write_netcdf(table, folder / NETCDF)
            names = [NETCDF]
            values = sum(variable.values.size for variable in table.variables.values())
            if values <= MOST_JSON_VALUES:
                document = to_document(table.with_price({}))
                with _kept(folder / JSON) as temporary:
                    temporary.write_bytes(orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY))
                names.append(JSON)
            if more is not None:
                with tempfile.TemporaryDirectory(prefix=".", suffix=PART, dir=folder) as scratch:
                    for path in more(folder / NETCDF, Path(scratch)):
                        with _kept(folder / path.name) as temporary:
                            path.replace(temporary)
                        names.append(path.name)
            return names

        about = {"process": process, "cells": cells, "blocks": blocks, "seconds": seconds}
        return self._finish(key, write, about)

    def finish_group(
        self, key: str, join: Callable[[], object], about: Mapping[str, Any]
    ) -> Manifest:
        """Have the parts of a Zarr group joined, and write its manifest, as `finish` does.

        `about` are fields of a `Manifest`: process, cells, blocks, seconds.
        """

        def write(folder: Path) -> list[str]:
            if not (folder / ZARR).exists():
                join()
            return [ZARR]

        return self._finish(key, write, about)

    def has_group(self, key: str) -> bool:
        """Return whether the Zarr group of a study is whole."""
        return (self.folder(key) / ZARR).exists()

    def in_group(self, key: str, path: str = GROUP) -> Path:
        """Return where a key of the Zarr group of a study is, be the group whole or growing."""
        folder = self.folder(key) / ZARR
        if folder.exists():
            return folder / path
        return partial(folder) / (GROWING if path == GROUP else path)

    def _finish(
        self, key: str, write: Callable[[Path], list[str]], about: Mapping[str, Any]
    ) -> Manifest:
        """Have the files of a result written, unless it is there, and then its manifest."""
        with self._locked(key) as folder:
            known = self.manifest(key)
            if known is not None:
                self.drop_blocks(key)
                return known
            names = write(folder)
            files = {name: fingerprint(folder / name) for name in names}
            manifest = Manifest(key=key, version=core.__version__, files=files, **about)
            with _kept(folder / MANIFEST) as temporary:
                temporary.write_text(json.dumps(asdict(manifest), indent=1), encoding="utf-8")
            self.drop_blocks(key)
            return manifest

    @contextlib.contextmanager
    def _locked(self, key: str) -> Iterator[Path]:
        """Yield the folder of a study, which nobody else finishes meanwhile."""
        folder = self.folder(key)
        while True:
            descriptor = os.open(folder, os.O_RDONLY)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX)
                # The folder may have been removed, and made anew, while we waited.
                if os.path.samestat(os.fstat(descriptor), folder.stat()):
                    yield folder
                    return
            finally:
                os.close(descriptor)

    # --- housekeeping

    def studies(self) -> list[str]:
        """Return the identifiers of all studies, those that were used longest ago first."""
        found = []
        with contextlib.suppress(FileNotFoundError):
            for folder in self.directory.iterdir():
                if IDENTIFIER.fullmatch(folder.name):
                    found.append((self.used(folder.name), folder.name))
        return [key for _, key in sorted(found)]

    def used(self, key: str) -> float:
        """Return when a study was last used [s since the epoch], to an hour; 0 if it is gone."""
        folder = self.folder(key)
        # A study that is just being added has its folder only: it is in use, too.
        for path in (folder / "study.json", folder):
            with contextlib.suppress(FileNotFoundError):
                return path.stat().st_mtime
        return 0.0

    def bytes(self, key: str) -> int:
        """Return how much the files of a study take."""
        return sum(_sizes(self.folder(key)))

    def remove(self, key: str) -> None:
        """Remove a study and everything made from it; the manifest goes first."""
        folder = self.folder(key)
        (folder / MANIFEST).unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)

    def remove_leftovers(self, age: float = PARTS_KEPT) -> int:
        """Remove what killed writers have left; return how many files and folders.

        Parameters
        ----------
        age : float
            Only what was not changed for so long [s]; 0 where nobody else can be writing.
        """
        count, before = 0, time.time() - age
        for key in self.studies():
            for path in self.folder(key).rglob(f".*{PART}"):
                with contextlib.suppress(FileNotFoundError):
                    if age and path.stat().st_mtime > before:
                        continue
                    if path.is_dir():
                        shutil.rmtree(path)
                    else:
                        path.unlink()
                    count += 1
        return count

    def note_use(self, key: str) -> None:
        """Note that a study is used, so that it stays."""
        path = self.folder(key) / "study.json"
        with contextlib.suppress(OSError):  # a directory that is read-only can be read
            if time.time() - path.stat().st_mtime > USED_EVERY:
                os.utime(path)


@contextlib.contextmanager
def _kept(path: Path) -> Iterator[Path]:
    """As `whole`, and the name is on the disk too: a loss of power takes back nothing told."""
    with whole(path) as temporary:
        yield temporary
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def _sizes(folder: Path) -> Iterator[int]:
    for parent, _, names in os.walk(folder):
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                yield (Path(parent) / name).stat().st_size


def _not_own(key: str, found: Prepared | None) -> VibrafeedError:
    """Return why a study that is there is no sweep of this version."""
    if found is not None:
        of_another_process = identifier(found.study, "accuracy") == key
        if not isinstance(found, Sweep) or of_another_process:
            return _unknown(key)
    return OtherVersionError(
        f"The sweep '{key[:12]}...' was posted to another version of vibrafeed than "
        f"{core.__version__}, which gives other identifiers. POST its study again, to /sweeps."
    )


def _unknown(key: str) -> NotFoundError:
    return NotFoundError(f"There is no study '{key[:80]}'. POST it first.")
