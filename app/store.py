"""Studies and results on disk, addressed by content: equal studies share one folder.

A folder each, named by the study's identifier: ``study.json``; ``blocks/`` while it is computed;
``result.nc`` and, where it is small, ``result.json``; last ``manifest.json``. A file appears
complete or not at all, and a result is there when its manifest is. Servers and workers use the same
folders.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import re
import shutil
import time
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import orjson

import core
from app.exceptions import NotFoundError, TornBlockError
from core.dataset.document import to_document
from core.dataset.netcdf import write_netcdf
from core.dataset.table import Table
from core.kinds import prepare_content
from core.study.load import read_json
from core.study.models import Study
from core.sweep import Sweep
from core.sweep.pieces import Computed
from core.sweep.prepare import Prepared

IDENTIFIER = re.compile(r"[0-9a-f]{64}")
NETCDF, JSON = "result.nc", "result.json"
MOST_JSON_VALUES = 1_000_000  # of a result that is also kept as JSON: some 20 MB
USED_EVERY = 3600.0  # s; the use of a study is noted no more often
_NOTES = "notes"


@dataclass(frozen=True)
class Manifest:
    """What is known of a result.

    Attributes
    ----------
    key, process, version : str
        Its identifier, the process that made it, the version of vibrafeed.
    cells, blocks : int
        Points of the grid, and pieces that they were computed in.
    seconds : float
        Time that computing took, summed over all workers.
    files : mapping
        Size in bytes and SHA-256 of each file.
    """

    key: str
    process: str
    version: str
    cells: int
    blocks: int
    seconds: float
    files: Mapping[str, Mapping[str, Any]]


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

    def add(self, study: Study, process: str | None = None) -> tuple[str, bool]:
        """Keep a study; return its identifier, and whether it is new."""
        key = identifier(study, process)
        path = self.directory / key / "study.json"
        if path.exists():
            self._note_use(path)
            return key, False
        path.parent.mkdir(parents=True, exist_ok=True)
        with _whole(path) as temporary:
            temporary.write_text(study.canonical(), encoding="utf-8")
        return key, True

    def get(self, key: str) -> Prepared:
        """Return the study of an identifier; raise `NotFoundError` if there is none."""
        path = self.folder(key) / "study.json"
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            raise _unknown(key) from None
        self._note_use(path)
        return prepare_content(read_json(content))

    def sweep(self, key: str) -> Sweep:
        """Return the sweep of an identifier; raise `NotFoundError` if it is none."""
        found = self.get(key)
        if not isinstance(found, Sweep) or identifier(found.study) != key:
            raise _unknown(key)
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
        path.parent.mkdir(parents=True, exist_ok=True)
        notes = np.frombuffer(json.dumps(dict(computed.notes)).encode(), np.uint8)
        with _whole(path) as temporary, temporary.open("wb") as file:
            np.savez(file, allow_pickle=False, **{_NOTES: notes}, **computed.arrays)

    def read_block(self, key: str, cells: int, index: int) -> Computed:
        """Return what was computed of a piece; raise `TornBlockError` if it cannot be read."""
        path = self._block(key, cells, index)
        try:
            with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as file:
                arrays = dict(file)
            notes = json.loads(arrays.pop(_NOTES).tobytes())
        except (FileNotFoundError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
            path.unlink(missing_ok=True)
            raise TornBlockError(f"block {index} of {key} cannot be read: {error}") from error
        return Computed(arrays, notes)

    def _block(self, key: str, cells: int, index: int) -> Path:
        # Blocks of another size, left by a job that was given up, are never taken for these.
        return self.folder(key) / "blocks" / str(cells) / f"{index:06d}.npz"

    # --- results

    def manifest(self, key: str) -> Manifest | None:
        """Return what is known of a result; None while there is none."""
        try:
            content = (self.folder(key) / "manifest.json").read_bytes()
        except FileNotFoundError:
            return None
        return Manifest(**json.loads(content))

    def finish(
        self,
        key: str,
        table: Table,
        *,
        process: str,
        cells: int,
        blocks: int,
        seconds: float,
        more: Callable[[Path], Iterable[str]] | None = None,
    ) -> Manifest:
        """Write a result and, last, its manifest; its blocks are needed no more.

        `more` writes further files into the folder, beside the NetCDF file, and returns their
        names.
        """
        folder = self.folder(key)
        write_netcdf(table, folder / NETCDF)
        files = {NETCDF: _fingerprint(folder / NETCDF)}
        if sum(variable.values.size for variable in table.variables.values()) <= MOST_JSON_VALUES:
            content = orjson.dumps(
                to_document(table.with_price({})), option=orjson.OPT_SERIALIZE_NUMPY
            )
            with _whole(folder / JSON) as temporary:
                temporary.write_bytes(content)
            files[JSON] = _fingerprint(folder / JSON)
        for name in more(folder) if more is not None else ():
            files[name] = _fingerprint(folder / name)
        manifest = Manifest(key, process, core.__version__, cells, blocks, seconds, files)
        with _whole(folder / "manifest.json") as temporary:
            temporary.write_text(json.dumps(asdict(manifest), indent=1), encoding="utf-8")
        shutil.rmtree(folder / "blocks", ignore_errors=True)
        return manifest

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

    def bytes(self, key: str | None = None) -> int:
        """Return how much the files of a study take, or those of all."""
        folder = self.directory if key is None else self.folder(key)
        return sum(_sizes(folder))

    def remove(self, key: str) -> None:
        """Remove a study and everything made from it; the manifest goes first."""
        folder = self.folder(key)
        (folder / "manifest.json").unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)

    def sweep_up(self, keys: Iterable[str] | None = None) -> int:
        """Remove what writers that were killed have left; return how many files.

        Only for studies that nobody else is writing.
        """
        count = 0
        for key in self.studies() if keys is None else keys:
            for path in self.folder(key).rglob(".*.part"):
                path.unlink(missing_ok=True)
                count += 1
        return count

    def _note_use(self, path: Path) -> None:
        with contextlib.suppress(OSError):  # a directory that is read-only can be read
            if time.time() - path.stat().st_mtime > USED_EVERY:
                os.utime(path)


@contextlib.contextmanager
def _whole(path: Path) -> Iterator[Path]:
    """Yield a temporary name; what stands there takes its place when the block ends well."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.{time.monotonic_ns()}.part")
    try:
        yield temporary
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
        # The name is on the disk too: a loss of power takes back nothing that was told.
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
    finally:
        temporary.unlink(missing_ok=True)


def _fingerprint(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    return {"bytes": path.stat().st_size, "sha256": digest}


def _sizes(folder: Path) -> Iterator[int]:
    for parent, _, names in os.walk(folder):
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                yield (Path(parent) / name).stat().st_size


def _unknown(key: str) -> NotFoundError:
    return NotFoundError(f"There is no study '{key[:80]}'. POST it first.")
