"""Sweeps on disk, addressed by content: equal studies share one identifier and one file."""

from __future__ import annotations

import hashlib
import os
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import core
from app.errors import NotFoundError
from core.dataset.netcdf import write_netcdf
from core.study import SweepStudy
from core.study.load import read_json
from core.sweep import Sweep, prepare_content, tabulate

IDENTIFIER = re.compile(r"[0-9a-f]{64}")


def identifier(study: SweepStudy) -> str:
    """Return the SHA-256 of the study and of the version of the equations."""
    return hashlib.sha256(f"{core.__version__} {study.canonical()}".encode()).hexdigest()


class SweepStore:
    """Keeps studies and the files made from them.

    A folder each: ``study.json`` and, once asked for, ``result.nc``. Both appear complete or not
    at all.
    """

    def __init__(self, directory: Path):
        self.directory = directory / "sweeps"
        # The NetCDF library belongs to this one thread: it crashes if two of a process use it.
        self._writer = ThreadPoolExecutor(max_workers=1, thread_name_prefix="netcdf")

    def add(self, study: SweepStudy) -> tuple[str, bool]:
        """Keep a study; return its identifier, and whether it is new."""
        key = identifier(study)
        path = self.directory / key / "study.json"
        if path.exists():
            return key, False
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = path.with_name(f".study.{os.getpid()}.part")
        with temporary.open("w", encoding="utf-8") as file:
            file.write(study.canonical())
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
        return key, True

    def get(self, key: str) -> Sweep:
        """Return the sweep of an identifier; raise `NotFoundError` if there is none."""
        # Only what looks like an identifier reaches the file system.
        path = self.directory / key / "study.json"
        if not IDENTIFIER.fullmatch(key) or not path.is_file():
            raise NotFoundError(f"There is no sweep '{key[:80]}'. POST its study to /sweeps first.")
        return prepare_content(read_json(path.read_bytes()))

    def netcdf(self, key: str, sweep: Sweep) -> Path:
        """Return the NetCDF file of the sweep of an identifier; the first call writes it.

        A file that is there is complete: it does not wait for what is being written.
        """
        path = self.directory / key / "result.nc"
        if not path.exists():
            self._writer.submit(_write_once, sweep, path).result()
        return path

    def close(self) -> None:
        """Finish the write under way, and take no more."""
        self._writer.shutdown()


def _write_once(sweep: Sweep, path: Path) -> None:
    if not path.exists():
        write_netcdf(tabulate(sweep), path)
