"""What the ledger's steps take: `python -m benchmarks.ledger`, or with `--url` of a PostgreSQL.

Medians of so many jobs that are posted, claimed and carried out one after another, in a new SQLite
file: on the disk, and in memory, where no step waits for a disk.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.app.jobs.ledger import Ledger

MEMORY = Path("/dev/shm")


def steps(where: Path | str, jobs: int) -> dict[str, float]:
    """Return the median time of each ledger operation [s]."""
    ledger = Ledger(where)
    times: dict[str, list[float]] = defaultdict(list)

    def clocked(name: str, step: Callable[[], Any]) -> Any:
        found, seconds = timed(step)
        times[name].append(seconds)
        return found

    size = {"cells": 1, "block_cells": 1, "blocks": 1, "bytes_": 1, "finished_seconds": None}
    run = time.time_ns()
    try:
        for n in range(jobs):
            key = f"{run}-{n}"
            job = clocked("post", lambda key=key: ledger.post(key, "sweep", **size))
            work = clocked("claim", lambda: ledger.claim("benchmark", 60.0))
            clocked("advance", lambda work=work: ledger.advance(work, done=1, seconds=1.0))
            clocked("holds", lambda work=work: ledger.holds(work))
            clocked("job", lambda job=job: ledger.job(job.id))
            clocked("succeed", lambda work=work: ledger.succeed(work))
    finally:
        ledger.close()
    return {name: statistics.median(values) for name, values in times.items()}


def main() -> None:
    """Print the table of times."""
    asked = options(__doc__, url=(str, "of a ledger that nobody else uses"), jobs=400)
    if asked.url:
        _tell("PostgreSQL", steps(asked.url, asked.jobs))
        return
    for name, place in {"disk": None, "memory": MEMORY if MEMORY.is_dir() else None}.items():
        if name == "memory" and place is None:
            continue
        with tempfile.TemporaryDirectory(dir=place) as folder:
            _tell(name, steps(Path(folder) / "jobs.sqlite3", asked.jobs))


def _tell(name: str, found: dict[str, float]) -> None:
    """Print the times of one database."""
    print(f"{name:12}" + "  ".join(f"{step} {1e3 * value:.2f} ms" for step, value in found.items()))


if __name__ == "__main__":
    main()
