"""Work that takes a while, and disks that are full, read-only or gone."""

import contextlib
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import SELDOM, wait_for


def simulation(number: int, size: int = 51) -> dict[str, Any]:
    """Return one of many studies of some seconds, in some tens of blocks."""
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity", "flight_fraction"],
        "parameters": {
            "frequency": 40 + number,
            "amplitude": {"start": "0.05 mm", "stop": "0.75 mm", "num": size},
            "beta": {"start": 5, "stop": 60, "num": size},
            "friction": 0.4,
            "restitution": 0.3,
        },
    }


def small(frequency: float = 50, **parameters: Any) -> dict[str, Any]:
    """Return one of many studies of a cell."""
    cell = {"amplitude": "0.2 mm", "beta": 30, "friction": 0.4, **parameters}
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "parameters": {"frequency": frequency, **cell},
    }


def expected(study: dict[str, Any], path: Path) -> bytes:
    """Return the file of a study as this process writes it."""
    write_netcdf(tabulate(prepare_content(study)), path)
    return path.read_bytes()


def mounts(*arguments: str | Path) -> bool:
    return subprocess.run(["mount", *arguments], capture_output=True).returncode == 0


@contextlib.contextmanager
def small_disk(folder: Path, megabytes: int) -> Iterator[None]:
    """Mount a small disk in memory; skip where one may not."""
    folder.mkdir()
    size = f"size={megabytes}m"
    if not shutil.which("mount") or not mounts("-t", "tmpfs", "-o", size, "none", folder):
        pytest.skip("no disk can be mounted")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def fill(folder: Path) -> Path:
    """Fill a small disk; return the file that does."""
    filler = folder / "filler"
    with contextlib.suppress(OSError):
        filler.write_bytes(bytes(10_000_000))
    return filler


@contextlib.contextmanager
def read_only(folder: Path) -> Iterator[None]:
    """Have a read-only view of a disk in its place: the disk itself is in use."""
    assert mounts("--bind", folder, folder)
    assert mounts("-o", "remount,bind,ro", folder)
    unmount = ["umount", folder]  # which a request may still be reading from
    try:
        yield
    finally:
        wait_for(lambda: subprocess.run(unmount, capture_output=True).returncode == 0, every=SELDOM)
