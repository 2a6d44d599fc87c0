"""No test compares measured time: a busy machine would fail it, and a fast one prove nothing."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

HERE = Path(__file__).parent
CLOCKS = {"time", "monotonic", "perf_counter", "process_time", "thread_time"}
CLOCKS |= {f"{name}_ns" for name in CLOCKS}
WAITING = HERE / "helpers" / "waiting.py"
"""The one place that looks whether it has waited long enough, to end what never comes."""


def is_clock(node: ast.AST) -> bool:
    """True of a reading of a clock, alone or with something added or taken off."""
    if isinstance(node, ast.BinOp):
        return is_clock(node.left) or is_clock(node.right)
    if not isinstance(node, ast.Call):
        return False
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    owner = getattr(getattr(node.func, "value", None), "id", "time")
    return name in CLOCKS and owner == "time" and not node.args


def verdicts(source: str) -> list[int]:
    """Return the lines in which a reading, or a difference of readings, is compared."""
    tree = ast.parse(source)
    readings = {
        target.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and is_clock(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    }

    def measures(node: ast.AST) -> bool:
        if isinstance(node, ast.BinOp):
            return measures(node.left) or measures(node.right)
        return is_clock(node) or (isinstance(node, ast.Name) and node.id in readings)

    compared = (node for node in ast.walk(tree) if isinstance(node, ast.Compare))
    return [node.lineno for node in compared if any(map(measures, (node.left, *node.comparators)))]


FILES = [path for path in sorted(HERE.rglob("*.py")) if path != WAITING]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(HERE).as_posix())
def test_no_test_compares_measured_time(path: Path) -> None:
    assert verdicts(path.read_text()) == []


@pytest.mark.parametrize(
    "source",
    [
        "assert time.monotonic() - started < 5",
        "took = time.perf_counter() - began\nassert took < 3",
        "until = time.monotonic() + 60\nwhile time.monotonic() < until:\n    pass",
        "assert before <= found <= time.time()",
    ],
)
def test_such_a_comparison_is_found(source: str) -> None:
    assert verdicts(source) != []


def impatient(source: str) -> list[int]:
    """Return the lines with a time limit of their own, in place of the patience of all."""
    keywords = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.keyword))
    return [
        node.value.lineno
        for node in keywords
        if node.arg == "timeout" and isinstance(node.value, ast.Constant) and node.value.value
    ]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(HERE).as_posix())
def test_time_limits_are_one_patience(path: Path) -> None:
    """`waiting.PATIENCE`: what a quiet machine does in 20 s takes a busy one minutes."""
    assert impatient(path.read_text()) == []


def test_a_time_limit_of_its_own_is_found() -> None:
    assert impatient("urlopen(request, timeout=20)") == [1]
    assert impatient("urlopen(request, timeout=PATIENCE)") == []


def test_a_clock_that_is_handed_on_is_none() -> None:
    assert verdicts("assert key.stands(time.time()) == [True]") == []
