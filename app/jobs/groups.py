"""The digests of the files of a Zarr group, in a list beside it as ``sha256sum`` reads it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from vibrafeed.app.jobs.manifest import ZARR
from vibrafeed.core.dataset.files import whole

LIST = f"{ZARR}.sha256"
KEPT = 8  # lists that are cached in memory; one of 100,000 chunks takes some 20 MB


def write_list(folder: Path, digests: Mapping[str, str]) -> None:
    """Write the file that lists the digests of a study's Zarr group, as `sha256sum` reads it.

    `folder` is the study's folder; `digests` holds the SHA-256 of each file by its path in the
    group.
    """
    lines = (f"{digest}  {ZARR}/{key}\n" for key, digest in sorted(digests.items()))
    with whole(folder / LIST) as temporary:
        temporary.write_text("".join(lines), encoding="ascii", newline="\n")


def complete_list(folder: Path) -> None:
    """Add files that are in a Zarr group and missing in its list of digests, such as documents.

    `folder` is the study's folder; the digests of the missing files are computed.
    """
    digests = dict(read_list(folder))
    for key, path in files_of(folder / ZARR):
        if key not in digests:
            with path.open("rb") as file:
                digests[key] = hashlib.file_digest(file, "sha256").hexdigest()
    write_list(folder, digests)


def read_list(folder: Path) -> Mapping[str, str]:
    """Return the SHA-256 of each file in a study's Zarr group by its path; empty without a list.

    `folder` is the study's folder. A list that has not changed is read from the cache.
    """
    path = folder / LIST
    try:
        status = path.stat()
    except FileNotFoundError:
        return {}
    return _read(path, status.st_ino, status.st_size, status.st_mtime_ns)


@lru_cache(maxsize=KEPT)
def _read(path: Path, *changes: int) -> Mapping[str, str]:
    """Return the SHA-256 of each file from a list of digests, by its path in the group.

    `path` is the list's; `changes` (inode, size, time of change) only make the cache read it again
    after a change.
    """
    lines = path.read_text(encoding="ascii", errors="replace").splitlines()
    pairs = (line.split("  ", 1) for line in lines)
    return {pair[1].removeprefix(f"{ZARR}/"): pair[0] for pair in pairs if len(pair) > 1}


def files_of(group: Path) -> Iterator[tuple[str, Path]]:
    """Yield every file in a Zarr group, sorted: path within the group as text, and full path."""
    for path in sorted(group.rglob("*")):
        if path.is_file():
            yield path.relative_to(group).as_posix(), path
