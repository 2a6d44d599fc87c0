"""A million cells from the command line, against the start-up of the same command.

`python -m benchmarks.command_line` runs `vibrafeed run` with and without `--dry-run` in turn and
prints the median of the ratios. The limit is 3.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PAIRS = 15
STUDY = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["acceleration_x", "starting_acceleration", "transport_velocity"]

[parameters]
frequency = { start = 20, stop = 120, num = 100 }
amplitude = 0.0005
alpha = { start = 0, stop = 90, num = 100 }
beta = { start = 0, stop = 90, num = 100 }
friction = 0.3
radius = 0.8
distance = 0.0002
"""


def seconds(*arguments: str) -> float:
    """Return the wall time of one run of the command."""
    command = [str(Path(sys.executable).with_name("vibrafeed")), "run", "--force", *arguments]
    started = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - started


def main() -> None:
    """Print the median times and their ratio."""
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study.toml"
        study.write_text(STUDY)
        pairs = [(seconds(str(study)), seconds(str(study), "--dry-run")) for _ in range(PAIRS + 1)]
    full, dry = zip(*pairs[1:], strict=True)  # the first pair warms the file cache
    ratios = [a / b for a, b in pairs[1:]]
    print(f"run        {statistics.median(full):.3f} s (median of {PAIRS})")
    print(f"--dry-run  {statistics.median(dry):.3f} s")
    print(f"ratio      {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")


if __name__ == "__main__":
    main()
