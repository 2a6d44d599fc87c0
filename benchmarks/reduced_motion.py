"""What answers in place of motions cost, over storing them; `python -m benchmarks.reduced_motion`.

A block on a plane without rebound, over frequency, amplitude, angle and friction: the highest speed
over angles, the share of designs that hop, a level, the mean and the regimes. Each way in a process
of its own: seconds by the clock and of the processor, and the most memory, over that of a program
that has followed one cell. Then the answers are compared with xarray's of the stored file.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray

from benchmarks.options import options
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

SPEED = "conveying_velocity"
STORED, REDUCED = "stored", "reduced"


def study(cells: int) -> dict[str, Any]:
    """Return a study of about `cells` cells."""
    each = max(2, round((cells / 20) ** 0.5))
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": [SPEED, "flight_fraction"],
        "parameters": {
            "frequency": [40, 45, 50, 55, 60],
            "amplitude": {"start": "0.05 mm", "stop": "0.6 mm", "num": each},
            "beta": {"start": 5, "stop": 60, "num": each},
            "friction": [0.2, 0.3, 0.4, 0.5],
        },
    }


ASKED = {
    "over": ["amplitude", "beta"],
    "statistics": ["max", "argmax", "mean"],
    "regimes": True,
    "shares": {"hops": ["flight_fraction > 0"]},
    "levels": {"reach": {"output": SPEED, "level": "100 mm/s", "along": "amplitude"}},
}


def run(way: str, cells: int, where: str) -> None:
    """Run a study in this process, and print time and memory."""
    tabulate(prepare_content(study(20)))  # loads what is compiled
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    content = study(cells) if way == STORED else {**study(cells), "reduce": ASKED}
    started, worked = time.perf_counter(), time.process_time()
    tabulate(prepare_content(content)).to_xarray().to_netcdf(where)
    taken = time.perf_counter() - started, time.process_time() - worked
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps([*taken, (most - before) / 1024, Path(where).stat().st_size / 1e6]))


def main() -> None:
    """Print both ways, and whether their results agree."""
    given = options(
        __doc__, cells=(2_000_000, "cells, about"), way=("", "of one process"), where=("", "a file")
    )
    if given.way:
        run(given.way, given.cells, given.where)
        return
    with TemporaryDirectory() as folder:
        found = {}
        for way in (STORED, REDUCED):
            where = str(Path(folder) / f"{way}.nc")
            command = [sys.executable, "-m", "benchmarks.reduced_motion", "--way", way]
            command += ["--cells", str(given.cells), "--where", where]
            printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            clock, worked, memory, file = json.loads(printed.splitlines()[-1])
            found[way] = worked
            print(
                f"{way:8} {clock:6.1f} s, {worked:6.1f} s of the processor, {memory:6.0f} MiB "
                f"more, file {file:.3f} MB"
            )
        print(f"reduced over stored: {found[REDUCED] / found[STORED]:.2f} of the processor's time")
        cells = xarray.open_dataset(Path(folder) / f"{STORED}.nc")
        answers = xarray.open_dataset(Path(folder) / f"{REDUCED}.nc")
        want = cells[SPEED].max(ASKED["over"]).transpose(*answers[f"{SPEED}_max"].dims)
        hops = (cells["flight_fraction"] > 0).mean(ASKED["over"])
        print("same largest:", np.array_equal(want, answers[f"{SPEED}_max"]))
        print("same share that hops:", np.array_equal(hops, answers["share_hops"]))


if __name__ == "__main__":
    main()
