"""What does not fit into memory is computed under a limit of it, and is what memory would hold.

    python -m benchmarks.limited [--stored 1e9] [--reduced 1e11] [--gigabytes 4]

`vibrafeed run` under `ulimit -v`, of seven axes of the narrow track:

- a sweep is stored as Zarr; the run is killed (kill -9) when a third is there, and goes on with
  `--resume`. All values are compared with those of sweeps in memory, one for each frequency.
- the largest and the mean speed over five axes; some are compared with those of their cells in
  memory.

It prints time, memory and the number of values that differ. The disk needs two bytes a cell or so.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import xarray

import vibrafeed
from benchmarks.large import FIVE, SPEED, study
from benchmarks.options import options
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.quantities import REGIMES

KEPT = ("frequency", "amplitude")
ANSWERS = 3
"""Of the reduction, that are compared."""
RUN = "import resource, sys; from vibrafeed.app.cli import app\n" + (
    "try:\n    app(['run', '-q', *sys.argv[1:]], standalone_mode=False)\n"
    "finally:\n    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)\n"
)


def started(content: dict[str, Any], target: Path, gigabytes: float) -> subprocess.Popen[str]:
    """Start a run of a study under a limit of virtual memory; it prints its largest memory."""
    file = target.with_suffix(".json")
    file.write_text(json.dumps(content))
    limit = f'ulimit -v {int(gigabytes * 1e6)}; exec "$@"'
    run = [sys.executable, "-W", "ignore", "-c", RUN, str(file), "-o", str(target), "--resume"]
    return subprocess.Popen(["sh", "-c", limit, "sh", *run], stdout=subprocess.PIPE, text=True)


def finished(run: subprocess.Popen[str], since: float) -> str:
    """Wait for a run; return its time and memory in words."""
    memory = run.communicate()[0].split()
    assert run.returncode == 0, "the run failed"
    return f"{time.perf_counter() - since:.0f} s, at most {int(memory[-1]) / 1e9:.2f} GB"


def fixed(content: dict[str, Any], at: dict[str, int]) -> dict[str, Any]:
    """Return a study with one value of some axes, by position, and all cells."""
    axes = prepare_content(content).grid.axes
    values = {name: float(axes[name].array()[k]) for name, k in at.items()}
    return {**study(1), "parameters": {**content["parameters"], **values}}


def stored(cells: float, gigabytes: float, folder: Path) -> None:
    """Store a sweep with one kill, and compare all of it."""
    content, target = study(cells), folder / "stored.zarr"
    blocks = prepare_content(content).cells / 2**18
    since = time.perf_counter()
    run = started(content, target, gigabytes)
    chunks = folder / ".stored.zarr.partial" / SPEED / "c"
    while run.poll() is None and sum(one.is_file() for one in chunks.rglob("*")) < blocks / 3:
        time.sleep(0.2)
    run.kill()
    run.communicate()
    assert not target.exists(), "it was done before it was killed"
    told = finished(started(content, target, gigabytes), since)
    differ = compared = 0
    with xarray.open_zarr(target, chunks=None) as found:
        for k in range(found.sizes["frequency"]):
            wanted = vibrafeed.sweep(fixed(content, {"frequency": k}))
            for name, values in wanted.data_vars.items():
                one = found[name].isel(frequency=k).transpose(*values.dims).values
                differ += int(
                    np.count_nonzero((one != values) & ~(np.isnan(one) & np.isnan(values)))
                )
                compared += one.size
    print(f"Zarr, {found[SPEED].size:,} cells, killed once: {told}; "
          f"{differ} of {compared:,} values differ from those in memory", flush=True)  # fmt: skip


def reduced(cells: float, gigabytes: float, folder: Path) -> None:
    """Reduce a sweep, and compare some answers."""
    content = study(cells, reduce={"over": list(FIVE), "statistics": ["max", "mean"]})
    target, since = folder / "reduced.nc", time.perf_counter()
    told = finished(started(content, target, gigabytes), since)
    valid = [regime.value for regime in REGIMES.values() if regime.valid]
    worst, chosen = {"max": 0.0, "mean": 0.0}, np.random.default_rng(1)
    with xarray.open_dataset(target) as found:
        for _ in range(ANSWERS):
            at = {name: int(chosen.integers(found.sizes[name])) for name in KEPT}
            whole = vibrafeed.sweep(fixed(content, at))
            counted = whole[SPEED].values[np.isin(whole["regime"].values, valid)]
            for what in worst:
                got = float(found[f"{SPEED}_{what}"].isel(at))
                wanted = float(getattr(np, what)(counted)) if counted.size else np.nan
                apart = (
                    0.0 if np.array_equal(got, wanted, equal_nan=True) else abs(got / wanted - 1)
                )
                worst[what] = max(worst[what], apart)
    worst_max, worst_mean = (f"{one:.1g}" for one in worst.values())
    print(f"reduced, {prepare_content(content).cells:,} cells: {told}; of {ANSWERS} answers max "
          f"differs by {worst_max} of its value, mean by {worst_mean}", flush=True)  # fmt: skip


def main() -> None:
    """Print both."""
    asked = options(__doc__, stored=1e9, reduced=1e11, gigabytes=4.0)
    with tempfile.TemporaryDirectory(prefix="limited-") as name:
        stored(asked.stored, asked.gigabytes, Path(name))
        reduced(asked.reduced, asked.gigabytes, Path(name))


if __name__ == "__main__":
    main()
