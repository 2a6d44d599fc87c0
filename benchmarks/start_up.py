"""Processor time of the first commands, of this tree or of several in turns.

`python -m benchmarks.start_up [TREE ...]` prints the median of nine runs of each command [s]. A
tree is a folder that holds `vibrafeed`; this one is always among them. Kernels are compiled by a
first run, which does not count.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
RUNS = 9
VIBRAFEED = ("-m", "vibrafeed")


def commands(tree: Path, folder: str) -> dict[str, tuple[str, ...]]:
    """Return the words after `python` of each command that is measured, by its name."""
    study = str(tree / "configs" / "nut.toml")
    return {
        "nothing": ("-c", "pass"),
        "import vibrafeed": ("-c", "import vibrafeed"),
        "vibrafeed --help": (*VIBRAFEED, "--help"),
        "vibrafeed run --help": (*VIBRAFEED, "run", "--help"),
        "vibrafeed serve --help": (*VIBRAFEED, "serve", "--help"),
        "vibrafeed run nut.toml": (*VIBRAFEED, "run", study, "--force", "-o", f"{folder}/nut.nc"),
    }


def seconds(tree: Path, words: tuple[str, ...]) -> float:
    """Return the processor time of Python with these words, in the tree [s]."""
    before = os.times()
    subprocess.run(
        [sys.executable, *words],
        check=True, capture_output=True, cwd=tree, env={**os.environ, "PYTHONPATH": str(tree)},
    )  # fmt: skip
    after = os.times()
    return after.children_user + after.children_system - sum(before[2:4])


def main(trees: list[str]) -> None:
    """Print a line a command, a column a tree."""
    places = [HERE, *(Path(tree).resolve() for tree in trees)]
    with tempfile.TemporaryDirectory() as folder:
        for name in commands(HERE, folder):
            found: dict[Path, list[float]] = {tree: [] for tree in places}
            for turn in range(RUNS + 1):
                for tree in places:
                    took = seconds(tree, commands(tree, folder)[name])
                    if turn:  # the first writes bytecode, and compiles kernels
                        found[tree].append(took)
            print(f"{name:<24}", *(f"{statistics.median(found[tree]):8.3f}" for tree in places))


if __name__ == "__main__":
    main(sys.argv[1:])
