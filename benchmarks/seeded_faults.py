"""Seeded faults, and the tests that notice them.

`python -m benchmarks.seeded_faults` puts faults, one at a time, into a copy of `core` and `app`: a
sign, a comparison, a bound or a unit, at places that a seed picks. The tests of `make test` run
against each, those of the fault's room first; the faults that they miss then meet the tests of
`make test-all`. It prints the faults, who noticed each, and the counts. 60 faults take hours;
`--number 6` shows how it goes.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
KINDS = ("sign", "comparison", "bound", "unit")
SIGNS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+")}
COMPARISONS = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
}
UNITS = {1e3: "1e2", 1e-3: "1e-2", 1e6: "1e5", 1e-6: "1e-5", 60: "3600", 180: "90", 360: "180"}
COMMANDS = {
    "make test": ("tests/fast", "tests/journeys"),
    "make test-all": (
        "tests/laws",
        "tests/service",
        "tests/browser",
        "tests/docs",
        "tests/packaging",
    ),
}


@dataclass(frozen=True)
class Fault:
    """A change of a few characters in a file of core or app."""

    kind: str
    path: str
    line: int
    start: int
    stop: int
    before: str
    after: str

    def __str__(self) -> str:
        return f"{self.kind:10} {self.path}:{self.line}: {self.before} becomes {self.after}"

    def put_into(self, tree: Path) -> None:
        """Write the file with the fault into another tree."""
        text = (ROOT / self.path).read_text()
        assert text[self.start : self.stop] == self.before
        (tree / self.path).write_text(text[: self.start] + self.after + text[self.stop :])


def main() -> None:
    """Run the tests on each fault, and print who noticed it."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--number", type=int, default=60)
    reader.add_argument("--seed", type=int, default=1)
    asked = reader.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder, "tree")
        files = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True
        ).stdout
        for name in filter(None, files.split("\0")):
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name, follow_symlinks=False)
        missed = chosen(asked.number, asked.seed)
        for command, folders in COMMANDS.items():
            if fails(tree, folders):
                sys.exit(f"{command} fails without a fault")
            there = [fault for fault in missed if not notices(tree, fault, folders)]
            print(f"{command}: {len(missed) - len(there)} of {len(missed)}", flush=True)
            missed = there
    for fault in missed:
        print(f"nobody: {fault}")


def chosen(number: int, seed: int) -> list[Fault]:
    """Return faults of all kinds in turn, no two in one file while there are others."""
    chance = random.Random(seed)
    faults = [fault for path in sources() for fault in faults_of(path)]
    chance.shuffle(faults)
    taken: list[Fault] = []
    while len(taken) < number:
        used = {fault.path for fault in taken}
        kind = KINDS[len(taken) % len(KINDS)]
        taken.append(next(f for f in faults if f.kind == kind and f.path not in used))
    return taken


def sources() -> Iterator[Path]:
    """Yield the files that get faults."""
    for room in ("core", "app"):
        yield from sorted((ROOT / room).rglob("*.py"))


def faults_of(path: Path) -> Iterator[Fault]:
    """Yield all faults of a file."""
    text = path.read_text()
    lines = [0]
    for line in text.splitlines(keepends=True):
        lines.append(lines[-1] + len(line.encode()))
    content = text.encode()

    def place(line: int | None, column: int | None) -> int:
        assert line is not None
        assert column is not None
        return len(content[: lines[line - 1] + column].decode())

    def fault(kind: str, line: int, start: int, stop: int, after: str) -> Fault:
        name = path.relative_to(ROOT).as_posix()
        return Fault(kind, name, line, start, stop, text[start:stop], after)

    tree = ast.parse(text)
    cut = {one for node in ast.walk(tree) if isinstance(node, ast.Slice) for one in ast.walk(node)}
    factors = {
        one
        for node in ast.walk(tree)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div)
        for one in (node.left, node.right)
    }
    before: str
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp) and type(node.op) in SIGNS:
            kind, (before, after) = "sign", SIGNS[type(node.op)]
            left, right = node.left, node.right
        elif isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARISONS:
            kind, (before, after) = "comparison", COMPARISONS[type(node.ops[0])]
            left, right = node.left, node.comparators[0]
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            if isinstance(node.value, bool) or node in cut:  # where a text is cut off is no bound
                continue
            start = place(node.lineno, node.col_offset)
            stop = place(node.end_lineno, node.end_col_offset)
            if node.value in UNITS and node in factors:  # else it is a tolerance
                yield fault("unit", node.lineno, start, stop, UNITS[node.value])
            elif node.value > 1:
                yield fault("bound", node.lineno, start, stop, repr(node.value * 2))
            continue
        else:
            continue
        start = place(left.end_lineno, left.end_col_offset)
        stop = place(right.lineno, right.col_offset)
        if text[start:stop].count(before) == 1:
            at = start + text[start:stop].index(before)
            yield fault(kind, node.lineno, at, at + len(before), after)


def notices(tree: Path, fault: Fault, folders: Sequence[str]) -> bool:
    """Return whether a test of some folders fails with a fault."""
    room = Path("tests/fast", *Path(fault.path).parts[:2])
    near = [room.as_posix()] if "tests/fast" in folders and (tree / room).is_dir() else []
    fault.put_into(tree)
    found = fails(tree, [*near, *folders])
    shutil.copy2(ROOT / fault.path, tree / fault.path)
    print(f"{'noticed' if found else 'missed':8} {fault}", flush=True)
    return found


def fails(tree: Path, folders: Sequence[str]) -> bool:
    """Return whether a test of some folders fails."""
    # Services and browsers wait, so their tests have more processes than there are cores.
    processes = (os.cpu_count() or 1) + (0 if "tests/fast" in folders else 3)
    schedule = ["-n", str(processes), "--dist", "loadfile", "--no-loadscope-reorder"]
    command = [sys.executable, "-m", "pytest", "-x", "-q", *schedule, *folders]
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, check=False)
    return done.returncode != 0


if __name__ == "__main__":
    main()
