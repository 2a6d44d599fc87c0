"""Studies and results on disk, addressed by content: equal studies share one folder.

A folder each, named by the study's identifier: ``study.json``; ``blocks/`` while it is computed;
``result.nc`` and, where it is small, ``result.json``, or ``result.zarr`` and a list of its digests;
last ``manifest.json``. A file appears
complete or not at all, and a result is there when its manifest is. Servers and workers use the same
folders; who finishes a study holds its lock, a file of its name in ``locks``.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import orjson
from filelock import FileLock

from vibrafeed.app.jobs.blocks import Blocks
from vibrafeed.app.jobs.groups import LIST, complete_list, files_of, read_list
from vibrafeed.app.jobs.integrity import Integrity
from vibrafeed.app.jobs.manifest import (
    JSON,
    MANIFEST,
    MAX_JSON_VALUES,
    NETCDF,
    ZARR,
    Making,
    Manifest,
    fingerprint,
)
from vibrafeed.core.code_version import code_version
from vibrafeed.core.dataset.document import to_document
from vibrafeed.core.dataset.files import PART, partial, whole
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.stores import GROUP
from vibrafeed.core.dataset.table import Table

logger = logging.getLogger("vibrafeed.store")

PARTS_KEPT = 3600.0  # s without a change, after which a temporary file counts as left over


class Store(Blocks):
    """Keeps studies and what is computed of them, below one directory.

    Threads and processes may use it at the same time.

    Attributes
    ----------
    integrity : Integrity
        Tells whether files of results are what was written.
    """

    def __init__(self, directory: Path):
        """Use a data directory."""
        super().__init__(directory)
        self.integrity = Integrity()

    def manifest(self, key: str) -> Manifest | None:
        """Return the manifest of a result if the result is complete, and note its use.

        The manifest lists the files of a result with their sizes [bytes] and SHA-256 digests. `key`
        is the study's identifier. None if there is no result, or if one of its files is missing or
        has another size. Results that have not been used for long are removed when room is needed.
        """
        manifest = self._manifest(key)
        if manifest is not None:
            self.note_use(key)
        return manifest

    def _manifest(self, key: str) -> Manifest | None:
        """Return the manifest of a result if all its files exist with their sizes; else None.

        `key` is the study's identifier; the manifest lists the files of a complete result. Unlike
        `manifest`, this does not count as a use of the study.
        """
        folder = self.folder(key)
        try:
            manifest = Manifest(**json.loads((folder / MANIFEST).read_bytes()))
            broken = [name for name in manifest.files if not _has_size(folder, name, manifest)]
        except FileNotFoundError:
            return None
        except (ValueError, TypeError, KeyError, AttributeError):
            logger.warning("a manifest cannot be read: %s", key)  # the result is made again
            return None
        if broken:
            logger.warning("a result is cut or gone: %s of %s", ", ".join(broken), key)
            return None
        return manifest

    def digest(self, key: str, name: str, manifest: Manifest) -> str | None:
        """Return the SHA-256 of a file of a result; None if it is unknown.

        `key` is the study's identifier, `name` the file's name or its path in the Zarr group.
        Groups that earlier versions wrote have no digests.
        """
        if name in manifest.files:
            return manifest.files[name].get("sha256")
        return read_list(self.folder(key)).get(name)

    def remove_file(self, key: str, path: Path, status: os.stat_result | None = None) -> None:
        """Remove a result with a damaged file, its manifest first, so that it is computed again.

        Parameters
        ----------
        key : str
            Identifier of the study.
        path : Path
            The damaged file.
        status : stat_result, optional
            The file that was found damaged; if another has taken its place meanwhile, nothing is
            removed.
        """
        with contextlib.suppress(FileNotFoundError), self._locked(key) as folder:
            if status is not None and path.exists() and not os.path.samestat(status, path.stat()):
                return
            logger.warning("a broken result is taken away: %s of %s", path.name, key)
            (folder / MANIFEST).unlink(missing_ok=True)
            (folder / LIST).unlink(missing_ok=True)
            if (folder / ZARR).exists():
                with tempfile.TemporaryDirectory(prefix=".", suffix=PART, dir=folder) as scratch:
                    (folder / ZARR).replace(Path(scratch) / ZARR)  # never half of it
            if path.is_file() and path.parent == folder:
                path.unlink()

    def finish(
        self,
        key: str,
        table: Table,
        *,
        process: str,
        cells: int,
        blocks: int,
        seconds: float,
        write_more: Callable[[Path, Path], Iterable[Path]] | None = None,
    ) -> Manifest:
        """Write a result from its table, then its manifest; remove its blocks. Return the manifest.

        A result that another process has finished meanwhile stays.

        Parameters
        ----------
        key, process : str
            The study's identifier, and the process that computed it.
        table : Table
            The result.
        cells, blocks : int
            Cells of the study, and number of blocks that they were computed in.
        seconds : float
            Computing time [s], summed over workers.
        write_more : callable, optional
            Called with the NetCDF file and a folder; writes further files there and returns their
            paths.
        """

        def write(folder: Path) -> list[str]:
            """Write the NetCDF file, the JSON document and further files; return their names.

            The JSON document is written only if the result has at most a million values.
            """
            write_netcdf(table, folder / NETCDF)
            names = [NETCDF]
            values = sum(variable.values.size for variable in table.variables.values())
            if values <= MAX_JSON_VALUES:
                document = to_document(table.with_price({}))
                with whole(folder / JSON) as temporary:
                    temporary.write_bytes(orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY))
                names.append(JSON)
            if write_more is not None:
                with tempfile.TemporaryDirectory(prefix=".", suffix=PART, dir=folder) as scratch:
                    for path in write_more(folder / NETCDF, Path(scratch)):
                        with whole(folder / path.name) as temporary:
                            path.replace(temporary)
                        names.append(path.name)
            return names

        return self._finish(key, write, Making(process, cells, blocks, seconds))

    def finish_group(self, key: str, finish: Callable[[], object], making: Making) -> Manifest:
        """Complete a Zarr group, then write the manifest of the group and return it.

        Parameters
        ----------
        key : str
            Identifier of the study.
        finish : callable
            Completes the group.
        making : Making
            Process, cells, blocks and computing time of the result.
        """

        def write(folder: Path) -> list[str]:
            if not (folder / ZARR).exists():
                finish()
            complete_list(folder)
            return [ZARR]

        return self._finish(key, write, making)

    def has_group(self, key: str) -> bool:
        """True if the result of a study exists as a complete Zarr group in the data directory.

        `key` is the study's identifier. A group without the metadata file at its root is
        incomplete, as that file is written last; it is removed.
        """
        group = self.folder(key) / ZARR
        if group.exists() and not (group / GROUP).is_file():
            self.remove_file(key, group)
        return group.exists()

    def in_group(self, key: str, path: str = GROUP) -> Path:
        """Return the path of a file in the Zarr group of a study, complete or still growing.

        `key` is the study's identifier, `path` the file's path in the group, by default the group's
        own document.
        """
        group = self.folder(key) / ZARR
        return (group if group.exists() else partial(group)) / path

    def _finish(self, key: str, write: Callable[[Path], list[str]], making: Making) -> Manifest:
        """Write the files of a result and then its manifest, which makes the result complete.

        If the result exists, its manifest is returned, and nothing is written. Stored blocks of the
        computation are removed in both cases.

        Parameters
        ----------
        key : str
            The study's identifier.
        write : callable
            Gets the study's folder, locked meanwhile, writes the files and returns their names.
        making : Making
            Facts for the manifest on the computation, such as its time.
        """
        with self._locked(key) as folder:
            existing = self.manifest(key)
            if existing is not None:
                self.drop_blocks(key)
                return existing
            names = write(folder)
            files = {name: _manifest_entry(folder, name) for name in names}
            manifest = Manifest(key=key, version=code_version(), files=files, **asdict(making))
            with whole(folder / MANIFEST) as temporary:
                temporary.write_text(json.dumps(asdict(manifest), indent=1), encoding="utf-8")
            self.drop_blocks(key)
            return manifest

    @contextlib.contextmanager
    def _locked(self, key: str) -> Iterator[Path]:
        """Yield the folder of a study, locked so that only one process completes its result.

        `key` is the study's identifier. The lock ends with the block.

        Raises
        ------
        FileNotFoundError
            If the folder has been removed.
        """
        folder = self.folder(key)
        lock = self._lock_file(key)
        lock.parent.mkdir(exist_ok=True)
        with FileLock(lock):
            folder.stat()  # it may have been removed while we waited
            yield folder

    def _lock_file(self, key: str) -> Path:
        """Return the file whose lock is a study's; not in its folder, which is then in use."""
        return self.directory.parent / "locks" / key

    # --- housekeeping

    def drop_blocks(self, key: str) -> None:
        """Remove what the computation of a result has stored on its way, if the result is complete.

        That are blocks, parts and an unfinished Zarr group, which a late worker may have left.
        `key` is the study's identifier.
        """
        if self._manifest(key) is not None:
            folder = self.folder(key)
            shutil.rmtree(folder / "blocks", ignore_errors=True)
            shutil.rmtree(partial(folder / ZARR), ignore_errors=True)

    def bytes(self, key: str) -> int:
        """Return the bytes of all files of a study, except of those that vanish meanwhile."""
        size = 0
        for parent, _, names in os.walk(self.folder(key)):
            for name in names:
                with contextlib.suppress(FileNotFoundError):
                    size += (Path(parent) / name).stat().st_size
        return size

    def remove(self, key: str) -> None:
        """Remove a study and all its files, the manifest first."""
        folder = self.folder(key)
        (folder / MANIFEST).unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)
        with contextlib.suppress(OSError):  # it is held, or the folder of studies is not there
            self._lock_file(key).unlink()

    def remove_leftovers(self, age: float = PARTS_KEPT) -> int:
        """Remove temporary files that killed writers left; return the number of those removed.

        Parameters
        ----------
        age : float
            Only those that have not been changed for this time [s]; 0 where no other process can be
            writing.
        """
        count, before = 0, time.time() - age
        for key in self.studies():
            for path in self.folder(key).rglob(f".*{PART}"):
                with contextlib.suppress(OSError):  # gone, or open in another process
                    if age and path.stat().st_mtime > before:
                        continue
                    if path.is_dir():
                        shutil.rmtree(path)
                    else:
                        path.unlink()
                    count += 1
        return count


def _manifest_entry(folder: Path, name: str) -> dict[str, Any]:
    """Return size and SHA-256 of a file of a result, as its manifest records them.

    For a Zarr group the size is that of all its files, and the digest that of their list of
    digests. `folder` is the study's; `name` is that of the file or group in it.
    """
    if name != ZARR:
        return fingerprint(folder / name)
    size = sum(path.stat().st_size for _, path in files_of(folder / ZARR))
    return {**fingerprint(folder / LIST), "bytes": size}


def _has_size(folder: Path, name: str, manifest: Manifest) -> bool:
    """True if a file of a result exists with its size; of a Zarr group, if its documents exist.

    `folder` is the study's, `name` the file's; `manifest` has the sizes.
    """
    if name == ZARR:
        has_list = "sha256" not in manifest.files[name] or (folder / LIST).is_file()
        return has_list and (folder / ZARR / GROUP).is_file()
    try:
        return (folder / name).stat().st_size == manifest.files[name]["bytes"]
    except FileNotFoundError:
        return False
