"""What computing a sweep in parts costs beside computing it at once.

python -m benchmarks.parts [CELLS] [PARTS]
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.reduce import ASKED, TABLE, study
from core.intake import prepare_content
from core.kinds import tabulate


def main(cells: int, count: int) -> None:
    """Print time and memory of a reduced sweep, in parts and as a whole."""
    content = study(cells, ASKED["all statistics"], TABLE)
    prepared = prepare_content(content)
    prepared.work.seconds()  # what repays compiling is compiled
    started = time.perf_counter()
    tabulate(prepared)
    at_once = time.perf_counter() - started
    with tempfile.TemporaryDirectory() as folder:
        parts = prepared.parts(str(Path(folder) / "result.nc"), count)
        times, sizes = [], []
        for part in range(count):
            started = time.perf_counter()
            record = parts.compute(part)
            parts.keep(part, record)
            times.append(time.perf_counter() - started)
            sizes.append(len(record))
        started = time.perf_counter()
        parts.join()
        joining = time.perf_counter() - started
    print(f"{prepared.cells:,} cells at once: {at_once:.2f} s")
    print(
        f"in {count:,} parts: {sum(times):.2f} s, {sum(times) / at_once:.2f} times; a part "
        f"{statistics.median(times):.3f} s ({min(times):.3f} to {max(times):.3f}), its record "
        f"{statistics.median(sizes):,.0f} bytes; joined in {joining:.2f} s"
    )


if __name__ == "__main__":
    given = [int(float(number)) for number in sys.argv[1:]]
    main(*(given + [1_000_000_000, 64][len(given) :]))
