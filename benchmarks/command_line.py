"""What a user waits for on the command line, in a fresh home and later.

``python -m benchmarks.command_line`` carries out what the README and the guides begin with, each
with nothing compiled (a home and a folder of compiled code of its own) and then again, five times,
and prints the medians as the table of docs/performance.md: time on the clock, and of the
processor. It takes three minutes of a quiet machine; ``--rounds N`` repeats it N times instead.

Then it runs a million cells of closed forms with and without ``--dry-run`` in turn, and prints the
median of the ratios. The limit is 3.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.options import options
from vibrafeed.core.system import ROOT

PAIRS = 15
MILLION = """
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
PYTHON = Path(sys.executable)
VIBRAFEED = PYTHON.with_name("vibrafeed")

Cost = tuple[float, float]
"""Time on the clock, and of the processor [s]."""


def study_of(page: str, kind: str) -> str:
    """Return the first study of a kind, or with a criterion of that kind, on a page."""
    blocks = (ROOT / page).read_text().split("```toml\n")[1:]
    return next(block.split("```")[0] for block in blocks if f'kind = "{kind}"' in block)


def cost(command: Sequence[object], folder: Path, environment: Mapping[str, str]) -> Cost:
    """Return the cost of a command that is run in a folder and must succeed."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [*map(str, command)], cwd=folder, env={**os.environ, **environment}, check=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - started, spent


def first_minute() -> dict[str, Cost]:
    """Return the cost of each command in a fresh home, and of second runs."""
    found: dict[str, Cost] = {}
    with tempfile.TemporaryDirectory() as name:
        home = Path(name)
        environment = {
            "HOME": name, "XDG_CACHE_HOME": str(home / "caches"),
            "NUMBA_CACHE_DIR": str(home / "compiled"),
        }  # fmt: skip
        found["`import vibrafeed`"] = cost([PYTHON, "-c", "import vibrafeed"], home, environment)
        found["`vibrafeed --help`"] = cost([VIBRAFEED, "--help"], home, environment)
        studies = {
            "simulation of the README": study_of("README.md", "simulate"),
            "sweep of the README": study_of("README.md", "sweep"),
            "optimum of docs/optimise.md": study_of("docs/optimise.md", "limit"),
        }
        for label, text in studies.items():
            (home / "study.toml").write_text(text)
            for when in ("first", "second"):
                run = [VIBRAFEED, "run", "--force", "study.toml"]
                found[f"{when} {label}"] = cost(run, home, environment)
    return found


def ratios() -> list[tuple[float, float]]:
    """Return times of a million cells and of the same command with --dry-run, in pairs."""
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "study.toml").write_text(MILLION)
        run = [VIBRAFEED, "run", "--force", "study.toml"]
        pairs = [
            (cost(run, Path(name), {})[0], cost([*run, "--dry-run"], Path(name), {})[0])
            for _ in range(PAIRS + 1)
        ]
    return pairs[1:]  # the first pair warms the file cache


def main() -> None:
    """Print the medians of all measurements."""
    rounds = [first_minute() for _ in range(options(__doc__, rounds=5).rounds)]
    print("| what | s | of the processor |\n| --- | --- | --- |")
    for label in rounds[0]:
        clock, spent = (statistics.median(one[label][k] for one in rounds) for k in (0, 1))
        print(f"| {label} | {clock:.2f} | {spent:.2f} |")
    full, dry = zip(*(pairs := ratios()), strict=True)
    quotients = [a / b for a, b in pairs]
    with_cells, without = statistics.median(full), statistics.median(dry)
    print(f"\nA million cells: {with_cells:.2f} s, {without:.2f} s with --dry-run; ratio", end=" ")
    print(f"{statistics.median(quotients):.2f} ({min(quotients):.2f} to {max(quotients):.2f}).")


if __name__ == "__main__":
    main()
