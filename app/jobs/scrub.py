"""Looking through all results of a data directory for what is broken."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from vibrafeed.app.jobs.groups import LIST, read_list
from vibrafeed.app.jobs.integrity import has_digest
from vibrafeed.app.jobs.manifest import MANIFEST, ZARR, Manifest
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.studies import IDENTIFIER

WHOLE, BROKEN, ORPHANED, WAITING = "whole", "broken", "orphaned", "no result"
OURS = ("study.json", MANIFEST, LIST, "blocks")  # files of a study that no manifest lists


@dataclass(frozen=True)
class Damage:
    """The state of the folder of a study, as it was found on the disk.

    Attributes
    ----------
    name : str
        Of the folder: the study's identifier.
    state : str
        "whole"; "broken": a file of the result is not what was written; "orphaned": no study, or
        files that belong to no result; "no result": it is not computed, or not as a whole.
    bytes : int
        Bytes that were read.
    files : tuple of str
        The broken or orphaned files.
    """

    name: str
    state: str
    bytes: int = 0
    files: tuple[str, ...] = ()


def damages(store: Store, after: str = "", stopped: Callable[[], bool] = bool) -> Iterator[Damage]:
    """Check the files of all stored results, and yield the state of each study's folder.

    States are yielded for intact folders, too, in the order of names. Nothing is changed.

    Parameters
    ----------
    store : Store
        The data directory with the results.
    after : str
        Name of a folder; it and those before it are left out, to continue a check.
    stopped : callable
        Is asked now and then; True ends the check.
    """
    if not store.directory.exists():
        return
    for folder in sorted(store.directory.iterdir()):
        if stopped():
            return
        if folder.name > after:
            yield _look(store, folder, stopped)


def _look(store: Store, folder: Path, stopped: Callable[[], bool]) -> Damage:
    """Return the state of one folder of the store: whole, broken, orphaned, or without a result.

    All files of a result are compared with their digests. `stopped` is a function that returns True
    to end before all have been compared; the state is then that of the files looked at.
    """
    key = folder.name
    if not IDENTIFIER.fullmatch(key) or not (folder / "study.json").is_file():
        return Damage(key, ORPHANED, files=(".",))
    manifest = store.manifest_as_it_is(key)
    names = set() if manifest is None else set(manifest.files)
    try:
        others = {path.name for path in folder.iterdir() if not path.name.startswith(".")}
    except FileNotFoundError:  # it has just been removed
        return Damage(key, WAITING)
    orphans = tuple(sorted(others - names - set(OURS)))
    if manifest is None:
        if (folder / MANIFEST).exists():
            return Damage(key, BROKEN, files=(MANIFEST,))
        return Damage(key, ORPHANED if orphans else WAITING, files=orphans)
    size, broken = 0, []
    for name, path, digest in _files(store, folder, manifest):
        if stopped():
            break
        if digest is None or not has_digest(path, digest):
            broken.append(name)
        else:
            with contextlib.suppress(FileNotFoundError):  # it has just been removed
                size += path.stat().st_size
    if broken:
        # It may have been made anew, or removed, since its manifest was read.
        is_same = store.manifest_as_it_is(key) == manifest
        return Damage(key, BROKEN, size, tuple(broken)) if is_same else Damage(key, WAITING, size)
    return Damage(key, ORPHANED if orphans else WHOLE, size, orphans)


def _files(
    store: Store, folder: Path, manifest: Manifest
) -> Iterator[tuple[str, Path, str | None]]:
    """Yield name, path and expected SHA-256 of each file of a result, to check it for damage.

    For a Zarr group these are its list of digests and all files of the list. The digest is None
    where an earlier version stored none.

    Parameters
    ----------
    store : Store
        Not used.
    folder : Path
        The study's folder.
    manifest : Manifest
        Lists the files of the result.
    """
    for name, known in manifest.files.items():
        if name != ZARR:
            yield name, folder / name, known.get("sha256")
        elif "sha256" in known:  # groups of earlier versions have no digests
            yield LIST, folder / LIST, known["sha256"]
            for key, digest in read_list(folder).items():
                yield f"{ZARR}/{key}", folder / ZARR / key, digest
