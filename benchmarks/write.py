"""How fast results are written, beside the disk and beside xarray, in one run.

    python -m benchmarks.write [--folder FOLDER] [--gigabytes 2] [--runs 5]
    python -m benchmarks.write [--folder FOLDER] --long 20   # bytes, memory, kills of a large sweep

Tiles are computed beforehand, a few that differ, and then written again and again: what is measured
is writing. Every file is on the disk (fsync) before the clock stops. The large sweep is the command
line's own, computed and written; it is killed (-9) at five random moments.
"""

from __future__ import annotations

import hashlib
import os
import random
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.dataset.files import Behind, sync
from vibrafeed.core.dataset.growing import SYNC_BYTES
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plan.tiles import Tiled
from vibrafeed.core.sweep import Sweep
from vibrafeed.core.sweep.stream import outline_table
from vibrafeed.core.sweep.targets import open_target

DIFFERENT = 4  # tiles that are computed


def study(cells: float) -> dict[str, object]:
    """Return a study of seven axes with about `cells` cells."""
    frequencies = max(2, round(cells / (14 * 15 * 15 * 10 * 10 * 5)))
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": ["transport_velocity"],
        "parameters": {
            "frequency": {"start": 20, "stop": 120, "num": frequencies},
            "amplitude": {"start": 1e-4, "stop": 1e-3, "num": 14},
            "alpha": {"start": 0, "stop": 90, "num": 15},
            "beta": {"start": 0, "stop": 90, "num": 15},
            "gamma": {"start": 0, "stop": 10, "num": 10},
            "friction": {"start": 0.1, "stop": 0.6, "num": 10},
            "radius": {"start": 0.2, "stop": 1, "num": 5},
            "distance": 2e-4,
        },
    }


def raw(path: Path, size: int, behind: Behind | None = None) -> None:
    """Write so many bytes; with `behind`, wait for the disk in the background."""
    block = np.random.default_rng(0).bytes(32 * 2**20)
    with path.open("wb", buffering=0) as file:
        for start in range(0, size, len(block)):
            file.write(block[: size - start])
            if behind is not None and start % SYNC_BYTES == 0:
                behind.start(os.fdatasync, file.fileno())
        if behind is not None:
            behind.end()
        os.fsync(file.fileno())


def ours(path: Path, sweep: Sweep, tiles: list[dict[str, np.ndarray]], **options: bool) -> None:
    """Write tiles as the command line does, repeating a few."""
    target = open_target(path, sweep, outline_table(sweep), **options)
    by_shape = {one["regime"].shape: one for one in tiles}
    for index in target.missing:
        box = target.tiles[index].box
        shape = tuple(stop - start for start, stop in box)
        known = tiles[index % len(tiles)]
        if known["regime"].shape != shape:
            known = by_shape[shape]
        target.write(index, known, 0.0)
    target.finish({})
    target.close()


def table(runs: dict[str, list[float]], sizes: dict[str, int], base: str) -> None:
    """Print medians, spreads and ratios to a base."""
    reference = statistics.median(runs[base])
    for name, seconds in runs.items():
        middle = statistics.median(seconds)
        print(
            f"{name:36} {middle:8.2f} s  ({min(seconds):.2f} to {max(seconds):.2f})"
            f"  {sizes[name] / 1e9:6.2f} GB  {sizes[name] / middle / 1e6:7.0f} MB/s"
            f"  {middle / reference:6.2f} times {base}"
        )


def write(folder: Path, gigabytes: float, count: int) -> None:
    """Compare ways of writing one sweep."""
    sweep = prepare_content(study(gigabytes * 1e9 / 9))
    tiled = Tiled(sweep)
    shapes = {tuple(b - a for a, b in tile.box): tile for tile in tiled.tiles}
    some = [tiled.tiles[k] for k in range(0, len(tiled.tiles), -(-len(tiled.tiles) // DIFFERENT))]
    tiles = [tiled.values(tile) for tile in [*some, *shapes.values()]]
    padded = tiled.bytes / sweep.bytes
    print(f"{sweep.cells:,} cells, {len(tiled.tiles)} tiles, chunks padded to {padded:.3f}")

    def peer(path: Path) -> None:
        """Write the file by a library."""
        part.to_netcdf(path, engine="netcdf4", encoding=encoding)
        sync(path)

    # xarray takes long: a tenth of it, from memory; its seconds are scaled by the bytes.
    small = prepare_content(study(gigabytes * 1e9 / 90))
    part = tabulate(small).to_xarray()
    encoding = {n: {"zlib": True, "complevel": 1, "shuffle": True} for n in part.data_vars}
    scale = sweep.bytes / sum(part[n].nbytes for n in part.data_vars)
    behind = Behind()
    ways: dict[str, Callable[[Path], None]] = {
        "raw write": lambda path: raw(path, sweep.bytes),
        "raw write, synced behind": lambda path: raw(path, sweep.bytes, behind),
        "NetCDF --plain": lambda path: ours(path, sweep, tiles, compression=False),
        "NetCDF zlib + shuffle": lambda path: ours(path, sweep, tiles),
        "Zarr, blosc lz4": lambda path: ours(path, sweep, tiles),
        "xarray, zlib 1 (scaled)": peer,
    }
    runs: dict[str, list[float]] = {name: [] for name in ways}
    chance = random.Random(0)
    for _ in range(count):
        # A disk may be slow after one that wrote much: none comes always after the same.
        for name, way in chance.sample(list(ways.items()), len(ways)):
            path = folder / ("out.zarr" if "Zarr" in name else "out.nc")
            seconds = timed(way, path)[1]
            runs[name].append(seconds * (scale if way is peer else 1.0))
            stored = sum(p.stat().st_size for p in [path, *path.rglob("*")] if p.is_file())
            print(f"  {name}: {runs[name][-1]:.2f} s, {stored / 1e9:.3f} GB", flush=True)
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    sizes = dict.fromkeys(ways, sweep.bytes)
    base = min(list(ways)[:2], key=lambda name: statistics.median(runs[name]))
    table(runs, sizes, base)
    peers, packed = (statistics.median(runs[name]) for name in list(ways)[:2:-2])
    print(f"compressed: {peers / packed:.1f} times as fast as xarray's zlib 1")


def long(folder: Path, gigabytes: float) -> None:
    """Run one large sweep, then again with kills; compare bytes and print memory."""
    import json

    path = folder / "long.json"
    path.write_text(json.dumps(study(gigabytes * 1e9 / 9)))
    command = [sys.executable, "-m", "vibrafeed", "run", str(path), "--plain", "-o"]
    seconds = timed(subprocess.run, [*command, str(folder / "one.nc")], check=True)[1]
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    size = (folder / "one.nc").stat().st_size
    print(f"{size / 1e9:.1f} GB in {seconds:.0f} s; largest resident memory {memory:.2f} GB")
    expected = _fingerprint(folder / "one.nc")
    (folder / "one.nc").unlink()
    chance = random.Random(0)
    for kill in range(5):
        process = subprocess.Popen([*command, str(folder / "two.nc"), "--resume"])
        time.sleep(chance.uniform(0.1, 0.3) * seconds)
        process.kill()
        process.wait()
        journal = (folder / ".two.nc.partial" / "journal").read_bytes()
        print(f"kill {kill + 1}: {journal.count(bytes([10])) - 1} tiles")
    subprocess.run([*command, str(folder / "two.nc"), "--resume"], check=True)
    same = _fingerprint(folder / "two.nc") == expected
    print(f"after five kills: {'the same bytes' if same else 'OTHER BYTES'}")
    (folder / "two.nc").unlink()


def _fingerprint(path: Path) -> str:
    """Return a digest of a file without its times and cost."""
    import h5py

    with h5py.File(path, "r+") as file:
        for name in (b"history", b"elapsed_seconds", b"cells_per_second"):
            attribute = h5py.h5a.open(file.id, name)
            attribute.write(np.zeros(attribute.shape, attribute.dtype))
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def main() -> None:
    """Run the comparisons that the arguments name."""
    given = options(__doc__, folder=Path, gigabytes=2.0, runs=5, long=float)
    with tempfile.TemporaryDirectory(dir=given.folder) as name:
        if given.long is None:
            write(Path(name), given.gigabytes, given.runs)
        else:
            long(Path(name), given.long)


if __name__ == "__main__":
    main()
