"""What computing a sweep in parts costs beside computing it at once.

python -m benchmarks.parts [--cells CELLS] [--parts PARTS]
"""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path

from benchmarks.options import options
from benchmarks.reduce import ASKED, TABLE, study
from benchmarks.timing import timed
from core.intake import prepare_content
from core.kinds import tabulate


def main(cells: int, count: int) -> None:
    """Print time and memory of a reduced sweep, in parts and as a whole."""
    content = study(cells, ASKED["all statistics"], TABLE)
    prepared = prepare_content(content)
    prepared.work.seconds()  # what repays compiling is compiled
    at_once = timed(tabulate, prepared)[1]
    with tempfile.TemporaryDirectory() as folder:
        parts = prepared.parts(str(Path(folder) / "result.nc"), count)
        times, sizes = [], []
        for part in range(count):
            record, computing = timed(parts.compute, part)
            times.append(computing + timed(parts.keep, part, record)[1])
            sizes.append(len(record))
        joining = timed(parts.join)[1]
    print(f"{prepared.cells:,} cells at once: {at_once:.2f} s")
    print(
        f"in {count:,} parts: {sum(times):.2f} s, {sum(times) / at_once:.2f} times; a part "
        f"{statistics.median(times):.3f} s ({min(times):.3f} to {max(times):.3f}), its record "
        f"{statistics.median(sizes):,.0f} bytes; joined in {joining:.2f} s"
    )


if __name__ == "__main__":
    asked = options(__doc__, cells=1e9, parts=64)
    main(int(asked.cells), asked.parts)
