"""The files of a result, and what is known of them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

NETCDF, ZARR, JSON = "result.nc", "result.zarr", "result.json"
MANIFEST = "manifest.json"
MAX_JSON_VALUES = 1_000_000  # of a result that is also kept as JSON: some 20 MB


@dataclass(frozen=True)
class Making:
    """The making of a result: process, cells of the study, blocks, and computing time [s]."""

    process: str
    cells: int
    blocks: int
    seconds: float


@dataclass(frozen=True)
class Manifest:
    """The manifest of a result.

    Attributes
    ----------
    key, process, version : str
        Its identifier, the process that made it, the version of vibrafeed and of its
        code.
    cells, blocks : int
        Points of the grid, and pieces that they were computed in.
    seconds : float
        Time that computing took, summed over all workers.
    files : mapping
        Size in bytes and SHA-256 of each file; of a group the SHA-256 of the list of its digests.
    """

    key: str
    process: str
    version: str
    cells: int
    blocks: int
    seconds: float
    files: Mapping[str, Mapping[str, Any]]


def fingerprint(path: Path) -> dict[str, Any]:
    """Return the size [bytes] and SHA-256 of a file, as entries of a manifest."""
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    return {"bytes": path.stat().st_size, "sha256": digest}
