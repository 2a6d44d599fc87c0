"""A sweep too large for one file, stored by the service and read while it grows.

    python -m benchmarks.growing_result [--cells 1e9] [--reads 200]

A job of the service stores the sweep as a Zarr group on two workers. Meanwhile a client reads one
random box after another over HTTP and compares each value that is there with the core's own,
computed for that box alone; after the end it reads as many boxes again, which have to be complete.
Printed are the time and the pace of storing, how long a box took to read while it grew and after,
the memory of the server, and the bytes on the disk. Exits with 1 if a value differs.
"""

from __future__ import annotations

import random
import sys
import time
from statistics import median
from typing import Any

import numpy as np
import xarray
from obstore.store import HTTPStore
from zarr.storage import ObjectStore

from benchmarks.options import options
from benchmarks.reduce import SPANS, SPEED, study
from benchmarks.serving import Served, percentile, served
from benchmarks.timing import timed
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

BOX = 5  # values along each axis at most: some 10^4 cells, of many chunks
ENDED = ("successful", "failed", "dismissed")


class Reader:
    """Reads random boxes of a growing group and compares them."""

    def __init__(self, address: str, content: dict[str, Any]):
        self._address = address
        self._prepared = prepare_content(content)
        self._sizes = {name: content["parameters"][name]["num"] for name in SPANS}
        self._random = random.Random(36)
        self.differences = 0

    def read(self) -> tuple[float, float]:
        """Read one box; return its seconds and the share of its cells that were stored."""
        box = {}
        for name, size in self._sizes.items():
            start = self._random.randrange(size)
            box[name] = (start, min(start + BOX, size))
        cut = {name: slice(*ends) for name, ends in box.items()}
        got, seconds = timed(lambda: self._group()[[SPEED, "regime"]].isel(cut).load())
        want = tabulate(self._prepared.within(box)).to_xarray()
        stored = got["regime"].values != 0
        same = (got[SPEED].values == want[SPEED].values) | np.isnan(want[SPEED].values)
        same &= got["regime"].values == want["regime"].values
        self.differences += int((stored & ~same).sum())
        return seconds, float(stored.mean())

    def _group(self) -> xarray.Dataset:
        """Open the group, whose chunks are read when they are asked for."""
        files = HTTPStore.from_url(self._address, client_options={"allow_http": True})
        return xarray.open_zarr(ObjectStore(files, read_only=True), chunks=None)


def figures(name: str, boxes: list[tuple[float, float]]) -> str:
    """Return a line of how long boxes took, and how much of them was there."""
    seconds = [one for one, _ in boxes]
    return (
        f"{name}: {len(boxes)} boxes, {median(seconds) * 1e3:.0f} ms, of ten the slowest "
        f"{percentile(seconds, 0.9) * 1e3:.0f} ms, at most {max(seconds) * 1e3:.0f} ms; "
        f"{np.mean([share for _, share in boxes]):.0%} of their cells there"
    )


def stored(server: Served, content: dict[str, Any], reads: int) -> int:
    """Store the sweep, read it meanwhile and afterwards; return how many values differed."""
    started = time.perf_counter()
    number = server.post_job("sweep", content)
    while server.get(f"/jobs/{number}")["status"] == "accepted":
        time.sleep(0.1)
    reader = Reader(f"{server.address}/jobs/{number}/results/zarr", content)
    growing, memory = [], server.memory()
    while (job := server.get(f"/jobs/{number}"))["status"] not in ENDED:
        growing.append(reader.read())
        memory = max(memory, server.memory())
    took = time.perf_counter() - started
    if job["status"] != "successful":
        sys.exit(f"the job ended as {job['status']}: {job['message']}")
    size = sum(path.stat().st_size for path in server.data.rglob("*") if path.is_file())
    cells = job["cells"]
    print(f"{cells:,} cells stored in {took:.1f} s, {took / cells * 1e9:.1f} ns a cell, "
          f"{size / took / 1e6:.0f} MB/s; {size / 1e9:.2f} GB on the disk")  # fmt: skip
    print(figures("while it grew", growing))
    after = [reader.read() for _ in range(reads)]
    print(figures("after its end", after))
    print(f"memory of the server at most {max(memory, server.memory()) / 2**20:.0f} MiB")
    incomplete = sum(share < 1 for _, share in after)
    print(f"values that differ: {reader.differences}; incomplete boxes at the end: {incomplete}")
    return reader.differences + incomplete


def main() -> None:
    """Print the figures."""
    asked = options(__doc__, cells=1e9, reads=200)
    content = {key: value for key, value in study(asked.cells, {}).items() if key != "reduce"}
    with served(workers=2, max_cells=1_000_000) as server:
        sys.exit(stored(server, content, asked.reads) > 0)


if __name__ == "__main__":
    main()
