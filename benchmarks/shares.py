"""What computing a sweep in shares costs beside computing it at once.

python -m benchmarks.shares [--cells CELLS] [--shares SHARES]
"""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path

from benchmarks.options import options
from benchmarks.reduce import ASKED, TABLE, study
from benchmarks.timing import timed
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate


def main(cells: int, count: int) -> None:
    """Print time and memory of a reduced sweep, in shares and as a whole."""
    content = study(cells, ASKED["all statistics"], TABLE)
    prepared = prepare_content(content)
    tabulate(prepared)  # compiles its loops
    at_once = timed(tabulate, prepared)[1]
    with tempfile.TemporaryDirectory() as folder:
        shares = prepared.shares(str(Path(folder) / "result.nc"), count)
        times, sizes = [], []
        for share in range(count):
            record, computing = timed(shares.compute, share)
            times.append(computing + timed(shares.keep, share, record)[1])
            sizes.append(len(record))
        joining = timed(shares.join)[1]
    print(f"{prepared.cells:,} cells at once: {at_once:.2f} s")
    print(
        f"in {count:,} shares: {sum(times):.2f} s, {sum(times) / at_once:.2f} times; a share "
        f"{statistics.median(times):.3f} s ({min(times):.3f} to {max(times):.3f}), its record "
        f"{statistics.median(sizes):,.0f} bytes; joined in {joining:.2f} s"
    )


if __name__ == "__main__":
    asked = options(__doc__, cells=1e9, shares=64)
    main(int(asked.cells), asked.shares)
