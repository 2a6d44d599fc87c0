"""What a slice costs that is evaluated when it is read, beside the same slice from stored files.

    python -m benchmarks.on_read [--cells 2e7] [--runs 9]

Each slice keeps two axes of a sweep and one value of the others. Its limit is the evaluation of its
cells alone, in the process. Files are in the system's cache, which is the best that they can have.
"""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray

from benchmarks.options import options
from benchmarks.timing import in_turns
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.sweep import Sweep
from vibrafeed.core.sweep.lazy import open_lazily
from vibrafeed.core.sweep.stream import outline_table, stream
from vibrafeed.core.sweep.targets import open_target

OUTPUT = "transport_velocity"


def study(cells: float) -> dict[str, object]:
    """Return a study of four axes with about `cells` cells."""
    each = max(2, round(cells ** (1 / 4)))
    ends = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 90), "beta": (0, 90)}
    axes = {name: {"start": a, "stop": b, "num": each} for name, (a, b) in ends.items()}
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": [OUTPUT],
        "parameters": {**axes, "friction": 0.3, "radius": 0.8, "distance": 2e-4},
    }


def stored(sweep: Sweep, path: Path) -> Path:
    """Write a sweep as the command line does; return its path."""
    target = open_target(path, sweep, outline_table(sweep))
    try:
        stream(sweep, target)
    finally:
        target.close()
    return path


def median(work: Callable[[], object], runs: int) -> tuple[float, float, float]:
    """Return median, least and largest time of a warm function [s]."""
    work()
    (seconds,) = in_turns(runs, work)
    return statistics.median(seconds), min(seconds), max(seconds)


def main() -> None:
    """Print the table."""
    asked = options(__doc__, cells=2e7, runs=9)
    content = study(asked.cells)
    sweep = prepare_content(content)
    shape = sweep.grid.shape
    print(f"{sweep.cells:,} cells, {shape}; slices of two axes")
    with tempfile.TemporaryDirectory() as folder:
        groups = {
            "evaluated on read": open_lazily(sweep),
            "Zarr, shards": xarray.open_zarr(stored(sweep, Path(folder) / "a.zarr"), chunks=None),
            "NetCDF": xarray.open_dataset(stored(sweep, Path(folder) / "a.nc")),
        }
        for kept in (("alpha", "beta"), ("frequency", "beta"), ("frequency", "amplitude")):
            at = {name: size // 3 for name, size in shape.items() if name not in kept}
            box = {
                name: (at.get(name, 0), at.get(name, size - 1) + 1) for name, size in shape.items()
            }
            plan = sweep.plan.only(OUTPUT)
            grid = sweep.grid.piece(box, plan.parameters)
            limit = median(lambda plan=plan, grid=grid: evaluate(plan, grid), asked.runs)
            print(f"{' x '.join(kept)}: {grid.cells:,} cells, evaluated in {1e3 * limit[0]:.2f} ms")
            want = None
            for name, group in groups.items():
                piece = group[OUTPUT].isel(at)
                took = median(lambda piece=piece: piece.copy().load(), asked.runs)
                values = piece.values
                assert want is None or np.array_equal(want, values)
                want = values
                spread = f"{1e3 * took[1]:.2f} to {1e3 * took[2]:.2f}"
                print(f"  {name:18} {1e3 * took[0]:8.2f} ms  ({spread})  {took[0] / limit[0]:.1f}")


if __name__ == "__main__":
    main()
