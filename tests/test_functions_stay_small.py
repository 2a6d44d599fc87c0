"""Functions of `core` that are read at once: few branches, few loose numbers, bounds with reasons.

The bounds are what stands: they may fall, and nothing new may pass them.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator
from pathlib import Path

CORE = Path(__file__).parents[1] / "core"
SCALARS = {"float", "int", "bool"}

MAX_SCALARS = 8
"""Loose numbers of a function: what belongs together is a named tuple."""

MAX_BRANCHES = 19
"""Ways through a function, with boolean operators and comprehensions."""

MAX_MANY = 26
"""Functions of `core` with more than 15 branches."""


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    found = (ast.FunctionDef, ast.AsyncFunctionDef)
    yield from (node for node in ast.walk(tree) if isinstance(node, found))


def inside(function: ast.AST) -> Iterator[ast.AST]:
    """Yield what stands in a function, that of functions in it aside."""
    for node in ast.iter_child_nodes(function):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node
            yield from inside(node)


def branches(function: ast.AST) -> int:
    count = 1
    for node in inside(function):
        if isinstance(node, ast.BoolOp):
            count += len(node.values) - 1
        elif isinstance(node, ast.comprehension):
            count += 1 + len(node.ifs)
        else:
            ways = (ast.If, ast.IfExp, ast.For, ast.AsyncFor, ast.While)
            count += isinstance(node, (*ways, ast.ExceptHandler, ast.match_case))
    return count


def scalars(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    given = (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs)
    kinds = (one.annotation for one in given)
    return sum(isinstance(kind, ast.Name) and kind.id in SCALARS for kind in kinds)


@functools.cache
def counted() -> tuple[tuple[str, int, int], ...]:
    """Return module and name, branches and loose numbers of each function of `core`."""
    found = []
    for path in sorted(CORE.rglob("*.py")):
        module = ".".join(path.relative_to(CORE).with_suffix("").parts)
        for function in functions(ast.parse(path.read_text(encoding="utf-8"))):
            found.append((f"{module}.{function.name}", branches(function), scalars(function)))
    return tuple(found)


def test_branches_of_a_function():
    assert len(counted()) > 2500
    assert [(name, n) for name, n, _ in counted() if n > MAX_BRANCHES] == []


def test_functions_of_many_branches_become_no_more():
    assert sum(n > 15 for _, n, _ in counted()) <= MAX_MANY


def test_loose_numbers_of_a_function():
    assert [name for name, _, loose in counted() if loose > MAX_SCALARS] == []


def without_reason(text: str) -> list[str]:
    """Return the limits of a module, `MAX_...`, beside or under which nothing is said."""
    lines, tree = text.splitlines(), ast.parse(text)
    found = []
    for node, after in zip(tree.body, [*tree.body[1:], None], strict=True):
        if not isinstance(node, ast.Assign | ast.AnnAssign):
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        names = [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
        limits = [name for name in names if name.startswith(("MAX_", "MOST_"))]
        said = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        beside = "#" in lines[(node.end_lineno or 1) - 1] or lines[node.lineno - 2].startswith("#")
        found += [] if said or beside else limits
    return found


def test_limits_of_motion_have_their_reason():
    paths = sorted((CORE / "motion").rglob("*.py"))
    found = {path.name: without_reason(path.read_text(encoding="utf-8")) for path in paths}
    assert {name: limits for name, limits in found.items() if limits} == {}


def test_what_is_counted():
    text = """
def one(a: float, b: int, c: bool, d: "Array", *, e: float = 0.0):
    if a and b or c:
        return [x for x in d if x if not x]
    for _ in d:
        try:
            pass
        except ValueError:
            return 1 if c else 2
"""
    (function,) = functions(ast.parse(text))
    assert branches(function) == 1 + 1 + 2 + 3 + 1 + 1 + 1
    assert scalars(function) == 4
    assert without_reason("MAX_A = 1\nMAX_B = 2\n'''Since.'''\nMAX_C = 3  # why\n") == ["MAX_A"]
